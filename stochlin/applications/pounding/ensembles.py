"""Response of buildings in a row to motions: histories of one, statistics over several."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.pounding.histories import floor_coords, histories, labelled
from stochlin.applications.pounding.rows import Standing
from stochlin.applications.pounding.runs import failure, responses, runs_of
from stochlin.applications.pounding.summaries import summary
from stochlin.applications.records.cells import RECORD, RecordedMotions, Records, checked_motions
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.pounding.run import StepCounts
from stochlin.solver.simulation.finite_motions import (
    LINK_PEAKS,
    Columns,
    exceedance,
    keeping_apart,
    mean_columns,
    quantile_columns,
)
from stochlin.solver.tables import labels

PATH, NEIGHBOURS = "path", "neighbours"
BETWEEN = "impacts", "hardest_force", "contact_energy"  # also of all contacts between two neighbours
PEAKS = "peak", "peak_acceleration", "peak_storey_shear", "peak_base_shear"
# Variables with a mean and quantiles over several motions.
STATISTICS = (
    *(*BETWEEN, *(f"{name}_between" for name in BETWEEN), "fastest_approach", "column_force"),
    *("column_force_share", "amplification", *PEAKS, *(f"{name}_alone" for name in PEAKS), *LINK_PEAKS),
)


class Ensemble(NamedTuple):
    """One motion or several, and their dimension, ``path`` or ``record``."""

    motions: RecordedMotions
    over: str
    labels: xr.DataArray | None = None  # coordinate along the dimension

    @property
    def single(self) -> bool:
        """Whether there is one motion, which adds no dimension to results."""
        return self.motions.names is None

    def describe(self) -> str:
        """The motions in one line, for the run information."""
        if not self.single and self.over == PATH:
            return f"{len(self.motions.grounds)} simulated motions"
        return self.motions.describe().removeprefix("record: ")


def checked_ensemble(motion: Records) -> Ensemble:
    """One motion or several, checked; an array over ``path`` and ``time`` has one motion a path."""
    try:
        if not isinstance(motion, xr.DataArray):
            motions = checked_motions(motion)
            names = xr.DataArray(motions.names, dims=RECORD, attrs={"long_name": "record"})
            return Ensemble(motions, RECORD, names)
        if PATH not in motion.dims:
            return Ensemble(checked_motions(motion), PATH)
        paths = {f"path {n}": motion.isel({PATH: n}, drop=True) for n in range(motion.sizes[PATH])}
        own = motion[PATH].assign_attrs(long_name="simulated motion") if PATH in motion.coords else None
        return Ensemble(checked_motions(paths), PATH, own)
    except (TypeError, ValueError) as error:
        raise type(error)(f"motion: {error}") from error


def response_table(
    standing: Standing,
    ensemble: Ensemble,
    paces: Sequence[StepCounts],
    progress: Progress | None,
) -> xr.Dataset:
    """Summary of each motion, or summary and histories of a single one.

    The results of one of several motions that fails are NaN, with the reason in ``missing``.
    """
    grounds, over, single = ensemble.motions.grounds, ensemble.over, ensemble.single
    runs = [runs_of(standing, *each, halved=single) for each in zip(grounds, paces, strict=True)]
    outcomes = responses([run for several in runs for run in several], standing, single, progress)
    size = len(runs[0])
    of_motions = [outcomes[begin : begin + size] for begin in range(0, len(outcomes), size)]
    reasons = [
        next(filter(None, (failure(standing, each) for each in of_motion)), "")
        for of_motion in of_motions
    ]
    if all(reasons):
        raise ArithmeticError(
            f"{reasons[0]}; so in all {len(reasons)} motions" if reasons[1:] else reasons[0]
        )
    summaries = [
        {} if reason else summary(standing, *of_motion)
        for reason, of_motion in zip(reasons, of_motions, strict=True)
    ]
    like = next(filter(None, summaries))
    blank = {name: (dim, np.full(np.shape(values), np.nan)) for name, (dim, values) in like.items()}
    rows = [values or blank for values in summaries]
    columns = {n: (dim, np.array([row[n][1] for row in rows], float)) for n, (dim, _) in like.items()}
    table = xr.Dataset(labelled(columns, standing, over), coords=floor_coords(standing))
    if single:
        courses = histories(standing, outcomes[0], grounds[0], ensemble.motions.records[0]["time"])
        return courses.assign(table.isel({over: 0}).drop_vars("energy_balance_error").data_vars)
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
    good = table.isel({over: (table.status == labels.CONVERGED).values})
    columns: Columns = {}
    for name in (each for each in STATISTICS if each in good):
        samples = good[name].transpose(over, ...)
        columns |= _statistics(name, samples.dims[1:], samples.values, levels)
    # Added at once, because each addition to a dataset takes a millisecond.
    table = table.assign(columns).assign_coords(quantile=labels.axis("quantile", "quantile", levels))
    if NEIGHBOURS not in table.dims:
        return table
    hits = good.impacts_between.rename({over: PATH})
    shares = exceedance(hits, 0.0).rename(
        {f"probability{end}": f"pounding_probability{end}" for end in labels.VALUE_AND_ENDS}
    )
    return table.assign({**shares.data_vars, **keeping_apart(hits, 0.0)})


def between_neighbours(table: xr.Dataset) -> xr.Dataset:
    """The variables of `BETWEEN`, of all contacts between two neighbours together."""
    by_gap = table[[*BETWEEN]].groupby("left")
    joined = by_gap.sum(skipna=False).assign(hardest_force=by_gap.max(skipna=False).hardest_force)
    names = [f"{left} | {left + 1}" for left in joined.left.values]
    joined = joined.rename({name: f"{name}_between" for name in BETWEEN} | {"left": NEIGHBOURS})
    coordinate = NEIGHBOURS, names, {"long_name": "both sides of the gap"}
    return joined.assign_coords({NEIGHBOURS: coordinate}).transpose(..., NEIGHBOURS)


def _statistics(name: str, dims: tuple[Any, ...], values: Array, levels: Array) -> Columns:
    """Mean and quantiles along the first axis, with their errors; NaN if any sample is NaN."""
    known = ~np.isnan(values).any(axis=0)
    values = np.where(known, values, 0.0)
    columns = mean_columns(name, dims, values) | quantile_columns(name, dims, values, levels)
    return {what: (over, np.where(known, each, np.nan)) for what, (over, each) in columns.items()}
