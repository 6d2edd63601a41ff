"""Limits of strength, intensity and added damping for which an existing gap is sufficient."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.separation.searches import Required, around, least, up_to
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
from stochlin.solver.linearization.equivalent_systems import solve_elastic
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
    half length of their 95 % interval; limits are found with all motions, to 0.1 % of the gap.

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
    least_factor, largest_factor = around(by_strength, STRENGTHS, AS_BUILT)
    amplitude = up_to(required(lambda factor: (pair, amplified(factor)), 1.0), AMPLITUDES)
    added = least(required(lambda more: (changed(damped, more), ground), 0.0), DAMPINGS)
    modes = map(first_mode, both.values())
    factors = [solved_reduction_factor(mode, solve_elastic(mode, usual)) for mode in modes]
    limits = {
        (f"{end}_reduction_factor", f"_{n}"): [factor * times for times in edge]
        for end, edge in (("largest", largest_factor), ("least", least_factor))
        for n, factor in enumerate(factors, start=1)
    }
    limits["largest_intensity", ""] = [float(usual.arrays()["intensity"]) * a**2 for a in amplitude]
    limits["least_added_damping", ""] = [*added]
    table = xr.Dataset(
        {
            **keeping_apart(pair_separation(built), float(gap)),
            "required_gap": required_gaps(built)[0],
            **{
                f"{name}{which}{number}": value
                for (name, number), interval in limits.items()
                for which, value in zip(labels.VALUE_AND_ENDS, interval, strict=True)
            },
        }
    )
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
