"""Table of pairs by nonlinear simulation, with the variables of the other methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure
from stochlin.solver.simulation.ensembles import (
    SimulationCells,
    SimulationRun,
    cells_of,
    join_cells,
    prepare,
)
from stochlin.solver.simulation.run_lengths import expected_seconds, with_length
from stochlin.solver.simulation.simulation import (
    MomentEstimates,
    run_attributes,
    simulate_moments,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import computed
from stochlin.solver.tables.work import check_work

if TYPE_CHECKING:
    from stochlin.solver.correlation.correlation import SimulationSettings


def simulate_pairs(
    first: Structure, second: Structure, ground: Ground, settings: SimulationSettings
) -> xr.Dataset:
    """Table of ``rho``, standard deviations and their standard errors; one ensemble for each ground."""
    first.check_stationary("first")
    second.check_stationary("second")
    sides, ground = (computed(first), computed(second)), computed(ground)
    if any(array.size > 1 for array in ground.arrays().values()):
        seconds = over_grounds(partial(_seconds, settings=settings), sides, ground).seconds
        check_work(
            f"the simulations on {seconds.size} grounds would take",
            "take fewer grounds at a time, lower paths or relaxation_times, or leave out structures "
            "that yield rarely",
            seconds=float(seconds.sum()),
            cores=cores(),
        )
    return over_grounds(partial(_on_one_ground, settings=settings), sides, ground)


def over_grounds(
    function: Callable[..., xr.Dataset], structures: Sequence[Structure], ground: Ground
) -> xr.Dataset:
    """Results of ``function(*structures, ground)`` for each ground of an array, put together."""
    sizes = {dim: n for array in ground.arrays().values() for dim, n in array.sizes.items() if n > 1}
    if not sizes:
        return function(*structures, ground)
    dim, size = next(iter(sizes.items()))
    parts = []
    for n in range(size):
        part = {str(dim): slice(n, n + 1)}
        parts.append(over_grounds(function, [side.isel(part) for side in structures], ground.isel(part)))
    return xr.concat(
        parts,
        dim,
        combine_attrs="override",
        data_vars="all",
        coords="minimal",
        compat="equals",
        join="outer",
    )


class _Pairs(NamedTuple):
    """Cells of both structures on one ground in one row, with the position of each cell in it."""

    cells: SimulationCells
    places: tuple[xr.DataArray, xr.DataArray]

    @classmethod
    def of(cls, first: Structure, second: Structure, ground: Ground) -> _Pairs:
        (cells_1, index_1), (cells_2, index_2) = cells_of(first, ground), cells_of(second, ground)
        return cls(join_cells([cells_1, cells_2]), (index_1, index_2 + cells_1.valid.size))

    def of_cells(self, values: Array, *index: xr.DataArray) -> xr.DataArray:
        return xr.apply_ufunc(lambda *i: values[i], *index, join="exact")

    def run(self, ground: Ground, settings: SimulationSettings, **options: Any) -> SimulationRun:
        return prepare(
            self.cells,
            ground,
            paths=settings.paths,
            seed=settings.seed,
            steps_per_period=settings.steps_per_period,
            **options,
        )


def _on_one_ground(
    first: Structure, second: Structure, ground: Ground, settings: SimulationSettings
) -> xr.Dataset:
    pairs = _Pairs.of(first, second, ground)
    run = with_length(pairs.run(ground, settings), settings.relaxation_times)
    table = _table(pairs, simulate_moments(run, settings.progress))
    for n, index in enumerate(pairs.places, start=1):
        table[f"drift_memory_{n}"] = pairs.of_cells(run.drift_memory, index)
    return table.assign_attrs(run_attributes(run))


def _seconds(
    first: Structure, second: Structure, ground: Ground, settings: SimulationSettings
) -> xr.Dataset:
    run = _Pairs.of(first, second, ground).run(ground, settings, moments=False)
    return xr.Dataset({"seconds": expected_seconds(run, settings.relaxation_times)})


def _table(pairs: _Pairs, moments: MomentEstimates) -> xr.Dataset:
    (index_1, index_2), of_cells = pairs.places, pairs.of_cells
    worst = xr.apply_ufunc(
        np.maximum, of_cells(moments.status, index_1), of_cells(moments.status, index_2), join="exact"
    )
    usable = worst < labels.NOT_CONVERGED
    table = xr.Dataset({"rho": of_cells(moments.rho, index_1, index_2).where(usable)})
    table["rho_standard_error"] = of_cells(moments.rho_error, index_1, index_2).where(usable)
    for number, index in ((1, index_1), (2, index_2)):
        sigma = of_cells(moments.displacement_std, index)
        uy = of_cells(pairs.cells.yield_displacement, index)
        table[f"displacement_std_{number}"] = sigma
        table[f"displacement_std_standard_error_{number}"] = of_cells(moments.displacement_error, index)
        table[f"ductility_std_{number}"] = sigma / uy
        table[f"yield_displacement_{number}"] = uy
        table[f"drift_{number}"] = of_cells(moments.drift, index)
    return table.assign(status=worst.astype(np.int8))
