"""From structures, gaps and a contact to the row of buildings that a kernel takes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import scipy.linalg

from stochlin.analyses.tables.checks import as_numbers, check_scalars
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.contact import ForceLaw, law_table, reduced_mass
from stochlin.kernels.pounding.rows import BILINEAR, BOUC_WEN, ELASTIC, Row
from stochlin.messages import brief
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact, Element
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.links import Link
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure

Building = Structure | ShearBuilding

# Laws of storeys that yield. One of a kind that is derived from these may be any other.
LAWS: Mapping[type, int] = {Bilinear: BILINEAR, BoucWen: BOUC_WEN, ShearBuilding: BILINEAR}

UNUSED = (0.0, 0.0, 1.0)  # shape of a law that has none
NUMBERS = "numbers, since a history is of one row"
ALIGNED = 0.05  # [m]: floors whose levels differ by less meet
SLOW = 1e-3  # of the velocity that the motion can give the stiffest structure in a quarter period


class Meeting(NamedTuple):
    """A contact: the building on its left, both floors counted from 0, their level [m]."""

    building: int
    floor_left: int
    floor_right: int
    level: float  # NaN for structures of one degree of freedom


class Stack(NamedTuple):
    """One building as a kernel takes it; see `Row`."""

    mass: Array
    stiffness: Array
    hardening: float
    strength: Array
    law: int
    shape: tuple[float, float, float]  # beta, gamma and exponent
    damping: Array


def checked_buildings(structures: Sequence[Building]) -> list[Building]:
    """The structures, once each of them can pound against the others."""
    if not isinstance(structures, Sequence) or len(structures) < 2:
        raise ValueError(
            f"structures = {brief(structures)}; allowed: a list of at least two, left to right"
        )
    for number, structure in enumerate(structures, start=1):
        role = f"structures, number {number}"
        if type(structure) not in LAWS:
            raise TypeError(
                f"{role} = {brief(structure)} is of the wrong kind; allowed: "
                f"{', '.join(kind.__name__ for kind in LAWS)}; for structures of another law there are "
                "separation and simulate"
            )
        if isinstance(structure, ShearBuilding):
            continue
        check_scalars(structure, role, NUMBERS)
        if structure.mass is None:
            raise ValueError(f"{role}: mass is not given; pounding needs it, in kg")
        if structure.reduction_factor is not None:
            raise ValueError(
                f"{role}: reduction_factor has no meaning in a given motion, for it refers to the "
                "elastic response to a ground model; give yield_displacement"
            )
    if len({isinstance(structure, ShearBuilding) for structure in structures}) > 1:
        raise ValueError(
            "structures: shear buildings stand beside structures whose height is not known; allowed: "
            "one kind in a row, so give each a ShearBuilding, of one storey if need be"
        )
    return list(structures)


def checked_gaps(gaps: npt.ArrayLike, count: int) -> Array:
    """Gaps [m] between ``count`` structures; a number will do for two."""
    allowed = f"one number between each two neighbours, {count - 1} in all"
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


def checked_links(link: Link | Sequence[Link | None] | None, count: int) -> list[Link | None]:
    """Links between ``count`` structures; one will do for two."""
    links: list[Link | None] = [None] * (count - 1)
    if link is not None and not isinstance(link, (Link, list, tuple)):
        raise TypeError(f"link = {brief(link)}; allowed: a Link, or a list of Link and None")
    if link is not None:
        links = [link] if isinstance(link, Link) else list(link)
    if len(links) != count - 1:
        raise ValueError(
            f"link: {len(links)} given; allowed: one between each two neighbours, {count - 1} in all, "
            "None where there is none"
        )
    for each in links:
        if each is not None:
            expect(each, Link, "link")
            check_scalars(each, "link", NUMBERS)
    return links


def meetings(structures: Sequence[Building]) -> list[Meeting]:
    """Contacts of the row, level by level from the ground, and along a level from left to right."""
    found: list[Meeting] = []
    for b in range(len(structures) - 1):
        one, two = structures[b], structures[b + 1]
        if isinstance(one, ShearBuilding) and isinstance(two, ShearBuilding):
            found += _aligned(b, one.levels(), two.levels())
        else:
            found.append(Meeting(b, 0, 0, np.nan))
    starts: dict[tuple[int, int], tuple[float, int]] = {}
    for m in found:  # a chain is known by the level and the building at which it begins
        key = starts.get((m.building, m.floor_left), (m.level, m.building))
        starts[m.building, m.floor_left] = key
        starts[m.building + 1, m.floor_right] = key
    return sorted(found, key=lambda m: (starts[m.building, m.floor_left], m.building))


def build_row(
    structures: Sequence[Building],
    gaps: Array,
    contact: Contact,
    motion: Array,
    links: Sequence[Link | None],
) -> tuple[Row, list[Meeting]]:
    """The row of buildings for a kernel, and what its contacts are.

    A link ties the highest floors at which two neighbours meet.
    """
    expect(contact, Contact, "contact")
    check_scalars(contact, "contact", NUMBERS)
    stacks = [_stack(structure) for structure in structures]
    first = np.concatenate([[0], np.cumsum([stack.mass.size for stack in stacks])])
    below = np.concatenate([np.arange(s.mass.size) + f - 1 for s, f in zip(stacks, first, strict=False)])
    below[first[:-1]] = -1
    mass, stiffness, strength = (
        np.concatenate([getattr(stack, name) for stack in stacks])
        for name in ("mass", "stiffness", "strength")
    )
    hardening, law, shape = (
        np.repeat([getattr(stack, name) for stack in stacks], np.diff(first), axis=0)
        for name in ("hardening", "law", "shape")
    )
    places = meetings(structures)
    tops = {m.building: m for m in sorted(places, key=lambda m: m.floor_left)}
    tied = [(b, tops[b], link) for b, link in enumerate(links) if link is not None]
    left = np.array([first[m.building] + m.floor_left for m in places])
    right = np.array([first[m.building + 1] + m.floor_right for m in places])
    element = contact if isinstance(contact, Element) else None
    laws = [
        element.force_law(float(m)) if element else ForceLaw()
        for m in reduced_mass(mass[left], mass[right])
    ]
    row = Row(
        first=first,
        below=below,
        mass=mass,
        per_mass=1 / mass,
        post=hardening * stiffness,
        couple=(1 - hardening) * stiffness,
        strength=strength,
        law=law,
        shape=shape,
        damping=np.ascontiguousarray(scipy.linalg.block_diag(*[stack.damping for stack in stacks])),
        left=left,
        right=right,
        gap=np.array([gaps[m.building] for m in places]),
        element=law_table(laws),
        jumps=element is None,
        restitution=1.0 if element else float(contact.e),
        slow=SLOW * float(np.abs(motion).max()) * min(map(shortest_period, structures)) / (2 * np.pi),
        tied=np.array(
            [(first[b] + m.floor_left, first[b + 1] + m.floor_right) for b, m, _ in tied], np.int64
        ).reshape(-1, 2),
        tie=np.array([(link.stiffness, link.damping_constant) for *_, link in tied], float).reshape(
            -1, 2
        ),
    )
    return row, places


def shortest_period(structure: Building) -> float:
    """Period of the structure, of a building's first mode [s]."""
    if isinstance(structure, ShearBuilding):
        return float(structure.periods()[0])
    return float(structure.arrays()["period"])


