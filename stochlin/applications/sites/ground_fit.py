"""Fit of a ground to a strong-motion record, or to a response spectrum."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.applications.records.ground_fit import ground_of_record
from stochlin.applications.records.spectra import STRONG_PART, Part
from stochlin.applications.sites.spectra import SHORTEST, checked_spectrum, interpolated, is_spectrum
from stochlin.applications.sites.spectrum_fit import (
    LONGEST,
    POINTS,
    Wanted,
    deliver,
)
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import refuse
from stochlin.models.arguments import Duration, OneOf, Seed, TwoNumbers, Whole, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import MOST_FILTERS

_OF_SPECTRA = ("clough_penzien",)
_FEWEST_DECADES = 0.5  # smallest range of periods of a spectrum within the range of the fit


@checked
def fit_ground(
    target: xr.DataArray,
    model: str | None = None,
    estimator: str | None = None,
    *,
    part: Part = STRONG_PART,
    frequency_range: TwoNumbers | None = None,
    duration: Duration | None = None,
    envelope: Envelope | None = None,
    filters: Annotated[int, Whole(1, MOST_FILTERS)] | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> Any:
    """Fit a ground to a record, or to an elastic response spectrum.

    **A record** is fitted by its power spectral density. The model is compared with the raw periodogram
    of a part of the record without its mean. No smoothing bandwidth has to be chosen, and the peak of a
    narrow-band ground keeps its height. The part is padded with zeros to four times its length, so that
    the result does not depend on the position of the Fourier frequencies. With ``estimator="psd"`` the
    fit is then equal to a least-squares fit of the sample autocovariance at all lags (Parseval). The
    other two estimators also depend on frequencies at which the ground is weak, where leakage from the
    peak matters; for them a tenth of the part is under a cosine taper. The search starts from a grid of
    periods and damping ratios.

    **A spectrum** is fitted such that motions of the given duration and envelope have it in the mean.
    The ground is one Clough-Penzien filter, or several in parallel. The fit uses the variances of
    elastic oscillators, the peak factors of `stochlin.rules.peak_factor_model` ``"vanmarcke"`` and an
    effective damping ratio for the start from rest. Motions are then simulated, and the fit is corrected
    by their mean spectrum, usually once.

    Parameters
    ----------
    target : xarray.DataArray
        A record, ground acceleration [m/s^2] over ``time`` [s], as from `read_record`; or a spectrum,
        pseudo-acceleration [m/s^2] over ``period`` [s], as from `eurocode_8`, `asce_7` and
        `read_spectrum`.
    model : str, optional
        Kind of ground. For a record ``"kanai_tajimi"`` (default), ``"clough_penzien"``, or an extension
        that can be fitted; for a spectrum ``"clough_penzien"``.
    estimator : {"psd", "log_psd", "whittle"}, optional
        Quantity that the fit to a record minimizes: the squared difference of the spectra (default),
        which is governed by the peak; the squared difference of their logarithms, in which all
        frequencies of the range count equally; or the Whittle likelihood, which is the most accurate if
        the model is true. The results differ widely for a record that the model does not describe; draw
        the fit with `stochlin.charts.fit_spectra`.
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
        Number of filters for a spectrum, 1 to 3. By default it is the smallest number with which the
        errors before the correction are at most 2 % (root mean square) and 6 % (largest).
    seed : int
        Seed of the motions that are simulated for a spectrum.
    progress : callable, optional
        Called with the share of the work of each simulation that is done.

    Returns
    -------
    KanaiTajimi, CloughPenzien, ParallelGround or an extension
        The fitted ground. Its ``intensity`` [m^2/s^3] is the two-sided PSD per rad/s of the white noise.
        Its ``source`` describes the fit: for a record the estimator, the part, the frequency range and
        relative standard errors, for a spectrum the error of the mean spectrum of simulated motions.

    Raises
    ------
    TypeError, ValueError
        If the target is neither a record nor an elastic spectrum; if an option is unknown or belongs to
        the other kind of target; if the range has too few frequencies or periods; or if the fit fails or
        ends on a bound, which happens if a record does not define a parameter.

    Notes
    -----
    The standard errors of a fit to a record are those of a stationary Gaussian process with the fitted
    spectrum [1]_, which a part of a record is only approximately. Short records of narrow-band ground
    define the damping ratio poorly. In 200 simulated records of 71 s with ``wg=3.09`` and ``xig=0.054``,
    90 % of the fitted damping ratios were within 0.21 to 2.0 times the true one with ``"psd"`` (median
    0.5), and within 0.63 to 1.8 times with ``"whittle"`` (median 1.1). The periodogram of a part of the
    duration d cannot distinguish a damping ratio below about ``2.8/(wg d)`` from a sinusoid; ``source``
    states this if the result is less than twice this value.

    Spectra are fitted from 0.05 to 4 s. A design spectrum is neither the mean nor the median spectrum of
    an earthquake, and does not contain the scatter between earthquakes.

    References
    ----------
    .. [1] P. Whittle, "Estimation and information in stationary time series", Arkiv foer
       Matematik 2, 423-434, 1953.
    .. [2] E. H. Vanmarcke, "On the distribution of the first-passage time for normal stationary random
       processes", J. Appl. Mech. 42, 215-220, 1975.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> import stochlin as sl
    >>> time, step = 0.02 * np.arange(10000), 2 * np.pi / 200
    >>> psd = sl.KanaiTajimi(period=1.0, damping=0.3, intensity=0.01).psd(step * np.arange(5001))
    >>> phase = np.random.default_rng(1).uniform(0, 2 * np.pi, psd.size)
    >>> spectrum = np.sqrt(psd.values * step) * np.exp(1j * phase)
    >>> history = np.fft.irfft(spectrum) * time.size
    >>> record = xr.DataArray(history, dims="time", coords={"time": time})
    >>> ground = sl.fit_ground(record, part=(0, 1))
    >>> round(ground.period, 2), round(ground.damping, 1), round(ground.intensity, 3)
    (1.0, 0.3, 0.01)

    Fit to a spectrum:

    >>> spectrum = sl.eurocode_8(0.25 * 9.80665, "B")
    >>> shape = sl.AminAng(1.5, 6.0, 0.6)
    >>> ground = sl.fit_ground(spectrum, duration=10.0, envelope=shape)
    >>> table = sl.charts.simulated_spectrum(ground, spectrum, 10.0, shape)
    >>> bool(abs(table.ratio.sel(period=slice(0.1, 4)) - 1).max() < 0.06)
    True
    """
    if not isinstance(target, xr.DataArray):
        raise TypeError(f"target is a {type(target).__name__}; allowed: an xarray.DataArray")
    if not is_spectrum(target):
        if "time" not in target.dims:
            raise ValueError(f"target has the dimensions {target.dims}; allowed: time or period")
        of_spectra = {"duration": duration, "envelope": envelope, "filters": filters}
        refuse("target", "a record", of_spectra)
        return ground_of_record(
            target,
            "kanai_tajimi" if model is None else model,
            "psd" if estimator is None else estimator,
            part=part,
            frequency_range=frequency_range,
        )
    other_part = None if part is STRONG_PART else part
    of_records = {"estimator": estimator, "frequency_range": frequency_range, "part": other_part}
    refuse("target", "a spectrum", of_records)
    OneOf(_OF_SPECTRA)("model", _OF_SPECTRA[0] if model is None else model)
    if duration is None:
        raise ValueError("duration is missing; a spectrum does not contain it: give it in seconds")
    wanted = _wanted(target, duration, envelope)
    fit = deliver(wanted, filters, seed, progress)
    under = "stationary" if envelope is None else envelope.describe()
    text = (
        f"fitted to {target.attrs.get('source', 'a spectrum')}, damping {wanted.damping:g}, from "
        f"{wanted.periods[0]:.3g} to {wanted.periods[-1]:.3g} s; motions of {duration:g} s, {under}, "
        f"have this spectrum in the mean with errors of {100 * fit.rms:.1f} % (root mean square) and "
        f"{100 * fit.worst:.1f} % (largest)"
    )
    return replace(fit.ground(), source=text)


def _wanted(spectrum: xr.DataArray, duration: float, envelope: Envelope | None) -> Wanted:
    period, values, damping = checked_spectrum(spectrum)
    shortest, longest = max(SHORTEST, period[period > 0][0]), min(LONGEST, period[-1])
    if not longest > shortest * 10**_FEWEST_DECADES:
        raise ValueError(f"spectrum has {period[0]:g} to {period[-1]:g} s; allowed: half a decade")
    sought = np.geomspace(shortest, longest, POINTS)
    return Wanted(sought, interpolated(period, values, sought), damping, duration, envelope)
