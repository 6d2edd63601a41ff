"""The buildings of a case in their row: one or two of them, gaps, floors that meet columns."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.buildings import Building
    from stochlin.applications.cases.reading.case import Case

# m, in place of a gap of 0: any motion towards each other closes it, and formulas hold
TOUCHING = 1e-6


def one_or_two(case: Case) -> tuple[Building, ...]:
    """The two buildings, or one beside its property line; a ValueError if there are more."""
    if len(case.buildings) > 2:
        what = (
            f"describes {len(case.buildings)} buildings; allowed: two, and more by 'stochlin pound'"
        )
        raise case.whole.table.error("", what)
    return case.buildings


def pair_of(case: Case) -> tuple[Building, Building]:
    """The two buildings from left to right; a ValueError if there are more or fewer."""
    buildings = one_or_two(case)
    if len(buildings) == 1:
        what = "is missing; only 'stochlin gap' and 'stochlin pound' accept one building alone"
        raise case.whole.table.error("building_2", what)
    return buildings[0], buildings[1]


def gap_of(case: Case) -> float | None:
    """Existing gap of two buildings, or of one and its property line [m], if the file has it."""
    gaps = case.wanted.existing
    return (gaps[0] or TOUCHING) if one_or_two(case) and gaps else None


def check_masses(case: Case, what: str) -> None:
    """Raise a ValueError, at the building, for one without a mass, on which ``what`` acts."""
    for building in case.described:
        if not building.has_storeys and building.structure.mass is None:
            said = f'is missing: {what} needs it; write it as mass = "800 t"'
            raise building.form.table.error("mass", said)


def motion_of(case: Case) -> dict[str, Any]:
    """Arguments of the functions that describe the simulated motions, by name."""
    return {
        "duration": case.site.course.duration,
        "envelope": case.site.course.envelope,
        "scatter": case.site.scatter,
        "confidence": case.wanted.confidence,
        "paths": case.simulated.paths and case.simulated.motions,
        "seed": case.simulated.seed,
    }


def simulated_as(case: Case, table: xr.Dataset) -> Case:
    """The case with the number of motions of a result."""
    return replace(case, simulated=replace(case.simulated, paths=table.attrs["paths"]))


def of_codes(case: Case) -> dict[str, Any]:
    """What rules of codes ask of the buildings and the site, by the names of `separation`.

    Floors do not align where slabs meet columns. The peak ground acceleration of the design is by
    default that of the spectrum of the site [m/s^2].
    """
    wanted = case.wanted
    facts: dict[str, Any] = {"zone": wanted.zone, "design_pga": wanted.design_pga}
    if wanted.design_pga is None:
        facts["design_pga"] = case.site.pga
    for n, building in enumerate(one_or_two(case), start=1):
        facts |= {f"height_{n}": building.height, f"storeys_{n}": building.storeys}
    if not case.alone:
        facts["floors_align"] = wanted.floors_align and not case.slabs
        facts |= {"same_property": wanted.same_property, "same_system": wanted.same_system}
    return facts
