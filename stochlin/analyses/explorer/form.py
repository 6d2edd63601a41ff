"""The controls of the explorer, and what they say as the tables of a case file."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from stochlin.analyses.cases.case import Case, case_of
from stochlin.analyses.cases.files.design import DISPLACEMENTS
from stochlin.analyses.cases.files.keys import Key, Slider, declared
from stochlin.analyses.cases.files.known import Known
from stochlin.analyses.cases.files.quantities import Quantity, in_si
from stochlin.analyses.cases.files.schema import (
    ASCE_7,
    EUROCODE_8,
    FILE,
    OSCILLATOR,
    REGULAR,
    TABLES,
    keys_at,
)
from stochlin.analyses.cases.files.sections import Section
from stochlin.analyses.cases.site import NONE, PARALLEL
from stochlin.analyses.linearization.transient_systems import check_course
from stochlin.analyses.tables.checks import check_duration
from stochlin.messages import DoubtfulInput
from stochlin.models.envelopes import ENVELOPES
from stochlin.models.grounds import GROUNDS
from stochlin.models.grounds.named import ground_names
from stochlin.models.parameters import Model

Place = tuple[str, str]
"""Table and key of a control; some choices have a name of their own in place of a key."""

OF_FILE = "storeys of the file"
S0, PGA, SA = "intensity S₀", "peak ground acceleration", "spectral acceleration"
GROUND, ENVELOPE = ("site", "ground"), ("motion", "envelope")
MEASURES = {S0: ("intensity",), PGA: ("pga",), SA: ("sa", "sa_period")}
STRENGTHS = {"reduction factor R": "reduction_factor", "yield displacement": "yield_displacement"}
SPECTRA = (EUROCODE_8, ASCE_7, FILE)
BUILDINGS = ("building_1", "building_2")
OF_YIELDING = ("yield_drifts", "yield_displacements", "base_shear_coefficient", "hardening")
# Where the second building starts if no file says otherwise; the first one starts as its keys say.
SECOND = {"period": 0.6, "storeys": 5}
PLAIN_FLOORS = {"floor_mass": "400 t"}  # no result of the explorer depends on it


class NumberControl(NamedTuple):
    """A control of a number: a key with a slider."""

    place: Place
    key: Key

    @property
    def slider(self) -> Slider:
        """The slider of the key."""
        assert self.key.slider is not None
        return self.key.slider


class Choice(NamedTuple):
    """A control with values to choose from, or yes and no if there are none."""

    place: Place
    label: str
    options: tuple[Any, ...] = ()


Control = NumberControl | Choice
CODES = (EUROCODE_8, ASCE_7)
CHOICES: Mapping[
    tuple[str, str], Sequence[Choice]
] = {  # by the table and the key that they stand before
    ("site", "ag"): [Choice(GROUND, "Kind of ground", (*ground_names(), *GROUNDS, *CODES))],
    ("site", "sds"): [
        Choice(("site", "soil"), "Ground type", tuple("ABCDE")),
        Choice(("site", "type"), "Type of spectrum", (1, 2)),
    ],
    ("site", "pga"): [Choice(("site", "measure"), "Strength given by", (*MEASURES,))],
    ("building", "period"): [
        Choice(("", "described"), "Building {number} described as", (OSCILLATOR, REGULAR))
    ],
    ("building", "reduction_factor"): [
        Choice(("", "yields"), "Yields (off: elastic)"),
        Choice(("", "strength"), "Strength of building {number} given by", (*STRENGTHS,)),
    ],
    ("motion", "rise_end"): [Choice(ENVELOPE, "Envelope", (*ENVELOPES, NONE))],
}


class ControlGroup(NamedTuple):
    """Controls that belong together."""

    title: str
    controls: Sequence[Control]


@dataclass(frozen=True)
class Form:
    """What the controls say, in SI units, and the rest of the case file.

    Only the controls of the chosen ground, envelope, description and strength are used; the others keep
    what they say for another choice. ``file`` has the tables of the case file, and ``rest``, for each
    building and each way to describe it, what has no control. Files that are known need not be there.
    """

    values: Mapping[Place, Any]
    file: Mapping[str, Any] = field(default_factory=dict)
    rest: Mapping[str, Mapping[str, Mapping[str, Any]]] = field(default_factory=dict)
    path: Path = Path("case.toml")
    known: Known = field(default_factory=Known, compare=False, repr=False)

    def __getitem__(self, place: Place) -> Any:
        """What a control says."""
        return self.values[place]

    def changed(self, changes: Mapping[Place, Any]) -> Form:
        """The form with other values of these controls."""
        return dataclasses.replace(self, values={**self.values, **changes})

    def options(self, choice: Choice) -> tuple[Any, ...]:
        """The texts to choose from, with the ground and the storeys of the file if it has some."""
        site = self.file.get("site", {})
        if choice.place == GROUND:
            of_file = {PARALLEL: "grounds" in site, FILE: site.get("spectrum", FILE) not in SPECTRA}
            return (*choice.options, *(name for name, there in of_file.items() if there))
        if choice.place[1] == "described" and OF_FILE in self.rest.get(choice.place[0], {}):
            return (*choice.options, OF_FILE)
        return choice.options

    def uses(self, place: Place) -> bool:
        """Whether a control has an effect; the others are hidden."""
        name, name_of_key = place
        if name in BUILDINGS:
            return self._of_building(name, name_of_key)
        if name == "site":
            return self._of_site(name_of_key)
        if name == "motion" and name_of_key not in ("envelope", "duration"):
            return name_of_key in parameters_of(ENVELOPES.get(self[ENVELOPE]))
        return True

    def _of_site(self, name: str) -> bool:
        ground, key = self[GROUND], TABLES["site"].get(name)
        if name == "ground" or (key and key.noted):
            return True
        if key and key.ways:
            return ground in key.ways
        if ground in SPECTRA:
            return False
        measure = self["site", "measure"]
        measured = {key: way for way, keys in MEASURES.items() for key in keys}
        if name in measured:
            return measured[name] == measure
        return name == "measure" or name in parameters_of(GROUNDS.get(ground))

    def _of_building(self, name: str, key: str) -> bool:
        described = self[name, "described"]
        can_yield = described != OF_FILE or not self.rest[name][OF_FILE].get("elastic")
        yields = can_yield and self[name, "yields"]
        oscillator = described == OSCILLATOR
        of_strength = {
            "strength": oscillator,
            "hardening": True,
            "base_shear_coefficient": described == REGULAR,
            "strength_factor": described == OF_FILE,
            **{key: oscillator and self[name, "strength"] == way for way, key in STRENGTHS.items()},
        }
        if key in of_strength:
            return bool(yields and of_strength[key])
        if key in ("storeys", "storey_height"):
            return bool(described == REGULAR)
        return key != "yields" or can_yield

    def tables(self) -> dict[str, Any]:
        """The tables of the case file: the controls that are used, and all that has no control."""
        tables = {"title": "Two buildings", **self.file}
        tables["site"] = {**self._site(), **self._numbers("site"), **self._of_all_sites()}
        kept = {"scatter": 0.0, **self.file.get("motion", {})}
        envelope = {"scatter": kept["scatter"], "envelope": self[ENVELOPE]}
        tables["motion"] = {**self._numbers("motion"), **envelope}
        for name in BUILDINGS:
            tables[name] = self._building(name)
        for name in ("separation", "simulation"):
            tables[name] = {**self.file.get(name, {}), **self._numbers(name)}
        return {name: _in_order(table, self.file.get(name)) for name, table in tables.items()}

    def case(self) -> Case:
        """The case of these values, without what of the file does not fit its buildings.

        These are measures and the codes that are applied. A ValueError names what does not fit.
        """
        tables = self.tables()
        try:
            case = read_again(tables, self.path, self.known)
        except ValueError:
            fitting = _without_measures_and_codes(tables)
            if fitting == tables:
                raise
            tables = fitting
            case = read_again(tables, self.path, self.known)
        check_course(case.duration, case.envelope)
        buildings = {f"building {n}": b.structure for n, b in enumerate(case.pair, start=1)}
        check_duration(case.duration, buildings)
        return case

    def _site(self) -> dict[str, Any]:
        """What names the ground or the spectrum, with those keys of the file that belong to it."""
        ground, site = self[GROUND], self.file.get("site", {})
        if ground not in SPECTRA:
            parts = {"grounds": site["grounds"]} if ground == PARALLEL else {}
            return {"ground": ground, **parts}
        kept = {key: value for key, value in site.items() if key not in ("scale", "ground")}
        if ground == FILE:
            return kept
        of_code = dict(kept) if kept.get("spectrum") == ground else {}
        if ground == EUROCODE_8:
            usual = TABLES["site"]["type"].default
            of_code |= {"soil": self["site", "soil"]}
            if "type" in of_code or self["site", "type"] != usual:
                of_code |= {"type": self["site", "type"]}
        return {**of_code, "spectrum": ground}

    def _of_all_sites(self) -> dict[str, Any]:
        """Records and hazard of the file, which go with any ground."""
        site = self.file.get("site", {})
        kept = {key: site[key] for key in ("records", "suite", "hazard") if key in site}
        if self[GROUND] not in SPECTRA and "scale_to" in kept.get("suite", {}):
            del kept["suite"]
        return kept

    def _building(self, name: str) -> dict[str, Any]:
        described = self[name, "described"]
        table = {**self.rest.get(name, {}).get(described, {}), **self._numbers(name)}
        if "name" in self.file.get(name, {}):
            table = {"name": self.file[name]["name"], **table}
        if not self[name, "yields"]:
            table = {key: value for key, value in table.items() if key not in OF_YIELDING}
            table["elastic"] = True
        return table

    def _numbers(self, name: str) -> dict[str, Any]:
        """The numbers of the controls of a table that are used, as they are written in a file."""
        return {
            control.key.name: written(control.key, self[control.place], self.file.get(name, {}))
            for control in numbers()
            if control.place[0] == name and self.uses(control.place)
        }


def _without_measures_and_codes(tables: Mapping[str, Any]) -> dict[str, Any]:
    """The tables without what belongs to the buildings of the file."""
    out = {"separation": "codes", **dict.fromkeys(BUILDINGS, DISPLACEMENTS)}
    return {
        name: {key: value for key, value in table.items() if key != out[name]} if name in out else table
        for name, table in tables.items()
        if name != "measures"
    }


def read_again(tables: Mapping[str, Any], path: Path, known: Known) -> Case:
    """The case of these tables; warnings were given when the file was read."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulInput)
        return case_of(Section(path.name, (), tables, {}), path, known)


