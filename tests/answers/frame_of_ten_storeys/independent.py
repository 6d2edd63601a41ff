"""The equations of motion by the method of Runge and Kutta, for all motions at once."""

from math import pi

import numpy as np
from scipy.linalg import eigh

PROGRAM = "Runge-Kutta, numpy"

# The published frame: columns of a storey, their sides, Young's modulus; and its Bouc-Wen law.
storeys, number, E, side, h = 10, 3, 3e10, np.array([0.5, *[0.4] * 9]), np.array([4.0, *[3.0] * 9])
m, xi, alpha, A, n, beta, gamma, D, end = 2.6e5, 0.05, 0.04, 1.0, 1, 15.0, 150.0, 0.0072, 10.0
k = number * 12 * E * side**4 / 12 / h**3
limits = np.array(
    [
        [34, 28, 22, 17, 13, 10.8, 8.5, 6.5, 5, 2.8],
        [47, 39, 28, 21, 16, 12.5, 10, 7.5, 6, 3.1],
    ]
)

squares, modes = eigh(
    np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1), m * np.eye(storeys)
)
damping = m * modes @ np.diag(2 * xi * np.sqrt(squares)) @ modes.T  # over the mass
periods = 2 * pi / np.sqrt(squares)


def between(floors):
    """Of the storeys, from floor to floor."""
    return np.diff(floors, axis=0, prepend=0.0)


def rates(state, ground):
    u, v, z = state  # z is a hysteretic drift, in metres
    drift, rate = between(u), between(v)
    shear = k[:, None] * (alpha * drift + (1 - alpha) * z)
    net = shear - np.vstack([shear[1:], np.zeros_like(shear[:1])])
    z_rate = A * rate - beta * abs(rate) * abs(z) ** (n - 1) * z - gamma * rate * abs(z) ** n
    return np.array([v, -ground - damping @ v - net / m, z_rate])


def peak_drifts(motions, step):
    """Of the storeys in all motions; each of their values lasts for a step."""
    state = np.zeros((3, storeys, motions.shape[1]))
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
white = library_numbers(int(np.ceil(end / step)), paths // 32) * np.sqrt(D / step)
peaks = peak_drifts(-white, step)
exceedance = np.mean(peaks > limits[..., None] / 1000, axis=-1)
ANSWERS = {"mean": peaks.mean(axis=-1), "exceedance": exceedance}

# Motions of its own, four times as many; the distances of the probabilities over their standard errors.
own_step, own_paths = 0.005, 4096
own = np.random.default_rng(1).standard_normal((round(end / own_step), own_paths))
own_peaks = peak_drifts(own * np.sqrt(D / own_step), own_step)
own_exceedance = np.mean(own_peaks > limits[..., None] / 1000, axis=-1)
variance = own_exceedance * (1 - own_exceedance)
apart = abs(exceedance - own_exceedance) / np.sqrt(variance / paths + variance / own_paths)
NUMBERS = {
    **{"storeys": storeys, "number": number, "E": E / 1e9, "side": side, "h": h, "m": m / 1000},
    **{"xi": xi, "alpha": alpha, "A": A, "n": n, "beta": beta, "gamma": gamma, "D": D, "end": end},
    **{"large": limits[0], "larger": limits[1], "paths": paths, "own_paths": own_paths},
    **{"step": 1000 * step, "own_step": 1000 * own_step, "uy": 1000 / (beta + gamma)},
    **{"apart": apart.max(), "within_one": np.sum(apart < 1), "compared": apart.size},
}
