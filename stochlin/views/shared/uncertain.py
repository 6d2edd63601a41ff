"""The uncertain parameters of a case, in words and as a table, for every command."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from stochlin.models.buildings import RegularBuilding
from stochlin.views.shared.blocks import Block, Table, Text
from stochlin.views.shared.words import valued

if TYPE_CHECKING:
    from stochlin.applications.cases.reading.case import Case
    from stochlin.models.uncertain import Uncertain, UncertainModel

WITHIN = 0.05, 0.95


def contained(case: Case, what: str) -> str:
    """A statement that the answer contains the uncertainty; empty where all is known."""
    if not case.uncertain:
        return ""
    return (
        f"Some parameters are uncertain. Each of the {case.simulated.motions} simulated motions has its "
        f"own sample of them, and {what} of motions and samples together. Formulas, and the strength of "
        "the shaking, are given for the medians."
    )


def unknowns(case: Case, what: str) -> list[Block]:
    """Both this statement and a row for each of them; nothing to show where all is known."""
    rows = [
        _row(of, model, name, uncertain)
        for of, model in case.uncertain.items()
        for name, uncertain in model.uncertain.items()
    ]
    heads = ("uncertain parameter", "median", "90 % range")
    return [Text(contained(case, what)), Table.of(heads, rows)]


def at_medians(case: Case) -> str:
    """A statement that the answer does not contain it; empty where all is known."""
    sentence = "Some parameters are uncertain: here they are taken at their medians."
    return sentence if case.uncertain else ""


def _row(of: str, model: UncertainModel, name: str, uncertain: Uncertain) -> tuple[str, ...]:
    median: Any = model.median()
    regular = "storeys" in model.arguments and name in RegularBuilding.parameter_names()
    kind = RegularBuilding if regular else type(median)
    units, long_name = kind.units(name), kind.__dataclass_fields__[name].metadata["long_name"]
    ends = valued([uncertain.at(share) for share in WITHIN], units, 3).replace(", ", " to ")
    return f"{of}, {long_name}", valued(uncertain.median, units), ends
