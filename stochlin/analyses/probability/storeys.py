"""Pounding of two structures in simulated motions, pair by pair, also with storeys."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.transient_systems import TimeGrid, numbered, of_cells
from stochlin.analyses.probability.cells import height_numbers, simulated_table
from stochlin.analyses.probability.simulated import STEPS_PER_PERIOD, Draws, histories_of
from stochlin.analyses.simulation.draws import Draw
from stochlin.analyses.simulation.structures_in_motion import structures_in_motion
from stochlin.analyses.simulation.views import displacements, pairs_of, view_of
from stochlin.analyses.tables.cells import over_cells
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.separation_histories import Watched
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap
from stochlin.models.systems import AnyStructure


def storeys_in_motion(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    draws: Draws,
    progress: Progress | None,
    drawn: Draw | None = None,
) -> xr.Dataset:
    """Variables of the table of `pounding_probability` by simulation, with errors.

    Each cell of the models is a separate simulation, and the gap is checked at all heights. With
    uncertain parameters, ``drawn`` has the samples of each motion, and the models are the medians.
    """
    stacks, grounds = (None, []) if drawn is None else (drawn.stacks(), drawn.grounds())

    def of_cell(first: AnyStructure, second: AnyStructure, ground: Ground, distance: Gap) -> xr.Dataset:
        moving = structures_in_motion([first, second], ground, None, stationary=False, samples=stacks)
        run = moving.run(ground, steps_per_period=STEPS_PER_PERIOD, grounds=grounds, **draws._asdict())
        gap = distance.arrays()["gap"]
        cell = numbered((gap > 0) & np.isfinite(gap))
        pairs = pairs_of(moving.system)
        view_1, view_2 = (
            view_of([displacements(moving.system, pair)[n] for pair in pairs], run.order, run.scale)
            for n in (0, 1)
        )
        gaps = of_cells(gap, cell).astype(float)
        watched = Watched(view_1, view_2, np.zeros(1, int), gaps, np.zeros(gaps.size, int))
        histories = histories_of(run, course, watched, progress)
        heights = xr.DataArray(0)
        if moving.has_storeys:
            heights = height_numbers([pair.height for pair in pairs])
        return simulated_table(histories, cell, heights, confidence, draws.seed)

    models = {"first": first, "second": second, "ground": ground}
    return over_cells(of_cell, models, beside={"distance": distance})
