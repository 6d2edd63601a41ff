"""A case file: what it says of a site, of buildings in a row and of what is wanted."""

from __future__ import annotations

import inspect
import math
import os
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, replace
from functools import cached_property
from itertools import pairwise, product
from pathlib import Path
from typing import Any

from stochlin.applications.cases.reading.buildings import (
    BUILDING_HEIGHT,
    FORMS,
    Building,
    SlabOnColumn,
    read_building,
    slabs_of_row,
)
from stochlin.applications.cases.reading.kinds import (
    TEXT,
    TRUTH,
    Inner,
    Integer,
    Key,
    ListOf,
    WithUnit,
    Word,
    key,
    key_of,
    keys_of,
    keys_of_model,
    text_or,
)
from stochlin.applications.cases.reading.records import PGA
from stochlin.applications.cases.reading.site import MOTIONS, SITES, CaseSite, MotionForm, read_site
from stochlin.applications.cases.reading.tables import NO_TABLE, Form, Source, TomlTable, read_table
from stochlin.applications.risk.risk import check_target, doubt_of_text
from stochlin.applications.sites.elastic_spectra import doubt_of_pga
from stochlin.files.inputs import input_path
from stochlin.kernels.simulation.stepping import whole_groups
from stochlin.messages import hint, plain
from stochlin.models.arguments import checked
from stochlin.models.contacts.elements import CONTACTS, DAMPING, RESTITUTION, Contact
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Model, Range
from stochlin.models.plausible import PLAUSIBLE, unquestioned
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
from stochlin.models.rules.other_codes import other_code
from stochlin.models.uncertain import UncertainModel
from stochlin.models.walls import IN_SPACE, TO_GROUND, Wall

INCHES_OR_FEET = re.compile(r"[\d.]+ *(?:in|ft)(?: *\+-.*)?", re.IGNORECASE)
NUMBERED = re.compile(r"building_([1-9]\d{0,5})")
ALL_STOREYS = "all"
TWO_FLOORS = ListOf(Integer(1), length=2)
STOREY_NUMBERS = text_or(ListOf(Integer(1), "listed"), f'"{ALL_STOREYS}", or a list of numbers')
FEWEST_PATHS = 100  # for a quantile with an interval
MOST_PATHS = 2048  # where no number is stated
GAP_LENGTH = WithUnit("m", NOT_NEGATIVE, PLAUSIBLE["gap"])
CONFIDENCE_LEVEL = WithUnit("1", Range(upper=1.0, reason="a probability"), PLAUSIBLE["confidence"])
ANNUAL_RISK = WithUnit("1", Range(upper=1.0, reason="a year"), PLAUSIBLE["risk"])
LEAST_REACH = 1.2  # longest period of a spectrum over that of a building, which yields or cracks
RISK = text_or(ANNUAL_RISK, 'a text such as "2 % in 50 years", or a number per year')
OWN_RULE = "a rule of your own, which is one file (docs/extending.md)"
DEVICE = ("stiffness", "damping_constant", "damping_exponent", "hardening", "yield_displacement")
# Keys of the factors that codes name differently.
CODE_KEYS = {
    BEHAVIOUR: "behaviour_factor",
    DEFLECTION: "displacement_factor",
    IMPORTANCE: "importance_factor",
}


# --- the tables [separation] and [simulation] ---


class Numbers(Form):
    """Numbers of code rules in place of their defaults; ``more`` has them by name."""

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """The rules that have a number."""
        rules = {name: rule.number for name, rule in CODE_RULES.items() if rule.number}
        return {name: Key(WithUnit(n.units, POSITIVE), name, None) for name, n in rules.items()}


