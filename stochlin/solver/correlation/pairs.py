"""Tables of pairs by statistical linearization, their errors, and the difference of both displacements.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one linear
equation. By the drift closure it has a part of the drifts, and is corrected by a map of simulations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

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
from stochlin.solver.linearization.equivalent_systems import BLANK, Solved, solved_together
from stochlin.solver.linearization.linearization import EXPECTED, OFF, caution_of, judged
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, over_all
from stochlin.solver.tables.checks import Tolerance
from stochlin.solver.tables.lazy import Cells, cellwise

SHOWN = ("displacement_std", "ductility_std", "yield_displacement")
UNKNOWN = (np.nan,) * (BOUNDS.size + 1)  # errors of rho where no pairs were simulated
DIFFERENCE = "relative_displacement"  # start of the names of variables
# Names of the results of `compared_pair` and `drifting_pair`
COMPARED = ("rho", "bias", "bias_error", f"{DIFFERENCE}_std", f"{DIFFERENCE}_bias")
DRIFTING = (
    *("rho", "rho_error", f"{DIFFERENCE}_std", f"{DIFFERENCE}_error", f"{DIFFERENCE}_bias"),
    COUNTED := "counted",
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
    errors = np.array(UNKNOWN if ground.calibration is None else ground.calibration.rho_errors)
    if closure == DRIFT:
        drifts = drifting(solved, tolerance)
        return _table(solved, drifts, partial(drifting_pair, errors), DRIFTING)
    values = solved.values
    system = EquivalentSystem(*values["system"])
    forcing = Forcing(*values["forcing"])
    linear = Linear.of(motion_of(system, forcing), values["displacement_std"])
    if not bias:
        return _table(solved, linear, linear_pair, COMPARED[:1])
    compared = Compared(linear, values["bias"], drifting(solved.by_drift, tolerance))
    return _table(solved, compared, partial(compared_pair, errors), COMPARED)


def _table(
    solved: Solved, structures: Any, function: Callable[..., Any], names: Sequence[str]
) -> dict[str, Cells]:
    """Variables of both structures, and those with these names of all pairs by a ``function``.

    The ``structures`` are those of ``solved`` in one row.
    """
    table = over_all(*(cells.shape for cells in solved.tables))
    places = [cells.places(table) for cells in solved.tables]
    good = (places[0] >= 0) & (places[1] >= 0)
    if not good.all():
        places = [np.broadcast_to(own, good.shape)[good] for own in places]
    places = [own + part.start for own, part in zip(places, solved.parts, strict=True)]
    pair = over_pairs(function, structures, structures, places, len(names))
    columns: dict[str, Array] = dict(zip(names, pair, strict=True))

    def worst(name: str) -> Array:
        return np.maximum(*(solved.values[name][own] for own in places))

    status = worst("status")
    not_physical = (status < labels.NOT_CONVERGED) & np.isnan(columns["rho"])
    columns["status"] = np.where(not_physical, np.int8(labels.NOT_PHYSICAL), status)
    of_sides = [*SHOWN]
    if names == DRIFTING:
        of_sides += ["bias"]
        flag = caution_of(columns["rho_error"], EXPECTED)
        of_difference = caution_of(columns.pop(COUNTED), EXPECTED)
        columns["bias"] = 0 * columns["rho_error"]
    elif names == COMPARED:
        of_sides += ["bias", "bias_error"]
        flag = caution_of(columns["bias"])
        of_difference = caution_of(columns[f"{DIFFERENCE}_bias"])
    if "bias" in columns:
        columns["caution"] = np.maximum(worst("caution"), flag)
        columns[f"{DIFFERENCE}_caution"] = of_difference
    own = [solved.labelled(n, of_sides) for n in (0, 1)]
    sides = {f"{name}_{n}": own[n - 1][name] for name in of_sides for n in (1, 2)}
    pairs = Flat(table, np.flatnonzero(good), {})
    rho, *others = [
        (name, pairs.array(values.ravel(), BLANK.get(name.removeprefix(f"{DIFFERENCE}_"), np.nan)))
        for name, values in columns.items()
    ]
    return dict([rho]) | sides | dict(others)


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
    most = OFF
    if "rho_standard_error" in table:
        shares = [table[f"displacement_std_standard_error_{n}"] / values[n - 1] for n in (1, 2)]
        rest = table["rho_standard_error"] / (1 - table["rho"])
        of_sides = values[0], shares[0], values[1], shares[1]
        kinds = float, float
        off, bias = cellwise(error_of_difference, *of_sides, values[2], rest, 0.0, kinds=kinds)
        most = EXPECTED
    (flag,) = cellwise(caution_of, off, kinds=(np.int8,), most=most)
    std = table.get(f"{DIFFERENCE}_std", std)  # a building with storeys has it already
    return {f"{DIFFERENCE}_std": std, f"{DIFFERENCE}_bias": bias, f"{DIFFERENCE}_caution": flag}
