"""The textbook's loop: quadrature, least squares, scipy's Lyapunov equation, and again."""

from math import erf, exp, pi, sqrt

import numpy as np
from scipy.integrate import quad
from scipy.linalg import solve_continuous_lyapunov

PROGRAM = "by hand, scipy"

T, xi, alpha, uy, S0 = 0.7, 0.05, 0.1, 0.02, 0.02
w = 2 * pi / T
INF = 12.0  # standard deviations


def normal(x):
    return exp(-x * x / 2) / sqrt(2 * pi)


def above(x):
    return (1 - erf(x / sqrt(2))) / 2


def slip(X):
    """``E[s v]`` and ``E[s z]`` of eq. (7): s is v where z > 1 and v > 0, or z < -1 and v < 0."""
    sv, sz = sqrt(X[1, 1]), sqrt(X[2, 2])
    r = X[1, 2] / (sv * sz)
    q = sqrt(1 - r * r)

    def first(t):  # E[v/sv; v > 0 | z = t sz]
        return r * t * above(-r * t / q) + q * normal(r * t / q)

    def second(t):
        return r * t * first(t) + q * q * above(-r * t / q)

    def integral(f):
        return quad(f, 1 / sz, max(INF, 2 / sz), epsabs=1e-15, epsrel=1e-12, limit=200)[0]

    return np.array(
        [
            2 * sv * sv * integral(lambda t: normal(t) * second(t)),
            2 * sv * sz * integral(lambda t: normal(t) * t * first(t)),
        ]
    )


c, k, changes = -1.0, 0.0, 0
X = np.zeros((3, 3))
while True:  # in ductility mu, its rate v, and z: z' = -c v - k z
    A = np.array([[0, 1, 0], [-alpha * w**2, -2 * xi * w, -(1 - alpha) * w**2], [0, -c, -k]])
    if k == 0:  # elastic: z is mu, as long as nothing slips
        A[2] = [0, 1, -1e-6]
    before, X = X, solve_continuous_lyapunov(A, -np.diag([0, 2 * pi * S0 / uy**2, 0]))
    # v - s = -c v - k z in the least squares: (1 + c) E[v v] + k E[v z] = E[s v], and likewise with
    # z.
    c_next, k = np.linalg.solve(X[1:, 1:], slip(X))
    c, changes = c_next - 1, changes + 1
    if np.abs(X - before).max() < 1e-13 * np.abs(X).max() or changes > 2000:
        break

ANSWERS = {
    "ductility_std": sqrt(X[0, 0]),
    "displacement_std": uy * sqrt(X[0, 0]),
    "velocity_std": uy * sqrt(X[1, 1]),
    "z_std": sqrt(X[2, 2]),
    "c_eq": c,
    "k_eq": k,
}
NUMBERS = {"T": T, "xi": xi, "alpha": alpha, "uy": 100 * uy, "S0": S0}
