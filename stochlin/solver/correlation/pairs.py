"""Tables of pairs by statistical linearization, and their errors.

Each structure is solved over its own dimensions. The covariance of a pair then follows from one linear
equation. By the drift closure it has a part of the drifts, and is corrected by a map of simulations.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.correlation.pairs import (
    Compared,
    ComparedPair,
    DriftingPair,
    Linear,
    LinearPair,
    compared_pair,
    drifting_pair,
    linear_pair,
    over_pairs,
)
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.correlation.errors import DIFFERENCE, errors_on
from stochlin.solver.correlation.signatures import drifting
from stochlin.solver.linearization.bias import EXPECTED, caution_of, judged
from stochlin.solver.linearization.equivalent_systems import BLANK, Solved, solved_together
from stochlin.solver.linearization.tolerance import Tolerance
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, over_all
from stochlin.solver.tables.cellwise import Cells

SHOWN = ("displacement_std", "ductility_std", "yield_displacement")


def linearized_pairs(
    pair: tuple[Structure, Structure],
    ground: Ground,
    closure: str,
    tolerance: Tolerance,
    bias: bool,
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization, with those of the bias if asked for."""
    solve = judged if bias or closure == DRIFT else solved_together
    solved, errors = solve(pair, ground, closure, tolerance), errors_on(ground)
    if closure == DRIFT:
        drifts = drifting(solved, tolerance)
        return _table(solved, drifts, partial(drifting_pair, errors), DriftingPair)
    values = solved.values
    system, forcing = EquivalentSystem(*values["system"]), Forcing(*values["forcing"])
    linear = Linear(system, forcing, values["displacement_std"])
    if not bias:
        return _table(solved, linear, linear_pair, LinearPair)
    compared = Compared(linear, values["bias"], drifting(solved.by_drift, tolerance))
    return _table(solved, compared, partial(compared_pair, errors), ComparedPair)


def _table(
    solved: Solved, structures: Any, function: Callable[..., Any], kind: type[Any]
) -> dict[str, Cells]:
    """Variables of both structures, and of all pairs by a ``function`` with results of this kind.

    The ``structures`` are those of ``solved`` in one row.
    """
    table = over_all(*(cells.shape for cells in solved.tables))
    places = [cells.places(table) for cells in solved.tables]
    good = (places[0] >= 0) & (places[1] >= 0)
    if not good.all():
        places = [np.broadcast_to(own, good.shape)[good] for own in places]
    places = [own + part.start for own, part in zip(places, solved.parts, strict=True)]
    pair = kind(*over_pairs(function, structures, structures, places, len(kind._fields)))

    def worst(name: str) -> Array:
        return np.maximum(*(solved.values[name][own] for own in places))

    status = worst("status")
    not_physical = (status < labels.NOT_CONVERGED) & np.isnan(pair.rho)
    columns = {"rho": pair.rho, "status": np.where(not_physical, np.int8(labels.NOT_PHYSICAL), status)}
    names = [*SHOWN]
    if isinstance(pair, ComparedPair):
        names += ["bias", "bias_error"]
        flag, of_difference = caution_of(pair.bias), caution_of(pair.difference_bias)
        columns |= {"bias": pair.bias, "bias_error": pair.error}
    elif isinstance(pair, DriftingPair):
        names += ["bias"]
        flag, of_difference = caution_of(pair.error, EXPECTED), caution_of(pair.counted, EXPECTED)
        columns |= {"rho_error": pair.error, "bias": 0 * pair.error}
        columns[f"{DIFFERENCE}_error"] = pair.difference_error
    if not isinstance(pair, LinearPair):
        columns["caution"] = np.maximum(worst("caution"), flag)
        columns[f"{DIFFERENCE}_std"] = pair.difference
        columns[f"{DIFFERENCE}_bias"] = pair.difference_bias
        columns[f"{DIFFERENCE}_caution"] = of_difference
    own = [solved.labelled(n, names) for n in (0, 1)]
    of_sides = {f"{name}_{n}": own[n - 1][name] for name in names for n in (1, 2)}
    pairs = Flat(table, np.flatnonzero(good), {})
    rho, *others = [
        (name, pairs.array(values.ravel(), BLANK.get(name.removeprefix(f"{DIFFERENCE}_"), np.nan)))
        for name, values in columns.items()
    ]
    return dict([rho]) | of_sides | dict(others)
