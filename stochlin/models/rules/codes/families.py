"""The families of rules of Valles-Mattox and Reinhorn (1996), whose formulas codes use, too."""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeNumber, CodeRule, Site


def root_of_squares(site: Site) -> Any:
    """Square root of the sum of the squared peaks."""
    return np.hypot(site.peak_1, site.peak_2)


def total(site: Site) -> Any:
    """Sum of the peaks."""
    return site.peak_1 + site.peak_2


def share_of_sum(site: Site) -> Any:
    """The number times the sum of the peaks, or times the peak of one building."""
    return site.number * total(site)


def share_of_height(site: Site) -> Any:
    """The number times the height of the lower building, or of one building."""
    return site.over_peaks(site.number * site.lower_height)


def fixed_distance(site: Site) -> Any:
    """The number itself."""
    return site.over_peaks(site.number)


SRSS = CodeRule(
    name="srss",
    title="SRSS",
    reference="Valles-Mattox and Reinhorn (1996), family of rules",
    mark="P",
    gap_of=root_of_squares,
    family="SRSS",
)
publish(CODE_RULES, SRSS, place=0)

SHARE_OF_SUM = CodeRule(
    name="share_of_sum",
    reference="Valles-Mattox and Reinhorn (1996), family of rules",
    mark="P",
    gap_of=share_of_sum,
    family="sum",
    line="of one building the factor times its own peak",
    number=CodeNumber("factor", usual=1.0),
)
publish(CODE_RULES, SHARE_OF_SUM, place=1)

SHARE_OF_HEIGHT = CodeRule(
    name="share_of_height",
    reference="Valles-Mattox and Reinhorn (1996), family of rules",
    mark="P",
    gap_of=share_of_height,
    family="height",
    assumptions="the peaks are not used",
    needs=("height_1", "height_2"),
    line="of one building the factor times its own height",
    number=CodeNumber("factor"),
)
publish(CODE_RULES, SHARE_OF_HEIGHT, place=11)

FIXED_DISTANCE = CodeRule(
    name="fixed_distance",
    reference="Valles-Mattox and Reinhorn (1996), family of rules",
    mark="P",
    gap_of=fixed_distance,
    family="fixed",
    assumptions="the peaks are not used",
    line="the same distance from a property line",
    number=CodeNumber("distance", units="m"),
)
publish(CODE_RULES, FIXED_DISTANCE, place=12)
