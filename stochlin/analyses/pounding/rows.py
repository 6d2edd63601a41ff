"""Checks of structures, gaps, contact and links, and the row of buildings that kernels take."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from stochlin.analyses.tables.checks import as_numbers, check_scalars
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.contact import ForceLaw, law_table
from stochlin.kernels.pounding.rows import BILINEAR, BOUC_WEN, ELASTIC, SLACK, Row
from stochlin.messages import brief
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact, Element
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.links import Link
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure
from stochlin.models.systems import (
    LEVEL,
    Stack,
    Tie,
    arrangement_of,
    check_links,
    first_period,
    shares_at,
    slabs_on_columns,
)

Building = Structure | ShearBuilding

# Hysteresis laws of the time steps, by exact class: a subclass may have another law.
LAWS: Mapping[type, int] = {Bilinear: BILINEAR, BoucWen: BOUC_WEN}

UNUSED = (0.0, 0.0, 1.0)  # Bouc-Wen parameters of a storey with another law, which are not used
NUMBERS = "numbers, since a history is of one row"
STEEPEST = 2e4  # [1/s], largest rate at which a dashpot with an exponent brings masses to rest
TINY = 1e-300
SLOW = 1e-3  # approach velocity that counts as zero over max |a| T/(2 pi), see `slow_approach`
SLABS, COLUMN = "slab to slab", "slab to column"


class Meeting(NamedTuple):
    """A contact between two neighbours: the building on its left, both floors and their level [m].

    Buildings and floors are counted from 0. Where a slab meets a column, the floor on the side of the
    column is the one above the level. The displacement of the column is ``share`` times that of this
    floor plus ``1 - share`` times that of the floor below or the ground.
    """

    building: int
    floor_left: int
    floor_right: int
    level: float  # NaN between structures of one degree of freedom
    struck: str = ""  # side of the column: "left", "right", or empty for slab to slab
    share: float = 1.0

    @property
    def kind(self) -> str:
        """Kind of the contact, slab to slab or slab to column."""
        return COLUMN if self.struck else SLABS

    @property
    def weights(self) -> tuple[float, float, float]:
        """Factors in the penetration of the left floor, the right floor and the floor below a column."""
        left, right = (self.share if self.struck == side else 1.0 for side in ("left", "right"))
        below = 1 - self.share if self.storey else 0.0
        return left, -right, below if self.struck == "left" else -below

    @property
    def storey(self) -> int:
        """Storey of the column, counted from 0, which is below the floor on the side of the column."""
        return self.floor_left if self.struck == "left" else self.floor_right


def checked_buildings(structures: Sequence[Building]) -> list[Building]:
    """The structures as a list, after a check that the time steps of pounding can be applied to each."""
    if not isinstance(structures, Sequence) or not structures:
        raise ValueError(
            f"structures = {brief(structures)}; allowed: a list of one or more, from left to right"
        )
    for number, structure in enumerate(structures, start=1):
        role = f"structures, number {number}"
        law = structure.storey_law if isinstance(structure, ShearBuilding) else structure
        if type(law) not in LAWS:
            raise TypeError(
                f"{role} = {brief(structure)} is of the wrong kind; allowed: "
                f"{', '.join(kind.__name__ for kind in LAWS)}, {ShearBuilding.__name__}; the "
                "event-driven time steps are only available for these laws; for other laws use "
                "separation, simulate or recorded_gap"
            )
        if isinstance(structure, ShearBuilding):
            continue
        check_scalars(structure, role, NUMBERS)
        if structure.mass is None:
            raise ValueError(f"{role}: mass is not given; pounding needs it, in kg")
        if structure.reduction_factor is not None:
            raise ValueError(
                f"{role}: reduction_factor has no meaning in a given motion, since it refers to the "
                "elastic response to a ground model; give yield_displacement"
            )
    return list(structures)


def checked_gaps(gaps: npt.ArrayLike, count: int) -> Array:
    """Gaps [m] between ``count`` structures as an array, checked; one number is enough for two."""
    allowed = f"one number between each two neighbours, {count - 1} in all"
    if count == 1:
        allowed = "none for one building alone, gaps=(), or a second structure"
    values = np.atleast_1d(as_numbers("gaps", gaps, allowed))
    if values.ndim != 1 or values.size != count - 1:
        raise ValueError(f"gaps = {brief(gaps)}; allowed: {allowed}")
    bad = np.flatnonzero(~(np.isfinite(values) & (values >= 0)))
    if bad.size:
        raise ValueError(
            f"gaps: {values[bad[0]]:g} between structures {bad[0] + 1} and {bad[0] + 2} is out of "
            "range; allowed: 0 <= gap, finite, in metres"
        )
    return values.astype(float)


def check_contact(contact: Contact | None, count: int) -> None:
    """Raise an error if ``count`` structures, more than one, have no valid contact."""
    if contact is None and count > 1:
        raise ValueError(
            f"contact is not given; {count} structures need a contact between them, for instance "
            "Kelvin(stiffness, restitution=..); only one building alone needs none"
        )
    if contact is not None:
        expect(contact, Contact, "contact")
        check_scalars(contact, "contact", NUMBERS)


def checked_links(link: Link | Sequence[Link | None] | None, count: int) -> tuple[Link | None, ...]:
    """Links between ``count`` structures, checked; for two structures a single link is enough."""
    links = check_links("link", link, count)
    for each in links:
        if each is not None:
            check_scalars(each, "link", NUMBERS)
    return links


def meetings(levels: Sequence[Array]) -> list[Meeting]:
    """Contacts of structures in a row, with floors at these levels [m]; NaN for an oscillator.

    They are sorted by level from the ground up, and from left to right at the same level.
    """
    found: list[Meeting] = []
    for b, (one, two) in enumerate(pairwise(levels)):
        if np.isnan(one).any() or np.isnan(two).any():  # an oscillator meets the roof
            level = np.fmax(one[-1], two[-1])
            found.append(Meeting(b, one.size - 1, two.size - 1, float(level)))
        else:
            found += _facing(b, one, two)
    starts: dict[tuple[int, int], tuple[float, int]] = {}
    chains: list[tuple[tuple[float, int], int, Meeting]] = []
    for m in found:  # slabs in contact form a chain, known by the level and building where it starts
        key = np.inf if np.isnan(m.level) else m.level, m.building
        if not m.struck:
            key = starts.get((m.building, m.floor_left), key)
            starts[m.building, m.floor_left] = starts[m.building + 1, m.floor_right] = key
        chains.append((key, m.building, m))
    return [m for *_, m in sorted(chains, key=lambda chain: chain[:2])]


def build_row(
    structures: Sequence[Building],
    gaps: Array,
    contact: Contact | None,
    motion: Array,
    links: Sequence[Link | None],
) -> tuple[Row, list[Meeting]]:
    """The row of buildings as kernels take it, and its contacts."""
    system = arrangement_of(structures, links)
    first, storeys = system.first, system.storeys
    mass = storeys.mass
    places = meetings([stack.levels for stack in system.stacks])
    floors = np.array([_floors(m, first) for m in places], np.int64).reshape(-1, 3)
    weight = np.array([m.weights for m in places], float).reshape(-1, 3)
    shares = weight**2 / mass[floors]
    meeting = 1.0 / (shares[:, 0] + shares[:, 1] + shares[:, 2])
    element = contact if isinstance(contact, Element) else None
    jumps = contact is not None and element is None
    columns = [m for m in places if m.struck]
    if contact is not None and jumps and columns:
        raise ValueError(
            f"contact = {contact.describe()}: velocities jump only where slabs meet, and of the "
            f"structures {columns[0].building + 1} and {columns[0].building + 2} a floor meets a column "
            f"at {columns[0].level:g} m; allowed: a contact with a force, for instance "
            "Kelvin(stiffness, restitution=..)"
        )
    laws = [element.force_law(float(m)) if element else ForceLaw() for m in meeting]
    row = Row(
        first=first,
        below=system.below,
        mass=mass,
        per_mass=1 / mass,
        post=storeys.post,
        couple=storeys.couple,
        strength=storeys.strength,
        law=np.concatenate([_laws(stack) for stack in system.stacks]),
        shape=np.ascontiguousarray(np.concatenate([_shapes(stack) for stack in system.stacks])),
        damping=storeys.damping,
        left=np.ascontiguousarray(floors[:, 0]),
        right=np.ascontiguousarray(floors[:, 1]),
        lower=np.ascontiguousarray(floors[:, 2]),
        weight=weight,
        meeting=meeting,
        gap=np.array([gaps[m.building] for m in places], float),
        element=law_table(laws),
        jumps=jumps,
        restitution=float(contact.e) if contact is not None and jumps else 1.0,
        slow=slow_approach(shortest_period(structures), motion),
        tied=np.array([(tie.one, tie.two) for tie in system.ties], np.int64).reshape(-1, 2),
        tie=np.array([_tie(tie, 1 / mass) for tie in system.ties], float).reshape(-1, 6),
        tie_law=np.array([_tie_law(tie.link) for tie in system.ties], np.int64),
    )
    return row, places


def shortest_period(structures: Sequence[Building]) -> float:
    """Shortest of the first-mode periods of the structures [s]."""
    return min(float(first_period(structure)) for structure in structures)


def slow_approach(shortest: float, motion: Array) -> float:
    """Approach velocity [m/s] below which a contact counts as elastic in this motion, `Row.slow`."""
    return SLOW * float(np.abs(motion).max()) * shortest / (2 * np.pi)


def _facing(b: int, one: Array, two: Array) -> list[Meeting]:
    """Contacts of two neighbours up to the lower roof, slab to slab and slab to column."""
    pairs = [(i, j) for i in range(one.size) for j in range(two.size) if abs(one[i] - two[j]) < LEVEL]
    found = [Meeting(b, i, j, float(0.5 * (one[i] + two[j]))) for i, j in pairs]
    for side, floor in slabs_on_columns(one, two):
        i, (levels, other) = floor - 1, ((one, two), (two, one))[side]
        above, share = next(iter(shares_at(other, levels[i]).items()))
        floors, struck = ((above, i), "left") if side else ((i, above), "right")
        found.append(Meeting(b, *floors, float(levels[i]), struck, share))
    return found


def _floors(m: Meeting, first: Array) -> tuple[int, int, int]:
    """Numbers, among all floors of the row, of the left, the right and the floor below the column."""
    left, right = int(first[m.building]) + m.floor_left, int(first[m.building + 1]) + m.floor_right
    upper = left if m.struck == "left" else right
    return left, right, upper - 1 if m.struck and m.storey else upper


def _laws(stack: Stack) -> Array:
    return np.where(np.isfinite(stack.system.strength), LAWS[type(stack.law)], ELASTIC)


def _shapes(stack: Stack) -> Array:
    if type(stack.law) is BoucWen:
        return stack.law_parameters
    return np.tile(UNUSED, (stack.system.mass.size, 1))


def _tie_law(link: Link) -> int:
    return BILINEAR if link.yields else ELASTIC if link.slack is None else SLACK


def _tie(tie: Tie, per_mass: Array) -> tuple[float, ...]:
    """Parameters of a link as kernels take them, in the order of `Row.tie`."""
    post, couple, strength = tie.link.spring
    c, a = tie.link.number("damping_constant"), tie.link.exponent
    easy = 0.0
    if a < 1:  # the velocity at which c |v|^(a-1) over the mass equals STEEPEST
        moved = per_mass[tie.one] + (per_mass[tie.two] if tie.two >= 0 else 0.0)
        easy = float(np.exp(min(np.log(max(c * moved / STEEPEST, TINY)) / (1 - a), 0.0)))
    return post, c, couple, strength, a, easy
