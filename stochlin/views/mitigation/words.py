"""Measures against pounding in plain words and short numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stochlin.applications.cases.rows import simulated_as
from stochlin.applications.cases.shaking import doubts
from stochlin.messages import plain
from stochlin.views.shared.blocks import Items, TableBlock, ViewSection, texts
from stochlin.views.shared.inches import sections_with_inches
from stochlin.views.shared.words import (
    NBSP,
    NO_VALUE,
    along,
    centimetres,
    floors,
    left_out,
    length,
    number,
    opening,
    per_cent,
    strength,
    with_interval,
    with_uncertainty,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import xarray as xr

    from stochlin.applications.cases.reading.case import Case

MEASURE_WIDTH = 34  # characters of a name
NOTES = {
    "measure": "Damping: added to buildings 1 and 2, in per cent of critical. Dashpot: damping "
    "constant of all linear links between the buildings. Needed: the gap for the confidence, and "
    "its 95 % interval. Apart: share of the simulated motions in which the "
    "existing gap prevents pounding. Std: standard deviation of the relative displacement by "
    "linearization, which is too small where buildings yield. All measures are simulated with the "
    "same motions.",
    "link": "Devices: mean | 95 % quantile over the simulated motions, without contact of the "
    "buildings and without partial factors of codes; 1.3 is floor 3 of building 1.",
}
Columns = dict[str, "Callable[[xr.Dataset], str]"]  # heads, and the cells below them


def answer_sections(table: xr.Dataset, case: Case) -> list[ViewSection]:
    """The answer, the measures in simulated motions, and what their columns mean."""
    case = simulated_as(case, table)
    about = (floors(case), *left_out(case), _headline(table), *strength(table, case))
    sections = [
        opening(case, doubts(table)),
        ViewSection(
            "", texts([*about, with_uncertainty(case, "needed gaps and shares are those")])
        ),
        ViewSection("", [_table(along(table, "measure"), _of_motions(table))]),
        *_devices(table),
        ViewSection("", [Items(_missing(table))]),
        ViewSection("", texts([text for name, text in NOTES.items() if name in table.dims])),
    ]
    return sections_with_inches(case, sections)


def _headline(table: xr.Dataset) -> str:
    """Whether the gap is enough as built."""
    built = table.isel(measure=0)
    apart = float(built.no_pounding_probability)
    wanted = float(table.attrs["confidence"])
    sentence = (
        f"As built, the existing gap of {length(float(table.attrs['gap_m']))} prevents pounding in "
        f"{per_cent(apart, 1)} of the motions; the required share is {100 * wanted:.4g}{NBSP}%."
    )
    if not (table.kind == "least").any():
        sentence += " That is enough, so no further measure is searched."
    return sentence


def _table(rows: Sequence[xr.Dataset], columns: Columns, words: Sequence[str] = ()) -> TableBlock:
    """A table of rows of a dataset, each with its measure and the columns."""
    cells = [
        (plain(row.measure.item(), MEASURE_WIDTH), *(cell(row) for cell in columns.values()))
        for row in rows
    ]
    return TableBlock.of(("measure", *columns), cells, words)


def _of_motions(table: xr.Dataset) -> Columns:
    """The parameters that were searched, and the results in simulated motions."""
    verdicts = table.verdict.attrs["flag_meanings"].replace("not_available", "none_found").split()
    return {
        "damping [%]": lambda row: _pair(row, "added_damping", "{:.1f}", 100),
        "dashpot [MN s/m]": lambda row: number(float(row.link_damping_constant) / 1e6),
        "needed [cm]": lambda row: centimetres(float(row.required_gap)),
        "interval": _interval,
        "apart": lambda row: per_cent(float(row.no_pounding_probability), 1),
        "verdict": lambda row: verdicts[int(row.verdict)].replace("_", " "),
        "std [cm]": lambda row: centimetres(float(row.relative_displacement_std)),
    }


def _interval(row: xr.Dataset) -> str:
    gap, low, high = with_interval(row, "required_gap")
    return f"{centimetres(low)} to {centimetres(high)}" if np.isfinite(gap) else NO_VALUE


def _devices(table: xr.Dataset) -> list[ViewSection]:
    """A table of all links and dampers; none without them."""
    if "link" not in table.dims:
        return []

    def both(name: str, unit: str) -> Callable[[xr.Dataset], str]:
        return lambda row: " | ".join(
            number(float(row[f"{name}{e}"]), unit) for e in ("_mean", "_quantile")
        )

    columns = {
        "device": lambda row: f"{row.link_kind.item()} {row.link_place.item()}",
        "force [MN]": both("peak_link_force", "MN"),
        "stroke [cm]": both("peak_link_stroke", "cm"),
        "energy [kJ]": both("link_energy", "kJ"),
    }
    rows = [row for measure in along(table, "measure") for row in along(measure, "link")]
    present = [row for row in rows if row.link_kind.item()]
    return [ViewSection("Devices", [_table(present, columns, ["device"])])]


def _missing(table: xr.Dataset) -> list[str]:
    """Searches without a result."""
    rows = along(table, "measure")
    return [f"{row.measure.item()}: {row.missing.item()}." for row in rows if row.missing.item()]


def _pair(row: xr.Dataset, name: str, form: str, scale: float = 1.0) -> str:
    values = [scale * float(row[f"{name}_{n}"]) for n in (1, 2)]
    return (
        " | ".join(form.format(value) for value in values)
        if np.isfinite(values).all()
        else NO_VALUE
    )
