"""Velocity pulse of a record, by the wavelets and the classifier of Shahi and Baker (2014)."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.signal import fftconvolve

from stochlin.kernels.basics.arrays import Array

REFERENCE = "Shahi, S. K. and Baker, J. W. (2014), Bull. Seismol. Soc. Am. 104(5), 2456-2466"
# Daubechies (1988), Commun. Pure Appl. Math. 41: the low-pass filter with four vanishing moments.
_LOW = np.array(
    [0.23037781330885523, 0.7148465705525415, 0.6308807679295904, -0.02798376941698385,
     -0.18703481171888114, 0.030841381835986965, 0.032883011666982945, -0.010597401784997278]
)  # fmt: skip
_HIGH = _LOW[::-1] * (-1.0) ** np.arange(_LOW.size)
_SUPPORT = _LOW.size - 1.0
_HALVINGS = 8
# Names and numbers of the authors' scripts: periods [s], period over scale, wavelets of a pulse, half of
# the width in scales in which they lie, candidates, share of the energy before an early pulse.
_PERIODS, _PERIOD_OF_SCALE, _SCALES = (0.25, 15.0), 1.4, 50
_WAVELETS, _WIDTH, _CANDIDATES, _LATE = 10, 0.4, 5, 0.17
_CENTIMETRES = 100.0
_STEP = 0.02  # s; finer velocities are averaged to about this step, a twelfth of the shortest period


class Pulse(NamedTuple):
    """The indicator of a record [-], positive if it has a pulse, and the period of this pulse [s]."""

    indicator: float
    period: float


@cache
def _wavelet() -> tuple[Array, Array]:
    """Times and the integral of the Daubechies wavelet of order 4 over its support, 0 to 7."""
    values = np.ones(1)
    for n in range(_HALVINGS):
        spread = np.zeros(2 * values.size - 1)
        spread[::2] = values
        values = np.sqrt(2) * np.convolve(spread, _LOW if n else _HIGH)
    # The first filter is that of the coarsest scale: it is spread most.
    step = 2.0**-_HALVINGS
    time = step * np.arange(values.size + 1)
    return time, np.concatenate([[0.0], np.cumsum(values) * step])


def _sampled(scale: int) -> Array:
    """The wavelet of a scale [samples] with unit energy, its mean in each sample."""
    time, integral = _wavelet()
    edges = np.arange(int(_SUPPORT * scale) + 2) / scale
    return np.sqrt(scale) * np.diff(np.interp(edges, time, integral))


def _coefficients(signal: Array, scale: int) -> Array:
    """Transform of a signal at one scale, by the sample at the middle of the wavelet."""
    found: Array = fftconvolve(signal, _sampled(scale)[::-1], mode="full")
    first = (_sampled(scale).size - 1) - int(_SUPPORT * scale / 2)
    return found[first : first + signal.size]


def _placed(scale: int, middle: int, size: int) -> Array:
    """The wavelet with its middle at a sample, zero outside of its support."""
    wavelet, placed = _sampled(scale), np.zeros(size)
    start = middle - int(_SUPPORT * scale / 2)
    low, high = max(start, 0), min(start + wavelet.size, size)
    placed[low:high] = wavelet[low - start : high - start]
    return placed


def _extracted(signal: Array, scale: int, middle: int) -> Array:
    """The pulse of ten wavelets of one scale around a sample."""
    pulse = np.zeros_like(signal)
    reach = int(np.ceil(_WIDTH * scale))
    low, high = max(0, middle - reach), min(signal.size, middle + reach + 1)
    for _ in range(_WAVELETS):
        coefficients = _coefficients(signal - pulse, scale)
        at = low + int(np.abs(coefficients[low:high]).argmax())
        pulse += coefficients[at] * _placed(scale, at, signal.size)
    return pulse


def _indicator(velocity: Array, pulse: Array) -> float:
    """The classifier of a velocity [m/s]; minus infinity for a pulse that comes late."""
    build_up, of_pulse = (np.cumsum(each**2) / (each**2).sum() for each in (velocity, pulse))
    if build_up[np.flatnonzero(of_pulse <= 0.05)[-1:]].sum() >= _LATE:
        return -np.inf
    peak, rest = np.abs(velocity).max(), velocity - pulse
    ratio = 0.63 * np.abs(rest).max() / peak + 0.777 * (rest**2).sum() / (velocity**2).sum()
    p, v = (ratio - 1.208421) / 0.2462717, (_CENTIMETRES * peak - 11.58861) / 18.88015
    return float(-7.817 - 0.5679 * p**2 - 0.1516 * v**2 - 3.0253 * p - 1.7396 * v - 2.7156 * p * v)


def velocity_pulse(velocity: Array, dt: float) -> Pulse:
    """The most pulse-like of five candidates in a velocity [m/s]; NaN if all come late.

    The authors turn both components to the direction of each candidate; here it is one component.
    """
    block = max(1, round(_STEP / dt))
    velocity = velocity[: velocity.size - velocity.size % block].reshape(-1, block).mean(axis=1)
    dt *= block
    shortest, longest = (period / _PERIOD_OF_SCALE / dt for period in _PERIODS)
    step = max(1, int(np.ceil((longest - int(shortest)) / _SCALES)))
    scales = max(1, int(shortest)) + step * np.arange(_SCALES + 1)
    coefficients = np.abs([_coefficients(velocity, int(scale)) for scale in scales])
    found = []
    for _ in range(_CANDIDATES):
        row, middle = np.unravel_index(coefficients.argmax(), coefficients.shape)
        coarse = int(scales[row])
        near = range(max(1, coarse - step), coarse + step + 1)
        scale = max(near, key=lambda s: abs(float(velocity @ _placed(s, int(middle), velocity.size))))
        pulse = _extracted(velocity, scale, int(middle))
        found.append(Pulse(_indicator(velocity, pulse), _PERIOD_OF_SCALE * scale * dt))
        reach = int(_WIDTH * coarse)
        coefficients[:, max(0, middle - reach) : middle + reach + 1] = 0.0
    best = max(found, key=lambda pulse: pulse.indicator)
    return best if np.isfinite(best.indicator) else Pulse(np.nan, np.nan)
