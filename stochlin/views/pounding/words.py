"""The results of pounding in plain words and short numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
from scipy import constants

from stochlin.applications.cases.pounding import energy_of, is_oscillator
from stochlin.applications.cases.shaking import doubts
from stochlin.applications.pounding.rows import COLUMN as SLAB_TO_COLUMN
from stochlin.solver.tables.labels import VALUE_AND_ENDS
from stochlin.views.shared.blocks import Block, Table, Text, ViewSection, texts
from stochlin.views.shared.screen import cut
from stochlin.views.shared.uncertain import at_medians
from stochlin.views.shared.words import (
    MISSING,
    SPACE,
    along,
    floors,
    in_g,
    left_out,
    length,
    number,
    opening,
    per_cent,
    recorded_shaking,
    scatter,
    shaking,
    short,
    site_in_words,
    with_interval,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case

    Column = tuple[str, Callable[[xr.Dataset], str]]  # head, and the cell of a row

LONGEST_NAME = 20
LARGE_ERROR = 0.01  # by time steps, above which a caution is given
SINKS = {"viscous": "damping dissipated", "hysteretic": "yielding", "contacts": "contacts"}
ALONE = "one building alone, without a neighbour."
NOTES = {
    "shear [MN]": "Shear: of the storey below the floor.",
    "accel. [g]": "Peaks are those of the roof; accelerations are those of the floor with the largest "
    "one; base: largest base shear. The second value is that without pounding.",
    "times": "Times: largest displacement with pounding, relative to that without.",
    "worst": "Worst: the floor whose displacement grows most by pounding.",
    "ductility": "Ductility: largest displacement relative to that at yield.",
    "gains [kJ]": "Gains: work of all impacts on the building, negative if they take energy from it.",
    "closest [cm]": "Closest: smallest distance in the motion, negative if the contact is compressed.",
}
COLUMN = "Contacts with a star: a slab meets a column between two floors."
JUMPS = (
    "Velocities jump in impacts with this contact: accelerations and shears are those between impacts."
)
ERRORS = (
    "Mean: with its standard error. The 95 % intervals of the quantiles are in brackets; over: the "
    "motions are too few for the upper end of the interval."
)
OF_ROOF = "Displacements are those of the roof; accelerations, those of the floor with the largest one."
FAILED = (
    "{} of {} motions FAILED and are left out: {}. These are probably strong motions, so the "
    "quantiles are too small."
)
STRENGTH = (
    "Strengths given by reduction factor or ductility refer to the ground of the file, {}, not to the "
    "records."
)


def answer_sections(case: Case, tables: Mapping[str, xr.Dataset]) -> list[ViewSection]:
    """All that is shown, record by record, and the meaning of the columns."""
    doubtful = [f"in {record} {text}" for record, table in tables.items() for text in doubts(table)]
    of_records = [_in_record(case, record, table) for record, table in tables.items()]
    return [
        opening(case, doubtful),
        ViewSection("", texts([floors(case), *left_out(case), at_medians(case)])),
        *(ViewSection("", blocks) for blocks in of_records),
        ViewSection("", [Text(_notes(case, next(iter(tables.values())), of_records[0]))]),
    ]


def _in_record(case: Case, record: str, table: xr.Dataset) -> list[Block]:
    about = [f"{record}: {headline(table)}", recorded_shaking(table, case), columns_faced(table)]
    tables = (_buildings, _contacts) if "contact" in table.dims else (_alone,)
    return [
        *texts(about),
        *(each(table) for each in tables),
        *texts([energies(table), step_error(table)]),
    ]


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


def columns_faced(table: xr.Dataset, end: str = "", when: str = "") -> str:
    """A clear warning where slabs meet columns; ``end`` is that of the names of the variables."""
    if "column" not in table.coords:
        return ""
    forces = table[f"column_force{end}"].fillna(0.0)
    hit = int((forces > 0).sum())
    if not hit:
        return "SLABS FACE COLUMNS: the floors are not level. No column is hit."
    contact = table.isel(contact=int(forces.argmax("contact")))
    struck = int(contact[str(contact.column.item())])
    force = f"{number(float(contact[f'column_force{end}']), 'MN')} MN"
    share = float(contact[f"column_force_share{end}"])
    if np.isfinite(share):
        force += f", {per_cent(share)} of the storey's shear at yield"
    return (
        f"SLABS HIT COLUMNS at {hit} contact{'s' * (hit > 1)}, since the floors are not level. "
        f"Hardest, {float(contact.level):.4g} m up: the columns of storey {int(contact.storey)} of "
        f"building {struck} take {force}{when}. They carry the building above: check them in bending "
        "and shear, or widen the gap."
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


def _table(head: str, rows: Iterable[tuple[str, xr.Dataset]], columns: Iterable[Column]) -> Table:
    """A row for each dataset, after its name."""
    columns = list(columns)
    heads = [head, *(name for name, _ in columns)]
    return Table.of(heads, [[name, *(cell(row) for _, cell in columns)] for name, row in rows])


def _in(unit: str, name: str) -> Callable[[xr.Dataset], str]:
    """The cell with a variable in this unit."""
    return lambda row: number(float(row[name]), unit)


def _times(name: str) -> Callable[[xr.Dataset], str]:
    """The cell with a ratio, to two decimals."""
    return lambda row: f"{value:.2f}" if np.isfinite(value := float(row[name])) else MISSING


def _named(building: xr.Dataset) -> str:
    """The number and the name of a building."""
    return f"{int(building.structure)}  {cut(str(building.building.item()), LONGEST_NAME)}"


def _roof(building: xr.Dataset) -> xr.Dataset:
    """What is at the roof of a building with floors."""
    return building.sel(floor=int(building.storeys)) if "floor" in building.dims else building


def _at_most(building: xr.Dataset, name: str) -> xr.Dataset:
    """What is at the floor where a variable is largest."""
    return (
        building.isel(floor=int(building[name].argmax("floor")))
        if "floor" in building.dims
        else building
    )


def _alone(table: xr.Dataset) -> Table:
    """The response of a single building, floor by floor from the roof down."""
    building = table.isel(structure=0)
    columns = [
        ("accel. [g]", _in("g", "peak_acceleration")),
        ("shear [MN]", _in("MN", "peak_storey_shear")),
    ]
    peak = _in("cm", "peak")
    if "floor" not in table.dims:
        columns.append(("ductility", _in("1", "peak_ductility")))
        return _table("peak [cm]", [(peak(building), building)], columns)
    height: Column = ("height [m]", lambda floor: f"{float(floor.floor_level):.4g}")
    down = [(str(int(floor.floor)), floor) for floor in along(building, "floor")[::-1]]
    return _table("floor", down, [height, ("peak [cm]", peak), *columns])


def _buildings(table: xr.Dataset) -> Table:
    """What pounding does to each building: values with it and without."""

    def both(unit: str, name: str, place: Callable[[xr.Dataset], xr.Dataset]) -> Callable[..., str]:
        ends = _in(unit, name), _in(unit, f"{name}_alone")
        return lambda building: " | ".join(cell(place(building)) for cell in ends)

    worst = ("worst", _worst) if "floor" in table.dims else ("ductility", _times("peak_ductility"))
    columns: list[Column] = [
        ("peak [cm]", both("cm", "peak", _roof)),
        ("times", lambda building: _times("amplification")(_roof(building))),
        worst,
        ("accel. [g]", both("g", "peak_acceleration", lambda b: _at_most(b, "peak_acceleration"))),
        ("base [MN]", both("MN", "peak_base_shear", lambda building: building)),
        ("gains [kJ]", _in("kJ", "energy_received")),
    ]
    rows = [(_named(building), building) for building in along(table, "structure")]
    return _table("building", rows, columns)


def _worst(building: xr.Dataset) -> str:
    """The floor whose displacement grows most."""
    floor = _at_most(building, "amplification")
    times = _times("amplification")(floor)
    return times if is_oscillator(building) else f"{times}, floor {int(floor.floor)}"


def _contacts(table: xr.Dataset) -> Table:
    """What happens at each contact."""

    def name(contact: xr.Dataset) -> str:
        sides = f"{int(contact.left)} | {int(contact.right)}"
        if "level" not in table.coords:
            return sides
        star = "*" if str(contact.kind.item()) == SLAB_TO_COLUMN else ""
        return f"{sides}, {float(contact.level):.4g} m up{star}"

    columns: list[Column] = [
        ("gap [cm]", _in("cm", "gap")),
        # zero without a sign
        ("closest [cm]", lambda c: f"{round(100 * float(c.least_clearance), 2) + 0:.2f}"),
        ("impacts", lambda contact: str(int(contact.impacts))),
        ("force [MN]", _in("MN", "hardest_force")),
        ("approach [m/s]", _in("m/s", "fastest_approach")),
        ("longest [ms]", _in("ms", "longest_impact")),
        ("lost [kJ]", _in("kJ", "contact_energy")),
    ]
    return _table("contact", [(name(contact), contact) for contact in along(table, "contact")], columns)


def _notes(case: Case, table: xr.Dataset, blocks: Sequence[Block]) -> str:
    """What the columns of the tables mean that are shown for a record."""
    heads = {head for block in blocks if isinstance(block, Table) for head in block.heads}
    meets = "contact" in table.dims
    notes = [note for head, note in NOTES.items() if head in heads and (meets or head != "accel. [g]")]
    notes += [COLUMN] * ("column" in table.coords)
    notes += [JUMPS] * (meets and bool(table.hardest_force.isnull().all()))
    if any(building.strength in ("reduction_factor", "ductility") for building in case.buildings):
        notes.append(STRENGTH.format(site_in_words(case)))
    return " ".join(notes)


def ensemble_sections(case: Case, table: xr.Dataset) -> list[ViewSection]:
    """How often buildings meet, and means and quantiles of what that does."""
    over = str(table.status.dims[0])
    simulated, meets = over == "path", "neighbours" in table.dims
    count, good = table.sizes[over], int((table.status == 0).sum())
    strongest = table[["peak_ground_acceleration"]].max()
    motions = f"{count} records"
    if simulated:
        duration = f"{case.site.course.duration:.4g} s"
        motions = f"{count} simulated motions of {duration}, {site_in_words(case)}"
    about = [
        f"{motions}: {_shares(table) if meets else ALONE}",
        *((shaking(table, case), scatter(case)) if simulated else (_strengths(table),)),
        at_medians(case),
    ]
    why = next((str(text) for text in table.missing.values if text), "")
    failed = FAILED.format(count - good, count, why) if good < count else ""
    level = f" at most in {per_cent(float(table['quantile'][-1]))} of the motions"
    columns = columns_faced(table.isel(quantile=-1), "_quantile", level)
    heads = ["", "mean", *(per_cent(level) for level in table["quantile"].values)]
    rows: list[list[str]] = []
    for of_pair in along(table, "neighbours") if meets else ():
        rows += _gap_rows(of_pair, heads)
    for building in along(table, "structure"):
        rows += _building_rows(building, heads)
    notes = [ERRORS, *["Alone: without pounding."] * meets, *[OF_ROOF] * ("floor" in table.dims)]
    notes += [JUMPS] * (meets and bool(table.hardest_force_between_mean.isnull().any()))
    return [
        opening(case, doubts(strongest)),
        ViewSection("", texts([floors(case), *left_out(case)])),
        *(ViewSection("", texts(several)) for several in (about, [failed], [columns])),
        ViewSection("", [Table.of(heads, rows), Text(" ".join(notes))]),
    ]


def _strengths(table: xr.Dataset) -> str:
    """From the weakest record to the strongest."""
    low, high = (in_g(float(end)) for end in table.peak_ground_acceleration.quantile([0.0, 1.0]))
    return f"The shaking: PGA {low} to {high}."


def _shares(table: xr.Dataset) -> str:
    """The share of the motions in which neighbours meet."""
    shares = []
    for of_pair in along(table, "neighbours"):
        share, low, high = map(per_cent, with_interval(of_pair, "pounding_probability"))
        left, right = str(of_pair.neighbours.item()).split(" | ")
        shares.append(f"buildings {left} and {right} hit in {share} of them ({low} to {high})")
    return f"{'; '.join(shares)}."


def _gap_rows(table: xr.Dataset, heads: list[str]) -> list[list[str]]:
    pair = str(table.neighbours.item())
    gap = 100 * float(table.gap.values[table.left.values == int(pair.split(" | ", maxsplit=1)[0])][0])
    kinds = {
        "impacts": ("impacts_between", 1.0),
        "largest force [MN]": ("hardest_force_between", 1e-6),
        "energy lost [kJ]": ("contact_energy_between", 1e-3),
    }
    rows = [_row(f"  {name}", table, stem, scale) for name, (stem, scale) in kinds.items()]
    return [[f"Gap {pair}, {gap:.3g} cm", *[""] * (len(heads) - 1)], *rows]


def _building_rows(table: xr.Dataset, heads: list[str]) -> list[list[str]]:
    shaken, meets = _at_most(table, "peak_acceleration_mean"), "neighbours" in table.dims
    at_floor = (
        "" if "floor" not in table.dims or is_oscillator(table) else f", floor {int(shaken.floor)}"
    )
    rows = []
    for name, place, stem, scale in (
        ("displacement [cm]", _roof(table), "peak", 100.0),
        (f"acceleration [g]{at_floor}", shaken, "peak_acceleration", 1 / constants.g),
        ("base shear [MN]", table, "peak_base_shear", 1e-6),
    ):
        rows.append(_row(f"  {name}", place, stem, scale))
        rows += [_row("    alone", place, f"{stem}_alone", scale)] * meets
    return [[_named(table), *[""] * (len(heads) - 1)], *rows]


def _row(name: str, table: xr.Dataset, stem: str, scale: float) -> list[str]:
    """Mean with its error, and quantiles with their intervals."""
    mean, error = (scale * float(table[f"{stem}_mean{end}"]) for end in ("", "_standard_error"))
    cells = [MISSING if np.isnan(mean) else f"{_digits(mean)} +- {error:.2g}"]
    ends = (scale * table[f"{stem}_quantile{end}"].values for end in VALUE_AND_ENDS)
    for value, low, high in zip(*ends, strict=True):
        between = f"{_digits(low)}-{_digits(high)}" if np.isfinite(high) else f"over {_digits(low)}"
        cells.append(MISSING if np.isnan(value) else f"{_digits(value)} ({between})")
    return [name, *cells]


def _digits(value: float) -> str:
    """Three digits, below one two: the intervals are wider."""
    return short(value) if value >= 1 else f"{value:.2g}"
