"""The equations of motion by the method of Runge and Kutta, for all motions at once."""

from math import pi

import numpy as np
from runge_kutta import Frame, answers_and_numbers

PROGRAM = "Runge-Kutta, numpy"

m, k = 1e5 * np.array([3, 3, 3, 3, 3, 2.4]), 1e8 * np.array([4.2, 4, 3.6, 3.1, 2.5, 1.8])
xi, alpha, n, S0, end = 0.03, 0.1, 3, 0.02, 15.0
uy = np.array([12, 12, 11, 10, 9, 8]) / 1000
beta = gamma = 1 / (2 * uy[:, None] ** n)
limits = np.array([[27, 21, 22, 24, 23.1, 16.8], [34, 26, 27, 28, 27, 18.5]])

ANSWERS, NUMBERS = answers_and_numbers(
    Frame(m, k, xi, alpha, n, beta, gamma), 2 * pi * S0, end, limits
)
NUMBERS |= {
    "m": m / 1000,
    "k": k / 1e6,
    "xi": xi,
    "alpha": alpha,
    "n": n,
    "uy": 1000 * uy,
    "S0": S0,
}
