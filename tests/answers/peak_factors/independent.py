"""The same spectrum on a fine grid of frequencies, and the calculators of pyrvt."""

from importlib.metadata import version

import numpy as np
from pyrvt.peak_calculators import Davenport1964, DerKiureghian1985, SquaredSpectrum, Vanmarcke1975

PROGRAM = f"pyrvt {version('pyrvt')}"

T, xi, Tg, xig, S0, duration = 0.5, 0.05, 0.4, 0.6, 0.01, 20.0
w0, wg = 2 * np.pi / T, 2 * np.pi / Tg
near = 2 + np.linspace(-1, 1, 400_001) ** 3  # [Hz], crowded about the peak
hertz = np.concatenate(
    [[0], np.geomspace(1e-4, 1, 100_000)[:-1], near, np.geomspace(3, 1e5, 400_000)[1:]]
)
w = 2 * np.pi * hertz
soil = (wg**4 + (2 * xig * wg * w) ** 2) / ((wg**2 - w**2) ** 2 + (2 * xig * wg * w) ** 2)
amplitude = np.sqrt(soil / ((w0**2 - w**2) ** 2 + (2 * xi * w0 * w) ** 2))
m0, m1, m2 = SquaredSpectrum(hertz, amplitude).moments(0, 1, 2)
# The root of the squared amplitude's moment, two-sided per rad/s, is the standard deviation.
std = np.sqrt(2 * np.pi * S0 * m0)
models = [Davenport1964(), DerKiureghian1985(), Vanmarcke1975()]
factors = np.array([model(duration, hertz, amplitude)[1] for model in models])

ANSWERS = {
    "displacement_std": std,
    "crossings": duration * np.sqrt(m2 / m0) / np.pi,
    "bandwidth": np.sqrt(1 - m1**2 / (m0 * m2)),
    "peak_factor": factors,
    "peak_mean": factors * std,
}
NUMBERS = {"T": T, "xi": xi, "Tg": Tg, "xig": xig, "S0": S0, "duration": duration}
