"""Grounds: stationary random ground acceleration as filtered white noise (eqs. 11 and 12)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization import filters
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing
from stochlin.models.parameters import Model, Parameter, Range, parameter

POSITIVE = Range()


@dataclass(frozen=True)
class Ground(Model):
    """Base of the grounds. ``intensity`` is the two-sided PSD ``S0`` of the white noise."""

    name: ClassVar[str]
    source: str = field(default="", compare=False, kw_only=True)

    @staticmethod
    def forcing(system: EquivalentSystem, parameters: Array) -> Forcing:
        """Forcing correlations of ``system``; ``parameters`` as listed by `kernel_parameters`."""
        raise NotImplementedError

    @staticmethod
    def memory(system: EquivalentSystem, parameters: Array) -> tuple[Forcing, tuple[Array, ...]]:
        """Forcing of ``system``, and frequency and damping ratio of the soil; white noise has none."""
        raise NotImplementedError

    def kernel_parameters(self) -> list[xr.DataArray]:
        """Intensity first, then frequencies [rad/s] and damping ratios of the filters."""
        raise NotImplementedError

    def psd(self, frequency: Parameter) -> xr.DataArray:
        """Two-sided power spectral density of the ground acceleration.

        Parameters
        ----------
        frequency : float or array
            Circular frequency [rad/s], any shape; a plain 1-D array gets the dimension
            ``frequency``.

        Returns
        -------
        xarray.DataArray
            PSD per rad/s [m^2/s^3].

        Examples
        --------
        >>> import stochlin as sl
        >>> float(sl.KanaiTajimi(period=2.0, damping=0.05).psd(0.0))
        1.0
        """
        if not isinstance(frequency, xr.DataArray):
            values = np.asarray(frequency, float)
            dims = ["frequency"][: values.ndim]
            coords = {"frequency": ("frequency", values, {"units": "rad/s"})} if dims else None
            frequency = xr.DataArray(values, dims=dims, coords=coords)
        intensity, *filters_ = self.kernel_parameters()
        density = intensity * self._transmission(frequency, *filters_)
        density.attrs = {"units": "m^2/s^3", "long_name": "two-sided PSD of ground acceleration"}
        return density.rename("psd")

    @staticmethod
    def _transmission(frequency: xr.DataArray, *filters_: xr.DataArray) -> xr.DataArray:
        raise NotImplementedError


@dataclass(frozen=True)
class WhiteNoise(Ground):
    """White noise ground acceleration.

    Parameters
    ----------
    intensity : float or array
        Two-sided PSD ``S0`` per rad/s [m^2/s^3], positive.
    source : str
        Where the numbers come from.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, not a number or wrongly shaped.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.WhiteNoise(intensity=0.01).describe()
    'WhiteNoise(intensity=0.01)'
    """

    name: ClassVar[str] = "white noise"
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def forcing(system: EquivalentSystem, parameters: Array) -> Forcing:
        """Forcing correlations of ``system``."""
        return filters.white_noise_forcing(system, *parameters)

    @staticmethod
    def memory(system: EquivalentSystem, parameters: Array) -> tuple[Forcing, tuple[Array, ...]]:
        """Forcing of ``system``; white noise remembers nothing."""
        return WhiteNoise.forcing(system, parameters), ()

    def kernel_parameters(self) -> list[xr.DataArray]:
        """Intensity."""
        return [self.arrays()["intensity"]]

    @staticmethod
    def _transmission(frequency: xr.DataArray, *filters_: xr.DataArray) -> xr.DataArray:
        return xr.ones_like(frequency, dtype=float)


@dataclass(frozen=True)
class KanaiTajimi(Ground):
    """White noise through one soil oscillator: eqs. (11) and (12) of the paper.

    ``f = wg^2 xg + 2 xig wg xg'`` with ``xg'' + 2 xig wg xg' + wg^2 xg = n``, so that the PSD is
    ``S0 (1 + 4 xig^2 (w/wg)^2) / [(1 - (w/wg)^2)^2 + 4 xig^2 (w/wg)^2]``.

    Parameters
    ----------
    period : float or array
        Ground period ``2 pi / wg`` [s], positive.
    damping : float or array
        Bandwidth ``xig``, a damping ratio [-], positive: .05 is a lake bed, .6 firm ground.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive.
    source : str
        Where the numbers come from.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, not a number or wrongly shaped.

    Notes
    -----
    The PSD at zero frequency is ``S0``: displacements of long-period structures are too large.
    `CloughPenzien` removes it.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (11) and (12); Kanai, K. (1957), Bull. Earthquake Res. Inst.
    35; Tajimi, H. (1960), 2nd World Conference on Earthquake Engineering.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.KanaiTajimi(period=2.0, damping=0.05).describe()
    'KanaiTajimi(period=2, damping=0.05, intensity=1)'
    """

    name: ClassVar[str] = "Kanai-Tajimi"
    period: Parameter = parameter("s", "ground period", POSITIVE)
    damping: Parameter = parameter(
        "1", "ground damping ratio", Range(reason="an undamped ground has no stationary motion")
    )
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def forcing(system: EquivalentSystem, parameters: Array) -> Forcing:
        """Forcing correlations of ``system``."""
        return filters.kanai_tajimi_forcing(system, *parameters)

    @staticmethod
    def memory(system: EquivalentSystem, parameters: Array) -> tuple[Forcing, tuple[Array, ...]]:
        """Forcing of ``system``, and frequency and damping ratio of the soil."""
        return KanaiTajimi.forcing(system, parameters), tuple(parameters[1:])

    def kernel_parameters(self) -> list[xr.DataArray]:
        """Intensity, frequencies [rad/s] and damping ratios."""
        values = self.arrays()
        return [values["intensity"], 2 * np.pi / values["period"], values["damping"]]

    @staticmethod
    def _transmission(frequency: xr.DataArray, *filters_: xr.DataArray) -> xr.DataArray:
        ratio = (frequency / filters_[0]) ** 2
        spread = 4 * filters_[1] ** 2 * ratio
        return (1 + spread) / ((1 - ratio) ** 2 + spread)


@dataclass(frozen=True)
class CloughPenzien(Ground):
    """Kanai-Tajimi ground through a high-pass oscillator, which removes the zero frequency.

    Its PSD is that of `KanaiTajimi` times ``(w/wf)^4 / [(1 - (w/wf)^2)^2 + 4 xif^2 (w/wf)^2]``.

    Parameters
    ----------
    period, damping : float or array
        Soil oscillator: period ``2 pi / wg`` [s] and damping ratio ``xig`` [-], positive.
    high_pass_period, high_pass_damping : float or array
        High-pass oscillator: period ``2 pi / wf`` [s] and damping ratio ``xif`` [-], positive.
    intensity : float or array
        Two-sided PSD ``S0`` of the white noise per rad/s [m^2/s^3], positive.
    source : str
        Where the numbers come from.

    Raises
    ------
    ValueError, TypeError
        If a parameter is out of range, not a number or wrongly shaped.

    References
    ----------
    Clough, R. W. and Penzien, J. (1975), Dynamics of structures.

    Examples
    --------
    >>> import stochlin as sl
    >>> ground = sl.CloughPenzien(0.42, 0.6, high_pass_period=4.2, high_pass_damping=0.6)
    >>> float(ground.psd(0.0))
    0.0
    """

    name: ClassVar[str] = "Clough-Penzien"
    period: Parameter = parameter("s", "ground period", POSITIVE)
    damping: Parameter = parameter(
        "1", "ground damping ratio", Range(reason="an undamped ground has no stationary motion")
    )
    high_pass_period: Parameter = parameter("s", "high-pass period", POSITIVE)
    high_pass_damping: Parameter = parameter("1", "high-pass damping ratio", POSITIVE)
    intensity: Parameter = parameter("m^2/s^3", "two-sided PSD of the white noise", POSITIVE, 1.0)

    @staticmethod
    def forcing(system: EquivalentSystem, parameters: Array) -> Forcing:
        """Forcing correlations of ``system``."""
        return filters.clough_penzien_forcing(system, *parameters)

    @staticmethod
    def memory(system: EquivalentSystem, parameters: Array) -> tuple[Forcing, tuple[Array, ...]]:
        """As on the soil alone: the high-pass oscillator is slow against a half-cycle."""
        return KanaiTajimi.memory(system, parameters[:3])

    def kernel_parameters(self) -> list[xr.DataArray]:
        """Intensity, frequencies [rad/s] and damping ratios."""
        values = self.arrays()
        return [
            values["intensity"],
            2 * np.pi / values["period"],
            values["damping"],
            2 * np.pi / values["high_pass_period"],
            values["high_pass_damping"],
        ]

    @staticmethod
    def _transmission(frequency: xr.DataArray, *filters_: xr.DataArray) -> xr.DataArray:
        ratio = (frequency / filters_[2]) ** 2
        high_pass = ratio**2 / ((1 - ratio) ** 2 + 4 * filters_[3] ** 2 * ratio)
        return KanaiTajimi._transmission(frequency, *filters_[:2]) * high_pass
