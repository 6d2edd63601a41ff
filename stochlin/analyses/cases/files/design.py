"""What the design of a building says: displacements under design forces, and the factors of its code."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import xarray as xr

from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.schema import BUILDING
from stochlin.analyses.cases.files.sections import Section
from stochlin.messages import hint, plain
from stochlin.models.rules.codes import (
    BEHAVIOUR,
    CODE_RULES,
    DEFLECTION,
    IMPORTANCE,
    CodeRule,
    code_rule_names,
    rules_of,
)

DISPLACEMENTS = "displacements"
KEYS = {  # of the factors of codes
    BEHAVIOUR: "behaviour_factor",
    DEFLECTION: "displacement_factor",
    IMPORTANCE: "importance_factor",
}
OF_DESIGN = (DISPLACEMENTS, *KEYS.values())


@dataclass(frozen=True)
class Design:
    """Displacements of the floors [m] by the engineer's analysis, if given, and factors by name."""

    displacements: tuple[float, ...] = ()
    factors: Mapping[str, float] = field(default_factory=dict)
    section: Section | None = field(default=None, compare=False, repr=False)  # for messages

    def needed(self, rule: CodeRule) -> list[str]:
        """The factors that the rule takes.

        Without displacements those of the spectrum are divided by the behaviour factor first, which has
        no effect for a code that multiplies by it again.
        """
        if self.displacements:
            return [rule.multiplies]
        return [] if rule.multiplies == BEHAVIOUR else [BEHAVIOUR, rule.multiplies]

    def missing(self, rule: CodeRule, has_spectrum: bool) -> str:
        """The first key that is missing for the rule, with the cure; empty if nothing is."""
        if not rule.multiplies:
            return ""
        if not (self.displacements or has_spectrum):
            why = f"{rule.name} needs them, since the site has no design spectrum to compute them from"
            return self._cure(DISPLACEMENTS, why)
        for name in self.needed(rule):
            if name not in self.factors:
                return self._cure(KEYS[name], f"{rule.name} needs its {rule.called[name]}")
        return ""

    @staticmethod
    def _cure(key: str, why: str) -> str:
        example = "3.0"
        if key == DISPLACEMENTS:
            example = '["1.2 cm", ...], of each floor from the ground up by your analysis'
        return f"{key}: {why}; write, for instance, {key} = {example}"


def read_design(section: Section, floors: int, is_oscillator: bool) -> Design:
    """The design of a building with so many floors; an oscillator has one."""
    displacements: tuple[float, ...] = ()
    if DISPLACEMENTS in section:
        quantity = BUILDING[DISPLACEMENTS].kind
        assert isinstance(quantity, Quantity)
        values = section.number_or_list(DISPLACEMENTS, quantity)
        displacements = tuple(values) if isinstance(values, list) else (values,)
        if len(displacements) != floors:
            allowed = (
                "one, at the level where the buildings could meet, for a building without storeys"
                if is_oscillator
                else f"one for each of its {floors} floors, from the ground up"
            )
            counted = f"{len(displacements)} displacement{'s' * (len(displacements) > 1)}"
            raise section.error(DISPLACEMENTS, f"has {counted}; allowed: {allowed}")
    factors = {name: section.read(key) for name, key in KEYS.items() if key in section}
    return Design(displacements, factors, section)


def read_codes(
    wanted: Section, designs: Sequence[Design], spectrum: xr.DataArray | None
) -> tuple[str, ...]:
    """Names of the codes that are to be applied, in the order of the file.

    A ValueError names what is missing for one that the file asks for. Without the key ``codes`` it is
    the code of the spectrum of the site, if there is one.
    """
    if "codes" not in wanted:
        code = "" if spectrum is None else str(spectrum.attrs.get("code", ""))
        if code in CODE_RULES:
            return (code,)
        for section in (design.section for design in designs if design.section is not None):
            if unused := [key for key in OF_DESIGN if key in section]:
                section.doubt(unused[0], 'is not used; name your code, as codes = ["eurocode_8"]')
        return ()
    rules: list[CodeRule] = []
    for name in wanted.texts("codes"):
        if not (named := rules_of(name)):
            countries = sorted({country for rule in CODE_RULES.values() for country in rule.countries})
            said = hint(name, [*CODE_RULES, *countries])
            known = f"{', '.join(CODE_RULES)}, or a country: {', '.join(countries)}"
            what = f"has {plain(name)!r}, which is not known"
            raise wanted.error("codes", f"{what}; {said}allowed: {known}")
        rules += named
    for rule in rules:
        if rule.takes_peaks() and not rule.multiplies:
            what = f"has {rule.name}, which states no factor on displacements under design forces"
            cure = "leave it out: 'stochlin gap --all-rules' shows what it makes of the simulated peaks"
            raise wanted.error("codes", f"{what}; {cure}")
        if rule.name not in (*code_rule_names(), *wanted.section("numbers", needed=False).values):
            what = f"has {rule.name}, but its number is missing"
            raise wanted.error("codes", f"{what}, as numbers = {{ {rule.name} = 0.02 }}")
        for design in designs:
            if lacking := design.missing(rule, spectrum is not None):
                assert design.section is not None
                key, _, why = lacking.partition(": ")
                raise design.section.error(key, f"is missing: {why}, or leave the code out of codes")
    return tuple(dict.fromkeys(rule.name for rule in rules))
