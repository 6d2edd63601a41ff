"""The tables [contact], [measures] and [mitigation] of a case file."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from typing import Any

from stochlin.analyses.cases.buildings import AnyBuilding
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.models.arguments import A_LABEL, is_label, is_whole
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import CONTACTS, DAMPING, RESTITUTION
from stochlin.models.links import Link
from stochlin.models.measures import Measure

NUMBERS = Measure.parameter_names()
OF_STRENGTH = ("stiffening", "strengthening")
DEVICE = ("stiffness", "damping_constant", "damping_exponent", "hardening", "yield_displacement")
LINK = tuple(f"link_{name}" for name in DEVICE)
FLOORS = "link_floors"
DAMPERS = ("dampers_1", "dampers_2")
ALL = "all"


def read_contact(section: Section) -> Contact:
    """The contact of a table, by the name of its model and the parameters of this model."""
    kind = CONTACTS[section.text("model", tuple(CONTACTS))]
    names = inspect.signature(kind).parameters
    section.only("model", *names)
    needed = [name for name, parameter in names.items() if parameter.default is inspect.Parameter.empty]
    keys = dict.fromkeys([*needed, *(key for key in section.values if key != "model")])
    return section.made(kind, {n: section.number(n, _quantity(section, kind, n)) for n in keys})


def read_measures(whole: Section, buildings: Sequence[AnyBuilding]) -> dict[str, Measure]:
    """The measures for the first two buildings, by name, in the order of the file."""
    table = whole.section("measures", needed=False)
    for name in table.values:
        if not is_label(name):
            raise table.error(name, f"has a name that cannot be shown; allowed: {A_LABEL}")
        if len(buildings) == 1:
            raise table.error(
                name,
                "is a measure for two buildings, and there is only one; leave out [measures], or write "
                "a line [building_2] and its keys below it",
            )
    return {name: _measure(table.section(name), buildings[:2]) for name in table.values}


def read_amplification_limit(whole: Section) -> float | None:
    """The largest accepted amplification [-], if it is given."""
    if "mitigation" not in whole:
        return None
    section = whole.section("mitigation")
    section.only(*section.keys)
    return float(section.read("amplification_limit"))


def _quantity(section: Section, kind: type[Contact], name: str) -> Quantity:
    """Unit and range of an argument of a contact; undeclared arguments are restitution and damping."""
    if name not in kind.parameter_names():
        return Quantity("1", RESTITUTION if name == "restitution" else DAMPING)
    declared = Quantity.declared(kind, name)
    if not declared.units.endswith("^n"):
        return declared
    power = inspect.signature(kind).parameters["exponent"].default
    if "exponent" in section:
        power = section.number("exponent", Quantity.declared(kind, "exponent"))
    return declared._replace(units=declared.units.replace("^n", f"^{power:g}"))


def _measure(section: Section, buildings: Sequence[AnyBuilding]) -> Measure:
    keys = (*NUMBERS, *LINK, FLOORS, *DAMPERS, "contact")
    section.only(*keys)
    if not section.values:
        raise section.error("", f"does nothing; allowed: {', '.join(keys)}")
    values: dict[str, Any] = section.given(Measure, NUMBERS)
    _doubt_weakening(section, values)
    link = _law(section, "link_")
    if FLOORS in section:
        if not link:
            raise section.error(FLOORS, f"has no link to tie; allowed: beside {' or '.join(LINK)}")
        link["floors"] = _floors(section, buildings)
    links = [section.made(Link, link)] if link else []
    for number, (key, building) in enumerate(zip(DAMPERS, buildings, strict=True), start=1):
        if key in section:
            links += _devices(section.section(key), number, building)
    if links:
        values["link"] = links[0] if len(links) == 1 else links
    if "contact" in section:
        values["contact"] = read_contact(section.section("contact"))
    return section.made(Measure, values)


def _doubt_weakening(section: Section, values: Mapping[str, float]) -> None:
    """Warn of a stiffening or strengthening factor below 1, where an increase may be meant."""
    for key in (f"{name}_{number}" for name in OF_STRENGTH for number in (1, 2)):
        if values.get(key, 1.0) < 1:
            more = f"{key} = {1 + values[key]:g}"
            section.doubt(key, f"is doubtful: it leaves less than there is; to add that, write {more}")


def _law(section: Section, prefix: str = "", listed: bool = False) -> dict[str, Any]:
    """Parameters of a link in the file; if ``listed``, each may be a list with a number per storey."""
    names = [name for name in Link.parameter_names() if f"{prefix}{name}" in section]
    for name, other in (("hardening", "yield_displacement"), ("damping_exponent", "damping_constant")):
        if name in names and other not in names:
            what = "link that yields" if name == "hardening" else "dashpot"
            raise section.error(f"{prefix}{name}", f"is of a {what}; allowed: beside {prefix}{other}")
    values: dict[str, Any] = {}
    for name in sorted(names, key=lambda name: name != "damping_exponent"):  # the unit depends on it
        key, quantity = f"{prefix}{name}", Quantity.declared(Link, name)
        power = values.get("damping_exponent", 1.0)
        if name == "damping_constant" and power != 1:
            quantity = quantity._replace(units=f"N (s/m)^{power:g}")
        single = not listed or name == "damping_exponent"
        values[name] = section.number(key, quantity) if single else section.number_or_list(key, quantity)
    return values


def _devices(section: Section, number: int, building: AnyBuilding) -> list[Link]:
    """Damping devices in storeys of a building, one in each storey."""
    section.only("storeys", *DEVICE)
    law = _law(section, listed=True)
    if not {"stiffness", "damping_constant"} & {*law}:
        raise section.error("", "does nothing; allowed: stiffness, damping_constant, or both")
    storeys = _storeys(section, building)
    for key, value in law.items():
        if isinstance(value, list) and len(value) != len(storeys):
            raise section.error(
                key,
                f"has {len(value)} values for dampers in {len(storeys)} storeys; allowed: one number "
                "for all of them, or one for each",
            )
    return [
        section.made(
            Link,
            {key: value[n] if isinstance(value, list) else value for key, value in law.items()}
            | {"structures": (number, number), "floors": (storey, storey - 1)},
        )
        for n, storey in enumerate(storeys)
    ]


def _storeys(section: Section, building: AnyBuilding) -> list[int]:
    """Numbers of the storeys with a device, from 1; an oscillator has one storey."""
    count = building.storeys if isinstance(building, StoreyBuilding) else 1
    storeys = section.values.get("storeys", ALL)
    if storeys == ALL:
        return list(range(1, count + 1))
    fits = isinstance(storeys, list) and storeys and all(map(is_whole, storeys))
    if not fits or not all(1 <= storey <= count for storey in storeys) or len({*storeys}) < len(storeys):
        numbers = f"1 to {count}" if count > 1 else "1, since it is an oscillator"
        raise section.error(
            "storeys",
            f"is not a list of storeys of {building.name}; allowed: {ALL!r}, or a list of whole "
            f"numbers, {numbers}, each once",
        )
    return list(storeys)


def _floors(section: Section, buildings: Sequence[AnyBuilding]) -> tuple[int, int]:
    """Numbers of the floors that a link ties, one of each building; an oscillator has one floor."""
    floors = section.values[FLOORS]
    counts = [b.storeys if isinstance(b, StoreyBuilding) else 1 for b in buildings]
    fits = isinstance(floors, list) and len(floors) == len(counts) and all(map(is_whole, floors))
    if not fits or not all(1 <= floor <= count for floor, count in zip(floors, counts, strict=True)):
        numbers = " and ".join(
            f"1 to {count} of {b.name}" if count > 1 else f"1 of {b.name}"
            for b, count in zip(buildings, counts, strict=True)
        )
        raise section.error(
            FLOORS,
            f"is not a floor of each building; allowed: two whole numbers, {numbers}, as {FLOORS} = "
            f"{counts}",
        )
    return floors[0], floors[1]
