"""Probability of pounding of the two buildings of a case file, simulated and in its records."""

from __future__ import annotations

from typing import NamedTuple

import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.probability.probability import pounding_probability
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.laws.bilinear import Bilinear


class ProbabilityAnswer(NamedTuple):
    """What `stochlin.pounding_probability` says of the case, for one gap [m]."""

    case: Case
    gap: float
    table: xr.Dataset
    records: dict[str, xr.Dataset]  # by the hybrid method


def judge_gap(case: Case, gap: float, progress: Progress | None = None) -> ProbabilityAnswer:
    """How likely the buildings of a case are to pound across this gap [m], simulated and in its records.

    ``progress`` is called with the share of the simulation that is done; errors are those of
    `stochlin.pounding_probability`.
    """
    first, second = case.pair
    bilinear = all(isinstance(building.structure, Bilinear) for building in case.pair)
    motions = case.records if bilinear else {}  # the hybrid method is of these alone
    asked = first.structure, second.structure, case.ground, gap
    table = pounding_probability(*asked, **case.motion, progress=progress)
    records = {
        name: pounding_probability(*asked, method="hybrid", record=record, confidence=case.confidence)
        for name, record in motions.items()
    }
    return ProbabilityAnswer(case, gap, table, records)
