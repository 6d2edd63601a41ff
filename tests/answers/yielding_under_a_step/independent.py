"""At the peak the velocity is zero: work of the force = energy of the spring and of yielding."""

from math import pi, sqrt

PROGRAM = "by hand"

T, stiff, alpha, a = 1.0, 0.1, 0.1, 3.2  # s, s, -, m/s^2
w = 2 * pi / T
uy = 4 / w**2  # yields at 4 m/s^2
# a u = w^2 uy^2/2 + w^2 uy x + alpha w^2 x^2/2 with u = uy + x
p, q = 2 * (w**2 * uy - a) / (alpha * w**2), (w**2 * uy**2 - 2 * a * uy) / (alpha * w**2)
x = -p / 2 + sqrt(p**2 / 4 - q)
ANSWERS = {"peak_alone": [uy + x, 2 * a / (2 * pi / stiff) ** 2]}
NUMBERS = {"T": T, "alpha": alpha, "a": a, "uy": 100 * uy, "mu": (uy + x) / uy, "stiff": stiff}
