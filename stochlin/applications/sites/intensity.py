"""Intensity of the motions of a ground, and scaling of a ground to a wanted intensity."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.applications.sites.elastic_spectra import USUAL_DAMPING
from stochlin.applications.sites.simulated_spectra import (
    PGA_STEP,
    SpectrumMotions,
    peak_accelerations,
)
from stochlin.applications.sites.spectra import check_goal
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import (
    Acceleration,
    DampingRatio,
    Duration,
    Paths,
    Seconds,
    Seed,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, rms_acceleration
from stochlin.solver.simulation.statistics import mean_with_error
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

PATHS_OF_INTENSITY = 1024  # gives a standard error of about half a per cent
FEWEST_OF_INTENSITY = 64  # fewest motions
MOST_STEPS_IN_MEMORY = 20_000_000  # most time steps of all motions in memory at once
_TOLD = "intensity for a mean"


@checked
def scale_ground(
    ground: Ground,
    duration: Duration,
    envelope: Envelope | None = None,
    *,
    pga: Acceleration | None = None,
    sa: Acceleration | None = None,
    period: Seconds | None = None,
    damping: DampingRatio = USUAL_DAMPING,
    paths: Paths = PATHS_OF_INTENSITY,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> Any:
    """Scale a ground so that its motions have a given mean peak ground or spectral acceleration.

    The motions are proportional to the square root of ``S0``, so that one simulation is enough. A
    peak ground acceleration is that of motions in steps of 0.01 s, as those of `simulated_motions`.

    Parameters
    ----------
    ground : KanaiTajimi, CloughPenzien, ParallelGround, or WhiteNoise with ``sa``
        Ground with scalar parameters; its own intensity does not matter.
    duration : float
        Length of each motion [s], positive.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions; without it they are stationary.
    pga : float, optional
        Wanted mean peak ground acceleration [m/s^2] in steps of 0.01 s; given, or ``sa`` and
        ``period`` are.
    sa, period : float, optional
        Wanted mean pseudo-acceleration [m/s^2] at this period [s].
    damping : float
        Damping ratio [-] for ``sa``.
    paths : int
        Number of simulated motions, at least 2.
    seed : int
        Seed of the simulation; the same seed gives the same result on any number of cores.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    Ground
        Ground of the same kind with the ``intensity`` [m^2/s^3] that gives the wanted acceleration.
        Its ``source`` states this acceleration and the standard error of the simulated mean.

    Raises
    ------
    ValueError, TypeError
        If neither or both of ``pga`` and ``sa`` are given, a number is out of range, or ``pga`` is
        given for white noise.

    Notes
    -----
    A filtered white noise has more and higher peaks in smaller steps: on usual soils the mean peak
    is 3 % lower in steps of 0.02 s, 2 % higher in 0.005 s and 4 % higher in 0.0025 s. All peak
    ground accelerations of simulated motions, also those of `stochlin.simulated_spectrum`, hazards
    and reports, are counted in steps of 0.01 s, whatever the duration. Spectral accelerations are
    simulated in 64 steps in a period, which make it 0.08 % longer.

    References
    ----------
    Derived here from the linear elastic response and the motion being proportional to ``sqrt(S0)``.

    Examples
    --------
    >>> import stochlin as sl
    >>> shape = sl.AminAng(2.0, 12.0, 0.4)
    >>> ground = sl.scale_ground(sl.named_ground("firm", 1.0), 20.0, shape, pga=0.3 * 9.80665)
    >>> table = sl.simulated_spectrum(ground, [0.5], 20.0, shape)
    >>> round(float(table.peak_ground_acceleration) / 9.80665, 9)
    0.3
    """
    motions = SpectrumMotions(ground, duration, envelope, paths, seed, progress)
    check_scalars(ground, "ground", "numbers")
    check_goal({"pga": pga, "sa": sa}, period)
    if pga is not None and not np.isfinite(rms_acceleration(ground)):
        raise ValueError(
            "pga: white noise has no peak; allowed: sa with a period, or another ground"
        )
    at = None if period is None else float(period)
    mean, error = _mean_acceleration(_of_unit_intensity(motions), at, damping)
    wanted = float(pga if sa is None else sa)  # type: ignore[arg-type]
    of_peak = f"peak ground acceleration (steps of {PGA_STEP:g} s)"
    what = of_peak if sa is None else f"Sa({period:g} s), damping {damping:g},"
    under = "stationary" if envelope is None else envelope.describe()
    text = (
        f"{_TOLD} {what} of {wanted / constants.g:.4g} g in motions of {duration:g} s, {under}, "
        f"with a standard error of {100 * error / mean:.2g} % from {paths} of them"
    )
    source = ground.source.partition(_TOLD)[0].rstrip("; ")
    changed: dict[str, Any] = {
        "intensity": (wanted / mean) ** 2,
        "source": f"{source}; {text}" if source else text,
    }
    return replace(ground, **changed)


def paths_for(duration: float) -> int:
    """Number of motions simulated for an intensity, smaller for very long motions [s]."""
    paths = MOST_STEPS_IN_MEMORY * PGA_STEP / duration
    return int(np.clip(paths, FEWEST_OF_INTENSITY, PATHS_OF_INTENSITY))


def shaking(
    ground: Ground, periods: Array, duration: float, envelope: Envelope | None, seed: int = 0
) -> xr.Dataset:
    """Mean intensity of the motions of a ground, with standard errors.

    The variables are ``rms_acceleration`` and ``peak_ground_acceleration`` [m/s^2], NaN for white
    noise; ``ground_intensity`` [m^2/s^3]; and ``spectral_acceleration_1`` [m/s^2] and so on, for
    the periods [s] in their order and the damping ratio 0.05.
    """
    intensity = float(ground.arrays()["intensity"])
    std = rms_acceleration(ground)
    columns = {
        "rms_acceleration": std if np.isfinite(std) else np.nan,
        "ground_intensity": intensity,
    }
    motions = _of_unit_intensity(
        SpectrumMotions(ground, duration, envelope, paths_for(duration), seed)
    )
    for n, at in enumerate([None, *map(float, periods)]):
        name, ending = ("spectral_acceleration", f"_{n}") if n else ("peak_ground_acceleration", "")
        mean, error = _mean_acceleration(motions, at, USUAL_DAMPING)
        columns[f"{name}{ending}"] = np.sqrt(intensity) * mean
        columns[f"{name}_standard_error{ending}"] = np.sqrt(intensity) * error
    return labels.label(xr.Dataset(columns, attrs={"pga_step_s": PGA_STEP}))


def _of_unit_intensity(motions: SpectrumMotions) -> SpectrumMotions:
    unit: dict[str, Any] = {"intensity": 1.0, "source": ""}
    return replace(motions, ground=replace(motions.ground, **unit))


@lru_cache(maxsize=256)  # another acceleration wanted of the same motions costs nothing
def _mean_acceleration(
    motions: SpectrumMotions, period: float | None, damping: float
) -> tuple[float, float]:
    """Mean acceleration of the motions, and its standard error [m/s^2].

    It is the pseudo-acceleration at a period [s]; without a period, the peak of the ground, which
    is NaN for white noise. Periods are simulated one by one, so that none changes the time steps of
    another.
    """
    if period is None and not np.isfinite(rms_acceleration(motions.ground)):
        return np.nan, np.nan
    if period is None:
        samples = np.abs(motions.accelerations().to_numpy()).max(axis=1)
    else:
        samples = peak_accelerations(np.array([period]), damping, motions)[:, 0]
    mean, error = mean_with_error(samples)
    return float(mean), float(error)
