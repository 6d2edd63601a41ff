"""Structures on one ground as one system: floors with masses, storeys between them, and links.

A link ties floors of two structures. It may also be a device inside one structure, between two of
its floors or between a floor and the ground.

An oscillator is treated as a building of one storey. Storeys and springs of links are the elements
of the system. The force of an element is ``post d + couple z`` [N], where ``d`` [m] is its drift
and ``z`` [m] the elastic part of the drift, which follows from the hysteresis law. ``post``
includes the P-delta effect of the weight above a storey.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.messages import brief
from stochlin.models.buildings.base import MultistoreyBuilding
from stochlin.models.buildings.modal import ModalBuilding
from stochlin.models.links import NUMBER_OF_GROUND, Link
from stochlin.models.parameters import expect
from stochlin.models.structures import CURE, AnyStructure, Structure

LEVEL = 0.05  # [m], floors whose heights differ by less are at the same level


class StickModel(NamedTuple):
    """One structure as a stick: its floors, with its elements, the storeys below them or its modes.

    Of an oscillator with arrays of cells (c,) as parameters, the system has the leading axis of the
    cells.
    """

    # with as many elements as coordinates; without ``couple`` where they stay elastic
    system: System
    levels: Array  # (f,) [m], heights of the floors above the ground; NaN for an oscillator
    law: Structure  # hysteresis law of all elements; without strength if they stay elastic
    shear_shares: Array  # (f, n) [-], of the forces of the elements in the storey shears
    # whether coordinates and elements are modes in place of floors and storeys
    by_modes: bool = False

    @property
    def is_oscillator(self) -> bool:
        """Whether the structure is an oscillator, which has no height."""
        return bool(np.isnan(self.levels).any())

    def floors(self, number: int) -> list[str]:
        """Names of the floors, where the structure has this number."""
        return [str(number)] if self.is_oscillator else numbered(str(number), self.levels.size)

    @property
    def coordinates(self) -> int:
        """Number of coordinates, which is also that of the elements."""
        return int(self.system.mass.shape[-1])

    @property
    def yields(self) -> Array:
        """Whether each element can yield in some cell (n,)."""
        return np.asarray(~np.isposinf(np.atleast_2d(self.system.strength)).all(axis=0))

    @property
    def limits(self) -> Array:
        """Extension of an element at which the structure falls (..., n) [m]; infinite if it cannot.

        An element without stiffness after yielding has lost all its force there; a storey has also
        fallen where its drift is its height.
        """
        storey = self.system
        z = self.law.largest_z().to_numpy()
        heights = np.inf if self.by_modes else np.diff(self.levels, prepend=0.0)
        powerless = falls_at(storey.post, storey.couple, (storey.strength.T * z).T)
        return np.where(np.isfinite(powerless), np.fmin(powerless, heights), np.inf)

    @property
    def law_parameters(self) -> Array:
        """Parameters that the law adds (n, k), one row for each element."""
        shape = self.system.mass.shape
        values = (array.to_numpy() for array in self.law.law_parameters())
        rows = [a[:, None] if a.ndim and len(shape) > 1 else a for a in values]
        return np.stack([np.zeros(shape), *(np.broadcast_to(a, shape) for a in rows)], axis=-1)[
            ..., 1:
        ]


class PlacedLink(NamedTuple):
    """A link and the numbers of the floors that it ties, counted from 0 through all structures."""

    floor: int
    other: int  # -1 is the ground, for a device inside one structure
    link: Link
    number: int  # of the link in the list that the user gave, from 1

    @property
    def name(self) -> str:
        """Name of the spring of the link in the dimension ``element``."""
        return f"link {self.number}"


class Assembly(NamedTuple):
    """Structures on one ground, and the links between them."""

    sticks: tuple[StickModel, ...]
    placed_links: tuple[PlacedLink, ...]

    @property
    def has_storeys(self) -> bool:
        """Whether there is a building with storeys."""
        return not all(stick.is_oscillator for stick in self.sticks)

    @property
    def first(self) -> Array:
        """Number of the first floor of each structure, then the count of all floors (s + 1,)."""
        return np.concatenate([[0], np.cumsum([stick.levels.size for stick in self.sticks])])

    @property
    def first_coordinate(self) -> Array:
        """Number of the first coordinate of each structure, then the count of all (s + 1,)."""
        return np.concatenate([[0], np.cumsum([stick.coordinates for stick in self.sticks])])

    @property
    def floors(self) -> list[str]:
        """Names of the floors and the storeys below them; 2.3 is the third floor of structure 2."""
        return [name for s, stick in enumerate(self.sticks, start=1) for name in stick.floors(s)]

    @property
    def coordinates(self) -> list[str]:
        """Names of the coordinates and of their elements: floors and storeys, or modes."""
        names: list[str] = []
        for s, stick in enumerate(self.sticks, start=1):
            modes = numbered(f"mode {s}", stick.coordinates)
            names.extend(modes if stick.by_modes else stick.floors(s))
        return names

    @property
    def shear_shares(self) -> Array:
        """Shares of the forces of elements in the storey shears (f, n) [-]; NaN if not known."""
        return scipy.linalg.block_diag(*(stick.shear_shares for stick in self.sticks))

    @property
    def yielding_modes(self) -> Array:
        """Numbers of the coordinates that are modes which can yield."""
        can_yield = [stick.yields & stick.by_modes for stick in self.sticks]
        return np.flatnonzero(np.concatenate(can_yield))

    @property
    def watched(self) -> list[str]:
        """Names of what is reported as elements: storeys below all floors, and modes that yield."""
        names = self.coordinates
        return [*self.floors, *(names[mode] for mode in self.yielding_modes)]

    @property
    def of_watched(self) -> Array:
        """Number of the element of each of the `watched`; -1 for storeys of a building by modes."""
        storeys = [
            np.full(stick.levels.size, -1)
            if stick.by_modes
            else begin + np.arange(stick.coordinates)
            for begin, stick in zip(self.first_coordinate[:-1], self.sticks, strict=True)
        ]
        return np.concatenate([*storeys, self.yielding_modes])

    @property
    def springs(self) -> list[str]:
        """Names of the springs: the elements, and after them the links."""
        return [*self.coordinates, *(placed.name for placed in self.placed_links)]

    @property
    def yielding_links(self) -> Array:
        """Numbers of the links that yield among the springs."""
        yields = [placed.link.yields for placed in self.placed_links]
        return int(self.first_coordinate[-1]) + np.flatnonzero(yields)

    @property
    def displacements(self) -> Array:
        """Matrix (w, n) from the coordinates to floors and then modes that yield, as `watched`."""
        shapes = self.storeys.shapes
        return np.concatenate([shapes, np.eye(shapes.shape[1])[self.yielding_modes]])

    @property
    def drifts(self) -> Array:
        """Matrix (w, w) from the `displacements` to drifts of storeys; modes stay as they are."""
        counts = [stick.levels.size for stick in self.sticks]
        storeys = (np.eye(count) - np.eye(count, k=-1) for count in counts)
        return scipy.linalg.block_diag(*storeys, np.eye(self.yielding_modes.size))

    @property
    def owners(self) -> Array:
        """Number of the structure of each of the `watched`, from 0 (w,)."""
        numbers = np.arange(len(self.sticks))
        of_modes = np.repeat(numbers, np.diff(self.first_coordinate))[self.yielding_modes]
        return np.concatenate([np.repeat(numbers, np.diff(self.first)), of_modes])

    @property
    def limits(self) -> Array:
        """Drift of each `watched` at which its structure falls (w,) [m]: `StickModel.limits`."""
        limits = np.concatenate([stick.limits for stick in self.sticks])
        return self.of_elements(limits, np.inf, np.inf)

    def fallen(self, drifts: Array, limits: Array) -> Array:
        """Whether each structure has fallen (..., s), by drifts of the `watched` (..., w) [m]."""
        beyond = np.isfinite(limits) & ~(np.abs(drifts) <= limits)
        of_structures = (self.owners == n for n in range(len(self.sticks)))
        return np.stack([beyond[..., watched].any(axis=-1) for watched in of_structures], axis=-1)

    @property
    def watched_strength(self) -> Array:
        """Strength (..., w) of the `watched` [m]; NaN for storeys of a building whose modes yield.

        Such storeys have no law of their own. Where nothing can yield, it is infinite.
        """
        return self.of_elements(self.storeys.strength, np.inf, np.nan)

    def of_elements(self, values: Array, elastic: float, unknown: float) -> Array:
        """Values (..., n) of the elements for the `watched`.

        Storeys of a building by its modes have the value ``elastic``, or ``unknown`` if modes
        yield.
        """
        weak = np.array([bool(stick.yields.any()) for stick in self.sticks])
        blank = np.where(weak[self.owners], unknown, elastic)
        return np.where(self.of_watched >= 0, values[..., self.of_watched], blank)

    @property
    def storeys(self) -> System:
        """All structures side by side, without the links."""
        return System.beside([stick.system for stick in self.sticks])

    @property
    def extensions(self) -> Array:
        """Matrix (s, n) that turns the n coordinates into extensions of the s elements.

        The elements are the storeys, followed by the springs of links with the extension ``u1 -
        u2``.
        """
        _, _, storeys, shapes, *_ = self.storeys
        ground = np.zeros_like(shapes[0])
        links = [
            shapes[t.floor] - (shapes[t.other] if t.other >= 0 else ground)
            for t in self.placed_links
        ]
        return np.concatenate([storeys, np.reshape(links, (-1, ground.size))])


def numbered(name: str, count: int) -> list[str]:
    """A name with the numbers from 1 to ``count`` after it."""
    return [f"{name}.{number}" for number in range(1, count + 1)]


def falls_at(post: Array, couple: Array, strength: Array) -> Array:
    """Extension [m] at which the force of an element that yields is 0 again; infinite if never."""
    with np.errstate(all="ignore"):
        return np.where((post < 0) & (couple > 0), couple * strength / -post, np.inf)


def stick_model_of(structure: AnyStructure) -> StickModel:
    """A structure as a stick model; the parameters of an oscillator are numbers or arrays (c,).

    Its strength is given in metres. An oscillator without a mass is taken to have 1 kg.
    """
    if isinstance(structure, MultistoreyBuilding):
        by_modes = isinstance(structure, ModalBuilding)
        shares = structure.shear_shares()
        return StickModel(
            structure.system(), structure.levels(), structure.element_law, shares, by_modes
        )
    assert isinstance(structure, Structure)
    values = {name: np.asarray(value) for name, value in structure.cells().items()}
    mass = values.get("mass", np.float64(1.0))
    w = 2 * np.pi / values["period"]
    hardening = values["hardening"] if structure.yields else np.ones(())
    strength = values.get("yield_displacement", np.inf)
    with np.errstate(over="ignore", invalid="ignore"):  # extreme structures get a status
        k = mass * w**2
        columns = (
            mass,
            hardening * k,
            (1 - hardening) * k,
            strength,
            2 * values["damping"] * w * mass,
        )
    shape = np.broadcast_shapes(*(np.shape(value) for value in (*values.values(), *columns)))
    wide = (np.broadcast_to(column, shape).astype(float)[..., None] for column in columns)
    elastic, post, couple, limit, damping = wide
    unit = np.ones((1, 1))
    storey = System(elastic, damping[..., None], unit, unit, post, couple, limit)
    return StickModel(storey, np.full(1, np.nan), structure, np.ones((1, 1)))


def stick_models_of(oscillators: Structure, dimension: str, count: int) -> list[StickModel]:
    """Stick models of ``count`` oscillators with parameters along ``dimension``."""
    whole = stick_model_of(oscillators)
    varies = bool(oscillators.own_parameters())
    wide = whole.system.over_cells(count)
    laws = (oscillators.isel({dimension: n}) if varies else oscillators for n in range(count))
    return [whole._replace(system=wide.at(n), law=law) for n, law in enumerate(laws)]


def check_stationary(system: Assembly) -> None:
    """Raise a ValueError if a storey has no positive stiffness after yielding."""
    for number, stick in enumerate(system.sticks, start=1):
        weak = np.atleast_2d((stick.system.post <= 0) & (stick.system.couple > 0)).any(axis=0)
        if not weak.any():
            continue
        storey = int(np.argmax(weak))
        left = stick.system.post[..., storey].min()
        what = f"structures, number {number}: storey {storey + 1} has no stiffness after yielding"
        cure = f"{CURE}; or give more hardening, or p_delta=False"
        raise ValueError(f"{what} ({left:.3g} N/m), whose drift has no stationary value; {cure}")


def shares_at(levels: Array, height: float) -> Array:
    """Shares of the floors (f,) in the displacement at a height [m], linear between them.

    The displacement at the ground is zero. An oscillator, whose level is NaN, moves as a whole.
    """
    if np.isnan(levels).any():
        return np.ones(1)
    floors = np.eye(levels.size)
    return np.array([np.interp(height, [0.0, *levels], [0.0, *floor]) for floor in floors])


def weaker(structure: AnyStructure, factor: float) -> AnyStructure:
    """The structure with its yield displacement or yield drifts [m] divided by ``factor``."""
    if not structure.yields or factor == 1:
        return structure
    name = structure.strength_name
    return replace(structure, **{name: getattr(structure, name) / factor})


def assembly_of(structures: Sequence[AnyStructure], links: Sequence[Link | None] = ()) -> Assembly:
    """Structures, whose strengths are given in metres, and their links as one system.

    Raises
    ------
    ValueError
        If a link names a structure or a floor that does not exist, or ties a structure without a
        mass.
    """
    sticks = tuple(stick_model_of(structure) for structure in structures)
    first = Assembly(sticks, ()).first
    placed_links = []
    for number, link in enumerate(links, start=1):
        if link is None:
            continue
        left, right = link.structures or (number, number + 1)
        if max(left, right) > len(sticks):
            what = f"link {number}: ties the structures {left} and {right} of {len(sticks)}"
            raise ValueError(f"{what}; allowed: structures = two of 1 to {len(sticks)}")
        for side in (left, right):
            check_mass(structures[side - 1], f"structure {side}")
        floors = link.floors or common_floors(sticks[left - 1], sticks[right - 1], number)
        for side, floor in zip((left, right), floors, strict=True):
            highest = sticks[side - 1].levels.size
            if floor > highest:
                lowest = NUMBER_OF_GROUND if link.within_one else 1
                what = f"link {number}: floors = {link.floors}, structure {side} has {highest}"
                raise ValueError(f"{what}; allowed: {lowest} to {highest}")
        on = int(first[left - 1]) + floors[0] - 1
        other = -1 if floors[1] == NUMBER_OF_GROUND else int(first[right - 1]) + floors[1] - 1
        placed_links.append(PlacedLink(on, other, link, number))
    return Assembly(sticks, tuple(placed_links))


def common_floors(first: StickModel, second: StickModel, number: int) -> tuple[int, int]:
    """Numbers, from 1, of the highest floors of two structures at the same level.

    An oscillator is taken to be at the level of the other structure's roof. ``number`` is that of
    the link, for messages.
    """
    if first.is_oscillator or second.is_oscillator:
        return first.levels.size, second.levels.size
    level = np.abs(first.levels[:, None] - second.levels) < LEVEL
    if not level.any():
        raise ValueError(f"link {number}: no two floors are at one level; give floors=(.., ..)")
    i, j = np.argwhere(level)[-1] + 1
    return int(i), int(j)


def slabs_on_columns(first: Array, second: Array) -> list[tuple[int, int]]:
    """Slabs of two neighbours that face columns of the other, from the ground up.

    ``first`` and ``second`` are the levels of the floors [m]. Each slab is a pair of the side, 0 or
    1, and the floor number, from 1. A slab faces columns if it is below the roof of the other
    building and the other building has no floor at the same level.
    """
    slabs = [
        (float(level), side, floor)
        for side, (levels, other) in enumerate(((first, second), (second, first)))
        for floor, level in enumerate(levels, start=1)
        if level < other[-1] and np.abs(other - level).min() >= LEVEL
    ]
    return [(side, floor) for _, side, floor in sorted(slabs)]


def check_links(name: str, links: object, count: int) -> tuple[Link | None, ...]:
    """The links between ``count`` structures as a tuple, checked; None stands for no link.

    A single link need not be in a list. ``name`` is that of the argument, for messages.
    """
    if links is None:
        return ()
    if isinstance(links, Link):
        links = [links]
    if not isinstance(links, (list, tuple)):
        raise TypeError(f"{name} = {brief(links)}; allowed: a Link, or a list of Link and None")
    for number, link in enumerate(links, start=1):
        if link is not None:
            expect(link, Link, f"{name}, number {number}" if len(links) > 1 else name)
    places = [None if link is None else link.structures for link in links]
    by_place = links and not any(places)
    too_many = any(place is None for place in places[max(count - 1, 0) :])
    if too_many or (by_place and len(links) != count - 1):
        allowed = "one between each two neighbours, or None, or links with structures=(.., ..)"
        raise ValueError(f"{name}: {len(links)} given; allowed: {allowed}")
    return tuple(links)


def check_mass(structure: AnyStructure, role: str) -> None:
    """Raise a ValueError if a structure on which a link or a contact acts has no mass."""
    if not structure.has_mass:
        raise ValueError(f"{role}: mass is not given; links and contacts need it, 0 < value, in kg")
