"""The equations of motion by the method of Runge and Kutta, for 2048 motions at once."""

from math import ceil, pi, sqrt

import numpy as np
from runge_kutta import Frame, library_numbers
from scipy.stats import beta as beta_law

PROGRAM = "Runge-Kutta, numpy"

m, k = 1e5 * np.array([3, 3, 3, 3, 3, 2.4]), 1e8 * np.array([4.2, 4, 3.6, 3.1, 2.5, 1.8])
xi, alpha, n, S0, end, modes = 0.03, 0.1, 1, 0.02, 15.0, (1, 3)
uy = np.array([12, 12, 11, 10, 9, 8]) / 1000
beta = gamma = 1 / (2 * uy[:, None])
limits = {"drift": [23, 27, 32, 35, 39.5, 44.5], "roof": [97, 114, 133, 145, 162, 182]}
paths, at_once, own_step = 32768, 2048, 0.0075
frame = Frame(m, k, xi, alpha, n, beta, gamma, rayleigh=modes)


def probabilities(noise, step):
    """Shares of the motions that exceed each limit, with their intervals by Clopper and Pearson.

    ``noise(part)`` are normal numbers (steps, at_once), which white noise has for a step each.
    """
    counts = {name: np.zeros(len(values)) for name, values in limits.items()}
    for part in range(paths // at_once):
        drifts, floors = frame.peaks(-sqrt(2 * pi * S0 / step) * noise(part), step)
        for name, most in (("drift", drifts.max(axis=0)), ("roof", floors[-1])):
            counts[name] += np.sum(1000 * most[:, None] > limits[name], axis=0)
    found = {}
    for name, count in counts.items():
        found[f"{name}_probability"] = count / paths
        found[f"{name}_probability_lower"] = beta_law.ppf(0.025, count, paths - count + 1)
        found[f"{name}_probability_upper"] = beta_law.ppf(0.975, count + 1, paths - count)
    return found


# The same motions: steps are parts of the fourth period, white noise has its mean over each.
squares, _ = frame.modes()
step = 2 * pi / sqrt(squares[3]) / 32
groups = at_once // 32
ANSWERS = probabilities(lambda part: library_numbers(ceil(end / step), groups, part * groups), step)
# Motions of its own.
random = np.random.default_rng(1)
own = probabilities(lambda _: random.standard_normal((round(end / own_step), at_once)), own_step)

apart = {}
for name in limits:
    p, q = ANSWERS[f"{name}_probability"], own[f"{name}_probability"]
    apart[name] = (p - q) / np.sqrt((p * (1 - p) + q * (1 - q)) / paths)
NUMBERS = {f"own_{name}": values for name, values in own.items()}
NUMBERS |= {f"{name}_apart": values for name, values in apart.items()}
NUMBERS |= {f"{name}_limits": values for name, values in limits.items()}
NUMBERS |= {
    "m": m / 1000,
    "k": k / 1e6,
    "xi": xi,
    "alpha": alpha,
    "n": n,
    "uy": 1000 * uy,
    "S0": S0,
}
NUMBERS |= {
    "end": end,
    "modes": modes,
    "paths": paths,
    "step": 1000 * step,
    "own_step": 1000 * own_step,
}
NUMBERS |= {"band": 0.5 / step, "own_band": 0.5 / own_step}
w, (a0, a1) = np.sqrt(squares), frame.factors()
NUMBERS["ratios"] = a0 / (2 * w) + a1 * w / 2