def written(key: Key, value: Any, file: Mapping[str, Any]) -> Any:
    """A number for a file: as it was written if it is the same, else with all its digits in SI."""
    if not isinstance(key.kind, Quantity):
        return value
    if isinstance(before := file.get(key.name), (str, int, float)) and _says(before, value, key.kind):
        return before
    if key.kind.units == "1":
        return value
    unit = key.slider.unit if key.slider else ""
    short = f"{value / key.unit_size:.8g} {unit}"
    return short if unit and _says(short, value, key.kind) else f"{value!r} {key.kind.units}"


def _says(text: Any, value: float, quantity: Quantity) -> bool:
    try:
        return in_si(text, quantity) == value
    except ValueError:  # of another kind of ground or building, or uncertain
        return False


def _in_order(table: Any, file: Any) -> Any:
    """A table with its keys in the order of the file; any other value as it is."""
    if not isinstance(table, dict) or not isinstance(file, dict):
        return table
    return {key: table[key] for key in (*file, *table) if key in table}


def parameters_of(kind: type[Model] | None) -> Sequence[str]:
    """Names of the parameters of a ground or an envelope."""
    return kind.parameter_names() if kind else ()


@cache
def groups() -> tuple[ControlGroup, ...]:
    """All controls."""
    sides = {"Building 1, left": ["building_1"], "Building 2, right": ["building_2"]}
    tables = {"Ground": ["site"], **sides, "Gap": ["separation"], "Motion": ["motion", "simulation"]}
    return tuple(
        ControlGroup(title, [control for name in names for control in _controls(name)])
        for title, names in tables.items()
    )


