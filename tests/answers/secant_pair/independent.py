"""Stiffness from the loop's tips, damping from its area; then eq. (4)."""

from math import pi, sqrt

PROGRAM = "by hand"


def effective(T, xi, alpha, mu):
    """For unit stiffness and yield displacement."""
    force = 1 + alpha * (mu - 1)
    secant = force / mu
    # a parallelogram: tips at +-mu, sides with slopes 1 and alpha
    area = 4 * (1 - alpha) * (mu - 1)
    return T / sqrt(secant), xi + area / (4 * pi * (secant * mu**2 / 2))


T, xi, alpha, mu = (1.0, 0.7), (0.05, 0.05), (0.05, 0.1), (4.0, 3.0)
(T1, x1), (T2, x2) = map(effective, T, xi, alpha, mu)
b = T2 / T1
above = 8 * sqrt(x1 * x2) * (x2 + x1 * b) * b**1.5
below = (1 - b**2) ** 2 + 4 * x1 * x2 * b * (1 + b**2) + 4 * (x1**2 + x2**2) * b**2
ANSWERS = {
    **{"period_eq_1": T1, "period_eq_2": T2, "damping_eq_1": x1, "damping_eq_2": x2},
    "rho": above / below,
}
NUMBERS = {"b": b, "above": above, "below": below, "T": T, "xi": xi, "alpha": alpha, "mu": mu}
