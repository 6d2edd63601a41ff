"""Covariances by the matrix exponential, Rice's rate of crossings, and an integral over time."""

from math import erfc, pi, sqrt

import numpy as np
from scipy.linalg import expm, solve_continuous_lyapunov
from scipy.stats import norm

PROGRAM = "by hand, scipy"

T, xi, S0, gap = (1.0, 0.6), (0.05, 0.03), 0.01, 0.12
A = np.zeros((4, 4))
for n in range(2):
    w = 2 * pi / T[n]
    A[2 * n : 2 * n + 2, 2 * n : 2 * n + 2] = [[0, 1], [-(w**2), -2 * xi[n] * w]]
b = np.array([0, 1, 0, 1])
stationary = solve_continuous_lyapunov(A, -2 * pi * S0 * np.outer(b, b))
d = np.array([[1, 0, -1, 0], [0, 1, 0, -1]])  # u1 - u2 and its velocity

STEP = 0.002
step = expm(A * STEP)
power, times, rates, stds = np.eye(4), [0.0], [0.0], [0.0]
for n in range(1, round(20 / STEP) + 1):
    power = power @ step
    (dd, dv), (_, vv) = d @ (stationary - power @ stationary @ power.T) @ d.T
    # Rice: of crossings upwards at d = gap, where the velocity has this mean and standard
    # deviation.
    mean, std = dv / dd * gap, sqrt(max(vv - dv**2 / dd, 1e-30))
    flux = std * norm.pdf(mean / std) + mean * norm.cdf(mean / std)
    rates.append(flux * norm.pdf(gap / sqrt(dd)) / sqrt(dd))
    times.append(n * STEP)
    stds.append(sqrt(dd))
sums = np.concatenate([[0], np.cumsum((np.array(rates[1:]) + rates[:-1]) / 2 * STEP)])
shown = (2.0, 5.0, 20.0)
at = [round(t / STEP) for t in shown]
ANSWERS = {
    "difference_std": [stds[n] for n in at],
    "instantaneous_probability": [erfc(gap / stds[n] / sqrt(2)) / 2 for n in at],
    "confidence_of_no_pounding_poisson": [np.exp(-sums[n]) for n in at],
}
NUMBERS = {"T": T, "xi": xi, "S0": S0, "gap": 100 * gap, "shown": shown}
