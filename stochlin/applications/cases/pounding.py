"""Pounding of the buildings of a case, in each of its records or in many motions together."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.cases.reading.case import Case
from stochlin.applications.cases.rows import error_of, motion_of, named_errors
from stochlin.applications.cases.shaking import recorded_shaking, shaking_of
from stochlin.applications.pounding.pounding import pound
from stochlin.applications.pounding.runs import STEPS_PER_CONTACT
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.models.arguments import checked
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.ground_motions import simulated_motions
from stochlin.solver.simulation.simulation import time_step
from stochlin.solver.tables import labels

# Variables of the input energy, and of its parts at the end of a record.
ENERGIES = {
    "input": ("input_energy",),
    "viscous": ("viscous_energy",),
    "hysteretic": ("hysteretic_energy",),
    "contacts": ("contact_lost_energy",),
    "remaining": ("kinetic_energy", "elastic_energy", "contact_stored_energy"),
}
Structures = list[Any]  # one or several, oscillators and buildings
OF_MOTIONS = ("ground", "envelope", "scatter")  # attributes of simulated motions that are kept


@checked
def pound_case(
    case: Case, progress: Progress | None = None, *, steps_per_contact: int = STEPS_PER_CONTACT
) -> dict[str, xr.Dataset]:
    """Response of the buildings of a case to each of its records, with all impacts.

    Parameters
    ----------
    case : Case
        A case as from `stochlin.read_case`, with records, a contact, gaps, and the mass of every
        building; a case of one building alone needs no gap and no contact.
    progress : callable, optional
        Called with the share of the work that is done.
    steps_per_contact : int
        As in `stochlin.pound`.

    Returns
    -------
    dict of xarray.Dataset
        For each record, the variables of `stochlin.pound`; over ``structure`` the name of the
        ``building``, and its ``yield_displacement`` [m] and ``peak_ductility`` [-], NaN if elastic, or
        for buildings with storeys ``storeys`` and over ``floor`` the ``floor_level`` [m]; over
        ``contact`` the ``least_clearance`` [m] at the output times; over ``sink`` the ``energy_share``
        [-], the parts of the input energy at the end.

    Raises
    ------
    ValueError, TypeError
        If the case lacks data, or as in `stochlin.pound`. The message names the file and the cure.
    ArithmeticError
        As in `stochlin.pound`.

    Notes
    -----
    A strength by reduction factor or by ductility refers to the response to the ground of the case, not
    to the record.
    """
    _check(case)
    structures, count, tables = _in_metres(case), len(case.site.records), {}
    for n, (name, record) in enumerate(case.site.records.items()):
        options = {
            "steps_per_contact": steps_per_contact,
            "progress": part_of(progress, n / count, (n + 1) / count),
        }
        strength = xr.Dataset(recorded_shaking(record, case.periods))
        table = _described(_pounded(case, structures, record, strength, options, f", record {name}"))
        tables[name] = table.assign_attrs(title=f"{_title(case)} {name}", record=name)
    return tables


@checked
def pound_motions(
    case: Case,
    motions: int | None = None,
    progress: Progress | None = None,
    *,
    steps_per_contact: int = STEPS_PER_CONTACT,
) -> xr.Dataset:
    """Response of the buildings of a case to many motions, with means and quantiles.

    Parameters
    ----------
    case : Case
        As in `pound_case`.
    motions : int, optional
        Number of simulated motions of the site, by default the records of the case. They are the first
        of those that ``stochlin gap`` simulates, with its seed and its time step, which is the attribute
        ``step_s``; uncertain parameters are at their medians.
    progress : callable, optional
        Called with the share of the motions that is done.
    steps_per_contact : int
        As in `stochlin.pound`.

    Returns
    -------
    xarray.Dataset
        The variables of `stochlin.pound` for several motions, over ``path`` or ``record``; over
        ``structure`` also the name of the ``building`` and its data as in `pound_case`.

    Raises
    ------
    ValueError, TypeError, ArithmeticError
        As in `pound_case`.
    """
    _check(case, simulated=motions is not None)
    options = {"steps_per_contact": steps_per_contact, "progress": progress}
    structures, records = _in_metres(case), case.site.records
    if motions is None:
        each = [xr.Dataset(recorded_shaking(record, case.periods)) for record in records.values()]
        strengths = xr.concat(each, "record", combine_attrs="drop")
        table = _pounded(case, structures, dict(records), strengths, options)
        table.attrs["title"] = f"{_title(case)} {len(records)} records"
        return labels.label(table)
    motion = {name: value for name, value in motion_of(case).items() if name != "confidence"}
    step = time_step([building.structure for building in case.buildings], case.site.ground)
    simulated = simulated_motions(case.site.ground, **motion | {"paths": motions, "step": step})
    table = _pounded(case, structures, simulated, shaking_of(case), options)
    table.attrs |= {name: simulated.attrs[name] for name in OF_MOTIONS if name in simulated.attrs}
    table.attrs |= {"duration_s": case.site.course.duration, "seed": case.simulated.seed, "step_s": step}
    table.attrs["title"] = f"{_title(case)} {motions} simulated motions"
    return labels.label(table)


def _pounded(
    case: Case,
    structures: Structures,
    motions: Any,
    strength: xr.Dataset,
    options: Mapping[str, Any],
    where: str = "",
) -> xr.Dataset:
    """The response, strength of the motions and names of the buildings; errors name the file."""
    with named_errors(case, where):
        table = pound(structures, list(case.wanted.existing), case.contact, motions, **options)
    return _named(table.assign(strength.data_vars), case, structures).assign_attrs(case=case.title)


def by_motion(table: xr.Dataset) -> xr.Dataset:
    """A table with a row for each motion, and a column for each floor, contact and so on."""
    over = str(table.status.dims[0])
    sheet = xr.Dataset(coords={name: table[name] for name in (over, "missing") if name in table.coords})
    for name, values in table.data_vars.items():
        others = [dim for dim in values.dims if dim != over]
        if over not in values.dims or "quantile" in others:
            continue
        for place in np.ndindex(*(values.sizes[dim] for dim in others)):
            at = dict(zip(others, place, strict=True))
            column = values.isel(at).reset_coords(drop=True)
            labels_there = [str(table[dim].values[n]).replace(" | ", "-") for dim, n in at.items()]
            if bool(column.notnull().any()) or "floor" not in others:
                sheet["_".join([str(name), *labels_there])] = (over, column.values, column.attrs)
    return sheet


def _title(case: Case) -> str:
    return f"{case.title}: {'alone' if case.alone else 'pounding'} in"


def _in_metres(case: Case) -> Structures:
    """The structures of the buildings, with strengths in metres."""
    return [
        item.structure if item.has_storeys else strength_in_metres(item.structure, case.site.ground)
        for item in case.buildings
    ]


def _check(case: Case, simulated: bool = False) -> None:
    """Raise a ValueError if the case lacks motions, gaps or a contact."""
    if not (case.site.records or simulated):
        cure = "[[site.records]], and below it path, units and dt; or --motions 100 for simulated ones"
        raise error_of(case, f"pounding needs a recorded motion; write {cure}")
    if not (case.alone or case.wanted.existing):
        cure = 'existing = "5 cm" in [separation], a list for more than two, "0 cm" if they touch'
        raise error_of(case, f"pounding needs the existing gap; write {cure}")
    if not (case.alone or case.contact):
        cure = '[contact], and below it model = "kelvin", stiffness = "2000 MN/m" and restitution = 0.65'
        raise error_of(case, f"pounding needs the contact between the buildings; write {cure}")


def _described(table: xr.Dataset) -> xr.Dataset:
    """The dataset with the shares of the energies, and the least clearance of each contact."""
    if "contact" in table.dims:
        left, right = (displacement_beside(table, side) for side in ("left", "right"))
        table["least_clearance"] = table.gap - (left - right).max("time")
    return labels.label(_with_energies(table))


def _named(table: xr.Dataset, case: Case, structures: Structures) -> xr.Dataset:
    """The dataset with the names of the buildings, and their floors or yield displacements."""
    names, each = [building.name for building in case.buildings], case.buildings
    table = table.assign_coords(building=("structure", names, {"long_name": "name of the building"}))
    if "floor" not in table.dims:
        strengths = [item.yield_displacement if item.yields else np.nan for item in structures]
        table["yield_displacement"] = ("structure", np.array(strengths, float))
        table["peak_ductility"] = table.peak / table.yield_displacement
        return table
    storeys = [item.storeys if item.has_storeys else 1 for item in each]
    levels = np.full((table.sizes["structure"], table.sizes["floor"]), np.nan)
    for row, building in zip(levels, each, strict=True):
        if building.has_storeys:
            row[: building.storeys] = building.structure.levels()
    about = {"units": "m", "long_name": "height of the floor, not known of an oscillator"}
    return table.assign_coords(
        storeys=("structure", storeys, {"long_name": "number of storeys"}),
        floor_level=(("structure", "floor"), levels, about),
    )


def displacement_beside(table: xr.Dataset, side: str) -> xr.DataArray:
    """Displacement of the slab or column on a side of each contact [m], over time and contact."""
    at = {"structure": table[side].drop_vars(table[side].coords)}
    if "floor" in table.dims:
        at["floor"] = table[f"floor_{side}"].drop_vars(table[f"floor_{side}"].coords)
    beside = table.displacement.sel(at)
    if "column" in table.coords:  # a column moves between its floors, or the ground and the first one
        share = table.share.where(table.column == side, 1.0)
        below = table.displacement.shift(floor=1, fill_value=0.0).sel(at)
        beside = share * beside + (1.0 - share) * below
    of_floors = ["structure", "floor", "building", "storeys", "floor_level"]
    return beside.drop_vars(of_floors, errors="ignore")


def _with_energies(table: xr.Dataset) -> xr.Dataset:
    """The dataset with the parts of the input energy at the end of the record, as shares."""
    last = table.isel(time=-1)
    input_energy, *kept = (float(energy_of(last, where)) for where in ENERGIES)
    shares = np.array(kept) / (input_energy if input_energy > 0 else np.nan)
    sinks = list(ENERGIES)[1:]
    table = table.assign_coords(sink=("sink", sinks, {"long_name": "where the energy is"}))
    return table.assign(energy_share=("sink", shares))


def energy_of(table: xr.Dataset, where: str) -> xr.DataArray:
    """Energy of one kind in `ENERGIES`, of all buildings together [J]."""
    parts = [table[name] for name in ENERGIES[where]]
    totals = [part.sum("structure") if "structure" in part.dims else part for part in parts]
    return sum(totals[1:], totals[0])


def hardest_contacts(table: xr.Dataset) -> list[int]:
    """Number of the contact of each gap with the largest force, else velocity, else least clearance."""
    chosen = []
    for left in np.unique(table.left.values):
        there = np.flatnonzero(table.left.values == left)
        force, speed = (table[name].values[there] for name in ("hardest_force", "fastest_approach"))
        most = force if np.isfinite(force).all() else speed
        best = np.argmax(most) if most.any() else np.argmin(table.least_clearance.values[there])
        chosen.append(int(there[best]))
    return chosen


def hardness(table: xr.Dataset) -> str:
    """Variable by which impacts are compared: force, or approach velocity if velocities jump."""
    return "largest_force" if bool(table.largest_force.notnull().all()) else "approach_velocity"
