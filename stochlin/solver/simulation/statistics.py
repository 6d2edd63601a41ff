"""Shares, means and quantiles of motions, with their 95 % intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import bdtrik, betaincinv

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import checked, is_number
from stochlin.models.parameters import check_alignment, check_units
from stochlin.solver.simulation.results import Column
from stochlin.solver.simulation.structures_in_motion import (
    HEIGHT,
    PATH,
    STRUCTURE,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import check_names

TAIL = (1 - 0.95) / 2  # probability on each side of a 95 % interval
# [m] in place of infinity; a quantile above its square root is interpolated to such a sample
IN_PLACE_OF_INFINITY = 1e200
ABOVE_GROUND = "height above the ground"
Columns = dict[str, Column]


@checked
def exceedance(samples: xr.DataArray, gap: float | xr.DataArray) -> xr.Dataset:
    """Probability that a peak or separation exceeds a gap, from its samples.

    Parameters
    ----------
    samples : xarray.DataArray
        Samples over ``path`` [m], such as ``separation`` of `simulate` with a duration.
    gap : float or xarray.DataArray
        Gap [m], which may have other dimensions. Gaps and samples may be infinite: a structure that
        falls moves beyond any gap.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the samples except ``path``, and those of the gap: ``probability``
        [-] with its 95 % interval ``probability_lower`` and ``probability_upper`` by Clopper and
        Pearson, which contains the true value with a probability of at least 95 %. They are NaN,
        with the status ``invalid_input``, where the gap or a sample is NaN. ``status``.

    Raises
    ------
    ValueError, TypeError
        If the samples have no dimension ``path`` or are none, the samples or the gap are not
        numbers, a single gap or a sample of a single cell is NaN, or dimensions of the same name
        differ in coordinates or length.

    References
    ----------
    Clopper, C. J. and Pearson, E. S. (1934), Biometrika 26.

    Examples
    --------
    >>> import stochlin as sl, xarray as xr
    >>> table = sl.exceedance(xr.DataArray([0.1, 0.2, 0.3, 0.4], dims="path"), gap=0.25)
    >>> float(table.probability)
    0.5
    """
    if not isinstance(samples, xr.DataArray) or samples.dtype.kind not in "iuf":
        raise TypeError(f"samples = {brief(samples)}; allowed: an xarray.DataArray of numbers")
    if PATH not in samples.dims:
        raise ValueError(
            f"samples has the dimensions {samples.dims}; allowed: one of them is '{PATH}'"
        )
    if not samples.size:
        raise ValueError("samples is empty; allowed: at least one number of metres")
    if not is_number(gap) and not (isinstance(gap, xr.DataArray) and gap.dtype.kind in "iuf"):
        raise TypeError(f"gap = {brief(gap)}; allowed: a number or an xarray.DataArray, in metres")
    gaps = xr.DataArray(gap)
    check_units("gap", gaps.attrs.get("units"), "m")
    if not gaps.ndim and np.isnan(gaps):
        raise ValueError("gap = nan; allowed: a number of metres, which may be infinite")
    check_alignment("samples and gap", samples, gaps)
    columns = "status", *(f"probability{end}" for end in ("", "_lower", "_upper"))
    check_names((*samples.dims, *samples.coords, *gaps.dims, *gaps.coords), columns)
    check_names({*gaps.coords} - {*gaps.dims}, (PATH,))
    table = pounding_shares(samples, gaps)
    complete = table.probability.notnull()
    if not complete.ndim and not complete:
        what = "nan is among the samples, or the gaps, of the only cell"
        raise ValueError(f"samples: {what}; allowed: numbers of metres, which may be infinite")
    return labels.label(table.assign(status=labels.status_where(complete)))


def pounding_shares(samples: xr.DataArray, gap: float | xr.DataArray) -> xr.Dataset:
    """``probability`` that samples over ``path`` exceed a gap [m], and its 95 % interval.

    They are NaN where the gap or a sample is NaN, which neither exceeds nor keeps a gap.
    """
    beyond = (samples > gap) | np.isposinf(samples)  # what falls exceeds any gap
    beyond = beyond.transpose(PATH, ...)
    shares = xr.Dataset(
        share_columns("probability", beyond.dims[1:], beyond.values), {**beyond.coords}
    )
    unknown = (samples.isnull() | xr.DataArray(gap).isnull()).any(PATH)
    return shares.where(~unknown) if unknown.any() else shares


def pair_separation(motions: xr.Dataset) -> xr.DataArray:
    """Peak of ``u_1 - u_2`` [m] in each motion, from a dataset of `simulate` for two structures.

    For one structure beside a property line it is the peak of ``u_1`` over all floors.
    """
    if _is_alone(motions):
        return motions.peak_positive.max(motions.peak_positive.dims[1])
    return _separation_of_pair(motions.separation)


def separation_at(motions: xr.Dataset, heights: Array) -> xr.DataArray:
    """`pair_separation` [m] over (path, height): heights of contact of two, or floors of one."""
    if _is_alone(motions):
        axis = labels.axis(HEIGHT, ABOVE_GROUND, heights, "m")
        at_floors = motions.peak_positive.values
        return xr.DataArray(at_floors, dims=(PATH, HEIGHT), coords={"height": axis.height})
    return _separation_of_pair(motions.separation_at_height).sel(height=heights)


def pair_peaks(motions: xr.Dataset) -> Array:
    """Peaks [m] of one structure at its roof, or of two at the lower roof (paths, 1 or 2)."""
    if _is_alone(motions):
        return motions.peak.values[:, -1:]
    if "peak_at_height" not in motions:
        return motions.peak.values
    return motions.peak_at_height.isel(height=-1).values


def required_gaps(motions: xr.Dataset) -> tuple[float, float, float]:
    """First quantile of `pair_separation` [m], with lower and upper end of its 95 % interval."""
    return quantile_interval(pair_separation(motions).values, motions["quantile"].values[0])


def _is_alone(motions: xr.Dataset) -> bool:
    """Whether the simulation has only one structure."""
    return motions.sizes[STRUCTURE] == 1


def _separation_of_pair(separation: xr.DataArray) -> xr.DataArray:
    return separation.isel(structure=0, structure_2=1, drop=True)


def keeping_apart(separation: xr.DataArray, gap: float | xr.DataArray) -> dict[str, xr.DataArray]:
    """Probability of no pounding for a gap [m], and its 95 % interval, as `pounding_shares`."""
    pounding = pounding_shares(separation, gap)
    return {
        "no_pounding_probability": 1 - pounding.probability,
        "no_pounding_probability_lower": 1 - pounding.probability_upper,
        "no_pounding_probability_upper": 1 - pounding.probability_lower,
    }


def share_columns(name: str, over: Sequence[Any], events: Array) -> Columns:
    """Share of the motions with an event (paths, ...), and its 95 % interval."""
    n = len(events)
    count = events.sum(axis=0)
    lower = np.nan_to_num(betaincinv(count, n - count + 1, TAIL), nan=0.0)
    upper = np.nan_to_num(betaincinv(count + 1, n - count, 1 - TAIL), nan=1.0)
    shares = zip(labels.VALUE_AND_ENDS, (count / n, lower, upper), strict=True)
    return {f"{name}{end}": (over, share) for end, share in shares}


def mean_with_error(samples: Array) -> tuple[Any, Any]:
    """Mean along the first axis, and its standard error, which is NaN for one sample."""
    several = len(samples) > 1
    with np.errstate(invalid="ignore"):  # a mean with a structure that falls is infinite
        spread = samples.std(axis=0, ddof=1) if several else np.full(samples.shape[1:], np.nan)
    return samples.mean(axis=0), spread / np.sqrt(len(samples))


def mean_columns(name: str, over: Sequence[Any], samples: Array) -> Columns:
    """Mean of a variable along the first axis, and its standard error."""
    mean, error = mean_with_error(samples)
    return {f"{name}_mean": (over, mean), f"{name}_mean_standard_error": (over, error)}


def quantiles_of(samples: Array, levels: Array) -> Array:
    """Quantiles along the first axis of samples that may be infinite."""
    quantiles = np.quantile(np.minimum(samples, IN_PLACE_OF_INFINITY), levels, axis=0)
    return np.where(quantiles > np.sqrt(IN_PLACE_OF_INFINITY), np.inf, quantiles)


def quantile_intervals(samples: Array, levels: Array) -> tuple[Array, Array, Array]:
    """Quantiles along the first axis, and their 95 % intervals from order statistics.

    They are NaN where a sample is NaN.
    """
    ordered = np.sort(samples, axis=0)  # with NaN at the end
    n = len(ordered)
    along_samples = (-1,) + (1,) * (samples.ndim - 1)
    low = np.ceil(bdtrik(TAIL, n, levels)).astype(int) - 1
    high = np.ceil(bdtrik(1 - TAIL, n, levels)).astype(int)
    estimate = quantiles_of(samples, levels)
    lower = np.where((low >= 0).reshape(along_samples), ordered[np.maximum(low, 0)], 0.0)
    upper = np.where((high < n).reshape(along_samples), ordered[np.minimum(high, n - 1)], np.inf)
    unknown = np.isnan(ordered[-1])
    return estimate, np.where(unknown, np.nan, lower), np.where(unknown, np.nan, upper)


def quantile_interval(samples: Array, level: float) -> tuple[Any, Any, Any]:
    """One quantile along the first axis, and its 95 % interval."""
    estimate, lower, upper = quantile_intervals(samples, np.array([level]))
    return estimate[0], lower[0], upper[0]


def quantile_columns(name: str, over: Sequence[Any], samples: Array, levels: Array) -> Columns:
    """Quantiles of a variable along the first axis, and the ends of their 95 % intervals."""
    intervals = zip(labels.VALUE_AND_ENDS, quantile_intervals(samples, levels), strict=True)
    return {f"{name}_quantile{end}": (("quantile", *over), values) for end, values in intervals}
