"""Tables of pairs by statistical linearization, their errors, and the difference of displacements.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one
linear equation. By the drift closure it has a part of the drifts, and is corrected by a map of
simulations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.errors import BOUNDS, error_of_difference, std_of_difference
from stochlin.kernels.correlation.pairs import (
    Compared,
    Linear,
    compared_pair,
    drifting_pair,
    linear_pair,
    over_pairs,
)
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, motion_of
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.correlation.signatures import drifting
from stochlin.solver.linearization.equivalent_systems import (
    STRUCTURE_VARIABLES,
    VALUES_IF_INVALID,
    Solved,
    solved_together,
)
from stochlin.solver.linearization.linearization import DOUBTFUL_BIAS, EXPECTED, caution_of, judged
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, over_all
from stochlin.solver.tables.checks import Tolerance
from stochlin.solver.tables.lazy import Cells, cellwise

UNKNOWN = (np.nan,) * (BOUNDS.size + 1)  # errors of rho where no pairs were simulated
DIFFERENCE = "relative_displacement"  # start of the names of variables
COUNTED_ERROR = "counted"  # error of the difference that counts in its caution
# Names of the results of `compared_pair` and `drifting_pair`
COMPARED = ("rho", "bias", "bias_error", f"{DIFFERENCE}_std", f"{DIFFERENCE}_bias")
DRIFTING = (
    "rho",
    "rho_error",
    f"{DIFFERENCE}_std",
    f"{DIFFERENCE}_error",
    f"{DIFFERENCE}_bias",
    COUNTED_ERROR,
)


def linearized_pairs(
    pair: tuple[Structure, Structure],
    ground: Ground,
    closure: str,
    tolerance: Tolerance,
    bias: bool,
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization, with those of the bias if asked for."""
    solve = judged if bias or closure == DRIFT else solved_together
    solved = solve(pair, ground, closure, tolerance)
    pairs = _Pairs.of(solved)
    errors = np.array(UNKNOWN if ground.calibration is None else ground.calibration.rho_errors)
    if closure == DRIFT:
        drifts = drifting(solved, tolerance)
        columns = pairs.columns(partial(drifting_pair, errors), drifts, DRIFTING)
        counted = columns.pop(COUNTED_ERROR)
        columns["bias"] = np.where(np.isnan(columns["rho_error"]), np.nan, 0.0)
        columns["caution"] = pairs.worst("caution", caution_of(columns["rho_error"], EXPECTED))
        columns[f"{DIFFERENCE}_caution"] = caution_of(counted, EXPECTED)
        return pairs.labelled(columns, (*STRUCTURE_VARIABLES, "bias"))
    system = EquivalentSystem(*solved.values["system"])
    forcing = Forcing(*solved.values["forcing"])
    linear = Linear.of(motion_of(system, forcing), solved.values["displacement_std"])
    if not bias:
        return pairs.labelled(pairs.columns(linear_pair, linear, ("rho",)), STRUCTURE_VARIABLES)
    compared = Compared(linear, solved.values["bias"], drifting(solved.by_drift, tolerance))
    columns = pairs.columns(partial(compared_pair, errors), compared, COMPARED)
    columns["caution"] = pairs.worst("caution", caution_of(columns["bias"]))
    columns[f"{DIFFERENCE}_caution"] = caution_of(columns[f"{DIFFERENCE}_bias"])
    return pairs.labelled(columns, (*STRUCTURE_VARIABLES, "bias", "bias_error"))


class _Pairs(NamedTuple):
    """Pairs of the structures of two tables that are solved together in one row."""

    solved: Solved
    table: xr.DataArray  # with the cells of both
    good: Array  # cells in which both structures are valid
    places: list[Array]  # of both structures of good cells, in the row

    @classmethod
    def of(cls, solved: Solved) -> _Pairs:
        """All pairs of a table."""
        table = over_all(*(cells.shape for cells in solved.tables))
        places = [cells.places(table) for cells in solved.tables]
        good = (places[0] >= 0) & (places[1] >= 0)
        if not good.all():
            places = [np.broadcast_to(place, good.shape)[good] for place in places]
        places = [place + part.start for place, part in zip(places, solved.parts, strict=True)]
        return cls(solved, table, good, places)

    def columns(
        self, function: Callable[..., Any], structures: Any, names: Sequence[str]
    ) -> dict[str, Array]:
        """Results of a ``function`` of pairs of these structures, by name, and the status."""
        results = over_pairs(function, structures, structures, self.places, len(names))
        columns: dict[str, Array] = dict(zip(names, results, strict=True))
        status = self.worst("status")
        not_physical = (status < labels.NOT_CONVERGED) & np.isnan(columns["rho"])
        columns["status"] = np.where(not_physical, np.int8(labels.NOT_PHYSICAL), status)
        return columns

    def worst(self, name: str, flags_of_pairs: Array | None = None) -> Array:
        """The largest flag of both structures, and of their pair."""
        flags = self.solved.values[name]
        worst = np.maximum(flags[self.places[0]], flags[self.places[1]])
        return worst if flags_of_pairs is None else np.maximum(worst, flags_of_pairs)

    def labelled(self, columns: dict[str, Array], names: Sequence[str]) -> dict[str, Cells]:
        """The variables of the table: rho, those of both structures, and the others."""
        variables = [self.solved.labelled(n, names) for n in (0, 1)]
        sides = {f"{name}_{n}": variables[n - 1][name] for name in names for n in (1, 2)}
        pairs = Flat(self.table, np.flatnonzero(self.good), {})
        arrays = {
            name: pairs.array(
                values.ravel(), VALUES_IF_INVALID.get(name.removeprefix(f"{DIFFERENCE}_"), np.nan)
            )
            for name, values in columns.items()
        }
        return {"rho": arrays.pop("rho")} | sides | arrays


@np.errstate(all="ignore")  # equal structures give 0/0, failed cells are NaN
def difference(table: Mapping[Any, Cells]) -> dict[str, Cells]:
    """Standard deviation of ``u_1 - u_2`` of a table of pairs, with its bias and its caution.

    Bias and caution follow from the standard errors of simulations; without these they are unknown.
    Nothing is added to a table that has them.
    """
    if f"{DIFFERENCE}_caution" in table:
        return {}
    values = [table[name] for name in ("displacement_std_1", "displacement_std_2", "rho")]
    (std,) = cellwise(std_of_difference, *values)
    bias = std * np.nan
    off = std * np.nan
    limit = DOUBTFUL_BIAS
    if "rho_standard_error" in table:
        shares = [table[f"displacement_std_standard_error_{n}"] / values[n - 1] for n in (1, 2)]
        rest = table["rho_standard_error"] / (1 - table["rho"])
        arguments = values[0], shares[0], values[1], shares[1], values[2], rest, 0.0
        kinds = float, float
        off, bias = cellwise(error_of_difference, *arguments, kinds=kinds)
        limit = EXPECTED
    (flag,) = cellwise(caution_of, off, kinds=(np.int8,), most=limit)
    std = table.get(f"{DIFFERENCE}_std", std)  # a building with storeys has it already
    return {f"{DIFFERENCE}_std": std, f"{DIFFERENCE}_bias": bias, f"{DIFFERENCE}_caution": flag}
