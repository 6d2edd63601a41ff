"""The subject of an answer: two buildings and the gap between them, or one and its property line."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case


class Subject(NamedTuple):
    """The words that differ; ``{gap}`` stands for a length."""

    page: str  # title
    gap: str  # what is asked
    stand: str  # what the answer requires
    keeping: str  # what a sufficient gap does
    the_buildings: str
    column: str  # of the share of motions in which it is enough
    good: str  # motions in which it is
    meet: str  # what is not wanted


PAIR = Subject(
    page="the gap between two buildings",
    gap="gap",
    stand="should stand {gap} apart",
    keeping="keeps them apart",
    the_buildings="the buildings",
    column="apart",
    good="motions without pounding",
    meet="they pound",
)
ALONE = Subject(
    page="the set-back from the property line",
    gap="set-back",
    stand="should stand {gap} away from its property line",
    keeping="keeps it on its side of the line",
    the_buildings="the building",
    column="inside",
    good="motions inside the line",
    meet="it crosses its property line",
)


def subject_of(case: Case) -> Subject:
    """The subject of the answer to a case."""
    return ALONE if case.alone else PAIR


def gap_of(dataset: xr.Dataset) -> str:
    """A gap or a set-back, of a table that `stochlin.separation` returned."""
    return PAIR.gap if "peak_2" in dataset else ALONE.gap
