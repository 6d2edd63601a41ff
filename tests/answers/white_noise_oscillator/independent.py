"""The integrals of the spectrum of the response, from any textbook (Crandall and Mark 1963)."""

from math import pi, sqrt

PROGRAM = "by hand"

T, xi, S0 = 1.0, 0.05, 0.01  # s, -, m^2/s^3 (two-sided, per rad/s)
w = 2 * pi / T
ANSWERS = {
    "displacement_std": sqrt(pi * S0 / (2 * xi * w**3)),
    "velocity_std": sqrt(pi * S0 / (2 * xi * w)),
}
NUMBERS = {"T": T, "xi": xi, "S0": S0, "w": w}
