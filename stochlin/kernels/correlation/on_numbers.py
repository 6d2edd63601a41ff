"""The formulas of pairs for numbers, compiled: the same functions as on arrays."""

from __future__ import annotations

import math
from inspect import isfunction
from typing import Any

import numpy as np
from numba.extending import overload, register_jitable

from stochlin.kernels.basics import elementary
from stochlin.kernels.basics.compiled import OFTEN, UNCOMPILED, called_often, entry, variant
from stochlin.kernels.correlation import errors, nearness, pairs, signatures
from stochlin.kernels.linearization import covariance, drift, gaussian, grounds
from stochlin.kernels.linearization import single_structures as structures

ROOT_HALF = math.sqrt(0.5)
REACH = 7.75  # standard deviations beyond which the integrand is left out; the relative error is 1e-14
_X, _W = np.polynomial.legendre.leggauss(36)
NODES = tuple((float(x) ** 2, float(w)) for x, w in zip(_X[18:], _W[18:], strict=True))


def _write(first, second, places_1, places_2, errors, out):
    """Write the results of pairs to ``out`` (k, n), pair by pair."""
    for n in range(places_1.size):
        row = pairs.results(pairs.cell(first, places_1[n]), pairs.cell(second, places_2[n]), errors)
        for k in range(len(row)):
            out[k, n] = row[k]


@overload(pairs.results, jit_options=OFTEN)
def _results_of(first, second, errors):
    function = pairs.PAIRS[first.instance_class][0]

    return lambda first, second, errors: function(first, second, errors)  # noqa: PLW0108  # no types


@overload(pairs.cell, jit_options=OFTEN)
def _cell(structures, place):
    dimensions = getattr(structures, "ndim", 0)
    if dimensions == 1:
        return lambda structures, place: structures[place]
    if dimensions == 2:
        return lambda structures, place: structures[:, place]
    kind = structures.instance_class
    return lambda structures, place: kind(*_cells(structures, place))


def _cells(parts: Any, place: Any) -> Any:
    """`pairs.cell` of each part of a tuple, in a tuple."""


@overload(_cells, jit_options=OFTEN)
def _cells_of(parts, place):
    if not len(parts):
        return lambda parts, place: ()
    return lambda parts, place: (pairs.cell(parts[0], place), *_cells(parts[1:], place))


@overload(elementary.choose, jit_options=OFTEN)
def _choose(condition, yes, no):
    return lambda condition, yes, no: yes if condition else no


@overload(elementary.ndtr, jit_options=OFTEN)
def _ndtr(x):
    return lambda x: 0.5 * math.erfc(-x * ROOT_HALF)


@overload(elementary.owens_t)
def _owens_t(h, a):
    def by_quadrature(h, a):
        """By Gauss-Legendre quadrature; for ``a > 1`` from ``T(a h, 1/a)``."""
        size = abs(a)
        steep = size > 1
        eta, length = (h * size, 1 / size) if steep else (h, size)
        length = min(length, REACH / eta)
        total = 0.0
        for square, weight in NODES:
            x = length * length * square
            total += weight * math.exp(-0.5 * eta * eta * (1 + x)) / (1 + x)
        part = total * length / (2 * math.pi)
        if steep:
            tail, beside = 0.5 * math.erfc(h * ROOT_HALF), 0.5 * math.erfc(eta * ROOT_HALF)
            part = 0.5 * (tail + beside) - tail * beside - part
        return part if a > 0 else -part

    return by_quadrature


# The terms in any order, so that several products are added at once.
register_jitable(fastmath={"reassoc"}, **OFTEN)(signatures.product)
ELSEWHERE = pairs.cell, pairs.results, pairs.over_pairs, signatures.product
for _module in (covariance, drift, errors, gaussian, grounds, nearness, pairs, signatures, structures):
    for _function in vars(_module).values():
        own = isfunction(_function) and _function.__module__ == _module.__name__
        if own and _function not in ELSEWHERE:
            called_often(_function)
called_often(elementary.solve_3x3)
# By the kind of structures; none where nothing is compiled.
WRITERS = {kind: entry(variant(_write, kind.__name__)) for kind in ([] if UNCOMPILED else pairs.PAIRS)}
