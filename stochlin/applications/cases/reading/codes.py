"""The table [separation] of a case file: gaps, confidence, risk, and building codes that are applied."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from stochlin.applications.cases.reading.buildings import Building
from stochlin.applications.cases.reading.hazards import EXAMPLE
from stochlin.applications.cases.reading.kinds import (
    TEXT,
    TRUTH,
    Inner,
    Key,
    Kind,
    ListOf,
    Quantity,
    Warn,
    Word,
    integer,
    key,
)
from stochlin.applications.cases.reading.records import PEAK
from stochlin.applications.cases.reading.tables import Form, Table
from stochlin.applications.risk.risk import check_target
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.messages import hint, plain
from stochlin.models.hazards import Hazard
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.rules.codes import (
    BEHAVIOUR,
    CODE_RULES,
    DEFLECTION,
    IMPORTANCE,
    ZONES,
    CodeRule,
    code_rule_names,
    rules_of,
)

FEWEST_PATHS, MOST_PATHS = 100, 2048  # for a quantile with an interval, and where none is given
GAP = Quantity("m", NOT_NEGATIVE, PLAUSIBLE["gap"])
SHARE = Quantity("1", Range(upper=1.0, reason="a probability"), PLAUSIBLE["confidence"])
RATE = Quantity("1", Range(upper=1.0, reason="a year"), PLAUSIBLE["risk"])
# Keys of the factors that codes name differently.
FACTORS = {
    BEHAVIOUR: "behaviour_factor",
    DEFLECTION: "displacement_factor",
    IMPORTANCE: "importance_factor",
}
OF_DESIGN = ("displacements", *FACTORS.values())


def _risk(written: Any, warn: Warn) -> Any:
    return (TEXT if isinstance(written, str) else RATE).read(written, warn)


RISK = Kind(_risk, "a text with its time, or a number per year", '"2 % in 50 years"')


@dataclass(frozen=True, kw_only=True)
class Numbers(Form):
    """Numbers of code rules in place of their defaults; ``more`` has them by name."""

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """The rules that have a number."""
        rules = {name: rule.number for name, rule in CODE_RULES.items() if rule.number}
        return {name: Key(Quantity(n.units, POSITIVE), name, None) for name, n in rules.items()}


@dataclass(frozen=True, kw_only=True)
class Wanted(Form):
    """What the separation is asked for."""

    existing: list[float] = key(ListOf(GAP, "listed"), "Existing gap", ())
    confidence: float = key(SHARE, "Confidence of no pounding")
    risk: str | float | None = key(RISK, "Allowed risk of pounding", None)
    floors_align: bool = key(TRUTH, "Floors at the same levels", False)
    same_property: bool = key(TRUTH, "On one property", False)
    same_system: bool = key(TRUTH, "Same structural system", False)
    codes: list[str] = key(ListOf(TEXT, "listed"), "Building codes that you apply, or countries", ())
    zone: str | None = key(Word(tuple(ZONES)), "Zone of Mexico City", None)
    design_pga: float | None = key(PEAK, "Peak ground acceleration of the design", None)
    numbers: Table | None = key(Inner(), "Numbers of rules in place of the usual ones", None)

    def of_rules(self) -> Mapping[str, float]:
        """Numbers of rules by name."""
        return {} if self.numbers is None else self.numbers.read(Numbers).more

    def check(self, buildings: int, hazard: Hazard | None) -> None:
        """Raise a ValueError for a wrong number of gaps, or a risk that the hazard does not reach."""
        if self.existing and len(self.existing) != (count := max(buildings - 1, 1)):
            which = "its distance from the property line" if buildings == 1 else "one between neighbours"
            what = f"does not fit the number of buildings, {buildings}; allowed: {count} in all, {which}"
            raise self.table.error("existing", what)
        if self.risk is not None and hazard is None:
            raise self.table.error("risk", f"needs a hazard; {EXAMPLE}")
        if self.risk is not None and hazard is not None:
            with self.table.naming("risk"):
                check_target(hazard, self.risk)

    def applied_codes(
        self, buildings: Sequence[Building], spectrum: xr.DataArray | None
    ) -> tuple[str, ...]:
        """Names of the codes that are applied; by default that of the spectrum of the site."""
        if "codes" not in self.table:
            known = CODE_RULES.get("" if spectrum is None else str(spectrum.attrs.get("code", "")))
            if known is None or any(missing_of(building, known, True) for building in buildings):
                _warn_of_unused(buildings)
                return ()
            return (known.name,)
        rules = [rule for name in self.codes for rule in self._rules(name)]
        for rule in rules:
            for building in buildings:
                if lacking := missing_of(building, rule, spectrum is not None):
                    name, why = lacking
                    what = f"is missing: {why}, or leave the code out of codes"
                    raise building.form.table.error(name, what)
        return tuple(dict.fromkeys(rule.name for rule in rules))

    def _rules(self, name: str) -> tuple[CodeRule, ...]:
        """The rules of a code or a country that can be applied."""
        rules = rules_of(name)
        if not rules:
            countries = sorted({country for rule in CODE_RULES.values() for country in rule.countries})
            known = f"{', '.join(CODE_RULES)}, or a country: {', '.join(countries)}"
            what = f"has {plain(name)!r}, which is not known"
            allowed = f"{hint(name, [*CODE_RULES, *countries])}allowed: {known}"
            raise self.table.error("codes", f"{what}; {allowed}")
        for rule in rules:
            if rule.takes_peaks() and not rule.multiplies:
                what = f"has {rule.name}, which states no factor on displacements under design forces"
                raise self.table.error("codes", f"{what}; leave it out")
            if rule.name not in (*code_rule_names(), *self.of_rules()):
                what = f"has {rule.name}, but its number is missing"
                raise self.table.error("codes", f"{what}, as numbers = {{ {rule.name} = 0.02 }}")
        return rules


@dataclass(frozen=True, kw_only=True)
class Simulated(Form):
    """The table [simulation]."""

    paths: int | None = key(integer(FEWEST_PATHS), "Simulated motions; else as many as needed", None)
    seed: int = key(integer(0), "Seed of the motions", 0)

    @property
    def motions(self) -> int:
        """Number of simulated motions, in whole groups of 32."""
        return whole_groups(self.paths or MOST_PATHS)


def factors_of(building: Building) -> dict[str, float]:
    """Factors of the code of a building that the file has, by their general names."""
    values = {name: getattr(building.form, key) for name, key in FACTORS.items()}
    return {name: value for name, value in values.items() if value is not None}


def missing_of(building: Building, rule: CodeRule, has_spectrum: bool) -> tuple[str, str] | None:
    """The first key that is missing for a rule, and why it is needed; None if nothing is.

    Displacements under design forces are given, or those of the spectrum divided by the behaviour
    factor, which has no effect for a code that multiplies by it again.
    """
    displacements, known = building.form.displacements, factors_of(building)
    if not rule.multiplies:
        return None
    if not (displacements or has_spectrum):
        why = f"{rule.name} needs them, since the site has no design spectrum to compute them from"
        return "displacements", f'{why}; write, for instance, displacements = ["1.2 cm", ...]'
    needed = [rule.multiplies] if displacements else [BEHAVIOUR, rule.multiplies]
    if not displacements and rule.multiplies == BEHAVIOUR:
        needed = []
    for name in (name for name in needed if name not in known):
        why = f"{rule.name} needs its {rule.called[name]}"
        return FACTORS[name], f"{why}; write, for instance, {FACTORS[name]} = 3.0"
    return None


def _warn_of_unused(buildings: Sequence[Building]) -> None:
    """Warn of keys of a design that no code uses."""
    for building in buildings:
        if unused := [name for name in OF_DESIGN if name in building.form.table]:
            what = 'is not used; name your code, as codes = ["eurocode_8"]'
            building.form.table.warn(unused[0], what)
