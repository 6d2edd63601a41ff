"""Integrals over all frequencies: 2 pi i times the sum of residues in the upper half plane."""

from math import pi, sqrt

import numpy as np
from numpy.polynomial import Polynomial

PROGRAM = "by residues"

Tg, xig, S0 = 0.8, 0.2, 0.01
pair = [(1.0, 0.05), (0.6, 0.02)]


def under(period, damping):
    """``w0^2 - w^2 + 2 i xi w0 w``, what is below the fraction of a frequency response."""
    w0 = 2 * pi / period
    return Polynomial([w0**2, 2j * damping * w0, -1])


def conjugate(polynomial):
    return Polynomial(polynomial.coef.conj())


wg = 2 * pi / Tg
soil = under(Tg, xig)
above = Polynomial([wg**2, 2j * xig * wg]) * Polynomial([wg**2, -2j * xig * wg])


def covariance(one, other):
    """The integral of ``S H1 conj(H2)``; its poles are simple."""
    below = soil * conjugate(soil) * under(*one) * conjugate(under(*other))
    slope = below.deriv()
    poles = [
        p for q in (soil, conjugate(soil), under(*one), conjugate(under(*other))) for p in q.roots()
    ]
    return (S0 * 2j * pi * sum(above(p) / slope(p) for p in poles if p.imag > 0)).real


(var_1, var_2), cross = (covariance(one, one) for one in pair), covariance(*pair)
ANSWERS = {
    "displacement_std_1": sqrt(var_1),
    "displacement_std_2": sqrt(var_2),
    "rho": cross / sqrt(var_1 * var_2),
}
NUMBERS = {
    "Tg": Tg,
    "xig": xig,
    "S0": S0,
    "T1": 1.0,
    "T2": 0.6,
    "xi1": 0.05,
    "xi2": 0.02,
    "cross": cross,
}
assert np.isclose(covariance(*pair), covariance(*pair[::-1]))
