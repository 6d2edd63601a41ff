"""Response of buildings in a row to many motions: summary of each motion, and statistics over them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain, islice
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.pounding.histories import Quantities, floor_coords, labelled
from stochlin.applications.pounding.rows import Standing
from stochlin.applications.pounding.runs import jobs_of, responses
from stochlin.applications.pounding.summaries import summary
from stochlin.applications.pounding.variables import STATISTICS
from stochlin.applications.records.cells import RECORD, RecordedMotions, Records, checked_motions
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.pounding.run import StepCounts
from stochlin.solver.simulation.finite_motions import (
    Columns,
    exceedance,
    keeping_apart,
    mean_columns,
    quantile_columns,
)
from stochlin.solver.tables import labels

PATH = "path"
NEIGHBOURS = "neighbours"
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
    try:
        if not isinstance(motion, xr.DataArray):
            motions = checked_motions(motion)
            names = xr.DataArray(motions.names, dims=RECORD, attrs={"long_name": "record"})
            return Ensemble(motions, RECORD, names)
        if PATH not in motion.dims:
            return Ensemble(checked_motions(motion), None)
        paths = {f"path {n}": motion.isel({PATH: n}, drop=True) for n in range(motion.sizes[PATH])}
        own = motion[PATH].assign_attrs(long_name="simulated motion") if PATH in motion.coords else None
        return Ensemble(checked_motions(paths), PATH, own)
    except (TypeError, ValueError) as error:
        raise type(error)(f"motion: {error}") from error


def over_motions(
    standing: Standing,
    ensemble: Ensemble,
    paces: Sequence[StepCounts],
    progress: Progress | None,
) -> xr.Dataset:
    """Summary of each motion; the results of one that fails are NaN, with the reason in ``missing``."""
    grounds, over = ensemble.motions.grounds, str(ensemble.over)
    of_motions = [jobs_of(standing, *each, halved=False) for each in zip(grounds, paces, strict=True)]
    outcomes = iter(responses(standing, list(chain.from_iterable(of_motions)), progress=progress))
    summaries: list[Quantities] = []
    reasons: list[str] = []
    for jobs in of_motions:
        values: Quantities = {}
        reasons.append("")
        try:
            values = summary(standing, list(islice(outcomes, len(jobs))))
        except ArithmeticError as error:
            reasons[-1] = str(error)
        summaries.append(values)
    if all(reasons):
        raise ArithmeticError(
            f"{reasons[0]}; so in all {len(reasons)} motions" if reasons[1:] else reasons[0]
        )
    like = next(filter(None, summaries))
    blank = {name: (dim, np.full(np.shape(values), np.nan)) for name, (dim, values) in like.items()}
    rows = [values or blank for values in summaries]
    columns = {n: (dim, np.array([row[n][1] for row in rows], float)) for n, (dim, _) in like.items()}
    table = xr.Dataset(labelled(columns, standing, over), coords=floor_coords(standing))
    good = xr.DataArray([not reason for reason in reasons], dims=over)
    table["status"] = labels.status_where(good, labels.NOT_CONVERGED)
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
        {f"probability{end}": f"pounding_probability{end}" for end in labels.VALUE_AND_ENDS}
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
    columns = mean_columns(name, dims, values) | quantile_columns(name, dims, values, levels)
    return {what: (over, np.where(known, each, np.nan)) for what, (over, each) in columns.items()}
