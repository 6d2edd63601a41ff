"""Results for a case: separation or set-back, limits of an existing gap, risk, and site spectrum."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.codes import APPLIED, with_applied_codes
from stochlin.analyses.cases.files.schema import FEWEST_PATHS
from stochlin.analyses.cases.sites.shaking import MOST_RECORDS, doubts, over_records, shaking_of
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.risk.risk import CERTAIN, RiskInputs, SimulatedRisk, Target
from stochlin.analyses.risk.variables import VARIABLES
from stochlin.analyses.sensitivity.sensitivity import sensitivity
from stochlin.analyses.separation.existing_gap import existing_gap
from stochlin.analyses.separation.separation import separation
from stochlin.analyses.sites.motion_fit import checked_components, periods_of_fit
from stochlin.analyses.sites.simulated_spectra import Motions, compared_spectrum, simulated_spectrum
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.messages import DoubtfulInput
from stochlin.models.parameters import Model
from stochlin.models.rules.codes import IN_COMMON

POINTS, SPECTRUM_PATHS = 401, 512
OF_RISK = 0.2  # share of the work for the risk, if there is a hazard
SEARCHES = 0.95  # share of the remaining work for the existing gap, if there is one
WITH_SENSITIVITIES = 0.5  # share of the work before the sensitivities
USUAL_PATHS, FEW_PATHS = 512, 128  # motions for the sensitivities
BAND = 0.2, 1.5  # of the shortest and of the longest period of buildings, in which spectra are compared
AROUND = 5.0  # factor of the range of the spectrum beyond the periods of buildings and ground
YEARS = 50.0  # default time of the probability of pounding [yr]
SHARE = 4  # motions of the case over those at each of the 13 intensities
PREFIX, GAP, OF = "risk_", "risk_gap", "risk_of"
USUAL = ("simulation", "srss", "eq_3_linearized", "eq_3_drift", "eq_3_paper")  # rules that are shown
KEPT = ("required_gap", "required_gap_lower", "required_gap_upper", "target_rate")


@dataclass(frozen=True)
class CaseAnswer:
    """A case and its results; ``existing`` is None if there is no existing gap."""

    case: Case
    separation: xr.Dataset
    existing: xr.Dataset | None
    spectrum: xr.Dataset
    shaking: xr.Dataset  # mean intensity of the motions
    over_records: xr.Dataset | None  # statistics over many records
    risk: xr.Dataset | None = None  # if there is a hazard
    matters: xr.Dataset | None = None  # sensitivities of the gap
    every_rule: bool = False  # whether all rules are shown

    @property
    def shown(self) -> xr.Dataset:
        """The rows of the rules that are shown: the usual ones, and those that the case asks for."""
        table = self.separation
        if self.every_rule:
            return table
        wanted = {*USUAL, *self.case.codes, *self.case.numbers}
        names = [str(name).removesuffix(APPLIED) for name in table.rule.values]
        return table.isel(rule=[name in wanted for name in names])

    def table(self, samples: bool = True) -> xr.Dataset:
        """All results in one dataset; without samples, only variables with one value for each rule."""
        table = self.separation
        if samples:
            table = table.assign(self.shaking.data_vars)
        if samples and self.over_records is not None:
            table = table.merge(self.over_records)
        if self.existing is not None:
            existing = {f"existing_{name}": array for name, array in self.existing.items()}
            table = table.assign(existing).assign_attrs(existing_gap_m=self.existing.attrs["gap_m"])
        if samples and self.risk is not None:
            table = table.merge(self.risk).assign_attrs(self.risk.attrs)
        table = table.assign_attrs(title=f"{self.case.title}: {table.attrs['title']}")
        return table if samples else table.drop_dims(set(table.dims) - {"rule"})

    def doubts(self) -> list[str]:
        """Texts on implausible results."""
        buildings = self.case.one_or_two
        peaks = tuple(float(self.separation[f"peak_mean_{n + 1}"]) for n in range(len(buildings)))
        return doubts(self.shaking, buildings, float(self.separation.gap[0]), peaks)


def answer_case(
    case: Case,
    progress: Progress | None = None,
    sensitivities: bool = False,
    every_rule: bool = False,
) -> CaseAnswer:
    """Separation of the two buildings of a case or set-back of one, and limits of the existing gap.

    Sensitivities are computed if any parameter is uncertain, or if ``sensitivities`` is True.
    ``every_rule`` has all rules shown, and not the usual ones only.
    ``progress`` is called with the share of the work that is done. Errors are those of `separation`,
    `existing_gap` and `sensitivity`.
    """
    sensitivities = sensitivities or bool(case.uncertain)
    end = WITH_SENSITIVITIES if sensitivities else 1.0
    first, *others = case.one_or_two
    second = others[0] if others else None
    pair = first.sampled, second.sampled if second else None
    begin = end * OF_RISK if case.hazard else 0.0
    middle = begin if case.gap is None else begin + (end - begin) * SEARCHES
    risky = _simulated_risk(case, part_of(progress, 0.0, begin))
    existing = None
    if case.gap is not None:
        options = {**case.motion, "progress": part_of(progress, begin, middle)}
        existing = existing_gap(*pair, case.sampled_ground, gap=case.gap, **options)
    in_common: dict[str, Any] = {} if case.alone else {name: getattr(case, name) for name in IN_COMMON}
    simulated = separation(
        *pair,
        case.sampled_ground,
        **case.motion | in_common | case.of_codes,
        height_1=first.height,
        height_2=second.height if second else None,
        numbers=case.numbers,
        unverified=case.unverified,
        records=dict(case.records) or None,
        progress=part_of(progress, middle, end),
    )
    table = with_applied_codes(case, simulated)
    matters = None
    if sensitivities:
        motion = {
            **case.motion,
            "paths": min(case.paths, _paths(case)),
            "progress": part_of(progress, end, 1.0),
        }
        matters = sensitivity(*pair, case.sampled_ground, **motion)
    records = None
    if len(case.records) > MOST_RECORDS:
        records = over_records(case, table.record_separation, float(table.gap[0]))
    risk = None if risky is None else _risk_table(risky, case, float(table.gap[0]))
    results = existing, _spectrum(case), shaking_of(case), records, risk, matters
    return CaseAnswer(case, table, *results, every_rule)


def _paths(case: Case) -> int:
    """Number of motions for the sensitivities, smaller for uncertain buildings with storeys.

    Such a building is made anew for each motion, which takes long.
    """
    storeys = any(
        isinstance(building, StoreyBuilding) and building.uncertain for building in case.buildings
    )
    return FEW_PATHS if storeys else USUAL_PATHS


def periods_of(*models: Model) -> list[float]:
    """Periods of the structures and of the ground [s]; white noise has no period."""
    return [float(model.arrays()["period"]) for model in models if "period" in model.arrays()]


def _spectrum(case: Case) -> xr.Dataset:
    """Response spectrum of the motions, compared with the target or the record; else the ground PSD."""
    options: Any = {"paths": SPECTRUM_PATHS, "seed": case.seed}
    motion = case.duration, case.envelope
    if case.spectrum is not None:
        return simulated_spectrum(case.ground, case.spectrum, *motion, **options)
    if case.fitted:
        compared = periods_of_fit(case.duration)
        of_record = checked_components(case.of_site.components).spectrum(compared)
        return compared_spectrum(Motions(case.ground, *motion, **options), compared, of_record)
    periods = [*case.periods, *periods_of(case.ground)]
    low, high = min(periods) / AROUND, max(periods) * AROUND
    frequency = np.geomspace(2 * np.pi / high, 2 * np.pi / low, POINTS)
    spectrum = case.ground.psd(frequency).rename("psd_ground").to_dataset()
    attrs = {"units": "s", "long_name": "period"}
    return spectrum.assign_coords(period=("frequency", 2 * np.pi / frequency, attrs))


def _simulated_risk(case: Case, progress: Progress | None) -> SimulatedRisk | None:
    """Simulated motions at all intensities of the hazard; None if the case has no hazard."""
    if case.hazard is None:
        return None
    sampled = [building.sampled for building in case.one_or_two]
    structures = dict(zip(("first", "second"), sampled, strict=False))
    motion = case.duration, case.envelope, case.scatter
    paths = whole_groups(max(FEWEST_PATHS, case.paths // SHARE))
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


def _risk_table(found: SimulatedRisk, case: Case, answer: float) -> xr.Dataset | None:
    """Risk with the existing gap, the required gap ``answer`` [m], and the gap for the allowed risk.

    Gaps of 0 are left out, since any shaking closes them; None if all are 0. Names of variables begin
    with ``risk_``, so that they can be merged with those of the separation.
    """
    gaps = {"existing": (*case.gaps, 0.0)[0], "answer": answer}
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
