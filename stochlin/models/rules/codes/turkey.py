"""The rule of Turkey, TBDY 2018.

The larger of alpha times the root of squares and a least joint by height. By 4.9.3.1 alpha is 0.25
R/I if the floors of all storeys are level and 0.5 R/I if not, and the displacements are reduced
ones; here each is multiplied by R/I of its own building. By 4.9.3.2 the joint is at least 30 mm up
to a height of 6 m, and 10 mm more for every 3 m above; heights between count in proportion.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import ALIGNED, CODE_RULES, CodeRule, Site
from stochlin.models.rules.codes.families import root_of_squares


def turkey(site: Site) -> Any:
    """The larger of the reduced root of squares and the joint by height."""
    least = 0.03 + 0.01 * np.maximum(site.lower_height - 6.0, 0.0) / 3.0
    return np.maximum(0.5 * site.if_aligned(0.5) * root_of_squares(site), least)


TBDY_2018 = CodeRule(
    name="tbdy_2018",
    title="TBDY 2018",
    reference="TBDY 2018, Turkey, 4.9.3",
    mark="S",
    gap_of=turkey,
    family="SRSS",
    assumptions="peaks are reduced displacements times R/I",
    of_pairs=(ALIGNED,),
    needs=("height_1", "height_2"),
    multiplies="behaviour",
    over_importance=True,
    countries=("Turkey", "Türkiye"),
    called={"behaviour": "behaviour factor R", "importance": "importance factor I"},
)
publish(CODE_RULES, TBDY_2018, place=16)
