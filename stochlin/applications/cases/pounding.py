"""Pounding of the buildings of a case in its record, or in many motions together."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import check_masses, motion_of
from stochlin.applications.cases.shaking import recorded_shaking, shaking_of
from stochlin.applications.pounding.pounding import (
    FEWEST_STEPS_PER_CONTACT,
    MOST_STEPS_PER_CONTACT,
    pound,
)
from stochlin.applications.pounding.rows import CONTACT_SIDES
from stochlin.applications.pounding.runs import STEPS_PER_CONTACT
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.arguments import Whole, checked
from stochlin.models.systems import assembly_of
from stochlin.models.walls import IN_SPACE
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.ground_motions import simulated_motions
from stochlin.solver.simulation.simulation import time_step
from stochlin.solver.tables import labels

# Variables of the input energy, and of its parts at the end of a record.
ENERGIES = {
    "input": ("input_energy", "wall_energy"),
    "viscous": ("viscous_energy",),
    "hysteretic": ("hysteretic_energy",),
    "contacts": ("contact_lost_energy",),
    "remaining": ("kinetic_energy", "elastic_energy", "contact_stored_energy"),
}
# attributes of simulated motions that the result has, too
ATTRIBUTES_OF_MOTIONS = "ground", "envelope", "scatter"


@checked
def pound_case(
    case: Case,
    motions: Annotated[int, Whole(1)] | None = None,
    progress: Progress | None = None,
    *,
    steps_per_contact: Annotated[
        int, Whole(FEWEST_STEPS_PER_CONTACT, MOST_STEPS_PER_CONTACT)
    ] = STEPS_PER_CONTACT,
) -> xr.Dataset:
    """Response of the buildings of a case to its record, with all impacts, or to many motions.

    Parameters
    ----------
    case : Case
        A case as from `stochlin.read_case`, with a contact, gaps, and the mass of every building; a
        case of one building alone needs no gap and no contact.
    motions : int, optional
        Number of simulated motions of the site, by default the records of the case. They are the
        first of those that ``stochlin gap`` simulates, with its seed and its time step, which is
        the attribute ``step_s``; uncertain parameters are at their medians.
    progress : callable, optional
        Called with the share of the work that is done.
    steps_per_contact : int
        As in `stochlin.pound`.

    Returns
    -------
    xarray.Dataset
        The variables of `stochlin.pound`, for a case with one record those of one motion, and else
        those of several, over ``record`` or ``path``; over ``structure`` the name of the
        ``building``, and its ``yield_displacement`` [m] and ``peak_ductility`` [-], NaN if elastic,
        or for buildings with storeys ``storeys`` and over ``floor`` the ``floor_level`` [m]. For
        one record also, over ``contact``, the ``least_clearance`` [m] at the output times.

    Raises
    ------
    ValueError, TypeError
        If ``case`` is no case, a number is out of range, the case lacks data, or for an error of
        `stochlin.pound`. The message names the file.

    Notes
    -----
    A strength by reduction factor or by ductility refers to the response to the ground of the case,
    not to the record.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (13) to (16); Newmark (1959), for the time steps.

    Examples
    --------
    >>> import pathlib, tempfile, stochlin as sl
    >>> lines = '''
    ...     site = {ground = "firm", pga = "0.4 g"}
    ...     motion = {duration = "10 s"}
    ...     building_1 = {period = "1 s", damping = 0.05, mass = "500 t", elastic = true}
    ...     building_2 = {period = "0.6 s", damping = 0.05, mass = "300 t", elastic = true}
    ...     separation = {existing = ["1 cm"], confidence = 0.9}
    ...     contact = {model = "kelvin", stiffness = "5000 MN/m", restitution = 0.65}
    ... '''
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "case.toml"
    >>> _ = path.write_text(lines, encoding="utf-8")
    >>> table = sl.pound_case(sl.read_case(path), motions=4)
    >>> bool((table.impacts > 0).all())
    True
    """
    if not isinstance(case, Case):
        raise TypeError(f"case = {brief(case)}; allowed: the result of read_case")
    _check(case, simulated=motions is not None)
    records = case.site.records
    about = dict[str, Any]()
    structures = [
        strength_in_metres(building.structure, case.site.ground) for building in case.buildings
    ]
    strengths = [xr.Dataset(recorded_shaking(record, case.periods)) for record in records.values()]
    shaken: Any
    if motions is not None:
        shaken = _simulated(case, motions)
        what = f"{motions} simulated motions"
        about = {name: shaken.attrs[name] for name in ATTRIBUTES_OF_MOTIONS if name in shaken.attrs}
        about |= {"duration_s": case.site.course.duration, "seed": case.simulated.seed}
        about["step_s"] = shaken.attrs["dt"]
        strength = shaking_of(case)
    elif len(records) == 1:
        [(what, shaken)] = records.items()
        [strength] = strengths
    else:
        shaken = dict(records)
        what = f"{len(records)} records"
        strength = xr.concat(strengths, "record", combine_attrs="drop")
    row, gaps = _row(case, structures)
    steps = steps_per_contact
    with case.whole.table.naming("", ""), case.whole.table.asking("contact"):
        table = pound(row, gaps, case.contact, shaken, steps_per_contact=steps, progress=progress)
    table = _named(table.assign(strength.data_vars), case, structures)
    if {"contact", "time"} <= set(table.dims):
        left, right = (displacement_beside(table, side) for side in CONTACT_SIDES)
        table["least_clearance"] = table.gap - (left - right).max("time")
    title = f"{case.title}: {'pounding' if gaps else 'alone'} in {what}"
    return labels.label(table).assign_attrs(about | {"case": case.title, "title": title})


def _simulated(case: Case, motions: int) -> xr.DataArray:
    """Simulated motions of the site of a case."""
    motion = {name: value for name, value in motion_of(case).items() if name != "confidence"}
    step = time_step([building.structure for building in case.buildings], case.site.ground)
    return simulated_motions(case.site.ground, **motion | {"paths": motions, "step": step})


def _row(case: Case, structures: Sequence[Any]) -> tuple[list[Any], list[float]]:
    """The buildings with the walls beside them, and the gaps between all of these."""
    left = [wall for wall in case.walls[:1] if wall]
    right = [wall for wall in case.walls[1:] if wall]
    existing = [] if case.alone else case.wanted.existing
    row = [*(wall.wall() for wall in left), *structures, *(wall.wall() for wall in right)]
    return row, [*(wall.gap for wall in left), *existing, *(wall.gap for wall in right)]


def _check(case: Case, simulated: bool = False) -> None:
    """Raise a ValueError if the case lacks motions, gaps or a contact."""
    alone = case.alone
    free = alone and not any(case.walls)
    records = case.site.records or simulated
    sides = "between the buildings" if not alone else "between building and wall"
    needed = {
        "a record; write [[site.records]], or --motions 100 for simulated ones": records,
        'the existing gap; write existing = "5 cm" in [separation]': alone or case.wanted.existing,
        f"the contact {sides}; write [contact] with its model": free or case.contact,
    }
    for what, present in needed.items():
        if not present:
            raise case.whole.table.error("", f"pounding needs {what}")
    if not free:
        check_masses(case, "a contact")


def _named(table: xr.Dataset, case: Case, structures: list[Any]) -> xr.Dataset:
    """The dataset with the names of the buildings, and their floors or yield displacements."""
    names = [building.name for building in case.buildings]
    table = table.assign_coords(
        building=("structure", names, {"long_name": "name of the building"})
    )
    if "floor" not in table.dims:
        strengths = [item.yield_displacement if item.yields else np.nan for item in structures]
        table["yield_displacement"] = ("structure", np.array(strengths, float))
        table["peak_ductility"] = table.peak / table.yield_displacement
        return table
    storeys = [building.floors for building in case.buildings]
    levels = np.full((table.sizes["structure"], table.sizes["floor"]), np.nan)
    for row, stick in zip(levels, assembly_of(structures).sticks, strict=True):
        row[: stick.levels.size] = stick.levels
    about = {"units": "m", "long_name": "height of the floor, not known of an oscillator"}
    return table.assign_coords(
        storeys=("structure", storeys, {"long_name": "number of storeys"}),
        floor_level=(("structure", "floor"), levels, about),
    )


def displacement_beside(table: xr.Dataset, side: str) -> xr.DataArray:
    """Displacement of the slab or column on a side of each contact [m], over time and contact."""
    building = table[side].drop_vars(table[side].coords)  # 0 for a wall
    at = {"structure": building.clip(min=1)}
    if "floor" in table.dims:
        at["floor"] = table[f"floor_{side}"].drop_vars(table[f"floor_{side}"].coords).clip(min=1)
    beside = table.displacement.sel(at)
    # A column moves between its floors, or between the ground and the first floor.
    if "column" in table.coords:
        share = table.share.where(table.column == side, 1.0)
        below = table.displacement.shift(floor=1, fill_value=0.0).sel(at)
        beside = share * beside + (1.0 - share) * below
    if "wall" in table.coords:
        moved = table.wall_displacement if "wall_displacement" in table else 0.0
        beside = beside.where(
            building > 0, moved * (table.wall.drop_vars(table.wall.coords) == IN_SPACE)
        )
    of_floors = ["structure", "floor", "building", "storeys", "floor_level"]
    return beside.drop_vars(of_floors, errors="ignore")


def energy_of(table: xr.Dataset, where: str) -> xr.DataArray:
    """Energy of one kind in `ENERGIES`, of all buildings together [J]."""
    parts = [table[name] for name in ENERGIES[where] if name in table]
    totals = [part.sum("structure") if "structure" in part.dims else part for part in parts]
    return sum(totals[1:], totals[0])


def closest_contacts(table: xr.Dataset) -> list[int]:
    """Number of the contact of each gap with the least clearance, negative where it is hit."""
    clearance = table.least_clearance.values
    return [
        int(np.flatnonzero(table.left == left)[clearance[table.left == left].argmin()])
        for left in np.unique(table.left)
    ]
