"""Probability of pounding of the two buildings of a case, by simulation and in its records."""

from __future__ import annotations

from typing import NamedTuple

import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.sites.shaking import MOST_RECORDS, doubts, over_records, shaking_of
from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.probability.probability import pounding_probability
from stochlin.analyses.records.gaps import recorded_gap
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.laws.bilinear import Bilinear


class ProbabilityAnswer(NamedTuple):
    """Results of `stochlin.pounding_probability` for a case and one gap [m]."""

    case: Case
    gap: float
    table: xr.Dataset
    records: dict[str, xr.Dataset]  # results by the hybrid method; empty if there are many records
    shaking: xr.Dataset  # mean intensity of the motions
    over_records: xr.Dataset | None  # statistics over many records

    def whole(self) -> xr.Dataset:
        """The table with the intensity of the motions and any statistics over records."""
        table = self.table.assign(self.shaking.data_vars)
        return table if self.over_records is None else table.merge(self.over_records)

    def doubts(self) -> list[str]:
        """Texts on implausible results."""
        return doubts(self.shaking, self.case.pair, float(self.table.required_gap_simulated))


def judge_gap(case: Case, gap: float, progress: Progress | None = None) -> ProbabilityAnswer:
    """Probability of pounding of the buildings of a case with a gap [m], simulated and in its records.

    ``progress`` is called with the share of the simulation that is done. Errors are those of
    `stochlin.pounding_probability`.
    """
    first, second = case.pair
    bilinear = all(isinstance(building.structure, Bilinear) for building in case.pair)
    many = len(case.records) > MOST_RECORDS
    motions = {} if many or not bilinear else case.records  # the hybrid method needs bilinear laws
    asked = first.structure, second.structure, case.ground, gap
    sampled = first.sampled, second.sampled, case.sampled_ground, gap
    table = pounding_probability(*sampled, **case.motion, progress=progress)
    records = {
        name: pounding_probability(*asked, method="hybrid", record=record, confidence=case.confidence)
        for name, record in motions.items()
    }
    suite = None
    if many:
        pair = [strength_in_metres(building.structure, case.ground) for building in case.pair]
        found = recorded_gap(pair[0], pair[1], dict(case.records)).separation
        suite = over_records(found, gap, case.confidence)
    return ProbabilityAnswer(case, gap, table, records, shaking_of(case), suite)
