"""Fragility: probability of pounding over the intensity of the motion and the gap."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.probability.formulas import by_formula, checked_gaps
from stochlin.applications.probability.probability import (
    PASSAGE_REFERENCES,
    PathsIfAny,
    closure_in_time,
    simulated_columns,
)
from stochlin.applications.risk.rates import (
    Fragility,
    SeparationsByIntensity,
    lognormal_fragility,
    simulated_separations,
    times_intensity,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.messages import brief
from stochlin.models.arguments import Duration, Probability, Scatter, Seed, as_numbers, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.parameters import Parameter
from stochlin.models.structures import AnyStructure, Gap
from stochlin.models.uncertain import as_array, median_of
from stochlin.solver.linearization.transient_response import IN_TIME, InTime
from stochlin.solver.linearization.transient_systems import check_course, course_of, over_time
from stochlin.solver.simulation.prepared import FiniteMotion, PreparedStructures
from stochlin.solver.simulation.statistics import pounding_shares
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.lazy import arrays_of

FRAGILITY_INSTANTS = 11  # instants of a calculation, of which only the last one is reported
INTENSITY = "intensity"
PROGRESS_OF_CURVES = 0.2  # share of the progress that the formulas have beside the simulation
STATUS = {
    "long_name": "status of the lognormal fragility",
    "flag_values": np.arange(5, dtype=np.int8),
    "flag_meanings": "fitted fewer_than_two_motions_pound all_pound_at_the_lowest_intensity "
    "fewer_than_two_intensities not_simulated",
}


def _by_factor(arguments: Mapping[str, Any]) -> bool:
    """Whether a structure's strength is a reduction factor, so that it has that of the ground."""
    pair = [median_of(arguments.get(role)) for role in ("first", "second")]
    return any(getattr(structure, "reduction_factor", None) is not None for structure in pair)


