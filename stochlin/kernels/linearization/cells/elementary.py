"""Functions of numbers that are NaN or infinite where those of the module `math` raise an error.

Compiled code and plain Python give the same bits, since both call the mathematics library of the system.
"""

from __future__ import annotations

import math

from stochlin.kernels.basics.compiled import called_often

LARGEST = 709.0  # of the exponents whose power of e is a number


@called_often
def exp(x):
    """The exponential function."""
    return math.inf if x > LARGEST else math.exp(x)


@called_often
def log(x):
    """The natural logarithm; NaN unless ``x`` is positive and finite."""
    return math.log(x) if 0.0 < x < math.inf else math.nan


@called_often
def atanh(x):
    """The inverse of the hyperbolic tangent; NaN unless ``abs(x) < 1``."""
    return math.atanh(x) if abs(x) < 1.0 else math.nan
