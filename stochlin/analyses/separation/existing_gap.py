"""Limits of strength, intensity and added damping for which an existing gap is sufficient."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import solve_elastic
from stochlin.analyses.linearization.strength import solved_reduction_factor, strength_in_metres
from stochlin.analyses.separation.searches import Edge, Required, around, least, up_to
from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.simulation.finite_motions import (
    keeping_apart,
    pair_separation,
    quantile_intervals,
)
from stochlin.analyses.simulation.simulation import check_repeated, simulate
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_existing, standing
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

STRENGTHS = np.geomspace(1 / 8, 8, 13)  # factors of both reduction factors
AS_BUILT = 6  # index of the factor 1 among these
ENDS = "", "_lower", "_upper"
AMPLITUDES = np.geomspace(1 / 16, 16, 17)  # factors of the ground acceleration
DAMPINGS = np.linspace(0, 0.4, 9)  # damping ratios added to both structures
MOST_DAMPING = 0.999
SIMULATIONS = 60  # usual number of simulations of the three searches together


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
    paths: Paths = 2048,
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
    check_existing(gap, duration, both)
    check_repeated(list(both.values()), median_of(ground), duration, paths, SIMULATIONS)
    if progress is not None:
        progress(0.0)
    done = itertools.count(1)

    def separations(pair: Sequence[AnyStructure], ground: Ground) -> xr.DataArray:
        options: dict[str, Any] = {"duration": duration, "envelope": envelope, "scatter": scatter}
        drawn: dict[str, Any] = {"paths": paths, "seed": seed, "quantiles": [confidence]}
        motions = simulate(list(pair), ground, **options, **drawn)
        if progress is not None:
            progress(min(next(done) / SIMULATIONS, 1.0))
        return pair_separation(motions)

    def required(pair: Sequence[AnyStructure], ground: Ground) -> list[float]:
        ends = quantile_intervals(separations(pair, ground).values, np.array([confidence]))
        return [float(end[0]) for end in ends]

    samples = separations(list(structures.values()), ground)
    case = _ExistingPair.of(list(structures.values()), ground)
    by_strength = Required(lambda s: required(case.weaker(s), ground), gap)
    least_factor, largest_factor = around(by_strength, STRENGTHS, AS_BUILT)
    by_amplitude = Required(lambda a: required(case.pair, case.stronger(a)), gap)
    amplitude = up_to(by_amplitude, AMPLITUDES)
    damping = least(Required(lambda x: required(case.damped(x), ground), gap), DAMPINGS)
    intensity = float(median_of(ground).arrays()["intensity"])
    table = xr.Dataset(
        {
            **keeping_apart(samples, float(gap)),
            "required_gap": float(np.quantile(samples, confidence)),
            **_factors("largest", case.factors, largest_factor),
            **_factors("least", case.factors, least_factor),
            **_with_interval("largest_intensity", Edge(*(intensity * a**2 for a in amplitude))),
            **_with_interval("least_added_damping", damping),
        }
    )
    searched = (
        f"reduction factors times {STRENGTHS[0]:g} to {STRENGTHS[-1]:g}, motion times "
        f"{AMPLITUDES[0]:g} to {AMPLITUDES[-1]:g}, added damping to {DAMPINGS[-1]:g}"
    )
    table = labels.label(table, VARIABLES)
    return labels.with_run_information(
        table.assign_attrs(
            gap_m=float(gap), confidence=confidence, searched=searched, **labels.of_scatter(scatter)
        ),
        f"What an existing {'gap' if second is not None else 'set-back'} allows, "
        f"{median_of(ground).name} ground",
        f"existing_gap(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        {**structures, "ground": ground},
    )


def _with_interval(name: str, edge: Edge, end: str = "") -> dict[str, float]:
    return {f"{name}{which}{end}": value for which, value in zip(ENDS, edge, strict=True)}


def _factors(which: str, factors: Sequence[float], edge: Edge) -> dict[str, float]:
    """Reduction factors of the structures at an edge of the range, with their intervals."""
    columns: dict[str, float] = {}
    for n, factor in enumerate(factors, start=1):
        columns |= _with_interval(f"{which}_reduction_factor", edge.times(factor), f"_{n}")
    return columns


class _ExistingPair(NamedTuple):
    """One or two structures with strengths in metres, and their changes."""

    pair: Sequence[Any]  # two structures, or one alone
    ground: Ground
    factors: Sequence[float]  # reduction factors, NaN if elastic

    @classmethod
    def of(cls, structures: Sequence[AnyStructure], ground: Ground) -> _ExistingPair:
        usual = median_of(ground)
        pair = [applied(lambda s: strength_in_metres(s, usual), each) for each in structures]
        modes = [first_mode(median_of(structure)) for structure in structures]
        factors = [solved_reduction_factor(mode, solve_elastic(mode, usual)) for mode in modes]
        return cls(pair, ground, factors)

    def weaker(self, factor: float) -> list[AnyStructure]:
        return [applied(lambda s: weaker(s, factor), structure) for structure in self.pair]

    def stronger(self, amplitude: float) -> Ground:
        return applied(lambda ground: _times(ground, amplitude**2), self.ground)

    def damped(self, added: float) -> list[AnyStructure]:
        return [applied(lambda s: _damped(s, added), structure) for structure in self.pair]


def _times(ground: Any, factor: float) -> Any:
    """The ground with its intensity multiplied by a factor."""
    return replace(ground, intensity=ground.intensity * factor)


def _damped(structure: Any, added: float) -> Any:
    """The structure with added damping; the total ratio is at most `MOST_DAMPING`."""
    return replace(structure, damping=np.minimum(structure.damping + added, MOST_DAMPING))
