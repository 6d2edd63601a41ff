"""Elastic spectra of building codes: pseudo-acceleration over period."""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.applications.sites.elastic_spectra import BY_CODE, marked
from stochlin.applications.sites.spectra import labelled
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import ImplausibleInput, brief
from stochlin.models.arguments import Acceleration, DampingOrZero, Seconds, checked, is_number
from stochlin.models.plausible import PLAUSIBLE

PERIOD_STEP = 0.01  # step between the periods of a spectrum [s]
LEAST_ORDINATE = 0.2  # lower bound of the design spectrum of Eurocode 8, beta, over ag
_EC8_LONGEST = 4.0  # [s]
_ASCE_LONGEST = 10.0  # [s]


class _Shape(NamedTuple):
    """Factor ``S`` and corner periods ``TB``, ``TC``, ``TD`` [s] of a design spectrum."""

    factor: float
    rise: float
    plateau: float
    long: float

    def shape(self, period: Array | float, start: float, top: float) -> Array:
        """From ``start`` at 0 up to ``top`` on the plateau, then as 1/T, and at last as 1/T^2."""
        after = np.maximum(period, self.plateau)
        falling = top * self.plateau / after * np.minimum(1, self.long / after)
        return np.where(period < self.rise, start + period / self.rise * (top - start), falling)


# EN 1998-1:2004, tables 3.2 and 3.3.
_EUROCODE = {
    1: {
        "A": _Shape(1.0, 0.15, 0.4, 2.0),
        "B": _Shape(1.2, 0.15, 0.5, 2.0),
        "C": _Shape(1.15, 0.2, 0.6, 2.0),
        "D": _Shape(1.35, 0.2, 0.8, 2.0),
        "E": _Shape(1.4, 0.15, 0.5, 2.0),
    },
    2: {
        "A": _Shape(1.0, 0.05, 0.25, 1.2),
        "B": _Shape(1.35, 0.05, 0.25, 1.2),
        "C": _Shape(1.5, 0.1, 0.25, 1.2),
        "D": _Shape(1.8, 0.1, 0.3, 1.2),
        "E": _Shape(1.6, 0.05, 0.25, 1.2),
    },
}


@checked
def eurocode_8(
    ag: Acceleration, soil: str, type: int = 1, damping: DampingOrZero = 0.05
) -> xr.DataArray:
    """Horizontal elastic response spectrum of Eurocode 8.

    It is that of EN 1998-1:2004, eqs. (3.2) to (3.6), with the recommended values of tables 3.2 and
    3.3. A national annex may have other values; use `read_spectrum` for these.

    Parameters
    ----------
    ag : float
        Design ground acceleration on ground type A, including the importance factor [m/s^2],
        positive.
    soil : str
        Ground type, ``"A"`` to ``"E"``.
    type : {1, 2}
        Type of the spectrum: 1 if earthquakes with a surface-wave magnitude above 5.5 govern, else
        2.
    damping : float
        Damping ratio ``xi`` [-], from 0 to 1. It enters by the factor
        ``eta = sqrt(10/(5 + 100 xi)) >= 0.55``.

    Returns
    -------
    xarray.DataArray
        Pseudo-acceleration [m/s^2] over ``period`` [s], from 0 (the peak ground acceleration) to 4
        s. The attributes are ``damping``, ``source``, ``elastic`` and the arguments of this
        function.

    Raises
    ------
    ValueError, TypeError
        If a value is out of range or the ground type is unknown.

    Warns
    -----
    UserWarning
        If ``ag`` is below 0.05 g, for which the code need not be applied, or above 1.5 g, so that
        it is probably not in m/s^2.

    References
    ----------
    EN 1998-1:2004, Eurocode 8: Design of structures for earthquake resistance, 3.2.2.2.

    Examples
    --------
    >>> import stochlin as sl
    >>> spectrum = sl.eurocode_8(0.25 * 9.80665, "C")
    >>> spectrum.sel(period=[0.0, 0.4, 1.0], method="nearest").values.round(3).tolist()
    [2.819, 7.049, 4.229]
    """
    if not is_number(type) or type not in _EUROCODE:
        raise ValueError(f"type = {brief(type)} is unknown; allowed: 1, 2")
    soils = _EUROCODE[int(type)]
    name = soil.strip().upper() if isinstance(soil, str) else ""
    if name not in soils:
        raise ValueError(f"soil = {brief(soil)} is no ground type; allowed: {', '.join(soils)}")
    eta = max(np.sqrt(10 / (5 + 100 * damping)), 0.55)
    period = PERIOD_STEP * np.arange(round(_EC8_LONGEST / PERIOD_STEP) + 1)
    values = ag * soils[name].factor * soils[name].shape(period, 1.0, 2.5 * eta)
    source = f"Eurocode 8, type {int(type)}, ground {name}, ag = {ag / constants.g:.4g} g"
    curve = marked(labelled(period, values, damping, source), BY_CODE)
    return curve.assign_attrs(
        code="eurocode_8", ag=float(ag), soil=name, spectrum_type=f"{int(type)}"
    )


