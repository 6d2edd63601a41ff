"""Peak displacements and peak relative displacements in simulated motions of finite duration."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import bdtrik, betaincinv

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores
from stochlin.kernels.simulation.ensemble import Crowd, Extremes, Links, finite_extremes
from stochlin.kernels.simulation.stepping import LANES, whole_groups
from stochlin.messages import brief
from stochlin.models.arguments import checked, is_number
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.systems import AnyStructure, Arrangement, Tie
from stochlin.solver.simulation.ensembles import SimulationRun, seconds_of
from stochlin.solver.simulation.structures_in_motion import STRUCTURE, StructuresInMotion
from stochlin.solver.simulation.views import (
    Pair,
    Terms,
    apart,
    at_heights,
    drifts_of,
    pairs_of,
    view_of,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.floors import ELEMENT, LINK, element_coordinates, link_coordinates
from stochlin.solver.tables.work import check_work

TAIL = (1 - 0.95) / 2  # probability on each side of a 95 % interval
FAR = 1e200  # [m], in place of infinity, between which and a number no quantile can be
PRECISION, MARGIN = 0.1, 1.2  # half of an interval over a gap, and motions over those that it needs
BLOCK = 256  # time steps that are computed at once
HEIGHT = "height above the ground"
LINK_PEAKS = "peak_link_force", "peak_link_stroke", "link_energy"
RUNS_AWAY = (
    "the rates of its law grow without end: give a law in which z and all other states stay bounded, "
    "such as v - abs(v)*z, or weaker motions"
)
Column = tuple[Sequence[str], Array]  # dimensions, and values over them
Columns = dict[str, Column]
ENVELOPES, RESULTS = 6, 6  # numbers that are in memory at once for each step, and for each peak


def check_motion(
    duration: float | None,
    envelope: Envelope | None,
    scatter: float,
    structures: Mapping[str, AnyStructure],
) -> None:
    """Raise if the duration does not go with the other arguments, or a structure has a longer period."""
    if duration is None:
        if envelope is not None:
            raise ValueError("envelope is given without a duration; allowed: both, or neither")
        if scatter:
            raise ValueError(
                f"scatter = {scatter:g} is given without a duration; it scales each motion by a random "
                "factor, and a stationary response is that of one intensity: give a duration"
            )
        return
    check_duration(duration, structures)


def check_finite(run: SimulationRun, duration: float, functions: int, times: int = 1) -> None:
    """Raise a ValueError if simulations of finite motions would take too much memory or time.

    ``functions`` is the number of quantities with a peak, ``times`` the number of simulations.
    """
    steps, paths = duration / run.plan.dt, run.plan.groups * LANES
    check_work(
        f"duration = {duration:g} s, in steps of {run.plan.dt:.2g} s and on {paths} paths, would take",
        "shorten it, lower paths, or leave out the shortest period",
        numbers=ENVELOPES * steps + RESULTS * 2.0 * paths * functions,
        seconds=seconds_of(run, times * steps, 2.0 * functions),
        cores=cores(),
    )


def check_response(system: Arrangement, finite: Array) -> None:
    """Raise an ArithmeticError if a floor (motions, floors) has a response that is not ``finite``."""
    lost = ~np.logical_and.reduceat(finite, system.first[:-1], axis=1)
    if lost.any():
        worst = int(np.argmax(lost.sum(axis=0)))
        raise ArithmeticError(
            f"structures, number {worst + 1}: its response is no longer finite; {RUNS_AWAY}"
        )


def finite_steps(run: SimulationRun, duration: float, envelope: Envelope | None) -> tuple[Crowd, Array]:
    """The crowd for finite motions, sampled at each step, and the envelope amid the steps."""
    dt = run.plan.dt
    middle = dt * (np.arange(int(np.ceil(duration / dt))) + 0.5)
    return run.with_plan(every=1, samples=BLOCK).crowd, envelope_at(envelope, middle)


def simulate_finite(
    moving: StructuresInMotion,
    run: SimulationRun,
    duration: float,
    envelope: Envelope | None,
    quantiles: Sequence[float],
    progress: Progress | None,
) -> xr.Dataset:
    """Dataset of `simulate` for motions of finite duration, without labels."""
    levels = np.asarray(quantiles, float)
    check_finite(run, duration, moving.functions)
    system, pairs, n = moving.system, pairs_of(moving.system), len(moving.system.floors)
    storeys = drifts_of(system) if moving.has_storeys else []
    places = at_heights(system) if moving.has_storeys else []
    functions = [
        *({floor: 1.0} for floor in range(n)),
        *storeys,
        *(terms for *_, terms in places),
        *(apart(system, pair) for pair in pairs),
    ]
    extremes = _extremes(run, functions, duration, envelope, progress, system.ties)
    highest, lowest = extremes.highest, extremes.lowest
    drifts = np.arange(n, n + len(storeys)) if storeys else np.arange(n)
    fallen = system.fallen(np.maximum(highest, -lowest)[:, drifts], moving.limits)
    if fallen.any():  # a structure that has fallen has moved beyond any gap
        owners = [[owner] for owner in system.owners]
        members = [*owners[:n], *owners[: len(storeys)], *([number] for number, *_ in places)]
        members += [[pair.first, pair.second] for pair in pairs]
        lost = np.stack([fallen[:, numbers].any(axis=1) for numbers in members], axis=1)
        highest, lowest = np.where(lost, np.inf, highest), np.where(lost, -np.inf, lowest)
    check_response(system, ~np.isnan(highest[:, :n]))
    either = np.maximum(highest, -lowest)
    samples: Columns = {
        "peak_positive": (("path", moving.floor), highest[:, :n]),
        "peak_negative": (("path", moving.floor), -lowest[:, :n]),
        "peak": (("path", moving.floor), either[:, :n]),
    }
    coords = {k: v for k, v in moving.floor_coords().items() if not k.endswith("_2")}
    if storeys:
        coords |= element_coordinates(system)
        samples["peak_drift"] = ("path", ELEMENT), either[:, n : n + len(storeys)]
    differences = slice(len(functions) - len(pairs), None)
    heights = np.unique([pair.height for pair in pairs if not np.isnan(pair.height)])
    samples |= _separations(system, pairs, heights, highest[:, differences], lowest[:, differences])
    names = [f"{number}" for number in range(1, len(system.stacks) + 1)]
    coords |= {STRUCTURE: names, f"{STRUCTURE}_2": names}
    if places:
        peaks = either[:, n + len(storeys) : len(functions) - len(pairs)]
        samples["peak_at_height"] = _at_heights(system, places, heights, peaks)
        coords["height"] = labels.axis("height", HEIGHT, heights, "m").height
    if system.ties:
        coords |= link_coordinates([tie.number for tie in system.ties])
        of_links = extremes.force, extremes.stroke, extremes.energy
        for name, each in zip(LINK_PEAKS, of_links, strict=True):
            samples[name] = ("path", LINK), np.where(fallen.any(axis=1, keepdims=True), np.inf, each)
    means = _means(samples)
    if storeys:
        means["ductility"] = [ELEMENT], means["peak_drift_mean"][1] / moving.strength
    (_, *over), apart_most = samples["separation"]
    quantile = quantile_columns("separation", over, apart_most, levels)
    if np.isfinite(moving.limits).any():
        means |= _collapses(fallen)
    coords["quantile"] = "quantile", levels, {"units": "1", "long_name": "quantile"}
    # Made at once, because each addition to a dataset takes a millisecond.
    return xr.Dataset(samples | means | quantile, coords, finite_attributes(run, duration, envelope))


def _means(samples: Columns) -> Columns:
    """Means over the motions, and their standard errors."""
    means: Columns = {}
    for name in ("peak", "peak_positive", "peak_drift", "separation", *LINK_PEAKS):
        if name in samples:
            (_, *over), values = samples[name]
            means |= mean_columns(name, over, values)
    return means


def _collapses(fallen: Array) -> Columns:
    """Probability that each structure falls, and its 95 % interval; by ``fallen`` (paths, s)."""
    count = fallen.sum(axis=0)
    ends = count / len(fallen), *share_interval(count, len(fallen))
    shares = zip(labels.VALUE_AND_ENDS, ends, strict=True)
    return {f"collapse_probability{end}": ((STRUCTURE,), share) for end, share in shares}


def finite_attributes(
    run: SimulationRun, duration: float, envelope: Envelope | None
) -> dict[str, float | int | str]:
    """Attributes of a dataset that describe its simulation of finite motions."""
    return {
        "paths": run.plan.groups * LANES,
        "seed": run.plan.seed,
        "step_s": run.plan.dt,
        "duration_s": float(duration),
        "envelope": "none" if envelope is None else envelope.describe(),
        **labels.of_scatter(run.plan.scatter),
    }


def largest_displacements(
    run: SimulationRun, duration: float, envelope: Envelope | None, times: int = 1
) -> Array:
    """Peaks ``max |u|`` [m] (paths, valid floors), one of ``times`` simulations of the same size."""
    floors = [{floor: 1.0} for floor in range(run.order.size)]
    check_finite(run, duration, len(floors), times)
    extremes = _extremes(run, floors, duration, envelope, None)
    return np.maximum(extremes.highest, -extremes.lowest)


def _extremes(
    run: SimulationRun,
    functions: list[Terms],
    duration: float,
    envelope: Envelope | None,
    progress: Progress | None,
    ties: Sequence[Tie] = (),
) -> Extremes:
    """Largest and smallest values [m] of linear functions of valid floors, and peaks of links."""
    crowd, shape = finite_steps(run, duration, envelope)
    links = None
    if ties:
        terms = [{tie.floor: 1.0} | ({tie.other: -1.0} if tie.other >= 0 else {}) for tie in ties]
        extensions = view_of(terms, run.order, run.scale)
        springs = [
            [*tie.link.spring, tie.link.number("damping_constant"), tie.link.exponent] for tie in ties
        ]
        links = Links(extensions, np.array(springs))
    return finite_extremes(crowd, view_of(functions, run.order, run.scale), shape, progress, links)


def _at_heights(
    system: Arrangement, places: list[tuple[int, float, Terms]], heights: Array, peaks: Array
) -> Column:
    """Peaks [m] of the structures at the heights at which they could meet another."""
    values = np.full((len(peaks), len(system.stacks), heights.size), np.nan)
    for (structure, height, _), column in zip(places, peaks.T, strict=True):
        values[:, structure, np.searchsorted(heights, height)] = column
    return ("path", STRUCTURE, "height"), values


def _separations(
    system: Arrangement, pairs: list[Pair], heights: Array, highest: Array, lowest: Array
) -> Columns:
    """Peak relative displacements [m], over all heights and, with storeys, at each height."""
    count, paths = len(system.stacks), len(highest)
    whole = np.zeros((paths, count, count))
    over = "path", STRUCTURE, f"{STRUCTURE}_2"
    at_height = np.full((paths, count, count, heights.size), np.nan)
    for pair, most, least in zip(pairs, highest.T, lowest.T, strict=True):
        for (i, j), value in (((pair.first, pair.second), most), ((pair.second, pair.first), -least)):
            whole[:, i, j] = np.maximum(whole[:, i, j], value)
            if not np.isnan(pair.height):
                at_height[:, i, j, np.searchsorted(heights, pair.height)] = value
    columns: Columns = {"separation": (over, whole)}
    if heights.size:
        columns["separation_at_height"] = (*over, "height"), at_height
    return columns


@checked
def exceedance(samples: xr.DataArray, gap: float | xr.DataArray) -> xr.Dataset:
    """Probability that a peak or separation exceeds a gap, from its samples.

    Parameters
    ----------
    samples : xarray.DataArray
        Samples over ``path`` [m], such as ``separation`` of `simulate` with a duration.
    gap : float or xarray.DataArray
        Gap [m], which may have other dimensions.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the samples except ``path``, and those of the gap: ``probability`` [-]
        with its 95 % interval ``probability_lower`` and ``probability_upper`` by Clopper and Pearson,
        which contains the true value with a probability of at least 95 %.

    Raises
    ------
    ValueError, TypeError
        If the samples have no dimension ``path``, or the samples or the gap are not numbers.

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
    if "path" not in samples.dims:
        raise ValueError(f"samples has the dimensions {samples.dims}; allowed: one of them is 'path'")
    if not is_number(gap) and not (isinstance(gap, xr.DataArray) and gap.dtype.kind in "iuf"):
        raise TypeError(f"gap = {brief(gap)}; allowed: a number or an xarray.DataArray, in metres")
    paths = samples.sizes["path"]
    count = ((samples > gap) | np.isposinf(samples)).sum("path")  # what falls exceeds any gap
    lower, upper = share_interval(count.to_numpy(), paths)
    table = xr.Dataset(
        {
            "probability": count / paths,
            "probability_lower": count.copy(data=lower),
            "probability_upper": count.copy(data=upper),
        }
    )
    return labels.label(table)


