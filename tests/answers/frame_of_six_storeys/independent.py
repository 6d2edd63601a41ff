"""The equations of motion by the method of Runge and Kutta, for all motions at once."""

from math import pi

import numpy as np
from scipy.linalg import eigh

PROGRAM = "Runge-Kutta, numpy"

m, k = 1e5 * np.array([3, 3, 3, 3, 3, 2.4]), 1e8 * np.array([4.2, 4, 3.6, 3.1, 2.5, 1.8])
xi, alpha, n, S0, end = 0.03, 0.1, 3, 0.02, 15.0
uy = np.array([12, 12, 11, 10, 9, 8]) / 1000
beta = gamma = 1 / (2 * uy[:, None] ** n)
limits = np.array([[27, 21, 22, 24, 23.1, 16.8], [34, 26, 27, 28, 27, 18.5]])

squares, modes = eigh(
    np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1), np.diag(m)
)
damping = modes @ np.diag(2 * xi * np.sqrt(squares)) @ modes.T * m  # over the masses
periods = 2 * pi / np.sqrt(squares)


def between(floors):
    """Of the storeys, from floor to floor."""
    return np.diff(floors, axis=0, prepend=0.0)


def rates(state, ground):
    u, v, z = state  # z is a hysteretic drift, in metres
    drift, rate = between(u), between(v)
    shear = k[:, None] * (alpha * drift + (1 - alpha) * z)
    net = shear - np.vstack([shear[1:], np.zeros_like(shear[:1])])
    z_rate = rate - beta * abs(rate) * abs(z) ** (n - 1) * z - gamma * rate * abs(z) ** n
    return np.array([v, -ground - damping @ v - net / m[:, None], z_rate])


def peak_drifts(motions, step):
    """Of the storeys in all motions; each of their values lasts for a step."""
    state = np.zeros((3, m.size, motions.shape[1]))
    peaks = np.zeros_like(state[0])
    for ground in motions:
        a = rates(state, ground)
        b = rates(state + step / 2 * a, ground)
        c = rates(state + step / 2 * b, ground)
        d = rates(state + step * c, ground)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        peaks = np.maximum(peaks, abs(between(state[0])))
    return peaks


def library_numbers(steps, groups):
    """The random numbers of the library, by a second program: xoshiro256+, the four parts of its bits.

    Their sum is made normal up to its ninth moment by a polynomial.
    """
    seeds = [np.random.SeedSequence(0, spawn_key=(group,)) for group in range(groups)]
    s = np.hstack([seed.generate_state(4 * 32, np.uint64).reshape(4, 32) for seed in seeds])
    found = np.empty((steps, s.shape[1]))
    for row in found:
        bits, shifted = s[0] + s[3], s[1] << np.uint64(17)
        s[2] ^= s[0]
        s[3] ^= s[1]
        s[1] ^= s[2]
        s[0] ^= s[3]
        s[2] ^= shifted
        s[3] = (s[3] << np.uint64(45)) | (s[3] >> np.uint64(19))
        x = sum((bits >> np.uint64(16 * part) & np.uint64(65535)).astype(float) for part in range(4))
        x = (x - 2 * 65535) / np.sqrt((2.0**32 - 1) / 3)
        row[:] = x * np.polyval(POLYNOMIAL, x**2)
    return found


POLYNOMIAL = [0.00042516035818070537, -0.0034087076598092536, 0.021272612064048006, 0.9554664534582995]

# The same motions: steps are parts of the fourth period, white noise has its mean over each.
step, paths = periods[3] / 256, 1024
white = library_numbers(int(np.ceil(end / step)), paths // 32) * np.sqrt(2 * pi * S0 / step)
peaks = peak_drifts(-white, step)
exceedance = np.mean(peaks > limits[..., None] / 1000, axis=-1)
ANSWERS = {"mean": peaks.mean(axis=-1), "exceedance": exceedance}

# Motions of its own, four times as many; the distances of the probabilities over their standard errors.
own_step, own_paths = 0.005, 4096
own = np.random.default_rng(1).standard_normal((round(end / own_step), own_paths))
own_peaks = peak_drifts(own * np.sqrt(2 * pi * S0 / own_step), own_step)
own_exceedance = np.mean(own_peaks > limits[..., None] / 1000, axis=-1)
variance = own_exceedance * (1 - own_exceedance)
apart = abs(exceedance - own_exceedance) / np.sqrt(variance / paths + variance / own_paths)
NUMBERS = {
    **{"m": m / 1000, "k": k / 1e6, "xi": xi, "alpha": alpha, "n": n, "uy": 1000 * uy, "S0": S0},
    **{"large": limits[0], "larger": limits[1], "paths": paths, "own_paths": own_paths, "end": end},
    **{"step": 1000 * step, "own_step": 1000 * own_step},
    **{"apart": apart.max(), "within_one": np.sum(apart < 1), "compared": apart.size},
}
