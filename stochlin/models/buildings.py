"""Shear buildings: floors on storeys that may yield."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.parameters import POSITIVE, Model, Parameter, parameter
from stochlin.models.structures import DAMPING, HARDENING

STOREY, MODE = "storey", "mode"


@dataclass(frozen=True)
class ShearBuilding(Model):
    """Shear building: a mass on each floor, a bilinear spring in each storey, damping by modes.

    Storeys are counted from the ground up, and each bears the number of the floor above it. Every mode
    of the elastic building has the same damping ratio ``xi``: ``C = sum_m 2 xi w_m M phi_m phi_m' M``,
    with modes of unit modal mass. It stays as it is where storeys yield.

    Parameters
    ----------
    masses : array
        Of the floors [kg], positive; one number a storey.
    stiffnesses : array
        Elastic stiffness of the storeys [N/m], positive.
    heights : array
        Of the storeys [m], positive: the floors are where these add up to.
    damping : float
        Viscous damping ratio of every mode [-], in (0, 1).
    hardening : float, optional
        Post-yield over elastic stiffness of every storey [-], in (0, 1]; needed with ``yield_drifts``.
    yield_drifts : float or array, optional
        Drift [m] at which a storey yields, positive: for every storey, or each its own. Without it the
        building stays elastic.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range (the message names the storey), arrays differ in
        length, or yield drifts come without hardening.

    References
    ----------
    Chopra, A. K. (2012), Dynamics of Structures, 4th ed., sections 9.1 and 11.4.

    Examples
    --------
    >>> import stochlin as sl
    >>> tower = sl.ShearBuilding([2e5] * 3, [4e8] * 3, [3.5] * 3, damping=0.05)
    >>> tower.periods().round(3).values
    array([0.316, 0.113, 0.078])
    >>> tower.levels().tolist()
    [3.5, 7.0, 10.5]
    """

    masses: Parameter = parameter("kg", "mass of the floor", POSITIVE)
    stiffnesses: Parameter = parameter("N/m", "stiffness of the storey", POSITIVE)
    heights: Parameter = parameter("m", "height of the storey", POSITIVE)
    damping: Parameter = parameter("1", "damping ratio of every mode", DAMPING)
    hardening: Parameter | None = parameter("1", "hardening ratio", HARDENING, None)
    yield_drifts: Parameter | None = parameter("m", "drift at yield", POSITIVE, None)

    def __post_init__(self) -> None:
        name = type(self).__name__
        for field in ("masses", "stiffnesses", "heights", "yield_drifts"):
            value = getattr(self, field)
            if value is not None and (field != "yield_drifts" or not np.isscalar(value)):
                object.__setattr__(self, field, _over_storeys(f"{name}: {field}", value))
        given = {key: getattr(self, key) for key in ("masses", "stiffnesses", "heights", "yield_drifts")}
        arrays = {key: value for key, value in given.items() if isinstance(value, xr.DataArray)}
        if len({array.sizes[STOREY] for array in arrays.values()}) > 1:
            told = ", ".join(f"{key} has {array.sizes[STOREY]}" for key, array in arrays.items())
            raise ValueError(f"{name}: {told} values; allowed: one for each storey in all of them")
        super().__post_init__()
        for field in ("damping", "hardening"):
            if isinstance(getattr(self, field), xr.DataArray):
                raise ValueError(f"{name}: {field} is an array; allowed: one number for the building")
        for key, value in self.arrays().items():
            allowed = self.allowed(key)
            bad = np.flatnonzero(~np.atleast_1d(allowed.contains(value.to_numpy())))
            if bad.size:
                raise ValueError(
                    f"{name}: {key} = {float(value[bad[0]]):g} in storey {bad[0] + 1} is out of range; "
                    f"allowed: {allowed}"
                )
        if self.yield_drifts is not None and self.hardening is None:
            raise ValueError(
                f"{name}: hardening is not given; storeys with a yield drift need their hardening "
                f"ratio, allowed: {HARDENING}"
            )

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return self.arrays()["masses"].sizes[STOREY]

    def levels(self) -> Array:
        """Heights of the floors above the ground (storeys,) [m]."""
        return np.cumsum(self.arrays()["heights"].to_numpy())

    def periods(self) -> xr.DataArray:
        """Periods of the elastic building [s] over ``mode``, counted from 1: the longest first."""
        w, _ = self._modes()
        modes = np.arange(1, w.size + 1)
        attrs = {"units": "s", "long_name": "period of the mode"}
        return xr.DataArray(2 * np.pi / w, dims=MODE, coords={MODE: modes}, attrs=attrs)

    def damping_matrix(self) -> Array:
        """Damping coefficients (storeys, storeys) [N s/m] of the floors."""
        w, shapes = self._modes()
        modal = self.arrays()["masses"].to_numpy()[:, None] * shapes
        return (modal * (2 * float(self.arrays()["damping"]) * w)) @ modal.T

    def _modes(self) -> tuple[Array, Array]:
        """Circular frequencies and mode shapes of unit modal mass, one a column."""
        root = np.sqrt(self.arrays()["masses"].to_numpy())
        k = self.arrays()["stiffnesses"].to_numpy()
        diagonal = (k + np.append(k[1:], 0.0)) / root**2
        squares, vectors = scipy.linalg.eigh_tridiagonal(diagonal, -k[1:] / (root[:-1] * root[1:]))
        return np.sqrt(squares), vectors / root[:, None]


def _over_storeys(label: str, value: Any) -> xr.DataArray:
    try:
        array = np.asarray(value)
    except (ValueError, TypeError):  # ragged lists; a dataset
        array = np.empty(())
    if array.ndim != 1 or not array.size:
        raise ValueError(
            f"{label} = {brief(value)}; allowed: a list or 1-D array with one number for each storey"
        )
    return xr.DataArray(array, dims=STOREY)