def numbers() -> Iterator[NumberControl]:
    """All controls of numbers."""
    return (c for group in groups() for c in group.controls if isinstance(c, NumberControl))


def choices() -> Iterator[Choice]:
    """All other controls."""
    return (c for group in groups() for c in group.controls if isinstance(c, Choice))


def _controls(name: str) -> Iterator[Control]:
    """The controls of a table, each choice before the key that follows it."""
    number = name.rpartition("_")[2]
    for key in keys_of(name).values():
        for choice in CHOICES.get((name.rstrip("_12"), key.name), ()):
            label = choice.label.format(number=number)
            yield choice._replace(place=(name, choice.place[1]), label=label)
        if key.slider:
            yield NumberControl((name, key.name), key)


def keys_of(name: str) -> Mapping[str, Key]:
    """The keys of a table, and the parameters of its kinds of model that have no key of their own."""
    keys = dict(keys_at((name,)))
    kinds: Mapping[str, Mapping[str, type[Model]]] = {"site": GROUNDS, "motion": ENVELOPES}
    for kind in kinds.get(name, {}).values():
        own = (parameter for parameter in parameters_of(kind) if parameter not in keys)
        keys |= {parameter: _with_slider(kind, parameter) for parameter in own}
    return keys


def _with_slider(kind: type[Model], name: str) -> Key:
    """The key of a parameter of an extension, with a slider about its default."""
    default, allowed = kind.__dataclass_fields__[name].default, kind.allowed(name)
    start = default if isinstance(default, float) else allowed.middle
    ends = max(allowed.lower, -start), min(allowed.upper, 3 * start)
    low, high = (start + 0.9 * (end - start) for end in ends)
    step = float(f"{(high - low) / 100:.0e}")
    unit = kind.units(name).replace("1", "", kind.units(name) == "1")
    return declared(kind, name, "", Slider(low, high, step, start, unit))