def pair_separation(motions: xr.Dataset) -> xr.DataArray:
    """Peak of ``u_1 - u_2`` [m] in each motion, from a dataset of `simulate` for two structures.

    For one structure beside a property line it is the peak of ``u_1`` over all floors.
    """
    if _is_alone(motions):
        return motions.peak_positive.max(motions.peak_positive.dims[1])
    return _of_pair(motions.separation)


def separation_at(motions: xr.Dataset, heights: Array) -> xr.DataArray:
    """`pair_separation` [m] over (path, height): heights of contact of two, or floors of one."""
    if _is_alone(motions):
        axis = labels.axis("height", HEIGHT, heights, "m")
        at_floors = motions.peak_positive.values
        return xr.DataArray(at_floors, dims=("path", "height"), coords={"height": axis.height})
    return _of_pair(motions.separation_at_height).sel(height=heights)


def pair_peaks(motions: xr.Dataset) -> Array:
    """Peaks [m] of one structure at its roof, or of two at the lower roof (paths, 1 or 2)."""
    if _is_alone(motions):
        return motions.peak.values[:, -1:]
    if "peak_at_height" not in motions:
        return motions.peak.values
    return motions.peak_at_height.isel(height=-1).values


def required_gaps(motions: xr.Dataset) -> tuple[float, float, float]:
    """First quantile of `pair_separation` [m], with the lower and upper end of its 95 % interval."""
    intervals = quantile_intervals(pair_separation(motions).values, motions["quantile"].values[:1])
    required, lower, upper = (float(column[0]) for column in intervals)
    return required, lower, upper


