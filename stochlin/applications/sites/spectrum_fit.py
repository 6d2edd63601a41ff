"""Fit of a ground whose motions, with an envelope and a duration, have a wanted mean response spectrum.

For given peak factors, the spectrum defines the variance of each oscillator, which is linear in the PSD
of the ground; the filters are fitted to these variances. The peak factors are first those of Vanmarcke's
formula. Since this formula neglects the envelope and the start from rest, they are then taken from a
simulation of the fitted ground.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

import numpy as np

from stochlin.applications.records.spectra import best_fit
from stochlin.applications.sites.simulated_spectra import Motions, peak_accelerations
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.envelopes import Envelope, strong_seconds
from stochlin.models.grounds import MOST_FILTERS, CloughPenzien, Ground, ParallelGround
from stochlin.models.rules.peak_factors import peak_factor_model

LONGEST, POINTS = 4.0, 72  # longest period [s] and number of periods for which a ground is fitted
GOOD_RMS, GOOD_WORST = 0.02, 0.06  # relative errors at which no further filter is tried
PATHS = 2048
STEPS_PER_PERIOD = 16  # of the search; the shortest of 24 neighbouring periods is 1.3 % too long
# Errors of the mean simulated spectrum at which corrections end, and the largest number of corrections.
DELIVERED_RMS, DELIVERED_WORST, CORRECTIONS = 0.02, 0.05, 3
_GROUND_WEIGHT = 10.0  # weight of the standard deviation of the ground; that of an oscillator is 1
_ROUNDS = 4  # number of fits with updated peak factors
_FIRST_FACTOR = 2.5

_STEP = 0.012  # step of ln w, an eighth of the resonance width of an oscillator with damping 0.05
_REACH = 8.0  # factor of the frequency range beyond the longest and the shortest period
# Bounds and starts of wg [rad/s], xig, wf [rad/s], xif and the intensity, in logarithms.
_LOWER = np.log([1.0, 0.02, 0.2, 0.2, 1e-20])
_UPPER = np.log([150.0, 3.0, 8.0, 1.5, 1e20])
_SOILS = np.log([(4.0, 0.3), (4.0, 0.8), (12.0, 0.3), (12.0, 0.8), (30.0, 0.5)])
_HIGH_PASS = np.log([(0.6, 0.6), (2.5, 0.6)])
_DRAWN = 6  # number of random combinations of these starts for two or three filters
_END = 1e-11  # tolerances of the least-squares search, whose minimum is flat


class Wanted(NamedTuple):
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
    wanted: Wanted, filters: int | None, seed: int, progress: Progress | None, paths: int = PATHS
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
        motions = Motions(fit.ground(), *timing, paths, seed + attempt, progress)
        peaks = peak_accelerations(wanted.periods, wanted.damping, motions, STEPS_PER_PERIOD)
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
    return (np.array([ones[i] for i in draw.choice(len(ones), count, False)]) for _ in range(_DRAWN))


class _Search:
    """Least-squares fit of the log standard deviations of oscillators of the wanted periods.

    The spectral moments of the oscillators are linear in the PSD of the ground. If the standard
    deviation of the ground is wanted, it is fitted too.
    """

    def __init__(self, wanted: Wanted) -> None:
        self.wanted = wanted
        w = 2 * np.pi / wanted.periods
        # Effective damping ratio whose stationary variance is that of a start from rest.
        damping = wanted.damping / -np.expm1(-2 * wanted.damping * w * wanted.strong)
        low, high = np.log([w.min() / _REACH, _REACH * w.max()])
        self._frequency = np.exp(np.arange(low, high, _STEP))
        x = (self._frequency / w[:, None]) ** 2
        response = 1 / (w[:, None] ** 4 * ((1 - x) ** 2 + 4 * damping[:, None] ** 2 * x))
        self._moments = [2 * _STEP * response * self._frequency ** (k + 1) for k in range(3)]
        self._rows, self._weight = self._moments[0], np.ones(wanted.periods.size)
        self._ground = np.zeros(0)
        if wanted.ground_std is not None:
            self._rows = np.vstack([self._rows, 2 * _STEP * self._frequency])
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
        l0, l1, l2 = (moment @ _psd(fit.logs, self._frequency) for moment in self._moments)
        crossings = np.sqrt(l2 / l0) * self.wanted.strong / np.pi
        bandwidth = np.sqrt(np.clip(1 - l1**2 / (l0 * l2), 0, 1))
        return peak_factor_model("vanmarcke").mean(np.maximum(crossings, 1.0), bandwidth)

    def corrected(self, fit: FittedFilters, accelerations: Array) -> FittedFilters:
        """The fit with the peak factors of a simulation, whose mean spectrum is ``accelerations``."""
        peaks = self.wanted._replace(accelerations=accelerations).displacements
        std = np.sqrt(self._moments[0] @ _psd(fit.logs, self._frequency))
        return self._best(peaks / std, [fit.logs])

    def _best(self, factors: Array, starts: Iterable[Array]) -> FittedFilters:
        frequency, rows, weight = self._frequency, self._rows, self._weight
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
        best = best_fit(residual, map(of_energy, starts), bounds, ftol=_END, xtol=_END, gtol=_END)
        return FittedFilters(best.x.reshape(-1, 5), best.fun[: target.size - self._ground.size])


def _psd(logs: Array, frequency: Array) -> Array:
    """PSD of all filters [m^2/s^3] (frequencies,)."""
    wg, xig, wf, xif, intensity = np.exp(logs.reshape(-1, 5)).T[..., None]
    soil = {"period": 2 * np.pi / wg, "damping": xig, "intensity": intensity}
    layer = {"high_pass_period": 2 * np.pi / wf, "high_pass_damping": xif}
    filters = CloughPenzien.filter(soil | layer)
    density: Array = (filters.intensity * filters.transmission(frequency)).sum(axis=0)
    return density
