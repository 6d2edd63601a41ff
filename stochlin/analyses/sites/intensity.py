"""How strong the motions of a ground are, and the ground whose motions are as strong as is asked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.records.files import METRES
from stochlin.analyses.simulation.ensembles import check_settings
from stochlin.analyses.simulation.finite_motions import mean_with_error
from stochlin.analyses.simulation.ground_motions import USUAL_STEP, simulated_motions
from stochlin.analyses.sites.simulated_spectra import peak_accelerations
from stochlin.analyses.sites.spectra import USUAL_DAMPING, check_damping, check_goal
from stochlin.analyses.sites.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_duration, check_scalars
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, rms_acceleration
from stochlin.models.parameters import expect

PATHS = 1024  # a standard error of about half a per cent
FEWEST, MOST_STEPS = 64, 20_000_000  # the latter of all motions, in memory at once
_TOLD = "intensity for a mean"


def scale_ground(
    ground: Ground,
    duration: float,
    envelope: Envelope | None = None,
    *,
    pga: float | None = None,
    sa: float | None = None,
    period: float | None = None,
    damping: float = USUAL_DAMPING,
    paths: int = PATHS,
    seed: int = 0,
    progress: Progress | None = None,
) -> Any:
    """Scale a ground so that the mean of its motions has a given peak or spectral acceleration.

    Strong by the mean of their peak ground accelerations, or by their mean spectral acceleration at a
    period. Motions go with the square root of ``S0``, so that one simulation is enough.

    Parameters
    ----------
    ground : KanaiTajimi, CloughPenzien, ParallelGround, or of ``sa`` WhiteNoise
        With scalar parameters; its own intensity does not matter.
    duration : float
        Length of each motion [s], positive.
    envelope : AminAng, ShinozukaSato, GammaEnvelope or HsuBernard, optional
        Without it the motions are stationary.
    pga : float, optional
        Mean peak ground acceleration [m/s^2] that is wanted.
    sa, period : float, optional
        Or the mean pseudo-acceleration [m/s^2] that is wanted, at this period [s].
    damping : float
        Damping ratio [-] for ``sa``.
    paths : int
        Motions that are simulated, from 2.
    seed : int
        The same seed gives the same answer, whatever the number of cores.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Ground
        Of the same kind; its ``intensity`` [m^2/s^3] is what was sought; its ``source`` says by what,
        with the standard error of the simulated mean.

    Raises
    ------
    ValueError, TypeError
        If it is not said how strong, or twice; if a number is out of range; if white noise is to have a
        peak ground acceleration.

    References
    ----------
    Derived here: linear elastic response, and the motion itself, are proportional to ``sqrt(S0)``.

    Examples
    --------
    >>> import stochlin as sl
    >>> shape = sl.AminAng(2.0, 12.0, 0.4)
    >>> ground = sl.scale_ground(sl.named_ground("firm", 1.0), 20.0, shape, pga=0.3 * 9.80665)
    >>> table = sl.simulated_spectrum(ground, [0.5], 20.0, shape)
    >>> round(float(table.peak_ground_acceleration) / 9.80665, 9)
    0.3
    """
    expect(ground, Ground, "ground")
    check_scalars(ground, "ground", "numbers")
    check_duration(duration)
    if envelope is not None:
        expect(envelope, Envelope, "envelope")
    check_goal({"pga": pga, "sa": sa}, period)
    check_damping(damping)
    check_settings(paths, seed)
    if pga is not None and not np.isfinite(rms_acceleration(ground)):
        raise ValueError(
            "pga: white noise has no peak, since it grows with smaller time steps; allowed: sa with a "
            "period, or another ground"
        )
    motion: Any = {"duration": duration, "envelope": envelope, "paths": paths, "seed": seed}
    if period is None:
        samples = _peaks(ground, **motion, progress=progress)
    else:
        (samples,) = peak_accelerations(
            np.array([float(period)]), damping, ground, **motion, progress=progress
        ).T
    found, error = mean_with_error(samples)
    wanted = float(pga if sa is None else sa)  # type: ignore[arg-type]
    times = wanted / found
    what = "peak ground acceleration" if sa is None else f"Sa({period:g} s), damping {damping:g},"
    under = "stationary" if envelope is None else envelope.describe()
    text = (
        f"{_TOLD} {what} of {wanted / METRES['g']:.4g} g in motions of {duration:g} s, {under}, "
        f"with a standard error of {100 * error / found:.2g} % from {paths} of them"
    )
    told = ground.source.partition(_TOLD)[0].rstrip("; ")
    changed: dict[str, Any] = {
        "intensity": float(ground.arrays()["intensity"]) * times * times,
        "source": f"{told}; {text}" if told else text,
    }
    return replace(ground, **changed)


def paths_for(duration: float) -> int:
    """As many motions as are simulated to say how strong they are, fewer where they are very long."""
    return int(np.clip(MOST_STEPS * USUAL_STEP / duration, FEWEST, PATHS))


def shaking(
    ground: Ground, periods: Array, duration: float, envelope: Envelope | None, seed: int = 0
) -> xr.Dataset:
    """How strong the motions of a ground are, in the mean: at these periods [s], and themselves.

    ``spectral_acceleration_1`` [m/s^2] and so on are of the periods in their order, damping 0.05. What
    white noise has not is NaN.
    """
    motion: Any = {"duration": duration, "envelope": envelope, "seed": seed}
    motion["paths"] = paths_for(duration)
    std = rms_acceleration(ground)
    known = np.isfinite(std)
    found = {"rms_acceleration": std if known else np.nan}
    found["ground_intensity"] = float(ground.arrays()["intensity"])
    peak = mean_with_error(_peaks(ground, **motion)) if known else (np.nan, np.nan)
    found |= dict(zip(_with_error("peak_ground_acceleration", ""), peak, strict=True))
    # Each by itself, in the steps in which `scale_ground` has sought it: what was asked for is told.
    of_each = {
        period: mean_with_error(samples)
        for period in set(map(float, periods))
        for samples in peak_accelerations(np.array([period]), USUAL_DAMPING, ground, **motion).T
    }
    for n, period in enumerate(map(float, periods), start=1):
        found |= dict(zip(_with_error("spectral_acceleration", f"_{n}"), of_each[period], strict=True))
    return labels.label(xr.Dataset(found), VARIABLES)


def _peaks(ground: Ground, **motion: Any) -> Array:
    highest: Array = np.abs(simulated_motions(ground, **motion).to_numpy()).max(axis=1)
    return highest


def _with_error(stem: str, end: str) -> tuple[str, str]:
    return f"{stem}{end}", f"{stem}_standard_error{end}"
