"""The equations of motion by the method of Runge and Kutta, for all motions at once."""

import numpy as np
from runge_kutta import Frame, answers_and_numbers

PROGRAM = "Runge-Kutta, numpy"

# The published frame: columns of a storey, their sides, Young's modulus; its Bouc-Wen law, with A =
# 1.
storeys, number, E, side, h = 10, 3, 3e10, np.array([0.5, *[0.4] * 9]), np.array([4.0, *[3.0] * 9])
m, xi, alpha, A, n, beta, gamma, D, end = 2.6e5, 0.05, 0.04, 1.0, 1, 15.0, 150.0, 0.0072, 10.0
modes = 1, 2
k = number * 12 * E * side**4 / 12 / h**3
limits = np.array(
    [
        [34, 28, 22, 17, 13, 10.8, 8.5, 6.5, 4.7, 2.35],
        [47, 39, 28, 21, 16, 12.5, 10, 7.5, 5.4, 2.7],
    ]
)

frame = Frame(np.full(storeys, m), k, xi, alpha, n, beta, gamma, rayleigh=modes)
ANSWERS, NUMBERS = answers_and_numbers(frame, D, end, limits)
NUMBERS |= {"storeys": storeys, "number": number, "E": E / 1e9, "side": side, "h": h, "m": m / 1000}
NUMBERS |= {"xi": xi, "alpha": alpha, "A": A, "n": n, "beta": beta, "gamma": gamma, "D": D}
NUMBERS |= {"uy": 1000 / (beta + gamma), "modes": modes}
