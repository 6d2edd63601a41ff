"""Free vibration about the shifted rest, closed form from blow to blow; times by root finding."""

from itertools import pairwise
from math import pi

import numpy as np
from scipy.optimize import brentq, minimize_scalar

PROGRAM = "by hand"

T, xi, m = np.array([1.2, 0.5]), np.array([0.05, 0.02]), np.array([2e5, 3e5])
a, gap, e, end = 2.0, 0.07, 0.65, 2.0
w = 2 * pi / T
wd, rest = w * np.sqrt(1 - xi**2), a / w**2


def free(t, u, v):
    """State after ``t`` from this state."""
    A = u - rest
    B = (v + xi * w * A) / wd
    decay, c, s = np.exp(-xi * w * t), np.cos(wd * t), np.sin(wd * t)
    x = decay * (A * c + B * s)
    return rest + x, decay * wd * (B * c - A * s) - xi * w * x


def peaks(length, u, v):
    """Largest displacements within the length."""
    found = np.zeros(2)
    for n in range(2):
        grid = np.linspace(0, length, 4001)
        values = np.array([abs(free(t, u, v)[0][n]) for t in grid])
        at = grid[np.argmax(values)]
        low, high = max(at - grid[1], 0), min(at + grid[1], length)
        best = minimize_scalar(
            lambda t, n=n: -abs(free(t, u, v)[0][n]),
            bounds=(low, high),
            method="bounded",
            options={"xatol": 1e-12},
        )
        found[n] = max(values.max(), -best.fun)
    return found


now, u, v = 0.0, np.zeros(2), np.zeros(2)
times, speeds, losses, largest = [], [], [], np.zeros(2)
alone = peaks(end, u, v)
while True:

    def closed(t, u=u, v=v):
        x, _ = free(t, u, v)
        return x[0] - x[1] - gap

    grid = np.linspace(1e-9, end - now, 20001)
    first = next(((p, q) for p, q in pairwise(grid) if closed(p) < 0 <= closed(q)), None)
    length = end - now if first is None else brentq(closed, *first, xtol=1e-15)
    largest = np.maximum(largest, peaks(length, u, v))
    if first is None:
        break
    now, (u, v) = now + length, free(length, u, v)
    approach = v[0] - v[1]
    times.append(now)
    speeds.append(approach)
    losses.append((1 - e**2) * m.prod() / m.sum() * approach**2 / 2)
    v = v + np.array([-1, 1]) * (1 + e) * approach * m[::-1] / m.sum()  # eq. (13)

ANSWERS = {
    "impact_time": times,
    "approach_velocity": speeds,
    "energy_lost": losses,
    "peak": largest,
    "peak_alone": alone,
}
NUMBERS = {
    "T1": T[0],
    "T2": T[1],
    "xi1": xi[0],
    "xi2": xi[1],
    "a": a,
    "gap": 100 * gap,
    "e": e,
    "end": end,
    "m": m / 1000,
}
