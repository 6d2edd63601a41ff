"""Separation between two buildings: what a rule is, and the four families of rules in the paper.

The peaks are the displacements that the code means by its own word, at the level where the
buildings could meet; each rule says which in ``assumptions``. Marks: S, seen in a copy of the source;
P, printed in Valles-Mattox and Reinhorn (1996); M, from memory, not compared with the source.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.models.parameters import Model, Parameter, Range, parameter

NOT_NEGATIVE = Range(include_lower=True)
ZONES: Mapping[str, float] = {"I": 0.001, "II": 0.003, "III": 0.006}  # share of the height, Mexico City
INELASTIC = "peaks are largest displacements, inelastic where the structure yields"


@dataclass(frozen=True)
class PeakPair(Model):
    """Peak displacements of two buildings, and their heights where a rule needs them."""

    peak_1: Parameter = parameter("m", "peak displacement, structure 1", NOT_NEGATIVE)
    peak_2: Parameter = parameter("m", "peak displacement, structure 2", NOT_NEGATIVE)
    height_1: Parameter | None = parameter("m", "height, structure 1", Range(), None)
    height_2: Parameter | None = parameter("m", "height, structure 2", Range(), None)


@dataclass(frozen=True)
class CodeRule:
    """Base of the rules."""

    name: ClassVar[str]
    reference: ClassVar[str]
    mark: ClassVar[str]
    assumptions: ClassVar[str] = INELASTIC
    needs: ClassVar[tuple[str, ...]] = ()  # arguments of `gap` beyond the peaks

    def gap(
        self,
        peak_1: Any,
        peak_2: Any,
        height_1: Any = None,
        height_2: Any = None,
        floors_align: bool = False,
        zone: str | None = None,
    ) -> Any:
        """Required separation [m].

        Parameters
        ----------
        peak_1, peak_2 : float or array
            Peak displacements [m] as the rule means them.
        height_1, height_2 : float or array, optional
            Heights of the two buildings [m].
        floors_align : bool
            Whether the floors of the buildings are at the same levels.
        zone : str, optional
            ``"I"``, ``"II"`` or ``"III"``, of Mexico City.

        Raises
        ------
        ValueError
            If something that the rule needs is not given, or the zone is unknown.
        """
        given = {"height_1": height_1, "height_2": height_2, "zone": zone}
        missing = [name for name in self.needs if given[name] is None]
        if missing:
            raise ValueError(
                f"{self.name} needs {', '.join(missing)}, which is not given; allowed: heights "
                f"[m], zone one of {', '.join(ZONES)}"
            )
        check_zone(zone)
        return self._gap(Site(peak_1, peak_2, height_1, height_2, floors_align, zone))

    def _gap(self, site: Site) -> Any:
        raise NotImplementedError


@dataclass(frozen=True)
class Site:
    """What is known of a pair of buildings."""

    peak_1: Any
    peak_2: Any
    height_1: Any
    height_2: Any
    floors_align: bool
    zone: str | None

    @property
    def root_of_squares(self) -> Any:
        """Square root of the sum of the squared peaks."""
        return np.hypot(self.peak_1, self.peak_2)

    @property
    def total(self) -> Any:
        """Sum of the peaks."""
        return self.peak_1 + self.peak_2

    @property
    def lower_height(self) -> Any:
        """Height at which the roof of the lower building meets the other."""
        return np.minimum(self.height_1, self.height_2)

    def if_aligned(self, factor: float) -> float:
        """The factor if floors align, else one."""
        return factor if self.floors_align else 1.0


def check_zone(zone: str | None) -> None:
    """Raise a ValueError for a zone that is not one."""
    if zone is not None and zone not in ZONES:
        raise ValueError(f"zone = {zone!r} is not known; allowed: {', '.join(ZONES)}")


@dataclass(frozen=True)
class SquareRoot(CodeRule):
    """Square root of the sum of squares, of the paper's four families."""

    name: ClassVar[str] = "srss"
    reference: ClassVar[str] = "Valles-Mattox and Reinhorn (1996), family of rules"
    mark: ClassVar[str] = "P"

    def _gap(self, site: Site) -> Any:
        return site.root_of_squares


@dataclass(frozen=True)
class ShareOfSum(CodeRule):
    """A factor times the sum of displacements, of the paper's four families; 1 unless told."""

    factor: float = 1.0

    name: ClassVar[str] = "share_of_sum"
    reference: ClassVar[str] = "Valles-Mattox and Reinhorn (1996), family of rules"
    mark: ClassVar[str] = "P"

    def __post_init__(self) -> None:
        _check_positive(self, "factor")

    def _gap(self, site: Site) -> Any:
        return self.factor * site.total


@dataclass(frozen=True)
class ShareOfHeight(CodeRule):
    """A factor times the lower building's height, of the paper's four families."""

    factor: float

    name: ClassVar[str] = "share_of_height"
    reference: ClassVar[str] = "Valles-Mattox and Reinhorn (1996), family of rules"
    mark: ClassVar[str] = "P"
    assumptions: ClassVar[str] = "the peaks are not used"
    needs: ClassVar[tuple[str, ...]] = ("height_1", "height_2")

    def __post_init__(self) -> None:
        _check_positive(self, "factor")

    def _gap(self, site: Site) -> Any:
        return self.factor * site.lower_height + 0 * site.total


@dataclass(frozen=True)
class FixedDistance(CodeRule):
    """A fixed distance [m], of the paper's four families."""

    distance: float

    name: ClassVar[str] = "fixed_distance"
    reference: ClassVar[str] = "Valles-Mattox and Reinhorn (1996), family of rules"
    mark: ClassVar[str] = "P"
    assumptions: ClassVar[str] = "the peaks are not used"

    def __post_init__(self) -> None:
        _check_positive(self, "distance")

    def _gap(self, site: Site) -> Any:
        return self.distance + 0 * site.total


def _check_positive(rule: CodeRule, name: str) -> None:
    value = getattr(rule, name)
    if not 0 < value < np.inf:
        raise ValueError(f"{rule.name}: {name} = {value!r}; allowed: a positive number")
