"""A ground whose motions deliver a response spectrum, under an envelope and over a duration.

For a given peak factor the spectrum fixes the variance of each oscillator, which is linear in the PSD of
the ground: the search for filters goes by that. Peak factors come from Vanmarcke's formula first, and
then, since the formula knows neither envelope nor start, from a simulation of what was found.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy import optimize

from stochlin.analyses.sites.simulated_spectra import peak_accelerations
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope, strong_seconds
from stochlin.models.grounds import CloughPenzien, Ground, ParallelGround
from stochlin.models.rules.peak_factors import peak_factor_model

LONGEST, POINTS = 4.0, 72  # of the periods for which a ground is fitted; the first in s
MOST_FILTERS = 3
GOOD_RMS, GOOD_WORST = 0.02, 0.06  # relative errors at which no further filter is tried
PATHS = 2048
# Error of the delivered spectrum at which a correction ends, and how often it is made at most.
DELIVERED_RMS, DELIVERED_WORST, CORRECTIONS = 0.02, 0.05, 3
_GROUND_WEIGHT = 10.0  # of the ground's own standard deviation, beside one oscillator
_ROUNDS = 4  # in which peak factors and filters come to agree
_FIRST_FACTOR = 2.5

_STEP = 0.012  # of ln w: an eighth of the width of the resonance of an oscillator of 5 %
_REACH = 8.0  # beyond the frequencies of the longest and of the shortest period
# Soil and high-pass oscillator, wg, xig, wf and xif in rad/s and 1, and the intensity.
_LOWER = np.log([1.0, 0.02, 0.2, 0.2, 1e-20])
_UPPER = np.log([150.0, 3.0, 8.0, 1.5, 1e20])
_SOILS = np.log([(4.0, 0.3), (4.0, 0.8), (12.0, 0.3), (12.0, 0.8), (30.0, 0.5)])
_HIGH_PASS = np.log([(0.6, 0.6), (2.5, 0.6)])
_DRAWN = 6  # combinations of them that two or three filters start from
_SLACK = 1e-6  # that a start keeps from the bounds
_END = 1e-11  # of the search: valleys are flat


class Wanted(NamedTuple):
    """What motions are to deliver."""

    periods: Array  # [s]
    accelerations: Array  # [m/s^2]
    damping: float
    duration: float  # [s]
    envelope: Envelope | None
    ground_std: float | None = None  # [m/s^2] of the stationary ground, where that is known

    @property
    def strong(self) -> float:
        """How long a stationary motion of the same energy lasts [s]."""
        return strong_seconds(self.duration, self.envelope)

    @property
    def displacements(self) -> Array:
        """Mean peaks [m]."""
        return self.accelerations * (self.periods / (2 * np.pi)) ** 2


class Delivered(NamedTuple):
    """A ground, and by how much what its motions deliver differs from what is wanted."""

    ground: Ground
    off: Array  # ln of the mean simulated spectrum over that wanted

    @property
    def rms(self) -> float:
        """Root mean square over the periods."""
        return float(np.sqrt(np.mean(self.off**2)))

    @property
    def worst(self) -> float:
        """Largest, of either sign."""
        return float(np.abs(self.off).max())


class _Oscillators:
    """Linear oscillators of the periods wanted; moments of their displacements, linear in the PSD."""

    def __init__(self, wanted: Wanted) -> None:
        w = 2 * np.pi / wanted.periods
        # From rest, after the strong part: the variance of a stationary oscillator of this damping.
        damping = wanted.damping / -np.expm1(-2 * wanted.damping * w * wanted.strong)
        low, high = np.log([w.min() / _REACH, _REACH * w.max()])
        self.frequency = np.exp(np.arange(low, high, _STEP))
        x = (self.frequency / w[:, None]) ** 2
        response = 1 / (w[:, None] ** 4 * ((1 - x) ** 2 + 4 * damping[:, None] ** 2 * x))
        self.moments = [2 * _STEP * response * self.frequency ** (k + 1) for k in range(3)]
        self.ground = 2 * _STEP * self.frequency  # of the variance of the ground itself
        self._strong = wanted.strong

    def variance(self, psd: Array) -> Array:
        return self.moments[0] @ psd

    def peak_factors(self, psd: Array) -> Array:
        l0, l1, l2 = (moment @ psd for moment in self.moments)
        crossings = np.sqrt(l2 / l0) * self._strong / np.pi
        bandwidth = np.sqrt(np.clip(1 - l1**2 / (l0 * l2), 0, 1))
        return peak_factor_model("vanmarcke").mean(np.maximum(crossings, 1.0), bandwidth)


class _Filters(NamedTuple):
    """Clough-Penzien filters, a row each; logarithms of wg, xig, wf, xif and the intensity."""

    logs: Array
    off: Array

    @property
    def good(self) -> bool:
        error = np.abs(self.off)
        return float(np.sqrt(np.mean(error**2))) <= GOOD_RMS and float(error.max()) <= GOOD_WORST

    def ground(self) -> Ground:
        rows = np.exp(self.logs)
        parts = [
            CloughPenzien(2 * np.pi / wg, xig, 2 * np.pi / wf, xif, intensity)
            for wg, xig, wf, xif, intensity in rows[np.argsort(rows[:, 0])].tolist()
        ]
        return parts[0] if len(parts) == 1 else ParallelGround(parts)


def deliver(
    wanted: Wanted, filters: int | None, seed: int, progress: Progress | None, paths: int = PATHS
) -> Delivered:
    """The ground that delivers a spectrum, by so many filters, or by the fewest that do it well."""
    search = _Search(wanted)
    found = None
    for count in range(1, MOST_FILTERS + 1) if filters is None else [filters]:
        found = search.by_formula(count)
        if found.good:
            break
    assert found is not None
    best = None
    for attempt in range(CORRECTIONS + 1):
        means = peak_accelerations(
            wanted.periods,
            wanted.damping,
            found.ground(),
            wanted.duration,
            wanted.envelope,
            paths=paths,
            seed=seed + attempt,  # a correction must not fit the scatter of one sample
            progress=progress,
        ).mean(axis=0)
        now = Delivered(found.ground(), np.log(means / wanted.accelerations))
        if best is None or now.rms < best.rms:
            best = now
        if best.rms <= DELIVERED_RMS and best.worst <= DELIVERED_WORST:
            break
        found = search.corrected(found, means)
    assert best is not None
    return best


def _starts(count: int) -> Iterable[Array]:
    ones = [np.concatenate([*pair, [0.0]]) for pair in product(_SOILS, _HIGH_PASS)]
    if count == 1:
        return (one[None] for one in ones)
    draw = np.random.default_rng(0)
    return (np.array([ones[i] for i in draw.choice(len(ones), count, False)]) for _ in range(_DRAWN))


class _Search:
    """Least squares of the logarithms of standard deviations, of oscillators and of the ground."""

    def __init__(self, wanted: Wanted) -> None:
        self.wanted, self.oscillators = wanted, _Oscillators(wanted)
        self._rows, self._weight = self.oscillators.moments[0], np.ones(wanted.periods.size)
        self._ground = np.zeros(0)
        if wanted.ground_std is not None:
            self._rows = np.vstack([self._rows, self.oscillators.ground])
            self._weight = np.append(self._weight, _GROUND_WEIGHT)
            self._ground = np.array([wanted.ground_std])

    def by_formula(self, count: int) -> _Filters:
        """By so many filters, with the peak factors of the formula."""
        factors = np.full(self.wanted.periods.size, _FIRST_FACTOR)
        starts = list(_starts(count))
        for _ in range(_ROUNDS):
            found = self._best(factors, starts)
            factors = self.oscillators.peak_factors(self._psd(found))
            starts = [found.logs]
        return found

    def corrected(self, found: _Filters, accelerations: Array) -> _Filters:
        """With the peak factors of a simulation, whose mean spectrum this is."""
        peaks = accelerations * (self.wanted.periods / (2 * np.pi)) ** 2
        std = np.sqrt(self.oscillators.variance(self._psd(found)))
        return self._best(peaks / std, [found.logs])

    def _psd(self, found: _Filters) -> Array:
        return _psd(found.logs, self.oscillators.frequency)[0]

    def _best(self, factors: Array, starts: Iterable[Array]) -> _Filters:
        frequency, rows, weight = self.oscillators.frequency, self._rows, self._weight
        target = np.log(np.append(self.wanted.displacements / factors, self._ground))

        def residual(logs: Array) -> Array:
            found: Array = weight * (0.5 * np.log(rows @ _psd(logs, frequency)[0]) - target)
            return found

        def slope(logs: Array) -> Array:
            psd, slopes = _psd(logs, frequency)
            found: Array = 0.5 * weight[:, None] * (rows @ slopes) / (rows @ psd)[:, None]
            return found

        fits = []
        for start in starts:
            logs = start.copy()
            logs[:, -1] -= 2 * (residual(logs) / weight).mean()
            lower, upper = (np.tile(bound, len(start)) for bound in (_LOWER, _UPPER))
            inside = np.clip(logs.ravel(), lower + _SLACK, upper - _SLACK)
            fits.append(
                optimize.least_squares(
                    residual, inside, slope, (lower, upper), ftol=_END, xtol=_END, gtol=_END
                )
            )
        best = min(fits, key=lambda fit: float(fit.cost))
        return _Filters(best.x.reshape(-1, 5), best.fun[: target.size - self._ground.size])


def _psd(logs: Array, frequency: Array) -> tuple[Array, Array]:
    """PSD of all filters together [m^2/s^3], and its slopes by their parameters (frequencies, 5 n)."""
    wg, xig, wf, xif, intensity = np.exp(logs.reshape(-1, 5)).T[..., None]
    x, y = (frequency / wg) ** 2, (frequency / wf) ** 2
    a, b = 4 * xig**2, 4 * xif**2
    soil, layer = (1 - x) ** 2 + a * x, (1 - y) ** 2 + b * y
    parts = intensity * (1 + a * x) / soil * y**2 / layer
    slopes = np.stack(
        [
            -2 * x * (a / (1 + a * x) - (a - 2 * (1 - x)) / soil),
            2 * a * x / (1 + a * x) - 2 * a * x / soil,
            -2 * (2 - y * (b - 2 * (1 - y)) / layer),
            -2 * b * y / layer,
            np.ones_like(x),
        ],
        axis=1,
    )
    return parts.sum(axis=0), (parts[:, None] * slopes).reshape(-1, frequency.size).T
