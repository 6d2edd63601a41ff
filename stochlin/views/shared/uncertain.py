"""The uncertain parameters of a case, in words and as a table, for every command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stochlin.models.buildings import RegularBuilding
from stochlin.views.shared.screen import columns, paragraph
from stochlin.views.shared.words import shown_unit, valued

if TYPE_CHECKING:
    from stochlin.analyses.cases.case import Case
    from stochlin.models.uncertain import Uncertain, UncertainModel

HEADS = ("uncertain parameter", "median", "90 % range")
WITHIN = 0.05, 0.95


def unknowns(case: Case) -> list[tuple[str, ...]]:
    """A row for each uncertain parameter."""
    return [
        _row(of, model, name, uncertain)
        for of, model in case.uncertain.items()
        for name, uncertain in model.uncertain.items()
    ]


def contained(case: Case, what: str) -> str:
    """A statement that the answer contains the uncertainty; empty where all is known."""
    if not case.uncertain:
        return ""
    return (
        f"Some parameters are uncertain. Each of the {case.paths} simulated motions has its own sample "
        f"of them, and {what} of motions and samples together. Formulas, and the strength of the "
        "shaking, are given for the medians."
    )


def unknown_lines(case: Case, what: str) -> list[str]:
    """Both for the screen; nothing where all is known."""
    rows = unknowns(case)
    return [*paragraph(contained(case, what)), *columns(HEADS, rows)] if rows else []


def at_medians(case: Case) -> str:
    """A statement that the answer does not contain it; empty where all is known."""
    sentence = "Some parameters are uncertain: here they are taken at their medians."
    return sentence if case.uncertain else ""


def _row(of: str, model: UncertainModel, name: str, uncertain: Uncertain) -> tuple[str, ...]:
    median: Any = model.median()
    regular = "storeys" in model.arguments and name in RegularBuilding.parameter_names()
    kind = RegularBuilding if regular else type(median)
    units, long_name = kind.units(name), kind.__dataclass_fields__[name].metadata["long_name"]
    unit, _ = shown_unit(units)
    low, high = (valued(uncertain.at(share), units, 3).removesuffix(unit) for share in WITHIN)
    return f"{of}, {long_name}", valued(uncertain.median, units), f"{low} to {high}{unit}"
