"""The buildings of a case file: as an oscillator, by storeys, or by modes."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import pairwise
from typing import Any, ClassVar, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.buildings.modes import MODE_DIRECTIONS, read_modes
from stochlin.applications.buildings.pushover import bilinear_of, pushover_options, read_pushover
from stochlin.applications.cases.reading.kinds import (
    COLUMN_OF_FILE,
    TEXT,
    TRUTH,
    Integer,
    Key,
    ListOf,
    WithUnit,
    Word,
    key,
    keys_of,
    keys_of_model,
    of,
)
from stochlin.applications.cases.reading.site import CaseSite
from stochlin.applications.cases.reading.tables import Form, TomlTable
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings.base import MOST_STOREYS, MultistoreyBuilding
from stochlin.models.buildings.modal import ModalBuilding
from stochlin.models.buildings.shear import RegularBuilding, ShearBuilding
from stochlin.models.laws import laws_in_numbers
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range
from stochlin.models.plausible import PLAUSIBLE, doubts_of_factors, doubts_of_size, unquestioned
from stochlin.models.rules.codes import AT_LEAST_1, IMPORTANCE_RANGE
from stochlin.models.systems import slabs_on_columns
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.drift_map import calibrated_closure
from stochlin.solver.linearization.strength import strength_for_ductility, strength_in_metres

CODE_FACTOR = WithUnit("1", AT_LEAST_1, PLAUSIBLE["behaviour"])
BUILDING_HEIGHT = WithUnit("m", POSITIVE, PLAUSIBLE["height"])
MOVE = WithUnit("m", NOT_NEGATIVE, PLAUSIBLE["displacements"])
IMPORTANCE_FACTOR = WithUnit("1", IMPORTANCE_RANGE, PLAUSIBLE["importance"])
DUCTILITY = WithUnit("1", Range(1.0, reason="1 for a building that just does not yield"))
TWO_MODES = ListOf(Integer(1, MOST_STOREYS), length=2)
STRENGTH_KEY = "strength"
HEIGHT_KEYS = {"height of its storeys": ("storey_height", "heights")}
WITH_HARDENING = (
    "reduction_factor",
    "yield_displacement",
    "ductility",
    "base_shear_coefficient",
    "yield_drifts",
    "yield_displacements",
)


MODE_KEYS = (
    "base_shear_coefficient",
    "reduction_factor",
    "yield_displacements",
    "pushover",
    "elastic",
)


class OfBuilding(Form):
    """Keys of every building; ``more`` are the parameters of its hysteresis law."""

    goes_with: ClassVar[Any] = tuple((strength, "hardening") for strength in WITH_HARDENING)
    # one number for all elements, or a list
    of_law: ClassVar[Mapping[str, Any]] = {"single": "alone"}

    name: str = key(TEXT, "Name in results", "")
    law: str = key(Word(laws_in_numbers), "Hysteresis law", "bilinear")
    damping: Any = of(Bilinear, "damping")
    hardening: Any = of(Bilinear, "hardening", default=None)
    elastic: bool = key(TRUTH, "It does not yield", False)
    displacements: Any = key(ListOf(MOVE, "listed"), "Displacements under design forces", ())
    behaviour_factor: float | None = key(CODE_FACTOR, "Behaviour factor of the code", None)
    displacement_factor: float | None = key(CODE_FACTOR, "Displacement factor of the code", None)
    importance_factor: float | None = key(IMPORTANCE_FACTOR, "Importance factor of the code", None)

    @classmethod
    def keys(cls, table: TomlTable) -> dict[str, Key]:
        """With the parameters of the law."""
        law = laws_in_numbers().get(str(table.values.get("law", "bilinear")))
        return keys_of(cls) | keys_of_model(law, law and law.own_parameters(), **cls.of_law)

    def of_hardening(self) -> dict[str, Any]:
        """The hardening, of a building whose keys give its strength."""
        return {"hardening": self.hardening} if self.chosen(STRENGTH_KEY) in WITH_HARDENING else {}


class OscillatorForm(OfBuilding):
    """A building as one oscillator."""

    described_as = "a building without storeys"
    one_of: ClassVar[Any] = {STRENGTH_KEY: (*WITH_HARDENING[:3], "elastic")}
    of_law: ClassVar[Mapping[str, Any]] = {"uncertain": True}

    period: Any = of(Bilinear, "period")
    reduction_factor: Any = of(Bilinear, "reduction_factor", default=None)
    yield_displacement: Any = of(Bilinear, "yield_displacement", default=None)
    ductility: float | None = key(DUCTILITY, "Mean peak ductility", None)
    mass: Any = of(Bilinear, "mass", default=None)
    height: float | None = key(BUILDING_HEIGHT, "Height", None)
    storeys: int | None = key(Integer(1), "Storeys", None)

    def model(self) -> Any:
        """The oscillator, elastic until `Building.on` finds a strength for its ductility."""
        names = "period", "damping", "reduction_factor", "yield_displacement", "mass"
        values = {**self.values_of(*names), **self.of_hardening(), **self.more}
        return self.table.made(laws_in_numbers()[self.law], **values)


PUSHOVER_KEYS = ("pushover_units", "pushover_columns")


class WithFloors(OfBuilding):
    """Keys of every building whose floors are known."""

    goes_with: ClassVar[Any] = (
        *OfBuilding.goes_with,
        *((name, "pushover") for name in PUSHOVER_KEYS),
    )

    storeys: int | None = key(Integer(1, MOST_STOREYS), "Storeys", None)
    pushover: str = key(TEXT, "File of its pushover curve", "")
    pushover_units: Any = key(ListOf(TEXT, length=2), "Units of displacement and force in it", None)
    pushover_columns: Any = key(ListOf(COLUMN_OF_FILE, length=2), "Columns of both in it", None)

    def described(self) -> Any:
        """The structure without what a pushover curve changes."""
        raise NotImplementedError

    def model(self) -> Any:
        """The structure with the strength of its pushover curve, if it has one."""
        structure = self.described()
        if not self.pushover:
            return structure
        path = self.table.path("pushover")
        called = dict.fromkeys(("length_units", "force_units"), "pushover_units")
        called |= dict.fromkeys(("displacement_column", "force_column"), "pushover_columns")
        with self.table.naming("pushover", **called), self.table.asking("pushover"):
            curve = read_pushover(
                path, **pushover_options(self.pushover_units, self.pushover_columns)
            )
            ideal = bilinear_of(curve, hardening=self.hardening)
            median_of(structure).with_pushover(ideal)  # with its warnings
        return applied(partial(_pushed, ideal=ideal), structure)


def _pushed(structure: Any, ideal: xr.Dataset) -> Any:
    """A structure, perhaps a sample of many, with an idealized pushover curve, without warnings."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DoubtfulInput)
        return structure.with_pushover(ideal)


