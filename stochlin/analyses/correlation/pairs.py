"""Tables of pairs by statistical linearization, and their errors.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one linear
equation. By the drift closure it has a part of the drifts, and is corrected by a map of simulations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.errors import (
    DIFFERENCE,
    doubt_of,
    errors_on,
    mean_error,
    relative_error,
)
from stochlin.analyses.correlation.signatures import drifting_side, insights
from stochlin.analyses.linearization.bias import (
    EXPECTED,
    bilinear_like,
    caution_of,
    judged,
    relative_bias,
)
from stochlin.analyses.linearization.drift_map import simulated
from stochlin.analyses.linearization.equivalent_systems import (
    STRENGTH_RATIO,
    Solved,
    solved_together,
)
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import Flat, over_all
from stochlin.analyses.tables.cellwise import Cells
from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.correlation.nearness import Nearness, with_nearness
from stochlin.kernels.correlation.signatures import Insight, informed_correlation
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, pair_covariance
from stochlin.kernels.linearization.drift import DriftingSide, drifting_correlation
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, Structure

Pair = tuple[Structure, Structure]
SHOWN = ("displacement_std", "ductility_std", "yield_displacement")
RHO: dict[str, Any] = {"rho": float, "status": np.int8}
UNKNOWN = len(labels.CAUTION_MEANINGS) - 1  # the caution of what is not known
EQUAL = 1e-12  # difference of two correlations that is a rounding error
ROUNDING = 1e-9  # by which |rho| may exceed 1 by rounding; beyond it the covariance is invalid
# Logarithm of the ratio of the periods from which the margin of eq. (13) counts in the caution. Of pairs
# with more similar periods, the difference comes from strength, hardening and damping alone, and its
# estimate is less certain.
ALIKE = 0.015


class Side(NamedTuple):
    """What the correlation of two linearized structures takes of each; cells are the last axes."""

    std: Array
    system: EquivalentSystem
    forcing: Forcing
    status: Array
    caution: Array  # of the displacement

    @classmethod
    def of(cls, solved: Solved) -> Side:
        """All cells of structures in one row."""
        values = solved.values
        system, forcing = EquivalentSystem(*values["system"]), Forcing(*values["forcing"])
        status = values["status"]
        return cls(values["displacement_std"], system, forcing, status, values.get("caution", status))


class DriftSide(NamedTuple):
    """What the correlation of two structures by the drift closure takes of each."""

    period: Array
    std: Array  # corrected by simulations
    error: Array  # its expected relative error
    status: Array
    strength: Array  # R/p
    known: Array  # whether the structure and the ground are within the simulated ranges
    elastic: Array
    drifting: DriftingSide
    insight: Insight | None
    nearness: Nearness | None

    @classmethod
    def of(cls, solved: Solved, tolerance: Tolerance) -> DriftSide:
        """All cells of structures in one row."""
        values, cells = solved.values, solved.oscillators
        side = drifting_side(values)
        return cls(
            cells.period,
            values["displacement_std"],
            values["displacement_error"],
            values["status"],
            values[STRENGTH_RATIO],
            simulated(solved.ground, solved.point, cells.soil),
            np.isinf(values["yield_displacement"]),
            side,
            *insights(solved, side, tolerance),
        )


def linearized_pairs(
    pair: Pair, ground: Ground, closure: str, tolerance: Tolerance, bias: bool
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization, except those of ``u_1 - u_2``."""
    solved = solved_together(pair, ground, closure, tolerance)
    if not bias:
        return _table(solved, SHOWN, RHO, _linear, Side.of(solved))
    truth, true = bilinear_like(solved, DRIFT, tolerance), None
    known = all(isinstance(structure, Bilinear) or not structure.yields for structure in pair)
    if known and any(structure.yields for structure in pair):
        true = DriftSide.of(truth, tolerance)
    more = relative_bias(solved, truth, tolerance)
    solved = solved._replace(values={**solved.values, **more})
    kinds = RHO | {"bias": float, "bias_error": float, "caution": np.int8}
    function = partial(_with_bias, values=errors_on(ground), known=known)
    return _table(solved, (*SHOWN, "bias", "bias_error"), kinds, function, Side.of(solved), true)


def drifting_pairs(pair: Pair, ground: Ground, tolerance: Tolerance) -> dict[str, Cells]:
    """Table of pairs by the drift closure, with the expected errors that remain after the correction."""
    solved = judged(solved_together(pair, ground, DRIFT, tolerance), DRIFT, tolerance)
    of_difference = {f"{DIFFERENCE}_{name}": float for name in ("error", "bias")}
    flags: dict[str, Any] = {f"{DIFFERENCE}_caution": np.int8, "caution": np.int8}
    kinds = RHO | {"rho_error": float, "bias": float} | of_difference | flags
    function = partial(_judged, values=errors_on(ground))
    return _table(solved, (*SHOWN, "bias"), kinds, function, DriftSide.of(solved, tolerance))


