"""Caughey and Stumpf (1961), Trans. ASME 28, for white noise that begins at 0."""

from math import exp, pi, sin, sqrt

PROGRAM = "by hand"

T, xi, S0 = 1.0, 0.05, 0.01
w = 2 * pi / T
wd = w * sqrt(1 - xi**2)
final = pi * S0 / (2 * xi * w**3)


def variances(t):
    """Of displacement and velocity."""
    decay, s, s2, ratio = exp(-2 * xi * w * t), sin(wd * t) ** 2, sin(2 * wd * t), xi * w / wd
    return (
        final * (1 - decay * (1 + 2 * ratio**2 * s + ratio * s2)),
        final * w**2 * (1 - decay * (1 + 2 * ratio**2 * s - ratio * s2)),
    )


times = (0.5, 1.0, 2.0, 6.0)
ANSWERS = {
    "displacement_std": [sqrt(variances(t)[0]) for t in times],
    "velocity_std": [sqrt(variances(t)[1]) for t in times],
}
NUMBERS = {"T": T, "xi": xi, "S0": S0, "final": sqrt(final), "times": times}
