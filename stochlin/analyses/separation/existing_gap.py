"""What an existing gap allows: strength, intensity of the motion, and added damping."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.analyses.linearization.equivalent_systems import solve_structure
from stochlin.analyses.linearization.strength import solved_reduction_factor, strength_in_metres
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.separation.variables import VARIABLES
from stochlin.analyses.simulation.finite_motions import keeping_apart, pair_separation
from stochlin.analyses.simulation.simulation import check_repeated, simulate
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_confidence, check_existing, check_scatter
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_mode, weaker
from stochlin.models.uncertain import applied, median_of

STRENGTHS = np.geomspace(1 / 8, 8, 13)  # factors on both reduction factors
AMPLITUDES = np.geomspace(1 / 16, 16, 17)  # factors on the motion
DAMPINGS = np.linspace(0, 0.4, 9)  # added to both
MOST_DAMPING = 0.999
CLOSE = 1e-3  # relative, of what is searched
SIMULATIONS = 60  # that the three searches take together, as a rule


def existing_gap(
    first: AnyStructure,
    second: AnyStructure,
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
    """What two buildings may be, or may be hit by, where the gap between them is given.

    One question at a time, everything else as it is; all by simulation, on the same motions.

    Parameters
    ----------
    first, second, ground, duration
        As in `separation`.
    gap : float
        The existing gap [m], positive.
    envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the share of the work that is done, by a guess.

    Returns
    -------
    xarray.Dataset
        Without dimensions: ``no_pounding_probability`` [-] as things are, with its 95 % interval;
        ``required_gap`` [m]; ``largest_reduction_factor_1`` and ``_2`` [-]: both strengths lowered
        alike, as far as the confidence holds throughout (of a building with storeys, that of its first
        mode); ``largest_intensity`` [m^2/s^3] of the ground, strengths in metres kept;
        ``least_added_damping`` [-], the same ratio added to both.
        Infinite where the confidence holds over all of the range that was searched, NaN where it
        holds nowhere; ``searched`` in the attributes says which it was.

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
    both = {"first": median_of(first), "second": median_of(second)}
    for role, structure in both.items():
        expect(structure, STRUCTURES, role)
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

    def required(pair: Sequence[AnyStructure], ground: Ground) -> float:
        return float(np.quantile(separations(pair, ground), confidence))

    samples = separations([first, second], ground)
    case = _ExistingPair.of((first, second), ground)
    strength = first_above(lambda s: required(case.weaker(s), ground), STRENGTHS, gap)
    amplitude = first_above(lambda a: required(case.pair, case.stronger(a)), AMPLITUDES, gap)
    damping = first_below(lambda x: required(case.damped(x), ground), DAMPINGS, gap)
    intensity = float(median_of(ground).arrays()["intensity"])
    table = xr.Dataset(
        {
            **keeping_apart(samples, float(gap)),
            "required_gap": float(np.quantile(samples, confidence)),
            **{f"largest_reduction_factor_{n}": r * strength for n, r in enumerate(case.factors, 1)},
            "largest_intensity": intensity * amplitude**2,
            "least_added_damping": damping,
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
        f"What an existing gap allows, {median_of(ground).name} ground",
        f"existing_gap(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        {"first": first, "second": second, "ground": ground},
    )


class _ExistingPair(NamedTuple):
    """The pair by its yield displacements, and how to change it."""

    pair: tuple[Any, Any]
    ground: Ground
    factors: tuple[float, float]  # reduction factors, NaN where elastic

    @classmethod
    def of(cls, structures: tuple[AnyStructure, AnyStructure], ground: Ground) -> _ExistingPair:
        usual = median_of(ground)
        one, other = (applied(lambda s: strength_in_metres(s, usual), each) for each in structures)
        modes = [first_mode(median_of(structure)) for structure in structures]
        solved = [solve_structure(mode, usual, "gaussian", USUAL) for mode in modes]
        first, second = (solved_reduction_factor(*both) for both in zip(modes, solved, strict=True))
        return cls((one, other), ground, (first, second))

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


def first_above(required: Callable[[float], float], grid: Any, gap: float) -> float:
    """Largest value up to which the required gap stays within; infinite if it always does, or NaN."""
    before = np.nan
    for value in grid:
        if required(value) > gap:
            return np.nan if np.isnan(before) else _root(required, before, value, gap)
        before = value
    return np.inf


def first_below(required: Callable[[float], float], grid: Any, gap: float) -> float:
    """Smallest value with which the required gap is within the gap; NaN if there is none."""
    before = np.nan
    for value in grid:
        if required(value) <= gap:
            return float(value) if np.isnan(before) else _root(required, before, value, gap)
        before = value
    return np.nan


def _root(required: Callable[[float], float], low: float, high: float, gap: float) -> float:
    """Where the required gap passes the gap between two values that bracket it."""
    return float(scipy.optimize.brentq(lambda x: required(x) - gap, low, high, rtol=CLOSE, xtol=1e-6))
