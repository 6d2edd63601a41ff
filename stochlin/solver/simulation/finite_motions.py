"""Peak displacements and peak relative displacements in simulated motions of finite duration."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr
from scipy.special import bdtrik, betaincinv

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores
from stochlin.kernels.simulation.ensemble import Extremes, Links, finite_extremes
from stochlin.kernels.simulation.stepping import LANES
from stochlin.messages import brief
from stochlin.models.arguments import checked, is_number
from stochlin.models.envelopes import Envelope, envelope_at
from stochlin.models.parameters import check_alignment, check_units
from stochlin.models.systems import AnyStructure, Arrangement, Stack
from stochlin.solver.simulation.ensembles import SimulationRun, seconds_of
from stochlin.solver.simulation.results import RESULTS, Column, EndedMotions, columns_of
from stochlin.solver.simulation.structures_in_motion import (
    HEIGHT,
    PATH,
    STRUCTURE,
    StructuresInMotion,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration, check_work
from stochlin.solver.tables.labels import ELEMENT, link_coordinates
from stochlin.solver.tables.lazy import check_names

TAIL = (1 - 0.95) / 2  # probability on each side of a 95 % interval
FAR = 1e200  # [m], in place of infinity, between which and a number no quantile can be
BLOCK = 256  # time steps that are computed at once
ABOVE_GROUND = "height above the ground"
Columns = dict[str, Column]
OF_STEPS, OF_PEAKS = 6, 6  # numbers that are in memory at once for each step, and for each peak


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
            raise ValueError(f"scatter = {scatter:g} is given without a duration; give one")
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
        numbers=OF_STEPS * steps + OF_PEAKS * 2.0 * paths * functions,
        seconds=seconds_of(run, times * steps, 2.0 * functions),
        cores=cores(),
    )


def names_of_laws(stacks: Sequence[Stack]) -> str:
    """The hysteresis laws of structures, each with the module that defines it."""
    laws = {type(stack.law) for stack in stacks}
    return " or ".join(sorted(f"{law.__qualname__} ({law.__module__})" for law in laws))


def runs_away(stacks: Sequence[Stack]) -> str:
    """What is wrong with the laws of structures whose response is no longer finite, and the cure."""
    return (
        f"the rates of the law {names_of_laws(stacks)} grow without end: give a law in which z "
        "and all other states stay bounded, such as v - abs(v)*z, or weaker motions"
    )


def check_response(system: Arrangement, finite: Array) -> None:
    """Raise an ArithmeticError if a floor (motions, floors) has a response that is not ``finite``."""
    lost = ~np.logical_and.reduceat(finite, system.first[:-1], axis=1)
    if lost.any():
        worst = int(np.argmax(lost.sum(axis=0)))
        what = f"structures, number {worst + 1}: its response is no longer finite"
        raise ArithmeticError(f"{what}; {runs_away([system.stacks[worst]])}")


def simulate_finite(
    moving: StructuresInMotion,
    duration: float,
    envelope: Envelope | None,
    quantiles: Sequence[float],
    progress: Progress | None,
) -> xr.Dataset:
    """Dataset of `simulate` for motions of finite duration, without labels."""
    levels = np.asarray(quantiles, float)
    run, system, functions = moving.run, moving.system, moving.functions
    extremes = extremes_of(run, [*functions.values()], (duration, envelope), progress, links_of(system))
    motions = _ended(moving, functions, extremes)
    check_response(system, ~np.isnan(motions.largest["floors"][0]))
    samples = columns_of(motions)
    names = [f"{number}" for number in range(1, len(system.stacks) + 1)]
    coords = moving.coords | {STRUCTURE: names, f"{STRUCTURE}_2": names}
    if moving.places:
        coords[HEIGHT] = labels.axis(HEIGHT, ABOVE_GROUND, moving.heights, "m").height
    if system.ties:
        coords |= link_coordinates([tie.number for tie in system.ties])
    means = _means(samples)
    if moving.system.has_storeys:
        means["ductility"] = [ELEMENT], means["peak_drift_mean"][1] / system.watched_strength
    (_, *over_pairs), apart_most = samples["separation"]
    quantile = quantile_columns("separation", over_pairs, apart_most, levels)
    if np.isfinite(moving.limits).any():
        means |= share_columns("collapse_probability", [STRUCTURE], motions.fallen)
    coords["quantile"] = "quantile", levels, {"units": "1", "long_name": "quantile"}
    # Made at once, because each addition to a dataset takes a millisecond.
    columns = samples | means | quantile | moving.input_factors()
    return xr.Dataset(columns, coords, finite_attributes(run, duration, envelope))


def links_of(system: Arrangement) -> tuple[Array, Array]:
    """Extensions of the links, as functions (l, w) of all that is watched, and their parameters."""
    extensions = np.zeros((len(system.ties), len(system.watched)))
    for row, tie in zip(extensions, system.ties, strict=True):
        row[tie.floor] = 1.0
        if tie.other >= 0:
            row[tie.other] = -1.0
    return extensions, np.reshape([tie.link.numbers for tie in system.ties], (-1, 5))


def extremes_of(
    run: SimulationRun,
    functions: Sequence[Array],
    motion: tuple[float, Envelope | None],
    progress: Progress | None = None,
    links: tuple[Array, Array] | None = None,
) -> Extremes:
    """Extremes of linear functions (m, w) [m] of all that is watched, and peaks of links.

    The ``motion`` is a duration with its envelope. Raises as `check_finite`.
    """
    matrix, (duration, envelope) = np.concatenate(functions), motion
    check_finite(run, duration, len(matrix))
    extensions, parameters = links or (np.zeros((0, 1)), np.zeros((0, 5)))
    middle = run.plan.dt * (np.arange(int(np.ceil(duration / run.plan.dt))) + 0.5)  # of the steps
    crowd, watched = run.with_plan(every=1, samples=BLOCK).crowd, Links(run.rows(extensions), parameters)
    return finite_extremes(crowd, run.rows(matrix), envelope_at(envelope, middle), progress, watched)


def _ended(
    moving: StructuresInMotion, functions: Mapping[str, Array], extremes: Extremes
) -> EndedMotions:
    """All that is known of the motions; a structure that falls moves beyond any gap."""
    system, matrix = moving.system, np.concatenate([*functions.values()])
    largest = np.stack([extremes.highest, -extremes.lowest])
    ends = np.cumsum([len(rows) for rows in functions.values()])[:-1]
    blocks = dict(zip(functions, np.split(largest, ends, axis=2), strict=True))
    drifts = blocks["drifts" if moving.system.has_storeys else "floors"].max(axis=0)
    fallen = system.fallen(drifts, moving.limits)
    members = np.arange(len(system.stacks)) == system.owners[:, None]
    lost = fallen @ (np.abs(matrix) @ members > 0).T
    largest[:, lost] = np.inf
    peaks = {"force": extremes.force, "stroke": extremes.stroke, "energy": extremes.energy}
    falls = fallen.any(axis=1, keepdims=True)
    links = {name: np.where(falls, np.inf, each) for name, each in peaks.items() if system.ties}
    ends_at, plastic = (moving.run.watched(each) for each in (extremes.last, extremes.plastic))
    return EndedMotions(moving, blocks, fallen, links, ends_at, plastic)


def _means(samples: Columns) -> Columns:
    """Means over the motions, and their standard errors."""
    means: Columns = {}
    for name, ((_, *over), values) in samples.items():
        if RESULTS[name].mean:
            means |= mean_columns(name, over, values)
    return means


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
        Over the dimensions of the samples except ``path``, and those of the gap: ``probability`` [-]
        with its 95 % interval ``probability_lower`` and ``probability_upper`` by Clopper and Pearson,
        which contains the true value with a probability of at least 95 %. They are NaN, with the status
        ``invalid_input``, where the gap or a sample is NaN. ``status``.

    Raises
    ------
    ValueError, TypeError
        If the samples have no dimension ``path`` or are none, the samples or the gap are not numbers, a
        single gap or a sample of a single cell is NaN, or dimensions of the same name differ in
        coordinates or length.

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
        raise ValueError(f"samples has the dimensions {samples.dims}; allowed: one of them is '{PATH}'")
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
    known = table.probability.notnull()
    if not known.ndim and not known:
        what = "nan is among the samples, or the gaps, of the only cell"
        raise ValueError(f"samples: {what}; allowed: numbers of metres, which may be infinite")
    return labels.label(table.assign(status=labels.status_where(known)))


def pounding_shares(samples: xr.DataArray, gap: float | xr.DataArray) -> xr.Dataset:
    """``probability`` that samples over ``path`` exceed a gap [m], and its 95 % interval.

    They are NaN where the gap or a sample is NaN, which neither exceeds nor keeps a gap.
    """
    beyond = (samples > gap) | np.isposinf(samples)  # what falls exceeds any gap
    beyond = beyond.transpose(PATH, ...)
    shares = xr.Dataset(share_columns("probability", beyond.dims[1:], beyond.values), {**beyond.coords})
    unknown = (samples.isnull() | xr.DataArray(gap).isnull()).any(PATH)
    return shares.where(~unknown) if unknown.any() else shares


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
        axis = labels.axis(HEIGHT, ABOVE_GROUND, heights, "m")
        at_floors = motions.peak_positive.values
        return xr.DataArray(at_floors, dims=(PATH, HEIGHT), coords={"height": axis.height})
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
    return quantile_interval(pair_separation(motions).values, motions["quantile"].values[0])


def _is_alone(motions: xr.Dataset) -> bool:
    """Whether the simulation has only one structure."""
    return motions.sizes[STRUCTURE] == 1


def _of_pair(separation: xr.DataArray) -> xr.DataArray:
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
    n, count = len(events), events.sum(axis=0)
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
    quantiles = np.quantile(np.minimum(samples, FAR), levels, axis=0)
    return np.where(quantiles > np.sqrt(FAR), np.inf, quantiles)


def quantile_intervals(samples: Array, levels: Array) -> tuple[Array, Array, Array]:
    """Quantiles along the first axis, and their 95 % intervals from order statistics.

    They are NaN where a sample is NaN.
    """
    ordered = np.sort(samples, axis=0)  # with NaN at the end
    n = len(ordered)
    each = (-1,) + (1,) * (samples.ndim - 1)
    low = np.ceil(bdtrik(TAIL, n, levels)).astype(int) - 1
    high = np.ceil(bdtrik(1 - TAIL, n, levels)).astype(int)
    estimate = quantiles_of(samples, levels)
    lower = np.where((low >= 0).reshape(each), ordered[np.maximum(low, 0)], 0.0)
    upper = np.where((high < n).reshape(each), ordered[np.minimum(high, n - 1)], np.inf)
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
