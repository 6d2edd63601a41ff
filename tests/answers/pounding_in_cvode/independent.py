"""The same equations of motion and events in CVODE of SUNDIALS, from event to event."""

from importlib.metadata import version

import numpy as np
from sksundae.cvode import CVODE

PROGRAM = f"CVODE, scikit-sundae {version('scikit-sundae')}"

T, xi, alpha = np.array([1.1, 0.5]), np.array([0.05, 0.03]), np.array([0.05, 0.1])
uy, m = np.array([0.04, 0.015]), np.array([2e5, 3e5])
gap, k, a = 0.02, 3e8, 0.6
w = 2 * np.pi / T
samples = 0.02 * np.arange(401)
shaking = 2.5 * np.sin(2 * np.pi * samples * (0.6 + 0.1 * samples)) * np.sin(np.pi * samples / 8)

# State: u, v and slip s of both, and what the contact has lost: 7 numbers.
plastic, touching, v0 = np.zeros(2), False, 0.0


def force(u, v):
    d = u[0] - u[1] - gap
    return k * max(d, 0) ** 1.5 * (1 + a * (v[0] - v[1]) / v0) if touching else 0.0


def rates(t, y, out):
    u, v, s = y[0:2], y[2:4], y[4:6]
    spring = w**2 * (alpha * u + (1 - alpha) * (u - s))
    f = force(u, v)
    ground = np.interp(t, samples, shaking)
    out[0:2] = v
    out[2:4] = -ground - 2 * xi * w * v - spring + np.array([-f, f]) / m
    out[4:6] = np.where(plastic != 0, v, 0)
    d = u[0] - u[1] - gap
    out[6] = (f - k * max(d, 0) ** 1.5) * (v[0] - v[1]) if touching else 0


def events(t, y, out):
    """Zero where a structure yields or unloads, the gap closes or opens, something is largest."""
    u, v, s = y[0:2], y[2:4], y[4:6]
    for n in range(2):
        out[n] = v[n] * plastic[n] if plastic[n] else uy[n] - abs(u[n] - s[n])
        out[3 + n] = v[n]
    d = u[0] - u[1] - gap
    out[2] = d if touching else -d
    if touching:
        now = np.zeros(7)
        rates(t, y, now)
        dv = v[0] - v[1]
        # The rate of the force, over what is never zero.
        out[5] = 1.5 * dv * (1 + a * dv / v0) + max(d, 0) * a * (now[2] - now[3]) / v0
    else:
        out[5] = 1.0


events.terminal = [True] * 6
events.direction = [-1, -1, -1, 0, 0, -1]
solver = CVODE(
    rates,
    method="Adams",
    rtol=1e-13,
    atol=1e-16,
    eventsfn=events,
    num_events=6,
    max_num_steps=100_000,
)

y, peak, now = np.zeros(7), np.zeros(2), 0.0
impacts = []
for end in samples[1:]:
    while now < end:
        found = solver.solve(np.array([now, end]), y)
        now, y = found.t[-1], found.y[-1].copy()
        u, v, s = y[0:2], y[2:4], y[4:6]
        peak = np.maximum(peak, np.abs(u))
        if found.status != 2:  # the sample
            continue
        (hit,) = np.flatnonzero(found.i_events[-1])[:1]
        if hit < 2:
            plastic[hit] = 0 if plastic[hit] else np.sign(u[hit] - s[hit])
        elif hit == 2 and not touching:
            touching, v0 = True, v[0] - v[1]
            impacts.append([now, v0, 0.0, now, y[6]])
        elif hit == 2:
            touching = False
            impacts[-1][3:] = now - impacts[-1][3], y[6] - impacts[-1][4]
        elif hit == 5:
            impacts[-1][2] = max(impacts[-1][2], force(u, v))
names = ("impact_time", "approach_velocity", "largest_force", "impact_duration", "energy_lost")
ANSWERS = dict(zip(names, np.transpose(impacts), strict=True)) | {"peak": peak}
NUMBERS = {
    **{"T": T, "xi": xi, "alpha": alpha, "uy": 100 * uy, "m": m / 1000, "gap": 100 * gap, "a": a},
    **{"k": k / 1e9, "end": samples[-1], "dt": samples[1]},
}
