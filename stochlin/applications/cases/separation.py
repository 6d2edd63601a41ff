"""Results for a case: separation or set-back, limits of an existing gap, risk and site spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.cases.codes import with_applied_codes
from stochlin.applications.cases.reading.case import FEWEST_PATHS, Case
from stochlin.applications.cases.rows import (
    gap_of,
    motion_of,
    of_codes,
    one_or_two,
    simulated_as,
)
from stochlin.applications.cases.shaking import MOST_RECORDS, over_records, shaking_of
from stochlin.applications.risk.risk import RiskSimulation, SimulatedRisk, allowed_rate
from stochlin.applications.sensitivity.sensitivity import sensitivity
from stochlin.applications.separation.existing_gap import WORK_OF_SEARCHES, GapSearch
from stochlin.applications.separation.separation import separation
from stochlin.applications.sites.motion_fit import checked_components, periods_of_fit
from stochlin.applications.sites.simulated_spectra import (
    SpectrumMotions,
    compared_spectrum,
    simulated_spectrum,
)
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.messages import brief
from stochlin.models.arguments import checked
from stochlin.models.grounds import SCATTER_OF_SPECTRUM
from stochlin.models.plausible import unquestioned
from stochlin.solver.simulation.prepared import FiniteMotion
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import standing

SPECTRUM_PATHS = 512
WORK_OF_RISK = 3.0  # work for the risk, in simulations of all motions
BEFORE_SENSITIVITIES = 0.5  # share of the work before the sensitivities
# Motions for the sensitivities; an uncertain building with storeys is made anew for each, slowly.
USUAL_PATHS = 512
FEW_PATHS = 128
# of the shortest and of the longest period of buildings, in which spectra are compared
BAND = (0.2, 1.5)
YEARS = 50.0  # default time of the probability of pounding [yr]
CASE_MOTIONS_PER_RISK_MOTION = 8  # motions of the case over those at each of the 25 intensities
WITH_SCATTER = "gap_with_scatter"  # variable: [m]
RISK_PREFIX = "risk_"
RISK_GAP = "risk_gap"
RISK_OF = "risk_of"
TARGET_VARIABLES = ("required_gap", "required_gap_lower", "required_gap_upper", "target_rate")


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

    def table(self, samples: bool = True) -> xr.Dataset:
        """All results in one dataset; without samples, only variables with one value per rule."""
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


@checked
def separation_case(case: Case, progress: Progress | None = None) -> xr.Dataset:
    """Gap of the buildings of a case by simulation and every rule, as ``stochlin gap`` answers it.

    Parameters
    ----------
    case : Case
        A case as from `stochlin.read_case`, of two buildings, or of one beside its property line.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        Over ``rule`` the variables of `stochlin.separation`, such as ``gap`` [m] and ``verdict``,
        with the codes, the records and the scatter of the case; those of `stochlin.existing_gap`
        with ``existing_`` before their names, if the case has an existing gap, and those of
        `stochlin.pounding_risk` with ``risk_``, if it has a hazard.

    Raises
    ------
    ValueError, TypeError
        If ``case`` is no case, has more than two buildings, or for an error of these functions; the
        message names the file, or the dictionary.
    ArithmeticError
        If there is no solution.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (3); the coordinate ``reference`` for each rule.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = {"period": "0.6 s", "damping": 0.05, "elastic": True}
    >>> content = {"site": {"ground": "firm", "pga": "0.3 g"}, "motion": {"duration": "10 s"}}
    >>> content |= {"building_1": building, "building_2": building | {"period": "1 s"}}
    >>> content |= {"separation": {"confidence": 0.9}, "simulation": {"paths": 128}}
    >>> table = sl.separation_case(sl.read_case(content))
    >>> bool(table.gap.sel(rule="srss") > 0)
    True
    """
    if not isinstance(case, Case):
        raise TypeError(f"case = {brief(case)}; allowed: the result of read_case")
    return answer_case(case, progress).table()


class ProgressOfParts(NamedTuple):
    """The progress of each part of an answer, by its share of the work."""

    risk: Progress
    separation: Progress
    scatter: Progress  # of the separation with the scatter of earthquakes
    existing: Progress  # of the limits of an existing gap
    sensitivity: Progress

    @classmethod
    def of(cls, case: Case, progress: Progress | None) -> ProgressOfParts:
        """The parts of a case; those that it does not need have no share."""
        work = {
            "risk": WORK_OF_RISK if case.site.hazard else 0.0,
            "separation": 1.0,
            "scatter": 1.0 if case.site.leaves_out_scatter else 0.0,
            "existing": 0.0 if gap_of(case) is None else WORK_OF_SEARCHES,
        }
        before = sum(work.values())
        work["sensitivity"] = before * (1 / BEFORE_SENSITIVITIES - 1) if case.uncertain else 0.0
        ends = [0.0, *np.cumsum(list(work.values())) / sum(work.values())]
        shares = zip(work, pairwise(ends), strict=True)
        return cls(**{name: part_of(progress, *share) for name, share in shares})


@unquestioned()
def answer_case(case: Case, progress: Progress | None = None) -> CaseAnswer:
    """Separation of the two buildings of a case or set-back of one, and limits of the existing gap.

    Sensitivities are computed if any parameter is uncertain. ``progress`` is called with the share
    of the work that is done. Errors are those of `separation`, `existing_gap` and `sensitivity`.
    """
    structures = [building.sampled for building in one_or_two(case)]
    first = structures[0]
    second = structures[1] if len(structures) > 1 else None
    models = first, second, case.site.sampled_ground
    gap = gap_of(case)
    motion = motion_of(case)
    scattered = case.site.leaves_out_scatter
    existing = None
    matters = None
    records = None
    search = None
    if gap is not None:
        search = GapSearch.of(
            standing(first, second),
            models[2],
            gap,
            case.wanted.confidence,
            _finite_motion(case),
            motion["paths"],
        )
    parts = ProgressOfParts.of(case, progress)
    risky = _simulated_risk(case, models, parts.risk)
    simulated = separation(
        *models,
        **motion,
        codes=of_codes(case) | {"numbers": case.wanted.numbers.more},
        records=dict(case.site.records) or None,
        progress=parts.separation,
    )
    if scattered:
        simulated = _with_scatter(simulated, models, motion, parts.scatter)
    if search is not None:
        existing = search.limits(simulated.separation_samples, parts.existing)
    table = with_applied_codes(case, simulated)
    answer = float(table.gap[0])
    risk = None if risky is None else _risk_table(risky, case, answer)
    if case.uncertain:
        slow = any(
            building.has_storeys and building.name in case.uncertain for building in case.buildings
        )
        few = min(case.simulated.motions, FEW_PATHS if slow else USUAL_PATHS)
        options = motion | {"paths": few, "progress": parts.sensitivity}
        matters = sensitivity(*models, **options)
    if len(case.site.records) > MOST_RECORDS:
        records = over_records(case, table.record_separation, answer)
    return CaseAnswer(
        case=simulated_as(case, table),
        separation=table,
        existing=existing,
        spectrum=_spectrum(case),
        shaking=shaking_of(case),
        over_records=records,
        risk=risk,
        matters=matters,
    )


def _with_scatter(
    simulated: xr.Dataset, models: Any, motion: dict[str, Any], progress: Progress | None
) -> xr.Dataset:
    """The table with the gap that is needed if motions also scatter as earthquakes do.

    The same motions are simulated with a factor each, for what yields is not in proportion to them.
    """
    paths = int(simulated.attrs["paths"])
    options = motion | {"scatter": SCATTER_OF_SPECTRUM.scatter, "paths": paths}
    table = separation(*models, **options, progress=progress).sel(rule="simulation", drop=True)
    name = f"gap, with the scatter of {SCATTER_OF_SPECTRUM.scatter:g} between earthquakes"
    columns = {
        f"{WITH_SCATTER}{end}": table[f"gap{end}"]
        .reset_coords(drop=True)
        .assign_attrs(long_name=name)
        for end in labels.VALUE_AND_ENDS
    }
    return simulated.assign(columns)


def _spectrum(case: Case) -> xr.Dataset:
    """Response spectrum of the motions beside the target or record; empty if there is neither."""
    options: Any = {"paths": SPECTRUM_PATHS, "seed": case.simulated.seed}
    motion = case.site.course[:2]
    if case.site.spectrum is not None:
        return simulated_spectrum(case.site.ground, case.site.spectrum, *motion, **options)
    if case.site.name == "fitted":
        compared = periods_of_fit(case.site.course.duration)
        of_record = checked_components(case.site.components).spectrum(compared)
        return compared_spectrum(
            SpectrumMotions(case.site.ground, *motion, **options), compared, of_record
        )
    return xr.Dataset()


def _finite_motion(case: Case) -> FiniteMotion:
    """The simulated motions of a case."""
    course = case.site.course
    return FiniteMotion(course.duration, course.envelope, case.site.scatter, case.simulated.seed)


def _simulated_risk(case: Case, models: Any, progress: Progress | None) -> SimulatedRisk | None:
    """Simulated motions at all intensities of the hazard; None if the case has no hazard."""
    if (hazard := case.site.hazard) is None:
        return None
    first, second, ground = models
    paths = whole_groups(max(FEWEST_PATHS, case.simulated.motions // CASE_MOTIONS_PER_RISK_MOTION))
    with case.site.form.hazard.table.naming(""):
        motion = _finite_motion(case)
        structures = standing(first, second)
        return RiskSimulation(structures, ground, hazard, motion, paths, progress).run()


def _risk_table(simulated: SimulatedRisk, case: Case, answer: float) -> xr.Dataset | None:
    """Risk with the existing gap, the required gap ``answer`` [m] and the gap for the allowed risk.

    Gaps of 0 are left out, since any shaking closes them; None if all are 0. Names of variables
    begin with ``risk_``, so that they can be merged with those of the separation.
    """
    existing = case.wanted.existing[0] if case.wanted.existing else 0.0
    gaps = {"existing": existing, "answer": answer}
    years = YEARS
    target = xr.Dataset()
    if case.wanted.risk is not None:
        years = allowed_rate(case.wanted.risk)[1] or YEARS
        with case.site.form.hazard.table.naming(""):
            target = simulated.gap_of(case.wanted.risk)[list(TARGET_VARIABLES)]
        gaps["target"] = float(target.required_gap)
    gaps = {what: gap for what, gap in gaps.items() if gap > 0}
    if not gaps:
        return None
    risks = [simulated.of_gap(gap, years) for gap in gaps.values()]
    along = labels.axis(RISK_GAP, "gap of which the risk is", np.array(list(gaps.values())), "m")
    table = xr.concat(
        risks, along, data_vars="all", coords="minimal", compat="override", join="exact"
    )
    which = {RISK_OF: (RISK_GAP, list(gaps), {"long_name": "which gap this is"})}
    table = labels.label(table.assign_coords(which).assign(target.data_vars))
    names = {
        name: f"{RISK_PREFIX}{name}" for name in table.variables if name not in (RISK_GAP, RISK_OF)
    }
    hazard = simulated.hazard.describe()
    paths = len(simulated.motions.separation)
    about = {"risk_hazard": hazard, "risk_years": years, "risk_paths": paths}
    return table.rename(names).drop_attrs(deep=False).assign_attrs(about)
