"""Limits of strength, intensity and added damping for which an existing gap is sufficient.

The required gap comes from a simulation and has a 95 % interval. Each value of a parameter is
simulated only once. Whether a gap is sufficient is often clear from a few motions; an edge is found
with all of them. Its interval is that of the required gap there, over the rate at which the
required gap changes between the trial values on both sides.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
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
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import weaker
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.equivalent_systems import solved_together
from stochlin.solver.linearization.strength import solved_reduction_factor
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures
from stochlin.solver.simulation.statistics import (
    keeping_apart,
    pair_separation,
    quantile_interval,
    required_gaps,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import standing

STRENGTH_FACTORS = np.geomspace(1 / 8, 8, 13)  # factors of both reduction factors
INDEX_OF_FACTOR_1 = 6  # index of the factor 1 among these
AMPLITUDES = np.geomspace(1 / 16, 16, 17)  # factors of the ground acceleration
DAMPINGS = np.linspace(0, 0.4, 9)  # damping ratios added to both structures
MOST_DAMPING = 0.999  # largest total damping ratio of a structure
MOST_SIMULATIONS = 12  # of the three searches together, as far as this is usual
# mean work of the three searches, in simulations of all motions
WORK_OF_SEARCHES = 8.0

# in place of a rate of 0: the interval is then the range of the search
SMALLEST_RATE = np.finfo(float).tiny
GAP_OF_FALLEN = 1e6  # [m], in place of a required gap that is infinite, since a structure falls
# relative difference of a simulated gap, or of two values, from which limits follow
CLOSE_GAPS = 1e-2
FEW_DIVISOR = 8  # trial values are simulated with one motion in so many
LEAST_FEW = 64  # and with at least so many
# half 95 % intervals between a gap from a few motions and the existing gap, with which these decide
CLEAR_DISTANCE = 1.5


Ends = tuple[float, float, float]  # required gap, and the ends of its interval [m]


class Edge(NamedTuple):
    """A value at which the required gap equals the existing one, and its 95 % interval."""

    value: float
    lower: float = np.nan
    upper: float = np.nan


NO_EDGE = Edge(np.nan)
NO_LIMIT = Edge(np.inf)


@dataclass
class Required:
    """The required gap by simulation as a function of a value.

    Whether a gap is sufficient is decided by a few motions, where these are clear.
    """

    gaps: Callable[[float, int], Ends]  # for a value and a number of motions
    existing: float  # the existing gap [m]
    paths: int  # the number of all motions
    simulated: dict[tuple[float, int], Ends]  # simulated so far

    def __call__(self, value: float) -> float:
        """Required gap at a value [m]."""
        return float(self._at(value, self.paths)[0])

    def _at(self, value: float, paths: int) -> Array:
        key = float(value), paths
        if key not in self.simulated:
            self.simulated[key] = self.gaps(*key)
        return np.minimum(self.simulated[key], GAP_OF_FALLEN)

    def enough(self, value: float) -> bool:
        """Whether the existing gap is sufficient at a value."""
        few = max(self.paths // FEW_DIVISOR, LEAST_FEW)
        if few < self.paths and (float(value), self.paths) not in self.simulated:
            gap, lower, upper = self._at(value, few)
            clearly_enough = gap + CLEAR_DISTANCE * (upper - gap) < self.existing
            clearly_too_little = gap - CLEAR_DISTANCE * (gap - lower) > self.existing
            if clearly_enough or clearly_too_little:
                return bool(gap < self.existing)
        return self(value) <= self.existing

    def end(
        self, grid: Sequence[float] | Array, order: Iterable[int], direction: int, open_end: Edge
    ) -> Edge:
        """End, on one side, of the sufficient values around the first in this order of a grid.

        It is `NO_EDGE` if there is no such value, and ``open_end`` if all on that side are
        sufficient.
        """
        n = next((n for n in order if self.enough(grid[n])), None)
        if n is None:
            return NO_EDGE
        while 0 <= n < len(grid) and self.enough(grid[n]):
            n += direction
        if not 0 <= n < len(grid):
            return open_end
        edge = self._edge(*sorted((float(grid[n - direction]), float(grid[n]))))
        return Edge(*np.clip(edge, grid[0], grid[-1]).tolist())

    def least(self, grid: Sequence[float] | Array) -> Edge:
        """First sufficient value; `NO_EDGE` if there is none."""
        return self.end(grid, range(len(grid)), -1, Edge(*[float(grid[0])] * 3))

    def _edge(self, low: float, high: float) -> Edge:
        """The edge between two values of which one is sufficient, by a few motions at least."""
        root = min(low, high, key=lambda value: abs(self._excess(value)))
        # Otherwise the gap at this value is close, or all motions contradict the few.
        if self._excess(low) * self._excess(high) < 0:
            root = scipy.optimize.brentq(self._excess, low, high, rtol=CLOSE_GAPS, xtol=1e-6)
        rate = (self(high) - self(low)) / (high - low) or SMALLEST_RATE
        gap, *ends = self._at(root, self.paths)
        simulated = sorted(
            (self(x), x) for x, n in self.simulated if n == self.paths and low <= x <= high
        )
        value = float(np.interp(self.existing, *np.transpose(simulated)))
        ends = [value + (gap - end) / rate for end in ends]
        # A structure falls there, so that the rate has no use.
        if max(self(low), self(high)) >= GAP_OF_FALLEN:
            ends += [low, high]
        return Edge(value, min(ends), max(ends))

    def _excess(self, value: float) -> float:
        """Required gap less the existing one [m]; 0 if it is close."""
        excess = self(value) - self.existing
        return 0.0 if abs(excess) <= CLOSE_GAPS * self.existing else excess


@checked(uncertain=True, in_metres=True)
def existing_gap(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    gap: Metres,
    *,
    duration: Duration,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter | None = None,
    paths: Paths | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Limits of strength, intensity and added damping for which an existing gap is sufficient.

    Each limit is found separately, with everything else unchanged, by simulation with the same
    motions.

    Parameters
    ----------
    first, second, ground
        As in `separation`. If ``second`` is None, the result is for one building beside its
        property line.
    gap : float
        Existing gap, or distance of one building from its property line [m], positive.
    duration, envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the approximate share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Without dimensions: ``no_pounding_probability`` [-] as built, with its 95 % interval;
        ``required_gap`` [m]; ``largest_reduction_factor_1`` and ``_2`` and
        ``least_reduction_factor_1`` and ``_2`` [-], the range of reduction factors around the
        present ones with the required confidence, when both strengths are changed by the same
        factor (for a building with storeys, those of its first mode); ``largest_intensity``
        [m^2/s^3] of the ground, up to which the gap has the confidence, with unchanged strengths in
        metres; and ``least_added_damping`` [-], the same damping ratio added to both structures.
        Each limit has a 95 % interval ``_lower`` and ``_upper``.

        If the gap lacks the confidence as built, the range of reduction factors is the next one
        with the confidence. A largest value is infinite, and a least value 0, if the confidence
        holds up to the end of the searched range, which is the attribute ``searched``. A limit is
        NaN if the confidence holds nowhere in this range.

    Raises
    ------
    ValueError, TypeError
        If the gap is not positive; otherwise as in `separation`.

    Notes
    -----
    Trial values are simulated with one motion in eight, at least 64, where these decide by one and
    a half times the half length of their 95 % interval. Limits are interpolated between values that
    are simulated with all motions, of which one requires the existing gap within 1 %. Their
    intervals are that of the required gap there, over its rate of change between the trial values
    on both sides.

    A least reduction factor above 0 means that the gap is not sufficient for stronger structures,
    for instance if they are in resonance while elastic.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for the least supplemental damping, which is found here by
    simulation.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.existing_gap(one, two, ground, gap=0.08, duration=20.0, paths=128)
    >>> bool(table.required_gap > 0.08), bool(table.least_added_damping > 0)
    (True, True)
    """
    structures = standing(first, second)
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)
    search = GapSearch.of(structures, ground, gap, confidence, motion, paths)
    if progress is not None:
        progress(0.0)
    motions = search.prepared.enough(confidence)
    rest = part_of(progress, 1 / (1 + WORK_OF_SEARCHES), 1.0)
    return search.limits(pair_separation(motions), rest)