def reduced_eurocode_8(elastic: xr.DataArray, period: float, behaviour: float) -> float:
    """Design spectrum of Eurocode 8 at a period [m/s^2], EN 1998-1:2004, eqs. (3.13) to (3.16).

    ``elastic`` is the spectrum by `eurocode_8`, and ``behaviour`` the factor ``q``, which includes
    the damping. The lower bound ``beta ag`` has the recommended ``beta = 0.2``.
    """
    soil = _EUROCODE[int(elastic.attrs["spectrum_type"])][elastic.attrs["soil"]]
    shape = float(soil.shape(period, 2 / 3, 2.5 / behaviour))
    least = 0.0 if period < soil.rise else LEAST_ORDINATE / soil.factor
    return float(elastic[0]) * max(shape, least)  # which is ag S at 0


@checked
def asce_7(sds: Acceleration, sd1: Acceleration, tl: Seconds) -> xr.DataArray:
    """Design response spectrum of ASCE 7, for the damping ratio 0.05.

    It is that of ASCE 7-16, 11.4.6: ``SDS (0.4 + 0.6 T/T0)`` below ``T0 = 0.2 TS``, ``SDS`` up to
    ``TS = SD1/SDS``, ``SD1/T`` up to ``TL``, and ``SD1 TL/T^2`` beyond.

    Parameters
    ----------
    sds, sd1 : float
        Design spectral accelerations at short periods and at 1 s [m/s^2], positive. Values in g, as
        in maps, are multiplied by 9.80665.
    tl : float
        Long-period transition [s], positive.

    Returns
    -------
    xarray.DataArray
        Pseudo-acceleration [m/s^2] over ``period`` [s], from 0 (the peak ground acceleration) to 10
        s. The attributes are ``damping``, ``source``, ``elastic`` and the arguments of this
        function.

    Raises
    ------
    ValueError, TypeError
        If a value is out of range, or ``TS`` is not less than ``tl``.

    Warns
    -----
    UserWarning
        If ``sds`` is below 0.167 g, for which the code asks for no spectrum, or above 3.75 g, so
        that it is probably not in m/s^2, or if ``sd1`` is more than 1.25 times ``sds``.

    References
    ----------
    ASCE/SEI 7-16 (2016), Minimum design loads and associated criteria, 11.4.6.

    Examples
    --------
    >>> import stochlin as sl
    >>> spectrum = sl.asce_7(sds=1.0 * 9.80665, sd1=0.6 * 9.80665, tl=8.0)
    >>> in_g = spectrum.sel(period=[0.0, 0.3, 2.0], method="nearest") / 9.80665
    >>> in_g.values.round(3).tolist()
    [0.4, 1.0, 0.3]
    """
    corner = sd1 / sds
    if corner >= tl:
        raise ValueError(f"tl = {tl:g} s; allowed: longer than TS = sd1/sds = {corner:.4g} s")
    if text := PLAUSIBLE["sd1 over sds"].doubt(corner):
        warnings.warn(
            f"asce_7: sd1 is {corner:.3g} times sds; {text}", ImplausibleInput, stacklevel=3
        )
    grid = PERIOD_STEP * np.arange(round(_ASCE_LONGEST / PERIOD_STEP) + 1)
    corners = [t for t in (0.2 * corner, corner, tl) if t < _ASCE_LONGEST]
    near = np.abs(grid[:, None] - corners).min(axis=1) < 1e-6
    period = np.union1d(grid[~near], corners)
    shape = _Shape(1.0, 0.2 * corner, corner, tl).shape(period, 0.4, 1.0)
    short = sds / constants.g
    long = sd1 / constants.g
    source = f"ASCE 7, SDS = {short:.4g} g, SD1 = {long:.4g} g, TL = {tl:g} s"
    curve = marked(labelled(period, sds * shape, 0.05, source), BY_CODE)
    return curve.assign_attrs(code="asce_7", sds=float(sds), sd1=float(sd1), tl=float(tl))
