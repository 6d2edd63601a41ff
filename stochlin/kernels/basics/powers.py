"""Exponentials, logarithms and powers of which the compiler makes vector instructions.

Those of the mathematics library are called number by number, which takes four times as long.
Polynomials are sums of parts that do not wait for one another. The errors are those of rounding:
relatively 3e-16 in the logarithm, and ``1e-16 (1 + |exponent log x|)`` in a power.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import called_often

# log 2 in two parts, of which the first has so few digits that its products with whole numbers are
# exact
LOG_2 = 6.93147180369123816490e-01
LOG_2_REST = 1.90821492927058770002e-10
# 1.5 * 2^52: adding it rounds to whole numbers, kept in the lowest digits
SHIFT = 6755399441055744.0
SHIFT_BITS = int(np.float64(SHIFT).view(np.int64))
ROOT_HALF_BITS = int(np.float64(np.sqrt(0.5)).view(np.int64))
# beyond, the exponential is zero or infinite, or nearly so
SMALLEST_EXPONENT = -708.0
LARGEST_EXPONENT = 709.0
SMALLEST_NORMAL = 2.2250738585072014e-308  # the smallest normal number


@called_often
def exponential(x):
    """``e^x``; beyond the range of numbers that at the end of the range."""
    x = min(max(x, SMALLEST_EXPONENT), LARGEST_EXPONENT)
    shifted = x * 1.4426950408889634 + SHIFT
    whole = shifted - SHIFT
    r = (x - whole * LOG_2) - whole * LOG_2_REST  # |r| <= (log 2)/2: 12 terms of the series
    s = r * r
    low = (0.5 + r * (1 / 6)) + s * (1 / 24 + r * (1 / 120))
    middle = (1 / 720 + r * (1 / 5040)) + s * (1 / 40320 + r * (1 / 362880))
    high = (1 / 3628800 + r * (1 / 39916800)) + s * (1 / 479001600)
    series = 1.0 + (r + s * (low + s * s * (middle + s * s * high)))
    power = (np.float64(shifted).view(np.int64) + 1023) << 52
    return series * np.int64(power).view(np.float64)


@called_often
def logarithm(x):
    """``log x`` of a positive number.

    With ``x = 2^k (1 + f)`` and ``s = f/(2 + f)`` it is ``k log 2 + 2 artanh s``. The polynomial is
    the one of the FreeBSD mathematics library (e_log.c, Sun Microsystems 1993).
    """
    bits = np.float64(max(x, SMALLEST_NORMAL)).view(np.int64)
    k = (bits - ROOT_HALF_BITS) >> 52
    f = np.int64(bits - (k << 52)).view(np.float64) - 1.0
    number = np.int64(k + SHIFT_BITS).view(np.float64) - SHIFT
    s = f / (2.0 + f)
    w = s * s
    q = w * w
    even = 0.3999999999940941908 + q * (0.2222219843214978396 + q * 0.1531383769920937332)
    high = 0.2857142874366239149 + q * (0.1818357216161805012 + q * 0.1479819860511658591)
    series = w * (0.6666666666666735130 + q * high) + q * even
    half = 0.5 * f * f
    return number * LOG_2 - ((half - (s * (half + series) + number * LOG_2_REST)) - f)


@called_often
def power(x, exponent):
    """``x^exponent`` of a number of at least zero."""
    value = exponential(exponent * logarithm(x))
    of_zero = np.inf if exponent < 0.0 else (1.0 if exponent == 0.0 else 0.0)
    return value if x > 0.0 else of_zero
