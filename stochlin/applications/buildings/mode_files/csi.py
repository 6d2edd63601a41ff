"""Tables of modes that ETABS exports, as text with separators or as a workbook."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.sparse import csgraph

from stochlin.applications.buildings.mode_files import (
    AskedModes,
    ModesOfFile,
    check_moving,
    check_seconds,
)
from stochlin.applications.buildings.mode_files.csi_tables import (
    BASES,
    CENTRE_TABLE,
    DIAPHRAGM_TABLE,
    HEIGHTS,
    JOINT_TABLE,
    MASS_RATIOS,
    MERGED_COLUMNS,
    STORY_DATA,
    STORY_TABLE,
    SUMMARY,
    keyed,
    needed_tables,
)
from stochlin.applications.sheets.columns import check_one_kind
from stochlin.applications.sheets.sheets import Table, spelled
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.buildings.base import MODE
from stochlin.models.parameters import ANY_NUMBER, NOT_NEGATIVE, PERIODS, POSITIVE, Range

MASS_RATIO = Range(upper=1.0, include_lower=True, include_upper=True)
LEAST_MASS_RATIO = 0.001  # of the mass; programs print ratios to four digits, and less is left out
PLAN_AXES = "UX", "UY"
LEAST_MOVE = 0.1  # share of the largest displacement of a mode from which a floor moves in it
LEAST_ROTATION = 1e-6  # rotation of a floor that turns [rad]
BASE = "base"


class Floors(NamedTuple):
    """The floors with their shapes, and the sums of mass times displacement of the whole model."""

    names: pd.Index  # of stories
    levels: Array  # [m]
    masses: Array  # [kg]
    shapes: Array  # (modes, floors)
    loads: Array  # (modes,)
    parts: Array  # of these floors alone (modes,)
    total: float  # mass of the whole model [kg]


class ModalCase(NamedTuple):
    """The modal case with those of its modes that move along the axis, and what is asked for."""

    choice: AskedModes
    axis: str
    case: str
    moving: pd.Index


def read(content: Mapping[str, Table], choice: AskedModes) -> ModesOfFile:
    """The modes of tables of ETABS: a line ``TABLE:  name``, titles, units, and rows.

    Needed are Modal Participating Mass Ratios, Story Definitions, Mass Summary by Story or by
    Diaphragm or Centers Of Mass And Rigidity, Diaphragm Center Of Mass Displacements and, for
    ``points``, Joint Displacements. Their order does not matter, and others are left alone. Where
    the line with the name is missing, the name of the sheet or of the file says which table it is.

    The participation factor of a mode is its effective mass over the sum of mass times displacement
    of the whole model. It holds for floors that turn, for several towers, and for any scale of the
    shapes.

    References
    ----------
    Computers and Structures, Inc., ETABS, database tables; the names of their fields are
    those of ``Results.ModalParticipatingMassRatios`` in the CSI application programming interface.
    """
    by_diaphragm = [DIAPHRAGM_TABLE, SUMMARY]
    of_mass = [*by_diaphragm, STORY_TABLE] if choice.tower else [STORY_TABLE, *by_diaphragm]
    groups = [[MASS_RATIOS], [HEIGHTS, STORY_DATA], of_mass, [CENTRE_TABLE]]
    groups += [[JOINT_TABLE]] if choice.points else []
    ratios, *others = needed_tables(content, *groups)
    axis = _axis(ratios, choice.direction)
    check_one_kind(ratios, ratios.column("case"), "load case")
    column = ratios.column("period")
    check_seconds(
        ratios.said_of(column).unit, ratios.sheet.where(ratios.units or ratios.titles, column)
    )
    periods = keyed(ratios, [MODE], "period", "period", PERIODS)
    shares = keyed(ratios, [MODE], axis.lower(), axis, MASS_RATIO)
    moving = shares[shares >= LEAST_MASS_RATIO]
    if moving.empty:
        raise ratios.error(f"has no mode with {LEAST_MASS_RATIO:.1%} of the mass along {axis}")
    wanted = ModalCase(choice, axis, str(ratios.texts("case").iloc[0]), moving.index)
    floors = _floors(content, others, wanted)
    _check_one_building(floors, others[2])
    effective = moving.to_numpy() * floors.total
    if choice.tower is None:
        check_moving([*moving.index], floors.loads / np.sqrt(effective), others[2].sheet.name)
    factors = np.divide(effective, floors.loads, np.zeros(effective.size), where=floors.loads != 0)
    masses = factors * floors.parts
    here = masses >= 0.999 * LEAST_MASS_RATIO * floors.masses.sum()
    chosen = moving.index[here]
    return ModesOfFile(
        chosen.tolist(),
        periods[chosen].to_numpy(),
        floors.shapes[here],
        floors.masses,
        floors.levels,
        factors[here],
        masses[here],
        shares.index[~shares.index.isin(chosen)].tolist(),
        [] if choice.points else _turning(others[2], wanted._replace(moving=chosen)),
    )


def _axis(ratios: Table, direction: str | None) -> str:
    """The direction that is asked for, or the only one."""
    axes = [axis for axis in PLAN_AXES if axis.lower() in ratios.names]
    axis = direction or (axes[0] if len(axes) == 1 else "missing")
    if axis not in axes:
        there = f"table {MASS_RATIOS} has modes along {' and '.join(axes)}"
        raise ValueError(
            f"direction is {axis}: {there}; give that of the gap, direction={PLAN_AXES[0]!r}"
        )
    return axis


def _moves(table: Table, title: str, wanted: ModalCase, names: Sequence[str]) -> pd.DataFrame:
    """What a column has in the modal case, by the columns with these names and by mode."""
    table = table._replace(rows=table.rows[table.texts("case") == wanted.case])
    if table.rows.empty:
        raise ValueError(f"{table.sheet.name}: {table.name} has no case {brief(wanted.case)}")
    moves = keyed(table, [*names, MODE], title, "displacement", None)
    return moves.unstack(MODE).reindex(columns=wanted.moving)


def _shapes(table: Table, moves: pd.DataFrame, floors: Sequence[str]) -> Array:
    """Displacements (modes, floors); a ValueError names a floor without one."""
    shapes = moves.reindex(floors)
    missing = shapes.isna().to_numpy()
    if missing.any():
        floor, mode = np.argwhere(missing)[0]
        place = f"floor {brief(floors[floor])} in mode {shapes.columns[mode]}"
        raise table.error(f"has no displacement of {place}")
    return shapes.to_numpy().T


def _of_tower(table: Table, tower: str | None) -> Table:
    """The lines of a tower; all if the table does not say whose they are."""
    if "tower" not in table.names or not (here := table.texts("tower") == tower).any():
        return table
    return table._replace(rows=table.rows[here])


def _chosen(places: pd.Index, heights: Table, weights: Table, tower: str | None) -> Array:
    """Which places are of the tower; a ValueError unless they are of one building."""
    towers = [*heights.texts("tower").unique()] if "tower" in heights.names else []
    groups = [places.get_level_values(name) for name in places.names if name != "story"]
    names = [*dict.fromkeys([*towers, *(name for group in groups for name in group)])]
    if tower is not None and tower not in names:
        raise ValueError(f"tower = {brief(tower)} is not in the tables; allowed: {listed(names)}")
    by_name = "tower" in places.names or not heights.texts("story").duplicated().any()
    choices = towers
    if not by_name:
        choices = [*places.unique("diaphragm")] if "diaphragm" in places.names else []
    chosen = places.get_level_values("story").isin(_of_tower(heights, tower).texts("story"))
    here = np.any([group == tower for group in groups], axis=0)
    if tower is not None and not np.any(here) and not by_name:
        what = f"does not say which masses are those of {brief(tower)}"
        raise weights.error(
            f"{what}; name a diaphragm as tower=, of {listed(choices) or DIAPHRAGM_TABLE}"
        )
    if np.any(here):
        chosen &= here
    twice = places[chosen].get_level_values("story").duplicated(keep=False)
    several = [*pd.unique(places[chosen][twice].get_level_values(-1))]
    several = choices or towers if tower is None and len(towers) > 1 else several
    if len(several) > 1:
        what = f"has {listed(several)}, which may be several buildings"
        raise heights.error(f"{what}; give that at the gap, tower={several[0]!r}")
    return chosen


def _floors(tables: Mapping[str, Table], others: Sequence[Table], wanted: ModalCase) -> Floors:
    """The floors, with the shapes of centres of mass or of named joints."""
    heights, weights, centres = others[:3]
    choice = wanted.choice
    axis = wanted.axis.lower()
    names = [name for name in MERGED_COLUMNS if name in weights.names and name in centres.names]
    mass = keyed(weights, names, axis, "mass", NOT_NEGATIVE, choice.mass_units)
    stories = mass.index.get_level_values("story")
    mass = mass[stories.isin(heights.texts("story")) & (stories.str.lower() != BASE)]
    mass_here = mass[_chosen(mass.index, heights, weights, choice.tower)]
    moves = _moves(centres, axis, wanted, names)
    loads = (moves.reindex(mass.index).fillna(0.0).T @ mass).to_numpy()
    moves_here = moves.reindex(mass_here.index)
    for frame in (mass_here, moves_here):
        frame.index = frame.index.get_level_values("story")
    levels = _levels(_of_tower(heights, choice.tower), centres, tables.get(spelled(BASES)), choice)
    levels = levels[levels.index.isin(mass_here.index) | (choice.tower is None)]
    if bare := [story for story in levels.index if not mass_here.get(story)]:
        raise weights.error(f"has no mass of story {listed(bare)}")
    mass_here = mass_here[levels.index]
    shapes = _shapes(centres, moves_here, levels.index)
    parts = shapes @ mass_here.to_numpy()
    if choice.points:
        joints = _named(others[3], choice.points)
        shapes = _shapes(joints, _moves(joints, axis, wanted, ["story"]), levels.index)
    return Floors(
        levels.index, levels.to_numpy(), mass_here.to_numpy(), shapes, loads, parts, mass.sum()
    )


def _named(table: Table, points: Sequence[str]) -> Table:
    """The lines of the named joints."""
    titles = [name for name in ("label", "uniquename") if name in table.names]
    names = pd.DataFrame({title: table.texts(title) for title in titles})
    joints = pd.unique(names.to_numpy().ravel())
    if strange := [point for point in points if point not in joints]:
        raise table.error(f"has no joint {listed(strange)}; allowed as points: {listed(joints)}")
    return table._replace(rows=table.rows[names.isin([*points]).any(axis=1)])


def _turning(table: Table, wanted: ModalCase) -> list[int]:
    """Modes in which floors turn, as far as the table says it."""
    if "rz" not in table.names:
        return []
    angles = _moves(table, "rz", wanted, [name for name in MERGED_COLUMNS if name in table.names])
    return sorted(int(mode) for mode in angles.columns[(angles.abs() > LEAST_ROTATION).any()])


def _levels(heights: Table, centres: Table, bases: Table | None, choice: AskedModes) -> pd.Series:
    """Levels of the stories above the ground [m], from the ground up, by name."""
    names = heights.texts("story")
    unit = choice.length_units
    twice = pd.DataFrame({"story": names, "height": heights.texts("height")}).duplicated()
    heights = heights._replace(rows=heights.rows[(names.str.lower() != BASE) & ~twice])
    height = keyed(heights, ["story"], "height", "length", POSITIVE, unit)
    elevations = None
    for table, title in ((centres, "z"), (heights, "elevation")):
        if title in table.names:
            first = table._replace(rows=table.rows[~table.texts("story").duplicated()])
            level = keyed(first, ["story"], title, "length", ANY_NUMBER, unit).reindex(height.index)
            elevations = elevations if level.isna().any() else level.sort_values(kind="stable")
    numbers = names.str.extract(r"(\d+)$")[0].dropna().astype(int)
    if elevations is not None:
        height = height[elevations.index]
    elif names.iloc[0].lower() != BASE and not (len(numbers) > 1 and numbers.diff()[1:].min() > 0):
        height = height[::-1]  # from the roof down, as programs have them
    if elevations is not None and bases is None:
        return elevations - max(0.0, elevations.iloc[0] - height.iloc[0])
    return height.cumsum() - (0.0 if bases is None else _depth(bases, choice))


def _depth(bases: Table, choice: AskedModes) -> float:
    """Depth of the base below 0, where the ground is [m]; a base above 0 stands on the ground."""
    table = _of_tower(bases, choice.tower)
    towers = keyed(table, ["tower"], "bselev", "length", ANY_NUMBER, choice.length_units)
    return max(0.0, -towers.max()) if len(towers) else 0.0


def _check_one_building(floors: Floors, table: Table) -> None:
    """Raise a ValueError if some floors move in modes of their own, as another building."""
    moving = np.abs(floors.shapes.T) >= LEAST_MOVE * np.abs(floors.shapes).max(axis=1)
    moving[~moving.any(axis=1)] = True
    count, part = csgraph.connected_components(moving.astype(int) @ moving.T.astype(int))
    if count > 1:
        parts = (listed(floors.names[part == n], 4) for n in range(2))
        what = f"has {' and '.join(parts)}, which move in different modes, as two buildings"
        raise table.error(f"{what}; name those of the building at the gap, points= or tower=")
