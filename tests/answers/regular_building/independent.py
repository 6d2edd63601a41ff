"""A straight line as the first mode: of n floors, floor i moves by i."""

from math import pi

PROGRAM = "by hand"

n, T, m, C, g = 8, 0.8, 4e5, 0.15, 9.80665
w = 2 * pi / T
# of inertia forces that grow with the height
above = [sum(range(i, n + 1)) for i in range(1, n + 1)]
shear = C * n * m * g  # at the base, at yield
drift = shear / (m * w**2 * above[0])
share = 3 * (n + 1) / (2 * (2 * n + 1))  # (sum i)^2 over n (sum i^2)
roof = 3 * n / (2 * n + 1)  # n (sum i) over (sum i^2)
ANSWERS = {
    "stiffness": [m * w**2 * each for each in above],
    "yield_drift": drift,
    "period": T,
    "mass": share * n * m,
    "yield_displacement": n * drift / roof,
    "participation": [roof * i / n for i in range(1, n + 1)],
}
NUMBERS = {
    **{"n": n, "T": T, "m": m / 1e3, "C": C, "shear": shear / 1e6, "drift": 1e3 * drift},
    **{"share": share, "roof": roof},
}