@dataclass
class GapSearch:
    """The search for the limits within which the existing ``gap`` [m] is sufficient."""

    structures: Mapping[str, AnyStructure]  # by role, as described
    prepared: PreparedStructures
    gap: float
    confidence: float

    @classmethod
    def of(
        cls,
        structures: Mapping[str, AnyStructure],
        ground: Ground,
        gap: float,
        confidence: float,
        motion: FiniteMotion,
        paths: int | None,
    ) -> GapSearch:
        """The search for structures by role; raises as `existing_gap`."""
        prepared = PreparedStructures.of(structures, ground, motion, paths, MOST_SIMULATIONS)
        return cls(structures, prepared, gap, confidence)

    def limits(self, samples: xr.DataArray, progress: Progress | None) -> xr.Dataset:
        """The result of `existing_gap`, from the gap [m] each motion (``path``) needs as built."""
        as_built = quantile_interval(samples.values, self.confidence)
        prepared = self.prepared
        done = 0.0
        advance = part_of(progress, 0.0, 1.0)
        advance(0.0)

        def required(change: Callable[[float], dict[str, Any]], present: float) -> Required:
            def gaps(value: float, paths: int) -> Ends:
                nonlocal done
                motions = prepared.simulated(paths, self.confidence, **change(value))
                done += paths / samples.size
                advance(done / max(WORK_OF_SEARCHES, done + 1))
                return required_gaps(motions)

            return Required(gaps, self.gap, samples.size, {(present, samples.size): as_built})

        def changed(change: Callable[[Any, float], Any], value: float) -> dict[str, Any]:
            models = prepared.structures
            structures = [applied(lambda s: change(s, value), model) for model in models]
            return {"structures": structures}

        def amplified(amplitude: float) -> dict[str, Any]:
            factor = amplitude**2
            ground = applied(lambda g: replace(g, intensity=g.intensity * factor), prepared.ground)
            return {"ground": ground}

        required_by_strength = required(partial(changed, weaker), 1.0)
        # The present strength, or the next that is sufficient, sought among stronger structures
        # first.
        stronger = range(INDEX_OF_FACTOR_1, -1, -1)
        order = *stronger, *range(INDEX_OF_FACTOR_1 + 1, STRENGTH_FACTORS.size)
        least_factor = required_by_strength.end(STRENGTH_FACTORS, order, -1, Edge(0.0))
        largest_factor = required_by_strength.end(STRENGTH_FACTORS, order, 1, NO_LIMIT)
        required_by_shaking = required(amplified, 1.0)
        amplitude = required_by_shaking.end(AMPLITUDES, [0], 1, NO_LIMIT)
        added = required(partial(changed, damped), 0.0).least(DAMPINGS)
        columns: dict[str, Any] = {**keeping_apart(samples, self.gap), "required_gap": as_built[0]}
        advance(1.0)
        usual = prepared.usual
        modes = [median_of(structure).first_mode() for structure in self.structures.values()]
        factors = [solved_reduction_factor(mode, solved_together((mode,), usual)) for mode in modes]
        limits: dict[str, Any] = {}
        for end, edge in (("largest", largest_factor), ("least", least_factor)):
            for n, factor in enumerate(factors, start=1):
                limits[f"{end}_reduction_factor{{}}_{n}"] = float(factor) * np.array(edge)
        limits["largest_intensity{}"] = float(usual.arrays()["intensity"]) * np.square(amplitude)
        limits["least_added_damping{}"] = added
        for name, edge in limits.items():
            columns |= {name.format(end): edge[k] for k, end in enumerate(labels.VALUE_AND_ENDS)}
        return self._labelled(xr.Dataset(columns))

    def _labelled(self, table: xr.Dataset) -> xr.Dataset:
        """The table with labels, and what was searched."""
        gap = self.gap
        motion = self.prepared.motion
        confidence = self.confidence
        searched = (
            f"reduction factors times {STRENGTH_FACTORS[0]:g} to {STRENGTH_FACTORS[-1]:g}, "
            f"motion times {AMPLITUDES[0]:g} to {AMPLITUDES[-1]:g}, "
            f"added damping to {DAMPINGS[-1]:g}"
        )
        what = "gap" if len(self.structures) > 1 else "set-back"
        about = {"searched": searched, **labels.of_scatter(motion.scatter)}
        return labels.with_run_information(
            labels.label(table).assign_attrs(gap_m=gap, confidence=confidence, **about),
            f"What an existing {what} allows, {self.prepared.usual.name} ground",
            f"existing_gap(gap={gap:g}, duration={motion.duration:g}, confidence={confidence:g}, "
            f"seed={motion.seed})",
            {**self.structures, "ground": self.prepared.ground},
        )


def damped(structure: Any, added: Any) -> Any:
    """The structure with added damping; the total ratio is at most `MOST_DAMPING`."""
    return replace(structure, damping=np.minimum(structure.damping + added, MOST_DAMPING))
