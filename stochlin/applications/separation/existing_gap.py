"""Limits of strength, intensity and added damping for which an existing gap is sufficient.

The required gap comes from a simulation and has a 95 % interval. Each value of a parameter is simulated
only once. Whether a gap is sufficient is often clear from a few motions; an edge is found with all of
them. The interval of a found value follows from the same simulations: it contains the values at which
the existing gap is within the interval of the required gap.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import (
    Duration,
    Metres,
    Paths,
    Probability,
    Scatter,
    Seed,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.systems import AnyStructure, first_mode, weaker
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.equivalent_systems import solved_together
from stochlin.solver.linearization.strength import solved_reduction_factor, strength_in_metres
from stochlin.solver.simulation.finite_motions import (
    enough_motions,
    keeping_apart,
    pair_separation,
    required_gaps,
)
from stochlin.solver.simulation.simulation import check_repeated, simulate
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration, standing

STRENGTHS = np.geomspace(1 / 8, 8, 13)  # factors of both reduction factors
AS_BUILT = 6  # index of the factor 1 among these
AMPLITUDES = np.geomspace(1 / 16, 16, 17)  # factors of the ground acceleration
DAMPINGS = np.linspace(0, 0.4, 9)  # damping ratios added to both structures
MOST_DAMPING = 0.999  # largest total damping ratio of a structure
SIMULATIONS = 20  # usual number of simulations of the three searches together

FAR = 1e6  # [m], in place of a required gap that is infinite, since a structure falls
CLOSE = 1e-2  # relative difference of a simulated gap, or of two values, from which limits follow
FEW, LEAST_FEW = 8, 64  # a few motions are one in eight, and at least this many
CLEAR = 2.0  # half 95 % intervals between a gap from a few motions and the limit, so that these decide


Ends = tuple[float, float, float]  # required gap, and the ends of its interval [m]


class Edge(NamedTuple):
    """A value at which the required gap equals the existing one, and its 95 % interval."""

    value: float
    lower: float = np.nan
    upper: float = np.nan


NONE, NO_LIMIT = Edge(np.nan), Edge(np.inf)


class Required:
    """The required gap by simulation as a function of a value; ``most`` is the existing gap.

    ``gaps`` gives it for a value and a number of motions, and ``known`` those of all ``paths`` by value.
    Whether a gap is sufficient is decided by a few motions, where these are clear. ``interval`` says
    whether the intervals of edges are wanted, which take two more simulations each.
    """

    def __init__(
        self,
        gaps: Callable[[float, int], Ends],
        most: float,
        paths: int,
        known: Mapping[float, Ends],
        interval: bool = True,
    ) -> None:
        self.most, self._gaps, self._interval = most, gaps, interval
        self._paths, self._few = paths, max(paths // FEW, LEAST_FEW)
        self._known = {(value, paths): _finite(ends) for value, ends in known.items()}

    def __call__(self, value: float) -> float:
        """Required gap at a value [m]."""
        return self._at(value, self._paths)[0]

    def _at(self, value: float, paths: int) -> Ends:
        key = float(value), paths
        if key not in self._known:
            self._known[key] = _finite(self._gaps(*key))
        return self._known[key]

    def enough(self, value: float) -> bool:
        """Whether the existing gap is sufficient at a value."""
        if self._few < self._paths and (float(value), self._paths) not in self._known:
            gap, least, most = self._at(value, self._few)
            if gap + CLEAR * (most - gap) < self.most or gap - CLEAR * (gap - least) > self.most:
                return gap < self.most
        return self(value) <= self.most

    def first_enough(self, grid: Sequence[float] | Array, order: Iterable[int]) -> int | None:
        """Index of the first sufficient value of a grid in this order; None if there is none."""
        return next((n for n in order if self.enough(grid[n])), None)

    def end(self, grid: Sequence[float] | Array, inside: int | None, way: int, open_end: Edge) -> Edge:
        """End of the sufficient values on one side of ``grid[inside]``, which is sufficient itself.

        It is `NONE` without such a value, and ``open_end`` if all on that side are sufficient.
        """
        if inside is None:
            return NONE
        n = inside
        while 0 <= n < len(grid) and self.enough(grid[n]):
            n += way
        return self._edge(grid[n - way], grid[n]) if 0 <= n < len(grid) else open_end

    def least(self, grid: Sequence[float] | Array) -> Edge:
        """First sufficient value; `NONE` if there is none."""
        return self.end(grid, self.first_enough(grid, range(len(grid))), -1, Edge(*[float(grid[0])] * 3))

    def _edge(self, first: float, second: float) -> Edge:
        """The edge between a sufficient value and one that is not."""
        low, high = sorted((float(first), float(second)))
        if self(first) > self.most or self(second) <= self.most:  # all contradict the few, just so
            root = first if self(first) > self.most else second
        else:
            root = scipy.optimize.brentq(self._excess, low, high, rtol=CLOSE, xtol=1e-6)
        required, *ends = self._at(root, self._paths)
        for end in ends if self._interval else ():  # near these values, the ends equal the limit
            moved = root - (end - required) * (high - low) / (self(high) - self(low))
            if end != required and moved > 0:
                self(moved)
        return self._interpolated(float(root), low, high)

    def _excess(self, value: float) -> float:
        """Required gap less the existing one [m]; 0 if it is close."""
        excess = self(value) - self.most
        return 0.0 if abs(excess) <= CLOSE * self.most else excess

    def _interpolated(self, root: float, low: float, high: float) -> Edge:
        """The value next to ``root`` at which the required gap equals the limit, with its interval."""
        known = {x: ends for (x, paths), ends in self._known.items() if paths == self._paths}
        at = np.array(sorted(known))
        over = np.array([known[x] for x in at]).T - self.most
        passed, *of_ends = (_crossings(at, each) for each in over)
        passed = passed[(passed >= low) & (passed <= high)]
        value = float(min(passed, key=lambda x: abs(x - root), default=root))
        ends = np.concatenate(of_ends)
        below, above = ends[ends <= value], ends[ends >= value]
        return Edge(value, float(below.max(initial=at[0])), float(above.min(initial=at[-1])))


def _finite(ends: Ends) -> Ends:
    required, least, most = np.minimum(ends, FAR)
    return float(required), float(least), float(most)


def _crossings(at: Array, values: Array) -> Array:
    """Positions at which values change sign, by linear interpolation."""
    low, high = values[:-1], values[1:]
    n = np.flatnonzero((low <= 0) != (high <= 0))
    positions: Array = at[n] + (at[n + 1] - at[n]) * low[n] / (low[n] - high[n])
    return positions


@checked
def existing_gap(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    duration: Duration,
    gap: Metres,
    *,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter = 0.0,
    paths: Paths | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Limits of strength, intensity and added damping for which an existing gap is sufficient.

    Each limit is found separately, with everything else unchanged, by simulation with the same motions.

    Parameters
    ----------
    first, second, ground, duration
        As in `separation`. If ``second`` is None, the result is for one building beside its property
        line.
    gap : float
        Existing gap, or distance of one building from its property line [m], positive.
    envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the approximate share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Without dimensions: ``no_pounding_probability`` [-] as built, with its 95 % interval;
        ``required_gap`` [m]; ``largest_reduction_factor_1`` and ``_2`` and
        ``least_reduction_factor_1`` and ``_2`` [-], the range of reduction factors around the present
        ones with the required confidence, when both strengths are changed by the same factor (for a
        building with storeys, those of its first mode); ``largest_intensity`` [m^2/s^3] of the ground,
        up to which the gap has the confidence, with unchanged strengths in metres; and
        ``least_added_damping`` [-], the same damping ratio added to both structures. Each limit has a
        95 % interval ``_lower`` and ``_upper``.

        If the gap lacks the confidence as built, the range of reduction factors is the next one with the
        confidence. A largest value is infinite, and a least value 0, if the confidence holds up to the
        end of the searched range, which is the attribute ``searched``. A limit is NaN if the confidence
        holds nowhere in this range.

    Raises
    ------
    ValueError, TypeError
        If the gap is not positive; otherwise as in `separation`.

    Notes
    -----
    Trial values are simulated with one motion in eight, at least 64, where these decide by twice the
    half length of their 95 % interval. Limits are interpolated between values that are simulated with
    all motions, of which one requires the existing gap within 1 %.

    A least reduction factor above 0 means that the gap is not sufficient for stronger structures, for
    instance if they are in resonance while elastic.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for the least supplemental damping, which is found here by
    simulation.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.existing_gap(one, two, ground, 20.0, gap=0.08, paths=128)
    >>> bool(table.required_gap > 0.08), bool(table.least_added_damping > 0)
    (True, True)
    """
    structures = standing(first, second)
    both = {role: median_of(structure) for role, structure in structures.items()}
    check_duration(duration, both)
    begin, most = check_repeated(list(both.values()), median_of(ground), duration, paths, SIMULATIONS)
    if progress is not None:
        progress(0.0)
    done = 0.0
    motion: Any = {"duration": duration, "envelope": envelope, "scatter": scatter, "seed": seed}

    def simulated(pair: Sequence[AnyStructure], ground: Ground, count: int) -> xr.Dataset:
        nonlocal done
        motions = simulate(list(pair), ground, paths=count, quantiles=[confidence], **motion)
        done += count / max(count, begin)
        if progress is not None:
            progress(min(done / SIMULATIONS, 1.0))
        return motions

    built = enough_motions(partial(simulated, [*structures.values()], ground), begin, most)
    begin = built.sizes["path"]
    usual = median_of(ground)
    pair = [applied(lambda s: strength_in_metres(s, usual), each) for each in structures.values()]

    def changed(change: Callable[[Any, float], Any], value: float) -> list[AnyStructure]:
        return [applied(lambda s: change(s, value), structure) for structure in pair]

    def amplified(amplitude: float) -> Ground:
        return applied(lambda g: replace(g, intensity=g.intensity * amplitude**2), ground)

    def required(change: Callable[[float], tuple[Any, Ground]], as_built: float) -> Required:
        known = {as_built: required_gaps(built)}
        return Required(lambda x, n: required_gaps(simulated(*change(x), n)), gap, begin, known)

    by_strength = required(lambda factor: (changed(weaker, factor), ground), 1.0)
    # The present strength, or the next that is sufficient, sought among stronger structures first.
    inside = by_strength.first_enough(STRENGTHS, (*range(AS_BUILT, -1, -1), *range(AS_BUILT + 1, 13)))
    least_factor = by_strength.end(STRENGTHS, inside, -1, Edge(0.0))
    largest_factor = by_strength.end(STRENGTHS, inside, 1, NO_LIMIT)
    by_shaking = required(lambda factor: (pair, amplified(factor)), 1.0)
    amplitude = by_shaking.end(AMPLITUDES, by_shaking.first_enough(AMPLITUDES, [0]), 1, NO_LIMIT)
    added = required(lambda more: (changed(damped, more), ground), 0.0).least(DAMPINGS)
    modes = map(first_mode, both.values())
    factors = [solved_reduction_factor(mode, solved_together((mode,), usual)) for mode in modes]
    limits: dict[str, Sequence[float]] = {}
    for end, edge in (("largest", largest_factor), ("least", least_factor)):
        for n, factor in enumerate(factors, start=1):
            limits[f"{end}_reduction_factor{{}}_{n}"] = [factor * times for times in edge]
    limits["largest_intensity{}"] = [float(usual.arrays()["intensity"]) * a**2 for a in amplitude]
    limits["least_added_damping{}"] = added
    table = xr.Dataset(keeping_apart(pair_separation(built), float(gap)))
    table["required_gap"] = required_gaps(built)[0]
    for name, interval in limits.items():
        for end, value in zip(labels.VALUE_AND_ENDS, interval, strict=True):
            table[name.format(end)] = value
    searched = (
        f"reduction factors times {STRENGTHS[0]:g} to {STRENGTHS[-1]:g}, motion times "
        f"{AMPLITUDES[0]:g} to {AMPLITUDES[-1]:g}, added damping to {DAMPINGS[-1]:g}"
    )
    table = labels.label(table)
    return labels.with_run_information(
        table.assign_attrs(
            gap_m=float(gap), confidence=confidence, searched=searched, **labels.of_scatter(scatter)
        ),
        f"What an existing {'gap' if second is not None else 'set-back'} allows, {usual.name} ground",
        f"existing_gap(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        {**structures, "ground": ground},
    )


def damped(structure: Any, added: Any) -> Any:
    """The structure with added damping; the total ratio is at most `MOST_DAMPING`."""
    return replace(structure, damping=np.minimum(structure.damping + added, MOST_DAMPING))
