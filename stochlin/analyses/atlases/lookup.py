"""Interpolation in an atlas, linear in the logarithms of all parameters."""

from __future__ import annotations

import itertools
import json
from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin.analyses.atlases.specification import OF_STRUCTURES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, sentence
from stochlin.models.grounds import GROUNDS
from stochlin.models.parameters import CASE, Parameter

ROUNDING = 1e-9  # allowed deviation of a logarithm from the end of an axis or a fixed parameter
UNKNOWN = 2  # value of ``caution`` outside of the atlas
CORNER = "corner"
PERIODS = ("period_1", "period_2")


def lookup(atlas: xr.Dataset, ground_period: Parameter = 1.0, **parameters: Parameter) -> xr.Dataset:
    """Interpolate in an atlas.

    The interpolation is linear in the logarithms of the parameters. Near equal periods ``rho`` has a
    ridge, whose width is that of the damping ratios; an atlas with a coarser grid underestimates it.

    Parameters
    ----------
    atlas : xarray.Dataset
        The atlas, as from `open_atlas`.
    ground_period : float or array
        Ground period ``2 pi/wg`` [s], by which the periods are divided. Without it the periods are
        already relative to the ground period.
    **parameters : float or array
        Values of all axes of the atlas by their names: ``period_1``, ``period_2``, ``damping`` and
        others. Arrays broadcast by dimension name; 1-D arrays share the dimension ``case``. Parameters
        that are fixed in the atlas may be given with their value. ``damping`` stands for both
        ``damping_1`` and ``damping_2``, and likewise ``hardening`` and ``reduction_factor``.

    Returns
    -------
    xarray.Dataset
        The variables of the atlas over the dimensions of the parameters. Cells outside of the atlas, or
        next to a failed cell of the atlas, are NaN. Their ``status`` is ``invalid_input`` or the worst
        of the surrounding cells; ``caution`` is also the worst of these.

    Raises
    ------
    ValueError, TypeError
        If a parameter is missing or unknown, differs from the fixed value in the atlas, or is not a
        number; or if a chunk of the atlas is damaged (the message names it).

    Examples
    --------
    >>> import tempfile, stochlin as sl
    >>> sweep = {"start": 0.5, "stop": 2.0, "count": 101, "spacing": "log"}
    >>> spec = {"ground": "white_noise"}
    >>> spec["parameters"] = {"period_1": sweep, "period_2": sweep, "damping": 0.05}
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     atlas = sl.write_atlas(spec, f"{folder}/atlas.zarr").load()
    >>> near = sl.lookup(atlas, period_1=0.9, period_2=1.0).rho
    >>> bool(abs(near - sl.rho_white_noise(0.9, 1.0, 0.05, 0.05).rho) < 0.002)
    True
    """
    points = _points(atlas, parameters, ground_period)
    corners = {name: _corners(np.log(atlas[name].values), point) for name, point in points.items()}
    result = xr.Dataset()
    for name, variable in atlas.data_vars.items():
        result[name] = _interpolate(variable, [corners[str(dim)] for dim in variable.dims])
    outside = xr.zeros_like(result.rho, bool)
    for _, share in corners.values():
        outside = outside | share.isnull()
    if bool((result.rho.isnull() & (result.status <= labels.ELASTIC_LIMIT) & ~outside).any()):
        raise ValueError(
            "rho is missing where status says that it was found: chunks of this atlas are gone; "
            "write it anew"
        )
    result["status"] = result.status.where(~outside, labels.INVALID_INPUT)
    result["caution"] = result.caution.where(~outside, UNKNOWN)
    for name in result.data_vars:
        kept = atlas[name].dtype
        result[name] = result[name].astype(kept).assign_attrs(atlas[name].attrs)
    return result.assign_attrs(atlas.attrs)


