"""Fit of an envelope to the cumulative energy of a record over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import product
from typing import Literal, NamedTuple

import numpy as np
import xarray as xr
from scipy import integrate

from stochlin.applications.records.ground_fit import best_fit
from stochlin.applications.records.records import checked_record
from stochlin.kernels.basics.arrays import Array
from stochlin.models.arguments import checked
from stochlin.models.envelopes import AminAng, Envelope, GammaEnvelope, ShinozukaSato

COMPARED_TIMES = 400  # number of times at which cumulative energies are compared
# smallest value of an unknown; for a time, relative to the length of the record
LEAST_UNKNOWN = 1e-3
LARGEST_UNKNOWN = 20.0  # largest value of an unknown, likewise


class _Unknown(NamedTuple):
    """A positive unknown of the fit, and its starting values."""

    is_time: bool  # a time, relative to the length of the record
    starts: tuple[float, ...]


# For each model, a function that makes the envelope from the unknowns, and the unknowns.
FittedEnvelope = Literal["amin_ang", "shinozuka_sato", "gamma"]
FITTED_ENVELOPES: Mapping[FittedEnvelope, tuple[Callable[..., Envelope], tuple[_Unknown, ...]]] = {
    "amin_ang": (
        lambda rise, strong, decay: AminAng(rise, rise + strong, 1 / decay),
        (_Unknown(True, (0.05, 0.3)), _Unknown(True, (0.1, 0.4)), _Unknown(True, (0.05, 0.3))),
    ),
    "shinozuka_sato": (
        lambda long, share: ShinozukaSato(1 / long, (1 + share) / long),
        (_Unknown(True, (0.1, 0.5)), _Unknown(False, (0.5, 5.0))),
    ),
    "gamma": (
        lambda power, time: GammaEnvelope(power, power / time),
        (_Unknown(False, (1.0, 4.0)), _Unknown(True, (0.1, 0.3))),
    ),
}


@checked
def fit_envelope(record: xr.DataArray, model: FittedEnvelope = "amin_ang") -> Envelope:
    """Envelope fitted to the cumulative energy of a record.

    The fit is by least squares on the cumulative ``Int m^2 dt`` of the envelope ``m`` over its
    total, compared with ``Int a^2 dt`` of the record (Husid plot). It is therefore not governed by
    single peaks.

    Parameters
    ----------
    record : xarray.DataArray
        Ground acceleration [m/s^2] over ``time`` [s], as from `read_record`. The time of the
        envelope is counted from the first sample.
    model : str
        ``"amin_ang"``, ``"shinozuka_sato"`` or ``"gamma"``.

    Returns
    -------
    AminAng, ShinozukaSato or GammaEnvelope
        The fitted envelope.

    Raises
    ------
    ValueError, TypeError
        If the record is not valid or the model is unknown.
    ArithmeticError
        If no fit is found.

    References
    ----------
    Husid, R. (1969), Rev. IDIEM 8; Saragoni and Hart (1974), Earthquake Eng. Struct. Dyn. 2.

    Examples
    --------
    >>> import numpy as np, stochlin as sl, xarray as xr
    >>> time = 0.01 * np.arange(4000)
    >>> shape = sl.GammaEnvelope(2.0, 0.4).at(time) * np.sin(30 * time)
    >>> record = xr.DataArray(shape, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
    >>> round(sl.fit_envelope(record, "gamma").power, 1)
    2.0
    """
    values, dt = checked_record(record)
    make, unknowns = FITTED_ENVELOPES[model]
    time = dt * np.arange(values.size)
    chosen = np.unique(np.linspace(0, values.size - 1, COMPARED_TIMES).astype(int))
    target = _build_up(values, dt)[chosen]
    unit = np.array([time[-1] if unknown.is_time else 1.0 for unknown in unknowns])
    bounds = np.log(LEAST_UNKNOWN), np.log(LARGEST_UNKNOWN)

    def residual(logs: Array) -> Array:
        envelope = make(*np.exp(logs) * unit)
        return _build_up(envelope.at(time), dt)[chosen] - target

    starts = product(*(np.log(unknown.starts) for unknown in unknowns))
    fit = best_fit(residual, map(np.array, starts), bounds)
    if not fit.success:
        raise ArithmeticError(f"no {model} fits the energy of the record; give another model")
    return make(*np.exp(fit.x) * unit)


def _build_up(values: Array, dt: float) -> Array:
    """Cumulative energy over its total [-], by the trapezoidal rule."""
    energy: Array = integrate.cumulative_trapezoid(values**2, dx=dt, initial=0.0)
    return energy / energy[-1]