def enough_motions(
    simulated: Callable[[int], xr.Dataset],
    paths: int,
    most: int,
    gaps: Callable[[xr.Dataset], Sequence[float]] = required_gaps,
) -> xr.Dataset:
    """As many simulated motions as a gap needs, from ``paths`` to ``most``.

    They are enough if the 95 % interval of the gap is no longer than `PRECISION` times the gap to both
    sides. ``gaps`` are the gap and the ends of its interval, ``simulated`` the motions for a number.
    """
    motions = simulated(paths)
    gap, lower, upper = gaps(motions)
    wide = (upper - lower) / (2 * PRECISION * gap) if upper > lower and gap > 0 else 0.0
    if wide <= 1 or paths >= most:
        return motions
    return enough_motions(simulated, whole_groups(int(min(most, MARGIN * paths * wide**2))), most, gaps)


def _is_alone(motions: xr.Dataset) -> bool:
    """Whether the simulation has only one structure."""
    return motions.sizes[STRUCTURE] == 1


def _of_pair(separation: xr.DataArray) -> xr.DataArray:
    return separation.isel(structure=0, structure_2=1, drop=True)


def keeping_apart(separation: xr.DataArray, gap: float | xr.DataArray) -> dict[str, xr.DataArray]:
    """Probability of no pounding for a gap [m], and its 95 % interval; see `exceedance`."""
    pounding = exceedance(separation, gap)
    return {
        "no_pounding_probability": 1 - pounding.probability,
        "no_pounding_probability_lower": 1 - pounding.probability_upper,
        "no_pounding_probability_upper": 1 - pounding.probability_lower,
    }


