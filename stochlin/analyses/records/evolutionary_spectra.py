"""Evolutionary power spectral density of a modulated ground."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.models.arguments import as_numbers, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Parameter


@checked
def evolutionary_psd(
    ground: Ground, envelope: Envelope, frequency: Parameter, time: Parameter
) -> xr.DataArray:
    """Evolutionary PSD of a uniformly modulated ground, ``m(t)^2 S(w)``.

    Parameters
    ----------
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        Stationary ground with the PSD ``S``.
    envelope : AminAng, ShinozukaSato, GammaEnvelope or HsuBernard
        Envelope ``m`` of the motion, the same for all frequencies.
    frequency : float or array
        Circular frequency [rad/s]; a plain 1-D array gets the dimension ``frequency``.
    time : float or array
        Time [s], from 0 on; a plain 1-D array gets the dimension ``time``.

    Returns
    -------
    xarray.DataArray
        Two-sided PSD per rad/s [m^2/s^3] over ``time``, ``frequency`` and the dimensions of the ground.

    Raises
    ------
    ValueError, TypeError
        If a time is negative or not finite, or the ground or the envelope is of another kind.

    References
    ----------
    Priestley, M. B. (1965), J. R. Stat. Soc. B 27.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> firm = sl.named_ground("firm", intensity=0.01)
    >>> time, frequency = np.linspace(0, 20, 41), np.linspace(1, 40, 79)
    >>> psd = sl.evolutionary_psd(firm, sl.HsuBernard(5.0), frequency, time)
    >>> float(psd.time[int(psd.isel(frequency=0).argmax("time"))])
    5.0
    """
    if not isinstance(time, xr.DataArray):
        values = as_numbers("time", time, "seconds, a number or a 1-D array").astype(float)
        if values.ndim > 1:
            raise ValueError("time is an array of several dimensions; allowed: a number or a 1-D array")
        time = labels.axis("time", "time", values, "s") if values.ndim else xr.DataArray(values)
    elif time.dtype.kind not in "iuf":
        raise TypeError(f"time is of {time.dtype}; allowed: numbers of seconds")
    rates = as_numbers("frequency", frequency, "rad/s, a number or a 1-D array")
    if rates.ndim > 1 and not isinstance(frequency, xr.DataArray):
        raise ValueError("frequency is an array of several dimensions; allowed: a number or a 1-D array")
    wrong = time.to_numpy()[~((time.to_numpy() >= 0) & np.isfinite(time.to_numpy()))]
    if wrong.size:
        raise ValueError(f"time = {wrong[0]:g} is out of range; allowed: 0 <= time, finite, in seconds")
    strength = time.copy(data=envelope.at(time.to_numpy().astype(float))) ** 2
    density = strength * ground.psd(frequency)
    density.attrs = {
        "units": "m^2/s^3",
        "long_name": "two-sided evolutionary PSD of ground acceleration",
        "ground": ground.describe(),
        "envelope": envelope.describe(),
    }
    return density.rename("psd")
