"""Fit of ground and envelope to a record, so that motions have its energy and response spectrum."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.analyses.records.envelope_fit import FITTED_ENVELOPES, fit_envelope
from stochlin.analyses.records.files import METRES
from stochlin.analyses.records.records import checked_record, strong_samples
from stochlin.analyses.records.response import response_spectrum
from stochlin.analyses.sites.simulated_spectra import (
    PGA_STEP,
    Motions,
    assign_mean,
    spectrum_and_motions,
)
from stochlin.analyses.sites.spectra import SHORTEST, USUAL_DAMPING
from stochlin.analyses.sites.spectrum_fit import LONGEST, POINTS, Wanted, deliver
from stochlin.analyses.sites.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.arguments import (
    Duration,
    OneOf,
    Paths,
    Scatter,
    Seed,
    Whole,
    check_fields,
    checked,
)
from stochlin.models.envelopes import Envelope, strong_seconds
from stochlin.models.grounds import Ground, rms_acceleration

FILTERS, PATHS = 2, 512
CYCLES = 4.0  # smallest number of cycles of a fitted period in a record
SHORTEST_RECORD = 2.0  # s
RECORD_TO_RECORD = 0.3  # scatter between the two components of a station, see docs/reality.md


@dataclass(frozen=True)
class FittedMotion:
    """Random motion of finite length, as fitted by `fit_motion`: ground, envelope and duration.

    Parameters
    ----------
    ground : CloughPenzien or ParallelGround
        Stationary ground, before the envelope is applied.
    envelope : AminAng, ShinozukaSato, GammaEnvelope or HsuBernard, or None
        Envelope of the motion. None is a stationary motion, which `fit_motion` does not return.
    duration : float
        Length of the motion [s].
    scatter : float
        Scatter of the ground acceleration between earthquakes [-], as in `simulate`. It cannot be
        obtained from one record, only from suites of records. 0 is for motions like this record.

    Raises
    ------
    TypeError, ValueError
        If an argument is of another kind or out of range.

    Examples
    --------
    >>> import stochlin as sl
    >>> motion = sl.FittedMotion(sl.named_ground("firm", 0.01), sl.AminAng(2.0, 12.0, 0.4), 20.0)
    >>> motion.duration
    20.0
    """

    ground: Ground
    envelope: Envelope | None
    duration: Duration
    scatter: Scatter = RECORD_TO_RECORD

    def __post_init__(self) -> None:
        check_fields(self, "FittedMotion: ")


@checked
def fit_motion(
    record: xr.DataArray,
    envelope: Annotated[str, OneOf(FITTED_ENVELOPES)] = "amin_ang",
    *,
    filters: Annotated[int, Whole(1, 3)] = FILTERS,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> FittedMotion:
    """Fit ground, envelope and duration to a record, so that motions have its energy and spectrum.

    The envelope is fitted by `fit_envelope`. The ground is fitted such that motions with this envelope
    have, in the mean, the response spectrum of the record from 0.05 to 4 s. Its intensity is then set
    such that they have the energy of the record exactly, ``sigma^2 Int m^2 dt = Int a^2 dt``, with the
    standard deviation ``sigma`` of the ground acceleration, the envelope ``m`` and the record ``a``. A
    ground by `fit_ground` is instead fitted to the strong part of the record; with an envelope by
    `fit_envelope`, its motions have about half of the energy of the record.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`, of 2 s or more.
    envelope : str
        Model of the envelope, as in `fit_envelope`.
    filters : int
        Number of Clough-Penzien filters in parallel, 1 to 3.
    seed : int
        Seed of the motions that are simulated during the fit.
    progress : callable, optional
        Called with the share of the work of each simulation that is done.

    Returns
    -------
    FittedMotion
        The ``ground``, the ``envelope``, the ``duration`` [s] of the record and the default ``scatter``
        [-], for `simulate`, `separation`, `simulated_motions` and other functions with these arguments.

    Raises
    ------
    ValueError, TypeError
        If the record is not valid or shorter than 2 s, or an option is unknown.
    ArithmeticError
        If no envelope can be fitted.

    Notes
    -----
    A record represents one earthquake, and the motions are like this one. The difference to other
    earthquakes is the ``scatter``, which is not fitted to the record.

    References
    ----------
    Husid, R. (1969), Rev. IDIEM 8, for the envelope; Vanmarcke, E. H. (1975), J. Appl. Mech. 42, for the
    peak factors.

    Examples
    --------
    >>> import stochlin as sl
    >>> shape = sl.AminAng(3.0, 10.0, 0.3)
    >>> record = sl.simulated_motions(sl.named_ground("firm", 0.01), 25.0, shape, paths=2)[0]
    >>> motion = sl.fit_motion(record)
    >>> table = sl.compare_motions(record, motion)
    >>> bool(abs(table.energy_ratio - 1) < 4 * table.energy_ratio_standard_error)
    True
    """
    values, dt = checked_record(record)
    duration = dt * values.size
    if duration < SHORTEST_RECORD:
        raise ValueError(
            f"record lasts {duration:.3g} s; allowed: {SHORTEST_RECORD:g} s or more, for a spectrum"
        )
    shape = fit_envelope(record, envelope)
    of_envelope = _energy(shape.at(dt * np.arange(values.size)), dt)
    std = float(np.sqrt(_energy(values, dt) / of_envelope))
    periods = np.geomspace(SHORTEST, min(LONGEST, duration / CYCLES), POINTS)
    spectrum = response_spectrum(record, periods, USUAL_DAMPING).pseudo_acceleration.values.ravel()
    wanted = Wanted(periods, spectrum, USUAL_DAMPING, duration, shape, std)
    ground = deliver(wanted, filters, seed, progress, PATHS).ground()
    changed: dict[str, Any] = {
        "intensity": float(ground.arrays()["intensity"]) * (std / rms_acceleration(ground)) ** 2,
        "source": f"energy and response spectrum of {record.attrs.get('source', 'a record')}",
    }
    return FittedMotion(replace(ground, **changed), shape, duration)


@checked
def compare_motions(
    record: xr.DataArray, motion: FittedMotion, *, paths: Paths = 256, seed: Seed = 0
) -> xr.Dataset:
    """Compare a record with motions fitted to it: energy, significant duration, response spectrum.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] over ``time`` [s].
    motion : FittedMotion
        The fitted motion, as from `fit_motion`.
    paths : int
        Number of simulated motions.
    seed : int
        Seed of the simulation; the same seed gives the same result.

    Returns
    -------
    xarray.Dataset
        Over ``period`` [s], the variables of `simulated_spectrum` with the spectrum of the record,
        damping ratio 0.05, as ``target`` [m/s^2]; ``ratio`` is the mean spectrum of the motions over
        that of the record. Without dimensions: ``energy_ratio`` [-], the mean ``Int a^2 dt`` of the
        motions over that of the record, and ``significant_duration`` [s], the mean time from 5 to 95 %
        of this integral, each with its standard error; ``record_arias_intensity`` [m/s] and
        ``record_significant_duration`` [s].

    Raises
    ------
    ValueError, TypeError
        If the record or the motion is not valid, or a number is out of range.

    References
    ----------
    Trifunac, M. D. and Brady, A. G. (1975), Bull. Seismol. Soc. Am. 65, for the duration.

    Examples
    --------
    >>> import stochlin as sl
    >>> motion = sl.FittedMotion(sl.named_ground("firm", 0.01), sl.AminAng(2.0, 12.0, 0.4), 20.0)
    >>> record = sl.simulated_motions(motion.ground, motion.duration, motion.envelope, paths=2)[0]
    >>> table = sl.compare_motions(record, motion, paths=64)
    >>> table.ratio.dims, bool(table.significant_duration < 20)
    (('period',), True)
    """
    values, dt = checked_record(record)
    if not isinstance(motion, FittedMotion):
        raise TypeError(f"motion is a {type(motion).__name__}; allowed: a motion of fit_motion")
    longest = min(LONGEST, motion.duration / CYCLES)
    periods = np.geomspace(SHORTEST, longest, POINTS)
    own = response_spectrum(record, periods, USUAL_DAMPING).pseudo_acceleration.values.ravel()
    motions = Motions(motion.ground, motion.duration, motion.envelope, paths, seed)
    table, simulated = spectrum_and_motions(motions, periods, own)
    energy, accelerations = _energy(values, dt), simulated.to_numpy()
    assign_mean(table, "energy_ratio", _energy(accelerations, PGA_STEP) / energy)
    first, last = strong_samples(accelerations)
    assign_mean(table, "significant_duration", PGA_STEP * (last - first))
    table["record_arias_intensity"] = (), np.pi / (2 * METRES["g"]) * energy
    first, last = strong_samples(values)
    table["record_significant_duration"] = (), dt * (last - first)
    call = f"compare_motions(paths={paths}, seed={seed})"
    title = f"{record.attrs.get('source', 'A record')} and the motions fitted to it"
    return labels.with_run_information(labels.label(table, VARIABLES), title, call, motions.models())


def energy_ratio(
    record: xr.DataArray, ground: Ground, envelope: Envelope | None, duration: float
) -> float:
    """Mean energy of motions over that of a record [-], ``sigma^2 Int m^2 dt / Int a^2 dt``."""
    of_motions = rms_acceleration(ground) ** 2 * strong_seconds(duration, envelope)
    return of_motions / float(_energy(*checked_record(record)))


def _energy(values: Array, dt: float) -> Array:
    return np.trapezoid(values**2, dx=dt, axis=-1)
