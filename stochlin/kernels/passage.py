"""First passage of a level by a Gaussian process that has a fast part and a slow offset.

The fast part crosses the level less the offset at the rate of Vanmarcke, as in `probability`. The
offset is a Markov process, which is followed on a grid: Ehrenfest's chain has the eigenvalues ``0,
-1, -2, ...`` of an Ornstein-Uhlenbeck process, so that a transition with the correlation ``c``
multiplies the coordinate along the eigenvector of ``-j`` by ``c^j``. At each instant the share of
the paths that cross until the next one is taken away.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.stats import binom

from stochlin.kernels.basics.arrays import SQRT_2PI, Array
from stochlin.kernels.basics.compiled import compiled, entry

CHAIN_PLACES = 21
GAP_TOLERANCE = 1e-4  # relative tolerance of a gap
TRIALS = 60  # largest number of trials
# gaps of a search, over the largest standard deviation
NARROWEST_SEARCHED = 1e-3
FIRST_SEARCHED = 2.5
WIDEST_SEARCHED = 14.0
SLOPE = 5.0  # usual slope of the reduced variate over the logarithm of the gap
LEAST_PROBABILITY = 1e-300  # least probability
EPS = 1e-15  # least of its complement


class Chain(NamedTuple):
    """A stationary Gauss-Markov process of variance 1 on a grid."""

    place: Array  # (m,)
    share: Array  # (m,) probability of each place
    into: Array  # (m, m) makes coordinates of probabilities, from that of the eigenvalue 0 on
    back: Array  # (m, m)


def ehrenfest(places: int) -> Chain:
    """Ehrenfest's chain."""
    last = places - 1
    number = np.arange(places)
    rates = (
        np.diag((last - number[:-1]) / 2, 1)
        + np.diag(number[1:] / 2, -1)
        - last / 2 * np.eye(places)
    )
    root = np.sqrt(binom.pmf(number, last, 0.5))
    _, vector = np.linalg.eigh(root[:, None] * rates / root)
    vector = vector[:, ::-1]  # from the constant on
    into = (vector / root[:, None]).T
    back = vector * root[:, None]
    return Chain((2 * number - last) / np.sqrt(last), root**2, into.copy(), back.copy())


CHAIN = ehrenfest(CHAIN_PLACES)


class Passage(NamedTuple):
    """The process ``d`` in c cases, over the instants."""

    std: Array  # (c, instants) standard deviation of the fast part [m]
    crossings: Array  # (c, instants) rate of its upward crossings of 0 [1/s]
    bandwidth: Array  # (c, instants); infinite for independent crossings
    offset: Array  # (c, instants) standard deviation of the slow offset [m]
    memory: Array  # (c, instants) correlation of the offset with that of the instant before
    seconds: Array  # (instants,) time that each of them stands for [s]
    # (c, instants, levels) levels of a Gaussian process that are crossed as often as those of the
    # fast part, at levels of `RELATIVE_LEVELS`; (0, 0, 0) if it is Gaussian itself.
    gaussian: Array


LEVEL_STEP = 0.25  # steps of a table of levels
HIGH = 12.0  # level beyond which nothing is crossed
RELATIVE_LEVELS = LEVEL_STEP * np.arange(57)  # over the standard deviation


@entry
def survival(gaps, passage, chain, shares):  # type: ignore[no-untyped-def]
    """Write the probabilities that ``d`` has not exceeded ``gaps`` (c, g) up to each instant.

    ``shares`` are (c, g, instants).
    """
    now = np.empty_like(chain.share)
    modes = np.empty_like(chain.share)
    for case in range(gaps.shape[0]):
        for number in range(gaps.shape[1]):
            _follow(gaps[case, number], case, passage, chain, now, modes, shares[case, number])


@entry
def required_gaps(confidence, weights, passage, chain, gaps):  # type: ignore[no-untyped-def]
    """Write the gaps (n,) for a confidence; m cases in a row are motions of these ``weights`` (m,).

    By secants of the reduced variate ``-ln(-ln P)`` over the logarithm of the gap, within brackets.
    """
    wanted = -np.log(-np.log(confidence))
    instants = passage.std.shape[1]
    now = np.empty_like(chain.share)
    modes = np.empty_like(chain.share)
    shares = np.empty(instants)
    for number in range(len(gaps)):
        begin = number * len(weights)
        largest = 0.0
        for case in range(begin, begin + len(weights)):
            for instant in range(instants):
                size = passage.std[case, instant] ** 2 + passage.offset[case, instant] ** 2
                largest = max(largest, size)
        if not largest > 0.0:
            gaps[number] = largest  # 0, or NaN
            continue
        low, high = (
            np.log(NARROWEST_SEARCHED * np.sqrt(largest)),
            np.log(WIDEST_SEARCHED * np.sqrt(largest)),
        )
        at = np.log(FIRST_SEARCHED * np.sqrt(largest))
        last = 0.0
        reduced = 0.0
        for trial in range(TRIALS):
            stays = 0.0
            for case in range(begin, begin + len(weights)):
                _follow(np.exp(at), case, passage, chain, now, modes, shares)
                stays += weights[case - begin] * shares[-1]
            before = reduced
            reduced = -np.log(-np.log(min(max(stays, LEAST_PROBABILITY), 1 - EPS)))
            if reduced < wanted:
                low = at
            else:
                high = at
            slope = (reduced - before) / (at - last) if trial > 0 else SLOPE
            last = at
            step = (wanted - reduced) / slope
            at = at + step
            if not low < at < high:
                at = 0.5 * (low + high)
            if abs(at - last) < GAP_TOLERANCE:
                break
        gaps[number] = np.exp(at)


@compiled
def _follow(gap, case, passage, chain, now, modes, shares):  # type: ignore[no-untyped-def]
    """Write probabilities that ``d`` of a case stays below a gap.

    ``now`` and ``modes`` are arrays that are used while these are computed.
    """
    places = len(now)
    instants = passage.std.shape[1]
    warped = len(passage.gaussian) > 0
    now[:] = chain.share
    share = 1.0
    for instant in range(instants):
        memory = passage.memory[case, instant]
        if instant > 0 and memory < 1.0:
            modes[:] = 0.0
            for place in range(places):
                for mode in range(places):
                    modes[mode] += chain.into[mode, place] * now[place]
            factor = 1.0
            now[:] = 0.0
            for mode in range(places):
                for place in range(places):
                    now[place] += chain.back[place, mode] * (factor * modes[mode])
                factor *= memory
        std = passage.std[case, instant]
        offset = passage.offset[case, instant]
        bandwidth = SQRT_2PI * passage.bandwidth[case, instant]
        most = passage.crossings[case, instant] * passage.seconds[instant]
        for place in range(places):
            left = gap - offset * chain.place[place]
            if not left > 0.0:
                now[place] = 0.0
                continue
            level = left / std
            if warped:
                at = level / LEVEL_STEP
                whole = min(int(at), passage.gaussian.shape[2] - 2)
                before = passage.gaussian[case, instant, whole]
                level = before + (at - whole) * (
                    passage.gaussian[case, instant, whole + 1] - before
                )
            if level < HIGH:
                if bandwidth < np.inf:
                    rate = most * -np.expm1(-bandwidth * level) / np.expm1(0.5 * level * level)
                else:  # independent crossings
                    rate = most * np.exp(-0.5 * level * level)
                now[place] = max(now[place], 0.0) * np.exp(-rate)
        share = min(now.sum(), share)  # not more by rounding
        shares[instant] = share
