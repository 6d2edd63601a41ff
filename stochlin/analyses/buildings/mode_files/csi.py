"""Tables of modes that ETABS and SAP2000 export, as text with separators or as a workbook."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import ClassVar, NamedTuple

import numpy as np

from stochlin.analyses.buildings.mode_files.base import (
    LEAST_SHARE,
    MODE_FILES,
    AskedModes,
    ModeFile,
    ModesOfFile,
    chosen_direction,
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
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range

RATIOS, OF_JOINTS = "Modal Participating Mass Ratios", "Joint Displacements"
OF_CENTRES, OF_STORIES = "Diaphragm Center Of Mass Displacements", "Mass Summary by Story"
HEIGHTS = "Story Definitions", "Story Data"
BASES = "Tower and Base Story Definitions"
COORDINATES, OF_MASSES = "Joint Coordinates", "Assembled Joint Masses"
SHARE = Range(upper=1.0, include_lower=True, include_upper=True)
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
    def recognizes(sheets: Sequence[Sheet]) -> bool:
        """Whether a line begins with 'TABLE:'."""
        return any(TITLE.match(row.cell(0)) for sheet in sheets for row in sheet)

    @staticmethod
    def read(sheets: Sequence[Sheet], asked: AskedModes) -> ModesOfFile:
        """The modes of all tables together."""
        tables = tables_in(sheets)
        ratios = needed_table(tables, RATIOS)
        known = [axis for axis in ("UX", "UY") if ratios.column(axis, needed=False) >= 0]
        axis = chosen_direction(asked, known, f"table {RATIOS}")
        period, share, step = ratios.column("Period"), ratios.column(axis), ratios.column(*STEP)
        for row in ratios.units:
            if (unit := row.cell(period).lower()) not in SECONDS:
                raise row.error(period, f"periods are in {brief(unit)}; allowed: sec")
        modes = {
            _whole(row, step): (row.number(period, "period", POSITIVE), row.number(share, axis, SHARE))
            for row in ratios.rows
        }
        moving = [mode for mode, (_, part) in modes.items() if part >= LEAST_SHARE]
        if not moving:
            raise ratios.titles.error(
                share,
                f"no mode has {LEAST_SHARE:.1%} of the mass along {axis}; choose another direction",
            )
        of_etabs = any(spelled(name) in tables for name in HEIGHTS)
        wanted = Wanted(tables, asked, axis, _only_case(ratios), moving)
        floors = (_of_stories if of_etabs else _of_joints)(wanted)
        masses = np.array([modes[mode][1] for mode in moving]) * floors.masses.sum()
        if not floors.loads.all():
            still = moving[int(np.argmin(floors.loads != 0))]
            what = f"mode {still} has mass along {axis}, and its displacements add up to 0"
            raise ratios.titles.error(share, f"{what}; export all tables of one analysis")
        return ModesOfFile(
            moving,
            np.array([modes[mode][0] for mode in moving]),
            floors.shapes,
            floors.masses,
            floors.levels,
            masses / floors.loads,
            masses,
            [mode for mode in modes if mode not in moving],
            _turning(needed_table(tables, OF_CENTRES if of_etabs else OF_JOINTS), wanted),
        )


def _only_case(ratios: CsiTable) -> str:
    column = ratios.column(*CASE)
    cases = {row.cell(column): row for row in ratios.rows}
    first, *others = cases
    if others:
        raise cases[others[0]].error(
            column, f"a second modal case, {brief(others[0])} beside {brief(first)}; export one of them"
        )
    return first


def _whole(row: SheetRow, column: int) -> int:
    """The number of a mode."""
    value = row.number(column, "mode number", POSITIVE)
    if value != round(value):
        raise row.error(column, f"{value:g} is not a mode number; allowed: a whole number")
    return round(value)


def _displacements(
    table: CsiTable, title: str, wanted: Wanted, points: Sequence[str] = ()
) -> Iterator[tuple[SheetRow, int, float]]:
    """Row, mode and displacement in the column of this title, of the points if any are named."""
    names = [
        n for n in (table.column(t, needed=False) for t in ("Label", "Unique Name", "Joint")) if n >= 0
    ]
    of_case, step, value = table.column(*CASE), table.column(*STEP), table.column(title)
    for row in table.rows:
        if row.cell(of_case) != wanted.case or (points and not {row.cell(n) for n in names} & {*points}):
            continue
        if (mode := _whole(row, step)) in wanted.moving:
            yield row, mode, row.number(value, "displacement")


def _by_floor(
    table: CsiTable, floors: Sequence[str], found: dict[tuple[str, int], float], moving: Sequence[int]
) -> Array:
    """Displacements of the floors in each mode; a ValueError names a floor without one."""
    for floor in floors:
        for mode in moving:
            if (floor, mode) not in found:
                raise table.titles.error(
                    None,
                    f"table {table.name} has no displacement of floor {brief(floor)} in mode {mode}",
                )
    return np.array([[found[floor, mode] for floor in floors] for mode in moving])


def _of_stories(wanted: Wanted) -> Floors:
    """The floors of ETABS, with the shapes of centres of mass or of named joints."""
    (stories, levels), (tables, asked, axis, *_) = _levels(wanted), wanted
    table = needed_table(tables, OF_STORIES)
    column, name = table.column(axis, "Mass X" if axis == "UX" else "Mass Y"), table.column("Story")
    mass = _by_name(table, name, column, "mass", asked.mass_units, NOT_NEGATIVE)
    for story in stories:
        if not mass.get(story):
            raise table.titles.error(name, f"story {brief(story)} has no mass in table {table.name}")
    masses = np.array([mass[story] for story in stories])
    shapes = _of_each_story(needed_table(tables, OF_CENTRES), wanted, stories)
    loads = shapes @ masses
    if asked.points:
        shapes = _of_each_story(needed_table(tables, OF_JOINTS), wanted, stories, asked.points)
    return Floors(levels, masses, shapes, loads)


def _turning(table: CsiTable, wanted: Wanted) -> list[int]:
    """Modes in which floors turn, as far as the table says it; none if the caller names points."""
    title = next((name for name in ("RZ", "R3") if table.column(name, needed=False) >= 0), "")
    if wanted.asked.points or not title:
        return []
    turned = {mode for _, mode, angle in _displacements(table, title, wanted) if abs(angle) > STILL}
    return sorted(turned)


def _of_each_story(
    table: CsiTable, wanted: Wanted, stories: list[str], points: Sequence[str] = ()
) -> Array:
    """Displacements of the stories in each mode; a ValueError for a story with two."""
    column, found = table.column("Story"), dict[tuple[str, int], float]()
    for row, mode, value in _displacements(table, wanted.axis, wanted, points):
        if (row.cell(column), mode) in found:
            what = "name one joint on each" if points else "allowed: one diaphragm on each"
            raise row.error(column, f"a second displacement of this story in mode {mode}; {what}")
        found[row.cell(column), mode] = value
    return _by_floor(table, stories, found, wanted.moving)


def _levels(wanted: Wanted) -> tuple[list[str], Array]:
    """Names of the stories and their levels above the ground [m]; stories come from the roof down."""
    table = needed_table(wanted.tables, *HEIGHTS)
    name, height = table.column("Story", "Name"), table.column("Height")
    size = table.size("length", height, wanted.asked.length_units)
    rows = [row for row in table.rows if row.cell(name).lower() != BASE]
    heights = [row.number(height, "story height", POSITIVE) for row in rows]
    levels = size * np.cumsum(heights[::-1])[::-1]
    return [row.cell(name) for row in rows], levels - _depth(wanted)


def _depth(wanted: Wanted) -> float:
    """Depth of the base below 0, where the ground is [m]; a base above 0 stands on the ground."""
    table = wanted.tables.get(spelled(BASES))
    if table is None:
        return 0.0
    columns = table.column("Tower"), table.column("BSElev")
    towers = _by_name(table, *columns, "length", wanted.asked.length_units)
    return max(0.0, -max(towers.values(), default=0.0))


def _of_joints(wanted: Wanted) -> Floors:
    """The floors of SAP2000: the levels of the joints that have displacements, or of the named ones."""
    tables, asked, axis, _, moving = wanted
    own, moves = f"U{'XY'.index(axis[1]) + 1}", needed_table(tables, OF_JOINTS)
    places, weights = needed_table(tables, COORDINATES), needed_table(tables, OF_MASSES)
    column = places.column("GlobalZ", "Z")
    height = _by_name(places, places.column("Joint"), column, "length", asked.length_units)
    level = {name: z - min(height.values()) for name, z in height.items()}
    column = weights.column(own)
    mass = _by_name(weights, weights.column("Joint"), column, "mass", asked.mass_units, NOT_NEGATIVE)
    mass = {name: value for name, value in mass.items() if value and level.get(name, 0.0) > SAME_LEVEL}
    moved: dict[tuple[str, int], float] = {}
    for row, mode, value in _displacements(moves, own, wanted):
        name = row.cell(moves.column("Joint"))
        if name not in level:
            raise row.error(moves.column("Joint"), f"joint {brief(name)} is not in table {COORDINATES}")
        moved[name, mode] = value
    known = sum(value for name, value in mass.items() if all((name, mode) in moved for mode in moving))
    if not mass or known < (1 - ASIDE) * sum(mass.values()):
        raise moves.titles.error(
            None,
            f"table {OF_JOINTS} has joints with {known / (sum(mass.values()) or 1):.0%} of the mass; "
            "export the modal displacements of all joints with mass",
        )
    loads = np.array(
        [sum(value * moved.get((name, mode), 0.0) for name, value in mass.items()) for mode in moving]
    )
    chosen = {name for name, _ in moved if level[name] > SAME_LEVEL}
    if strange := {*asked.points} - chosen:
        what = f"table {OF_JOINTS} has no joint {listed(sorted(strange))} above the base"
        raise moves.titles.error(None, f"{what}, which points names")
    chosen &= {*asked.points} or chosen
    names = sorted(chosen, key=lambda name: (level[name], name))
    levels = np.array([level[name] for name in names])
    _check_one_each(moves, names, levels)
    masses = _of_floors(weights, levels, mass, level)
    above = levels - max(0.0, -min(height.values()))
    return Floors(above, masses, _by_floor(moves, names, moved, moving), loads)


def _by_name(
    table: CsiTable, names: int, column: int, quantity: str, asked: str | None, allowed: Range = ANY
) -> dict[str, float]:
    """A number of each joint or story, in SI; a ValueError for one that is there twice."""
    size, values = table.size(quantity, column, asked), dict[str, float]()
    for row in table.rows:
        name = row.cell(names)
        if name in values:
            raise row.error(names, f"{brief(name)} is there twice; export one of them")
        values[name] = size * row.number(column, quantity, allowed)
    return values


def _of_floors(table: CsiTable, levels: Array, mass: dict[str, float], level: dict[str, float]) -> Array:
    """Masses of the floors [kg], each joint at the nearest; a ValueError if too much is between them."""
    masses, aside = np.zeros(levels.size), 0.0
    for name, value in mass.items():
        nearest = int(np.argmin(np.abs(levels - level[name])))
        masses[nearest] += value
        aside += value * (abs(levels[nearest] - level[name]) > SAME_LEVEL)
    if aside > ASIDE * masses.sum() or not masses.all():
        told = listed(f"{height:g}" for height in levels)
        raise table.titles.error(
            None,
            f"{aside / masses.sum():.0%} of the mass is not at the floors, {told} m, or one has none; "
            "name one joint on each floor with points=",
        )
    return masses


def _check_one_each(table: CsiTable, names: Sequence[str], levels: Array) -> None:
    """Raise a ValueError if two joints are on one floor."""
    together = np.flatnonzero(np.diff(levels) <= SAME_LEVEL)
    if together.size:
        n = int(together[0])
        raise table.titles.error(
            None,
            f"joints {names[n]} and {names[n + 1]} are both at {levels[n]:g} m; name one on each floor, "
            f"points=[{names[n]!r}, ...]",
        )
