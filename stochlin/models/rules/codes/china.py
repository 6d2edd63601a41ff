"""The rule of China, GB 50011.

Concrete frames: 100 mm, and 20 mm for every `step` of the lower building above 15 m: 3 m for
intensity 8, and 5, 4 and 2 m for intensities 6, 7 and 9. Heights between multiples of the step
count in proportion. Without heights the lower building is taken to have at most 15 m.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeNumber, CodeRule, Site


def china(site: Site) -> Any:
    """100 mm, and 20 mm for each step of the lower building above 15 m."""
    both = site.height_1 is not None and site.height_2 is not None
    beyond = np.maximum(site.lower_height - 15.0, 0.0) if both else 0.0
    return site.over_peaks(0.1 + 0.02 * beyond / site.number)


CHINA_GB_50011 = CodeRule(
    name="china_gb_50011",
    title="China GB 50011",
    reference="GB 50011-2010, 6.1.4",
    mark="S",
    gap_of=china,
    family="fixed",
    assumptions=(
        "concrete frames, intensity 8, up to 15 m where no height is given; the peaks are not used"
    ),
    countries=("China",),
    number=CodeNumber("step", units="m", usual=3.0),
)
publish(CODE_RULES, CHINA_GB_50011, place=15)
