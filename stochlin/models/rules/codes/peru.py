"""The rules of Peru: E.030 of 2018, and as of 2026.

Within one property the gap is the larger of s and 2/3 of the sum of the peaks. s is the larger of
0.006 h and 30 mm; h is the height of the level where the distance is checked: here the lower
building's height (33.2). From a property line it is the larger of 2/3 of the peak and half of s for
the building's own height (33.3), which suffices if the neighbour keeps its part. The gap between
two properties is the sum of both distances (33.4).

That of 2026 has a least joint of 0.02 Z S h in place of 0.006 h. The number is Z S, zone factor
times soil factor. The text was not compared; what it does not change is taken from the edition of
2018.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, SUM_OF_DISTANCES, CodeNumber, CodeRule, Site
from stochlin.models.rules.codes.families import total


def joint(site: Site, height: Any) -> Any:
    """The least joint for a height: 0.006 of it, or as of 2026 0.02 Z S, and 30 mm."""
    return np.maximum((0.006 if site.number is None else 0.02 * site.number) * height, 0.03)


def peru_line(site: Site) -> Any:
    """Of one building the larger of 2/3 of its peak and half of the joint by its height."""
    return np.maximum(joint(site, site.height_1) / 2, site.peak_1 * (2 / 3))


def peru(site: Site) -> Any:
    """Within one property the larger of 2/3 of the peaks and the joint by the lower height."""
    return np.maximum(joint(site, site.lower_height), total(site) * (2 / 3))


E030 = CodeRule(
    name="peru_e030",
    title="Peru E.030",
    reference="Norma E.030 (2018), Peru, article 33",
    mark="S",
    gap_of=peru,
    line_of=peru_line,
    family="sum",
    between="sum",
    of_pairs=(SUM_OF_DISTANCES,),
    needs=("height_1", "height_2"),
    line="a building keeps 2/3 of its own displacement and half of the joint for its own height",
    multiplies="deflection",
    countries=("Peru",),
    called={"behaviour": "reduction R", "deflection": "0.75 R, or 0.85 R if irregular"},
)
E030_OF_2026 = replace(
    E030,
    name="peru_e030_2026",
    title="Peru E.030 (2026)",
    reference="Norma E.030 as of 2026, Peru",
    mark="M",
    countries=(),
    number=CodeNumber("zone_and_soil"),
)

publish(CODE_RULES, E030, place=9)
publish(CODE_RULES, E030_OF_2026, place=10)
