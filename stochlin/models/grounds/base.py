"""The base of the grounds: stationary random ground acceleration as filtered white noise."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter, stationary
from stochlin.models.parameters import Model, Parameter, Range, as_array, expect
from stochlin.registry import Registry

GROUNDS: Registry[type[Ground]] = Registry("ground", "stochlin.models.grounds")
POSITIVE_DAMPING = Range(reason="an undamped ground has no stationary motion")
MOST_FILTERS = 3  # in parallel, of a ground that is fitted to a spectrum


class Fit(NamedTuple):
    """Bounds and starting values by which `fit_ground` seeks parameters other than period and intensity.

    Those of parameters in seconds are multiples of the ground's ``period``.
    """

    bounds: Mapping[str, tuple[float, float]]  # lower and upper bound, by name of the parameter
    starts: Sequence[tuple[float, ...]]  # starting values of all these parameters, one tuple a search


@dataclass(frozen=True)
class Ground(Model):
    """Base of the grounds; ``intensity`` is the two-sided PSD ``S0`` of the white noise [m^2/s^3]."""

    name: ClassVar[str]
    fit: ClassVar[Fit | None] = None  # None for a ground that cannot be fitted to records
    source: str = field(default="", compare=False, kw_only=True)

    @staticmethod
    def filter(values: Mapping[str, Any]) -> Filter:
        """The filter of the white noise for these parameter values, numbers or arrays over cells.

        State space, spectra, linearization and time steps are derived from this filter.
        """
        raise NotImplementedError

    def filter_of(self, rows: Iterable[Array]) -> Filter:
        """The filter for arrays over cells; ``rows`` are parameter values in the order of `cells`."""
        return self.filter(dict(zip(self.cells(), rows, strict=True)))

    def lone_filter(self) -> Filter:
        """The filter of a ground whose parameters are all numbers."""
        return self.filter({name: value.item() for name, value in self.arrays().items()})

    def psd(self, frequency: Parameter) -> xr.DataArray:
        """Two-sided power spectral density of the ground acceleration, per rad/s [m^2/s^3].

        ``frequency`` holds circular frequencies [rad/s] of any shape; a plain 1-D array gets the
        dimension ``frequency``.

        Examples
        --------
        >>> import stochlin as sl
        >>> float(sl.KanaiTajimi(period=2.0, damping=0.05).psd(0.0))
        1.0
        """
        if not isinstance(frequency, xr.DataArray):
            values = as_array(frequency).astype(float)
            dims = ["frequency"][: values.ndim]
            coords = {"frequency": ("frequency", values, {"units": "rad/s"})} if dims else None
            frequency = xr.DataArray(values, dims=dims, coords=coords)
        density = self.arrays()["intensity"] * self._transmission(frequency)
        density.attrs = {"units": "m^2/s^3", "long_name": "two-sided PSD of ground acceleration"}
        return density.rename("psd")

    def _transmission(self, frequency: xr.DataArray) -> xr.DataArray:
        """PSD of the ground acceleration over ``S0`` [-]."""

        def of_cells(frequency: Array, *rows: Array) -> Array:
            return self.filter_of(rows).transmission(frequency)

        arrays = self.arrays().values()
        return xr.apply_ufunc(of_cells, frequency, *arrays, join="exact")


def rms_acceleration(ground: Ground) -> float:
    """Standard deviation of the stationary ground acceleration [m/s^2]; infinite for white noise.

    For a Kanai-Tajimi ground this is ``sqrt(pi S0 wg (1 + 4 xig^2)/(2 xig))``.
    """
    expect(ground, Ground, "ground")
    soil = ground.lone_filter()
    if not soil.states:
        return np.inf
    matrix, noise, output = soil.arrays
    covariance = stationary(matrix[None], noise[None])[0]
    return float(np.sqrt(2 * np.pi * soil.intensity * output @ covariance @ output))
