"""Buildings with storeys in a case file: from a few numbers, storey by storey, or by their modes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from stochlin.analyses.cases.files.design import Design, read_design
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.modes import modes_of
from stochlin.analyses.cases.files.pushover import check_pushover, pushed
from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.analyses.cases.files.schema import (
    BUILDING,
    BY_MODES,
    OF_PUSHOVER,
    OSCILLATOR,
    PUSHOVER,
    REGULAR,
    SINGLY,
    keys_of_way,
)
from stochlin.analyses.cases.files.sections import Section
from stochlin.messages import listed
from stochlin.models.buildings import (
    STOREYS,
    ModalBuilding,
    MultistoreyBuilding,
    RegularBuilding,
    ShearBuilding,
)
from stochlin.models.laws import laws_in_numbers
from stochlin.models.structures import Structure
from stochlin.models.systems import slabs_on_columns, tuned
from stochlin.models.uncertain import UncertainModel, applied, median_of

# Keys that tell how a building is described, the last one its strength.
WAYS = {
    REGULAR: ("period", "floor_mass", "base_shear_coefficient"),
    SINGLY: ("masses", "stiffnesses", "yield_drifts"),
}
# A building with any of these keys has storeys; an oscillator has none of them.
OF_STOREYS = [key.name for key in BUILDING.values() if key.ways and OSCILLATOR not in key.ways]
OF_MODES = [key.name for key in BUILDING.values() if key.ways == (BY_MODES,)]
OF_OSCILLATORS = [key.name for key in BUILDING.values() if key.ways == (OSCILLATOR,)]
EXAMPLES = {"period": '"0.8 s"', "floor_mass": '"400 t"', "storeys": "8", "storey_height": '"3.2 m"'}
PERIOD = Quantity.declared(RegularBuilding, "period")
COEFFICIENT = Quantity.declared(RegularBuilding, "base_shear_coefficient")


@dataclass(frozen=True)
class StoreyBuilding:
    """A building of a case with storeys; ``strength`` is the key that gives its strength in the file."""

    name: str
    structure: MultistoreyBuilding
    strength: str
    uncertain: UncertainModel | None = None  # as in `Building`
    design: Design = field(default_factory=Design)
    turning: str = ""  # modes of the file that turn in plan, whose shapes are not those of named points

    @property
    def sampled(self) -> Any:
        """The structure with its uncertain parameters, for simulations that sample them."""
        return self.uncertain or self.structure

    @property
    def height(self) -> float:
        """Level of the roof [m]."""
        return float(self.structure.levels()[-1])

    @property
    def storeys(self) -> int:
        """Number of storeys."""
        return self.structure.storeys

    @property
    def period(self) -> float:
        """Period of the first mode [s]."""
        return float(self.structure.mode_periods()[0])

    @property
    def weighed(self) -> bool:
        """Whether its mass is known, which is always the case."""
        return True

    @property
    def storey_height(self) -> float:
        """Mean storey height [m]."""
        return self.height / self.storeys


class SlabOnColumn(NamedTuple):
    """A floor slab of one building at a level [m] where its neighbour has columns.

    Buildings are counted from 1 on the left, floors and storeys from 1 at the ground.
    """

    floor: int
    column_of: int
    storey: int
    level: float
    name_of_slab: str
    name_of_column: str

    def __str__(self) -> str:
        return (
            f"floor {self.floor} of {self.name_of_slab}, at {self.level:g} m, meets the columns in "
            f"storey {self.storey} of {self.name_of_column}"
        )


def slabs_of_row(buildings: Sequence[Any]) -> tuple[SlabOnColumn, ...]:
    """Slabs that meet columns, of all neighbours whose floors are known, pair by pair from the left."""
    slabs = []
    for number, pair in enumerate(pairwise(buildings), start=1):
        if not all(isinstance(building, StoreyBuilding) for building in pair):
            continue
        levels = [building.structure.levels() for building in pair]
        for side, floor in slabs_on_columns(*levels):
            level, other = float(levels[side][floor - 1]), 1 - side
            storey = int(np.searchsorted(levels[other], level)) + 1
            names = pair[side].name, pair[other].name
            slabs.append(SlabOnColumn(floor, number + other, storey, level, *names))
    return tuple(slabs)


def storey_keys(section: Section) -> list[str]:
    """The keys of a building that belong to buildings with storeys."""
    return [key for key in OF_STOREYS if key in section]


def read_storeys(section: Section, number: int, folder: Path, known: Known) -> StoreyBuilding:
    """The building with storeys; a ValueError for missing or additional keys."""
    if any(key in section for key in OF_MODES):
        return _by_modes(section, number, folder, known)
    a_few = any(key in section for key in WAYS[REGULAR][1:])
    singly = any(key in section for key in WAYS[SINGLY][: 2 if a_few else 3])
    way = SINGLY if singly else REGULAR
    name, law = law_of(section)
    _check_keys(section, list(dict.fromkeys([*WAYS[way], *keys_of_way(way), *law.own_parameters()])))
    *needed, key = WAYS[way]
    example = 'yield_drifts = "2 cm", of all storeys or a list' if singly else f"{key} = 0.15"
    strength = _strength(section, key, example)
    _check_missing(section, needed)
    _check_counts(section, [*WAYS[SINGLY], "heights", "dampers", *law.own_parameters()])
    own = [key for key in law.own_parameters() if key in section or not hasattr(law, key)]
    values: dict[str, Any] = {
        "damping": section.parameter("damping", Quantity.declared(ShearBuilding, "damping")),
        "law": name,
        "law_parameters": {key: section.number_or_list(key, Quantity.declared(law, key)) for key in own},
        "p_delta": section.read("p_delta"),
        "damping_modes": section.values.get("damping_modes"),
    }
    if strength == key:
        values["hardening"] = section.parameter(
            "hardening", Quantity.declared(ShearBuilding, "hardening")
        )
    if "dampers" in section:
        values["dampers"] = section.parameter_or_list(
            "dampers", Quantity.declared(ShearBuilding, "dampers")
        )
    described = (_singly if singly else _regular)(section, strength, values)
    if strength == PUSHOVER:
        described = pushed(section, described, folder, known)
    building = _named(section, number, described, strength, scaled=singly)
    if strength != "elastic":
        for doubt in building.structure.doubts():
            section.doubt(strength, f"is doubtful: {doubt}")
    return building


def _by_modes(section: Section, number: int, folder: Path, known: Known) -> StoreyBuilding:
    """The building by its modes, of a file or in tables."""
    name, law = law_of(section)
    allowed = [*keys_of_way(BY_MODES), *law.own_parameters()]
    for key in (*OF_STOREYS, *OF_OSCILLATORS):
        if key in section and key not in allowed:
            what = f"stiffness, mass and damping ratio; allowed: {', '.join(allowed)}"
            raise section.error(
                key, f"does not belong to a building by its modes, which have their own {what}"
            )
    section.only(*allowed)
    table = modes_of(section, folder, known)
    strength = _strength(section, "yield_displacements", 'yield_displacements = "4 cm", of mode 1')
    if "storeys" in section and section.whole("storeys", STOREYS) != table.sizes["floor"]:
        what = f"is not the number of floors of the modes, {table.sizes['floor']}; leave it out"
        raise section.error("storeys", what)
    own = [key for key in law.own_parameters() if key in section or not hasattr(law, key)]
    values: dict[str, Any] = {
        "law": name,
        "law_parameters": {key: section.number_or_list(key, Quantity.declared(law, key)) for key in own},
    }
    for key in ("damping", *(() if strength in (PUSHOVER, "elastic") else ("hardening", strength))):
        values[key] = section.parameter_or_list(key, Quantity.declared(ModalBuilding, key))
    described = section.made(ModalBuilding.from_table, {"table": table, **values})
    if strength == PUSHOVER:
        described = pushed(section, described, folder, known)
    building = _named(section, number, described, strength, scaled=True)
    return replace(building, turning=table.attrs.get("turning", ""))


def _strength(section: Section, key: str, example: str) -> str:
    """The key that gives the strength: this one, the pushover curve or ``elastic``."""
    if section.read("elastic") and "strength_factor" in section:
        what = f"goes with {key}, not with elastic = true; leave one of them out"
        raise section.error("strength_factor", what)
    strength = strength_key(
        section, (key, PUSHOVER, "elastic"), f'{example}, pushover = "push.csv", elastic = true'
    )
    check_pushover(section)
    return strength


def _named(section: Section, number: int, described: Any, strength: str, scaled: bool) -> StoreyBuilding:
    """The building with its name, and with its measured period and its strength factor."""
    factor = section.read("strength_factor")
    period = section.number("period", PERIOD) if scaled and "period" in section else None
    if period is not None or factor != 1:
        described = applied(partial(tuned, period=period, strengthening=factor), described)
    structure = median_of(described)
    return StoreyBuilding(
        section.read("name") or f"Building {number}",
        structure,
        strength,
        described if isinstance(described, UncertainModel) else None,
        read_design(section, structure.storeys, is_oscillator=False),
    )


def law_of(section: Section) -> tuple[str, type[Structure]]:
    """Name and class of the hysteresis law; a ValueError for a parameter of another law."""
    laws = laws_in_numbers()
    name = section.text("law", tuple(laws), "bilinear")
    owners: dict[str, str] = {}
    for other, law in laws.items():
        owners = dict.fromkeys(law.own_parameters(), other) | owners
    misspelled = any(key not in section.keys and key not in owners for key in section.values)
    for key, other in owners.items():
        if key in section and key not in laws[name].own_parameters() and not misspelled:
            what = f'belongs to law = "{other}", not to "{name}"; write that law, or leave it out'
            raise section.error(key, what)
    return name, laws[name]


def strength_key(section: Section, keys: Sequence[str], example: str) -> str:
    """The key by which the strength is given; a ValueError unless there is exactly one."""
    elastic = section.read("elastic")
    present = [key for key in keys if key in section and (key != "elastic" or elastic)]
    if not present:
        raise section.error("", f"has no strength; allowed: one of {example}")
    if len(present) > 1:
        raise section.error(
            present[1],
            f"is given as well: strength is given {len(present)} times, by {' and '.join(present)}; "
            f"allowed: one of {example}",
        )
    return present[0]


def _regular(section: Section, strength: str, values: dict[str, Any]) -> Any:
    """A regular building from a few numbers."""
    heights = _heights(section)
    values |= {
        "period": section.parameter("period", PERIOD),
        "mass": section.parameter("floor_mass", Quantity.declared(RegularBuilding, "mass")),
        "storey_height": heights,
        "storeys": len(heights) if isinstance(heights, list) else section.whole("storeys", STOREYS),
    }
    if strength in WAYS[REGULAR]:
        values[strength] = section.parameter(strength, COEFFICIENT)
    return section.made(ShearBuilding.regular, values)


def _singly(section: Section, strength: str, values: dict[str, Any]) -> Any:
    """A building given storey by storey."""
    for key in ("masses", "stiffnesses"):
        values[key] = section.parameters(key, Quantity.declared(ShearBuilding, key))
    heights, storeys = _heights(section), np.size(median_of(values["masses"]))
    values["heights"] = heights if isinstance(heights, list) else [heights] * storeys
    if strength in WAYS[SINGLY]:
        values[strength] = section.parameter_or_list(
            strength, Quantity.declared(ShearBuilding, strength)
        )
    return section.made(ShearBuilding, values)


def _heights(section: Section) -> float | list[float]:
    """Height of all storeys, or a list with the height of each [m]."""
    quantity = Quantity.declared(ShearBuilding, "heights")
    return (
        section.numbers("heights", quantity)
        if "heights" in section
        else section.number("storey_height", quantity)
    )


def _check_keys(section: Section, allowed: Sequence[str]) -> None:
    """Raise a ValueError for an unknown key, or a key that cannot be combined with those of storeys."""
    elsewhere = (*OF_STOREYS, *OF_OSCILLATORS, "period")
    # Those that only a pushover curve or Rayleigh damping needs would make the list too long.
    rare = (*OF_PUSHOVER, "damping_modes")
    shown = [key for key in allowed if key not in rare]
    strange = [key for key in section.values if key in elsewhere and key not in allowed]
    if strange:
        marks = [key for key in storey_keys(section) if key not in strange]
        more = f", and neither {'is' if len(strange) == 2 else 'are'} {listed(strange[1:])}"
        raise section.error(
            strange[0],
            f"is not a key that is known here{more if strange[1:] else ''}, where {_say(marks)} by its "
            f"storeys; allowed: {', '.join(shown)}; for an oscillator, leave out {listed(marks)}",
        )
    section.only(*allowed, elsewhere=elsewhere)
    if "heights" in section and "storey_height" in section:
        raise section.error("heights", "is given together with storey_height; allowed: one of them")


def _check_missing(section: Section, needed: Sequence[str]) -> None:
    """Raise a ValueError if keys that a building with storeys needs are missing."""
    if "heights" not in section:
        needed = [*needed, *([] if "masses" in needed else ["storeys"]), "storey_height"]
    missing = [key for key in needed if key not in section]
    if missing:
        marks = storey_keys(section)
        more = f", and so {'is' if len(missing) == 2 else 'are'} {listed(missing[1:])}"
        lines = ", ".join(f"{key} = {_example(key)}" for key in missing)
        raise section.error(
            missing[0],
            f"is missing{more if missing[1:] else ''}: {_say(marks)} by its storeys; write, for "
            f"instance, {lines}; for an oscillator, leave out {listed(marks)}",
        )


def _check_counts(section: Section, keys: Sequence[str]) -> None:
    """Raise a ValueError for a list whose length differs from the number of storeys."""
    if "storeys" in section:
        count = section.whole("storeys", STOREYS)
        for key in keys:
            values = section.values.get(key)
            if isinstance(values, list) and len(values) != count:
                raise section.error(
                    key, f"has {len(values)} values, but storeys = {count}; allowed: one for each storey"
                )


def _say(marks: Sequence[str]) -> str:
    return f"{listed(marks)} {'describes' if len(marks) == 1 else 'describe'} the building"


def _example(key: str) -> str:
    if key in EXAMPLES:
        return EXAMPLES[key]
    each = Quantity.declared(ShearBuilding, key).example
    return f"[{each}, {each}]"
