"""The rules of Italy: NTC 2008 and 2018.

The larger of the sum of the peaks and h/100 ag S/(0.5 g). h is the height of the points that face
each other, here that of the lower building, and the factor ag S/(0.5 g) is 1 at most. The peaks are
those of the life-safety limit state (SLV). The estimate of a displacement without calculation is
not included. The edition of 2018 writes h/100 (2 ag S/g), which is the same.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from scipy.constants import g

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeRule, Site
from stochlin.models.rules.codes.families import total


def italy(site: Site) -> Any:
    """The larger of the sum of the peaks and the share of the height by acceleration."""
    least = site.lower_height / 100 * np.minimum(site.design_pga / (0.5 * g), 1.0)
    return np.maximum(total(site), least)


NTC_2008 = CodeRule(
    name="ntc_2008",
    title="NTC 2008",
    reference="NTC 2008, Italy, 7.2.2",
    mark="S",
    gap_of=italy,
    family="sum",
    assumptions="peaks are displacements of the limit state SLV, mu_d times elastic (7.3.3.3)",
    needs=("height_1", "height_2", "design_pga"),
    multiplies="deflection",
    called={
        "behaviour": "behaviour factor q",
        "deflection": "mu_d: q, or 1 + (q - 1) TC/T1 for T1 < TC",
    },
)
NTC_2018 = replace(
    NTC_2008,
    name="ntc_2018",
    title="NTC 2018",
    reference="NTC 2018, Italy, 7.2.1",
    countries=("Italy",),
)

publish(CODE_RULES, NTC_2008, place=17)
publish(CODE_RULES, NTC_2018, place=18)