def share_interval(count: Array, motions: int) -> tuple[Array, Array]:
    """95 % interval of the probability of an event, from the number of motions in which it occurs."""
    lower = betaincinv(count, motions - count + 1, TAIL)
    upper = betaincinv(count + 1, motions - count, 1 - TAIL)
    return np.nan_to_num(lower, nan=0.0), np.nan_to_num(upper, nan=1.0)


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
    quantiles = np.quantile(np.minimum(samples, FAR), levels, axis=0)
    return np.where(quantiles > np.sqrt(FAR), np.inf, quantiles)


def quantile_intervals(samples: Array, levels: Array) -> tuple[Array, Array, Array]:
    """Quantiles along the first axis, and their 95 % intervals from order statistics."""
    ordered = np.sort(samples, axis=0)
    n = len(ordered)
    each = (-1,) + (1,) * (samples.ndim - 1)
    low = np.ceil(bdtrik(TAIL, n, levels)).astype(int) - 1
    high = np.ceil(bdtrik(1 - TAIL, n, levels)).astype(int)
    estimate = quantiles_of(samples, levels)
    lower = np.where((low >= 0).reshape(each), ordered[np.maximum(low, 0)], 0.0)
    upper = np.where((high < n).reshape(each), ordered[np.minimum(high, n - 1)], np.inf)
    return estimate, lower, upper


def quantile_columns(name: str, over: Sequence[Any], samples: Array, levels: Array) -> Columns:
    """Quantiles of a variable along the first axis, and the ends of their 95 % intervals."""
    intervals = zip(labels.VALUE_AND_ENDS, quantile_intervals(samples, levels), strict=True)
    return {f"{name}_quantile{end}": (("quantile", *over), values) for end, values in intervals}
