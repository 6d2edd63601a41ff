"""Building codes as an engineer applies them: displacements of a design times its factors."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.case import factors_of
from stochlin.applications.cases.rows import of_codes, one_or_two
from stochlin.applications.separation.code_gaps import Rule, code_row, rules_with
from stochlin.applications.separation.separation import (
    COMMENT_ON_CODES,
    gaps_by_height,
    judged_rules,
)
from stochlin.applications.separation.storeys import site_with_storeys
from stochlin.applications.sites.design_spectra import reduced_eurocode_8
from stochlin.applications.sites.spectra import interpolated
from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.codes import BEHAVIOUR, IMPORTANCE, CodeRule, Site
from stochlin.models.systems import assembly_of
from stochlin.solver.simulation.structures_in_motion import at_height
from stochlin.solver.tables import labels

if TYPE_CHECKING:
    from stochlin.applications.cases.reading.buildings import Building
    from stochlin.applications.cases.reading.case import Case

APPLIED = "_applied"  # end of the names of such rules
KIND = "applied"  # of such rules
APPLY = (
    "A code as you apply it: displacements under design forces times its factors, combined as it "
    "asks."
)
GIVEN_DISPLACEMENTS = "given"
BY_SPECTRUM = "by the first mode under the design spectrum"
EC8 = "eurocode_8"  # name of its rule and of its spectrum
LIMITED = (
    "that of 3.2.2.5, and q times its displacement at most that of the elastic spectrum (4.3.4)"
)


def with_applied_codes(case: Case, table: xr.Dataset) -> xr.Dataset:
    """The separation of a case with a row more for each code as its engineer applies it.

    A code that takes no displacements has its row already.
    """
    rules_by_name = {code.name: code for code in rules_with(case.wanted.numbers.more)}
    codes = [rules_by_name[name] for name in case.codes if rules_by_name[name].multiplies]
    rules = [_applied(case, code, table) for code in codes]
    if not rules:
        return table
    required = float(table.gap[0])
    applied = judged_rules(rules, table.separation_samples, case.wanted.confidence, required)
    applied = applied.assign_coords(kind=("rule", [KIND] * len(rules)))
    if "height" in table.dims:
        applied = applied.merge(gaps_by_height([rule.gaps for rule in rules], table.height.values))
    whole = xr.concat(
        [table, applied], "rule", data_vars="minimal", coords="minimal", compat="override"
    )
    whole = labels.label(whole)
    return whole.assign_attrs(comment=f"{APPLY} {COMMENT_ON_CODES}")


def _applied(case: Case, rule: CodeRule, table: xr.Dataset) -> Rule:
    """A code as the engineer applies it, at each height at which the buildings could meet."""
    buildings = one_or_two(case)
    heights = np.atleast_1d(table.get("height", np.nan))
    name = f"{rule.name}{APPLIED}"
    nothing = np.full(heights.size, np.nan)
    for building in buildings:
        if lacking := _beyond(case, building):
            return Rule(name, "code", nothing, missing=f"{building.name} lacks {lacking}")
    structures = [building.structure for building in buildings]
    system = assembly_of(structures)
    site = Site(0.0, None if case.alone else 0.0, **of_codes(case))
    if any(building.has_storeys for building in buildings):
        site = site_with_storeys(site, structures)
        site = site.with_arrays({f"height_{n}": heights for n, _ in enumerate(buildings, start=1)})
    floors = np.concatenate([design_displacements(case, building, rule) for building in buildings])
    arrays: dict[str, Any] = {}
    for n, building in enumerate(buildings, start=1):
        factors = factors_of(building)
        arrays[f"peak_{n}"] = np.array([at_height(system, n - 1, z) @ floors for z in heights])
        arrays[f"importance_{n}"] = factors.get(IMPORTANCE)
        # The behaviour factor has no effect on displacements of the spectrum that it divides first.
        arrays[f"{rule.multiplies}_{n}"] = factors.get(rule.multiplies, 1.0)
    row = code_row(rule, site.with_arrays(arrays))
    return replace(row, name=name, assumptions=f"{row.assumptions}; {stated(case, rule)}")


def design_displacements(case: Case, building: Building, rule: CodeRule) -> Array:
    """Displacements of the floors of a building under the design forces of a code [m].

    They are those of the file, or those of the first mode under the spectrum of the site, reduced
    by the behaviour factor. By Eurocode 8 they are those of its design spectrum, but ``q`` times
    them is not taken above the displacement of the elastic spectrum, as 4.3.4 allows.
    """
    if building.form.displacements:
        return np.array(building.form.displacements)
    mode = building.structure.first_mode()
    spectrum = case.site.spectrum
    assert spectrum is not None
    period = float(mode.arrays()["period"])
    at = interpolated(spectrum.period.values, spectrum.values, np.array([period]))
    shape = building.structure.first_mode_moves().values if building.has_storeys else np.ones(1)
    behaviour = factors_of(building).get(BEHAVIOUR, 1.0)
    importance = factors_of(building).get(IMPORTANCE, 1.0)
    # A code that divides displacements by the importance factor has multiplied the forces by it.
    forces = (importance if rule.over_importance else 1.0) / behaviour
    displacements: Array = shape * at * (period / (2 * np.pi)) ** 2 * forces
    if _reduces(case, building, rule):
        reduced = reduced_eurocode_8(spectrum, period, behaviour)
        displacements *= min(1.0, behaviour * reduced / at[0])
    return displacements


def _reduces(case: Case, building: Building, rule: CodeRule) -> bool:
    """Whether the design spectrum of Eurocode 8 is used, with a known behaviour factor."""
    code = "" if case.site.spectrum is None else case.site.spectrum.attrs.get("code")
    by_spectrum = not building.form.displacements and BEHAVIOUR in factors_of(building)
    return by_spectrum and rule.name == EC8 == code


def stated(case: Case, rule: CodeRule) -> str:
    """The displacements of the buildings and the factors of the code, in words."""
    buildings = one_or_two(case)
    where = (
        GIVEN_DISPLACEMENTS if building.form.displacements else BY_SPECTRUM
        for building in buildings
    )
    sentences = [f"displacements {' and '.join(dict.fromkeys(where))}"]
    if any(_reduces(case, building, rule) for building in buildings):
        sentences.append(LIMITED)
    for name in (rule.multiplies, *([IMPORTANCE] if rule.over_importance else [])):
        factors = (f"{factors_of(building).get(name, 1.0):g}" for building in buildings)
        sentences.append(f"{rule.called[name]}: {' and '.join(factors)}")
    return "; ".join(sentences)


def _beyond(case: Case, building: Building) -> str:
    """Why the site's spectrum has no value for a building; empty if it has, or is not needed."""
    if building.form.displacements or case.site.spectrum is None:
        return ""
    period = case.site.spectrum.period.values
    shortest, longest = period[period > 0][[0, -1]]
    if shortest <= building.period <= longest:
        return ""
    within = f"the design spectrum, {shortest:.3g} to {longest:.3g} s"
    return f"displacements: its period of {building.period:.3g} s is not in {within}"
