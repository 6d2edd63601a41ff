"""Elementary functions in plain arithmetic, so that loops over lanes with them become vector code.

Their relative errors are a few units in the last place, those of `tanh` absolute ones. Compiled code and
plain Python give the same bits.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.extending import overload

from stochlin.kernels.basics.compiled import OFTEN, called_often

LOG2_E = 1 / math.log(2)
LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10  # ln 2 in two parts
ROUND = 1.5 * 2.0**52  # added to a number, it leaves the nearest integer in the last digits
LEAST = -700.0  # below it the exponential function is taken as 0
SHORT = 0.17  # up to here the series of atanh is short
ROOT_HALF = math.sqrt(0.5)
BITS_OF_ONE, BITS_OF_ROOT_HALF, BITS_OF_2_52 = (
    int(np.float64(number).view(np.int64)) for number in (1.0, ROOT_HALF, 2.0**52)
)
OF_EXP = tuple(1 / math.factorial(n) for n in range(13, -1, -1))
OF_ATANH = tuple(1 / (2 * n + 1) for n in range(11, -1, -1))
MIDDLE = 3.75  # where the variable (x - MIDDLE)/(x + MIDDLE) of the polynomial for erfcx is 0

# Its even and its odd terms, the highest first: Chebyshev interpolation of (1 + 2 x) erfcx(x).
EVEN = (
    -2.7293941332533855e-09,
    3.256499083798513e-08,
    -2.4996538037405243e-07,
    1.7438577411359181e-06,
    -1.143961526007595e-05,
    5.164737123871838e-05,
    0.00029371408777227685,
    -0.00974657962081509,
    -0.058693398584491845,
    -0.10880393014193915,
    0.0035854154854663067,
    1.2375126308378275,
)
ODD = (
    -1.952790162974837e-09,
    1.8778501156468795e-08,
    -5.0816911811698186e-08,
    -9.79297529099823e-07,
    2.238759272534769e-05,
    -0.0002901553656394713,
    0.0017556261692276722,
    0.028362277371370044,
    0.09230432116435616,
    0.08227673848999159,
    -0.14024059858554522,
)


@called_often
def exp(x):
    """The exponential function, for ``x`` below 700."""
    rounded = x * LOG2_E + ROUND
    n = rounded - ROUND
    value = _polynomial(OF_EXP, (x - n * LN2_HIGH) - n * LN2_LOW)
    return 0.0 if x < LEAST else scaled(value, rounded)


@called_often
def log(x):
    """The natural logarithm; NaN unless ``x`` is positive and finite."""
    factor, exponent = split(x)
    part = (factor - 1) / (factor + 1)
    value = exponent * LN2_HIGH + (2 * part * _polynomial(OF_ATANH, part * part) + exponent * LN2_LOW)
    return value if 0.0 < x < math.inf else math.nan


@called_often
def atanh(x):
    """The inverse of the hyperbolic tangent; NaN unless ``abs(x) < 1``."""
    ratio = (1 + x) / (1 - x)
    factor, exponent = split(ratio)
    part = x if abs(x) < SHORT else (factor - 1) / (factor + 1)  # the exponent is then 0
    value = part * _polynomial(OF_ATANH, part * part) + exponent * (0.5 * LN2_LOW)
    value = exponent * (0.5 * LN2_HIGH) + value
    return value if abs(x) < 1.0 else math.nan


@called_often
def tanh(x):
    """The hyperbolic tangent."""
    fall = exp(-2 * abs(x))
    value = (1 - fall) / (1 + fall)
    return value if x > 0 else -value


@called_often
def erfcx(x):
    """``exp(x^2) erfc(x)`` for ``x >= 0`` (Shepherd and Laframboise 1981, Math. Comput. 36)."""
    t = (x - MIDDLE) / (x + MIDDLE)
    return (_polynomial(EVEN, t * t) + t * _polynomial(ODD, t * t)) / (1 + 2 * x)


@called_often
def _polynomial(coefficients, x):
    """The polynomial with these coefficients, the highest first."""
    value = 0.0
    for coefficient in coefficients:
        value = value * x + coefficient
    return value


def scaled(value: Any, rounded: Any) -> Any:
    """``value`` times two to the power of the integer ``rounded - ROUND``."""
    return math.ldexp(value, int(rounded - ROUND))


@overload(scaled, jit_options=OFTEN)
def _scaled_in_code(value, rounded):
    def by_bits(value, rounded):
        power = np.float64(rounded).view(np.int64) << 52
        return np.int64(np.float64(value).view(np.int64) + power).view(np.float64)

    return by_bits


def split(x: Any) -> Any:
    """A factor of ``x > 0`` between the roots of 1/2 and 2, and the exponent of 2 of the other one."""
    factor, exponent = math.frexp(x)
    return (2 * factor, exponent - 1.0) if factor < ROOT_HALF else (factor, float(exponent))


@overload(split, jit_options=OFTEN)
def _split_in_code(x):
    def by_bits(x):
        raised = np.uint64(np.float64(x).view(np.uint64) + np.uint64(BITS_OF_ONE - BITS_OF_ROOT_HALF))
        exponent = np.uint64((raised >> np.uint64(52)) | np.uint64(BITS_OF_2_52))
        factor = np.uint64((raised & np.uint64(2**52 - 1)) + np.uint64(BITS_OF_ROOT_HALF))
        return factor.view(np.float64), exponent.view(np.float64) - (2.0**52 + 1023)

    return by_bits
