"""The rules of Mexico City: NTC-Sismo, 1.10.

From the boundary a building keeps the larger of D + c h and 50 mm: D is the peak displacement, h
the height, and c a share by zone. Between two buildings the gap is the sum of both distances; the
code allows half of it if both bodies have "la misma altura y estructuración" and their slabs are at
the same height in all storeys. The edition of 2023, which has other zones, was not seen.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, ZONES, CodeRule, Site

SIMPLIFIED = {"I": 0.007, "II": 0.009, "III": 0.012}  # share of the height by zone
HALF_IF_SIMILAR = (
    "half for the same height, structural system and slab levels, which accepts contact of slabs"
)


def mexico_city_line(site: Site) -> Any:
    """Of one building its peak and a share of its height by zone, 50 mm at least."""
    assert site.zone is not None  # which the rule needs
    return np.maximum(site.peak_1 + ZONES[site.zone] * site.height_1, 0.05)


def mexico_city_simplified_line(site: Site) -> Any:
    """Of one building a share of its height by zone, 50 mm at least."""
    return np.maximum(SIMPLIFIED[str(site.zone)] * site.height_1, 0.05) + 0 * site.peak_1


MEXICO_CITY = CodeRule(
    name="mexico_city",
    title="Mexico City",
    reference="NTC-Sismo, Mexico City, 1.10",
    mark="S",
    line_of=mexico_city_line,
    family="sum",
    half_if_alike=True,
    of_pairs=(HALF_IF_SIMILAR,),
    needs=("height_1", "height_2", "zone"),
    line=(
        "a building keeps its displacement and a share of its height from its own "
        "boundary, 50 mm at least"
    ),
    multiplies="behaviour",
    countries=("Mexico",),
    called={"behaviour": "seismic behaviour factor Q"},
)
publish(CODE_RULES, MEXICO_CITY, place=6)

MEXICO_CITY_SIMPLIFIED = CodeRule(
    name="mexico_city_simplified",
    title="Mexico City, simplified",
    reference="NTC-Sismo, Mexico City, 1.10, simplified method",
    mark="S",
    line_of=mexico_city_simplified_line,
    family="height",
    half_if_alike=True,
    assumptions="the peaks are not used: the simplified method has none",
    of_pairs=(HALF_IF_SIMILAR,),
    needs=("height_1", "height_2", "zone"),
    line="a building keeps a share of its height from its own boundary, 50 mm at least",
)
publish(CODE_RULES, MEXICO_CITY_SIMPLIFIED, place=14)
