"""Fit of a ground to a strong-motion record, or to a response spectrum."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.records.ground_fit import ground_of_record
from stochlin.analyses.records.spectra import STRONG_PART, Part
from stochlin.analyses.sites.spectra import SHORTEST, checked_spectrum, interpolated, is_spectrum
from stochlin.analyses.sites.spectrum_fit import (
    LONGEST,
    MOST_FILTERS,
    POINTS,
    Delivered,
    Wanted,
    deliver,
)
from stochlin.analyses.tables.checks import check_duration, check_whole
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect

_OF_SPECTRA = "clough_penzien"
_FEWEST_DECADES = 0.5  # of periods that a spectrum covers within the range of a fit


def fit_ground(
    target: xr.DataArray,
    model: str | None = None,
    estimator: str | None = None,
    *,
    part: Part = STRONG_PART,
    frequency_range: tuple[float, float] | None = None,
    duration: float | None = None,
    envelope: Envelope | None = None,
    filters: int | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> Any:
    """Fit a ground to a record, or to an elastic response spectrum.

    **To a record**, by its power spectral density. The model is compared with the raw periodogram of the
    part without its mean: there is no smoothing bandwidth to choose, and the peak of a narrow-band
    ground keeps its height. The part is padded with zeros to four times its length, so that the result
    does not depend on where the Fourier frequencies fall; with ``estimator="psd"`` this is the
    least-squares fit of the sample autocovariance at all lags (Parseval). The two other estimators also
    see the frequencies at which the ground is weak, where leakage from the peak counts: for them a tenth
    of the part is under a cosine taper. The search starts from a grid of periods and dampings.

    **To a spectrum**, so that motions of this duration and envelope have it in the mean. The ground is
    one Clough-Penzien filter, or several in parallel. The search goes by the variances of elastic
    oscillators, `peak_factor_model` ``"vanmarcke"`` and an effective damping for the start from rest;
    then motions are simulated, and what they miss is put right, once as a rule.

    Parameters
    ----------
    target : xarray.DataArray
        A record: ground acceleration [m/s^2] over ``time`` [s], as `read_record` gives it. Or a
        spectrum: pseudo-acceleration [m/s^2] over ``period`` [s], as `eurocode_8`, `asce_7` and
        `read_spectrum` give it.
    model : str, optional
        The kind of ground. Of a record ``"kanai_tajimi"`` (by default), ``"clough_penzien"``, or an
        extension that can be fitted; of a spectrum ``"clough_penzien"``.
    estimator : {"psd", "log_psd", "whittle"}, optional
        Of a record, what the fit minimizes: the squared difference of the spectra, which follows the
        peak (by default); the squared difference of their logarithms, in which each frequency of the
        range counts alike; or the Whittle likelihood, the most accurate one if the model is true. On a
        record that the model does not describe they differ widely: look at it with `fit_spectra`.
    part : tuple of two floats
        Fractions of the cumulative energy between which a record is used, see `strong_part`;
        (0, 1) is all of it.
    frequency_range : tuple of two floats, optional
        Of a record, lowest and highest circular frequency used [rad/s]. By default those below which the
        part has 0.01 % (and one cycle at least) and 99 % of its energy. They matter little to ``"psd"``
        and much to the other two.
    duration : float
        Of a spectrum, the length of the motions [s]. A spectrum does not say it, and inelastic gaps
        depend on it: try half and double.
    envelope : AminAng, ShinozukaSato, GammaEnvelope or HsuBernard, optional
        Of a spectrum, how the motions rise and fall; without it they are stationary.
    filters : int, optional
        Of a spectrum, the number of filters, 1 to 3; by default the fewest that come within 2 % (root
        mean square) and 6 % (largest error) before the correction.
    seed : int
        Of the motions that are simulated for a spectrum.
    progress : callable, optional
        Called with the share of the work of each simulation that is done.

    Returns
    -------
    KanaiTajimi, CloughPenzien, ParallelGround or an extension
        With ``intensity`` [m^2/s^3], the two-sided PSD per rad/s of the white noise. ``source`` names
        what was fitted and how well: of a record the estimator, the part, the range and relative
        standard errors, of a spectrum the error of what simulated motions deliver.

    Raises
    ------
    TypeError, ValueError
        If the target is neither a record nor an elastic spectrum, an option is unknown or goes with the
        other kind of target, the range holds too few frequencies or periods, or the fit fails or ends
        on a bound, as it does where a record does not define a parameter.

    Notes
    -----
    The standard errors of a fit to a record are those of a stationary Gaussian process of the fitted
    spectrum [1]_, which a part of a record is only roughly. Short records of narrow-band ground say
    little: in 200 simulated ones of 71 s with ``wg=3.09``, ``xig=0.054`` the damping found over the true
    one was 0.21 to 2.0 with ``"psd"`` (median 0.5) and 0.63 to 1.8 with ``"whittle"`` (median 1.1), in
    nine cases of ten. A periodogram of duration d cannot tell a damping ratio below about ``2.8/(wg d)``
    from a sinusoid; ``source`` says so where the result is less than twice that.

    Spectra are fitted from 0.05 to 4 s. A design spectrum is no spectrum of an earthquake to come: it is
    neither its mean nor its median, and the scatter between earthquakes is not in it.

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
    >>> time, step = 0.02 * np.arange(20000), 2 * np.pi / 400
    >>> psd = sl.KanaiTajimi(period=1.0, damping=0.3, intensity=0.01).psd(step * np.arange(10001))
    >>> phase = np.random.default_rng(1).uniform(0, 2 * np.pi, psd.size)
    >>> spectrum = np.sqrt(psd.values * step) * np.exp(1j * phase)
    >>> history = np.fft.irfft(spectrum) * time.size
    >>> record = xr.DataArray(history, dims="time", coords={"time": time})
    >>> ground = sl.fit_ground(record, part=(0, 1))
    >>> round(ground.period, 2), round(ground.damping, 1), round(ground.intensity, 3)
    (1.0, 0.3, 0.01)

    Of a spectrum:

    >>> spectrum = sl.eurocode_8(0.25 * 9.80665, "B")
    >>> ground = sl.fit_ground(spectrum, duration=20.0, envelope=sl.AminAng(2.0, 12.0, 0.4))
    >>> table = sl.simulated_spectrum(ground, spectrum, 20.0, sl.AminAng(2.0, 12.0, 0.4))
    >>> bool(abs(table.ratio.sel(period=slice(0.1, 4)) - 1).max() < 0.06)
    True
    """
    if not isinstance(target, xr.DataArray):
        raise TypeError(
            f"target is a {type(target).__name__}; allowed: an xarray.DataArray, a record over time or "
            "a spectrum over period"
        )
    if not is_spectrum(target):
        if "time" not in target.dims:
            raise ValueError(
                f"target has the dimensions {target.dims}; allowed: time, of a record, or period, of a "
                "spectrum"
            )
        others = {"duration": duration, "envelope": envelope, "filters": filters}
        given = [name for name, value in others.items() if value is not None]
        if given:
            raise ValueError(f"{given[0]} goes with a spectrum; a record has its own, so leave it out")
        return ground_of_record(
            target,
            model or "kanai_tajimi",
            estimator or "psd",
            part=part,
            frequency_range=frequency_range,
        )
    if not (model is None or (isinstance(model, str) and model == _OF_SPECTRA)):
        raise ValueError(f"model = {brief(model)} is not fitted to a spectrum; allowed: {_OF_SPECTRA}")
    if estimator is not None or frequency_range is not None or part is not STRONG_PART:
        raise ValueError("estimator, part and frequency_range go with a record; leave them out")
    if filters is not None:
        check_whole("filters", filters, 1, MOST_FILTERS)
    check_whole("seed", seed, 0)
    if duration is None:
        raise ValueError("duration is missing; a spectrum does not contain it: give it in seconds")
    check_duration(duration)
    if envelope is not None:
        expect(envelope, Envelope, "envelope")
    wanted = _wanted(target, duration, envelope)
    found = deliver(wanted, filters, seed, progress)
    return _with_source(found, wanted, str(target.attrs.get("source", "a spectrum")))


def _wanted(spectrum: xr.DataArray, duration: float, envelope: Envelope | None) -> Wanted:
    period, values, damping = checked_spectrum(spectrum)
    shortest, longest = max(SHORTEST, period[period > 0][0]), min(LONGEST, period[-1])
    if not longest > shortest * 10**_FEWEST_DECADES:
        raise ValueError(
            f"spectrum goes from {period[0]:g} to {period[-1]:g} s; allowed: half a decade or more "
            f"between {SHORTEST:g} and {LONGEST:g} s"
        )
    sought = np.geomspace(shortest, longest, POINTS)
    return Wanted(sought, interpolated(period, values, sought), damping, duration, envelope)


def _with_source(found: Delivered, wanted: Wanted, source: str) -> Ground:
    under = "stationary" if wanted.envelope is None else wanted.envelope.describe()
    text = (
        f"fitted to {source}, damping {wanted.damping:g}, from {wanted.periods[0]:.3g} to "
        f"{wanted.periods[-1]:.3g} s; motions of {wanted.duration:g} s, {under}, have this spectrum in "
        f"the mean with errors of {100 * found.rms:.1f} % (root mean square) and "
        f"{100 * found.worst:.1f} % (largest)"
    )
    return replace(found.ground, source=text)
