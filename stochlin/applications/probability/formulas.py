"""Probability of pounding of a pair by transient linearization and crossing theory."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.optimize import elementwise

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.spectral_moments import bandwidth_of
from stochlin.kernels.linearization.systems.springs import Springs
from stochlin.kernels.linearization.systems.substitution import EquivalentCoefficients, response_of
from stochlin.kernels.linearization.transient import TransientMoments
from stochlin.kernels.probability import accumulated, exceeding, hazards
from stochlin.models.parameters import Parameter
from stochlin.models.structures import DRIFT, Gap
from stochlin.models.systems import Assembly
from stochlin.models.uncertain import median_of
from stochlin.solver.correlation.levels import PairsInTime, lone_pair_in_time
from stochlin.solver.linearization.levels import INSTANTS, EnvelopesInTime, strengths
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.systems.state_space import models_of, problem_of
from stochlin.solver.linearization.transient_systems import TIME, TimeGrid, solve_course
from stochlin.solver.simulation.structures_in_motion import HEIGHT, PATH, at_height, meeting_heights
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import check_names

# relative variance of the difference below which it is an error of the integration
EQUAL_DISPLACEMENTS = 1e-6
# bounds of a gap in a search, over the largest standard deviation
WIDEST_GAP = 14.0
NARROWEST_GAP = 1e-3
FORMULA_TOLERANCE = 1e-5  # relative tolerance of the search
STDS = "displacement_std_1", "displacement_std_2", "difference_std"
BANDWIDTHS = 13  # instants at which the bandwidth of yielding structures is computed
MOTION_DIMENSION = "motion"  # dimension of the motions, which the results do not have


class Chances(NamedTuple):
    """Probabilities over (instants of the result, cells)."""

    now: Array  # probability that u_1 - u_2 exceeds the gap at the instant
    vanmarcke: Array  # confidence of no pounding until the instant, for crossings in clumps
    poisson: Array  # confidence of no pounding until the instant, for independent crossings


class Variances(NamedTuple):
    """Of both displacements and of ``u_1 - u_2`` [m^2], over (instants of the result, h)."""

    u_1: Array
    u_2: Array
    d_d: Array


class PairMoments(NamedTuple):
    """Second moments of a pair, with ``d = u_1 - u_2``: (times, m, h) in m motions at h heights."""

    u_1: Array  # [m^2], E[u_1^2]
    u_2: Array  # [m^2]
    d_d: Array  # [m^2]
    d_v: Array  # [m^2/s], E[d d']
    v_v: Array  # [m^2/s^2]
    bandwidth: Array  # [-] of d


def moments_of_pair(
    system: Assembly,
    problem: Springs,
    heights: Array,
    course: TimeGrid,
    shortest: float,
    progress: Progress | None = None,
) -> PairMoments:
    """Moments of two structures with this shortest period [s] by transient linearization."""
    floors = [[at_height(system, number, height) for height in heights] for number in (0, 1)]
    first, second = np.array(floors) @ problem.system.shapes
    rows = np.concatenate([first, second, first - second])
    moments = solve_course(system, problem, rows, course, shortest, progress)
    bandwidth = _bandwidths(moments, problem, first - second, course.times)
    u_1, u_2, d_d = np.split(moments.displacement, 3, axis=-1)
    d_v = moments.mixed[..., -heights.size :]
    v_v = moments.velocity[..., -heights.size :]
    d_d = np.where(d_d > EQUAL_DISPLACEMENTS * (u_1 + u_2), d_d, 0.0)
    return PairMoments(u_1, u_2, d_d, d_v, v_v, bandwidth)


def _bandwidths(moments: TransientMoments, problem: Springs, rows: Array, times: Array) -> Array:
    """Bandwidth [-] over (times, m, h) of h sums of coordinates with these weights, in m motions.

    At each instant it is that of the stationary response of the equivalent linear systems at this
    instant, since their spectrum develops within a few periods.
    """
    elastic = not moments.relaxation.any() and not moments.slip.any()
    chosen = np.unique(np.linspace(0, times.size - 1, 1 if elastic else BANDWIDTHS).astype(int))
    table = []
    for instant in chosen:
        linear = EquivalentCoefficients(
            moments.slip[instant], moments.relaxation[instant], problem.dashpots
        )
        with np.errstate(invalid="ignore", divide="ignore"):
            l0, l1, l2 = response_of(problem, linear).spectral_moments(rows)
            bandwidth = bandwidth_of(l0, l1, l2)
        # NaN, for structures that move together, becomes 1: crossings are then independent.
        table.append(np.nan_to_num(bandwidth, nan=1.0))
    columns = np.reshape(table, (chosen.size, -1)).T
    over_time = [np.interp(times, times[chosen], column) for column in columns]
    return np.stack(over_time, axis=1).reshape(times.size, *table[0].shape)


class RelativeMotion(NamedTuple):
    """The moments of a pair in motions of k strengths, over whose ``weights`` results are averaged.

    `DriftingMotion` has the same methods.
    """

    moments: PairMoments  # (times, k, h)
    course: TimeGrid
    weights: Array  # (k,), with the sum 1

    def variances(self) -> Variances:
        """Means over the strengths."""
        shown = [values[self.course.shown] for values in self.moments[:3]]
        return Variances(*(np.einsum("k,tkh->th", self.weights, values) for values in shown))

    def chances(self, gap: Array, height: Array) -> Chances:
        """Probabilities (instants of the result, c) of exceeding gaps, and of no pounding.

        ``gap`` and ``height`` are gaps (c,) [m] and the number of the height (c,) of each.
        """
        shown = self.course.shown
        result = Chances(*np.zeros((3, shown.size, gap.size)))
        for strength, weight in enumerate(self.weights):
            at = PairMoments(*(moment[:, strength, height] for moment in self.moments))
            result.now[:] += weight * exceeding(gap, at.d_d[shown])
            rates = hazards(gap, at.d_d, at.d_v, at.v_v, at.bandwidth)
            with np.errstate(under="ignore"):
                for confidence, rate in zip((result.poisson, result.vanmarcke), rates, strict=True):
                    confidence[:] += weight * np.exp(-accumulated(rate, self.course.times)[shown])
        return result

    def gap_for(self, confidence: float) -> Array:
        """Gap (h,) [m] for a confidence of no pounding in the motion; 0 without relative motion.

        The crossings come in clumps.
        """
        largest = np.sqrt(self.moments.d_d.max(axis=0))
        widest = largest.max(axis=0)
        moving = np.flatnonzero(widest > 0)
        narrowest = NARROWEST_GAP * largest.min(axis=0)[moving] / widest[moving]
        at_end = self._replace(course=self.course._replace(shown=self.course.shown[-1:]))

        def off(level: Array, height: Array) -> Array:
            which = height.astype(int)
            gap = (level * widest[which]).ravel()
            vanmarcke = at_end.chances(gap, which.ravel()).vanmarcke[0]
            return (vanmarcke - confidence).reshape(level.shape)

        root = elementwise.find_root(
            off,
            (narrowest, np.full(moving.size, WIDEST_GAP)),
            args=(moving.astype(float),),
            tolerances={"xrtol": FORMULA_TOLERANCE},
        )
        required = np.zeros(widest.size)
        required[moving] = np.where(root.success, root.x * widest[moving], np.nan)
        return required


class DriftingMotion(NamedTuple):
    """Two oscillators by the drift closure, in motions of k strengths."""

    motions: PairsInTime
    shown: Array  # indices of the instants of the result

    def variances(self) -> Variances:
        """Means over the strengths."""
        first = self.motions.first
        second = self.motions.second
        assert second is not None
        u_1 = self.motions.means(first.variance)
        u_2 = self.motions.means(second.variance)
        d_d = self.motions.means(self.motions.difference)
        return Variances(u_1[self.shown], u_2[self.shown], d_d[self.shown])

    def drifts(self) -> dict[str, Array]:
        """Standard deviations of the slow parts of the displacements and of ``u_1 - u_2`` [m]."""
        first = self.motions.first
        second = self.motions.second
        moves = self.motions.moves
        assert second is not None
        slow = first.offset, second.offset, moves.offset**2
        names = "drift_std_1", "drift_std_2", "difference_drift_std"
        rows = (np.sqrt(self.motions.means(values))[self.shown] for values in slow)
        return dict(zip(names, rows, strict=True))

    def chances(self, gap: Array, height: Array) -> Chances:
        """Probabilities (instants of the result, c) to exceed gaps (c,) [m], and of no pounding."""
        apart = self.motions.difference[self.shown]
        now = exceeding(gap[:, None], apart[:, None]) @ self.motions.course.weights
        stays = (
            self.motions.survival(gap[None], independent=independent)[0].T[self.shown]
            for independent in (False, True)
        )
        return Chances(now, *stays)

    def gap_for(self, confidence: float) -> Array:
        """Gap (1,) [m] for a confidence of no pounding in the motion."""
        return self.motions.required_gaps(confidence)


def drifting_motions(
    pair: Sequence[Any], ground: Any, course: TimeGrid, sizes: Array, weights: Array
) -> list[DriftingMotion]:
    """Two oscillators by the drift closure, in i motions of k sizes (i, k) with weights (k,)."""
    per_shown = -(-(INSTANTS - 1) // (course.shown.size - 1))
    instants = (course.shown.size - 1) * per_shown + 1
    tiled = np.tile(weights, len(sizes))
    envelopes = EnvelopesInTime.of(course.envelope, course.duration, sizes.ravel(), tiled, instants)
    motions = lone_pair_in_time(pair, ground, envelopes)
    shown = np.arange(0, instants, per_shown)
    ranges = (slice(begin, begin + weights.size) for begin in range(0, sizes.size, weights.size))
    return [DriftingMotion(motions.part(part), shown) for part in ranges]


def by_formula(
    structures: Sequence[Any],
    ground: Any,
    distance: Gap,
    course: TimeGrid,
    confidence: float,
    scatter: float,
    progress: Progress | None,
    closure: str,
    intensities: Array | None = None,
) -> list[xr.Dataset]:
    """Results by linearization with this closure, averaged over the scatter.

    There is one table for each of the ``intensities`` [m^2/s^3], which are by default that of the
    ground. The motions of all intensities and strengths are solved together.
    """
    ground = median_of(ground)
    pair = [strength_in_metres(median_of(structure), ground) for structure in structures]
    intensity = float(ground.arrays()["intensity"])
    if intensities is None:
        intensities = np.array([intensity])
    factors, weights = strengths(scatter)
    if closure == DRIFT:
        sizes = np.outer(np.sqrt(intensities / intensity), factors)
        motions = drifting_motions(pair, ground, course, sizes, weights)
        return [_table(motion, np.array([np.nan]), distance, confidence) for motion in motions]
    scaled = xr.DataArray(np.outer(intensities, factors**2).ravel(), dims=MOTION_DIMENSION)
    ground = replace(ground, intensity=scaled)
    system, problem = problem_of(models_of(pair, ground), in_time=True)
    heights = meeting_heights(*system.sticks)
    shortest = min(float(structure.first_period()) for structure in pair)
    moments = moments_of_pair(system, problem, heights, course, shortest, progress)
    parts = [np.split(moment, intensities.size, axis=1) for moment in moments]
    tables = []
    for moments_at_intensity in zip(*parts, strict=True):
        motion = RelativeMotion(PairMoments(*moments_at_intensity), course, weights)
        tables.append(_table(motion, heights, distance, confidence))
    return tables


def _table(
    motion: RelativeMotion | DriftingMotion, heights: Array, distance: Gap, confidence: float
) -> xr.Dataset:
    """Results of one motion, over the heights of contact [m] if there are storeys."""
    count = heights.size
    gaps = gaps_in_a_row(distance)
    variances = motion.variances()
    chances = motion.chances(np.tile(gaps, count), np.repeat(np.arange(count), gaps.size))
    table = xr.Dataset()
    stds = [np.sqrt(np.maximum(variance, 0)) for variance in variances]
    columns = dict(zip(STDS, stds, strict=True))
    if isinstance(motion, DriftingMotion):
        columns |= motion.drifts()
    for name, values in columns.items():
        table[name] = (TIME, HEIGHT), values
    product = table.displacement_std_1 * table.displacement_std_2
    shared = 0.5 * (variances.u_1 + variances.u_2 - variances.d_d)  # E[u_1 u_2]
    table["rho"] = shared / product.where(product > 0)
    table["required_gap"] = HEIGHT, motion.gap_for(confidence)
    for name, chance in (
        ("instantaneous_probability", chances.now),
        ("confidence_of_no_pounding", chances.vanmarcke),
        ("confidence_of_no_pounding_poisson", chances.poisson),
    ):
        table[name] = over_gaps(chance.reshape(len(chance), count, -1), distance, TIME, HEIGHT)
    if np.isnan(heights[0]):  # of two oscillators
        return table.isel({HEIGHT: 0})
    axis = labels.axis(HEIGHT, "height above the ground", heights, "m")
    return _at_all_heights(table.assign_coords({HEIGHT: axis}))


def _at_all_heights(table: xr.Dataset) -> xr.Dataset:
    """The worst probabilities of all heights, and the moments at the highest one.

    The variables at each height have the ending ``_at_height``; the displacements have none.
    ``confidence_of_no_pounding_at_least`` is Boole's bound.
    """
    confidences = [f"confidence_of_no_pounding{ending}" for ending in ("", "_poisson")]
    worst = table[["instantaneous_probability", "required_gap"]].max(HEIGHT, skipna=False)
    worst = worst.assign(table[confidences].min(HEIGHT, skipna=False).data_vars)
    for name, array in table.items():
        if not str(name).startswith("displacement"):
            worst[f"{name}_at_height"] = array
    missed = (1 - table.confidence_of_no_pounding).sum(HEIGHT, skipna=False)
    worst["confidence_of_no_pounding_at_least"] = (1 - missed).clip(0)
    governing = table.required_gap.fillna(-1.0).idxmax(HEIGHT)
    worst["governing_height"] = governing.where(table.required_gap.notnull().all(HEIGHT))
    return table.isel({HEIGHT: -1}, drop=True).assign(worst.data_vars)


def checked_gaps(gap: Parameter, *names: str) -> Gap:
    """The gaps; a ValueError if a dimension is named as one of the result or of ``names``.

    Gaps along the motions would be those of one motion each.
    """
    distance = Gap(gap)
    array = distance.arrays()["gap"]
    check_names((*array.dims, *array.coords), {PATH, TIME, HEIGHT, "status", *names})
    return distance


def gaps_in_a_row(distance: Gap) -> Array:
    """The gaps (g,) [m], and 1 m in place of invalid ones."""
    return distance.arrays()["gap"].where(distance.valid(), 1.0).to_numpy().ravel()


def over_gaps(values: Array, distance: Gap, *dims: str) -> xr.DataArray:
    """Values (..., g) over these dimensions and those of the gap; NaN for invalid gaps."""
    gap = distance.arrays()["gap"]
    shape = values.shape[:-1] + gap.shape
    array = xr.DataArray(values.reshape(shape), gap.coords, [*dims, *gap.dims])
    return array.where(distance.valid())
