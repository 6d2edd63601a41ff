"""Spectra of records, and the estimators by which models of grounds are fitted to them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy import fft, optimize

from stochlin.applications.records.records import checked_record, strong_part
from stochlin.kernels.basics.arrays import Array
from stochlin.models.arguments import TwoNumbers, checked
from stochlin.models.grounds import Ground
from stochlin.solver.tables import labels

Vector = npt.NDArray[np.float64]
Part = TwoNumbers

STRONG_PART: Part = (0.05, 0.95)

# Shares of the cumulative energy over frequency between which a fit is made by default. Outside,
# leakage, noise and filters of the record outweigh the ground motion.
_ENERGY = (1e-4, 0.99)
# Share of the part under a cosine taper, for estimators that weight low ordinates fully.
_TAPER = 0.1
_INSIDE = 1e-6  # smallest distance of a start of a fit from the bounds
_SIXTH_OCTAVE = 2 ** (1 / 12)  # frequency ratio from the centre of a sixth of an octave to its edges


class Estimator(NamedTuple):
    """Residuals of a fit, with the weight and variance from which standard errors follow.

    The estimating equations are ``sum weight e dlog(model)/dp = 0``. The error ``e`` has the variance
    ``variance``, since ordinates of a record over the true PSD are exponentially distributed.
    """

    text: str
    residual: Callable[[Vector, Vector], Vector]
    weight: Callable[[Vector], Vector]
    variance: float
    taper: float


def _difference(record: Vector, model: Vector) -> Vector:
    return (model - record) / record.max()


def _log_difference(record: Vector, model: Vector) -> Vector:
    return np.log(model / record) - np.euler_gamma  # the mean log of an exponential variable


def _deviance(record: Vector, model: Vector) -> Vector:
    ratio = record / model
    return np.sign(ratio - 1) * np.sqrt(2 * np.maximum(ratio - 1 - np.log(ratio), 0))


ESTIMATORS = {
    "psd": Estimator("least squares on the linear PSD", _difference, np.square, 1.0, 0.0),
    "log_psd": Estimator(
        "least squares on the log PSD", _log_difference, np.ones_like, np.pi**2 / 6, _TAPER
    ),
    "whittle": Estimator("Whittle likelihood", _deviance, np.ones_like, 1.0, _TAPER),
}


def best_fit(
    residual: Callable[[Array], Array],
    starts: Iterable[Array],
    bounds: tuple[Any, Any],
    **options: float,
) -> Any:
    """The fit with the least sum of squares, as `scipy.optimize.least_squares` returns it.

    ``residual`` is a function of the unknowns, ``options`` are tolerances of the search.
    """
    lower, upper = bounds
    inside = (np.clip(start, lower + _INSIDE, upper - _INSIDE) for start in starts)
    fits = [optimize.least_squares(residual, start, "3-point", bounds, **options) for start in inside]
    return min(fits, key=lambda fit: float(fit.cost))


@checked
def fit_spectra(record: xr.DataArray, ground: Ground, *, part: Part = STRONG_PART) -> xr.Dataset:
    """Compare the spectrum of a record with that of a ground, for a chart of the fit.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] with the dimension ``time`` [s].
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, as from `stochlin.fit_ground` or any other.
    part : tuple of two floats
        Fractions of the cumulative energy between which the record is used.

    Returns
    -------
    xarray.Dataset
        Over ``frequency`` [rad/s], the positive Fourier frequencies: ``psd_record`` (raw
        periodogram), ``psd_smoothed`` (its mean over a sixth of an octave) and ``psd_ground``, all
        two-sided per rad/s [m^2/s^3]. Twice the integral of ``psd_record`` is the variance of this part
        of the record.

    Raises
    ------
    TypeError, ValueError
        If the record or the ground is not valid, or the fractions are out of range.

    References
    ----------
    Schuster, A. (1898), Terrestrial Magnetism 3, for the periodogram.

    Examples
    --------
    >>> import numpy as np, xarray as xr
    >>> import stochlin as sl
    >>> time = 0.01 * np.arange(4000)
    >>> record = xr.DataArray(np.sin(10 * time), dims="time", coords={"time": time})
    >>> spectra = sl.charts.fit_spectra(record, sl.WhiteNoise(0.05))
    >>> round(float(spectra.psd_record.idxmax("frequency")), 1)
    10.0
    """
    frequency, density, duration = periodogram(strong_part(record, *part))
    axis = labels.axis("frequency", "circular frequency", frequency[1:], "rad/s")
    densities = {"psd_record": density[1:], "psd_smoothed": _smoothed(frequency[1:], density[1:])}
    spectra = xr.Dataset({name: axis.copy(data=values) for name, values in densities.items()})
    spectra["psd_ground"] = ground.psd(axis)
    for variable, long_name in (
        ("psd_record", "two-sided PSD of the record, raw periodogram"),
        ("psd_smoothed", "two-sided PSD of the record, mean over a sixth of an octave"),
        ("psd_ground", f"two-sided PSD of the ground, {ground.name}"),
    ):
        spectra[variable].attrs = {"units": "m^2/s^3", "long_name": long_name}
    text = described(record, part, duration)
    labels.with_run_information(
        spectra, f"Spectrum beside {ground.name} ground: {text}", "fit_spectra", {"ground": ground}
    )
    spectra.attrs |= {"record": text, "ground_source": ground.source}
    return spectra


def described(record: xr.DataArray, part: Part, duration: float) -> str:
    """Name of a record, part used and its duration [s], for sources and titles."""
    name = record.attrs.get("source", "a record")
    return f"{name}, {100 * part[0]:g}-{100 * part[1]:g} % part ({duration:.4g} s)"


def periodogram(
    part: xr.DataArray, padding: int = 1, taper: float = 0.0
) -> tuple[Vector, Vector, float]:
    """Frequencies [rad/s] from 0 to Nyquist, two-sided PSD per rad/s, and the duration [s]."""
    from scipy import signal  # which takes long to load, with all of scipy.stats

    values, dt = checked_record(part)
    if not np.ptp(values):
        raise ValueError(f"record is {values[0]:g} throughout the part used; allowed: some motion")
    length = values.size if padding == 1 else fft.next_fast_len(padding * values.size, real=True)
    window = ("tukey", taper)
    hertz, density = signal.periodogram(values, 1 / dt, window, length, return_onesided=False)
    half = length // 2 + 1
    return 2 * np.pi * np.abs(hertz[:half]), density[:half] / (2 * np.pi), values.size * dt


def energy_band(frequency: Vector, density: Vector, duration: float) -> tuple[float, float]:
    """Default frequency range of a fit [rad/s], lowest and highest."""
    energy = np.cumsum(density)
    low, high = frequency[np.searchsorted(energy, np.multiply(_ENERGY, energy[-1]))]
    return max(2 * np.pi / duration, float(low)), float(high)


def _smoothed(frequency: Vector, density: Vector) -> Vector:
    """Mean of the density over a sixth of an octave, by differences of the cumulative energy."""
    step = frequency[0]
    edges = np.append(0.0, frequency) + step / 2
    energy = np.append(0.0, np.cumsum(density) * step)
    # A band is never narrower than the step, and does not go beyond the ends.
    low = np.clip(np.minimum(frequency / _SIXTH_OCTAVE, frequency - step / 2), edges[0], None)
    high = np.clip(np.maximum(frequency * _SIXTH_OCTAVE, frequency + step / 2), None, edges[-1])
    mean: Vector = (np.interp(high, edges, energy) - np.interp(low, edges, energy)) / (high - low)
    return mean