class Wanted(Form):
    """What the separation is asked for."""

    existing: list[float] = key(ListOf(GAP_LENGTH, "listed"), "Existing gap", ())
    confidence: float = key(CONFIDENCE_LEVEL, "Confidence of no pounding")
    risk: str | float | None = key(RISK, "Allowed risk of pounding", None)
    floors_align: bool = key(TRUTH, "Floors at the same levels", False)
    same_property: bool = key(TRUTH, "On one property", False)
    same_system: bool = key(TRUTH, "Same structural system", False)
    codes: list[str] = key(
        ListOf(TEXT, "listed"), "Building codes that you apply, or countries", ()
    )
    zone: str | None = key(Word(tuple(ZONES)), "Zone of Mexico City", None)
    design_pga: float | None = key(PGA, "Peak ground acceleration of the design", None)
    numbers: Numbers = key(Inner((Numbers,)), "Numbers of rules", Numbers(table=NO_TABLE))

    def check(self, buildings: Sequence[Building], site: CaseSite) -> None:
        """Raise a ValueError for a wrong number of gaps, or a risk the hazard does not reach."""
        count = max(len(buildings) - 1, 1)
        if len(self.existing) not in (0, count):
            what = (
                f"does not fit the number of buildings, {len(buildings)}; allowed: {count} in all"
            )
            raise self.table.error("existing", what)
        if self.risk is not None:
            if site.hazard is None:
                raise self.table.error("risk", "needs a hazard; allowed: with [site.hazard]")
            with self.table.naming("risk"):
                check_target(site.hazard, self.risk)
            if text := doubt_of_text(self.risk):
                self.table.warn("risk", text)
        pga = self.design_pga
        spectrum = site.spectrum
        if pga is not None and spectrum is not None and (above := doubt_of_pga(spectrum, pga)):
            self.table.warn("design_pga", above)
        if self.floors_align and (slabs := slabs_of_row(buildings)):
            what = f"is not so: {slabs[0].words}; codes are asked as if it were false"
            self.table.warn("floors_align", what)

    def applied_codes(self, buildings: Sequence[Building], site: CaseSite) -> tuple[str, ...]:
        """Names of the codes that are applied; by default that of the site, if it can be."""
        about = {} if site.spectrum is None else site.spectrum.attrs
        codes = self.codes or [about[name] for name in ("code",) if name in about]
        rules = {rule.name: rule for name in codes for rule in self._rules(name)}
        lacking = [
            (building, missing, rule.name)
            for rule, building in product(rules.values(), buildings)
            if (missing := missing_of(building, rule, site.spectrum is not None))
        ]
        if lacking and self.codes:
            (building, missing, code), *_ = lacking
            where = ", or a site by its spectrum" if site.spectrum is None else ""
            what = f"is missing: {code} needs it{where}, or leave the code out of codes"
            raise building.form.table.error(missing, what)
        for building in buildings if lacking or not rules else ():
            unused = [n for n in ("displacements", *CODE_KEYS.values()) if n in building.form.table]
            if unused:
                reasons = [
                    f"since {code}, the code of the site, needs {missing} as well"
                    for other, missing, code in lacking
                    if other is building
                ]
                cure = '; name your code, as codes = ["eurocode_8"]'
                what = f"is not used, {reasons[-1]}" if reasons else f"is not used{cure}"
                building.form.table.warn(unused[0], what)
        return () if lacking else tuple(rules)

    def _rules(self, name: str) -> tuple[CodeRule, ...]:
        """The rules of a code or a country that can be applied."""
        rules = rules_of(name)
        if not rules:
            countries = sorted(
                {country for rule in CODE_RULES.values() for country in rule.countries}
            )
            allowed = [*CODE_RULES, *countries]
            said = other_code(name) or hint(name, allowed)
            # with the nearest name, the countries are not needed
            listed = CODE_RULES if said else allowed
            what = f"has {plain(name)!r}, which is not known; {said}allowed: {', '.join(listed)}"
            raise self.table.error("codes", f"{what}, or {OWN_RULE}")
        for rule in rules:
            if rule.takes_peaks() and not rule.multiplies:
                raise self.table.error(
                    "codes", f"has {rule.name}, which states no factor; leave it out"
                )
            if rule.name not in (*code_rule_names(), *self.numbers.more):
                what = f"has {rule.name}, but its number is missing"
                raise self.table.error("codes", f"{what}, as numbers = {{ {rule.name} = 0.02 }}")
        return rules