class Storeyed(WithFloors):
    """Keys of every chain of storeys."""

    described_as = "a building by its storeys"

    storey_height: float | None = of(
        RegularBuilding, "storey_height", "Storey height", None, uncertain=False
    )
    heights: Any = of(
        ShearBuilding, "heights", "Heights of storeys", None, uncertain=False, single=""
    )
    dampers: Any = of(ShearBuilding, "dampers", default=None, single="alone")
    p_delta: bool = key(TRUTH, "Weight softens storeys (P-delta)", False)
    damping_modes: Any = key(TWO_MODES, "Two modes with the damping ratio", None)

    def shared(self) -> dict[str, Any]:
        """Arguments of both ways to make a chain."""
        names = "damping", "dampers", "law", "p_delta", "damping_modes"
        return {**self.values_of(*names), "law_parameters": self.more, **self.of_hardening()}


class Regular(Storeyed):
    """A building with equal floors, by a few numbers."""

    goes_with: ClassVar[Any] = (*Storeyed.goes_with, ("storey_height", "storeys"))
    one_of: ClassVar[Any] = HEIGHT_KEYS | {
        STRENGTH_KEY: ("base_shear_coefficient", "pushover", "elastic")
    }

    period: Any = of(RegularBuilding, "period")
    floor_mass: Any = of(RegularBuilding, "mass")
    base_shear_coefficient: Any = of(RegularBuilding, "base_shear_coefficient", default=None)

    def described(self) -> Any:
        """The building."""
        return self.table.made(
            ShearBuilding.regular,
            storeys=self.storeys or len(self.heights),
            storey_height=self.heights or self.storey_height,
            mass=self.floor_mass,
            **self.values_of("period", "base_shear_coefficient"),
            **self.shared(),
        )


