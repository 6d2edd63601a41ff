"""Least-squares fits of the logarithms of parameters, from several starts."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from scipy import optimize

from stochlin.kernels.basics.arrays import Array

_INSIDE = 1e-6  # smallest distance of a start from the bounds


def best_fit(
    residual: Callable[[Array], Array],
    starts: Iterable[Array],
    bounds: tuple[Any, Any],
    slope: Callable[[Array], Array] | str = "2-point",
    **options: float,
) -> Any:
    """The fit with the least sum of squares, as `scipy.optimize.least_squares` returns it.

    ``residual`` is a function of the unknowns, ``slope`` that of its derivatives; ``options`` are
    tolerances of the search.
    """
    lower, upper = bounds
    inside = (np.clip(start, lower + _INSIDE, upper - _INSIDE) for start in starts)
    fits = [optimize.least_squares(residual, start, slope, bounds, **options) for start in inside]
    return min(fits, key=lambda fit: float(fit.cost))
