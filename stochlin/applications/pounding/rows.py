"""Checks of structures, gaps, contact and links, and the row of buildings that kernels take."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Annotated, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.integrate import cumulative_trapezoid

from stochlin.applications.records.cells import check_structure
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.pounding.run import BuildingRow
from stochlin.kernels.records.runs import SampledMotion
from stochlin.kernels.simulation.contacts import Contacts, ForceLaw
from stochlin.messages import brief
from stochlin.models.arguments import as_numbers
from stochlin.models.contacts.elements import Contact, Element
from stochlin.models.links import Link
from stochlin.models.parameters import check_units, expect
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import (
    LEVEL,
    Assembly,
    assembly_of,
    check_links,
    check_mass,
    shares_at,
    slabs_on_columns,
)
from stochlin.models.walls import IN_SPACE, Wall
from stochlin.solver.simulation.connected_structures import modes_of, row_of
from stochlin.solver.tables.checks import check_scalars

NUMBERS = "numbers, since a history is of one row"
SLAB_TO_SLAB = "slab to slab"
SLAB_TO_COLUMN = "slab to column"
SLAB_TO_WALL = "slab to wall"
WALL_TO_COLUMN = "wall to column"
CONTACT_SIDES = "left", "right"  # sides of a contact


class ContactPlace(NamedTuple):
    """A contact between two neighbours: the building on its left, both floors and their level [m].

    Buildings and floors are counted from 0; before the first building, and in place of the floor of
    a wall, stands -1. Where a slab meets a column, the floor on the side of the column is the one
    above the level. The displacement of the column is ``share`` times that of this floor plus ``1 -
    share`` times that of the floor below or the ground.
    """

    building: int
    floor_left: int
    floor_right: int
    level: float  # NaN between structures of one degree of freedom
    struck: str = ""  # side of the column: "left", "right", or empty for slab to slab
    share: float = 1.0
    wall: str = ""  # side of a wall: "left", "right", or empty between two buildings
    fixed: str = ""  # what the wall is fixed to

    @property
    def kind(self) -> str:
        """What meets, in words."""
        if self.wall:
            return WALL_TO_COLUMN if self.struck else SLAB_TO_WALL
        return SLAB_TO_COLUMN if self.struck else SLAB_TO_SLAB

    def shares(self, side: str) -> dict[int, float]:
        """Shares of the floors in the displacement of what meets on one side, by their numbers."""
        if self.wall == side:
            return {}
        floor = self.floor_left if side == CONTACT_SIDES[0] else self.floor_right
        if self.struck != side:
            return {floor: 1.0}
        return {floor: self.share} | ({floor - 1: 1 - self.share} if floor else {})

    @property
    def storey(self) -> int:
        """Storey of the column, counted from 0, below the floor on the side of the column."""
        return self.floor_left if self.struck == "left" else self.floor_right


class Neighbours(NamedTuple):
    """Buildings from left to right, and the walls beside them."""

    buildings: list[AnyStructure]
    walls: dict[str, Wall]  # by their side of the row, "left" or "right"

    @property
    def gaps(self) -> list[str]:
        """Both sides of each gap in words, from left to right."""
        numbers = range(1, len(self.buildings))
        between = [f"structures {number} and {number + 1}" for number in numbers]
        if CONTACT_SIDES[0] in self.walls:
            between.insert(0, "the wall and structure 1")
        if CONTACT_SIDES[1] in self.walls:
            between.append(f"structure {len(self.buildings)} and the wall")
        return between


class PreparedRow(NamedTuple):
    """Buildings in a row, and each of them alone, as kernels take them."""

    row: BuildingRow
    # the same without links between buildings; the row itself, if there are none
    alone: BuildingRow
    assembly: Assembly
    places: list[ContactPlace]
    reduced: Array  # (c,) [kg]: reduced mass of both sides of each contact
    system: System  # of the buildings with their links, without walls

    @property
    def first(self) -> Array:
        """Number of the first floor of each building, and of all floors (s + 1,)."""
        return self.assembly.first

    @property
    def shortest(self) -> float:
        """Shortest of the first-mode periods of the structures [s]."""
        return min(float(modes_of(stick.system)[0].max()) for stick in self.assembly.sticks)


def checked_row(structures: Sequence[AnyStructure | Wall]) -> Neighbours:
    """The buildings and walls, after a check that each building has what time steps need."""
    if not isinstance(structures, Sequence) or not structures:
        raise ValueError(f"structures = {brief(structures)}; allowed: a list, from left to right")
    walls: dict[str, Wall] = {}
    buildings: list[AnyStructure] = []
    for number, structure in enumerate(structures, start=1):
        role = f"structures, number {number}"
        if isinstance(structure, Wall):
            if 1 < number < len(structures) or len(structures) == 1:
                what = "a wall" if len(structures) > 1 else "a wall alone"
                raise ValueError(
                    f"{role} is {what}; allowed: a wall first or last, beside a building"
                )
            side = CONTACT_SIDES[0] if number == 1 else CONTACT_SIDES[1]
            walls[side] = structure
            continue
        expect(structure, (AnyStructure, Wall), role)
        check_structure(role, structure)
        check_scalars(structure, role, NUMBERS)
        check_mass(structure, role)
        buildings.append(structure)
    if not buildings:
        raise ValueError("structures has walls alone; allowed: at least one building between them")
    return Neighbours(buildings, walls)


def checked_gaps(gaps: npt.ArrayLike, between: Sequence[str]) -> Array:
    """Gaps [m] as an array, checked; a number is enough for a single one.

    ``between`` has both sides of each gap in words.
    """
    count = len(between)
    allowed = f"one number between each two neighbours, {count} in all"
    if count == 0:
        allowed = "none for one building alone, gaps=(), or a second structure"
    if isinstance(gaps, xr.DataArray):
        check_units("gaps", gaps.attrs.get("units"), "m")
    values = np.atleast_1d(as_numbers("gaps", gaps, allowed))
    if values.ndim != 1 or values.size != count:
        raise ValueError(f"gaps = {brief(gaps)}; allowed: {allowed}")
    bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0)))
    if bad.size:
        what = f"gaps: {values[bad[0]]:g} between {between[bad[0]]}"
        raise ValueError(f"{what} is out of range; allowed: 0 <= gap, finite, in metres")
    return values.astype(float)


def check_contact(name: str, contact: Contact | None) -> None:
    """Raise an error unless a contact with scalar parameters is given."""
    if contact is None:
        what = f"{name} is not given; structures side by side need one"
        raise ValueError(f"{what}, for instance Kelvin(stiffness, restitution=..)")
    expect(contact, Contact, name)
    check_scalars(contact, name, NUMBERS)


BetweenBuildings = Annotated[Contact, check_contact]


def doubts_of_walls(
    neighbours: Neighbours, gaps: Array, grounds: Iterable[SampledMotion], velocity: float
) -> Iterator[str]:
    """Texts on walls fixed in space that move too far, from this velocity of the ground [m/s]."""
    in_space = [side for side, wall in neighbours.walls.items() if wall.fixed == IN_SPACE]
    if not in_space:
        return
    limits = PLAUSIBLE["displacement of the ground"]
    moved = [ground_displacement(ground, velocity) for ground in grounds]
    away = -1.0 if in_space == [CONTACT_SIDES[0]] else 1.0  # by which both walls come closer
    closer = max(float((away * u).max()) for u in moved)
    opposite = len(neighbours.walls) == 2 and len(in_space) == 1
    if opposite and closer > gaps.sum():
        what = f"the walls come {closer:.3g} m closer to each other than at the start, and the gaps"
        yield f"{what} are {gaps.sum():.3g} m in all; {limits.above}"
        return
    farthest = max(float(np.abs(u).max()) for u in moved)
    if text := limits.doubt(farthest):
        yield f"a wall fixed in space moves by {farthest:.3g} m against the ground; {text}"


def ground_displacement(ground: SampledMotion, velocity: float) -> Array:
    """Displacement of the ground [m] at its samples, by the trapezoidal rule."""
    rates = velocity + cumulative_trapezoid(ground.acceleration, dx=ground.dt, initial=0.0)
    return cumulative_trapezoid(rates, dx=ground.dt, initial=0.0)


def checked_links(link: Link | Sequence[Link | None] | None, count: int) -> tuple[Link | None, ...]:
    """Links between ``count`` structures, checked; for two structures a single link is enough."""
    links = check_links("link", link, count)
    for member in links:
        if member is not None:
            check_scalars(member, "link", NUMBERS)
    return links


def contact_places(levels: Sequence[Array], walls: Mapping[str, Wall]) -> list[ContactPlace]:
    """Contacts of buildings in a row, with floors at these levels [m]; NaN for an oscillator.

    They are sorted by level from the ground up, and from left to right at the same level.
    """
    contacts: list[ContactPlace] = []
    for side, wall in walls.items():
        contacts += _on_wall(wall, side, levels)
    for b, (left, right) in enumerate(pairwise(levels)):
        if np.isnan(left).any() or np.isnan(right).any():  # an oscillator meets the roof
            level = np.fmax(left[-1], right[-1])
            contacts.append(ContactPlace(b, left.size - 1, right.size - 1, float(level)))
        else:
            contacts += _facing(b, left, right)
    return sorted(
        contacts,
        key=lambda place: (round(np.nan_to_num(place.level, nan=np.inf), 6), place.building),
    )


def build_row(
    neighbours: Neighbours, gaps: Array, contact: Contact | None, links: Sequence[Link | None]
) -> PreparedRow:
    """The row of buildings as kernels take it, with its contacts, and the buildings alone."""
    system = assembly_of(neighbours.buildings, links)
    places = contact_places([stick.levels for stick in system.sticks], neighbours.walls)
    columns = [place for place in places if place.struck]
    if contact is not None and not isinstance(contact, Element) and columns:
        column = columns[0]
        what = f"contact = {contact.describe()}: velocities jump where slabs meet"
        where = (
            f"of structures {column.building + 1} and {column.building + 2} a floor meets a column"
        )
        if column.wall:
            where = "a wall meets a column"
        raise ValueError(
            f"{what}, and {where} at {column.level:g} m; allowed: a contact with a force"
        )
    left_floors, right_floors = _sides(places, system)
    left = left_floors @ system.storeys.shapes
    right = right_floors @ system.storeys.shapes
    mass = system.storeys.mass
    reduced = 1.0 / ((left + right) ** 2 @ (1.0 / mass))
    before = int(CONTACT_SIDES[0] in neighbours.walls)  # gaps before the first building
    space = np.array([gaps[place.building + before] for place in places], float)
    in_space = any(wall.fixed == IN_SPACE for wall in neighbours.walls.values())
    if in_space:
        left = np.column_stack([left, _of_wall(places, CONTACT_SIDES[0])])
        right = np.column_stack([right, _of_wall(places, CONTACT_SIDES[1])])
    laws = [ForceLaw()] * len(places)
    restitution: float | None = None
    if isinstance(contact, Element):
        laws = [contact.force_law(float(reduced_mass)) for reduced_mass in reduced]
    else:
        restitution = 1.0 if contact is None else float(contact.e)
    coordinates = mass.size + in_space
    contacts = Contacts.of(laws, coordinates, left, right, space, restitution, in_space)
    inner = tuple(placed for placed in system.placed_links if placed.link.within_one)
    row = row_of(system, contacts)
    of_links = row.elements.system
    row = alone = beside_wall(row) if in_space else row
    if inner != system.placed_links:
        alone = row_of(system._replace(placed_links=inner), Contacts.of([], mass.size))
    return PreparedRow(row, alone, system, places, reduced, of_links)


def _of_wall(places: Sequence[ContactPlace], side: str) -> Array:
    """Weights (c,) of the displacement of walls fixed in space, on one side of contacts."""
    weight = 1.0 if side == CONTACT_SIDES[0] else -1.0
    in_space = [place.wall == side and place.fixed == IN_SPACE for place in places]
    return np.where(in_space, weight, 0.0)


def beside_wall(row: BuildingRow) -> BuildingRow:
    """A row with a last coordinate for walls fixed in space.

    No spring holds it, so that it moves against the ground by as much as the ground moves.
    """
    wall = System(
        mass=np.ones(1),
        damping=np.zeros((1, 1)),
        extensions=np.zeros((0, 1)),
        shapes=np.zeros((0, 1)),
        post=np.zeros(0),
        couple=np.zeros(0),
        strength=np.zeros(0),
    )
    system = System.beside([row.elements.system, wall])
    return row._replace(elements=row.elements._replace(system=system))


def _on_wall(wall: Wall, side: str, levels: Sequence[Array]) -> list[ContactPlace]:
    """Contacts of the building at one end of the row with the wall on this side of it."""
    building = -1 if side == CONTACT_SIDES[0] else len(levels) - 1
    floors = levels[0] if side == CONTACT_SIDES[0] else levels[-1]
    other = CONTACT_SIDES[1] if side == CONTACT_SIDES[0] else CONTACT_SIDES[0]
    touched = floors.tolist() if wall.levels is None else wall.levels
    if wall.levels is not None and np.isnan(floors).any():
        what = f"{wall.describe()} stands beside an oscillator, which has no levels"
        raise ValueError(f"{what}; allowed: a wall without levels, or a building with storeys")
    contacts = []
    slabs: set[int] = set()
    for level in touched:
        floor = int(np.searchsorted(floors, level - LEVEL))  # the first one that is not below
        if floor == floors.size:
            what = f"{wall.describe()} is above the roof of its building at {floors[-1]:g} m"
            raise ValueError(f"{what}; allowed: levels up to the roof")
        struck = other if floors[floor] - level >= LEVEL else ""
        if not struck and floor in slabs:
            what = f"{wall.describe()} meets the slab at {floors[floor]:g} m twice"
            raise ValueError(f"{what}; allowed: one level within {LEVEL:g} m of a slab")
        slabs |= set() if struck else {floor}
        share = float(shares_at(floors, level)[floor]) if struck else 1.0
        sides = (-1, floor) if side == CONTACT_SIDES[0] else (floor, -1)
        contacts.append(
            ContactPlace(building, *sides, float(level), struck, share, side, wall.fixed)
        )
    return contacts


def _facing(b: int, left: Array, right: Array) -> list[ContactPlace]:
    """Contacts of two neighbours up to the lower roof, slab to slab and slab to column."""
    pairs = [
        (i, j)
        for i in range(left.size)
        for j in range(right.size)
        if abs(left[i] - right[j]) < LEVEL
    ]
    contacts = [ContactPlace(b, i, j, float(0.5 * (left[i] + right[j]))) for i, j in pairs]
    for side, floor in slabs_on_columns(left, right):
        i = floor - 1
        levels = right if side else left
        other = left if side else right
        above = int(np.searchsorted(other, levels[i]))
        share = float(shares_at(other, levels[i])[above])
        floors, struck = ((above, i), "left") if side else ((i, above), "right")
        contacts.append(ContactPlace(b, *floors, float(levels[i]), struck, share))
    return contacts


def _sides(places: Sequence[ContactPlace], system: Assembly) -> tuple[Array, Array]:
    """Weights (c, n) of the floors in the penetrations, those of the left and of the right side."""
    sides = np.zeros((2, len(places), int(system.first[-1])))
    for j, place in enumerate(places):
        for k, side in enumerate(CONTACT_SIDES):
            for floor, share in place.shares(side).items():
                sides[k, j, system.first[place.building + k] + floor] = share if k == 0 else -share
    return sides[0], sides[1]
