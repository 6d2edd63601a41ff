"""The response to a ramp from any textbook (Chopra), and once more, later, taken off."""

from math import cos, exp, hypot, pi, sin, sqrt

PROGRAM = "by hand"

T, xi, rate, t1 = 0.8, 0.05, 2.0, 0.5  # s, -, m/s^3, s
w = 2 * pi / T
wd = w * sqrt(1 - xi**2)


def ramp(t):
    """Displacement and velocity under ``rate t``."""
    if t <= 0:
        return 0.0, 0.0
    decay, c, s = exp(-xi * w * t), cos(wd * t), sin(wd * t)
    u = t - 2 * xi / w + decay * (2 * xi / w * c - (1 - 2 * xi**2) / wd * s)
    v = 1 - decay * (c + xi * w / wd * s)
    return rate / w**2 * u, rate / w**2 * v


times = (0.2, 0.4, 0.8, 1.5)
states = [[a - b for a, b in zip(ramp(t), ramp(t - t1), strict=True)] for t in times]
ANSWERS = {
    "displacement": [u for u, _ in states],
    "velocity": [v for _, v in states],
    "radius": [hypot(u, v / w) for u, v in states],
}
NUMBERS = {"T": T, "xi": xi, "rate": rate, "t1": t1, "w": w, "wd": wd}
