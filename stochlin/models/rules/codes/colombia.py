"""The rule of Colombia, NSR-10.

A new building keeps a share of its height from its boundary, by table A.6.5-1. Beside a neighbour
that has left no joint it is 0.02 above three storeys if the floors are level; if not, 0.01 for
three storeys and 0.03 above. Beside an empty plot, or a neighbour with its joint, it is 0.01 above
three storeys. Of two buildings the one that keeps more is taken as the new one. Zones of low hazard
need no joint, and parts of one building keep the sum of their displacements (A.6.5.1).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeRule, Site

BESIDE = "the neighbour stands on the boundary and has left no joint"


def beside(site: Site) -> Any:
    """What building 1 keeps beside a neighbour that stands on the boundary."""
    three, more = (0.0, 0.02) if site.floors_align else (0.01, 0.03)
    share = three * (site.storeys_1 == 3) + more * (site.storeys_1 > 3)
    return share * site.height_1


def colombia(site: Site) -> Any:
    """What the building keeps that keeps more, by height and storeys."""
    return site.over_peaks(np.maximum(beside(site), beside(site.mirrored())))


def colombia_line(site: Site) -> Any:
    """What one building keeps beside an empty plot."""
    return 0.01 * (site.storeys_1 > 3) * site.height_1 + 0 * site.peak_1


NSR_10 = CodeRule(
    name="nsr_10",
    title="NSR-10",
    reference="NSR-10, Colombia, A.6.5.2",
    mark="S",
    gap_of=colombia,
    line_of=colombia_line,
    family="height",
    assumptions="the peaks are not used",
    of_pairs=(BESIDE,),
    needs=("height_1", "height_2", "storeys_1", "storeys_2"),
    line="beside an empty plot a building of more than three storeys keeps 0.01 of its height",
    countries=("Colombia",),
)
publish(CODE_RULES, NSR_10, place=20)