class Singly(Storeyed):
    """A building storey by storey, from the ground up."""

    one_of: ClassVar[Any] = HEIGHT_KEYS | {STRENGTH_KEY: ("yield_drifts", "pushover", "elastic")}

    masses: Any = of(ShearBuilding, "masses", single="")
    stiffnesses: Any = of(ShearBuilding, "stiffnesses", single="")
    yield_drifts: Any = of(ShearBuilding, "yield_drifts", default=None, single="alone")

    def described(self) -> Any:
        """The building."""
        heights = self.heights or [self.storey_height] * np.size(median_of(self.masses))
        names = "masses", "stiffnesses", "yield_drifts"
        return self.table.made(
            ShearBuilding, heights=heights, **self.values_of(*names), **self.shared()
        )


class ByModes(WithFloors):
    """A building by the modes of a file, as programs of structural analysis write it."""

    described_as = "a building by its modes"
    one_of: ClassVar[Any] = {STRENGTH_KEY: MODE_KEYS}

    damping: Any = of(ModalBuilding, "damping", single="alone")
    hardening: Any = of(ModalBuilding, "hardening", default=None, single="alone")
    yield_displacements: Any = of(
        ModalBuilding, "yield_displacements", default=None, single="alone"
    )
    base_shear_coefficient: Any = of(RegularBuilding, "base_shear_coefficient", default=None)
    reduction_factor: Any = of(Bilinear, "reduction_factor", default=None, uncertain=False)
    modes: str = key(TEXT, "File of its modes")
    direction: str | None = key(Word(MODE_DIRECTIONS), "Direction of the gap in the file", None)
    points: list[str] = key(ListOf(TEXT, "listed"), "Points with the shapes, one on each floor", ())
    tower: str | None = key(TEXT, "Tower or diaphragm in the file", None)
    mass_units: str | None = key(TEXT, "Unit of the masses in the file", None)
    length_units: str | None = key(TEXT, "Unit of the levels in the file", None)

    @cached_property
    def of_modes(self) -> xr.Dataset:
        """The modes of the file, read once."""
        path = self.table.path("modes")
        options = self.values_of("direction", "points", "tower", "mass_units", "length_units")
        with self.table.naming("modes", "cannot be read: "), warnings.catch_warnings():
            # Doubts are raised about the building of these modes instead.
            warnings.simplefilter("ignore", DoubtfulInput)
            return read_modes(path, **options)

    def described(self) -> Any:
        """The building."""
        values = self.values_of("damping", "law", "yield_displacements", "base_shear_coefficient")
        values |= self.of_hardening()
        make = ModalBuilding.from_table
        return self.table.made(make, table=self.of_modes, law_parameters=self.more, **values)


FORMS = (OscillatorForm, Regular, Singly, ByModes)


