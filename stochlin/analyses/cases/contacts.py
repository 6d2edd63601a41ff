"""What the buildings of a case file meet at, and the measures against pounding that it names."""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from typing import Any

from stochlin.analyses.cases.buildings import AnyBuilding
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.cases.values import Quantity, Section
from stochlin.analyses.tables.checks import A_LABEL, is_label, is_whole
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import CONTACTS, DAMPING, RESTITUTION
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.parameters import POSITIVE

DAMPINGS = ("added_damping_1", "added_damping_2")
LINK = {
    f"link_{name}": name
    for name in ("stiffness", "damping_constant", "hardening", "yield_displacement", "slack")
}
FLOORS = "link_floors"


def read_contact(section: Section) -> Contact:
    """The contact of a table: its model, and the parameters that this model takes."""
    kind = CONTACTS[section.text("model", tuple(CONTACTS))]
    names = inspect.signature(kind).parameters
    section.only("model", *names)
    needed = [name for name, one in names.items() if one.default is inspect.Parameter.empty]
    given = dict.fromkeys([*needed, *(key for key in section.values if key != "model")])
    return section.made(kind, {n: section.number(n, _quantity(section, kind, n)) for n in given})


def read_measures(whole: Section, buildings: Sequence[AnyBuilding]) -> dict[str, Measure]:
    """The measures by name, in the order of the file; none if there is no such table.

    Links are between the first two buildings.
    """
    table = whole.section("measures", needed=False)
    for name in table.values:
        if not is_label(name):
            raise table.error(name, f"has a name that cannot be shown; allowed: {A_LABEL}")
    return {name: _measure(table.section(name), buildings[:2]) for name in table.values}


def read_amplification_limit(whole: Section) -> float | None:
    """The largest amplification that is accepted, if it is said."""
    if "mitigation" not in whole:
        return None
    section = whole.section("mitigation")
    section.only("amplification_limit")
    return section.number("amplification_limit", Quantity("1", POSITIVE))


def _quantity(section: Section, kind: type[Contact], name: str) -> Quantity:
    """Unit and range; what a contact takes without declaring it are the two names of its damping."""
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
    section.only(*DAMPINGS, *LINK, FLOORS, "contact")
    if not section.values:
        raise section.error(
            "", f"does nothing; allowed: {', '.join(DAMPINGS)}, {', '.join(LINK)}, contact"
        )
    values: dict[str, Any] = section.given(Measure, DAMPINGS)
    link: dict[str, Any] = {
        own: section.number(key, Quantity.declared(Link, own))
        for key, own in LINK.items()
        if key in section
    }
    if "hardening" in link and "yield_displacement" not in link:
        raise section.error(
            "link_hardening", "is of a link that yields; allowed: beside link_yield_displacement"
        )
    if FLOORS in section:
        if not link:
            raise section.error(FLOORS, f"has no link to tie; allowed: beside {' or '.join(LINK)}")
        link["floors"] = _floors(section, buildings)
    if link:
        values["link"] = section.made(Link, link)
    if "contact" in section:
        values["contact"] = read_contact(section.section("contact"))
    return section.made(Measure, values)


def _floors(section: Section, buildings: Sequence[AnyBuilding]) -> tuple[int, int]:
    """The floors that a link ties, one of each building; an oscillator is one floor."""
    given = section.values[FLOORS]
    counts = [b.storeys if isinstance(b, StoreyBuilding) else 1 for b in buildings]
    fits = isinstance(given, list) and len(given) == len(counts) and all(map(is_whole, given))
    if not fits or not all(1 <= floor <= count for floor, count in zip(given, counts, strict=True)):
        told = " and ".join(
            f"1 to {count} of {b.name}" if count > 1 else f"1 of {b.name}"
            for b, count in zip(buildings, counts, strict=True)
        )
        raise section.error(
            FLOORS,
            f"is not a floor of each building; allowed: two whole numbers, {told}, as {FLOORS} = "
            f"{counts}",
        )
    return given[0], given[1]
