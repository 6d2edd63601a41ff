"""The two buildings of a case for the explorer: periods, a changed period, arguments of analyses."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from stochlin.analyses.cases.case import Case
from stochlin.analyses.linearization.strength import reduction_factor, strength_in_metres
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.rules.codes import Neighbours
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure, elastic_period, tuned


def structures_of(case: Case) -> tuple[AnyStructure, AnyStructure]:
    """Both buildings; the first one is on the left."""
    first, second = case.pair
    return first.structure, second.structure


def has_storeys(case: Case) -> bool:
    """Whether at least one building is described by storeys."""
    return any(isinstance(structure, MultistoreyBuilding) for structure in structures_of(case))


def elastic_periods(case: Case) -> tuple[float, float]:
    """Periods of both buildings [s]."""
    first, second = structures_of(case)
    return elastic_period(first), elastic_period(second)


def ratio_of(case: Case) -> float:
    """Ratio of the periods, T2/T1."""
    period_1, period_2 = elastic_periods(case)
    return period_2 / period_1


def with_period(structure: AnyStructure, period: Any) -> AnyStructure:
    """The structure with another period [s]; storeys keep their yield shears."""
    if isinstance(structure, Structure):
        return replace(structure, period=period)
    return tuned(structure, period)


def equivalent_strength(case: Case, number: int) -> tuple[str, float]:
    """Key and value that give oscillator 1 or 2 the same strength in the other way.

    It is the yield displacement [m] if the strength is given as a reduction factor, and vice versa.
    """
    structure: Any = structures_of(case)[number - 1]
    if isinstance(structure, MultistoreyBuilding) or not structure.yields:
        raise ValueError(f"building {number} is no oscillator that yields")
    if structure.reduction_factor is None:
        return "reduction_factor", float(reduction_factor(structure, case.ground).reduction_factor)
    in_metres = strength_in_metres(structure, case.ground)
    return "yield_displacement", float(in_metres.yield_displacement)


def motion_of(case: Case) -> dict[str, Any]:
    """Duration, envelope, confidence and scatter, as keyword arguments of the analyses."""
    names = ("duration", "envelope", "confidence", "scatter")
    return {name: getattr(case, name) for name in names}


def neighbours_of(case: Case) -> Neighbours:
    """What both buildings have in common."""
    return Neighbours(case.floors_align, case.same_property, case.same_system)


def gap_of(case: Case) -> float:
    """The existing gap [m]."""
    if case.gap is None:
        raise ValueError(f'{case.file}: separation.existing is missing; write existing = "5 cm"')
    return case.gap


def heights_of(case: Case) -> tuple[float | None, float | None]:
    """Heights of both buildings [m], as far as they are known."""
    first, second = case.pair
    return first.height, second.height


def for_codes(case: Case) -> dict[str, Any]:
    """Arguments for rules of building codes; heights only of buildings without storeys."""
    heights = [
        None if isinstance(building.structure, MultistoreyBuilding) else building.height
        for building in case.pair
    ]
    return {
        "height_1": heights[0],
        "height_2": heights[1],
        **vars(neighbours_of(case)),
        **case.of_codes,
        "numbers": case.numbers,
    }