def _table(
    solved: Solved,
    names: Sequence[str],
    kinds: Mapping[str, Any],
    function: Callable[..., Any],
    *rows: Any,
) -> dict[str, Cells]:
    """Variables of both structures, and those of pairs, which a ``function`` of sides computes.

    Each of the ``rows`` has sides of both structures, one after the other; or there are none.
    """
    table = over_all(*(cells.shape for cells in solved.tables))
    sides = [
        on_arrays(partial(_beside, cells, part, table), each)
        for each in rows
        for part, cells in zip(solved.parts, solved.tables, strict=True)
    ]
    results = in_slabs(function, *sides, kinds=[*kinds.values()], shape=table.shape)
    labelled = [xr.DataArray(x, table.coords, table.dims) if x.ndim else x for x in results]
    own = [solved.labelled(n, names) for n in (0, 1)]
    of_sides = {f"{name}_{n}": own[n - 1][name] for name in names for n in (1, 2)}
    return {"rho": labelled[0], **of_sides, **dict(zip(kinds, labelled, strict=True))}


def _beside(cells: Flat, part: slice, table: xr.DataArray, values: Array) -> Array:
    """Values of some of all cells, with the axes of the table of pairs."""
    return cells.beside(values[..., part], table)


@np.errstate(all="ignore")  # cells with extreme parameters get a status
def _linear(first: Side, second: Side) -> tuple[Array, Array]:
    joint = pair_covariance(first.system, first.forcing, second.system, second.forcing)
    return checked_rho(joint / (first.std * second.std), first.status, second.status)


@np.errstate(all="ignore")
def _with_bias(
    first: Side, second: Side, *true: DriftSide | None, values: Array, known: bool
) -> tuple[Array, ...]:
    """``rho`` and its status, bias, the error of the truth, and the caution of a pair.

    The truth of two elastic structures is ``rho`` itself; that of other laws is not ``known``.
    """
    rho, status = _linear(first, second)
    exact, error = (rho, 0 * rho) if known else (np.nan, np.nan)
    if true[0] is not None and true[1] is not None:
        exact, _, error, _, _ = _drifting(true[0], true[1], values)
    bias = np.where(np.abs(rho - exact) < EQUAL, 0.0, rho - exact) + 0 * error
    worst = np.maximum(np.maximum(first.caution, second.caution), caution_of(bias))
    return rho, status, bias, error + 0 * bias, np.where(np.isnan(bias), UNKNOWN, worst)


@np.errstate(all="ignore")
def _drifting(first: DriftSide, second: DriftSide, values: Array) -> tuple[Array, ...]:
    """``rho`` of pairs, status, expected error of both and of ``1 - rho``, and weight of eq. (13).

    ``values`` are `errors_on` this ground.
    """
    rho, share = drifting_correlation(first.drifting, second.drifting), np.zeros(())
    if first.nearness is not None and second.nearness is not None:
        unseen: Array | float = 1.0
        if first.insight is not None and second.insight is not None:
            rho = informed_correlation(rho, first.insight, second.insight)
            unseen = first.insight.left * second.insight.left
        rho, share = with_nearness(rho, first.nearness, second.nearness, unseen)
    doubt = doubt_of(rho, share, first.strength, second.strength)
    rho, status = checked_rho(rho, first.status, second.status)
    error = mean_error(values, first.strength, second.strength)
    error = np.where(first.known & second.known, error, np.nan)
    error = np.where(first.elastic & second.elastic, 0.0, error) + 0 * rho
    return rho, status, error, doubt, share


@np.errstate(all="ignore")
def _judged(first: DriftSide, second: DriftSide, *, values: Array) -> tuple[Array, ...]:
    """Variables of `drifting_pairs`.

    The caution of ``u_1 - u_2`` is that of its error less half of the bias to the safe side, if the
    periods differ. Its error is 0 if both structures are elastic.
    """
    rho, status, error, doubt, share = _drifting(first, second, values)
    apart, lean = relative_error(first.std, first.error, second.std, second.error, rho, doubt, share)
    apart = np.where(error == 0, 0.0, apart + 0 * error)
    lean = lean + 0 * apart
    unlike = np.abs(np.log(first.period / second.period)) >= ALIKE
    flag = caution_of(apart - np.where(unlike, lean / 2, 0.0), EXPECTED)
    worst = [caution_of(off, EXPECTED) for off in (error, first.error, second.error)]
    return rho, status, error, 0 * error, apart, lean, flag, np.maximum(np.maximum(*worst[:2]), worst[2])


def checked_rho(rho: Array, status_1: Array, status_2: Array) -> tuple[Array, Array]:
    """``rho`` of pairs, NaN where one side failed or its size exceeds 1, and the status."""
    status = np.maximum(status_1, status_2)
    wrong = (status < labels.NOT_CONVERGED) & ~(np.abs(rho) <= 1 + ROUNDING)
    status = np.where(wrong, labels.NOT_PHYSICAL, status)
    return np.where(status < labels.NOT_CONVERGED, np.clip(rho, -1, 1), np.nan), status
