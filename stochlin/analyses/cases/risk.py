"""Risk of pounding of the buildings of a case with several gaps, and the gap for its allowed risk."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import FEWEST_PATHS, Case
from stochlin.analyses.risk.risk import CERTAIN, RiskInputs, SimulatedRisk, Target
from stochlin.analyses.risk.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import DoubtfulInput

YEARS = 50.0  # default time of the probability of pounding [yr]
SHARE = 4  # motions of the case over those at each of the 13 intensities
PREFIX, GAP, OF = "risk_", "risk_gap", "risk_of"
KEPT = ("required_gap", "required_gap_lower", "required_gap_upper", "target_rate")


def simulated_risk(case: Case, progress: Progress | None) -> SimulatedRisk | None:
    """Simulated motions at all intensities of the hazard; None if the case has no hazard."""
    if case.hazard is None:
        return None
    sampled = [building.sampled for building in case.one_or_two]
    structures = dict(zip(("first", "second"), sampled, strict=False))
    motion = case.duration, case.envelope, case.scatter
    paths = max(FEWEST_PATHS, case.paths // SHARE)
    inputs = RiskInputs(structures, case.sampled_ground, case.hazard, *motion, paths, case.seed)
    with _of_hazard(case):
        inputs.check()
        return inputs.simulated(progress)


@contextmanager
def _of_hazard(case: Case) -> Iterator[None]:
    """Add the file and the place of the hazard to errors that occur inside the context."""
    try:
        yield
    except (ValueError, ArithmeticError) as error:
        raise ValueError(f"{case.file}: site.hazard cannot be used: {error}") from error


def risk_table(found: SimulatedRisk, case: Case, answer: float) -> xr.Dataset | None:
    """Risk with the existing gap, the required gap ``answer`` [m], and the gap for the allowed risk.

    None if all these gaps are 0. Names of variables begin with ``risk_``, so that they can be merged
    with those of the separation.
    """
    gaps = {"existing": case.gap or 0.0, "answer": answer}
    years, target = YEARS, xr.Dataset()
    if case.risk is not None:
        years = Target.of(case.risk).years or YEARS
        with _of_hazard(case):
            target = found.gap_of(case.risk)
        gaps["target"] = float(target.required_gap)
        target = target[list(KEPT)]
    gaps = {what: gap for what, gap in gaps.items() if gap > 0}
    if not gaps:
        return None
    with warnings.catch_warnings(), _of_hazard(case):
        warnings.simplefilter("ignore", DoubtfulInput)  # on weak shaking; the report states it instead
        each = [found.of_gap(gap, years) for gap in gaps.values()]
    along = labels.axis(GAP, "gap of which the risk is", np.array(list(gaps.values())), "m")
    table = xr.concat(each, along, data_vars="all", coords="minimal", compat="override", join="exact")
    attrs = {"long_name": "which gap this is"}
    table = table.assign_coords({OF: (GAP, list(gaps), attrs)}).assign(target.data_vars)
    for end, times in (("lower", -CERTAIN), ("upper", CERTAIN)):
        table[f"annual_rate_{end}"] = (
            table.annual_rate + times * table.annual_rate_standard_error
        ).clip(0)
    table = labels.label(table, VARIABLES).rename(
        {name: f"{PREFIX}{name}" for name in table.variables if name not in (GAP, OF)}
    )
    inputs = found.inputs
    table.attrs = {
        "risk_hazard": inputs.hazard.describe(),
        "risk_measure": inputs.hazard.measure,
        "risk_years": years,
        "risk_paths": inputs.paths,
    }
    return table
