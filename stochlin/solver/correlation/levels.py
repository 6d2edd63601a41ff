"""Pairs of bilinear structures in motions of finite length, by the drift closure."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array, on_arrays
from stochlin.kernels.correlation.errors import BOUNDS
from stochlin.kernels.correlation.levels import (
    L1_NODES,
    AtLevels,
    Difference,
    PairRows,
    alone,
    difference,
    pair_rows,
)
from stochlin.kernels.correlation.pairs import drifting_pair, over_pairs, taken
from stochlin.kernels.linearization.covariance import own_covariance
from stochlin.kernels.linearization.drift import drifting_correlation
from stochlin.kernels.linearization.harmonic import Harmonic, load_levels, share_of_load
from stochlin.kernels.linearization.levels import StructureInTime, Tables, levels_for
from stochlin.kernels.linearization.spectral_moments import bandwidth_of, displacement_moments
from stochlin.kernels.passage import CHAIN, RELATIVE_LEVELS, Passage, required_gaps, survival
from stochlin.models.grounds import Ground
from stochlin.models.structures import Structure
from stochlin.solver.correlation.signatures import drifting
from stochlin.solver.linearization.equivalent_systems import Oscillators, joined
from stochlin.solver.linearization.levels import (
    EnvelopesInTime,
    SolvedLevels,
    structures_in_time,
    yielding,
)
from stochlin.solver.linearization.transient_systems import STRONG_SHARE
from stochlin.solver.tables.cells import flat
from stochlin.solver.tables.checks import USUAL_TOLERANCE

LEAST_DRIFT_SHARE = 1e-6  # of the drift in a standard deviation
# Kinds of pairs with larger errors: logarithm of the ratio of periods, damping of the ground,
# smaller frequency over that of the ground, and cycles of the longer period in strong shaking.
ALIKE_PERIODS = 0.08
NARROW_GROUND_DAMPING = 0.2
STIFF_FREQUENCY_RATIO = 1.2
BRIEF_CYCLES = 0.7
ROUNDING_OF_DAMPING = 1e-9  # a damping of 0.2 counts as narrow
# Mean absolute error of the gap for 90 % by kind, of 900 simulated pairs
# (benchmarks/finite_drift.py).
GAP_ERRORS = {
    "usual": 0.05,
    "brief": 0.06,
    "alike": 0.075,
    "narrow": 0.1,
    "stiff": 0.11,
    "stiff on narrow": 0.135,
}


class ExpectedErrors(NamedTuple):
    """What is known of the gaps of n pairs for 90 %, from simulated pairs of the same kind."""

    error: Array  # (n,) mean absolute relative error
    # (n,) 1 where errors are larger than usual, 2 on grounds that were not simulated
    caution: Array


class PairsInTime(NamedTuple):
    """n pairs, or structures alone, in m motions of one course: arrays (instants, n m)."""

    course: EnvelopesInTime
    first: StructureInTime
    second: StructureInTime | None
    moves: Difference
    joint: Array  # covariance of both displacements [m^2]
    gaussian: Array  # levels of the load, see `Passage`
    failed: Array  # (n,)
    expected: ExpectedErrors

    def passage(self) -> Passage:
        """The passage of levels by ``u_1 - u_2``."""
        seconds = np.full_like(self.course.times, self.course.step)
        seconds[[0, -1]] /= 2
        std, velocity, bandwidth, offset, memory = self.moves
        moves = std > 0
        rate = np.where(moves, velocity / np.where(moves, 2 * np.pi * std, 1.0), 0.0)
        memory = np.vstack([np.ones_like(memory[:1]), memory])
        rows = [np.ascontiguousarray(row.T) for row in (std, rate, bandwidth, offset, memory)]
        return Passage(rows[0], rows[1], rows[2], rows[3], rows[4], seconds, self.gaussian)

    def part(self, motions: slice) -> PairsInTime:
        """Some of the motions of a single pair."""

        def some(rows: Any) -> Any:
            return on_arrays(lambda row: row[..., motions], rows)

        return self._replace(
            course=self.course._replace(weights=self.course.weights[motions]),
            first=some(self.first),
            second=some(self.second),
            moves=some(self.moves),
            joint=some(self.joint),
            gaussian=self.gaussian[motions],
        )

    @property
    def difference(self) -> Array:
        """Variance of ``u_1 - u_2`` (instants, n m) [m^2]."""
        return self.moves.displacement**2 + self.moves.offset**2

    def means(self, values: Array) -> Array:
        """Means (instants, n) over the motions of values (instants, n m)."""
        weights = self.course.weights
        mean: Array = values.reshape(len(values), -1, weights.size) @ weights
        return mean

    def strong_rho(self) -> Array:
        """Correlation (n,) of both displacements while shaking is strong, by mean covariances."""
        assert self.second is not None
        strong = self.course.envelope.max(axis=1) >= STRONG_SHARE

        def while_strong(values: Array) -> Array:
            """Sums (n,) of means over the motions."""
            sums: Array = self.means(values)[strong].sum(axis=0)
            return sums

        variances = while_strong(self.first.variance) * while_strong(self.second.variance)
        rho: Array = while_strong(self.joint) / np.sqrt(variances)
        return rho

    def required_gaps(self, confidence: float) -> Array:
        """Gaps (n,) [m] for a confidence of no passage in the motions."""
        gaps = np.empty(self.failed.size)
        required_gaps(confidence, self.course.weights, self.passage(), CHAIN, gaps)
        return np.where(self.failed, np.nan, gaps)

    def survival(self, gaps: Array, *, independent: bool = False) -> Array:
        """Probability (n, g, instants) that gaps (n, g) [m] have not been exceeded.

        The crossings come in clumps, unless they are ``independent``.
        """
        passage = self.passage()
        if independent:
            passage = passage._replace(bandwidth=np.full_like(passage.bandwidth, np.inf))
        weights = self.course.weights
        count = self.failed.size
        motions = weights.size
        instants = self.course.times.size
        shares = np.empty((count * motions, gaps.shape[1], instants))
        survival(np.repeat(gaps, motions, axis=0), passage, CHAIN, shares)
        mean = np.einsum("m,nmgt->ngt", weights, shares.reshape(count, motions, -1, instants))
        return np.where(self.failed[:, None, None], np.nan, mean)


@np.errstate(all="ignore")  # failed structures are NaN
def pairs_in_time(
    cells: Sequence[Oscillators], ground: Ground, course: EnvelopesInTime
) -> PairsInTime:
    """One or two structures in each of n cells, with strengths in metres."""
    structures = structures_in_time(joined(cells), ground, course)
    sides = structures.number.reshape(len(cells), -1)
    first = structures.moving(sides[0])
    solved = structures.solved
    motions = course.weights.size
    second = None
    if len(cells) == 1:
        tables = Tables.of(solved.levels, _bandwidth(solved)[None])
        bandwidth = tables.at(first.square, np.repeat(sides[0], motions))[0]
        moves = alone(first, bandwidth, course.step)
        joint = np.zeros_like(first.square)
    else:
        second = structures.moving(sides[1])
        tables = Tables.of(solved.levels, np.array(_pair_rows(solved, *sides)))
        square = np.sqrt(first.square * second.square)
        rows = PairRows(*tables.at(square, np.repeat(np.arange(sides.shape[1]), motions)))
        envelope = np.tile(course.envelope, sides.shape[1])
        moves, joint = difference(first, second, rows, envelope, course.step)
    return PairsInTime(
        course=course,
        first=first,
        second=second,
        moves=moves,
        joint=joint,
        gaussian=_levels_of_load(cells, ground, course),
        failed=np.any(solved.failed[sides], axis=0),
        expected=expected_errors(cells, ground, course),
    )


def lone_pair_in_time(
    structures: Sequence[Structure], ground: Ground, course: EnvelopesInTime
) -> PairsInTime:
    """One pair or structure, with strengths in metres; an ArithmeticError without a solution."""
    cells = [flat({"structure": structure, "ground": ground}) for structure in structures]
    pairs = pairs_in_time([Oscillators.of(oscillators) for oscillators in cells], ground, course)
    if pairs.failed.any():
        raise ArithmeticError("the drift closure has no solution; give less extreme parameters")
    return pairs


def expected_errors(
    cells: Sequence[Oscillators], ground: Ground, course: EnvelopesInTime
) -> ExpectedErrors:
    """Expected errors of pairs by their kind."""
    frequencies = np.array([2 * np.pi / oscillators.period for oscillators in cells])
    alike = np.ptp(np.log(frequencies), axis=0) < ALIKE_PERIODS if len(cells) > 1 else False
    narrow: Array | bool = False
    stiff: Array | bool = False
    soil = ground.filter_of(cells[0].soil)
    if soil.oscillators:
        frequency = np.sqrt(soil.oscillators[0])
        damping = soil.oscillators[1] / (2 * frequency)
        narrow = damping < NARROW_GROUND_DAMPING * (1 + ROUNDING_OF_DAMPING)
        stiff = frequencies.min(axis=0) > STIFF_FREQUENCY_RATIO * frequency
    cycles = course.strong_seconds * frequencies.min(axis=0) / (2 * np.pi)
    error = np.where(cycles < BRIEF_CYCLES, GAP_ERRORS["brief"], GAP_ERRORS["usual"])
    error = np.where(alike, GAP_ERRORS["alike"], error)
    error = np.where(stiff, GAP_ERRORS["stiff"], np.where(narrow, GAP_ERRORS["narrow"], error))
    error = np.where(narrow & np.asarray(stiff), GAP_ERRORS["stiff on narrow"], error)
    if soil.states and not soil.oscillators:
        return ExpectedErrors(np.full_like(error, np.nan), np.full(error.size, 2, np.int8))
    return ExpectedErrors(error, (error > GAP_ERRORS["usual"]).astype(np.int8))


def _bandwidth(solved: SolvedLevels) -> Array:
    """Bandwidth of the displacement of each structure at each level."""
    return bandwidth_of(*displacement_moments(solved.system, solved.forcing, solved.soil))


def _pair_rows(solved: SolvedLevels, first: Array, second: Array) -> PairRows:
    """Rows of pairs (n levels,) of structures with these numbers (n,)."""
    both = drifting(solved.solved, USUAL_TOLERANCE)
    count = solved.levels.size
    frequency = np.sqrt(solved.system.stiffness)
    nodes = np.broadcast_to(L1_NODES, (len(L1_NODES), frequency.size))
    structures = AtLevels(
        solved.system,
        solved.forcing,
        own_covariance(solved.system, solved.forcing),
        both.side,
        solved.rows,
        np.tile(solved.levels, frequency.size // count),
        solved.soil.later(solved.system, nodes),
    )
    places = [(side[:, None] * count + np.arange(count)).ravel() for side in (first, second)]
    unused = np.full(len(BOUNDS) + 1, np.nan)  # errors of rho
    rho = over_pairs(partial(drifting_pair, unused), both, both, places, 6)[0]
    derived = over_pairs(drifting_correlation, both.side, both.side, places)[0]
    share = solved.solved.values["drift_std"] / np.sqrt(both.side.variance)
    share = np.maximum(share, LEAST_DRIFT_SHARE)
    added = (rho - derived) / (share[places[0]] * share[places[1]])
    firsts = taken(structures, places[0])
    seconds = taken(structures, places[1])
    return pair_rows(firsts, seconds, np.clip(np.nan_to_num(added), -1, 1))


def _levels_of_load(cells: Sequence[Oscillators], ground: Ground, course: EnvelopesInTime) -> Array:
    """Levels (n m, instants, levels) of the load, where not the response but the load is Gaussian.

    See eq. (20); without such pairs the array is empty.
    """
    soil = ground.filter_of(cells[0].soil)
    none = np.empty((0, 0, 0))
    if not soil.oscillators:
        return none
    frequency = np.sqrt(soil.oscillators[0])
    damping = soil.oscillators[1] / (2 * frequency)
    frequencies = np.array([2 * np.pi / oscillators.period for oscillators in cells])
    pairs = zip(frequencies.T, frequency, damping, strict=True)
    shares = np.array([share_of_load(*pair) for pair in pairs])
    if not shares.any():
        return none
    count = shares.size
    instants, motions = course.envelope.shape
    result = np.empty((count, motions, instants, RELATIVE_LEVELS.size))
    result[:] = RELATIVE_LEVELS
    variance = np.pi * soil.intensity * frequency * (1 + 4 * damping**2) / (2 * damping)
    std = course.scale * np.sqrt(variance)
    levels = levels_for(course.spread)
    structures = [yielding(oscillators) for oscillators in cells]
    for cell in np.flatnonzero(shares):
        harmonics = [
            Harmonic.of(
                2 * np.pi / structure.period[cell],
                structure.damping[cell],
                structure.hardening[cell],
                structure.strength[cell],
                frequency[cell],
            )
            for structure in structures
        ]
        rows = [
            load_levels(harmonics, std[cell] * level, shares[cell], RELATIVE_LEVELS)
            for level in levels
        ]
        tables = Tables.of(levels, np.array(rows).T)
        levels_in_time = tables.at(course.envelope**2, np.zeros(motions, int))
        result[cell] = levels_in_time.transpose(2, 1, 0)
    return result.reshape(count * motions, instants, RELATIVE_LEVELS.size)
