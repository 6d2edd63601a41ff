"""The rule of Iran, Standard 2800.

From the boundary a building keeps 0.005 of its height, which suffices up to 8 storeys of normal
importance. Above, and for an importance factor above 1, it keeps its nonlinear displacement of the
design, with P-delta, if that is larger; 0.005 of the height is taken as the least distance here,
too. A page on the standard was seen, which does not say how the displacements of two buildings are
combined: they are added.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, SUM_OF_DISTANCES, CodeRule, Site


def iran_line(site: Site) -> Any:
    """Of one building 0.005 of its height, or its peak if it is tall or important."""
    displaced = (site.storeys_1 > 8) | (site.importance > 1)
    return np.maximum(0.005 * site.height_1, displaced * site.peak_1)


IRAN_2800 = CodeRule(
    name="iran_2800",
    title="Standard 2800 of Iran",
    reference="Standard 2800, Iran, fourth edition",
    mark="M high",
    line_of=iran_line,
    family="sum",
    assumptions="peaks are nonlinear displacements with P-delta, Cd times elastic",
    of_pairs=(SUM_OF_DISTANCES,),
    needs=("height_1", "height_2", "storeys_1", "storeys_2"),
    line=(
        "0.005 of the height; above 8 storeys, or if important, its displacement if that is larger"
    ),
    multiplies="deflection",
    countries=("Iran",),
    called={
        "behaviour": "behaviour factor Ru",
        "deflection": "displacement factor Cd",
        "importance": "importance factor I",
    },
)
publish(CODE_RULES, IRAN_2800, place=19)
