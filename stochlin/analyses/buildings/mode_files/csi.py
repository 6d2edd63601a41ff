"""Tables of modes that ETABS and SAP2000 export, as text with separators or as a workbook."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product
from typing import ClassVar, NamedTuple

import numpy as np

from stochlin.analyses.buildings.mode_files.base import (
    MODE_FILES,
    MODE_NUMBERS,
    AskedModes,
    ModeFile,
    ModesOfFile,
)
from stochlin.analyses.buildings.mode_files.csi_tables import (
    TITLE,
    CsiTable,
    needed_table,
    spelled,
    tables_in,
)
from stochlin.analyses.buildings.sheets import Sheet, SheetRow
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.buildings.modal import ANY
from stochlin.models.parameters import NOT_NEGATIVE, PERIODS, POSITIVE, Range

RATIOS, OF_JOINTS = "Modal Participating Mass Ratios", "Joint Displacements"
OF_CENTRES, OF_STORIES = "Diaphragm Center Of Mass Displacements", "Mass Summary by Story"
HEIGHTS = "Story Definitions", "Story Data"
BASES = "Tower and Base Story Definitions"
COORDINATES, OF_MASSES = "Joint Coordinates", "Assembled Joint Masses"
SHARE = Range(upper=1.0, include_lower=True, include_upper=True)
LEAST_SHARE = 0.001  # of the mass; programs print ratios to four digits, and less is left out
AXES = "UX", "UY"
SAME_LEVEL = 0.01  # largest difference of the levels of joints on one floor [m]
STILL = 1e-6  # rotation of a floor that does not turn [rad]
ASIDE = 0.02  # largest share of the mass that may be between the floors, or at joints without shapes
CASE = "Case", "Output Case", "Load Case", "Load Case/Combo"
STEP = "Mode", "Step Num", "Step Number"
BASE, SECONDS = "base", ("", "s", "sec")


class Floors(NamedTuple):
    """The floors, and for each mode their shapes and the sum of mass times displacement of the whole."""

    levels: Array  # [m]
    masses: Array  # [kg]
    shapes: Array  # (modes, floors)
    loads: Array  # (modes,)


class Wanted(NamedTuple):
    """The tables, and the modal case with those of its modes that move along the axis."""

    tables: dict[str, CsiTable]
    asked: AskedModes
    axis: str
    case: str
    moving: Sequence[int]


@MODE_FILES.register("csi", 2)
class CsiModes(ModeFile):
    """Tables of ETABS and SAP2000: each has a line ``TABLE:  name``, titles, units, and rows.

    The file needs the table Modal Participating Mass Ratios, and besides, of ETABS, Story Definitions,
    Mass Summary by Story, Diaphragm Center Of Mass Displacements and, for ``points``, Joint
    Displacements; of SAP2000, Joint Coordinates, Assembled Joint Masses and Joint Displacements. Their
    order does not matter, and others are left alone. Stories come from the roof down.

    The participation factor of a mode is its effective mass over the sum of mass times displacement of
    the whole floors. It holds for floors that turn, and for any scale of the shapes.

    References
    ----------
    Computers and Structures, Inc., ETABS and SAP2000, database tables; the names of their fields are
    those of ``Results.ModalParticipatingMassRatios`` in the CSI application programming interface.
    """

    header: ClassVar[str] = f"a line 'TABLE:  {RATIOS}' of ETABS or SAP2000"
    takes: ClassVar[Sequence[str]] = AskedModes._fields

    @staticmethod
    def buildings(sheets: Sequence[Sheet]) -> Sequence[Sequence[Sheet]]:
        """All sheets together in which a line begins with 'TABLE:'."""
        together = [sheet for sheet in sheets if any(TITLE.match(row.cell(0)) for row in sheet)]
        return [together] if together else []

    @staticmethod
    def read(sheets: Sequence[Sheet], asked: AskedModes) -> ModesOfFile:
        """The modes of all tables together."""
        tables = tables_in(sheets)
        ratios = needed_table(tables, RATIOS)
        axis = _axis(ratios, asked.direction)
        period, share, step = ratios.column("Period"), ratios.column(axis), ratios.column(*STEP)
        for row in ratios.units:
            if (unit := row.cell(period).lower()) not in SECONDS:
                raise row.error(period, f"periods are in {brief(unit)}; allowed: sec")
        modes = ratios.by(step, _whole)
        periods = {mode: row.number(period, "period", PERIODS) for mode, row in modes.items()}
        shares = {mode: row.number(share, axis, SHARE) for mode, row in modes.items()}
        moving = [mode for mode in modes if shares[mode] >= LEAST_SHARE]
        if not moving:
            raise ratios.error(f"has no mode with {LEAST_SHARE:.1%} of the mass along {axis}")
        of_etabs = any(spelled(name) in tables for name in HEIGHTS)
        wanted = Wanted(tables, asked, axis, _only_case(ratios), moving)
        floors = (_of_stories if of_etabs else _of_joints)(wanted)
        masses = np.array([shares[mode] for mode in moving]) * floors.masses.sum()
        if not floors.loads.all():
            still = moving[int(np.argmin(floors.loads != 0))]
            raise ratios.error(f"has mode {still}, which does not move; export one analysis alone")
        return ModesOfFile(
            moving,
            np.array([periods[mode] for mode in moving]),
            floors.shapes,
            floors.masses,
            floors.levels,
            masses / floors.loads,
            masses,
            [mode for mode in modes if mode not in moving],
            _turning(needed_table(tables, OF_CENTRES if of_etabs else OF_JOINTS), wanted),
        )


def _axis(ratios: CsiTable, direction: str | None) -> str:
    """The direction that is asked for, or the only one."""
    known = [axis for axis in AXES if ratios.column(axis, needed=False) >= 0]
    axis = direction or (known[0] if len(known) == 1 else "missing")
    if axis not in known:
        there = f"table {RATIOS} has modes along {' and '.join(known)}"
        raise ValueError(f"direction is {axis}: {there}; give that of the gap, direction={AXES[0]!r}")
    return axis


def _only_case(ratios: CsiTable) -> str:
    column = ratios.column(*CASE)
    cases = {row.cell(column): row for row in ratios.rows}
    first, *others = cases
    if others:
        what = f"a second modal case, {brief(others[0])} beside {brief(first)}; export one of them"
        raise cases[others[0]].error(column, what)
    return first


def _whole(row: SheetRow, column: int) -> int:
    """The number of a mode."""
    value = row.number(column, "mode number", MODE_NUMBERS)
    if value != round(value):
        raise row.error(column, f"{value:g} is not a mode number; allowed: a whole number")
    return round(value)


def _displacements(
    table: CsiTable, title: str, wanted: Wanted, points: Sequence[str] = ()
) -> dict[tuple[str, int], float]:
    """What a column has by story or joint and mode, of the points if any are named."""
    titles = ("Label", "Unique Name", "Joint")
    labels = [n for label in titles if (n := table.column(label, needed=False)) >= 0]
    columns = ("Story", "Joint"), CASE, STEP, (title,)
    column, of_case, step, value = (table.column(*titles) for titles in columns)
    found: dict[tuple[str, int], float] = {}
    for row in table.rows:
        if row.cell(of_case) != wanted.case or (points and not {*points} & {*map(row.cell, labels)}):
            continue
        name, mode = row.cell(column), _whole(row, step)
        if (name, mode) in found:
            what = f"a second displacement of {brief(name)} in mode {mode}"
            raise row.error(column, f"{what}; allowed: one diaphragm or joint on each floor")
        if mode in wanted.moving:
            found[name, mode] = row.number(value, "displacement")
    return found


def _by_floor(
    table: CsiTable, floors: Sequence[str], found: dict[tuple[str, int], float], moving: Sequence[int]
) -> Array:
    """Displacements of the floors in each mode; a ValueError names a floor without one."""
    for floor, mode in product(floors, moving):
        if (floor, mode) not in found:
            raise table.error(f"has no displacement of floor {brief(floor)} in mode {mode}")
    return np.array([[found[floor, mode] for floor in floors] for mode in moving])


def _of_stories(wanted: Wanted) -> Floors:
    """The floors of ETABS, with the shapes of centres of mass or of named joints."""
    (stories, levels), (tables, asked, axis, _, moving) = _levels(wanted), wanted
    table = needed_table(tables, OF_STORIES)
    titles = axis, "Mass X" if axis == "UX" else "Mass Y"
    mass = _by_name(table, titles, "mass", asked.mass_units, NOT_NEGATIVE)
    if bare := [story for story in stories if not mass.get(story)]:
        raise table.error(f"has no mass of story {listed(bare)}")
    masses = np.array([mass[story] for story in stories])
    table = needed_table(tables, OF_CENTRES)
    shapes = _by_floor(table, stories, _displacements(table, axis, wanted), moving)
    loads = shapes @ masses
    if asked.points:
        table = needed_table(tables, OF_JOINTS)
        moved = _displacements(table, axis, wanted, asked.points)
        shapes = _by_floor(table, stories, moved, moving)
    return Floors(levels, masses, shapes, loads)


def _turning(table: CsiTable, wanted: Wanted) -> list[int]:
    """Modes in which floors turn, as far as the table says it; none if the caller names points."""
    title = next((name for name in ("RZ", "R3") if table.column(name, needed=False) >= 0), "")
    if wanted.asked.points or not title:
        return []
    angles = _displacements(table, title, wanted)
    return sorted({mode for (_, mode), angle in angles.items() if abs(angle) > STILL})


def _levels(wanted: Wanted) -> tuple[list[str], Array]:
    """Names of the stories and their levels above the ground [m]; stories come from the roof down."""
    table = needed_table(wanted.tables, *HEIGHTS)
    name, height = table.column("Story", "Name"), table.column("Height")
    size = table.size("length", height, wanted.asked.length_units)
    rows = {story: row for story, row in table.by(name, SheetRow.cell).items() if story.lower() != BASE}
    heights = [row.number(height, "story height", POSITIVE) for row in rows.values()]
    return [*rows], size * np.cumsum(heights[::-1])[::-1] - _depth(wanted)


def _depth(wanted: Wanted) -> float:
    """Depth of the base below 0, where the ground is [m]; a base above 0 stands on the ground."""
    table = wanted.tables.get(spelled(BASES))
    if table is None:
        return 0.0
    towers = _by_name(table, ["BSElev"], "length", wanted.asked.length_units)
    return max(0.0, -max(towers.values(), default=0.0))


def _of_joints(wanted: Wanted) -> Floors:
    """The floors of SAP2000: the levels of the joints that have displacements, or of the named ones."""
    tables, asked, axis, _, moving = wanted
    own, moves = f"U{'XY'.index(axis[1]) + 1}", needed_table(tables, OF_JOINTS)
    places, weights = needed_table(tables, COORDINATES), needed_table(tables, OF_MASSES)
    height = _by_name(places, ("GlobalZ", "Z"), "length", asked.length_units)
    level = {name: z - min(height.values()) for name, z in height.items()}
    mass = _by_name(weights, [own], "mass", asked.mass_units, NOT_NEGATIVE)
    mass = {name: value for name, value in mass.items() if value and level.get(name, 0.0) > SAME_LEVEL}
    moved = _displacements(moves, own, wanted)
    if unknown := {name for name, _ in moved} - level.keys():
        raise moves.error(f"has joint {listed(sorted(unknown))}, which is not in table {COORDINATES}")
    known = sum(value for name, value in mass.items() if all((name, mode) in moved for mode in moving))
    if not mass or known < (1 - ASIDE) * sum(mass.values()):
        what = f"has joints with {known / (sum(mass.values()) or 1):.0%} of the mass"
        raise moves.error(f"{what}; export the modal displacements of all joints with mass")
    of_mass = [[moved.get((name, mode), 0.0) for name in mass] for mode in moving]
    loads = np.array(of_mass) @ [*mass.values()]
    chosen = {name for name, _ in moved if level[name] > SAME_LEVEL}
    if strange := {*asked.points} - chosen:
        raise moves.error(f"has no joint {listed(sorted(strange))} above the base, which points names")
    chosen &= {*asked.points} or chosen
    names = sorted(chosen, key=lambda name: (level[name], name))
    levels = np.array([level[name] for name in names])
    _check_one_each(moves, names, level)
    masses = _of_floors(weights, levels, mass, level)
    above = levels - max(0.0, -min(height.values()))
    return Floors(above, masses, _by_floor(moves, names, moved, moving), loads)


def _by_name(
    table: CsiTable, titles: Sequence[str], quantity: str, asked: str | None, allowed: Range = ANY
) -> dict[str, float]:
    """A number of each joint, story or tower, in SI; a ValueError for one that is there twice."""
    rows, column = (
        table.by(table.column("Story", "Joint", "Tower"), SheetRow.cell),
        table.column(*titles),
    )
    size = table.size(quantity, column, asked)
    return {name: size * row.number(column, quantity, allowed) for name, row in rows.items()}


def _of_floors(table: CsiTable, levels: Array, mass: dict[str, float], level: dict[str, float]) -> Array:
    """Masses of the floors [kg], each joint at the nearest; a ValueError if too much is between them."""
    masses, aside = np.zeros(levels.size), 0.0
    for name, value in mass.items():
        nearest = int(np.argmin(np.abs(levels - level[name])))
        masses[nearest] += value
        aside += value * (abs(levels[nearest] - level[name]) > SAME_LEVEL)
    if aside > ASIDE * masses.sum() or not masses.all():
        floors = listed(f"{height:g}" for height in levels)
        what = f"has {aside / masses.sum():.0%} of the mass not at the floors, {floors} m"
        raise table.error(f"{what}, or a floor has none; name one joint on each floor with points=")
    return masses


def _check_one_each(table: CsiTable, names: Sequence[str], level: dict[str, float]) -> None:
    """Raise a ValueError if two joints are on one floor."""
    for lower, upper in pairwise(names):
        if level[upper] - level[lower] <= SAME_LEVEL:
            both = f"has joints {lower} and {upper}, both at {level[lower]:g} m"
            raise table.error(f"{both}; name one on each floor, points=[{lower!r}, ...]")
