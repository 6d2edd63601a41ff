"""The four families of separation rules in the paper, which building codes use."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, ClassVar

import numpy as np

from stochlin.messages import brief
from stochlin.models.rules.codes import CODE_RULES, FIXED, HEIGHT, SRSS, SUM, CodeRule, Site
from stochlin.models.rules.published import published

PAPER = "Valles-Mattox and Reinhorn (1996), family of rules"
NO_PEAKS = "the peaks are not used"


@published(CODE_RULES, "srss", PAPER, "P", 1)
class SquareRoot(CodeRule):
    """Square root of the sum of the squared peaks."""

    family = SRSS

    def of_site(self, site: Site) -> Any:
        return site.root_of_squares


class Numbered(CodeRule):
    """A rule with a number, which is a field of the class."""

    units: ClassVar[str] = "1"  # unit of the number

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not 0 < value < np.inf:
                raise ValueError(
                    f"{self.name}: {field.name} = {brief(value)}; allowed: a positive number"
                )


@published(CODE_RULES, "share_of_sum", PAPER, "P", 2)
@dataclass(frozen=True)
class ShareOfSum(Numbered):
    """A factor, by default 1, times the sum of the peaks, or times the peak of one building."""

    family = SUM
    line = "of one building the factor times its own peak"

    factor: float = 1.0

    def of_site(self, site: Site) -> Any:
        return self.factor * site.total


OF_HEIGHT = ("height_1", "height_2")


@published(CODE_RULES, "share_of_height", PAPER, "P", 11)
@dataclass(frozen=True)
class ShareOfHeight(Numbered):
    """A factor times the height of the lower building, or times the height of one building."""

    assumptions = NO_PEAKS
    family = HEIGHT
    needs = OF_HEIGHT
    line = "of one building the factor times its own height"

    factor: float

    def of_site(self, site: Site) -> Any:
        return self.factor * site.lower_height + 0 * site.total


@published(CODE_RULES, "fixed_distance", PAPER, "P", 12)
@dataclass(frozen=True)
class FixedDistance(Numbered):
    """A fixed distance [m]."""

    assumptions = NO_PEAKS
    family = FIXED
    line = "the same distance from a property line"
    units = "m"

    distance: float

    def of_site(self, site: Site) -> Any:
        return self.distance + 0 * site.total
