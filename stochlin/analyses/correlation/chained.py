"""Table of pairs by the augmented state space: the chain of eqs. (5) to (12) for every cell.

The state matrix of both structures and the ground is formed for each cell, its Lyapunov equation is
solved, and the coefficients are renewed until both stand still, without the closed forms of
`linearized`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from stochlin.analyses.correlation.pairs import SHOWN
from stochlin.analyses.linearization.systems.systems import (
    check_chain,
    equations_of_cells,
    solution_table,
    solve_equations,
)
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import CELL, flat
from stochlin.analyses.tables.cellwise import Cells, cellwise
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Model
from stochlin.models.structures import Structure

Pair = tuple[Structure, Structure]
OF_PAIR = ("rho", *SHOWN)
NEEDED = ["rho", "displacement_std", "ductility_std", "yield_drift", "c_eq", "k_eq", "status"]
AT_ONCE = 1000  # cells that are solved together
PAIRS_SHARE = 0.9  # share of the work for the pairs


def chained_pairs(
    pair: Pair, ground: Ground, tolerance: Tolerance, progress: Progress | None = None
) -> dict[str, Cells]:
    """Variables of `correlate` by linearization with ``solver="lyapunov"``."""
    both = _solved(pair, ground, tolerance, part_of(progress, 0.0, PAIRS_SHARE))
    sides = [_solved((structure,), ground, tolerance) for structure in pair]
    statuses = [solution["status"] for solution in (both, *sides)]
    (status,) = cellwise(_largest, *statuses, kinds=(np.int8,))
    (rho,) = cellwise(np.where, status < labels.NOT_CONVERGED, both["rho"], np.nan)
    shown = {f"{name}_{n}": side[name] for name in SHOWN for n, side in enumerate(sides, start=1)}
    return {"rho": rho, **shown, "status": status}


def _solved(
    structures: Sequence[Structure],
    ground: Ground,
    tolerance: Tolerance,
    progress: Progress | None = None,
) -> dict[str, Cells]:
    """Linearized response of a pair or of one structure, over the dimensions of the parameters.

    A pair has ``rho`` of both; ``displacement_std``, ``ductility_std`` and ``yield_displacement`` are
    those of the last structure.
    """
    roles = {f"structure_{n}": structure for n, structure in enumerate(structures, start=1)}
    models: dict[str, Model] = {**roles, "ground": ground}
    check_chain(models)
    cells = flat(models)
    if not cells.where.size:
        blank = dict.fromkeys(OF_PAIR, cells.array(np.empty(0)))
        return blank | {"status": cells.array(np.empty(0, np.int8), labels.INVALID_INPUT)}
    tables = []
    for begin in range(0, cells.where.size, AT_ONCE):
        part = cells.part(slice(begin, begin + AT_ONCE))
        equations = equations_of_cells(part, ())
        solution = solution_table(part, equations, solve_equations(equations, tolerance))
        tables.append(solution[NEEDED])
        if progress is not None:
            progress(min(1.0, (begin + AT_ONCE) / cells.where.size))
    table = xr.concat(tables, CELL) if len(tables) > 1 else tables[0]
    calm = ((table.c_eq == -1) & (table.k_eq == 0)).any("element") & (table.status == labels.CONVERGED)
    parts = (
        table.rho[:, 0, -1],
        table.displacement_std[:, -1],
        table.ductility_std[:, -1],
        table.yield_drift[:, -1],
    )
    values = {
        name: cells.array(array.values.astype(float)) for name, array in zip(OF_PAIR, parts, strict=True)
    }
    status = table.status.where(~calm, np.int8(labels.ELASTIC_LIMIT)).values
    return {**values, "status": cells.array(status, labels.INVALID_INPUT)}


def _largest(*arrays: Array) -> Array:
    return np.maximum.reduce(np.broadcast_arrays(*arrays))
