"""What an existing gap allows: strength, intensity of the motion, and added damping."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import solve_structure
from stochlin.analyses.linearization.strength import solved_reduction_factor, strength_in_metres
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.separation.searches import Edge, Required, around, least, up_to
from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.simulation.finite_motions import (
    keeping_apart,
    pair_separation,
    quantile_intervals,
)
from stochlin.analyses.simulation.simulation import check_repeated, simulate
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_confidence, check_existing, check_scatter, standing
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.systems import AnyStructure, first_mode, weaker
from stochlin.models.uncertain import applied, median_of

STRENGTHS = np.geomspace(1 / 8, 8, 13)  # factors on both reduction factors
AS_BUILT = 6  # of these, the one that changes nothing
ENDS = "", "_lower", "_upper"
AMPLITUDES = np.geomspace(1 / 16, 16, 17)  # factors on the motion
DAMPINGS = np.linspace(0, 0.4, 9)  # added to both
MOST_DAMPING = 0.999
SIMULATIONS = 60  # that the three searches take together, as a rule


def existing_gap(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    duration: float,
    gap: float,
    *,
    envelope: Envelope | None = None,
    confidence: float = 0.9,
    scatter: float = 0.0,
    paths: int = 2048,
    seed: int = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Strength, shaking and added damping for which an existing gap is sufficient.

    Each is searched alone, with everything else unchanged, by simulation with the same motions.

    Parameters
    ----------
    first, second, ground, duration
        As in `separation`; with None for ``second`` of one building beside its property line.
    gap : float
        The existing gap [m], positive; of one building its distance from the line.
    envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the share of the work that is done, by a guess.

    Returns
    -------
    xarray.Dataset
        Without dimensions: ``no_pounding_probability`` [-] as things are, with its 95 % interval;
        ``required_gap`` [m]; ``largest_reduction_factor_1`` and ``_2`` [-]: both strengths lowered
        alike, from the present ones as far as the confidence holds (of a building with storeys, that of
        its first mode), and ``least_reduction_factor_1`` and ``_2`` where it ceases to hold if they are
        raised, as between structures that are in resonance while elastic; if it does not hold at
        present, the ends of the strengths next to it where it does. ``largest_intensity`` [m^2/s^3] of
        the ground, up to which it holds throughout, strengths in metres kept; ``least_added_damping``
        [-], the same ratio added to both. Each with its 95 % interval, ``_lower`` and ``_upper``.
        Infinite, or for a least 0, where the confidence holds to the end of the range that was searched,
        NaN where it holds nowhere; ``searched`` in the attributes says which it was.

    Raises
    ------
    ValueError, TypeError
        If the gap is not positive; otherwise as `separation`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), on least supplemental damping, here found by simulation.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.existing_gap(one, two, ground, 20.0, gap=0.08, paths=128)
    >>> bool(table.required_gap > 0.08), bool(table.least_added_damping > 0)
    (True, True)
    """
    check_confidence(confidence)
    check_scatter(scatter)
    given = standing(first, second)
    both = {role: median_of(structure) for role, structure in given.items()}
    check_existing(gap, duration, both)
    check_repeated(list(both.values()), median_of(ground), duration, paths, seed, SIMULATIONS)
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

    samples = separations(list(given.values()), ground)
    case = _ExistingPair.of(list(given.values()), ground)
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
        {**given, "ground": ground},
    )


def _with_interval(name: str, edge: Edge, end: str = "") -> dict[str, float]:
    return {f"{name}{which}{end}": value for which, value in zip(ENDS, edge, strict=True)}


def _factors(which: str, factors: Sequence[float], edge: Edge) -> dict[str, float]:
    """Reduction factors of the structures at an edge."""
    found: dict[str, float] = {}
    for n, factor in enumerate(factors, start=1):
        found |= _with_interval(f"{which}_reduction_factor", edge.times(factor), f"_{n}")
    return found


class _ExistingPair(NamedTuple):
    """The structures by their yield displacements, and how to change them."""

    pair: Sequence[Any]  # or one of them alone
    ground: Ground
    factors: Sequence[float]  # reduction factors, NaN where elastic

    @classmethod
    def of(cls, structures: Sequence[AnyStructure], ground: Ground) -> _ExistingPair:
        usual = median_of(ground)
        pair = [applied(lambda s: strength_in_metres(s, usual), each) for each in structures]
        modes = [first_mode(median_of(structure)) for structure in structures]
        solved = [solve_structure(mode, usual, "gaussian", USUAL) for mode in modes]
        factors = [solved_reduction_factor(*both) for both in zip(modes, solved, strict=True)]
        return cls(pair, ground, factors)

    def weaker(self, factor: float) -> list[AnyStructure]:
        return [applied(lambda s: weaker(s, factor), structure) for structure in self.pair]

    def stronger(self, amplitude: float) -> Ground:
        return applied(lambda ground: _times(ground, amplitude**2), self.ground)

    def damped(self, added: float) -> list[AnyStructure]:
        return [applied(lambda s: _damped(s, added), structure) for structure in self.pair]


def _times(ground: Any, factor: float) -> Any:
    """The ground with so many times the intensity."""
    return replace(ground, intensity=ground.intensity * factor)


def _damped(structure: Any, added: float) -> Any:
    """The structure with more damping, as much as there can be."""
    return replace(structure, damping=np.minimum(structure.damping + added, MOST_DAMPING))
