"""The formulas of pairs for numbers, compiled: the same functions as on arrays."""

from __future__ import annotations

from inspect import isfunction
from typing import Any

from numba.extending import overload, register_jitable

from stochlin.kernels.basics import elementary
from stochlin.kernels.basics.compiled import OFTEN, UNCOMPILED, called_often, entry, variant
from stochlin.kernels.correlation import errors, nearness, pairs, signatures
from stochlin.kernels.linearization import covariance, drift, grounds


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


# The terms in any order, so that several products are added at once.
register_jitable(fastmath={"reassoc"}, **OFTEN)(signatures.product)
ELSEWHERE = pairs.cell, pairs.results, pairs.over_pairs, signatures.product
for _module in (covariance, drift, errors, grounds, nearness, pairs, signatures):
    for _function in vars(_module).values():
        own = isfunction(_function) and _function.__module__ == _module.__name__
        if own and _function not in ELSEWHERE:
            called_often(_function)
called_often(elementary.solve_3x3)
# By the kind of structures; none where nothing is compiled.
WRITERS = {kind: entry(variant(_write, kind.__name__)) for kind in ([] if UNCOMPILED else pairs.PAIRS)}
