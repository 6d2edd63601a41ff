"""The pairs of two structures by simulation, in the same table as the other methods."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr

from stochlin.analyses.simulation.ensembles import cells_of, check_settings, join_cells, prepare
from stochlin.analyses.simulation.run_lengths import with_length
from stochlin.analyses.simulation.simulation import run_attributes, simulate_moments
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure


@dataclass(frozen=True)
class SimulationSettings:
    """How to simulate: arguments of `simulate`, which describes them."""

    paths: int
    seed: int
    steps_per_period: int
    relaxation_times: float
    progress: Progress | None

    def __post_init__(self) -> None:
        check_settings(self.paths, self.seed, self.steps_per_period, self.relaxation_times)

    @property
    def told(self) -> str:
        """What the history of a result says of them."""
        return f"paths={self.paths}, seed={self.seed}"


def simulate_pairs(
    first: Structure, second: Structure, ground: Ground, settings: SimulationSettings
) -> xr.Dataset:
    """Table of ``rho``, standard deviations and their errors; one ensemble a ground."""
    return over_grounds(partial(_on_one_ground, settings=settings), (first, second), ground)


def over_grounds(
    function: Callable[..., xr.Dataset], structures: Sequence[Structure], ground: Ground
) -> xr.Dataset:
    """``function`` of the structures and one ground, for every ground of a table of them."""
    sizes = {dim: n for array in ground.arrays().values() for dim, n in array.sizes.items() if n > 1}
    if not sizes:
        return function(*structures, ground)
    dim, size = next(iter(sizes.items()))
    parts = []
    for n in range(size):
        part = {str(dim): slice(n, n + 1)}
        parts.append(over_grounds(function, [one.isel(part) for one in structures], ground.isel(part)))
    return xr.concat(
        parts,
        dim,
        combine_attrs="override",
        data_vars="all",
        coords="minimal",
        compat="equals",
        join="outer",
    )


def _on_one_ground(
    first: Structure, second: Structure, ground: Ground, settings: SimulationSettings
) -> xr.Dataset:
    (cells_1, index_1), (cells_2, index_2) = cells_of(first, ground), cells_of(second, ground)
    cells = join_cells([cells_1, cells_2])
    index_2 = index_2 + cells_1.valid.size
    run = prepare(
        cells,
        ground,
        paths=settings.paths,
        seed=settings.seed,
        steps_per_period=settings.steps_per_period,
    )
    run = with_length(run, settings.relaxation_times)
    moments = simulate_moments(run, settings.progress)

    def of_cells(values: Array, *index: xr.DataArray) -> xr.DataArray:
        return xr.apply_ufunc(lambda *i: values[i], *index, join="exact")

    worst = xr.apply_ufunc(
        np.maximum, of_cells(moments.status, index_1), of_cells(moments.status, index_2), join="exact"
    )
    usable = worst < labels.NOT_CONVERGED
    table = xr.Dataset({"rho": of_cells(moments.rho, index_1, index_2).where(usable)})
    table["rho_standard_error"] = of_cells(moments.rho_error, index_1, index_2).where(usable)
    for number, index in ((1, index_1), (2, index_2)):
        sigma = of_cells(moments.displacement_std, index)
        uy = of_cells(cells.yield_displacement, index)
        table[f"displacement_std_{number}"] = sigma
        table[f"displacement_std_standard_error_{number}"] = of_cells(moments.displacement_error, index)
        table[f"ductility_std_{number}"] = sigma / uy
        table[f"yield_displacement_{number}"] = uy
        table[f"drift_{number}"] = of_cells(moments.drift, index)
    return table.assign(status=worst.astype(np.int8)).assign_attrs(run_attributes(run))