@dataclass(frozen=True)
class Building:
    """A building of a case; ``sampled`` has uncertain parameters, ``structure`` their medians."""

    name: str
    sampled: Any
    form: Any

    @cached_property
    def structure(self) -> Any:
        """The structure at the medians of its parameters."""
        return median_of(self.sampled)

    @property
    def strength(self) -> str:
        """The key that gives the strength."""
        return str(self.form.chosen(STRENGTH_KEY))

    @property
    def of_first_mode(self) -> bool:
        """Whether it has a strength of the whole building, which its mode 1 bears alone."""
        return isinstance(self.form, ByModes) and self.strength in MODE_KEYS[:2]

    @property
    def has_storeys(self) -> bool:
        """Whether its floors are known."""
        return isinstance(self.structure, MultistoreyBuilding)

    @property
    def floors(self) -> int:
        """Number of its floors; an oscillator has one."""
        return int(self.structure.storeys) if self.has_storeys else 1

    @property
    def height(self) -> float | None:
        """Level of the roof [m], if it is known."""
        return float(self.structure.levels()[-1]) if self.has_storeys else self.form.height

    @property
    def storeys(self) -> int | None:
        """Number of storeys, if it is known."""
        return self.floors if self.has_storeys else self.form.storeys

    @property
    def period(self) -> float:
        """Period of the first mode, of small oscillations [s]."""
        return float(self.structure.first_period())

    @property
    def turning(self) -> str:
        """Modes of its file that turn in plan."""
        modes = self.form.of_modes if isinstance(self.form, ByModes) else xr.Dataset()
        return str(modes.attrs.get("turning", ""))

    def doubts(self) -> Iterator[str]:
        """Texts on what follows from several keys and is implausible."""
        yield from self.structure.doubts()
        if self.form.behaviour_factor and self.form.displacement_factor:
            yield from doubts_of_factors(self.form.behaviour_factor, self.form.displacement_factor)
        moves = self.form.displacements
        growth = moves[-1] / moves[0] if len(moves) > 1 and moves[0] else 1.0
        if text := PLAUSIBLE["displacement upwards"].doubt(growth):
            yield f"its roof has {growth:.2g} of the displacement of its first floor; {text}"
        if not self.has_storeys:
            yield from doubts_of_size(self.period, self.height, self.storeys)

    @unquestioned()
    def on(self, site: CaseSite) -> Building:
        """The building with its strength on the ground of a site, if it depends on it."""
        if self.of_first_mode and self.strength == "reduction_factor":
            with self.form.table.naming("reduction_factor", "gives no strength: "):
                return replace(self, sampled=applied(self._weaker_mode(site), self.sampled))
        if self.strength != "ductility":
            return self
        closure = calibrated_closure(self.structure, site.ground)
        target = self.structure, site.ground, self.form.ductility
        with self.form.table.naming("ductility", "has no strength: "):
            factor = float(strength_for_ductility(*target, closure=closure).reduction_factor)
        return replace(
            self, sampled=applied(partial(replace, reduction_factor=factor), self.sampled)
        )

    def _weaker_mode(self, site: CaseSite) -> Callable[[Any], Any]:
        """To let mode 1 yield at its elastic displacement on a ground over the reduction factor."""
        hardening = float(np.ravel(self.structure.hardening)[0])
        factor = self.form.reduction_factor
        mode = replace(self.structure.oscillator(), hardening=hardening, reduction_factor=factor)
        at_yield = strength_in_metres(mode, site.ground).yield_displacement
        return partial(_yielding, displacement=float(at_yield))


def _yielding(building: ModalBuilding, displacement: float) -> ModalBuilding:
    """A building by its modes, perhaps one of many samples, of which mode 1 yields."""
    return building.yielding_at(displacement)


def read_building(table: TomlTable, number: int) -> Building:
    """A building by the form that has most of its keys."""
    form: Any = table.read(*((ByModes,) if "modes" in table else FORMS))
    building = Building(form.name or f"Building {number}", form.model(), form)
    floors = building.floors
    for name, count in {"displacements": len(form.displacements), "storeys": form.storeys}.items():
        applies = building.has_storeys or name == "displacements"
        if applies and count not in (None, 0, floors):
            raise table.error(name, f"does not fit {floors} floors; allowed: {floors}")
    for text in building.doubts():
        table.warn("", f"is doubtful: {text}")
    return building


class SlabOnColumn(NamedTuple):
    """A floor slab at a level [m] where its neighbour, ``column_of`` from the left, has columns."""

    column_of: int
    level: float
    words: str


def slabs_of_row(buildings: Sequence[Building]) -> tuple[SlabOnColumn, ...]:
    """Slabs that meet columns, of all neighbours with known floors, pair by pair from the left."""
    slabs = []
    for number, pair in enumerate(pairwise(buildings), start=1):
        if not all(building.has_storeys for building in pair):
            continue
        levels = [building.structure.levels() for building in pair]
        for side, floor in slabs_on_columns(*levels):
            level = float(levels[side][floor - 1])
            other = 1 - side
            storey = int(np.searchsorted(levels[other], level)) + 1
            place = f"storey {storey} of {pair[other].name}"
            words = (
                f"floor {floor} of {pair[side].name}, at {level:g} m, meets the columns in {place}"
            )
            slabs.append(SlabOnColumn(number + other, level, words))
    return tuple(slabs)
