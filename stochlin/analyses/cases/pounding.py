"""Pounding of the buildings of a case file, in each of its records."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from stochlin.analyses.cases.buildings import Building
from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.sites.shaking import LEVELS, recorded_shaking
from stochlin.analyses.cases.storeys import StoreyBuilding
from stochlin.analyses.cases.variables import VARIABLES
from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.pounding.pounding import pound
from stochlin.analyses.simulation.finite_motions import keeping_apart
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.parallel import Progress
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact
from stochlin.models.structures import Structure

# The input, and where it goes.
ENERGIES = {
    "input": ("input_energy",),
    "viscous": ("viscous_energy",),
    "hysteretic": ("hysteretic_energy",),
    "contacts": ("contact_lost_energy",),
    "remaining": ("kinetic_energy", "elastic_energy", "contact_stored_energy"),
}


def pound_case(case: Case, progress: Progress | None = None) -> dict[str, xr.Dataset]:
    """The buildings of a case through each of its records, with all their impacts.

    Parameters
    ----------
    case : Case
        As `stochlin.read_case` gives it, with records, a contact, gaps, and the mass of every building.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    dict of xarray.Dataset
        By record: what `stochlin.pound` returns; over ``structure`` the name of the ``building``, its
        ``storeys`` or ``yield_displacement`` [m] and ``peak_ductility`` [-], NaN where elastic; over
        ``contact`` its ``gap`` [m], ``impacts``, ``hardest_force`` [N], ``fastest_approach`` [m/s],
        ``longest_impact`` [s], ``contact_energy`` [J] that it has taken and ``least_clearance`` [m] at
        the instants of ``time``; over ``structure`` the ``energy_received`` [J] from all impacts, and
        over ``floor``, too, its ``floor_level`` [m]; over ``sink`` the ``energy_share`` [-] of the
        input, at the end.

    Raises
    ------
    ValueError, TypeError
        If the case lacks something, or as in `stochlin.pound`. The message names the file, and the cure.
    ArithmeticError
        As in `stochlin.pound`.

    Notes
    -----
    A reduction factor, or the strength that a ductility asks for, refers to the elastic response to the
    ground of the case, whatever the record.
    """
    contact = _checked(case)
    structures: list[Structure | ShearBuilding] = [
        strength_in_metres(building.structure, case.ground)
        if isinstance(building, Building)
        else building.structure
        for building in case.buildings
    ]
    tables: dict[str, xr.Dataset] = {}

    def of_all(share: float) -> None:
        if progress is not None:
            progress((len(tables) + share) / len(case.records))

    for name, record in case.records.items():
        try:
            table = pound(structures, list(case.gaps), contact, record, progress=of_all)
        except (ValueError, TypeError, ArithmeticError) as error:
            raise type(error)(f"{case.file}, record {name}: {error}") from error
        periods = [building.period for building in case.buildings]
        table = table.assign(recorded_shaking(record, periods))
        tables[name] = _described(table, case, structures).assign_attrs(
            title=f"{case.title}: pounding in {name}", record=name, case=case.title
        )
    return tables


def over_records(tables: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """What many records come to: in how many they meet, and quantiles of what that does."""
    each = list(tables.values())
    hits = np.array([float(table.impacts.sum()) for table in each])
    forces, speeds = (
        [float(np.nan_to_num(table[name].max())) for table in each]
        for name in ("hardest_force", "fastest_approach")
    )
    times = [table.amplification.max({*table.amplification.dims} - {"structure"}) for table in each]
    apart = keeping_apart(xr.DataArray(hits, dims="path"), 0.5)
    found = xr.Dataset({f"record_{name}": share for name, share in apart.items()})
    found = found.assign_coords(quantile=labels.axis("quantile", "quantile", np.array(LEVELS)))
    for name, values in (("impacts", hits), ("largest_force", forces), ("fastest_approach", speeds)):
        found[f"record_{name}"] = "quantile", np.quantile(np.array(values), LEVELS)
    found["record_amplification"] = (
        ("quantile", "structure"),
        np.quantile(np.array(times), LEVELS, axis=0),
    )
    return labels.label(found, VARIABLES)


def _checked(case: Case) -> Contact:
    """The contact, once nothing else is missing either."""
    needs = f"{case.file}: pounding needs"
    if not case.records:
        raise ValueError(
            f"{needs} a recorded motion; write [[site.records]], and below it its path, units and dt"
        )
    if not case.gaps:
        raise ValueError(
            f'{needs} the gap there is; write existing = "5 cm" in [separation], "0 cm" for buildings '
            "that touch, and a list for more than two"
        )
    for number, building in enumerate(case.buildings, start=1):
        if not building.weighed:
            raise ValueError(
                f'{needs} the mass of every building; write mass = "1500 t" in [building_{number}]'
            )
    if case.contact is None:
        raise ValueError(
            f'{needs} what the buildings meet at; write [contact], and below it model = "kelvin", '
            'stiffness = "2000 MN/m" and restitution = 0.65'
        )
    return case.contact


def _described(table: xr.Dataset, case: Case, structures: list[Structure | ShearBuilding]) -> xr.Dataset:
    """The dataset with the names of the case, and with what its impacts and energies add up to."""
    names = [building.name for building in case.buildings]
    strengths = [
        structure.yield_displacement if isinstance(structure, Structure) and structure.yields else np.nan
        for structure in structures
    ]
    table = table.assign_coords(building=("structure", names, {"long_name": "name of the building"}))
    if "floor" in table.dims:
        storeys = [b.storeys if isinstance(b, StoreyBuilding) else 1 for b in case.buildings]
        table = table.assign_coords(storeys=("structure", storeys, {"long_name": "number of storeys"}))
        levels = np.full(table.peak.shape, np.nan)
        for row, structure in zip(levels, structures, strict=True):
            if isinstance(structure, ShearBuilding):
                row[: structure.storeys] = structure.levels()
        about = {"units": "m", "long_name": "height of the floor, not known of an oscillator"}
        table = table.assign_coords(floor_level=(("structure", "floor"), levels, about))
    else:
        table["yield_displacement"] = ("structure", np.array(strengths, float))
        table["peak_ductility"] = table.peak / table.yield_displacement
        if "largest_radius_amplification" not in table:  # it is estimated for bilinear buildings
            table["largest_radius_amplification"] = np.nan * table.amplification
    return labels.label(_with_energies(_with_tallies(table)), VARIABLES)


def _with_tallies(table: xr.Dataset) -> xr.Dataset:
    """What the impacts of each contact come to."""
    hit = table.impact_contact.values == table.contact.values[:, None]
    table["impacts"] = ("contact", hit.sum(axis=1))
    at_most = {
        "hardest_force": table.largest_force,
        "fastest_approach": table.approach_velocity,
        "longest_impact": table.impact_duration,
    }
    for name, values in at_most.items():  # NaN without an impact, or where one has no such value
        most = np.array([np.maximum.reduce(values.values[own], initial=-np.inf) for own in hit])
        table[name] = ("contact", np.where(np.isfinite(most), most, np.nan))
    table["contact_energy"] = ("contact", hit @ table.energy_lost.values)
    received = np.zeros(table.sizes["structure"])
    for side in table.side.values:
        structures = table[str(side)].values[table.impact_contact.values - 1] - 1
        np.add.at(received, structures, table.energy_transferred.sel(side=side).values)
    table["energy_received"] = ("structure", received)
    table["gap"] = ("contact", np.array(table.attrs["gaps"])[table.left.values - 1])
    left, right = (displacement_beside(table, side) for side in ("left", "right"))
    table["least_clearance"] = table.gap - (left - right).max("time")
    return table


def displacement_beside(table: xr.Dataset, side: str) -> xr.DataArray:
    """Displacement of a side of each contact, floor or column, over ``time`` and ``contact``."""
    at = {"structure": table[side].drop_vars(table[side].coords)}
    if "floor" in table.dims:
        at["floor"] = table[f"floor_{side}"].drop_vars(table[f"floor_{side}"].coords)
    beside = table.displacement.sel(at)
    if "column" in table.coords:  # between its floors, or the ground and the first
        share = table.share.where(table.column == side, 1.0)
        below = table.displacement.shift(floor=1, fill_value=0.0).sel(at)
        beside = share * beside + (1.0 - share) * below
    of_floors = ["structure", "floor", "building", "storeys", "floor_level"]
    return beside.drop_vars(of_floors, errors="ignore")


def _with_energies(table: xr.Dataset) -> xr.Dataset:
    """Shares of what the ground has put in, at the end of the record."""
    last = table.isel(time=-1)
    given, *kept = (float(energy_of(last, where)) for where in ENERGIES)
    shares = np.array(kept) / (given if given > 0 else np.nan)
    sinks = list(ENERGIES)[1:]
    table = table.assign_coords(sink=("sink", sinks, {"long_name": "where the energy is"}))
    return table.assign(energy_share=("sink", shares))


def energy_of(table: xr.Dataset, where: str) -> xr.DataArray:
    """What of the energy is there, of all buildings together [J]."""
    parts = [table[name] for name in ENERGIES[where]]
    totals = [part.sum("structure") if "structure" in part.dims else part for part in parts]
    return sum(totals[1:], totals[0])


def is_oscillator(one: xr.Dataset) -> bool:
    """Whether a structure in a row with storeys has none: its floor has no height."""
    return bool(one.floor_level.isnull().all())


def hardest_contacts(table: xr.Dataset) -> list[int]:
    """Of each gap the contact that is hit hardest, else fastest, or that comes nearest."""
    chosen = []
    for left in np.unique(table.left.values):
        there = np.flatnonzero(table.left.values == left)
        force, speed = (table[name].values[there] for name in ("hardest_force", "fastest_approach"))
        most = force if np.isfinite(force).any() else speed
        clearance = table.least_clearance.values[there]
        best = np.nanargmax(most) if np.isfinite(most).any() else np.argmin(clearance)
        chosen.append(int(there[best]))
    return chosen


def hardest_record(tables: Mapping[str, xr.Dataset]) -> str:
    """The record with the hardest impact, by force or else by approach; the first if none has one."""

    def most(name: str) -> tuple[float, float]:
        one = tables[name]
        return tuple(float(np.nan_to_num(one[n].max())) for n in ("hardest_force", "fastest_approach"))  # type: ignore[return-value]

    return max(tables, key=most)


def hardness(table: xr.Dataset) -> str:
    """What impacts are compared by: their force, or, where velocities jump, their approach."""
    return "largest_force" if bool(table.largest_force.notnull().all()) else "approach_velocity"
