"""Fit of a ground to a strong-motion record, or to a mean response spectrum of its motions.

A ground is fitted to a spectrum for motions with an envelope and a duration. For given peak
factors, the spectrum defines the variance of each oscillator, which is linear in the PSD of the
ground; the filters are fitted to these variances. The peak factors are first those of Vanmarcke's
formula. Since this formula neglects the envelope and the start from rest, they are then taken from
a simulation of the fitted ground.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable
from dataclasses import replace
from itertools import product
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.ground_fit import (
    STRONG_PART,
    Estimated,
    best_fit,
    ground_of_record,
)
from stochlin.applications.sites.elastic_spectra import DividedBy, as_elastic, taken_in_words
from stochlin.applications.sites.simulated_spectra import SpectrumMotions, peak_accelerations
from stochlin.applications.sites.spectra import (
    SHORTEST_PERIOD,
    checked_spectrum,
    interpolated,
    is_spectrum,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.spectral_moments import bandwidth_of
from stochlin.messages import DoubtfulInput, refuse
from stochlin.models.arguments import Duration, OneOf, Seed, Truth, TwoNumbers, Whole, checked
from stochlin.models.envelopes import Envelope, strong_seconds
from stochlin.models.grounds import (
    MOST_FILTERS,
    SCATTER_OF_SPECTRUM,
    CloughPenzien,
    Ground,
    ParallelGround,
)
from stochlin.models.rules.peak_factors import peak_factor_model

_OF_SPECTRA = ("clough_penzien",)
_FEWEST_DECADES = 0.5  # smallest range of periods of a spectrum within the range of the fit
LONGEST_FITTED = 4.0  # longest period [s] for which a ground is fitted
FITTED_PERIODS = 72  # number of such periods
POOR_FIT = 0.3  # largest error of a fit above which there is a warning
# relative errors at which no further filter is tried
GOOD_RMS = 0.02
GOOD_WORST = 0.06
PATHS_OF_GROUND = 2048
# of the search; the shortest of 24 neighbouring periods is 1.3 % too long
SEARCH_STEPS_PER_PERIOD = 16
# Errors of the mean simulated spectrum at which corrections end, and the largest number of
# corrections.
DELIVERED_RMS = 0.02
DELIVERED_WORST = 0.05
CORRECTIONS = 3
_GROUND_WEIGHT = 10.0  # weight of the standard deviation of the ground; that of an oscillator is 1
_ROUNDS = 4  # number of fits with updated peak factors
_FIRST_FACTOR = 2.5

# step of ln w, an eighth of the resonance width of an oscillator with damping 0.05
_LOG_STEP = 0.012
_REACH = 8.0  # factor of the frequency range beyond the longest and the shortest period
# Bounds and starts of wg [rad/s], xig, wf [rad/s], xif and the intensity, in logarithms.
_LOWER = np.log([1.0, 0.02, 0.2, 0.2, 1e-20])
_UPPER = np.log([150.0, 3.0, 8.0, 1.5, 1e20])
_SOILS = np.log([(4.0, 0.3), (4.0, 0.8), (12.0, 0.3), (12.0, 0.8), (30.0, 0.5)])
_HIGH_PASS = np.log([(0.6, 0.6), (2.5, 0.6)])
_DRAWN = 6  # number of random combinations of these starts for two or three filters
_SEARCH_TOLERANCE = 1e-11  # tolerances of the least-squares search, whose minimum is flat


@checked
def fit_ground(
    target: xr.DataArray,
    model: str | None = None,
    estimator: Estimated | None = None,
    *,
    part: TwoNumbers = STRONG_PART,
    frequency_range: TwoNumbers | None = None,
    duration: Duration | None = None,
    envelope: Envelope | None = None,
    filters: Annotated[int, Whole(1, MOST_FILTERS)] | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
    elastic: Truth | None = None,
    divided_by: DividedBy | None = None,
) -> Any:
    """Fit a ground to a record, or to an elastic response spectrum.

    **A record** is fitted by its power spectral density. The model is compared with the raw
    periodogram of a part of the record without its mean. No smoothing bandwidth has to be chosen,
    and the peak of a narrow-band ground keeps its height. The part is padded with zeros to four
    times its length, so that the result does not depend on the position of the Fourier frequencies.
    With ``estimator="psd"`` the fit is then equal to a least-squares fit of the sample
    autocovariance at all lags (Parseval). The other two estimators also depend on frequencies at
    which the ground is weak, where leakage from the peak matters; for them a tenth of the part is
    under a cosine taper. The search starts from a grid of periods and damping ratios.

    **A spectrum** is fitted such that motions of the given duration and envelope have it in the
    mean. The ground is one Clough-Penzien filter, or several in parallel. The fit uses the
    variances of elastic oscillators, the peak factors of `stochlin.rules.peak_factor_model`
    ``"vanmarcke"`` and an effective damping ratio for the start from rest. Motions are then
    simulated, and the fit is corrected by their mean spectrum, usually once.

    Parameters
    ----------
    target : xarray.DataArray
        A record, ground acceleration [m/s^2] over ``time`` [s], as from `read_record`; or a
        spectrum, pseudo-acceleration [m/s^2] over ``period`` [s], as from `eurocode_8`, `asce_7`
        and `read_spectrum`.
    model : str, optional
        Kind of ground. For a record ``"kanai_tajimi"`` (default), ``"clough_penzien"``, or an
        extension that can be fitted; for a spectrum ``"clough_penzien"``.
    estimator : {"psd", "log_psd", "whittle"}, optional
        Quantity that the fit to a record minimizes: the squared difference of the spectra
        (default), which is governed by the peak; the squared difference of their logarithms, in
        which all frequencies of the range count equally; or the Whittle likelihood, which is the
        most accurate if the model is true. The results differ widely for a record that the model
        does not describe; draw the ``psd`` of the ground beside a periodogram of the record, as of
        ``scipy.signal.welch``.
    part : tuple of two floats
        Fractions of the cumulative energy between which a record is used; (0, 1) is
        the whole record.
    frequency_range : tuple of two floats, optional
        Lowest and highest circular frequency used for a record [rad/s]. By default these are the
        frequencies below which the part has 0.01 % (at least one cycle) and 99 % of its energy. The
        range has little effect on ``"psd"`` and a large one on the other estimators.
    duration : float
        Length of the motions for a spectrum [s]. A spectrum does not contain it, but inelastic gaps
        depend on it; compare half and twice the value.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions for a spectrum; without it they are stationary.
    filters : int, optional
        Number of filters for a spectrum, 1 to 3. By default it is the smallest number with which
        the errors before the correction are at most 2 % (root mean square) and 6 % (largest).
    seed : int
        Seed of the motions that are simulated for a spectrum.
    progress : callable, optional
        Called with the share of the work of each simulation that is done.
    elastic, divided_by : optional
        What a spectrum is that does not say so itself, as in `read_spectrum`.

    Returns
    -------
    KanaiTajimi, CloughPenzien, ParallelGround or an extension
        The fitted ground. Its ``intensity`` [m^2/s^3] is the two-sided PSD per rad/s of the white
        noise. Its ``scatter``, the default of functions that simulate its motions, is 0.3 for a
        spectrum and 0.4 for a record. Its ``source`` describes the fit: for a record the estimator,
        the part, the frequency range and relative standard errors, for a spectrum how it was taken,
        and the error of the mean spectrum of simulated motions.

    Raises
    ------
    TypeError, ValueError
        If the target is neither a record nor a spectrum; if an option is unknown or belongs to the
        other kind of target; if the range has too few frequencies or periods; or if the fit fails
        or ends on a bound, which happens if a record does not define a parameter.

    Warns
    -----
    UserWarning
        If the mean spectrum of the motions differs from a spectrum by more than 30 % at a period.

    Notes
    -----
    The standard errors of a fit to a record are those of a stationary Gaussian process with the
    fitted spectrum [1]_, which a part of a record is only approximately. Short records of
    narrow-band ground define the damping ratio poorly. In 200 simulated records of 71 s with
    ``wg=3.09`` and ``xig=0.054``, 90 % of the fitted damping ratios were within 0.21 to 2.0 times
    the true one with ``"psd"`` (median 0.5), and within 0.63 to 1.8 times with ``"whittle"``
    (median 1.1). The periodogram of a part of the duration d cannot distinguish a damping ratio
    below about ``2.8/(wg d)`` from a sinusoid; ``source`` states this if the result is less than
    twice this value.

    Spectra are fitted from 0.05 to 4 s, by motions without scatter. A design spectrum is neither
    the mean nor the median spectrum of an earthquake, and does not contain the scatter between
    earthquakes. Records scatter less about a spectrum than by the default, but those of yielding
    structures more.

    References
    ----------
    .. [1] P. Whittle, "Estimation and information in stationary time series", Arkiv foer
       Matematik 2, 423-434, 1953.
    .. [2] E. H. Vanmarcke, "On the distribution of the first-passage time for normal stationary
       random processes", J. Appl. Mech. 42, 215-220, 1975.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> import stochlin as sl
    >>> time, step = 0.02 * np.arange(10000), 2 * np.pi / 200
    >>> psd = sl.KanaiTajimi(period=1.0, damping=0.3, intensity=0.01).psd(step * np.arange(5001))
    >>> phase = np.random.default_rng(1).uniform(0, 2 * np.pi, psd.size)
    >>> spectrum = np.sqrt(psd.values * step) * np.exp(1j * phase)
    >>> history = np.fft.irfft(spectrum) * time.size
    >>> record = xr.DataArray(history, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
    >>> ground = sl.fit_ground(record, part=(0, 1))
    >>> round(ground.period, 2), round(ground.damping, 1), round(ground.intensity, 3)
    (1.0, 0.3, 0.01)

    Fit to a spectrum:

    >>> spectrum = sl.eurocode_8(0.25 * 9.80665, "B")
    >>> shape = sl.AminAng(1.5, 6.0, 0.6)
    >>> ground = sl.fit_ground(spectrum, duration=10.0, envelope=shape)
    >>> table = sl.simulated_spectrum(ground, spectrum, 10.0, shape, paths=256)
    >>> bool(abs(table.ratio.sel(period=slice(0.1, 4)) - 1).max() < 0.06)
    True
    """
    if not isinstance(target, xr.DataArray):
        raise TypeError(f"target is a {type(target).__name__}; allowed: an xarray.DataArray")
    if not is_spectrum(target):
        if "time" not in target.dims:
            raise ValueError(f"target has the dimensions {target.dims}; allowed: time or period")
        of_spectra: dict[str, Any] = {
            "duration": duration,
            "envelope": envelope,
            "filters": filters,
        }
        of_spectra |= {"elastic": elastic, "divided_by": divided_by}
        refuse("target", "a record", of_spectra)
        return ground_of_record(target, model, estimator, part, frequency_range)
    other_part = None if part is STRONG_PART else part
    of_records = {"estimator": estimator, "frequency_range": frequency_range, "part": other_part}
    refuse("target", "a spectrum", of_records)
    OneOf(_OF_SPECTRA)("model", _OF_SPECTRA[0] if model is None else model)
    if duration is None:
        raise ValueError("duration is missing; a spectrum does not contain it: give it in seconds")
    checked_spectrum(target)
    target = as_elastic(target, elastic, divided_by)
    wanted = _wanted(target, duration, envelope)
    fit = deliver(wanted, filters, seed, progress)
    under = "stationary" if envelope is None else envelope.describe()
    range_of_fit = f"from {wanted.periods[0]:.3g} to {wanted.periods[-1]:.3g} s"
    text = (
        f"fitted to {target.attrs.get('source', 'a spectrum')} ({taken_in_words(target)}), damping "
        f"{wanted.damping:g}, {range_of_fit}; motions of {duration:g} s, {under}, "
        f"have this spectrum in the mean with errors of {100 * fit.rms:.1f} % (root mean square) "
        f"and {100 * fit.worst:.1f} % (largest)"
    )
    if fit.worst > POOR_FIT:
        what = f"fit_ground: the mean spectrum of motions differs by up to {100 * fit.worst:.0f} %"
        cure = "are the periods and ordinates right, or does one peak need more filters?"
        warnings.warn(f"{what}; usual are 10 % at most; {cure}", DoubtfulInput, stacklevel=3)
    return replace(
        fit.ground(),
        source=f"{text}; {SCATTER_OF_SPECTRUM}",
        scatter=SCATTER_OF_SPECTRUM.scatter,
        fitted_for=(float(duration), envelope, float(wanted.periods[-1])),
    )


def _wanted(spectrum: xr.DataArray, duration: float, envelope: Envelope | None) -> TargetMotions:
    period, values, damping = checked_spectrum(spectrum)
    shortest = max(SHORTEST_PERIOD, period[period > 0][0])
    longest = min(LONGEST_FITTED, period[-1])
    if not longest > shortest * 10**_FEWEST_DECADES:
        raise ValueError(f"spectrum has {period[0]:g} to {period[-1]:g} s; allowed: half a decade")
    sought = np.geomspace(shortest, longest, FITTED_PERIODS)
    return TargetMotions(sought, interpolated(period, values, sought), damping, duration, envelope)


class TargetMotions(NamedTuple):
    """The wanted mean spectrum of motions, with their duration and envelope."""

    periods: Array  # [s]
    accelerations: Array  # [m/s^2]
    damping: float
    duration: float  # [s]
    envelope: Envelope | None
    ground_std: float | None = None  # [m/s^2], wanted standard deviation of the stationary ground

    @property
    def strong(self) -> float:
        """Duration of a stationary motion with the same energy [s]."""
        return strong_seconds(self.duration, self.envelope)

    @property
    def displacements(self) -> Array:
        """Wanted mean peak displacements of the oscillators [m]."""
        return self.accelerations * (self.periods / (2 * np.pi)) ** 2


class FittedFilters(NamedTuple):
    """Clough-Penzien filters, one in each row: logarithms of wg, xig, wf, xif and the intensity."""

    logs: Array
    off: Array  # ln of the mean spectrum of their motions over that wanted, by formula or simulated

    @property
    def rms(self) -> float:
        """Root mean square of the error over the periods [-]."""
        return float(np.sqrt(np.mean(self.off**2)))

    @property
    def worst(self) -> float:
        """Largest absolute error [-]."""
        return float(np.abs(self.off).max())

    def ground(self) -> Ground:
        """The filters as a ground, in parallel if there are several."""
        rows = np.exp(self.logs)
        parts = [
            CloughPenzien(2 * np.pi / wg, xig, 2 * np.pi / wf, xif, intensity)
            for wg, xig, wf, xif, intensity in rows[np.argsort(rows[:, 0])].tolist()
        ]
        return parts[0] if len(parts) == 1 else ParallelGround(parts)


def deliver(
    wanted: TargetMotions,
    filters: int | None,
    seed: int,
    progress: Progress | None,
    paths: int = PATHS_OF_GROUND,
) -> FittedFilters:
    """Fit to a spectrum, with ``filters`` filters or as few as give a good fit.

    Its errors are those of the mean spectrum of simulated motions.
    """
    search = _Search(wanted)
    for count in range(1, MOST_FILTERS + 1) if filters is None else [filters]:
        fit = search.by_formula(count)
        if fit.rms <= GOOD_RMS and fit.worst <= GOOD_WORST:
            break
    simulated: list[FittedFilters] = []
    for attempt in range(CORRECTIONS + 1):
        # Another sample each time, so that a correction does not fit its scatter.
        timing = wanted.duration, wanted.envelope
        motions = SpectrumMotions(fit.ground(), *timing, paths, seed + attempt, progress)
        peaks = peak_accelerations(wanted.periods, wanted.damping, motions, SEARCH_STEPS_PER_PERIOD)
        means = peaks.mean(axis=0)
        simulated.append(fit._replace(off=np.log(means / wanted.accelerations)))
        best = min(simulated, key=lambda fit: fit.rms)
        if best.rms <= DELIVERED_RMS and best.worst <= DELIVERED_WORST:
            break
        fit = search.corrected(fit, means)
    return best


def _starts(count: int) -> Iterable[Array]:
    ones = [np.concatenate([*pair, [0.0]]) for pair in product(_SOILS, _HIGH_PASS)]
    if count == 1:
        return (start[None] for start in ones)
    draw = np.random.default_rng(0)
    return (
        np.array([ones[i] for i in draw.choice(len(ones), count, False)]) for _ in range(_DRAWN)
    )


class _Search:
    """Least-squares fit of the log standard deviations of oscillators of the wanted periods.

    The spectral moments of the oscillators are linear in the PSD of the ground. If the standard
    deviation of the ground is wanted, it is fitted too.
    """

    def __init__(self, wanted: TargetMotions) -> None:
        self.wanted = wanted
        w = 2 * np.pi / wanted.periods
        # Effective damping ratio whose stationary variance is that of a start from rest.
        damping = wanted.damping / -np.expm1(-2 * wanted.damping * w * wanted.strong)
        low, high = np.log([w.min() / _REACH, _REACH * w.max()])
        self._frequency = np.exp(np.arange(low, high, _LOG_STEP))
        x = (self._frequency / w[:, None]) ** 2
        response = 1 / (w[:, None] ** 4 * ((1 - x) ** 2 + 4 * damping[:, None] ** 2 * x))
        self._moments = [2 * _LOG_STEP * response * self._frequency ** (k + 1) for k in range(3)]
        self._rows = self._moments[0]
        self._weight = np.ones(wanted.periods.size)
        self._ground = np.zeros(0)
        if wanted.ground_std is not None:
            self._rows = np.vstack([self._rows, 2 * _LOG_STEP * self._frequency])
            self._weight = np.append(self._weight, _GROUND_WEIGHT)
            self._ground = np.array([wanted.ground_std])

    def by_formula(self, count: int) -> FittedFilters:
        """The fit with ``count`` filters and the peak factors of Vanmarcke's formula."""
        factors = np.full(self.wanted.periods.size, _FIRST_FACTOR)
        starts = list(_starts(count))
        for _ in range(_ROUNDS):
            fit = self._best(factors, starts)
            factors = self._peak_factors(fit)
            starts = [fit.logs]
        return fit

    def _peak_factors(self, fit: FittedFilters) -> Array:
        density = _psd(fit.logs, self._frequency)
        l0 = self._moments[0] @ density
        l1 = self._moments[1] @ density
        l2 = self._moments[2] @ density
        crossings = np.sqrt(l2 / l0) * self.wanted.strong / np.pi
        return peak_factor_model("vanmarcke").mean(
            np.maximum(crossings, 1.0), bandwidth_of(l0, l1, l2)
        )

    def corrected(self, fit: FittedFilters, accelerations: Array) -> FittedFilters:
        """The fit with peak factors of a simulation, whose mean spectrum is ``accelerations``."""
        peaks = self.wanted._replace(accelerations=accelerations).displacements
        std = np.sqrt(self._moments[0] @ _psd(fit.logs, self._frequency))
        return self._best(peaks / std, [fit.logs])

    def _best(self, factors: Array, starts: Iterable[Array]) -> FittedFilters:
        frequency = self._frequency
        rows = self._rows
        weight = self._weight
        target = np.log(np.append(self.wanted.displacements / factors, self._ground))

        def residual(logs: Array) -> Array:
            residuals: Array = weight * (0.5 * np.log(rows @ _psd(logs, frequency)) - target)
            return residuals

        def of_energy(start: Array) -> Array:
            logs = start.copy()
            logs[:, -1] -= 2 * (residual(logs) / weight).mean()
            return logs.ravel()

        starts = [*starts]
        bounds = np.tile(_LOWER, len(starts[0])), np.tile(_UPPER, len(starts[0]))
        best = best_fit(
            residual,
            map(of_energy, starts),
            bounds,
            ftol=_SEARCH_TOLERANCE,
            xtol=_SEARCH_TOLERANCE,
            gtol=_SEARCH_TOLERANCE,
        )
        return FittedFilters(best.x.reshape(-1, 5), best.fun[: target.size - self._ground.size])


def _psd(logs: Array, frequency: Array) -> Array:
    """PSD of all filters [m^2/s^3] (frequencies,)."""
    wg, xig, wf, xif, intensity = np.exp(logs.reshape(-1, 5)).T[..., None]
    soil = {"period": 2 * np.pi / wg, "damping": xig, "intensity": intensity}
    layer = {"high_pass_period": 2 * np.pi / wf, "high_pass_damping": xif}
    filters = CloughPenzien.filter(soil | layer)
    density: Array = (filters.intensity * filters.transmission(frequency)).sum(axis=0)
    return density
