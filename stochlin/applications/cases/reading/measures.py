"""The tables [contact] and [measures] of a case file."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, replace
from typing import Any

from stochlin.applications.cases.reading.buildings import Building
from stochlin.applications.cases.reading.kinds import (
    Inner,
    Key,
    ListOf,
    Quantity,
    Word,
    integer,
    key,
    key_of,
    keys_of,
    keys_of_model,
)
from stochlin.applications.cases.reading.tables import Form, Table
from stochlin.models.arguments import A_LABEL, is_label
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import CONTACTS, DAMPING, RESTITUTION
from stochlin.models.links import Link
from stochlin.models.measures import Measure

DEVICE = ("stiffness", "damping_constant", "damping_exponent", "hardening", "yield_displacement")
ALL = "all"


@dataclass(frozen=True, kw_only=True)
class OfContact(Form):
    """A contact by the name of its model; ``more`` are the arguments of the model."""

    model: str = key(Word(lambda: [*CONTACTS]), "Model of the contact")

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """With the arguments of the model; those that it does not declare are ratios."""
        keys, kind = keys_of(cls), CONTACTS.get(str(table.values.get("model")))
        arguments = inspect.signature(kind).parameters if kind else {}
        for name, argument in arguments.items():
            ratio = Quantity("1", RESTITUTION if name == "restitution" else DAMPING)
            declared = kind is not None and name in kind.parameter_names()
            known = key_of(kind, name) if kind and declared else Key(ratio, "")
            keys[name] = known._replace(default=MISSING if argument.default is argument.empty else None)
        if "stiffness" in keys and "exponent" in keys:
            exponent = table.values.get("exponent", arguments["exponent"].default)
            keys["stiffness"] = _in_units(keys["stiffness"], f"N/m^{exponent}")
        return keys

    def contact(self) -> Contact:
        """The contact."""
        contact: Contact = self.table.made(CONTACTS[self.model], **self.more)
        return contact


@dataclass(frozen=True, kw_only=True)
class Devices(Form):
    """Damping devices in storeys of one building, each parameter one for all or a list."""

    goes_with = (("hardening", "yield_displacement"), ("damping_exponent", "damping_constant"))

    storeys: Any = key(ListOf(integer(1), "listed"), "Storeys with a device, or all", ALL)

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """With the parameters of a link."""
        keys = {**keys_of(cls), **keys_of_model(Link, DEVICE, single="alone")}
        if table.values.get("storeys") == ALL:
            keys["storeys"] = Key(Word((ALL,)), "Storeys with a device")
        return _with_power(keys, "", table)

    def links(self, number: int, building: Building) -> list[Link]:
        """A link in each storey; an oscillator has one storey."""
        storeys = [*range(1, building.floors + 1)] if self.storeys == ALL else self.storeys
        if max(storeys) > building.floors:
            what = f"is not in {building.name}; allowed: {ALL!r}, or storeys 1 to {building.floors}"
            raise self.table.error("storeys", what)
        each = {n: v if isinstance(v, list) else [v] * len(storeys) for n, v in self.more.items()}
        for name, values in each.items():
            if len(values) != len(storeys):
                what = f"has {len(values)} values for dampers in {len(storeys)} storeys"
                raise self.table.error(name, f"{what}; allowed: one for all of them, or one for each")
        of_each = ({name: values[n] for name, values in each.items()} for n in range(len(storeys)))
        return [
            _link(self.table, values, structures=(number, number), floors=(storey, storey - 1))
            for storey, values in zip(storeys, of_each, strict=True)
        ]


@dataclass(frozen=True, kw_only=True)
class OfMeasure(Form):
    """A measure between the first two buildings, or in them; ``more`` are parameters of its link."""

    goes_with = tuple((f"link_{name}", f"link_{other}") for name, other in Devices.goes_with)

    link_floors: list[int] | None = key(
        ListOf(integer(1), length=2), "Floors that the link ties, one of each building", None
    )
    dampers_1: Table | None = key(Inner(), "Devices in storeys of building 1", None)
    dampers_2: Table | None = key(Inner(), "Devices in storeys of building 2", None)
    contact: Table | None = key(Inner(), "Contact with the measure", None)

    @classmethod
    def keys(cls, table: Table) -> dict[str, Key]:
        """With the parameters of a measure, and of a link after a prefix."""
        link = {f"link_{name}": each for name, each in keys_of_model(Link, DEVICE).items()}
        keys = {**keys_of_model(Measure), **keys_of(cls), **link}
        return _with_power(keys, "link_", table)

    def measure(self, buildings: Sequence[Building]) -> Measure:
        """The measure."""
        if not self.table.values:
            raise self.table.error("", f"does nothing; allowed: {', '.join(self.keys(self.table))}")
        link = {n.removeprefix("link_"): v for n, v in self.more.items() if n.startswith("link_")}
        own = {name: value for name, value in self.more.items() if not name.startswith("link_")}
        for name, value in own.items():
            if "ening" in name and value < 1:
                what = f"it leaves less than there is; to add that, write {name} = {1 + value:g}"
                self.table.warn(name, f"is doubtful: {what}")
        links = (
            [_link(self.table, link, floors=self._floors(buildings))] if link or self.link_floors else []
        )
        for number, devices in enumerate((self.dampers_1, self.dampers_2), start=1):
            if devices is not None:
                links += devices.read(Devices).links(number, buildings[number - 1])
        if links:
            own["link"] = links[0] if len(links) == 1 else links
        if self.contact is not None:
            own["contact"] = self.contact.read(OfContact).contact()
        measure: Measure = self.table.made(Measure, **own)
        return measure

    def _floors(self, buildings: Sequence[Building]) -> tuple[int, int] | None:
        """The floors that the link ties, one of each building."""
        if self.link_floors is None:
            return None
        counts = [building.floors for building in buildings]
        if any(floor > count for floor, count in zip(self.link_floors, counts, strict=True)):
            each = (f"1 to {building.floors} of {building.name}" for building in buildings)
            what = f"is not a floor of each building; allowed: {' and '.join(each)}"
            raise self.table.error("link_floors", f"{what}, as link_floors = {counts}")
        return self.link_floors[0], self.link_floors[1]


def _link(table: Table, values: Mapping[str, Any], **ends: Any) -> Link:
    """A link with these parameters and ends."""
    if not {"stiffness", "damping_constant"} & values.keys():
        raise table.error(
            "", "has a link that does nothing; allowed: a stiffness, a damping constant, or both"
        )
    link: Link = table.made(Link, **values, **ends)
    return link


def read_measures(table: Table, buildings: Sequence[Building]) -> dict[str, Measure]:
    """The measures for the first two buildings, by name, in the order of the file."""
    for name in table.values:
        if not is_label(name):
            raise table.error(name, f"has a name that cannot be shown; allowed: {A_LABEL}")
        if len(buildings) == 1:
            what = "is a measure for two buildings, and there is only one; leave out [measures], or"
            raise table.error(name, f"{what} write a line [building_2] and its keys below it")
    return {n: table.table(n).read(OfMeasure).measure(buildings[:2]) for n in table.values}


def _with_power(keys: dict[str, Key], prefix: str, table: Table) -> dict[str, Key]:
    """The keys of a link; the unit of a damping constant depends on the exponent."""
    power, name = table.values.get(f"{prefix}damping_exponent", 1), f"{prefix}damping_constant"
    return keys if power == 1 else keys | {name: _in_units(keys[name], f"N (s/m)^{power}")}


def _in_units(known: Key, units: str) -> Key:
    """A key with this unit of its number, or of the numbers of its list."""
    kind = known.kind
    inner = replace(kind.kind if isinstance(kind, ListOf) else kind, units=units)
    return known._replace(kind=replace(kind, kind=inner) if isinstance(kind, ListOf) else inner)
