"""Pounding of a pair of structures in simulated motions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.probability.axes import Draws, ResultAxes, over_heights
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores
from stochlin.kernels.simulation.separation_histories import (
    Falls,
    Histories,
    Watched,
    infinite_if_fallen,
    separation_histories,
)
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap
from stochlin.models.systems import AnyStructure
from stochlin.solver.linearization.transient_systems import TimeGrid
from stochlin.solver.simulation.draws import draw
from stochlin.solver.simulation.ensembles import SimulationRun, seconds_of
from stochlin.solver.simulation.finite_motions import (
    finite_steps,
    quantile_intervals,
    share_interval,
)
from stochlin.solver.simulation.structures_in_motion import StructuresInMotion, structures_in_motion
from stochlin.solver.simulation.views import displacements, drifts_of, pairs_of, view_of
from stochlin.solver.tables import labels
from stochlin.solver.tables.work import check_work

SAMPLES = "separation_samples"  # variable from which a fragility is fitted
STEPS_PER_PERIOD = 32
STEP_OF_DISTANCE = 6e-8  # time to compare a distance with gaps at a step [s], approximately
ENVELOPES, RESULTS = 6, 6  # numbers in memory at once for each step, and for each motion and height


def by_simulation(
    pair: Sequence[AnyStructure],
    ground: Ground,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    draws: Draws,
    progress: Progress | None,
) -> xr.Dataset:
    """Results by simulation, with errors; the gap is checked at all heights."""
    assert draws.paths is not None
    drawn = draw(pair, ground, draws.paths, draws.seed)
    structures, ground = drawn.medians
    moving = structures_in_motion(structures, ground, None, False, drawn.stacks())
    grounds = drawn.grounds()
    run = moving.run(ground, steps_per_period=STEPS_PER_PERIOD, grounds=grounds, **draws._asdict())
    axes = ResultAxes(np.array([place.height for place in pairs_of(moving.system)]), distance)
    histories = _histories(run, course, _watched(moving, run, axes.gaps), progress)
    return _table(histories, axes, confidence, draws.seed).assign(drawn.table())


def _watched(moving: StructuresInMotion, run: SimulationRun, gaps: Array) -> Watched:
    """Displacements at the heights of contact, the gaps, and the drifts at which structures fall."""
    system, falls = moving.system, None
    left, right = (
        view_of([displacements(system, place)[n] for place in pairs_of(system)], run.order, run.scale)
        for n in (0, 1)
    )
    if np.isfinite(moving.limits).any():
        drifts = view_of(drifts_of(system), run.order, run.scale)
        falls = Falls(drifts, np.atleast_2d(moving.limits).T, np.unique(system.owners, True)[1])
    return Watched(left, right, np.zeros(1, int), gaps, np.zeros(gaps.size, int), falls)


def _histories(
    run: SimulationRun, course: TimeGrid, watched: Watched, progress: Progress | None
) -> Histories:
    """Simulated histories of a run; the motions are those of `simulate` with the same seed."""
    paths, steps = run.plan.groups * LANES, course.duration / run.plan.dt
    count = len(watched.first.row)
    check_work(
        f"duration = {course.duration:g} s, in steps of {run.plan.dt:.2g} s and on {paths} paths, would "
        "take",
        "shorten it, lower paths, or leave out the shortest period",
        numbers=ENVELOPES * steps + RESULTS * float(paths) * count,
        seconds=seconds_of(run, steps) + STEP_OF_DISTANCE * steps * paths * count,
        cores=cores(),
    )
    crowd, shape = finite_steps(run, course.duration, course.envelope)
    instants = course.times[course.shown] / run.plan.dt
    instants[-1] = shape.size
    return separation_histories(crowd, shape, instants, watched, progress)


def _table(histories: Histories, axes: ResultAxes, confidence: float, seed: int) -> xr.Dataset:
    """Simulated probabilities and standard deviations, with errors, all heights together."""
    n, alive, stem = len(histories.largest), histories.survivors, "confidence_of_no_pounding_simulated"
    shares = {"instantaneous_probability_simulated": histories.beyond / n, stem: alive / n}
    shares |= dict(zip((f"{stem}_lower", f"{stem}_upper"), share_interval(alive, n), strict=True))
    mean = histories.squares / n
    error = np.sqrt(np.maximum(histories.fourths / n - mean**2, 0) / n) / (
        2 * np.sqrt(np.where(mean > 0, mean, 1.0))
    )
    stds = {
        "displacement_std_simulated_1": np.sqrt(mean[:, 0]),
        "displacement_std_simulated_2": np.sqrt(mean[:, 1]),
        "difference_std_simulated": np.sqrt(mean[:, 2]),
        "difference_std_simulated_standard_error": error[:, 2],
    }
    at_heights = {
        **{name: infinite_if_fallen(std) for name, std in stds.items()},
        **_required_gaps(histories.largest, confidence),
    }
    table = xr.Dataset({name: axes.array(each, heights=False) for name, each in shares.items()})
    table = table.assign({name: axes.array(each, gaps=False) for name, each in at_heights.items()})
    largest = histories.largest.max(axis=1)
    gaps = _required_gaps(largest[:, None], confidence)
    whole: dict[str, Any] = {name: float(gap) for name, (gap,) in gaps.items()}
    whole[SAMPLES] = "path", largest
    return over_heights(table).assign(whole).assign_attrs(paths=n, seed=seed)


def _required_gaps(largest: Array, confidence: float) -> dict[str, Array]:
    """Gaps [m] for the confidence, from samples (motions, h), and their 95 % intervals."""
    gaps = quantile_intervals(largest, np.array([confidence]))
    return {
        f"required_gap_simulated{ending}": values
        for ending, (values,) in zip(labels.VALUE_AND_ENDS, gaps, strict=True)
    }
