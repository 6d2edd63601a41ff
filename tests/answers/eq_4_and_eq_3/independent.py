"""Eqs. (4) and (3), step by step, and eq. (4) once more as an integral over frequencies."""

from math import pi, sqrt

from scipy.integrate import quad

PROGRAM = "by hand"

T1, T2, xi1, xi2 = 1.0, 0.8, 0.05, 0.03
p1, p2 = 0.12, 0.09  # m
b = T2 / T1
above = 8 * sqrt(xi1 * xi2) * (xi2 + xi1 * b) * b**1.5
below = (1 - b**2) ** 2 + 4 * xi1 * xi2 * b * (1 + b**2) + 4 * (xi1**2 + xi2**2) * b**2
rho = above / below
gap = sqrt(p1**2 + p2**2 - 2 * rho * p1 * p2)
ANSWERS = {"rho": rho, "gap": gap}
NUMBERS = {
    **{"T1": T1, "T2": T2, "xi1": xi1, "xi2": xi2, "p1": p1, "p2": p2},
    **{"b": b, "above": above, "below": below, "srss": sqrt(p1**2 + p2**2)},
}


def response(w, period, damping):
    w0 = 2 * pi / period
    return 1 / (w0**2 - w**2 + 2j * damping * w0 * w)


def covariance(one, other):
    """Even in w, so twice the half; the peaks are told."""
    return sum(
        quad(
            lambda w: 2 * (response(w, *one) * response(w, *other).conjugate()).real,
            a,
            c,
            epsrel=1e-11,
        )[0]
        for a, c in [(0, 5), (5, 7), (7, 9), (9, 60), (60, float("inf"))]
    )


one, other = (T1, xi1), (T2, xi2)
by_integral = covariance(one, other) / sqrt(covariance(one, one) * covariance(other, other))
assert abs(by_integral - rho) < 1e-9
