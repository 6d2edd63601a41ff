"""Pounding of a pair of structures in simulated motions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.probability.formulas import gaps_in_a_row, over_gaps
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.separation_histories import (
    Falls,
    Histories,
    Watched,
    infinite_if_fallen,
    separation_histories,
)
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap
from stochlin.models.systems import AnyStructure
from stochlin.solver.linearization.transient_systems import TIME, TimeGrid
from stochlin.solver.simulation.ensembles import SimulationRun
from stochlin.solver.simulation.finite_motions import (
    check_finite,
    finite_steps,
    quantile_intervals,
    share_interval,
)
from stochlin.solver.simulation.simulation import STEPS_PER_PERIOD
from stochlin.solver.simulation.structures_in_motion import (
    GROUND,
    StructuresInMotion,
    at_height,
    draw,
    pairs_of,
    structures_in_motion,
)
from stochlin.solver.tables import labels

STDS = (
    *(f"displacement_std_simulated_{number}" for number in (1, 2)),
    *(f"difference_std_simulated{ending}" for ending in ("", "_standard_error")),
)


def by_simulation(
    pair: Sequence[AnyStructure],
    ground: Ground,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    draws: Mapping[str, Any],
    progress: Progress | None,
) -> xr.Dataset:
    """Results by simulation, with errors; the gap is checked at all heights.

    ``draws`` are the number ``paths`` of the motions, their ``seed`` and their ``scatter``.
    """
    drawn = draw(pair, ground, draws["paths"], draws["seed"])
    structures, ground = drawn.medians
    moving = structures_in_motion(structures, ground, None, False, drawn.stacks())
    grounds = drawn.samples_of(GROUND)
    run = moving.run(ground, steps_per_period=STEPS_PER_PERIOD, grounds=grounds, **draws)
    watched = _watched(moving, run, gaps_in_a_row(distance))
    histories = _histories(run, course, watched, progress)
    table = _table(histories, distance, confidence).assign(drawn.table())
    return table.assign_attrs(paths=len(histories.largest), seed=draws["seed"])


def _watched(moving: StructuresInMotion, run: SimulationRun, gaps: Array) -> Watched:
    """Displacements at the heights of contact, the gaps, and the drifts at which structures fall."""
    system, falls = moving.system, None
    heights = [pair.height for pair in pairs_of(system)]
    left, right = (
        run.rows(np.array([at_height(system, n, height) for height in heights])) for n in (0, 1)
    )
    if np.isfinite(moving.limits).any():
        drifts = run.rows(system.drifts)
        falls = Falls(drifts, np.atleast_2d(moving.limits).T, np.unique(system.owners, True)[1])
    return Watched(left, right, np.zeros(1, int), gaps, np.zeros(gaps.size, int), falls)


def _histories(
    run: SimulationRun, course: TimeGrid, watched: Watched, progress: Progress | None
) -> Histories:
    """Simulated histories of a run; the motions are those of `simulate` with the same seed."""
    check_finite(run, course.duration, len(watched.first))
    crowd, shape = finite_steps(run, course.duration, course.envelope)
    instants = course.times[course.shown] / run.plan.dt
    instants[-1] = shape.size
    return separation_histories(crowd, shape, instants, watched, progress)


def _table(histories: Histories, distance: Gap, confidence: float) -> xr.Dataset:
    """Simulated probabilities at all heights together, and standard deviations at the highest one."""
    n, alive, stem = len(histories.largest), histories.survivors, "confidence_of_no_pounding_simulated"
    shares = {"instantaneous_probability_simulated": histories.beyond / n, stem: alive / n}
    shares |= dict(zip((f"{stem}_lower", f"{stem}_upper"), share_interval(alive, n), strict=True))
    table = xr.Dataset({name: over_gaps(each, distance, TIME) for name, each in shares.items()})
    mean, fourth = (moments[..., -1] / n for moments in (histories.squares, histories.fourths))
    error = np.sqrt(np.maximum(fourth - mean**2, 0) / n) / (2 * np.sqrt(np.where(mean > 0, mean, 1.0)))
    stds = dict(zip(STDS, (*np.sqrt(mean.T), error[:, 2]), strict=True))
    table = table.assign({name: (TIME, infinite_if_fallen(std)) for name, std in stds.items()})
    gaps = required_gaps(histories.largest.max(axis=1, keepdims=True), confidence)
    return table.assign({name: gap.item() for name, gap in gaps.items()})


def required_gaps(largest: Array, confidence: float) -> dict[str, Array]:
    """Gaps [m] for the confidence, from samples (motions, h), and their 95 % intervals."""
    gaps = quantile_intervals(largest, np.array([confidence]))
    return {
        f"required_gap_simulated{ending}": values
        for ending, (values,) in zip(labels.VALUE_AND_ENDS, gaps, strict=True)
    }
