"""The equations of motion of both masses, and scipy's Lyapunov equation."""

from math import nan, pi, sqrt

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

PROGRAM = "by hand, scipy"

T, xi, m, S0 = (1.0, 0.6), (0.05, 0.03), (4e5, 2e5), 0.01
k, c = 4e6, 5e5
M = np.diag(m)
w = 2 * pi / np.array(T)
pull = np.array([[1, -1], [-1, 1]])
K, C = M @ np.diag(w**2) + k * pull, M @ np.diag(2 * np.array(xi) * w) + c * pull
A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
b = np.array([0, 0, 1, 1])
X = solve_continuous_lyapunov(A, -2 * pi * S0 * np.outer(b, b))
d, f = np.array([1, -1, 0, 0]), np.array([k, -k, c, -c])
ANSWERS = {
    "displacement_std": [sqrt(X[0, 0]), sqrt(X[1, 1])],
    "rho": [[nan, X[0, 1] / sqrt(X[0, 0] * X[1, 1])], [nan, nan]],
    "relative_displacement_std": [[nan, sqrt(d @ X @ d)], [nan, nan]],
    "link_force_std": [sqrt(f @ X @ f)],
}
NUMBERS = {"T": T, "xi": xi, "S0": S0, "m": np.array(m) / 1000, "k": k / 1e6, "c": c / 1e6}
