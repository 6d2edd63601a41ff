"""Fragility: probability of pounding over the intensity of the motion and the gap."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.probability.axes import Draws
from stochlin.applications.probability.probability import REFERENCES, PathsIfAny, with_samples
from stochlin.applications.probability.simulated import SAMPLES
from stochlin.applications.probability.variables import VARIABLES
from stochlin.applications.risk.rates import (
    NOT_SIMULATED,
    Fragility,
    SeparationsByIntensity,
    lognormal_fragility,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import Duration, Probability, Scatter, Seed, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, WhiteNoise
from stochlin.models.parameters import Parameter
from stochlin.models.structures import Gap
from stochlin.models.systems import AnyStructure
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.tables import labels

POINTS = 11  # instants of a calculation, of which only the last one is reported
OPPOSITE = {
    "_simulated_lower": "_simulated_upper",
    "_simulated_upper": "_simulated_lower",
    "_at_most": "_at_least",
}
STATUS = {
    "long_name": "status of the lognormal fragility",
    "flag_values": np.arange(5, dtype=np.int8),
    "flag_meanings": "fitted fewer_than_two_motions_pound all_pound_at_the_lowest_intensity "
    "fewer_than_two_intensities not_simulated",
}
ENDINGS = ("", "_poisson", "_corrected", "_simulated", *OPPOSITE, "_at_height")


@checked
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
    scatter: Scatter = 0.0,
    paths: PathsIfAny = 1024,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Probability of pounding of two given buildings over the intensity of the motion and the gap.

    The strengths of the buildings do not change with the intensity: a ``reduction_factor`` refers to
    ``ground`` as given, and its yield displacement is kept at all intensities.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic, ModifiedClough, ShearBuilding or any other structure
        The structures, as in `pounding_probability`; without formulas if a law cannot be linearized.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with the intensity to which reduction factors refer.
    gap : float or array
        Gaps [m]; a plain array gets the dimension ``gap``.
    intensity : float or array
        Intensities ``S0`` [m^2/s^3]; a plain array gets the dimension ``intensity``.
    duration, envelope, confidence, scatter, paths, seed, progress
        As in `pounding_probability`.

    Returns
    -------
    xarray.Dataset
        Over ``intensity`` and ``gap``: ``pounding_probability`` [-], the probability of pounding in the
        motion by formula with crossings in clumps, and with the endings ``_poisson`` for independent
        crossings, ``_corrected`` for the known bias, ``_simulated`` with a 95 % interval ``_lower`` and
        ``_upper``, and for buildings with storeys ``_at_height`` and ``_at_most``, Boole's upper bound
        for all heights together.

        Over ``intensity``: ``required_gap`` [m], also ``_corrected`` and ``_simulated``, and ``status``.

        Over ``gap``: the lognormal fragility by maximum likelihood from the simulated motions, with
        ``fragility_median`` [m^2/s^3] and ``fragility_dispersion`` [-], the standard deviation of the
        logarithm of ``S0``, both with standard errors. They are NaN, with the reason in
        ``fragility_status``, if fewer than two motions lead to pounding, if all of them do at the lowest
        intensity, for a single intensity, and for invalid cells.

    Raises
    ------
    ValueError, TypeError, ArithmeticError
        As in `pounding_probability`.

    Notes
    -----
    The fragility is fitted to the lowest intensity of pounding in each simulated motion, interpolated as
    in `pounding_risk`. For a motion without pounding, this intensity is known to be above the highest
    one (censored data). Below the lowest intensity separations are taken as proportional to the root of
    ``S0``, as for elastic structures; the lowest intensity should therefore lead to pounding in hardly
    any motion.

    References
    ----------
    Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice, S. O. (1945), Bell Syst. Tech. J. 24; Baker, J. W.
    (2015), Earthquake Spectra 31, for fragilities by maximum likelihood.

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
    named_gap = _named(Gap(gap).gap, "gap", "m", "gap")
    named_intensity = _named(WhiteNoise(intensity).intensity, "intensity", "m^2/s^3", "intensity S0")
    changed: dict[str, Any] = {"intensity": named_intensity}
    models: dict[str, Any] = {
        "first": strength_in_metres(first, ground),
        "second": strength_in_metres(second, ground),
        "ground": replace(ground, **changed),
    }
    draws, motion = Draws(paths, seed, float(scatter)), (duration, envelope, POINTS)
    results = with_samples(models, Gap(named_gap), motion, confidence, draws, progress)
    results = results.isel(time=-1, drop=True)
    table = xr.Dataset()
    for ending in ENDINGS:
        confident = f"confidence_of_no_pounding{OPPOSITE.get(ending, ending)}"
        if confident in results:
            table[f"pounding_probability{ending}"] = 1 - results[confident]
    for ending in ENDINGS:
        if f"required_gap{ending}" in results:
            table[f"required_gap{ending}"] = results[f"required_gap{ending}"]
    if SAMPLES in results:
        table = table.assign(_lognormal(results[SAMPLES], named_gap, named_intensity))
    table["status"] = results.status
    table = labels.label(table, VARIABLES).assign_attrs(results.attrs)
    return labels.with_run_information(
        table,
        f"Fragility of two structures against pounding, {ground.name} ground",
        f"pounding_fragility(duration={duration:g}, confidence={confidence:g}, paths={paths}, "
        f"seed={seed})",
        {"first": first, "second": second, "ground": ground},
        REFERENCES,
    )


def _lognormal(samples: xr.DataArray, gap: Any, intensity: Any) -> dict[str, xr.DataArray]:
    """Lognormal fragility for each gap, from the lowest intensity of pounding in each motion."""
    gap, intensity = xr.DataArray(gap), xr.DataArray(intensity)
    along = intensity.dims if intensity.ndim == 1 and intensity.dims[0] not in gap.dims else ()
    if not along:
        samples, along, levels = samples.expand_dims("of_one"), ("of_one",), np.ones(1)
    else:
        levels, order = np.unique(intensity.to_numpy(), return_index=True)
        samples = samples.isel({along[0]: order})

    def fitted(largest: Array, gap: float) -> tuple[float, ...]:
        if np.isfinite(largest).all() and 0 < gap < np.inf:
            return lognormal_fragility(SeparationsByIntensity(levels, largest, 0.5), gap)
        return Fragility(status=NOT_SIMULATED)

    fits = xr.apply_ufunc(
        fitted,
        samples,
        gap,
        input_core_dims=[["path", *along], []],
        output_core_dims=[[]] * len(Fragility._fields),
        vectorize=True,
    )
    fragility = Fragility(*fits).named()
    status = fragility["fragility_status"].astype(np.int8).drop_attrs()
    return fragility | {"fragility_status": status.assign_attrs(STATUS)}


def _named(value: Any, name: str, units: str, long_name: str) -> Any:
    """A plain array, over the dimension ``case``, as an array over the dimension ``name``."""
    if not isinstance(value, xr.DataArray) or value.dims != ("case",) or "case" in value.coords:
        return value
    return labels.axis(name, long_name, value.to_numpy(), units)
