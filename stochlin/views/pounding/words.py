"""The results of pounding in plain words and short numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy import constants

from stochlin.analyses.cases.pounding import energy_of, is_oscillator
from stochlin.analyses.cases.shaking import doubts
from stochlin.analyses.pounding.rows import COLUMN as SLAB_TO_COLUMN
from stochlin.views.shared.blocks import Block, Table, Text, ViewSection, texts
from stochlin.views.shared.descriptions import site_in_words
from stochlin.views.shared.screen import cut
from stochlin.views.shared.uncertain import at_medians
from stochlin.views.shared.words import (
    MISSING,
    SPACE,
    along,
    centimetres,
    floors,
    left_out,
    length,
    number,
    opening,
    per_cent,
    recorded_shaking,
    short,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.reading.case import Case

LONGEST_NAME, SHORTER_NAME = 26, 20
LARGE_ERROR = 0.01  # by time steps, above which a caution is given
BASE = "Base: largest base shear."
SINKS = {"viscous": "damping dissipated", "hysteretic": "yielding", "contacts": "contacts"}
ALONE = "one building alone, without a neighbour."
SHEAR = "Shear: of the storey below the floor."
TIMES = "Times: largest displacement with pounding, relative to that without."
ESTIMATE = (
    "Estimate: growth factor of the energy radius (PER) in the worst single impact, at full energy "
    "and without yielding."
)
DUCTILITY = "Ductility: largest displacement relative to that at yield."
ROOF = "Peaks are those of the roof. Worst: the floor whose displacement grows most by pounding."
FLOOR = (
    "Floor: the floor with the largest acceleration; alone: its acceleration without pounding. Storey "
    "shear: the largest growth factor of a storey's shear by pounding."
)
JUMPS = (
    "Velocities jump in impacts with this contact: accelerations and shears are those between impacts."
)
HITS = "Hits give: work of all impacts on the building, negative if they take energy from it."
COLUMN = "Contacts with a star: a slab meets a column between two floors."
CLOSEST = "Closest: smallest distance in the motion, negative if the contact is compressed."
STRENGTH = (
    "Strengths given by reduction factor or ductility refer to the ground of the file, {}, not to the "
    "records."
)


def answer_sections(case: Case, tables: Mapping[str, xr.Dataset]) -> list[ViewSection]:
    """All that is shown, record by record, and the meaning of the columns."""
    doubts_of = {record: _doubts(table, case) for record, table in tables.items()}
    doubtful = [f"in {record} {doubt}" for record, several in doubts_of.items() for doubt in several]
    return [
        opening(case, doubtful),
        ViewSection("", texts([floors(case), *left_out(case), at_medians(case)])),
        *(ViewSection("", _in_record(case, record, table)) for record, table in tables.items()),
        ViewSection("", texts([_notes(case, next(iter(tables.values())))])),
    ]


def _in_record(case: Case, record: str, table: xr.Dataset) -> list[Block]:
    columns: list[Block] = []
    if "column" in table.coords:
        columns = [Text(columns_met(table)), _struck(table)]
    responses = (_buildings, _borne, _contacts) if "contact" in table.dims else (_alone,)
    return [
        *texts([f"{record}: {headline(table)}", recorded_shaking(table, case)]),
        *columns,
        *(response(table) for response in responses),
        *texts([energies(table), step_error(table)]),
    ]


def _doubts(table: xr.Dataset, case: Case) -> list[str]:
    peaks = table.peak.max("floor") if "floor" in table.dims else table.peak
    return doubts(table, case.buildings, peaks=tuple(map(float, peaks)))


def headline(table: xr.Dataset) -> str:
    """The result of one record in a sentence."""
    if "contact" not in table.dims:
        return ALONE
    count = int(table.impacts.sum())
    if not count:
        nearest = int(table.least_clearance.argmin("contact"))
        left, gap = (float(table[name][nearest]) for name in ("least_clearance", "gap"))
        return f"no pounding. At least {length(left)} of the gap of {length(gap)} remain open."
    begin = float(table.impact_time.min())
    sentence = f"{count} impact{'s' * (count > 1)}, the first at {begin:.2f} s."
    force, speed = float(table.largest_force.max(skipna=False)), float(table.fastest_approach.max())
    if np.isfinite(force):
        return f"{sentence} Largest force {number(force, 'MN')} MN, fastest approach {short(speed)} m/s."
    return f"{sentence} Fastest approach {short(speed)} m/s; this contact gives no forces."


def columns_met(table: xr.Dataset) -> str:
    """A clear warning where slabs hit columns."""
    met = int(table.column_force.notnull().sum())
    hit = int((table.column_force > 0).sum())
    begin = "SLABS FACE COLUMNS: the floors are not level"
    if not hit:
        return f"{begin} at {met} contact{'s' * (met > 1)}; in this record no column is hit."
    contact = table.isel(contact=int(table.column_force.argmax("contact")))
    struck = int(contact[str(contact.column.item())])
    force = f"{number(float(contact.column_force), 'MN')} MN"
    if np.isfinite(float(contact.column_force_share)):
        force += f", {per_cent(float(contact.column_force_share))} of the storey's shear at yield"
    return (
        f"SLABS HIT COLUMNS at {hit} contact{'s' * (hit > 1)}, since the floors are not level. "
        f"Hardest, {float(contact.level):.4g} m up: the columns of storey {int(contact.storey)} of "
        f"building {struck} take {force}. They carry the building above: check them in bending and "
        "shear, or widen the gap."
    )


def energies(table: xr.Dataset) -> str:
    """The energy balance, and its error."""
    energy = number(float(energy_of(table.isel(time=-1), "input")), "kJ")
    share = {str(name): float(table.energy_share.sel(sink=name)) for name in table.sink.values}
    meets = "contact" in table.dims
    sinks = {name: word for name, word in SINKS.items() if meets or name != "contacts"}
    parts = [f"{word} {per_cent(share[name], 1)}" for name, word in sinks.items()]
    return (
        f"Of the {energy} kJ from the ground, {', '.join(parts)}; {per_cent(share['remaining'], 1)} are "
        f"left at the end. The balance is off by {float(table.energy_balance_error.max()):.0e} at most."
    )


def step_error(table: xr.Dataset) -> str:
    """The error by time steps, with a caution and the cure if it is large."""
    error = float(table.step_error)
    sentence = f"Error by time steps: at most {100 * error:.1g}{SPACE}% of a peak or largest force."
    if error <= LARGE_ERROR:
        return sentence
    return f"{sentence} CAUTION: more than {per_cent(LARGE_ERROR)}; take more --steps-per-contact."


def _measured(row: xr.Dataset, columns: Mapping[str, tuple[str, str]]) -> list[str]:
    """Numbers of a row, by the head of their column the name of the variable and the unit."""
    return [number(float(row[name]), unit) for name, unit in columns.values()]


def _alone(table: xr.Dataset) -> Table:
    """The response of a single building, floor by floor from the roof down."""
    building = table.isel(structure=0)
    columns = {
        "peak [cm]": ("peak", "cm"),
        "accel. [g]": ("peak_acceleration", "g"),
        "shear [MN]": ("peak_storey_shear", "MN"),
    }
    if "floor" not in table.dims:
        columns["ductility"] = ("peak_ductility", "1")
        return Table.of([*columns], [_measured(building, columns)])
    floors_down = along(building, "floor")[::-1]
    rows = [
        [str(int(floor.floor)), f"{float(floor.floor_level):.4g}", *_measured(floor, columns)]
        for floor in floors_down
    ]
    return Table.of(["floor", "height [m]", *columns], rows)


def _buildings(table: xr.Dataset) -> Table:
    """The effect of pounding on each building."""
    rows = []
    for place, name in enumerate(table.building.values, start=1):
        building = table.isel(structure=place - 1)
        cells = _roof(building) if "floor" in table.dims else _whole(building)
        rows.append([f"{place}  {cut(str(name), LONGEST_NAME)}", *cells])
    more = ["worst"] if "floor" in table.dims else ["estimate", "ductility"]
    return Table.of(["building", "peak [cm]", "alone [cm]", "times", *more], rows)


def _whole(building: xr.Dataset) -> list[str]:
    """Peaks of an oscillator, their ratio, the estimate of it, and the ductility."""
    ratios = ("amplification", "largest_radius_amplification", "peak_ductility")
    values = (float(building[name]) for name in ratios)
    return [
        *(centimetres(float(building[name])) for name in ("peak", "peak_alone")),
        *(f"{value:.2f}" if np.isfinite(value) else MISSING for value in values),
    ]


def _borne(table: xr.Dataset) -> Table:
    """Accelerations, shears, and the work of impacts on each building."""
    storeys = "floor" in table.dims
    heads = ["building", "accel. [g]", "alone", *["floor"] * storeys, "base [MN]", "alone"]
    heads += [*["storey shear"] * storeys, "hits give [kJ]"]
    rows = []
    for place, name in enumerate(table.building.values):
        building = table.isel(structure=place)
        known = storeys and not is_oscillator(building)
        most = (
            building.isel(floor=int(building.peak_acceleration.argmax("floor"))) if storeys else building
        )
        row = [f"{place + 1}  {cut(str(name), SHORTER_NAME)}"]
        row += [f"{float(most[f'peak_acceleration{end}']) / constants.g:.2f}" for end in ("", "_alone")]
        row += [str(int(most.floor)) if known else MISSING] if storeys else []
        row += [number(float(building[f"peak_base_shear{end}"]), "MN") for end in ("", "_alone")]
        row += [_shear(building) if known else MISSING] if storeys else []
        work = float(building.energy_received) / 1e3
        rows.append([*row, f"{work:+.3g}" if work else "0"])
    return Table.of(heads, rows)


def _shear(building: xr.Dataset) -> str:
    """The storey whose shear grows most."""
    times = building.peak_storey_shear / building.peak_storey_shear_alone
    worst = times.isel(floor=int(times.argmax("floor")))
    return f"{float(worst):.2f}, storey {int(worst.floor)}"


def _struck(table: xr.Dataset) -> Table:
    """The columns that slabs have hit, storey by storey; no rows if none was."""
    hit = table.isel(contact=np.flatnonzero(table.column_force > 0))
    worst: dict[tuple[int, int], xr.Dataset] = {}
    for contact in along(hit, "contact"):
        place = int(contact[str(contact.column.item())]), int(contact.storey)
        if place not in worst or contact.column_force > worst[place].column_force:
            worst[place] = contact
    rows = [
        [
            f"{building}  {cut(str(table.building.values[building - 1]), LONGEST_NAME)}",
            str(storey),
            f"{float(contact.level):.4g}",
            number(float(contact.column_force), "MN"),
            per_cent(float(contact.column_force_share)),
        ]
        for (building, storey), contact in sorted(worst.items(), key=lambda item: item[0])
    ]
    heads = ["columns of", "storey", "hit at [m]", "force [MN]", "of the shear at yield"]
    return Table.of(heads, rows)


def _roof(table: xr.Dataset) -> list[str]:
    top = table.sel(floor=int(table.storeys))
    worst = table.isel(floor=int(table.amplification.argmax("floor")))
    return [
        centimetres(float(top.peak)),
        centimetres(float(top.peak_alone)),
        f"{float(top.amplification):.2f}",
        f"{float(worst.amplification):.2f}"
        + ("" if is_oscillator(table) else f", floor {int(worst.floor)}"),
    ]


def _contacts(table: xr.Dataset) -> Table:
    """What happens at each contact."""
    columns = {
        "force [MN]": ("hardest_force", "MN"),
        "approach [m/s]": ("fastest_approach", "m/s"),
        "longest [ms]": ("longest_impact", "ms"),
        "lost [kJ]": ("contact_energy", "kJ"),
    }
    rows = []
    for contact in along(table, "contact"):
        closest = f"{round(100 * float(contact.least_clearance), 2) + 0:.2f}"  # zero without a sign
        named = f"{int(contact.left)} | {int(contact.right)}"
        if "level" in table.coords:
            named += f", {float(contact.level):.4g} m up"
            named += "*" if str(contact.kind.item()) == SLAB_TO_COLUMN else ""
        begin = [named, centimetres(float(contact.gap)), closest, str(int(contact.impacts))]
        rows.append(begin + _measured(contact, columns))
    return Table.of(["contact", "gap [cm]", "closest [cm]", "impacts", *columns], rows)


def _notes(case: Case, table: xr.Dataset) -> str:
    storeys = "floor" in table.dims
    notes = [COLUMN] if "column" in table.coords else []
    if "contact" in table.dims:
        notes += [TIMES, *([ROOF, FLOOR] if storeys else [f"{ESTIMATE} {DUCTILITY}"])]
        jumps = table.sizes["impact"] and bool(table.largest_force.isnull().all())
        notes += [BASE, *[JUMPS] * bool(jumps), HITS, CLOSEST]
    else:
        notes.append(SHEAR if storeys else DUCTILITY)
    if any(building.strength in ("reduction_factor", "ductility") for building in case.buildings):
        notes.append(STRENGTH.format(site_in_words(case)))
    return " ".join(notes)