def _aligned(b: int, one: Array, two: Array) -> list[Meeting]:
    """Contacts of two neighbours: every level up to the lower roof has to be one of both."""
    roof = min(one[-1], two[-1]) + ALIGNED
    pairs = [(i, j) for i in range(one.size) for j in range(two.size) if abs(one[i] - two[j]) < ALIGNED]
    met = {i for i, _ in pairs}, {j for _, j in pairs}
    for levels, seen, number in ((one, met[0], b + 1), (two, met[1], b + 2)):
        for i, level in enumerate(levels):
            if level < roof and i not in seen:
                other = two if number == b + 1 else one
                told = ", ".join(f"{each:g}" for each in other)
                raise ValueError(
                    f"structures {b + 1} and {b + 2}: storeys do not meet: floor {i + 1} of structure "
                    f"{number} is at {level:g} m, the floors of its neighbour at {told} m; allowed: "
                    f"common levels, within {ALIGNED:g} m, up to the lower roof"
                )
    return [Meeting(b, i, j, float(0.5 * (one[i] + two[j]))) for i, j in pairs]


def _stack(structure: Building) -> Stack:
    values = {name: array.to_numpy() for name, array in structure.arrays().items()}
    hardening = float(values.get("hardening", 1.0))
    if isinstance(structure, ShearBuilding):
        strength = np.broadcast_to(values.get("yield_drifts", np.inf), values["masses"].shape)
        law = LAWS[type(structure)] if "yield_drifts" in values else ELASTIC
        damping = structure.damping_matrix()
        stiffness = values["stiffnesses"]
        return Stack(values["masses"], stiffness, hardening, strength, law, UNUSED, damping)
    mass, w = values["mass"].reshape(1), 2 * np.pi / values["period"]
    strength = np.atleast_1d(values.get("yield_displacement", np.inf)).astype(float)
    damping = (2 * values["damping"] * w * mass).reshape(1, 1)
    if not structure.yields:
        return Stack(mass, mass * w**2, 1.0, strength, ELASTIC, UNUSED, damping)
    law, shape = LAWS[type(structure)], UNUSED
    if law == BOUC_WEN:
        shape = (float(values["beta"]), float(values["gamma"]), float(values["exponent"]))
    return Stack(mass, mass * w**2, hardening, strength, law, shape, damping)
