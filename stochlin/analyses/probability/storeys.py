"""Two structures in a finite earthquake, at least one of them a building with storeys: by simulation."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.transient_systems import course_of, numbered, of_cells, over_time
from stochlin.analyses.probability.cells import simulated_table
from stochlin.analyses.probability.simulated import STEPS_PER_PERIOD, histories_of
from stochlin.analyses.simulation.riders import riders_of
from stochlin.analyses.simulation.views import displacements, pairs_of, view_of
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import over_cells
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.separation_histories import Watched
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap
from stochlin.models.systems import AnyStructure, first_period


def storeys_in_motion(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    distance: Gap,
    duration: float,
    envelope: Envelope | None,
    points: int,
    *,
    confidence: float,
    counts: tuple[int, int],
    progress: Progress | None,
) -> xr.Dataset:
    """What simulated motions say, with errors; ``counts`` are paths and seed.

    The gap is kept at all heights at once; standard deviations are those at the lower roof. Each cell
    of the ground is a simulation of its own.
    """
    paths, seed = counts
    if not paths:
        raise ValueError(
            "paths = 0; allowed for buildings with storeys: from 2, since they are simulated only"
        )

    def of_ground(first: AnyStructure, second: AnyStructure, ground: Ground) -> xr.Dataset:
        riders = riders_of([first, second], ground, None, stationary=False)
        run = riders.run(ground, paths=paths, seed=seed, steps_per_period=STEPS_PER_PERIOD)
        shortest = min(float(first_period(structure)) for structure in (first, second))
        course = course_of(envelope, duration, shortest, points)
        gap = distance.arrays()["gap"]
        valid = (gap > 0) & np.isfinite(gap)
        cell = numbered(valid)
        heights = pairs_of(riders.system)
        one, two = (
            view_of([displacements(riders.system, pair)[n] for pair in heights], run.order, run.scale)
            for n in (0, 1)
        )
        start, pairs = np.zeros(1, int), np.zeros(int(valid.sum()), int)
        watched = Watched(one, two, start, of_cells(gap, cell).astype(float), pairs)
        soil = ground.lone_filter()
        found = histories_of(run, soil, course, watched, progress)
        table = simulated_table(found, cell, xr.DataArray(0), confidence, seed)
        status = labels.status_where(valid)
        return over_time(table.assign(status=status).assign_attrs(height_m=heights[-1].height), course)

    return over_cells(of_ground, {"first": first, "second": second, "ground": ground})
