"""The results of pounding in plain words and short numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from scipy import constants

from stochlin.applications.cases.pounding import ENERGIES, energy_of
from stochlin.applications.cases.shaking import doubts
from stochlin.messages import plain
from stochlin.solver.tables.labels import VALUE_AND_ENDS
from stochlin.views.shared.blocks import TableBlock, TextBlock, ViewSection, texts
from stochlin.views.shared.inches import sections_with_inches
from stochlin.views.shared.words import (
    NBSP,
    NO_VALUE,
    along,
    at_medians,
    counted,
    files_taken,
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
    site_in_words,
    with_interval,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case

LONGEST_BUILDING_NAME = 24
LARGE_ERROR = 0.01  # by time steps, above which a caution is given
SINKS = "damping dissipated", "yielding", "contacts"  # of ENERGIES
NO_NEIGHBOUR = "one building alone, without a neighbour."
# Rows of a table: the variable, and what its values are multiplied by.
OF_GAPS = {
    "impacts": ("impacts_between", 1.0),
    "largest force [MN]": ("hardest_force_between", 1e-6),
    "energy lost [kJ]": ("contact_energy_between", 1e-3),
}
OF_BUILDINGS = {
    "displacement [cm]": ("peak", 100.0),
    "acceleration [g]": ("peak_acceleration", 1 / constants.g),
    "base shear [MN]": ("peak_base_shear", 1e-6),
    "ductility": ("peak_ductility", 1.0),
}
OF_NEIGHBOURS = {
    "amplification": ("amplification", 1.0),
    "work of impacts [kJ]": ("energy_received", 1e-3),
}
MEANINGS = "Alone: without pounding. Amplification: displacement over that alone."
OF_FLOORS = (
    "Displacements are those of the roof; accelerations and amplifications, those of the floor "
    "where they are largest."
)
JUMPS = (
    "Velocities jump in impacts with this contact: accelerations and shears are those between "
    "impacts."
)
STATISTICS_NOTE = (
    "Mean: with its standard error. The 95 % intervals of the quantiles are in brackets; over: the "
    "motions are too few for the upper end of the interval."
)
FAILED = (
    "{} of {} motions FAILED and are left out: {}. These are probably strong motions, so the "
    "quantiles are too small."
)
STRENGTH_BY_GROUND = (
    "Strengths given by reduction factor or ductility refer to the ground of the file, {}, not to "
    "the records."
)


def answer_sections(case: Case, table: xr.Dataset) -> list[ViewSection]:
    """What happens in a record, or how often it happens in many motions, and a table of values."""
    facts = _of_record(case, table) if "time" in table.dims else _of_motions(case, table)
    strongest = table[["peak_ground_acceleration"]].max()
    sections = [
        opening(case, doubts(strongest)),
        ViewSection(
            "", texts([floors(case), *left_out(case), at_medians(case), files_taken(case)])
        ),
        *(ViewSection("", texts(several)) for several in facts),
        _values(case, table),
    ]
    return sections_with_inches(case, sections)


def _of_record(case: Case, table: xr.Dataset) -> list[list[str]]:
    (record,) = case.site.records
    about = [f"{record}: {headline(table)}", recorded_shaking(table, case), columns_faced(table)]
    return [[*about, energies(table), step_error(table)]]


def headline(table: xr.Dataset) -> str:
    """The result of one record in a sentence."""
    if "contact" not in table.dims:
        return NO_NEIGHBOUR
    count = int(table.impacts.sum())
    if not count:
        nearest = int(table.least_clearance.argmin("contact"))
        left = float(table["least_clearance"][nearest])
        gap = float(table["gap"][nearest])
        return f"no pounding. At least {length(left)} of the gap of {length(gap)} remain open."
    begin = float(table.impact_time.min())
    sentence = f"{counted(count, 'impact')}, the first at {begin:.2f} s."
    force = float(table.largest_force.max(skipna=False))
    speed = float(table.fastest_approach.max())
    if np.isfinite(force):
        hardest = table.isel(contact=int(table.hardest_force.argmax("contact")))
        level = f" {float(hardest.level):.4g} m up" if "level" in table.coords else ""
        largest = f"Largest force {number(force, 'MN')} MN{level}"
        return f"{sentence} {largest}, fastest approach {number(speed)} m/s."
    return f"{sentence} Fastest approach {number(speed)} m/s; this contact gives no forces."


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
        f"SLABS HIT COLUMNS at {counted(hit, 'contact')}, since the floors are not level. "
        f"Hardest, {float(contact.level):.4g} m up: the columns of storey {int(contact.storey)} of "
        f"building {struck} take {force}{when}. They carry the building above: check them in "
        "bending and shear, or widen the gap."
    )


def energies(table: xr.Dataset) -> str:
    """The energy balance, and its error."""
    last = table.isel(time=-1)
    amounts = [float(energy_of(last, where)) for where in ENERGIES]
    energy = amounts[0]
    meets = "contact" in table.dims
    shares = [per_cent(part / energy, 1) if energy > 0 else NO_VALUE for part in amounts[1:]]
    sinks = zip(SINKS, shares[:-1], strict=True)
    losses = ", ".join(f"{word} {share}" for word, share in sinks if meets or word != "contacts")
    left = shares[-1]
    return (
        f"Of the {number(energy, 'kJ')} kJ from the ground, {losses}; {left} are left at the end. "
        f"The balance is off by {float(table.energy_balance_error.max()):.0e} at most."
    )


def step_error(table: xr.Dataset) -> str:
    """The error by time steps, with a caution and the cure if it is large."""
    error = float(table.step_error)
    sentence = f"Error by time steps: at most {100 * error:.1g}{NBSP}% of a peak or largest force."
    if error <= LARGE_ERROR:
        return sentence
    return f"{sentence} CAUTION: more than {per_cent(LARGE_ERROR)}; take more --steps-per-contact."


def roof(building: xr.Dataset) -> xr.Dataset:
    """What is at the roof of a building with floors."""
    return building.sel(floor=int(building.storeys)) if "floor" in building.dims else building


def _values(case: Case, table: xr.Dataset) -> ViewSection:
    """Rows of each gap and building: values in one record, or means and quantiles, and notes."""
    single = "time" in table.dims
    meets = "neighbours" in table.dims
    end = "" if single else "_mean"
    heads = [""] if single else ["mean", *(per_cent(level) for level in table["quantile"].values)]
    blank = [""] * len(heads)

    def row(name: str, at: Mapping[str, int], stem: str, scale: float) -> list[str]:
        part = _part(table.isel(at), f"{stem}{end}")
        cells = [number(scale * float(part[stem]))] if single else _statistics(part, stem, scale)
        return [name, *cells]

    rows: list[list[str]] = []
    for n, pair in enumerate(table.neighbours.values if meets else ()):
        gap = 100 * float(table.gap.values[table.left.values == np.unique(table.left)[n]][0])
        rows.append([f"Gap {pair}, {gap:.3g} cm", *blank])
        for name, (stem, scale) in OF_GAPS.items():
            rows.append(row(f"  {name}", {"neighbours": n}, stem, scale))
    for n, building in enumerate(table.building.values):
        rows.append([f"{n + 1}  {plain(str(building), LONGEST_BUILDING_NAME)}", *blank])
        for name, (stem, scale) in (OF_BUILDINGS | (OF_NEIGHBOURS if meets else {})).items():
            if f"{stem}{end}" in table:
                rows.append(row(f"  {name}", {"structure": n}, stem, scale))
            if meets and f"{stem}_alone{end}" in table:
                rows.append(row("    alone", {"structure": n}, f"{stem}_alone", scale))
    relative = "reduction_factor", "ductility"
    by_ground = any(building.strength in relative for building in case.buildings)
    notes = [STRENGTH_BY_GROUND.format(site_in_words(case))] * (single and by_ground)
    notes += [STATISTICS_NOTE] * (not single)
    notes += [MEANINGS] * meets + [OF_FLOORS] * ("floor" in table.dims)
    jumps = meets and bool(table[f"hardest_force_between{end}"].isnull().any())
    text = " ".join([*notes, *[JUMPS] * jumps])
    return ViewSection("", [TableBlock.of(["", *heads], rows), TextBlock(text)])


def _part(table: xr.Dataset, name: str) -> xr.Dataset:
    """What is at the roof for displacements, and else at the floor with the largest value."""
    if "floor" not in table[name].dims:
        return table
    if name.removesuffix("_mean") in ("peak", "peak_alone"):
        return roof(table)
    return table.isel(floor=int(table[name].argmax("floor")))


def _of_motions(case: Case, table: xr.Dataset) -> list[list[str]]:
    over = str(table.status.dims[0])
    simulated = over == "path"
    meets = "neighbours" in table.dims
    count = table.sizes[over]
    good = int((table.status == 0).sum())
    motions = f"{count} records"
    strength = [_strengths(table)]
    if simulated:
        duration = f"{case.site.course.duration:.4g} s"
        motions = f"{count} simulated motions of {duration}, {site_in_words(case)}"
        strength = [shaking(table, case), scatter(case)]
    why = next((str(text) for text in table.missing.values if text), "")
    failed = FAILED.format(count - good, count, why) if good < count else ""
    level = f" at most in {per_cent(float(table['quantile'][-1]))} of the motions"
    columns = columns_faced(table.isel(quantile=-1), "_quantile", level)
    return [
        [f"{motions}: {_shares(table) if meets else NO_NEIGHBOUR}", *strength],
        [failed],
        [columns],
    ]


def _strengths(table: xr.Dataset) -> str:
    """From the weakest record to the strongest."""
    low, high = table.peak_ground_acceleration.quantile([0.0, 1.0])
    return f"The shaking: PGA {in_g(float(low))} to {in_g(float(high))}."


def _shares(table: xr.Dataset) -> str:
    """The share of the motions in which neighbours meet."""
    shares = []
    for of_pair in along(table, "neighbours"):
        share, low, high = map(per_cent, with_interval(of_pair, "pounding_probability"))
        left, right = str(of_pair.neighbours.item()).split(" | ")
        both = f"buildings {left} and {right} hit"
        if "wall" in (left, right):
            both = f"building {right if left == 'wall' else left} hits the wall"
        shares.append(f"{both} in {share} of them ({low} to {high})")
    return f"{'; '.join(shares)}."


def _statistics(table: xr.Dataset, stem: str, scale: float) -> list[str]:
    """Mean with its error, and quantiles with their intervals."""
    mean = scale * float(table[f"{stem}_mean"])
    error = scale * float(table[f"{stem}_mean_standard_error"])
    cells = [NO_VALUE if np.isnan(mean) else f"{_digits(mean)} +- {error:.2g}"]
    ends = (scale * table[f"{stem}_quantile{end}"].values for end in VALUE_AND_ENDS)
    for value, low, high in zip(*ends, strict=True):
        between = f"{_digits(low)}-{_digits(high)}" if np.isfinite(high) else f"over {_digits(low)}"
        cells.append(NO_VALUE if np.isnan(value) else f"{_digits(value)} ({between})")
    return cells


def _digits(value: float) -> str:
    """Three digits, below one two: the intervals are wider."""
    return number(value) if value >= 1 else f"{value:.2g}"
