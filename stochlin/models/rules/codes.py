"""Separation between two buildings as building codes ask for it, one rule a class, found by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.models.rules.separations import (
    INELASTIC,
    ZONES,
    CodeRule,
    FixedDistance,
    ShareOfHeight,
    ShareOfSum,
    Site,
    SquareRoot,
)

ALIGNED = "the factor for floors that align accepts contact at slab level"


@dataclass(frozen=True)
class Asce7(SquareRoot):
    """ASCE 7 and IBC: square root of the sum of squares."""

    name: ClassVar[str] = "asce_7"
    reference: ClassVar[str] = "ASCE 7, section on structural separation; IBC"
    mark: ClassVar[str] = "S"
    assumptions: ClassVar[str] = "peaks are maximum inelastic displacements, Cd times elastic over Ie"


@dataclass(frozen=True)
class Canada(SquareRoot):
    """National Building Code of Canada: square root of the sum of squares."""

    name: ClassVar[str] = "canada"
    reference: ClassVar[str] = "National Building Code of Canada"
    mark: ClassVar[str] = "S"


@dataclass(frozen=True)
class Eurocode8(CodeRule):
    """Eurocode 8, 4.4.2.7: square root of the sum of squares, times .7 if floors align."""

    name: ClassVar[str] = "eurocode_8"
    reference: ClassVar[str] = "EN 1998-1, 4.4.2.7"
    mark: ClassVar[str] = "M high"
    assumptions: ClassVar[str] = (
        f"peaks are design displacements, behaviour factor times elastic; {ALIGNED}"
    )

    def _gap(self, site: Site) -> Any:
        return site.if_aligned(0.7) * site.root_of_squares


@dataclass(frozen=True)
class Ubc97(SquareRoot):
    """UBC-97: square root of the sum of squares of maximum inelastic displacements."""

    name: ClassVar[str] = "ubc_97"
    reference: ClassVar[str] = "Uniform Building Code 1997, 1633.2.11"
    mark: ClassVar[str] = "M high"
    assumptions: ClassVar[str] = "peaks are maximum inelastic displacements, .7 R times those of design"


@dataclass(frozen=True)
class MexicoCity(CodeRule):
    """Mexico City: each building keeps 50 mm and ``D + c h`` from its boundary; half if slabs align.

    ``c`` is .001, .003, .006 in zones I, II, III. Between two bodies the two distances add up.
    """

    name: ClassVar[str] = "mexico_city"
    reference: ClassVar[str] = "NTC-Sismo, Mexico City"
    mark: ClassVar[str] = "S"
    assumptions: ClassVar[str] = f"{INELASTIC}; {ALIGNED}"
    needs: ClassVar[tuple[str, ...]] = ("height_1", "height_2", "zone")

    def _gap(self, site: Site) -> Any:
        share = ZONES[str(site.zone)]
        one, two = (
            np.maximum(peak + share * height, 0.05)
            for peak, height in ((site.peak_1, site.height_1), (site.peak_2, site.height_2))
        )
        return site.if_aligned(0.5) * (one + two)


@dataclass(frozen=True)
class India(CodeRule):
    """IS 1893: the sum; half of it if floors align."""

    name: ClassVar[str] = "is_1893"
    reference: ClassVar[str] = "IS 1893 (Part 1)"
    mark: ClassVar[str] = "M"
    assumptions: ClassVar[str] = f"peaks are R times the displacements under design forces; {ALIGNED}"

    def _gap(self, site: Site) -> Any:
        return site.if_aligned(0.5) * site.total


@dataclass(frozen=True)
class Taiwan(CodeRule):
    """Taiwan: .6 of the sum."""

    name: ClassVar[str] = "taiwan"
    reference: ClassVar[str] = "Seismic design specifications for buildings, Taiwan"
    mark: ClassVar[str] = "S"
    assumptions: ClassVar[str] = "peaks are 1.4 alpha_y Ra times the displacements under design forces"

    def _gap(self, site: Site) -> Any:
        return 0.6 * site.total


@dataclass(frozen=True)
class Peru(CodeRule):
    """E.030: the largest of .006 h, 30 mm and 2/3 of the sum; ``h`` the lower building's height."""

    name: ClassVar[str] = "peru_e030"
    reference: ClassVar[str] = "Norma E.030, Peru"
    mark: ClassVar[str] = "M"
    needs: ClassVar[tuple[str, ...]] = ("height_1", "height_2")

    def _gap(self, site: Site) -> Any:
        least = np.maximum(0.006 * site.lower_height, 0.03)
        return np.maximum(least, site.total * (2 / 3))


_RULES: dict[str, CodeRule] = {
    rule.name: rule
    for rule in (
        SquareRoot(),
        ShareOfSum(),
        Asce7(),
        Canada(),
        Eurocode8(),
        Ubc97(),
        MexicoCity(),
        India(),
        Taiwan(),
        Peru(),
    )
}
_FAMILIES: dict[str, type[CodeRule]] = {
    family.name: family for family in (ShareOfSum, ShareOfHeight, FixedDistance)
}


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
    return tuple(_RULES)


def code_rule(name: str, value: float | None = None) -> CodeRule:
    """Separation rule of a building code, by name.

    Parameters
    ----------
    name : str
        One of `code_rule_names`, or ``"share_of_height"`` or ``"fixed_distance"``, in any case.
    value : float, optional
        The number of a family: a factor [-] for ``"share_of_sum"`` and ``"share_of_height"``, a
        distance [m] for ``"fixed_distance"``.

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
    key = str(name).strip().lower()
    if key not in _RULES and key not in _FAMILIES:
        names = dict.fromkeys([*_RULES, *_FAMILIES])
        raise ValueError(f"name = {name!r} is no known rule; allowed: {', '.join(names)}")
    if value is None and key in _RULES:
        return _RULES[key]
    if value is None:
        raise ValueError(f"value is not given; {key} needs it; allowed: a positive number")
    if key not in _FAMILIES:
        raise ValueError(f"value = {value!r} is given to {key}; allowed for {', '.join(_FAMILIES)} only")
    return _FAMILIES[key](value)  # type: ignore[call-arg]
