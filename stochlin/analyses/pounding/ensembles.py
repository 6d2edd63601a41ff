"""Response of buildings in a row to many motions: summary of each motion, and statistics over them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.histories import floor_coords
from stochlin.analyses.pounding.rows import Building, Standing, shortest_period
from stochlin.analyses.pounding.runs import Outcome, RowResponse, responses, with_and_without
from stochlin.analyses.pounding.summaries import labelled, step_error, summary
from stochlin.analyses.pounding.variables import STATISTICS
from stochlin.analyses.records.cells import RECORD, RecordedMotions, Records, checked_motions
from stochlin.analyses.simulation.finite_motions import (
    Columns,
    exceedance,
    keeping_apart,
    quantile_intervals,
)
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.pounding.run import StepCounts

OF_COARSER = 0.8  # share of the work of a run with its error up to the run in coarser steps
PATH = "path"
NEIGHBOURS = "neighbours"
ENDS = ("", "_lower", "_upper")  # endings of the names of a quantity and its 95 % interval
# Variables that are NaN without an impact and then count as 0, with the variable that counts impacts.
OF_IMPACTS = {
    "hardest_force": "impacts",
    "hardest_force_between": "impacts_between",
    "fastest_approach": "impacts",
}
# Variables that are combined over all contacts between two neighbours, and how.
BETWEEN: Mapping[str, Any] = {
    "impacts": np.sum,
    "hardest_force": np.fmax.reduce,
    "contact_energy": np.sum,
}


class Ensemble(NamedTuple):
    """Motions and their dimension, ``path`` or ``record``, which is None for one motion."""

    motions: RecordedMotions
    over: str | None
    labels: xr.DataArray | None = None  # coordinate along the dimension

    def describe(self) -> str:
        """The motions in one line, for the run information."""
        if self.over != PATH:
            return self.motions.describe().removeprefix("record: ")
        (acceleration, dt), *more = self.motions.grounds
        return f"{1 + len(more)} paths, {acceleration.size} samples at {dt:g} s"


def checked_ensemble(motion: Records) -> Ensemble:
    """One motion or several, checked; an array over ``path`` and ``time`` has one motion a path."""
    if not isinstance(motion, xr.DataArray):
        motions = checked_motions(motion)
        names = xr.DataArray(motions.names, dims=RECORD, attrs={"long_name": "record"})
        return Ensemble(motions, RECORD, names)
    if PATH not in motion.dims:
        return Ensemble(checked_motions(motion), None)
    paths = {f"path {n}": motion.isel({PATH: n}, drop=True) for n in range(motion.sizes[PATH])}
    own = motion[PATH].assign_attrs(long_name="simulated motion") if PATH in motion.coords else None
    return Ensemble(checked_motions(paths), PATH, own)


def over_motions(
    structures: Sequence[Building],
    standing: Standing,
    ensemble: Ensemble,
    paces: Sequence[StepCounts],
    halved: bool,
    progress: Progress | None,
) -> xr.Dataset:
    """Summary of each motion; the results of one that fails are NaN, with the reason in ``missing``.

    With the errors of the time steps if ``halved``.
    """
    grounds, over = ensemble.motions.grounds, str(ensemble.over)
    shortest = shortest_period(structures)
    coarser = [pace._replace(cuts=pace.cuts // 2) for pace in paces]
    share = OF_COARSER if halved else 1.0
    both = with_and_without(
        structures, standing, grounds, paces, shortest, progress=part_of(progress, 0, share)
    )
    of_motions: list[tuple[Outcome, ...]] = list(both)
    if halved:
        rest = part_of(progress, share, 1)
        more = responses(structures, standing.row, grounds, coarser, shortest, progress=rest)
        of_motions = [(*pair, rerun) for pair, rerun in zip(both, more, strict=True)]
    summaries: list[dict[str, Any] | ArithmeticError] = []
    for of_motion in of_motions:
        errors = [each for each in of_motion if isinstance(each, ArithmeticError)]
        if errors:
            summaries.append(errors[0])
            continue
        response, alone, *coarse = (each for each in of_motion if isinstance(each, RowResponse))
        error = {"step_error": step_error(standing, coarse[0], response)} if coarse else {}
        summaries.append(summary(standing, response, alone) | error)
    failed = [each for each in summaries if isinstance(each, ArithmeticError)]
    if len(failed) == len(summaries):
        raise ArithmeticError(
            f"{failed[0]}; so in all {len(summaries)} motions" if failed[1:] else failed[0]
        )
    like = next(each for each in summaries if isinstance(each, dict))
    blank = {name: np.full(np.shape(values), np.nan) for name, values in like.items()}
    rows = [blank if isinstance(each, ArithmeticError) else each for each in summaries]
    values = {name: np.array([each[name] for each in rows], float) for name in like}
    good = xr.DataArray([isinstance(each, dict) for each in summaries], dims=over)
    coords = floor_coords(standing.first, structures)
    table = xr.Dataset(labelled(values, standing.first, structures, over), coords=coords)
    table["status"] = labels.status_where(good, labels.NOT_CONVERGED)
    reasons = ["" if isinstance(each, dict) else str(each) for each in summaries]
    if ensemble.labels is not None:
        table = table.assign_coords({over: ensemble.labels})
    return table.assign_coords(
        missing=(over, reasons, {"long_name": "missing results of a motion, and the reason"})
    )


def with_statistics(table: xr.Dataset, over: str, levels: Array) -> xr.Dataset:
    """The table with values for each gap, and with means and quantiles over the motions.

    Motions that failed do not count.
    """
    table = _between_neighbours(table, over)
    good = table.isel({over: (table.status == labels.CONVERGED).values})
    columns: Columns = {}
    for name in (each for each in STATISTICS if each in good):
        samples = good[name].transpose(over, ...)
        values = samples.values
        if name in OF_IMPACTS:
            impacts = good[OF_IMPACTS[name]].transpose(*samples.dims)
            values = np.where(impacts.values > 0, values, 0.0)
        columns |= _statistics(name, samples.dims[1:], values, levels)
    # Added at once, because each addition to a dataset takes a millisecond.
    table = table.assign(columns).assign_coords(quantile=labels.axis("quantile", "quantile", levels))
    hits = good.impacts_between.rename({over: PATH})
    shares = exceedance(hits, 0.0).rename(
        {f"probability{end}": f"pounding_probability{end}" for end in ENDS}
    )
    return table.assign({**shares.data_vars, **keeping_apart(hits, 0.0)})


def neighbours(count: int) -> dict[str, Any]:
    """Coordinate ``neighbours`` of the gaps between ``count`` structures."""
    pairs = [f"{n} | {n + 1}" for n in range(1, count)]
    return {NEIGHBOURS: (NEIGHBOURS, pairs, {"long_name": "both sides of the gap"})}


def _between_neighbours(table: xr.Dataset, over: str) -> xr.Dataset:
    """The table with the variables of `BETWEEN`, combined over all contacts between two neighbours."""
    left = table.left.values
    pairs = np.unique(left)
    table = table.assign_coords(neighbours(pairs.size + 1))
    columns: Columns = {}
    for name, join in BETWEEN.items():
        values = table[name].transpose(over, "contact").values
        joined = [join(values[:, left == n], axis=1) for n in pairs]
        together = np.reshape(joined, (pairs.size, len(values))).T
        columns[f"{name}_between"] = (over, NEIGHBOURS), np.ascontiguousarray(together)
    return table.assign(columns)


def _statistics(name: str, dims: tuple[Any, ...], values: Array, levels: Array) -> Columns:
    """Mean and quantiles along the first axis, with their errors; NaN if any sample is NaN."""
    known = ~np.isnan(values).any(axis=0)
    values = np.where(known, values, 0.0)
    error = np.full(known.shape, np.nan)
    if len(values) > 1:
        error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
    columns = {"mean": (dims, values.mean(axis=0)), "mean_standard_error": (dims, error)}
    for end, each in zip(ENDS, quantile_intervals(values, levels), strict=True):
        columns[f"quantile{end}"] = ("quantile", *dims), each
    return {
        f"{name}_{what}": (over, np.where(known, each, np.nan)) for what, (over, each) in columns.items()
    }
