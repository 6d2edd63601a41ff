"""Table of pairs by nonlinear simulation, with the variables of the other methods."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.parallel import cores
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure
from stochlin.solver.linearization.equivalent_systems import solve_elastic
from stochlin.solver.simulation.simulation import simulate
from stochlin.solver.simulation.stationary_motions import expected_seconds
from stochlin.solver.simulation.structures_in_motion import structures_in_motion
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import CELL_DIMENSION, NONE_VALID, flat, over_all, over_cells
from stochlin.solver.tables.checks import check_work, count_cells
from stochlin.solver.tables.lazy import computed

MOTION_VARIABLES = "displacement_std", "displacement_std_standard_error", "drift", "drift_memory"


def simulate_pairs(
    first: Structure, second: Structure, ground: Ground, options: dict[str, Any]
) -> xr.Dataset:
    """Table of ``rho``, standard deviations and their standard errors; one ensemble per ground."""
    first.check_stationary("first")
    second.check_stationary("second")
    sides = {"first": computed(first), "second": computed(second)}
    ground = computed(ground)
    on_one_ground = partial(_on_one_ground, options, count_cells(ground))
    return over_cells(on_one_ground, {"ground": ground}, beside=sides)


def _on_one_ground(
    options: dict[str, Any], grounds: int, ground: Ground, first: Structure, second: Structure
) -> xr.Dataset:
    """The table on one of some ``grounds``, of all structures under the same motions."""
    sides = [flat({"structure": structure}) for structure in (first, second)]
    if not all(side.where.size for side in sides):
        raise ValueError(NONE_VALID)
    structures = [
        side.models["structure"].isel({CELL_DIMENSION: n})
        for side in sides
        for n in range(side.where.size)
    ]
    if grounds > 1:
        _check_grounds(structures, ground, options, grounds)
    motions = simulate(structures, ground, **options)
    begin = sides[0].where.size
    parts = (slice(begin), slice(begin, None))
    table = xr.Dataset()
    statuses = []
    pair = zip(sides, parts, (first, second), strict=True)
    for n, (side, part, structure) in enumerate(pair, start=1):
        columns = {}
        for name in MOTION_VARIABLES:
            columns[name] = xr.DataArray(side.array(motions[name].values[part]))
        strength = solve_elastic(structure, ground).yield_displacement
        columns |= {
            "yield_displacement": strength,
            "ductility_std": columns["displacement_std"] / strength,
        }
        table = table.assign({f"{name}_{n}": values for name, values in columns.items()})
        blank = labels.INVALID_INPUT
        statuses.append(xr.DataArray(side.array(motions.status.values[part], blank)))
    status = xr.apply_ufunc(np.maximum, *statuses, join="exact").astype(np.int8)
    shape = over_all(*(side.shape for side in sides))
    row = sides[0].places(shape)
    column = sides[1].places(shape)
    pairs = {}
    for name in ("rho", "rho_standard_error"):
        values = np.asarray(motions[name].values[parts][row, column])
        pairs[name] = shape.copy(data=values).where(status < labels.NOT_CONVERGED)
    attrs = {key: value for key, value in motions.attrs.items() if not key.startswith("structure")}
    return xr.Dataset({**pairs, **table, "status": status}, attrs=attrs)


def _check_grounds(
    structures: list[Structure], ground: Ground, options: dict[str, Any], grounds: int
) -> None:
    """Raise a ValueError if simulations on all grounds, if each is as long, would take too long."""
    choices = {name: options[name] for name in ("paths", "seed", "steps_per_period")}
    run = structures_in_motion(structures, ground, None, True, **choices).run
    check_work(
        f"the simulations on {grounds} grounds would take",
        "take fewer grounds at a time, lower paths or relaxation_times, or leave out structures "
        "that yield rarely",
        seconds=grounds * expected_seconds(run, options["relaxation_times"]),
        cores=cores(),
    )
