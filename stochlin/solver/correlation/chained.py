"""Table of pairs by the augmented state space: the chain of eqs. (5) to (12) for every cell.

The state matrix of both structures and the ground is formed for each cell, its Lyapunov equation is
solved, and the coefficients are renewed until both stand still, without the closed forms of
`linearized`.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce

import numpy as np

from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure
from stochlin.solver.correlation.pairs import SHOWN
from stochlin.solver.linearization.systems.systems import (
    check_chain,
    equations_of_cells,
    solution_table,
    solve_equations,
)
from stochlin.solver.linearization.tolerance import Tolerance
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import flat
from stochlin.solver.tables.cellwise import Cells, cellwise
from stochlin.solver.tables.floors import ELEMENT, FLOOR

OF_PAIR = ("rho", *SHOWN)
LAST = "displacement_std", "ductility_std", "yield_drift"  # what `SHOWN` is of the last structure


def chained_pairs(
    pair: tuple[Structure, Structure], ground: Ground, tolerance: Tolerance
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization with ``solver="lyapunov"``."""
    both, *sides = (_solved(each, ground, tolerance) for each in (pair, pair[:1], pair[1:]))
    status = reduce(np.maximum, (solution["status"] for solution in (both, *sides)))
    (rho,) = cellwise(np.where, status < labels.NOT_CONVERGED, both["rho"], np.nan)
    shown = {f"{name}_{n}": side[name] for name in SHOWN for n, side in enumerate(sides, start=1)}
    return {"rho": rho, **shown, "status": status}


def _solved(structures: Sequence[Structure], ground: Ground, tolerance: Tolerance) -> dict[str, Cells]:
    """Linearized response of a pair or of one structure, over the dimensions of the parameters.

    A pair has ``rho`` of both; ``displacement_std``, ``ductility_std`` and ``yield_displacement`` are
    those of the last structure.
    """
    models: dict[str, Model] = {f"structure_{n}": each for n, each in enumerate(structures, start=1)}
    models["ground"] = ground
    check_chain(models)
    cells = flat(models)
    if not cells.where.size:
        blank = dict.fromkeys(OF_PAIR, cells.array(np.empty(0)))
        return blank | {"status": cells.array(np.empty(0, np.int8), labels.INVALID_INPUT)}
    equations = equations_of_cells(cells, ())
    table = solution_table(cells, equations, solve_equations(equations, tolerance))
    calm = ((table.c_eq == -1) & (table.k_eq == 0)).any("element") & (table.status == labels.CONVERGED)
    status = table.status.where(~calm, np.int8(labels.ELASTIC_LIMIT))
    last = [table.rho.isel(floor=0, floor_2=-1, drop=True)]
    for name, dim in zip(LAST, (FLOOR, ELEMENT, ELEMENT), strict=True):
        last.append(table[name].isel({dim: -1}, drop=True))
    return {**dict(zip(OF_PAIR, last, strict=True)), "status": status}