def factors_of(building: Building) -> dict[str, float]:
    """Factors of the code of a building that the file has, by their general names."""
    values = {name: getattr(building.form, key) for name, key in CODE_KEYS.items()}
    return {name: value for name, value in values.items() if value is not None}


def missing_of(building: Building, rule: CodeRule, has_spectrum: bool) -> str:
    """The first key of a building that is missing for a rule; empty if none is.

    Displacements under design forces are given, or those of the spectrum divided by the behaviour
    factor, which has no effect for a code that multiplies by it again.
    """
    if not rule.multiplies:
        return ""
    if building.form.displacements:
        needed = [rule.multiplies]
    elif not has_spectrum:
        return "displacements"
    else:
        needed = [] if rule.multiplies == BEHAVIOUR else [BEHAVIOUR, rule.multiplies]
    factors = factors_of(building)
    return next((CODE_KEYS[name] for name in needed if name not in factors), "")


class Simulated(Form):
    """The table [simulation]."""

    paths: int | None = key(
        Integer(FEWEST_PATHS), "Simulated motions; else as many as needed", None
    )
    seed: int = key(Integer(0), "Seed of the motions", 0)

    @property
    def motions(self) -> int:
        """Number of simulated motions, in whole groups of 32."""
        return whole_groups(self.paths or MOST_PATHS)


# --- the tables [contact] and [measures] ---


class OfContact(Form):
    """A contact by the name of its model; ``more`` are the arguments of the model."""

    model: str = key(Word(lambda: [*CONTACTS]), "Model of the contact")

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the arguments of the model; those that it does not declare are ratios."""
        keys = keys_of(cls)
        kind = CONTACTS.get(str(table.values.get("model")), Contact)
        arguments = inspect.signature(kind).parameters
        for name, argument in arguments.items():
            ratio = WithUnit("1", RESTITUTION if name == "restitution" else DAMPING)
            parameter = key_of(kind, name) if name in kind.parameter_names() else Key(ratio, "")
            keys[name] = parameter._replace(
                default=MISSING if argument.default is argument.empty else None
            )
        if "stiffness" in keys and "exponent" in keys:
            exponent = table.values.get("exponent", arguments["exponent"].default)
            keys["stiffness"] = _in_units(keys["stiffness"], f"N/m^{exponent}")
        return keys

    def contact(self) -> Contact:
        """The contact."""
        return self.table.asked(self.table.made(CONTACTS[self.model], **self.more))


class OfWall(Form):
    """A rigid wall beside the first or last building."""

    described_as = "a wall, which has no mass"

    gap: float = key(GAP_LENGTH, "Gap to the building")
    fixed: str = key(Word((TO_GROUND, IN_SPACE)), "What it is fixed to", TO_GROUND)
    levels: list[float] = key(
        ListOf(BUILDING_HEIGHT, "listed"), "Levels that it touches; else all floors", ()
    )

    def wall(self) -> Wall:
        """The wall."""
        return self.table.made(Wall, fixed=self.fixed, levels=self.levels or None)


class OfLink(Form):
    """A link; ``more`` are its parameters."""

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the parameters of a link; the unit of a damping constant depends on the exponent."""
        keys = keys_of_model(Link, DEVICE)
        power = table.values.get("damping_exponent", 1)
        if power != 1:
            keys["damping_constant"] = _in_units(keys["damping_constant"], f"N (s/m)^{power}")
        return keys_of(cls) | keys

    def link(self, **ends: Any) -> Link:
        """The link with these ends."""
        if not {"stiffness", "damping_constant"} & self.more.keys():
            raise self.table.error(
                "", "is a link that does nothing; give stiffness or damping_constant"
            )
        return self.table.made(Link, **self.more, **ends)


class Between(OfLink):
    """A link between the first two buildings."""

    floors: list[int] | None = key(
        TWO_FLOORS, "Floors that the link ties, one of each building", None
    )

    def links(self, buildings: Sequence[Building]) -> list[Link]:
        """The link."""
        counts = [building.floors for building in buildings]
        if self.floors and any(map(int.__gt__, self.floors, counts)):
            raise self.table.error("floors", f"are not of both buildings; allowed: up to {counts}")
        return [self.link(floors=self.floors)]


