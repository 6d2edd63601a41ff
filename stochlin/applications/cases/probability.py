"""Probability of pounding of the two buildings of a case, by simulation and in its records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import motion_of, pair_of, simulated_as
from stochlin.applications.cases.shaking import MOST_RECORDS, doubts, over_records, shaking_of
from stochlin.applications.probability.probability import pounding_probability
from stochlin.applications.records.gaps import recorded_gap
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.structures import Structure
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.tables import labels

BEFORE_RECORDS = 0.4  # share of the work before many records
INSTANTS = 501  # at which the confidence in the records is kept


class ProbabilityAnswer(NamedTuple):
    """Results of `stochlin.pounding_probability` for a case and one gap [m]."""

    case: Case
    gap: float
    table: xr.Dataset
    records: xr.Dataset | None  # results by the hybrid method; None if there are many records
    shaking: xr.Dataset  # mean intensity of the motions
    over_records: xr.Dataset | None  # statistics over many records

    def whole(self) -> xr.Dataset:
        """The table with the intensity of the motions and the results of records, for a file."""
        table = self.table.assign(self.shaking.data_vars)
        for results in (self.over_records, self.records):
            table = table if results is None else table.merge(results)
        return table

    def rows(self) -> xr.Dataset:
        """A row for each instant of the motions and each record, with the end of that record."""
        if self.records is None:
            return self.table
        return self.table.merge(self.records.isel(record_time=-1, drop=True))

    def doubts(self) -> list[str]:
        """Texts on implausible results."""
        return doubts(self.shaking)


def judge_gap(case: Case, gap: float, progress: Progress | None = None) -> ProbabilityAnswer:
    """Probability of pounding of the buildings of a case with a gap [m], simulated and in its records.

    ``progress`` is called with the share of the work that is done. Errors are those of
    `stochlin.pounding_probability`.
    """
    first, second = pair_of(case)
    oscillators = all(isinstance(building.structure, Structure) for building in pair_of(case))
    many = len(case.site.records) > MOST_RECORDS
    motions = {} if many or not oscillators else case.site.records  # the hybrid method has no storeys
    medians = first.structure, second.structure, case.site.ground, gap
    sampled = first.sampled, second.sampled, case.site.sampled_ground, gap
    simulating = part_of(progress, 0.0, BEFORE_RECORDS if many else 1.0)
    table = pounding_probability(*sampled, **motion_of(case), progress=simulating)
    options: Any = {"method": "hybrid", "confidence": case.wanted.confidence}
    records = {
        name: pounding_probability(*medians, record=each, **options) for name, each in motions.items()
    }
    hybrid, suite = _side_by_side(records) if records else None, None
    if many:
        pair = [strength_in_metres(building.structure, case.site.ground) for building in pair_of(case)]
        rest = part_of(progress, BEFORE_RECORDS, 1.0)
        separations = recorded_gap(pair[0], pair[1], dict(case.site.records), progress=rest).separation
        suite = over_records(case, separations, gap)
    return ProbabilityAnswer(simulated_as(case, table), gap, table, hybrid, shaking_of(case), suite)


def _side_by_side(records: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Results of the hybrid method on one time axis; after its end a record keeps its last values."""
    timed = [result.assign_coords(time=result.time - result.time[0]) for result in records.values()]
    instants = np.linspace(0.0, max(float(result.time[-1]) for result in timed), INSTANTS)
    rows = [
        result[["required_gap", "separation", "rho", "confidence_of_no_pounding"]]
        .reindex(time=instants, method="ffill")
        .assign(radius_difference=abs(result.radius_1 - result.radius_2).max())
        for result in timed
    ]
    table = xr.concat(rows, "record", combine_attrs="drop").drop_attrs()
    table = table.rename({name: f"record_{name}" for name in [*table.data_vars, "time"]}).assign_coords(
        record=("record", [*records], {"long_name": "record"}),
        record_time=labels.axis("record_time", "time from the beginning of the record", instants, "s"),
    )
    return labels.label(table)
