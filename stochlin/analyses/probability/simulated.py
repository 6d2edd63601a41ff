"""Pounding of pairs of structures in simulated motions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.transient_systems import (
    TIME,
    TimeGrid,
    grounds_of,
    numbered,
    of_cells,
    oscillators_of,
    spread_over,
)
from stochlin.analyses.probability.cells import HEIGHT, PairTable, height_numbers, over_heights
from stochlin.analyses.simulation.draws import draw
from stochlin.analyses.simulation.ensembles import (
    SimulationCells,
    SimulationRun,
    joined_laws,
    prepare,
    seconds_of,
)
from stochlin.analyses.simulation.finite_motions import (
    finite_steps,
    quantile_intervals,
    share_interval,
)
from stochlin.analyses.simulation.structures_in_motion import structures_in_motion
from stochlin.analyses.simulation.views import displacements, drifts_of, pairs_of, view_of
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import over_cells
from stochlin.analyses.tables.work import check_work
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

SAMPLES = "separation_samples"  # variable from which a fragility is fitted
STEPS_PER_PERIOD = 32
STEP_OF_DISTANCE = 6e-8  # time to compare a distance with gaps at a step [s], approximately
ENVELOPES, RESULTS = 6, 6  # numbers in memory at once for each step, and for each motion and pair


class Draws(NamedTuple):
    """Number, seed and scatter of simulated motions."""

    paths: int
    seed: int
    scatter: float  # standard deviation of the logarithm of a random factor on each motion


def by_simulation(
    pairs: PairTable,
    models: Mapping[str, Any],
    distance: Gap,
    confidence: float,
    draws: Draws,
    progress: Progress | None,
) -> xr.Dataset:
    """Variables of the table by simulation, with errors; ``pairs`` has one strength of the motion.

    All oscillators are simulated under the same motions. Pairs with storeys and pairs with uncertain
    parameters are simulated one by one, and the gap is checked at all heights.
    """
    first, second, ground = models.values()
    drawn = draw([first, second], ground, draws.paths, draws.seed)
    (first, second), ground = drawn.medians
    if not drawn.factors and not any(side.has_storeys for side in pairs.sides):
        histories = _of_oscillators(pairs, ground, draws, progress)
        return _table(histories, pairs.cell_number, pairs.pair_number, confidence, draws.seed)
    samples, grounds = drawn.stacks(), drawn.grounds()

    def of_cell(first: AnyStructure, second: AnyStructure, ground: Ground, distance: Gap) -> xr.Dataset:
        moving = structures_in_motion([first, second], ground, None, stationary=False, samples=samples)
        run = moving.run(ground, steps_per_period=STEPS_PER_PERIOD, grounds=grounds, **draws._asdict())
        gap = distance.arrays()["gap"]
        cell = numbered((gap > 0) & np.isfinite(gap))
        meetings = pairs_of(moving.system)
        view_1, view_2 = (
            view_of([displacements(moving.system, place)[n] for place in meetings], run.order, run.scale)
            for n in (0, 1)
        )
        gaps = of_cells(gap, cell).astype(float)
        falls = None
        if np.isfinite(moving.limits).any():
            drifts = view_of(drifts_of(moving.system), run.order, run.scale)
            falls = Falls(
                drifts, np.atleast_2d(moving.limits).T, np.unique(moving.system.owners, True)[1]
            )
        watched = Watched(view_1, view_2, np.zeros(1, int), gaps, np.zeros(gaps.size, int), falls)
        heights = xr.DataArray(0)
        if moving.has_storeys:
            heights = height_numbers([place.height for place in meetings])
        histories = _histories(run, pairs.course, watched, progress)
        return _table(histories, cell, heights, confidence, draws.seed)

    medians = {"first": first, "second": second, "ground": ground}
    return over_cells(of_cell, medians, beside={"distance": distance}).assign(drawn.table())


def _of_oscillators(
    pairs: PairTable, ground: Ground, draws: Draws, progress: Progress | None
) -> Histories:
    """Simulated histories of pairs of oscillators, all under the same motions.

    Cells may have different intensities: the response to ``a`` times a motion is ``a`` times that of a
    structure with the strength ``uy/a`` to the motion.
    """
    sides = pairs.sides
    below = grounds_of(sides)
    if any((row != row[0]).any() for name, row in below.items() if name != "intensity"):
        raise ValueError(
            "ground has several periods or damping ratios; allowed in a simulation: one ground, of "
            "which only the intensity is an array; simulate one ground at a time"
        )
    amplitude = np.sqrt(below["intensity"] / below["intensity"][0])
    period, damping, hardening, uy = oscillators_of(sides)
    dims = [array.dims for array in ground.arrays().values()]
    lone = ground.isel({name: slice(0, 1) for name in set().union(*dims)})
    cells = SimulationCells(
        period,
        damping,
        hardening,
        uy / amplitude,
        joined_laws([side.law.T for side in sides]),
        np.concatenate(
            [np.full(side.period.size, side.stack.law.step(), object) for side in pairs.sides]
        ),
        1 / (damping * 2 * np.pi / period),
        np.zeros(period.size),
        np.ones(period.size, bool),
    )
    run = prepare(cells, lone, steps_per_period=STEPS_PER_PERIOD, **draws._asdict())
    metres = run.scale * amplitude
    view_1, view_2 = (
        view_of([{int(n): 1.0} for n in side], run.order, metres) for side in pairs.structures_of_pair
    )
    watched = Watched(
        view_1,
        view_2,
        np.arange(len(view_1.row)),
        pairs.gap,
        pairs.pair_of_cell,
        _falls_of_oscillators(pairs, run, metres),
    )
    return _histories(run, pairs.course, watched, progress)


def _falls_of_oscillators(pairs: PairTable, run: SimulationRun, metres: Array) -> Falls | None:
    """Displacements at which the oscillators of all pairs fall, if any can."""
    limit, both = np.concatenate([side.limits for side in pairs.sides]), pairs.structures_of_pair.ravel()
    if np.isposinf(limit).all():
        return None
    drifts = view_of([{int(n): 1.0} for n in both], run.order, metres)
    return Falls(drifts, limit[both], np.arange(both.size))


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


def _table(
    histories: Histories, cell: xr.DataArray, pair: xr.DataArray, confidence: float, seed: int
) -> xr.Dataset:
    """Simulated probabilities and standard deviations, with errors.

    ``cell`` and ``pair`` have the numbers of gaps and pairs. With several heights, the pairs are one
    pair at each height.
    """
    n = len(histories.largest)
    alive = histories.survivors
    lower, upper = share_interval(alive, n)
    stem = "confidence_of_no_pounding_simulated"
    table = xr.Dataset(
        {
            "instantaneous_probability_simulated": spread_over(histories.beyond / n, cell),
            stem: spread_over(alive / n, cell),
            f"{stem}_lower": spread_over(lower, cell),
            f"{stem}_upper": spread_over(upper, cell),
        }
    )
    mean = histories.squares / n
    error = np.sqrt(np.maximum(histories.fourths / n - mean**2, 0) / n) / (
        2 * np.sqrt(np.where(mean > 0, mean, 1.0))
    )
    names = ("displacement_std_simulated_1", "displacement_std_simulated_2", "difference_std_simulated")
    for row, name in enumerate(names):
        table[name] = spread_over(infinite_if_fallen(np.sqrt(mean[:, row])), pair)
    table["difference_std_simulated_standard_error"] = spread_over(infinite_if_fallen(error[:, 2]), pair)
    largest, place = histories.largest, pair
    table = table.assign(_simulated_gaps(largest, pair, confidence))
    if HEIGHT in pair.dims:
        largest, place = largest.max(axis=1, keepdims=True), xr.DataArray(0)
        table = over_heights(table).assign(_simulated_gaps(largest, place, confidence))
    table[SAMPLES] = spread_over(largest, place).rename({TIME: "path"})
    return table.assign_attrs(paths=n, seed=seed)


def _simulated_gaps(largest: Array, pair: xr.DataArray, confidence: float) -> dict[str, xr.DataArray]:
    """Gap [m] for the confidence, from samples (motions, pairs), and its 95 % interval."""
    gaps = quantile_intervals(largest, np.array([confidence]))
    return {
        f"required_gap_simulated{ending}": spread_over(values, pair)
        for ending, (values,) in zip(labels.VALUE_AND_ENDS, gaps, strict=True)
    }
