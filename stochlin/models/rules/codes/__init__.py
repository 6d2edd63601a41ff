"""Separation between two buildings: as building codes ask for it, and by the four families of the paper.

The peaks are the displacements that the code means by its own word, at the level where the
buildings could meet; each rule says which in ``assumptions``. Some rules also say how far one building
stays away from its property line.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import MISSING, dataclass, fields, replace
from typing import Any, ClassVar

import numpy as np

from stochlin.messages import brief
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Parameter, parameter
from stochlin.models.rules.published import Published, look_up
from stochlin.registry import Registry

ZONES: Mapping[str, float] = {"I": 0.001, "II": 0.003, "III": 0.006}  # share of the height, Mexico City
# The families of the paper, by which a rule gets its gap.
SRSS, SUM, HEIGHT, FIXED = FAMILIES = ("SRSS", "sum", "height", "fixed")
INELASTIC = "peaks are largest displacements, inelastic where the structure yields"
ALIGNED = "the factor for floors that align accepts contact at slab level"
TWO = "a second building: what it says of a property line is not known here"
CODE_RULES: Registry[type[CodeRule]] = Registry("code rule", "stochlin.models.rules.codes")


@dataclass(frozen=True)
class BuildingPeaks(Model):
    """Peak displacements of two buildings, or of one, and their heights where a rule needs them."""

    of_arguments = True

    peak_1: Parameter = parameter("m", "peak displacement, structure 1", NOT_NEGATIVE)
    peak_2: Parameter | None = parameter("m", "peak displacement, structure 2", NOT_NEGATIVE, None)
    height_1: Parameter | None = parameter("m", "height, structure 1", POSITIVE, None)
    height_2: Parameter | None = parameter("m", "height, structure 2", POSITIVE, None)


@dataclass(frozen=True)
class CodeRule(Published):
    """Base of the rules; a number that a rule takes is its field."""

    assumptions: ClassVar[str] = INELASTIC
    family: ClassVar[str] = ""  # one of FAMILIES, that which mostly governs
    needs: ClassVar[tuple[str, ...]] = ()  # arguments of `gap` beyond the peaks
    line: ClassVar[str] = ""  # what it says of one building and its property line, where that is known

    def gap(
        self,
        peak_1: Any,
        peak_2: Any,
        height_1: Any = None,
        height_2: Any = None,
        floors_align: bool = False,
        zone: str | None = None,
    ) -> Any:
        """Required separation [m], for peak displacements [m] as the rule means them.

        Without ``peak_2`` the distance of one building from its property line. Some rules also need the
        heights of the buildings [m], or the zone ``"I"``, ``"II"`` or ``"III"`` of Mexico City: a
        ValueError says what is missing. ``floors_align``: whether the floors of the buildings are at the
        same levels.
        """
        if peak_2 is None and not self.line:
            raise ValueError(f"{self.name} needs {TWO}; give peak_2")
        told = {"height_1": height_1, "height_2": height_2, "zone": zone}
        given = [name for name, value in told.items() if value is not None]
        if missing := self.missing(given, peak_2 is None):
            raise ValueError(
                f"{self.name} needs {', '.join(missing)}, which is not given; allowed: heights "
                f"[m], zone one of {', '.join(ZONES)}"
            )
        check_zone(zone)
        if peak_2 is None:
            return self.from_line(Site(peak_1, 0 * peak_1, height_1, height_1, False, zone))
        return self.of_site(Site(peak_1, peak_2, height_1, height_2, floors_align, zone))

    def missing(self, given: Collection[str], alone: bool) -> list[str]:
        """What it needs beyond the peaks and is not given, for two buildings or for one."""
        if alone and not self.line:
            return [TWO]
        return [name for name in self.needs if name not in given and not (alone and name == "height_2")]

    def of_site(self, site: Site) -> Any:
        """Required separation [m]."""
        raise NotImplementedError

    def from_line(self, site: Site) -> Any:
        """Required distance from a property line [m]: from a neighbour as high, which does not move."""
        return self.of_site(site)

    def told(self, alone: bool) -> str:
        """The assumptions, after the number of the rule where that is not the usual one.

        Of one building what the rule says of its property line comes first, and nothing of floors.
        """
        stated = [
            f"{field.name} {getattr(self, field.name):g}"
            for field in fields(self)
            if getattr(self, field.name) != field.default
        ]
        if alone and self.line:
            return "; ".join([*stated, self.line, self.assumptions.removesuffix(f"; {ALIGNED}")])
        return "; ".join([*stated, self.assumptions])


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
    def heights_known(self) -> bool:
        """Of both buildings."""
        return self.height_1 is not None and self.height_2 is not None

    @property
    def lower_height(self) -> Any:
        """Height at which the roof of the lower building meets the other."""
        return np.minimum(self.height_1, self.height_2)

    def mirrored(self) -> Site:
        """The same with the buildings exchanged."""
        swapped = {"peak_1": self.peak_2, "peak_2": self.peak_1}
        return replace(self, **swapped, height_1=self.height_2, height_2=self.height_1)

    def if_aligned(self, factor: float) -> float:
        """The factor if floors align, else one."""
        return factor if self.floors_align else 1.0


def check_zone(zone: str | None) -> None:
    """Raise a ValueError for a zone that is not one."""
    if zone is not None and (not isinstance(zone, str) or zone not in ZONES):
        raise ValueError(f"zone = {brief(zone)} is not known; allowed: {', '.join(ZONES)}")


def code_rule_names() -> tuple[str, ...]:
    """Names of the separation rules that `code_gaps` sets side by side.

    Returns
    -------
    tuple of str
        In the order of `code_gaps`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.code_rule_names()[:4]
    ('srss', 'share_of_sum', 'asce_7', 'canada')
    """
    return tuple(name for name, rule in CODE_RULES.items() if not _lacks_number(rule))


def code_rule(name: str, value: float | None = None) -> CodeRule:
    """Separation rule of a building code, by name.

    Parameters
    ----------
    name : str
        One of `code_rule_names`, or ``"share_of_height"`` or ``"fixed_distance"``, in any case.
    value : float, optional
        The number of a rule that has one: a factor [-] for ``"share_of_sum"``, ``"share_of_height"`` and
        ``"asce_41"``, a distance [m] for ``"fixed_distance"``, and for ``"china_gb_50011"`` the height
        above 15 m for which the joint grows by 20 mm [m]. What has a usual one can do without.

    Returns
    -------
    CodeRule
        With ``gap(peak_1, peak_2, ...)`` [m], ``reference``, ``mark`` and ``assumptions``.

    Raises
    ------
    ValueError
        If the name is unknown, or a family's number is missing, not positive, or given to a rule
        that has none.

    Examples
    --------
    >>> import stochlin as sl
    >>> round(float(sl.code_rule("eurocode_8").gap(0.03, 0.04, floors_align=True)), 6)
    0.035
    >>> float(sl.code_rule("share_of_height", 0.01).gap(0.03, 0.04, 12.0, 20.0))
    0.12
    """
    rule = look_up(CODE_RULES, name, "name")
    if value is None and _lacks_number(rule):
        raise ValueError(f"value is not given; {rule.name} needs it; allowed: a positive number")
    if value is None:
        return rule.usual()
    if not fields(rule):
        families = ", ".join(name for name, one in CODE_RULES.items() if fields(one))
        raise ValueError(f"value = {brief(value)} is given to {rule.name}; allowed for {families} only")
    return rule(value)  # type: ignore[call-arg]


def _lacks_number(rule: type[CodeRule]) -> bool:
    return any(field.default is MISSING for field in fields(rule))
