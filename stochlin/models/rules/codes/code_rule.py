"""What the rules of codes have in common: the buildings that they ask about, and their factors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from stochlin.messages import brief
from stochlin.models.arguments import Truth, check_fields, checked, is_number
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Range, parameter
from stochlin.models.rules import Published, look_up
from stochlin.registry import Registry

Zone = Literal["I", "II", "III"]  # of Mexico City
ZONES: Mapping[Zone, float] = {"I": 0.001, "II": 0.003, "III": 0.006}  # share of the height
# families of rules that use no peaks
BY_HEIGHT = "height"
FIXED = "fixed"
FAMILIES = ("", "SRSS", "sum", BY_HEIGHT, FIXED)
INELASTIC = "peaks are largest displacements, inelastic where the structure yields"
SECOND_UNKNOWN = "a second building: what it says of a property line is not known here"


def _check_formula(rule: CodeRule) -> None:
    """Raise a ValueError for a rule whose formula fails with what the rule says that it needs."""
    tried = replace(rule, value=1.0) if rule.lacks_number else rule
    try:
        site = Site(0.1, 0.1, **{name: TRIAL_BUILDINGS.get(name, 1.0) for name in rule.needs})
        for pair in (site, replace(site, same_property=True)):
            float(tried.gap_of_displaced(pair))
    except (TypeError, AttributeError) as error:
        taken = ", ".join(["both peaks", *rule.needs, *(["its number"] if rule.number else [])])
        what = f"{rule.name}: the formula fails with {taken} alone"
        raise ValueError(
            f"{what}; name what else it takes in needs, or by a number: {error}"
        ) from error


CODE_RULES: Registry[CodeRule] = Registry(
    "code rule", "stochlin.models.rules.codes", check=_check_formula
)
# Buildings with which formulas are tried; of other needs 1 in SI units is a value.
TRIAL_BUILDINGS: Mapping[str, Any] = {
    "zone": "I",
    "height_1": 10.0,
    "height_2": 10.0,
    "storeys_1": 3.0,
    "storeys_2": 3.0,
}
# Factors of codes on displacements under design forces, as `stochlin.code_gaps` names them.
FACTORS_OF_CODES = BEHAVIOUR, DEFLECTION, IMPORTANCE = "behaviour", "deflection", "importance"
AT_LEAST_1 = Range(
    1.0, include_lower=True, reason="it multiplies displacements under design forces"
)
IMPORTANCE_RANGE = Range(0.5, 2.0, True, True, "codes have 0.8 to 1.5")
STOREYS_ABOVE_GROUND = Range(1.0, include_lower=True, reason="storeys above the ground")
MULTIPLIED = (
    "displacements that are multiplied already: it has no factor on those under design forces"
)
BOTH = ("floors_align", "same_property", "same_system")  # facts of two buildings
# Assumptions on two buildings that several codes have.
ALIGNED = "the factor for floors that align accepts contact at slab level"
SUM_OF_DISTANCES = "between two properties the gap is the sum of both distances from the line"


@dataclass(frozen=True)
class Site(Model):
    """What rules ask of two buildings, or of one beside its property line: see `CodeRule.gap`.

    With a behaviour or displacement factor the peaks are those under design forces, which each code
    multiplies by its factors; with ``elastic`` they are those of the elastic spectrum.
    """

    of_arguments = True

    peak_1: Any = parameter("m", "peak displacement, structure 1", NOT_NEGATIVE)
    peak_2: Any = parameter("m", "peak displacement, structure 2", NOT_NEGATIVE, None)
    height_1: Any = parameter("m", "height, structure 1", POSITIVE, None)
    height_2: Any = parameter("m", "height, structure 2", POSITIVE, None)
    floors_align: Truth = False
    zone: Zone | None = None
    same_property: Truth = False
    same_system: Truth = False
    storeys_1: Any = parameter("1", "number of storeys, structure 1", STOREYS_ABOVE_GROUND, None)
    storeys_2: Any = parameter("1", "number of storeys, structure 2", STOREYS_ABOVE_GROUND, None)
    importance_1: Any = parameter("1", "importance, structure 1", IMPORTANCE_RANGE, None)
    importance_2: Any = parameter("1", "importance, structure 2", IMPORTANCE_RANGE, None)
    design_pga: Any = parameter("m/s^2", "peak acceleration of the design", POSITIVE, None)
    behaviour_1: Any = parameter("1", "behaviour factor, structure 1", AT_LEAST_1, None)
    behaviour_2: Any = parameter("1", "behaviour factor, structure 2", AT_LEAST_1, None)
    deflection_1: Any = parameter("1", "displacement factor, structure 1", AT_LEAST_1, None)
    deflection_2: Any = parameter("1", "displacement factor, structure 2", AT_LEAST_1, None)
    elastic: bool = False
    number: Any = None  # of the rule

    def __post_init__(self) -> None:
        super().__post_init__()
        check_fields(self)
        of_second = [name for name in self.present if name.endswith("_2")]
        of_second += [name for name in BOTH if getattr(self, name)]
        if self.alone and of_second:
            raise ValueError(f"{of_second[0]} is given, of a second building that is not there")

    @property
    def alone(self) -> bool:
        """Whether there is one building, beside its property line."""
        return self.peak_2 is None

    @property
    def of_design(self) -> bool:
        """Whether the peaks are displacements under design forces, or are reduced to these."""
        return any(name.startswith((BEHAVIOUR, DEFLECTION)) for name in self.present)

    @property
    def present(self) -> list[str]:
        """Names of what is given."""
        return [name for name, value in vars(self).items() if value is not None]

    @property
    def importance(self) -> Any:
        """Importance factor of building 1 [-], by default 1."""
        return 1.0 if self.importance_1 is None else self.importance_1

    @property
    def lower_height(self) -> Any:
        """Height of the lower building [m], at which its roof would meet the other building."""
        return np.minimum(self.height_1, self.height_2)

    def mirrored(self) -> Site:
        """The same pair with the buildings exchanged."""
        of_both = [name[:-1] for name in vars(self) if name.endswith("_1")]
        exchanged = {f"{of}{n}": getattr(self, f"{of}{3 - n}") for of in of_both for n in (1, 2)}
        return self.with_arrays(exchanged)

    def beside_line(self) -> Site:
        """Building 1 beside a building of the same height that does not move."""
        unmoved = {"peak_2": 0 * self.peak_1, "height_2": self.height_1}
        return self.with_arrays(unmoved | dict.fromkeys(BOTH, False))

    def if_aligned(self, factor: float) -> float:
        """The factor if the floors align, else 1."""
        return factor if self.floors_align else 1.0

    def over_peaks(self, gap: Any) -> Any:
        """A gap [m] that does not depend on peaks, over their dimensions, NaN where they are."""
        return gap + 0 * (self.peak_1 + self.peak_2)


class CodeNumber(NamedTuple):
    """The number of a rule: its name, its unit, and its usual value, if it has one."""

    name: str
    units: str = "1"
    usual: float | None = None


@dataclass(frozen=True, kw_only=True)
class CodeRule(Published):
    """A separation rule: a formula, and what must be known to use it.

    A code that takes the displacements of a design says in ``multiplies`` by which of its factors
    those under design forces are multiplied, times ``share``, and over the importance factor if
    ``over_importance``. ``called`` has the names that it gives to its factors.
    """

    # Required separation of two buildings [m]; by default the sum of both distances from the line.
    gap_of: Callable[[Site], Any] | None = field(default=None, compare=False)
    # Required distance of building 1 from a property line [m]; by default the gap to a building of
    # the same height that does not move.
    line_of: Callable[[Site], Any] | None = field(default=None, compare=False)
    assumptions: str = INELASTIC
    of_pairs: Sequence[str] = ()  # further assumptions, which say nothing of one building
    # the quantity from which the gap is computed: "SRSS", "sum", "height" or "fixed"
    family: str = ""
    # the same between two properties, if both distances from the line are added there
    between: str = ""
    needs: Sequence[str] = ()  # arguments of `gap` required besides the peaks
    # of both distances, for the same height, system and levels of floors
    half_if_alike: bool = False
    line: str = ""  # statement on one building and its property line, empty if not known
    multiplies: str = ""  # BEHAVIOUR or DEFLECTION; empty if it takes no such displacements
    share: float = 1.0
    over_importance: bool = False
    larger_factor: bool = False  # of both buildings, for both, where floors do not align
    # by name in FACTORS_OF_CODES
    called: Mapping[str, str] = field(default_factory=dict, hash=False)
    countries: Sequence[str] = ()  # in which the code is in use
    number: CodeNumber | None = None
    value: float | None = None  # of its number, in place of the usual one

    def __post_init__(self) -> None:
        if self.gap_of is None and self.line_of is None:
            raise ValueError(f"{self.name}: gap_of is not given; allowed: a function of a Site")
        for what in ("of_pairs", "needs", "countries"):
            if isinstance(text := getattr(self, what), str):
                raise ValueError(
                    f"{self.name}: {what} = {text!r}; allowed: a tuple, as ({text!r},)"
                )
        if not isinstance(self.called, Mapping):
            what = f"{self.name}: called = {brief(self.called)}"
            raise ValueError(f"{what}; allowed: names by factor, as {{'behaviour': 'factor R'}}")
        words = {
            "family": ({self.family}, FAMILIES),
            "between": ({self.between}, FAMILIES),
            "needs": (self.needs, Site.__dataclass_fields__),
            "multiplies": ({self.multiplies}, ("", BEHAVIOUR, DEFLECTION)),
            "called": (self.called, FACTORS_OF_CODES),
        }
        for what, (names, allowed) in words.items():
            for name in names:
                if name not in allowed:
                    accepted = ", ".join(map(repr, allowed))
                    raise ValueError(f"{self.name}: {what} = {brief(name)}; allowed: {accepted}")
        for factor in (self.multiplies, BEHAVIOUR) if self.multiplies else ():
            if factor not in self.called:
                what = f"called has no {factor!r}, which the rule multiplies or divides by"
                raise ValueError(f"{self.name}: {what}; allowed: what the code calls it")

    @property
    def stated_number(self) -> Any:
        """The number of the rule: that of the user, or the usual one."""
        return self.number.usual if self.number and self.value is None else self.value

    @property
    def lacks_number(self) -> bool:
        """Whether the rule needs a number that it does not have."""
        return self.number is not None and self.stated_number is None

    def takes_peaks(self) -> bool:
        """Whether the rule uses displacements at all."""
        return self.family not in (BY_HEIGHT, FIXED)

    def displaced(self, site: Site) -> Site:
        """The pair with the displacements of the code [m], for those under design forces.

        Those of an elastic spectrum are divided first by the behaviour factor, as design forces
        are.
        """
        if not (site.of_design and self.multiplies):
            return site
        both = [site] if site.alone else [site, site.mirrored()]
        factors = [getattr(building, f"{self.multiplies}_1") for building in both]
        if self.larger_factor and not (site.alone or site.floors_align):
            factors = [np.maximum(*factors)] * 2
        peaks = {}
        for n, (building, factor) in enumerate(zip(both, factors, strict=True), start=1):
            # A code that divides displacements by the importance factor has multiplied the forces
            # by it.
            importance = building.importance if self.over_importance and not site.elastic else 1.0
            behaviour = building.behaviour_1 if site.elastic else 1.0
            peaks[f"peak_{n}"] = self.share * factor * building.peak_1 / behaviour / importance
        return site.with_arrays(peaks)

    def gap(self, peak_1: Any, peak_2: Any, *more: Any, **others: Any) -> Any:
        """Required separation [m] for peak displacements [m] as the rule defines them.

        Without ``peak_2`` it is the distance of one building from its property line. ``more`` and
        ``others`` are, in this order or by name: ``height_1`` and ``height_2`` of the buildings
        [m]; ``floors_align``, whether the floors of both are at the same levels; ``zone`` of Mexico
        City, ``"I"``, ``"II"`` or ``"III"``; ``same_property``, whether no property line is between
        them; ``same_system``, whether their structural systems are the same; ``storeys_1`` and
        ``storeys_2``; ``importance_1`` and ``importance_2``, importance factors; and
        ``design_pga``, the peak ground acceleration of the design [m/s^2]. A ValueError names what
        a rule needs and is missing.
        """
        site = Site(peak_1, peak_2, *more, **others)
        if missing := self.missing(site):
            raise ValueError(f"{self.name} needs {', '.join(missing)}, which is not given")
        return self.gap_of_displaced(self.displaced(site))

    def gap_of_displaced(self, site: Site) -> Any:
        """Required separation [m] for a pair with the displacements of the code."""
        site = site.with_arrays({"number": self.stated_number})
        formula = self.line_of or self.gap_of
        assert formula is not None
        if site.alone:
            return formula(site.beside_line())
        if self.gap_of is None or (self.between and not site.same_property):
            both = formula(site.beside_line()) + formula(site.mirrored().beside_line())
            alike = self.half_if_alike and site.floors_align and site.same_system
            return (1 - 0.5 * (site.height_1 == site.height_2)) * both if alike else both
        return self.gap_of(site)

    def missing(self, site: Site) -> list[str]:
        """What the rule requires and is not given, a factor with the code's name for it."""
        if site.alone and not self.line:
            return [SECOND_UNKNOWN]
        needed = [name for name in self.needs if not (site.alone and name.endswith("_2"))]
        lacking = [name for name in needed if name not in site.present]
        if not (site.of_design and self.takes_peaks()):
            return lacking
        if not self.multiplies:
            return [*lacking, MULTIPLIED]
        for factor in dict.fromkeys((self.multiplies, *([BEHAVIOUR] * site.elastic))):
            both = [f"{factor}_{n}" for n in "12"[: 1 if site.alone else 2]]
            if unknown := [name for name in both if name not in site.present]:
                lacking += [f"{unknown[0]} ({self.called[factor]})", *unknown[1:]]
        return lacking

    def stated(self, alone: bool) -> str:
        """The assumptions of the rule in words, with its number before them if not the default.

        For one building (``alone``) they begin with the statement on property lines, and those on
        two buildings are left out.
        """
        texts = [self.assumptions, *self.of_pairs]
        if alone and self.line:
            texts = [self.line, self.assumptions]
        if self.number is not None and self.stated_number != self.number.usual:
            texts.insert(0, f"{self.number.name} {self.stated_number:g}")
        return "; ".join(texts)


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
        One of `code_rule_names`, or ``"share_of_height"`` or ``"fixed_distance"``, in upper or
        lower case.
    value : float, optional
        Number of the rule: a factor [-] for ``"share_of_sum"``, ``"share_of_height"`` and
        ``"asce_41"``, a distance [m] for ``"fixed_distance"``, and for ``"china_gb_50011"`` the
        height [m] above 15 m for which the joint grows by 20 mm. It is required by
        ``"share_of_height"`` and ``"fixed_distance"``; other rules have a default or no number.

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
    if value is None:
        return rule
    if rule.number is None:
        names = ", ".join(name for name, other in CODE_RULES.items() if other.number)
        raise ValueError(
            f"value = {brief(value)} is given to {rule.name}; allowed for {names} only"
        )
    if not (is_number(value) and 0 < value < np.inf):
        what = f"{rule.name}: {rule.number.name} = {brief(value)}"
        raise ValueError(f"{what}; allowed: a positive number")
    return replace(rule, value=value)


def rules_of(name: str) -> tuple[CodeRule, ...]:
    """The rules of a code by its name or by the name of a country; empty if there are none."""
    plain = name.strip().lower()
    of_country = [rule for rule in CODE_RULES.values() if plain in map(str.lower, rule.countries)]
    key = plain.replace("-", "_").replace(" ", "_")
    return tuple(of_country or ([CODE_RULES[key]] if key in CODE_RULES else []))