class Devices(OfLink):
    """Damping devices in storeys of one building, all alike."""

    storeys: Any = key(STOREY_NUMBERS, "Storeys that have one", ALL_STOREYS)

    def links(self, number: int, building: Building) -> list[Link]:
        """A link in each storey; an oscillator has one storey."""
        every = range(1, building.floors + 1)
        storeys = every if self.storeys == ALL_STOREYS else self.storeys
        if not {*storeys} <= {*every}:
            allowed = f"allowed: {ALL_STOREYS!r}, or storeys 1 to {building.floors}"
            what = f"is not in {building.name}; {allowed}"
            raise self.table.error("storeys", what)
        return [self.link(structures=(number, number), floors=(n, n - 1)) for n in storeys]


class OfMeasure(Form):
    """A measure between the first two buildings, or in them; ``more`` are its other parameters."""

    described_as = "a measure without contact (a bumper is [contact], for 'stochlin pound')"

    link: Between | None = key(Inner((Between,)), "Link between the buildings", None)
    dampers_1: Devices | None = key(Inner((Devices,)), "Devices in storeys of building 1", None)
    dampers_2: Devices | None = key(Inner((Devices,)), "Devices in storeys of building 2", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the parameters of a measure."""
        return keys_of_model(Measure) | keys_of(cls)

    def measure(self, buildings: Sequence[Building]) -> Measure:
        """The measure."""
        if not self.table.values:
            raise self.table.error("", f"does nothing; allowed: {', '.join(self.keys(self.table))}")
        links = self.link.links(buildings) if self.link else []
        for number, devices in enumerate((self.dampers_1, self.dampers_2), start=1):
            if devices is not None:
                links += devices.links(number, buildings[number - 1])
        return self.table.made(Measure, **self.more, link=links)


def _in_units(number: Key, units: str) -> Key:
    """A key with this unit of its number."""
    return number._replace(kind=replace(number.kind, units=units))


def _measures(table: TomlTable, buildings: Sequence[Building]) -> dict[str, Measure]:
    """The measures for the first two buildings, by name, in the order of the file."""
    if table.values and len(buildings) == 1:
        raise table.error("", "are measures for two buildings; allowed: with [building_2]")
    return {
        n: table.table(n, forms=(OfMeasure,)).read(OfMeasure).measure(buildings[:2])
        for n in table.values
    }


# --- the whole file ---


class WholeCase(Form):
    """The tables of a file; ``more`` are the buildings from left to right."""

    title: str = key(TEXT, "Title of all results", "")
    site: TomlTable = key(Inner(SITES, later=True), "Ground and records")
    motion: TomlTable = key(Inner(MOTIONS, later=True), "Duration and envelope")
    separation: Wanted = key(Inner((Wanted,)), "What is wanted")
    simulation: Simulated = key(Inner((Simulated,)), "Simulated motions", Simulated(table=NO_TABLE))
    contact: OfContact | None = key(Inner((OfContact,)), "Contact between the buildings", None)
    wall_left: OfWall | None = key(Inner((OfWall,)), "Wall beside the first building", None)
    wall_right: OfWall | None = key(Inner((OfWall,)), "Wall beside the last building", None)
    measures: TomlTable | None = key(Inner((), later=True), "Measures, each with its name", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the buildings, none left out, and the next one, which a wrong name may mean."""
        count = max(1, sum(1 for name in table.values if NUMBERED.fullmatch(name)))
        needed = Key(Inner(FORMS, later=True), "A building")
        names = [f"building_{n}" for n in range(1, count + 1)]
        after = {f"building_{count + 1}": needed._replace(default=None)}
        return keys_of(cls) | dict.fromkeys(names, needed) | after


@dataclass(frozen=True)
class Case:
    """What a case file says, in SI units.

    ``described`` are the buildings as the file has them, and ``buildings`` have the strength that
    gives them their ductility on the ground. ``codes`` are the rules that the engineer applies.
    """

    whole: WholeCase
    site: CaseSite = field(compare=False, repr=False)
    described: tuple[Building, ...] = field(compare=False, repr=False)
    wanted: Wanted = field(compare=False)
    simulated: Simulated = field(compare=False)
    codes: tuple[str, ...] = field(compare=False)
    contact: Contact | None = field(compare=False)
    measures: Mapping[str, Measure] = field(compare=False)
    doubts: tuple[str, ...] = field(compare=False, default=())  # on what the file says

    @property
    def title(self) -> str:
        """Title of all results."""
        *others, last = (building.name for building in self.described)
        return self.whole.title or " and ".join(filter(None, [", ".join(others), last]))

    @property
    def alone(self) -> bool:
        """Whether there is one building, beside its property line."""
        return len(self.described) == 1

    @property
    def in_inches(self) -> bool:
        """Whether the file has lengths in inches or feet."""
        return any(map(INCHES_OR_FEET.fullmatch, texts_within(self.whole.table.values)))

    @property
    def walls(self) -> tuple[OfWall | None, OfWall | None]:
        """The walls on the left and on the right of the buildings, for `pound_case`."""
        return self.whole.wall_left, self.whole.wall_right

    @property
    def files(self) -> list[Path]:
        """The case file and those that it names."""
        return self.whole.table.source.files

    @property
    def periods(self) -> list[float]:
        """Periods of the buildings [s], of small oscillations."""
        return [building.period for building in self.buildings]

    @property
    def slabs(self) -> tuple[SlabOnColumn, ...]:
        """Floor slabs that meet columns of a neighbour."""
        return slabs_of_row(self.described)

    @property
    def uncertain(self) -> dict[str, UncertainModel]:
        """Buildings and ground with uncertain parameters, by name."""
        models = {building.name: building.sampled for building in self.buildings}
        models["ground"] = self.site.sampled_ground
        return {name: model for name, model in models.items() if isinstance(model, UncertainModel)}

    @cached_property
    def buildings(self) -> tuple[Building, ...]:
        """The buildings from left to right."""
        return tuple(building.on(self.site) for building in self.described)


def texts_within(values: Any) -> Iterator[str]:
    """All texts of the values of a table, and of the tables and lists within."""
    if isinstance(values, str):
        yield values
    elif isinstance(values, Mapping | list):
        for value in values.values() if isinstance(values, Mapping) else values:
            yield from texts_within(value)


@checked
def read_case(path: str | os.PathLike[str] | dict[str, Any]) -> Case:
    """Read a case file, or a dictionary with the content of one.

    Parameters
    ----------
    path : str, path or dict
        Path of the case file, TOML as ``stochlin gap --example`` prints it. Values with a unit are
        texts such as ``"0.8 s"``; paths of other files are relative to it. Nothing in the file is
        evaluated as code. A dictionary has the same tables and keys, and names no files, for it may
        be another's.

    Returns
    -------
    Case
        What the file says. Of its parts ``site`` has ``ground``, ``spectrum``, ``records``,
        ``hazard``, ``scatter`` [-] and ``course``, the duration [s] and the envelope; each of its
        ``buildings`` has its ``structure``, which is an argument of the functions, and ``sampled``
        with its uncertain parameters; ``wanted`` has the ``existing`` gaps [m], the ``confidence``
        [-] and the ``risk``; ``simulated`` the ``paths`` and the ``seed``; ``contact`` and
        ``measures`` are arguments of `pound` and `mitigate`.

    Raises
    ------
    OSError
        If the file cannot be read.
    ValueError
        If the file is not valid TOML, or a dictionary names a file; if a key is unknown or missing,
        a unit is missing or unknown, or a value is not a number or out of range; if a building has
        no strength or two, or keys of both an oscillator and a building with storeys; if there are
        too many or too few gaps, or a link ties a floor that does not exist; if there are too many
        or too few displacements of a design, or a code to be applied lacks one of its factors; or
        if a record cannot be read or fitted. The message names the file, the line, the key and what
        is allowed.

    Warns
    -----
    UserWarning
        If a value is allowed, and no building, motion or gap has it, such as a gap above 1 m or a
        confidence below 0.5, which are asked about in Python as well; if a motion ends before its
        strong part; or if floors are stated to align and do not.

    Examples
    --------
    >>> import pathlib, tempfile, stochlin as sl
    >>> lines = '''
    ...     site = {ground = "firm", intensity = "0.01 m^2/s^3"}
    ...     motion = {duration = "20 s", envelope = "none"}
    ...     separation = {confidence = 0.9, existing = "5 cm"}
    ...     building_1 = {period = "1 s", damping = 0.05, elastic = true}
    ...     building_2 = {period = "0.6 s", damping = 0.05, elastic = true}
    ... '''
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "case.toml"
    >>> _ = path.write_text(lines, encoding="utf-8")
    >>> case = sl.read_case(path)
    >>> [building.structure.period for building in case.buildings], case.wanted.existing
    ([1.0, 0.6], [0.05])
    """
    if isinstance(path, dict):
        return case_of(TomlTable(Source(Path("case"), "", []), path))
    return case_of(read_table(input_path("path", path)))


def check_together(buildings: Sequence[Building], site: CaseSite) -> None:
    """Warn of what tables of a case contradict in one another, or have in common by mistake.

    A ValueError is raised if motions are shorter than a period.
    """
    for n, (building, other) in enumerate(pairwise(buildings), start=2):
        if isinstance(building.sampled, Model) and building.sampled.moves_as(other.sampled):
            what = f"is the same as that before, {building.name}; usual are two that differ"
            other.form.table.warn("", f"is doubtful: building {n} {what}")
    longest = math.inf if site.spectrum is None else float(site.spectrum.period[-1])
    for building in buildings:
        if isinstance(site.motion, MotionForm) and building.period > site.motion.duration:
            what = f"is shorter than the period of {building.name}, {building.period:.3g} s"
            raise site.motion.table.error("duration", f"{what}; allowed: one period or more")
        if longest < LEAST_REACH * building.period:
            ends = f"ends at {longest:g} s, and {building.name} has {building.period:.3g} s"
            site.form.table.warn("spectrum", f"is doubtful: it {ends}; usual are spectra to 4 s")
    pga = site.goal.get("pga") or site.pga or math.nan
    for name, record in site.records.items():
        ratio = float(abs(record).max()) / pga
        if text := PLAUSIBLE["peak over that of the site"].doubt(ratio):
            what = f"the peak of {name} is {ratio:.3g} times that of the site; {text}"
            site.form.table.warn(
                "records" if site.form.records else "suite", f"is doubtful: {what}"
            )


def case_of(table: TomlTable) -> Case:
    """The case of a file, with what was doubted while it was read."""
    caught: list[warnings.WarningMessage] = []
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            case = _case_of(table)
    finally:  # also where the file is refused
        for warning in caught:
            warnings.warn_explicit(
                warning.message, warning.category, warning.filename, warning.lineno
            )
    return replace(case, doubts=tuple(str(warning.message) for warning in caught))


@unquestioned()
def _case_of(table: TomlTable) -> Case:
    """The case of a file."""
    whole = table.read(WholeCase)
    site = read_site(whole.site, whole.motion)
    buildings = tuple(
        read_building(building, n) for n, building in enumerate(whole.more.values(), start=1)
    )
    whole.separation.check(buildings, site)
    check_together(buildings, site)
    return Case(
        whole=whole,
        site=site,
        described=buildings,
        wanted=whole.separation,
        simulated=whole.simulation,
        codes=whole.separation.applied_codes(buildings, site),
        contact=None if whole.contact is None else whole.contact.contact(),
        measures=_measures(table.table("measures"), buildings),
    )


def forms_of(name: str) -> Sequence[type[Form]]:
    """The forms of a table by its name, such as ``site.hazard`` or ``building_1``."""
    forms: Sequence[type[Form]] = (WholeCase,)
    for part in name.split("."):
        forms = next(form.keys(NO_TABLE)[part].kind.forms for form in forms)
    return forms
