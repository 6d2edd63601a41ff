"""The closed form of an oscillator on white noise."""

from math import pi, sqrt

PROGRAM = "by hand"

T1, T2, xi1, xi2, S0 = 1.0, 0.8, 0.05, 0.03, 0.01
stds = [sqrt(pi * S0 / (2 * xi * (2 * pi / T) ** 3)) for T, xi in ((T1, xi1), (T2, xi2))]
ANSWERS = {"displacement_std": stds}
NUMBERS = {"T1": T1, "T2": T2, "xi1": xi1, "xi2": xi2, "S0": S0}
