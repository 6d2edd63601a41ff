"""Ground filters whose output is modulated by a function of time and frequency.

An evolutionary process (Priestley 1965) is ``Int a(t, w) exp(i w t) dZ(w)``, with the spectrum
``a^2 S(w)`` and ``a >= 0``. Frequencies are taken by the angle ``phi = 2 arctan(w / c)``, from 0 to
``pi``, with a central frequency ``c``. There ``a(t, w)`` is one of four Fourier series,

    a(t, w) = sum over i of a_i(t) cos(i phi) or sin(i phi),    i = 0, 1, 2 ... or 1/2, 3/2 ...,

which differ in how they go on beyond 0 and ``pi``; the one of least work is taken. The all-pass filter
``(c - s) / (c + s)`` only turns phases, by ``-phi``. With the output ``u_p`` of a chain of ``p`` such
filters after the ground, ``cos(i phi)`` is ``(u_{h+i} + u_{h-i}) / 2`` and ``sin(i phi)`` is
``(u_{h-i} - u_{h+i}) / 2``, each up to a turn of phases that is the same at all times, so that no
covariance changes. ``h`` is the largest ``i``. Thus the modulated ground is a filter with ``2 h`` more
states, whose output rows have the amplitudes ``a_i(t)``.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple, Self

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Matrices

SAMPLES = 256  # angles at which a modulation is evaluated
ANGLES = np.pi * (np.arange(SAMPLES) + 0.5) / SAMPLES
MOST_TERMS = 48  # of a series, which has fewer if these make its error
ENOUGH = 1e-11  # or less
KINDS = (np.cos, 0.0), (np.sin, 1.0), (np.cos, 0.5), (np.sin, 0.5)  # functions, and the first i

Modulation = Callable[[Array, Array], Array]  # of times (t,) and frequencies (f,) [rad/s], (t, f)


class RowsFilter(NamedTuple):
    """A filter under unit white noise with ``r`` outputs."""

    matrix: Array  # (k, k)
    noise: Array  # (k,)
    rows: Array  # (r, k): of the states in the outputs
    direct: Array  # (r,): of the white noise in the outputs

    @classmethod
    def of(cls, ground: Matrices) -> Self:
        """The filter of a ground; one without states gives out the white noise."""
        direct = np.full(1, 0.0 if ground.noise.size else 1.0)
        return cls(ground.matrix, ground.noise, ground.output[None], direct)

    def with_all_passes(self, center: float, length: int) -> Self:
        """The filter of one output with a chain of all-pass filters behind; the rows are all ``u_p``."""
        k = self.noise.size
        states, outputs = k + length, length + 1
        shapes = (states, states), (states,), (outputs, states), (outputs,)
        longer = type(self)(*map(np.zeros, shapes))
        longer.matrix[:k, :k], longer.noise[:k] = self.matrix, self.noise
        longer.rows[0, :k], longer.direct[0] = self.rows[0], self.direct[0]
        for p in range(length):  # the state z' = -c z + 2 c u_p gives u_{p+1} = z - u_p
            longer.matrix[k + p] = 2 * center * longer.rows[p]
            longer.noise[k + p] = 2 * center * longer.direct[p]
            longer.matrix[k + p, k + p] = -center
            longer.rows[p + 1], longer.direct[p + 1] = -longer.rows[p], -longer.direct[p]
            longer.rows[p + 1, k + p] = 1.0
        return longer


class FourierSeries(NamedTuple):
    """A Fourier series for a modulation, by the angle of the frequency."""

    center: float  # c [rad/s]
    function: np.ufunc  # cos or sin
    orders: Array  # (r,) the i
    error: float  # root mean square over the angle of what is left out, over that of the modulation

    @property
    def frequencies(self) -> Array:
        """Frequencies (SAMPLES,) of the angles [rad/s]."""
        return frequencies_of(self.center)

    def amplitudes(self, values: Array) -> Array:
        """The ``a_i`` (t, r) from values (t, SAMPLES) of the modulation."""
        return values @ _coefficients(self.function, self.orders)

    def modulated(self, ground: RowsFilter) -> RowsFilter:
        """The ground, whose outputs with the amplitudes give the modulated motion."""
        last, sign = self.orders[-1], 1.0 if self.function is np.cos else -1.0
        chain = ground.with_all_passes(self.center, round(2 * last))
        less, more = (np.rint(last + side * self.orders).astype(int) for side in (-1, 1))
        rows, direct = (0.5 * (of[less] + sign * of[more]) for of in (chain.rows, chain.direct))
        return chain._replace(rows=rows, direct=direct)


def shortest_series(modulation: Modulation, times: Array, centers: Iterable[float]) -> FourierSeries:
    """The series for a modulation that needs the least work, of those with the least error."""
    choices = []
    for center in centers:
        values = modulation(times, frequencies_of(center))
        choices += [_series(center, values, *kind) for kind in KINDS]
    return min(
        choices, key=lambda series: (max(series.error, ENOUGH), series.center * series.orders[-1])
    )


def frequencies_of(center: float) -> Array:
    """Frequencies (SAMPLES,) of the angles [rad/s]."""
    return center * np.tan(ANGLES / 2)


def _series(center: float, values: Array, function: np.ufunc, first: float) -> FourierSeries:
    """One kind of series for values (t, SAMPLES) of a modulation."""
    orders = first + np.arange(SAMPLES)
    squares = 0.5 * (values @ _coefficients(function, orders)) ** 2
    left_out = np.sqrt(np.cumsum(squares[:, ::-1], axis=1)[:, ::-1].max(axis=0))
    size = max(np.sqrt((values**2).mean(axis=1).max()), np.finfo(float).tiny)
    errors = left_out[1 : MOST_TERMS + 1] / size
    last = int(np.argmax(errors <= ENOUGH)) if errors.min() <= ENOUGH else MOST_TERMS - 1
    return FourierSeries(center, function, orders[: last + 1], float(errors[last]))


def _coefficients(function: np.ufunc, orders: Array) -> Array:
    """Matrix (SAMPLES, r) from values at the angles to the coefficients of a series."""
    matrix: Array = function(ANGLES[:, None] * orders) * (np.where(orders == 0, 1.0, 2.0) / SAMPLES)
    return matrix
