"""The subject of an answer: two buildings and the gap between them, or one and its property line."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

    from stochlin.analyses.cases.reading.case import Case


class Subject(NamedTuple):
    """The words that differ; ``{gap}`` stands for a length."""

    page: str  # title
    gap: str  # what is asked
    stand: str  # what one does or both do, by the answer
    keeping: str
    they: str
    the_buildings: str
    column: str  # of the share of motions in which it is enough
    good: str  # motions in which it is
    share: str  # of a rule, what that share is of
    would: str  # of any gap
    rules: str  # that are told
    records: str  # what a set-back in a record is of
    meet: str  # what is not wanted
    met: str
    labels: Mapping[str, str]  # of rules that have another name here


PAIR = Subject(
    page="the gap between two buildings",
    gap="gap",
    stand="should stand {gap} apart",
    keeping="keeps them apart",
    they="they",
    the_buildings="the buildings",
    column="apart",
    good="motions without pounding",
    share="the rule's gap prevents pounding",
    would="a gap would have kept the buildings apart",
    rules="",
    records="",
    meet="they pound",
    met="they pounded",
    labels={},
)
ALONE = Subject(
    page="the set-back from the property line",
    gap="set-back",
    stand="should stand {gap} away from its property line",
    keeping="keeps it on its side of the line",
    they="it",
    the_buildings="the building",
    column="inside",
    good="motions inside the line",
    share="the building, with the rule's set-back, stays on its side of the line",
    would="a set-back would have kept the building on its side of the line",
    rules="Rules without a known provision for property lines are left out.",
    records="The line is on the side of positive displacements; on the other side a record may need "
    "up to the peak.",
    meet="it crosses its property line",
    met="it crossed its property line",
    labels={"share_of_sum": "share of its peak", "share_of_height": "share of its height"},
)


def subject_of(case: Case) -> Subject:
    """The subject of the answer to a case."""
    return ALONE if case.alone else PAIR


def gap_of(dataset: xr.Dataset) -> str:
    """A gap or a set-back, of a table that `stochlin.separation` returned."""
    return PAIR.gap if "peak_2" in dataset else ALONE.gap
