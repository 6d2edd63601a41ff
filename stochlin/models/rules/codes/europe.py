"""The rule of Eurocode 8.

By paragraph (2) buildings of one property keep the root of squares of their displacements, and a
building keeps its own displacement from a property line, so that the gap between two properties is
the sum of both. Paragraph (3) reduces "the above referred distance" by 0.7 for floors at the same
elevations. The text of the code was not seen: the reduction is taken within one property only.
"""

from __future__ import annotations

from typing import Any

from stochlin.models.rules import publish
from stochlin.models.rules.codes import ALIGNED, CODE_RULES, SUM_OF_DISTANCES, CodeRule, Site
from stochlin.models.rules.codes.families import root_of_squares


def eurocode_8(site: Site) -> Any:
    """Root of squares, reduced for floors that align."""
    return site.if_aligned(0.7) * root_of_squares(site)


EUROCODE_8 = CodeRule(
    name="eurocode_8",
    title="Eurocode 8",
    reference="EN 1998-1:2004, 4.4.2.7",
    mark="M high",
    gap_of=eurocode_8,
    family="SRSS",
    between="sum",
    assumptions="peaks are design displacements, behaviour factor times elastic",
    of_pairs=(SUM_OF_DISTANCES, ALIGNED),
    line="from a property line a building keeps its own displacement",
    multiplies="behaviour",
    countries=(
        "Europe",
        "Austria",
        "Bulgaria",
        "Croatia",
        "Cyprus",
        "Czechia",
        "France",
        "Germany",
        "Greece",
        "Hungary",
        "Portugal",
        "Slovakia",
        "Slovenia",
    ),
    called={"behaviour": "behaviour factor q", "importance": "importance factor, within ag"},
)
publish(CODE_RULES, EUROCODE_8, place=4)
