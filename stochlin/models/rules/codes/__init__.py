"""Separation rules: the gap between two buildings by building codes and by four families of rules.

The rules take peak displacements at the level where the buildings could meet, as the code defines them;
``assumptions`` of each rule states the definition. Some rules also give the distance of one building
from its property line.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, NamedTuple

import numpy as np

from stochlin.messages import brief
from stochlin.models.arguments import OneOf, check_fields, checked
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Parameter, Range, parameter
from stochlin.models.rules.published import Published, look_up
from stochlin.registry import Registry

ZONES: Mapping[str, float] = {"I": 0.001, "II": 0.003, "III": 0.006}  # share of the height, Mexico City
Zone = Annotated[str, OneOf(ZONES)]
HEIGHT, FIXED = "height", "fixed"  # families of rules, besides "SRSS" and "sum" of the peaks
INELASTIC = "peaks are largest displacements, inelastic where the structure yields"
TWO = "a second building: what it says of a property line is not known here"
CODE_RULES: Registry[CodeRule] = Registry("code rule", "stochlin.models.rules.codes")
# Factors of codes on displacements under design forces, as `stochlin.code_gaps` names them.
FACTORS = BEHAVIOUR, DEFLECTION, IMPORTANCE = "behaviour", "deflection", "importance"
AT_LEAST_1 = Range(1.0, include_lower=True, reason="it multiplies displacements under design forces")
OF_IMPORTANCE = Range(0.5, 2.0, True, True, "codes have 0.8 to 1.5")
STOREYS = Range(1.0, include_lower=True, reason="storeys above the ground")
MULTIPLIED = "displacements that are multiplied already: it has no factor on those under design forces"


@dataclass(frozen=True)
class BuildingPeaks(Model):
    """Peak displacements [m] of two buildings or of one, and what rules need besides.

    These are their heights [m] and storeys, the peak ground acceleration of the design [m/s^2], and the
    factors of codes if the peaks are those under design forces.
    """

    of_arguments = True

    peak_1: Parameter = parameter("m", "peak displacement, structure 1", NOT_NEGATIVE)
    peak_2: Parameter | None = parameter("m", "peak displacement, structure 2", NOT_NEGATIVE, None)
    height_1: Parameter | None = parameter("m", "height, structure 1", POSITIVE, None)
    height_2: Parameter | None = parameter("m", "height, structure 2", POSITIVE, None)
    storeys_1: Parameter | None = parameter("1", "number of storeys, structure 1", STOREYS, None)
    storeys_2: Parameter | None = parameter("1", "number of storeys, structure 2", STOREYS, None)
    design_pga: Parameter | None = parameter(
        "m/s^2", "peak ground acceleration of the design", POSITIVE, None
    )
    behaviour_1: Parameter | None = parameter("1", "behaviour factor, structure 1", AT_LEAST_1, None)
    behaviour_2: Parameter | None = parameter("1", "behaviour factor, structure 2", AT_LEAST_1, None)
    deflection_1: Parameter | None = parameter("1", "displacement factor, structure 1", AT_LEAST_1, None)
    deflection_2: Parameter | None = parameter("1", "displacement factor, structure 2", AT_LEAST_1, None)
    importance: Parameter | None = parameter("1", "importance factor", OF_IMPORTANCE, None)
    importance_2: Parameter | None = parameter(
        "1", "importance factor, structure 2", OF_IMPORTANCE, None
    )


class Number(NamedTuple):
    """The number of a rule: its name, its unit, and its usual value, if it has one."""

    name: str
    units: str = "1"
    usual: float | None = None


@dataclass(frozen=True, kw_only=True)
class CodeRule(Published):
    """A separation rule: a formula, and what must be known to use it.

    A code that takes the displacements of a design says in ``multiplies`` by which of its factors those
    under design forces are multiplied, times ``share``, and over the importance factor if
    ``over_importance``. ``called`` has the names that it gives to its factors.
    """

    # Required separation of two buildings [m]; by default the sum of both distances from the line.
    gap_of: Callable[[Site], Any] | None = field(default=None, compare=False)
    # Required distance of building 1 from a property line [m]; by default the gap to a building of the
    # same height that does not move.
    line_of: Callable[[Site], Any] | None = field(default=None, compare=False)
    assumptions: str = INELASTIC
    of_pairs: Sequence[str] = ()  # further assumptions, which say nothing of one building
    family: str = ""  # the quantity from which the gap is computed: "SRSS", "sum", "height" or "fixed"
    between: str = ""  # the same between two properties, if both distances from the line are added there
    needs: Sequence[str] = ()  # arguments of `gap` required besides the peaks
    line: str = ""  # statement on one building and its property line, empty if not known
    multiplies: str = ""  # BEHAVIOUR or DEFLECTION; empty if it takes no such displacements
    share: float = 1.0
    over_importance: bool = False
    larger_factor: bool = False  # of both buildings, for both, where floors do not align
    called: Mapping[str, str] = field(default_factory=dict, hash=False)  # by name in FACTORS
    countries: Sequence[str] = ()  # in which the code is in use
    number: Number | None = None
    value: float | None = None  # of its number

    def __post_init__(self) -> None:
        if self.number is None:
            return
        if self.value is None:
            object.__setattr__(self, "value", self.number.usual)
        elif not 0 < self.value < np.inf:
            raise ValueError(
                f"{self.name}: {self.number.name} = {brief(self.value)}; allowed: a positive number"
            )

    @property
    def lacks_number(self) -> bool:
        """Whether the rule needs a number that it does not have."""
        return self.number is not None and self.value is None

    def takes_peaks(self) -> bool:
        """Whether the rule uses displacements at all."""
        return self.family not in (HEIGHT, FIXED)

    def designed(self, displacement: Any, factor: Any, importance: Any = 1.0) -> Any:
        """The displacement of the code [m], for that of a building under design forces [m].

        ``factor`` is the one that the code ``multiplies`` displacements by.
        """
        return self.share * factor * displacement / (importance if self.over_importance else 1.0)

    def under_design_forces(self, displacement: Any, behaviour: Any, importance: Any = 1.0) -> Any:
        """The displacement under design forces [m], for that of the elastic spectrum [m].

        Design forces are those of the spectrum over the behaviour factor. A code that divides
        displacements by the importance factor has multiplied the forces by it.
        """
        return displacement * (importance if self.over_importance else 1.0) / behaviour

    def gap(self, peak_1: Any, peak_2: Any, *more: Any, **others: Any) -> Any:
        """Required separation [m] for peak displacements [m] as the rule defines them.

        Without ``peak_2`` it is the distance of one building from its property line. ``more`` and
        ``others`` are, in this order or by name: ``height_1`` and ``height_2`` of the buildings [m];
        ``floors_align``, whether the floors of both are at the same levels; ``zone`` of Mexico City,
        ``"I"``, ``"II"`` or ``"III"``; ``same_property``, whether no property line is between them;
        ``same_system``, whether their structural systems are the same; ``storeys_1`` and ``storeys_2``;
        ``importance_1`` and ``importance_2``, importance factors; and ``design_pga``, the peak ground
        acceleration of the design [m/s^2]. A ValueError names what a rule needs and is missing.
        """
        if peak_2 is None and not self.line:
            raise ValueError(f"{self.name} needs {TWO}; give peak_2")
        site = replace(Site(peak_1, peak_2, *more, **others), number=self.value)
        named = [name for name, value in vars(site).items() if value is not None]
        if missing := self.missing(named, peak_2 is None):
            raise ValueError(
                f"{self.name} needs {', '.join(missing)}, which is not given; allowed: heights [m], "
                f"numbers of storeys, design_pga [m/s^2], zone one of {', '.join(ZONES)}"
            )
        if peak_2 is None:
            return self._from_line(site)
        if self.gap_of is None or (self.between and not site.same_property):
            return self._from_line(site) + self._from_line(site.mirrored())
        return self.gap_of(site)

    def _from_line(self, site: Site) -> Any:
        """Distance of building 1 from a property line [m]."""
        formula = self.line_of or self.gap_of
        assert formula is not None
        alone = {"peak_2": 0 * site.peak_1, "height_2": site.height_1}
        return formula(replace(site, **alone, **vars(Neighbours())))

    def missing(self, named: Collection[str], alone: bool) -> list[str]:
        """Arguments that the rule requires and that are not ``given``, for two buildings or for one."""
        if alone and not self.line:
            return [TWO]
        return [n for n in self.needs if n not in named and not (alone and n.endswith("_2"))]

    def governed_by(self, same_property: bool) -> str:
        """The family of the rule for two buildings of one property or of two."""
        return self.family if same_property else self.between or self.family

    def told(self, alone: bool) -> str:
        """The assumptions of the rule in words, with its number before them if it is not the default.

        For one building (``alone``) they begin with the statement on property lines, and those on two
        buildings are left out.
        """
        of_line = alone and bool(self.line)
        own = self.number is not None and self.value != self.number.usual
        return "; ".join(
            [
                *([f"{self.number.name} {self.value:g}"] if self.number and own else []),
                *([self.line] if of_line else []),
                self.assumptions,
                *([] if of_line else self.of_pairs),
            ]
        )


@dataclass(frozen=True)
class Neighbours:
    """What two buildings have in common, each False where it is not so or not known."""

    floors_align: bool = False  # floors at the same levels
    same_property: bool = False  # no property line between them
    same_system: bool = False  # the same structural system

    def told(self) -> str:
        """What is true, for the run information: ``", floors_align=True"``, or empty."""
        return "".join(f", {name}=True" for name, value in vars(self).items() if value)


@dataclass(frozen=True)
class Site:
    """The arguments of `CodeRule.gap` for a pair of buildings."""

    peak_1: Any
    peak_2: Any
    height_1: Any = None
    height_2: Any = None
    floors_align: bool = False
    zone: Zone | None = None
    same_property: bool = False
    same_system: bool = False
    storeys_1: Any = None
    storeys_2: Any = None
    importance_1: Any = 1.0
    importance_2: Any = 1.0
    design_pga: Any = None
    number: Any = None  # of the rule

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def lower_height(self) -> Any:
        """Height of the lower building [m], at which its roof would meet the other building."""
        return np.minimum(self.height_1, self.height_2)

    def mirrored(self) -> Site:
        """The same pair with the buildings exchanged."""
        buildings = ("peak", "height", "storeys", "importance")
        swapped = {f"{of}_{n}": getattr(self, f"{of}_{3 - n}") for of in buildings for n in (1, 2)}
        return replace(self, **swapped)

    def if_aligned(self, factor: float) -> float:
        """The factor if the floors align, else 1."""
        return factor if self.floors_align else 1.0


def code_rule_names() -> tuple[str, ...]:
    """Names of the separation rules in the table of `stochlin.code_gaps`.

    Returns
    -------
    tuple of str
        Names in the order of `stochlin.code_gaps`.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.rules.code_rule_names()[:4]
    ('srss', 'share_of_sum', 'asce_7', 'canada')
    """
    return tuple(name for name, rule in CODE_RULES.items() if not rule.lacks_number)


@checked
def code_rule(name: str, value: float | None = None) -> CodeRule:
    """Separation rule of a building code, by name.

    Parameters
    ----------
    name : str
        One of `code_rule_names`, or ``"share_of_height"`` or ``"fixed_distance"``, in upper or lower
        case.
    value : float, optional
        Number of the rule: a factor [-] for ``"share_of_sum"``, ``"share_of_height"`` and ``"asce_41"``,
        a distance [m] for ``"fixed_distance"``, and for ``"china_gb_50011"`` the height [m] above 15 m
        for which the joint grows by 20 mm. It is required by ``"share_of_height"`` and
        ``"fixed_distance"``; other rules have a default or no number.

    Returns
    -------
    CodeRule
        The rule, with the method ``gap(peak_1, peak_2, ...)`` [m] and the attributes ``reference``,
        ``mark`` and ``assumptions``.

    Raises
    ------
    ValueError
        If the name is unknown, or if the number is missing, is not positive or is given to a rule
        without one.

    Examples
    --------
    >>> import stochlin as sl
    >>> rule = sl.rules.code_rule("eurocode_8")
    >>> round(float(rule.gap(0.03, 0.04)), 6)
    0.07
    >>> round(float(rule.gap(0.03, 0.04, floors_align=True, same_property=True)), 6)
    0.035
    >>> float(sl.rules.code_rule("share_of_height", 0.01).gap(0.03, 0.04, 12.0, 20.0))
    0.12
    """
    rule = look_up(CODE_RULES, name, "name")
    if value is None and rule.lacks_number:
        raise ValueError(f"value is not given; {rule.name} needs it; allowed: a positive number")
    if value is not None and rule.number is None:
        known = ", ".join(name for name, each in CODE_RULES.items() if each.number)
        raise ValueError(f"value = {brief(value)} is given to {rule.name}; allowed for {known} only")
    return rule if value is None else replace(rule, value=value)


def rules_of(name: str) -> tuple[CodeRule, ...]:
    """The rules of a code by its name or by the name of a country; empty if there are none."""
    plain = name.strip().lower()
    of_country = [
        rule for rule in CODE_RULES.values() if plain in (country.lower() for country in rule.countries)
    ]
    key = plain.replace("-", "_").replace(" ", "_")
    return tuple(of_country or ([CODE_RULES[key]] if key in CODE_RULES else []))
