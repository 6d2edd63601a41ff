"""Probability of pounding of a pair by transient linearization and crossing theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeGuard

import numpy as np
import xarray as xr

from stochlin.applications.probability.axes import HEIGHT, ResultAxes, over_heights
from stochlin.applications.probability.crossings import Difference, RelativeMotion, bandwidths
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.probability.drift_growth import drift_variances
from stochlin.models.grounds import Ground
from stochlin.models.structures import Gap, Structure
from stochlin.models.systems import AnyStructure, first_period
from stochlin.models.uncertain import median_of
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.systems.state_space import Equations
from stochlin.solver.linearization.systems.systems import equations_of
from stochlin.solver.linearization.transient_systems import TimeGrid, solve_course
from stochlin.solver.simulation.views import at_height, meeting_heights

EQUAL = 1e-6  # relative variance of the difference below which it is an error of the integration
OF_MOMENTS = 0.9  # share of the progress that the moments have beside the bandwidths
MOTION = "motion"  # dimension of the motions, which the results do not have
CHANCES = "instantaneous_probability", "confidence_of_no_pounding", "confidence_of_no_pounding_poisson"
# Variables that have a version with the plastic drift, and the names of these.
CORRECTED = {
    **{f"displacement_std_{n}": f"displacement_std_corrected_{n}" for n in (1, 2)},
    **{name: f"{name}_corrected" for name in (*CHANCES[:2], "difference_std", "required_gap")},
}
# Range [standard deviations], step of the logarithm, and least number of steps on each side, of the
# strengths of motions with a scatter. The peaks scatter by a logarithmic standard deviation of 0.15 or
# more for one strength, so that probabilities are smooth in the strength; the error of the mean is
# about 0.001.
REACH, STEP, FEWEST = 3.2, 0.25, 4


def strengths(scatter: float) -> tuple[Array, Array]:
    """Factors on the motion, over which formulas are averaged, and their weights with the sum 1."""
    if not scatter:
        return np.ones(1), np.ones(1)
    each = max(FEWEST, int(np.ceil(REACH * scatter / STEP)))
    normal = np.linspace(-REACH, REACH, 2 * each + 1)
    weights = np.exp(-0.5 * normal**2)
    return np.exp(scatter * normal), weights / weights.sum()


class PairMoments(NamedTuple):
    """Moments of a pair over time, in m motions of different strength, at h heights."""

    own: Array  # (2, times, m h) variances of both displacements [m^2]
    both: Difference
    bandwidth: Array  # (times, m h) of the relative displacement
    pace: Array  # (elements, times, m) alpha k_eq [1/s]


def moments_of_pair(
    equations: Equations,
    heights: Array,
    course: TimeGrid,
    shortest: float,
    progress: Progress | None = None,
) -> PairMoments:
    """Moments of two structures with this shortest period [s] by transient linearization."""
    system = equations.arrangement
    floors = np.zeros((2, heights.size, int(system.first[-1])))
    for number, row in np.ndindex(floors.shape[:2]):
        for floor, share in at_height(system, number, float(heights[row])).items():
            floors[number, row, floor] = share
    first, second = floors @ equations.system.shapes
    begin, rest = part_of(progress, 0.0, OF_MOMENTS), part_of(progress, OF_MOMENTS, 1.0)
    rows = np.concatenate([first, second, first - second])
    moments = solve_course(equations, rows, course, shortest, begin)
    bandwidth = bandwidths(moments, equations, first - second, course.times, rest)
    (own_1, own_2, d_d), (*_, d_v), (*_, v_v) = (
        [part.reshape(len(part), -1) for part in np.split(values, 3, axis=-1)]
        for values in (moments.displacement, moments.mixed, moments.velocity)
    )
    d_d = np.where(d_d > EQUAL * (own_1 + own_2), d_d, 0.0)
    springs, yields = equations.system, equations.yields
    pace = np.zeros((len(own_1), *equations.strength.shape))
    pace[..., yields] = moments.relaxation * (springs.post / springs.elastic)[:, yields]
    both = Difference(d_d, d_v, v_v, 0.5 * (own_1 + own_2 - d_d))
    return PairMoments(np.stack([own_1, own_2]), both, bandwidth, np.moveaxis(pace, -1, 0))


def by_formula(
    structures: Sequence[Any],
    ground: Any,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    scatter: float,
    progress: Progress | None,
    intensities: Array | None = None,
) -> list[xr.Dataset]:
    """Results by linearization, and with its known bias corrected, averaged over the scatter.

    There is one table for each of the ``intensities`` [m^2/s^3], which are by default that of the
    ground. The motions of all intensities and strengths are solved together.
    """
    ground = median_of(ground)
    pair = [strength_in_metres(median_of(structure), ground) for structure in structures]
    if intensities is None:
        intensities = np.array([float(ground.arrays()["intensity"])])
    factors, weights = strengths(scatter)
    changed: dict[str, Any] = {
        "intensity": xr.DataArray(np.outer(intensities, factors**2).ravel(), dims=MOTION)
    }
    ground = replace(ground, **changed)
    equations = equations_of(pair, ground)
    heights = meeting_heights(*equations.arrangement.stacks)
    shortest = min(float(first_period(structure)) for structure in pair)
    moments = moments_of_pair(equations, heights, course, shortest, progress)
    axes, columns = ResultAxes(heights, distance), [moments.bandwidth, *moments.both]
    drift, apart = _drift(pair, moments, ground, course.times)
    own = [*moments.own, *drift, apart]
    tables = []
    for intensity in range(intensities.size):
        band, *both, own_1, own_2, drift_1, drift_2, slow = (
            np.split(column, intensities.size, axis=1)[intensity] for column in (*columns, *own)
        )
        linear = RelativeMotion(Difference(*both), band, np.zeros_like(slow), course, weights)
        table = _table(linear, (own_1, own_2), axes, confidence)
        corrected = table
        if slow.any():  # also where it is unknown, hence NaN
            total = own_1 + drift_1, own_2 + drift_2
            corrected = _table(linear._replace(drift=slow), total, axes, confidence)
        renamed = {name: CORRECTED[name] for name in map(str, corrected) if name in CORRECTED}
        table = table.assign(corrected[[*renamed]].rename(renamed))
        product = table.displacement_std_1 * table.displacement_std_2
        product_of_both = axes.array(linear.mean(linear.both.product), gaps=False)
        table["rho"] = product_of_both / product.where(product > 0)
        tables.append(_bounds(table) if HEIGHT in table.dims else table)
    return tables


def _table(
    motion: RelativeMotion, own: tuple[Array, Array], axes: ResultAxes, confidence: float
) -> xr.Dataset:
    """Results of one motion, with the variances (times, k h) of both displacements [m^2]."""
    count, both = axes.heights.size, motion.both
    gaps = np.tile(axes.gaps, count)
    chances = motion.chances(gaps, np.repeat(np.arange(count), axes.gaps.size))
    over_gaps = [axes.array(chance.reshape(len(chance), count, -1)) for chance in chances]
    table = xr.Dataset(dict(zip(CHANCES, over_gaps, strict=True)))
    names = "displacement_std_1", "displacement_std_2", "difference_std"
    variances = *own, both.d_d + motion.drift
    stds = [np.sqrt(motion.mean(np.maximum(variance, 0))) for variance in variances]
    for name, std in zip(names, stds, strict=True):
        table[name] = axes.array(std, gaps=False)
    table["required_gap"] = axes.array(motion.gap_for(confidence), gaps=False)
    return table


def _bounds(table: xr.Dataset) -> xr.Dataset:
    """Table of all heights together, with Boole's bound of the confidence and the governing height."""
    missed = (1 - table.confidence_of_no_pounding).sum(HEIGHT, skipna=False)
    governing = table.required_gap.fillna(-1.0).idxmax(HEIGHT)
    return over_heights(table).assign(
        confidence_of_no_pounding_at_least=(1 - missed).clip(0),
        governing_height=governing.where(table.required_gap.notnull().all(HEIGHT)),
    )


def _is_in_map(structure: AnyStructure) -> TypeGuard[Structure]:
    """Whether it is an oscillator with a stationary linearization, whose bias may be known."""
    if not isinstance(structure, Structure):
        return False
    return not structure.yields or (structure.linearizes and bool(structure.settles().any()))


def _drift(
    pair: Sequence[AnyStructure], moments: PairMoments, ground: Ground, times: Array
) -> tuple[Array, Array]:
    """Variances [m^2] of the plastic drifts and of their difference; NaN where the bias is unknown."""
    (first, second), own, product = pair, moments.own, moments.both.product
    if not (_is_in_map(first) and _is_in_map(second)):
        unknown = np.nan if first.yields or second.yields else 0.0
        return np.full_like(own, unknown), np.full_like(product, unknown)
    table, count = correlate(first, second, ground), moments.pace.shape[-1]
    *biases, shared = (
        np.broadcast_to(table[name].values, count) for name in ("bias_1", "bias_2", "bias")
    )
    return drift_variances(own, product, moments.pace, times, np.stack(biases), shared)
