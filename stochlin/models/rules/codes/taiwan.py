"""The rule of Taiwan: 0.6 times the sum of the peaks."""

from __future__ import annotations

from typing import Any

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeRule, Site
from stochlin.models.rules.codes.families import total


def taiwan(site: Site) -> Any:
    """0.6 times the sum of the peaks."""
    return 0.6 * total(site)


TAIWAN = CodeRule(
    name="taiwan",
    title="Taiwan",
    reference="Seismic design specifications for buildings, Taiwan",
    mark="S",
    gap_of=taiwan,
    family="sum",
    assumptions="peaks are 1.4 alpha_y Ra times the displacements under design forces",
    multiplies="deflection",
    countries=("Taiwan",),
    called={
        "behaviour": "1.4 alpha_y Fu, by which forces are less",
        "deflection": "1.4 alpha_y Ra",
    },
)
publish(CODE_RULES, TAIWAN, place=8)