@checked(in_metres=_by_factor)
def pounding_fragility(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    gap: Parameter,
    intensity: Parameter,
    *,
    duration: Duration,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    closure: InTime | None = None,
    scatter: Scatter | None = None,
    paths: PathsIfAny = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Probability of pounding of two given buildings over the intensity of the motion and the gap.

    The strengths of the buildings do not change with the intensity: a ``reduction_factor`` refers
    to ``ground`` as given, and its yield displacement is kept at all intensities.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic, ModifiedClough, ShearBuilding or other structure
        The structures, as in `pounding_probability`; without formulas if a law cannot be
        linearized.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with the intensity to which reduction factors refer.
    gap : float or array
        Gaps [m]; a plain array gets the dimension ``gap``.
    intensity : float or sequence of float
        Intensities ``S0`` [m^2/s^3], positive and increasing.
    duration, envelope, confidence, closure, scatter, paths, seed, progress
        As in `pounding_probability`.

    Returns
    -------
    xarray.Dataset
        Over ``intensity`` and ``gap``: ``pounding_probability`` [-], the probability of pounding in
        the motion by formula with crossings in clumps, and with the endings ``_poisson`` for
        independent crossings, and ``_simulated`` with a 95 % interval ``_lower`` and ``_upper``. By
        formula it is that of the worst height.

        Over ``intensity``: ``required_gap`` [m], also ``_simulated``, and ``status``.

        Over ``gap``: the lognormal fragility by maximum likelihood from the simulated motions, with
        ``fragility_median`` [m^2/s^3] and ``fragility_dispersion`` [-], the standard deviation of
        the logarithm of ``S0``, both with standard errors. They are NaN, with the reason in
        ``fragility_status``, if fewer than two motions lead to pounding, if all of them do at the
        lowest intensity, for a single intensity, for invalid gaps, and if a structure falls.

    Raises
    ------
    ValueError, TypeError, ArithmeticError
        As in `pounding_probability`; also if the intensities do not increase, or a parameter of the
        structures or the ground is an array.

    Notes
    -----
    The fragility is fitted to the lowest intensity of pounding in each simulated motion,
    interpolated as in `pounding_risk`. For a motion without pounding, this intensity is known to be
    above the highest one (censored data). Below the lowest intensity separations are taken as
    proportional to the root of ``S0``, as for elastic structures; the lowest intensity should
    therefore lead to pounding in hardly any motion.

    References
    ----------
    Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice, S. O. (1945), Bell Syst. Tech. J. 24; Baker,
    J. W. (2015), Earthquake Spectra 31, for fragilities by maximum likelihood.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    >>> firm = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.pounding_fragility(
    ...     one, two, firm, np.linspace(0.1, 0.5, 5), [0.01, 0.04], duration=20.0, paths=64
    ... )
    >>> bool((table.pounding_probability.diff("gap") < 0).all())
    True
    """
    if not isinstance(gap, xr.DataArray) and (gaps := as_array(gap)).ndim == 1:
        gap = labels.axis("gap", "gap", gaps, "m")
    distance = checked_gaps(gap, INTENSITY)
    levels = _increasing(intensity)
    models: dict[str, Any] = {"first": first, "second": second, "ground": ground}
    if arrays := arrays_of(models):
        raise ValueError(
            f"{', '.join(arrays)} is an array; allowed: the numbers of one pair at a time"
        )
    scatter = scatter_of(ground, scatter)
    seconds = check_course(duration, envelope)
    pair = (first, second)
    by_role = {"first": first, "second": second}
    check_duration(seconds, by_role)
    if paths:
        motion = FiniteMotion(seconds, envelope, scatter, seed)
        prepared = PreparedStructures.of(by_role, ground, motion, paths, levels.size)
    shortest = min(float(structure.first_period()) for structure in pair)
    course = course_of(envelope, seconds, shortest, FRAGILITY_INSTANTS)
    taken = closure_in_time(closure, pair)
    along = labels.axis(INTENSITY, "intensity S0", levels, "m^2/s^3")
    table = xr.Dataset(coords={INTENSITY: along})
    comment = IN_TIME[taken]
    try:
        part = part_of(progress, 0.0, PROGRESS_OF_CURVES if paths else 1.0)
        formulas = by_formula(
            pair, ground, distance, course, confidence, scatter, part, taken, levels
        )
        last = xr.concat(formulas, along).isel(time=-1, drop=True)
        for ending in ("", "_poisson"):
            missed = 1 - last[f"confidence_of_no_pounding{ending}"]
            table[f"pounding_probability{ending}"] = missed
        table["required_gap"] = last.required_gap
    except ArithmeticError as error:
        if not paths:
            raise
        comment = f"There are no formulas: {error}."
    if paths:
        rest = part_of(progress, PROGRESS_OF_CURVES, 1.0)
        unit = times_intensity(ground, 1 / float(ground.arrays()[INTENSITY]))
        prepared_at_unit = replace(prepared, ground=unit)
        motions = simulated_separations(prepared_at_unit, levels, levels, 0.5, paths, rest)
        table = table.assign(_simulated_variables(motions, distance, confidence))
    table["status"] = labels.status_where(distance.valid() & xr.ones_like(along, bool))
    table.attrs = {
        **over_time(xr.Dataset(), course).attrs,
        **({"paths": paths, "seed": seed} if paths else {}),
        "confidence": confidence,
        **({"comment": comment} if any(structure.yields for structure in pair) else {}),
        **labels.of_scatter(scatter),
    }
    return labels.with_run_information(
        labels.label(table),
        f"Fragility of two structures against pounding, {ground.name} ground",
        f"pounding_fragility(duration={duration:g}, confidence={confidence:g}, paths={paths}, "
        f"seed={seed})",
        {**models, "gap": distance},
        PASSAGE_REFERENCES,
    )


def _increasing(intensity: Parameter) -> Array:
    """The intensities [m^2/s^3]; a ValueError unless they are positive and increase."""
    allowed = "a positive number, or increasing ones"
    levels = np.atleast_1d(as_numbers(INTENSITY, intensity, allowed)).astype(float)
    if levels.ndim > 1 or not ((np.diff(levels, prepend=0.0) > 0) & (levels < np.inf)).all():
        raise ValueError(f"{INTENSITY} = {brief(intensity)}; allowed: {allowed}")
    return levels


def _simulated_variables(
    motions: SeparationsByIntensity, distance: Gap, confidence: float
) -> dict[str, xr.DataArray]:
    """Simulated probabilities and required gaps, and the lognormal fragility, for each gap."""
    gap = distance.arrays()["gap"]
    samples = xr.DataArray(motions.separation, dims=("path", INTENSITY))
    shares = pounding_shares(samples, gap)
    columns = simulated_columns("pounding_probability", shares, samples, distance, confidence)
    fits = xr.apply_ufunc(
        lambda gap: lognormal_fragility(motions, gap),
        gap,
        output_core_dims=[()] * len(Fragility._fields),
        vectorize=True,
    )
    columns |= {f"fragility_{name}": fit for name, fit in zip(Fragility._fields, fits, strict=True)}
    status = columns["fragility_status"].astype(np.int8).drop_attrs()
    return columns | {"fragility_status": status.assign_attrs(STATUS)}