def _points(
    atlas: xr.Dataset, parameters: Mapping[str, Parameter], ground_period: Parameter
) -> dict[str, xr.DataArray]:
    """Logarithms of the coordinates along each axis of the atlas, broadcast against each other."""
    specification = json.loads(atlas.attrs["specification"])
    held = {name: v for name, v in specification["parameters"].items() if isinstance(v, float)}
    soil = GROUNDS.named(specification["ground"], "ground")
    times = {name for name, own in soil.beside_structures().items() if soil.units(own) == "s"}
    axes = [str(dim) for dim in atlas.rho.dims]
    place = {name: _array(name, value) for name, value in _numbered(parameters, {*axes, *held}).items()}
    unknown = [name for name in place if name not in (*axes, *held)]
    missing = [name for name in axes if name not in place]
    if unknown or missing:
        what = f"{', '.join(unknown)} unknown" if unknown else f"{', '.join(missing)} missing"
        raise ValueError(f"{what}; this atlas needs {', '.join(axes)} and holds {held}")
    unit = _array("ground_period", ground_period)
    logs: dict[str, xr.DataArray] = {}
    with np.errstate(invalid="ignore", divide="ignore"):  # values <= 0 are outside of the atlas
        for name, value in place.items():
            logs[name] = np.log(value / unit if name in times.union(PERIODS) else value)  # type: ignore[assignment]
    for name, number in held.items():
        if name in logs and bool((np.abs(logs[name] - np.log(number)) > ROUNDING).any()):
            raise ValueError(f"{name} is held at {number:g} in this atlas; allowed: this value")
    try:
        points = xr.broadcast(*(logs[name] for name in axes))
    except xr.AlignmentError as error:
        raise ValueError(f"parameters share a dimension, not its length: {sentence(error)}") from error
    return dict(zip(axes, points, strict=True))


def _numbered(parameters: Mapping[str, Parameter], known: set[str]) -> dict[str, Parameter]:
    """The parameters, with ``damping`` as ``damping_1`` and ``damping_2`` if the atlas has these."""
    named: dict[str, Parameter] = {}
    for name, value in parameters.items():
        pair = [f"{name}_{n}" for n in (1, 2)]
        if name in OF_STRUCTURES and name not in known and known & set(pair):
            named |= dict.fromkeys(pair, value)
        else:
            named[name] = value
    return named


def _array(name: str, value: Parameter) -> xr.DataArray:
    if isinstance(value, xr.DataArray):
        array = value
    else:
        numbers = np.asarray(value)
        if numbers.ndim > 1:
            raise ValueError(f"{name} has {numbers.ndim} dimensions; allowed: a number or a 1-D array")
        array = xr.DataArray(numbers, dims=[CASE][: numbers.ndim])
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {brief(value)} is not a real number")
    return array.astype(float)


def _corners(axis: Array, point: xr.DataArray) -> tuple[xr.DataArray, xr.DataArray]:
    """Index of the axis value below each point, and weight of the one above; NaN outside."""
    x = point.values
    inside = (x >= axis[0] - ROUNDING) & (x <= axis[-1] + ROUNDING)
    low = np.clip(np.searchsorted(axis, x, side="right") - 1, 0, max(axis.size - 2, 0))
    high = np.minimum(low + 1, axis.size - 1)
    width = np.where(high > low, axis[high] - axis[low], 1.0)
    share = np.where(inside, np.clip((x - axis[low]) / width, 0, 1), np.nan)
    return point.copy(data=low), point.copy(data=share)


def _interpolate(
    variable: xr.DataArray, corners: list[tuple[xr.DataArray, xr.DataArray]]
) -> xr.DataArray:
    """Weighted mean over the surrounding cells; for flags, the largest value with a weight above 0."""
    dims, flags = [str(dim) for dim in variable.dims], variable.dtype.kind == "i"
    # One request for all surrounding cells, so that each chunk on disk is read only once.
    steps = np.array(list(itertools.product((0, 1), repeat=len(dims))), int).reshape(
        2 ** len(dims), len(dims)
    )
    where, weight = {}, xr.DataArray(np.ones(len(steps)), dims=CORNER)
    for n, (dim, (low, share)) in enumerate(zip(dims, corners, strict=True)):
        up = xr.DataArray(steps[:, n], dims=CORNER)
        where[dim] = (low + up).clip(max=variable.sizes[dim] - 1)
        weight = weight * xr.where(up == 1, share, 1 - share)  # type: ignore[no-untyped-call]
    plain = variable.drop_vars(dims, errors="ignore").variable
    values = xr.DataArray(plain[{dim: where[dim].variable for dim in dims}].load())
    if flags:
        return values.where(weight > 0, 0).max(CORNER)
    terms = (values * weight).where(weight != 0, 0.0)  # outside, the weight is NaN
    return terms.sum(CORNER, skipna=False)
