"""Correlation of two structures with plastic drift, eq. (8) of ``docs/drift.md``, without a map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from stochlin.analyses.linearization.equivalent_systems import INTERNAL, SHARES, system_and_forcing
from stochlin.analyses.tables.cellwise import Solved, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import by_slabs
from stochlin.kernels.linearization.drift import DriftingSide, drifting_correlation

Side = Sequence[Any]  # the fields of a `DriftingSide` as arrays of numbers
LENGTH = len(INTERNAL) + 3 + len(SHARES)


def side_of(solved: Solved) -> Side:
    """A structure that was solved with the drift closure, for `derived_correlation`."""
    values = [solved[name] for name in (*INTERNAL, "drift_std", "drift_rate", *SHARES)]
    return cellwise(_side, *values, kinds=(float,) * LENGTH)


@np.errstate(all="ignore")  # failed cells are NaN
def _side(*values: Array) -> tuple[Array, ...]:
    end = len(INTERNAL)
    std, rate, *shares = values[end:]
    side = DriftingSide.of(*system_and_forcing(values[:end]), std, rate, shares)
    return tuple(np.broadcast_arrays(*values[:end], side.std, side.unit, side.rate, *side.kicks))


def side_from(values: Sequence[Array]) -> DriftingSide:
    """The structure of the arrays of `side_of`."""
    end = len(INTERNAL)
    std, unit, rate, *kicks = values[end:]
    return DriftingSide(*system_and_forcing(values[:end]), std, unit, rate, kicks)


def derived_correlation(first: Side, second: Side) -> Any:
    """``rho`` of two structures."""
    return cellwise(_rho, *first, *second)[0]


@by_slabs(float)
@np.errstate(all="ignore")  # cells with extreme parameters become NaN, with a status
def _rho(*values: Array) -> Array:
    return drifting_correlation(side_from(values[:LENGTH]), side_from(values[LENGTH:]))
