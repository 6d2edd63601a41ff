"""Modulations of a ground by functions of time and frequency: their checks and their series."""

from __future__ import annotations

import inspect
import warnings
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.modulated_filters import (
    MOST_TERMS,
    FourierSeries,
    RowsFilter,
    shortest_series,
)
from stochlin.messages import DoubtfulInput, brief
from stochlin.models.arguments import as_numbers

INSTANTS = 257  # at which the series of a modulation is chosen
WIDER = 4.0  # factor on both sides of the frequencies of structures, between which c is sought
NOTED_ERROR, LARGEST_ERROR = 1e-3, 0.05  # of a series, from which it is noted or refused


def check_modulation(name: str, value: object) -> None:
    """Raise a TypeError unless ``value`` can be called with two arguments."""
    try:
        inspect.signature(value).bind("time", "frequency")  # type: ignore[arg-type]
    except ValueError:  # a compiled function, which does not say its arguments
        return
    except TypeError:
        raise TypeError(f"{name} = {brief(value)}; allowed: a function of time and frequency") from None


Modulation = Annotated[Callable[[Array, Array], Any], check_modulation]


@dataclass(frozen=True)
class SampledModulation:
    """A modulation at the frequencies of its series."""

    function: Callable[[Array, Array], Any]
    series: FourierSeries

    @classmethod
    def of(
        cls, function: Callable[[Array, Array], Any], duration: float, slowest: float, fastest: float
    ) -> SampledModulation:
        """The modulation for structures between two circular frequencies [rad/s]."""
        times = np.linspace(0, duration, INSTANTS)
        octaves = int(np.ceil(np.log2(WIDER**2 * fastest / slowest)))
        centers = slowest / WIDER * 2.0 ** np.arange(octaves + 1)
        series = shortest_series(lambda t, w: _values(function, t, w), times, centers)
        left_out = f"modulation: {MOST_TERMS} terms over frequency leave out {series.error:.2g} of it"
        if not series.error <= LARGEST_ERROR:
            raise ValueError(
                f"{left_out}; allowed: {LARGEST_ERROR:g} at most; make it smoother over frequency, with "
                "a limit as the frequency grows"
            )
        if series.error > NOTED_ERROR:
            warnings.warn(
                f"{left_out}, which is about the relative error of the result; to reduce it, make the "
                "modulation smoother over frequency",
                DoubtfulInput,
                stacklevel=5,
            )
        sampled = cls(function, series)
        if not sampled.largest(times).max() > 0:
            raise ValueError(
                f"modulation is 0 during the whole duration = {duration:g}; allowed: positive values "
                "within the duration"
            )
        return sampled

    @property
    def name(self) -> str:
        """Name of the function."""
        return getattr(self.function, "__name__", type(self.function).__name__)

    def largest(self, times: Array) -> Array:
        """Largest values over frequency (t,) at times [s]."""
        values: Array = _values(self.function, times, self.series.frequencies).max(axis=1)
        return values

    def amplitudes(self, times: Array) -> Array:
        """Amplitudes (t, r) of the outputs of the `modulated` ground at times [s]."""
        return self.series.amplitudes(_values(self.function, times, self.series.frequencies))

    def modulated(self, ground: RowsFilter) -> RowsFilter:
        """The ground with the outputs that the series needs."""
        return self.series.modulated(ground)

    def attributes(self) -> Mapping[str, str | float | int]:
        """Name, number of terms and error, as attributes of a result."""
        return {
            "modulation": self.name,
            "modulation_terms": self.series.orders.size,
            "modulation_error": self.series.error,
        }


def _values(function: Callable[[Array, Array], Any], times: Array, frequencies: Array) -> Array:
    """Values (t, f) of a modulation; raises an error unless they are finite and not negative."""
    result = as_numbers(
        "modulation(time, frequency)", function(times[:, None], frequencies[None, :]), "real numbers"
    )
    shape = times.size, frequencies.size
    try:
        values = np.broadcast_to(result.astype(float), shape)
    except ValueError:
        raise ValueError(
            f"modulation returns an array of shape {result.shape} for times {shape[0], 1} and "
            f"frequencies {1, shape[1]}; allowed: {shape}, or what broadcasts to it"
        ) from None
    wrong = np.argwhere(~((values >= 0) & np.isfinite(values)))
    if wrong.size:
        i, j = wrong[0]
        raise ValueError(
            f"modulation is {values[i, j]:g} at the time {times[i]:g} s and the circular frequency "
            f"{frequencies[j]:g} rad/s; allowed: finite values from 0 on"
        )
    return values
