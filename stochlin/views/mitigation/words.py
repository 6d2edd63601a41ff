"""Measures against pounding in plain words and short numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stochlin.analyses.cases.rows import pair_of, simulated_as
from stochlin.analyses.cases.shaking import doubts
from stochlin.analyses.separation.separation import AT_LEAST, LESS
from stochlin.views.shared.blocks import Items, Table, ViewSection, texts
from stochlin.views.shared.screen import cut
from stochlin.views.shared.uncertain import unknowns
from stochlin.views.shared.words import (
    MISSING,
    SPACE,
    along,
    centimetres,
    floors,
    left_out,
    length,
    opening,
    per_cent,
    scatter,
    shaking,
    short,
    with_interval,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

    from stochlin.analyses.cases.reading.case import Case

WIDE = 34  # characters of a name
WORDS, UNDECIDED = (
    {AT_LEAST: "enough", LESS: "not enough"},
    "undecided within the error of the simulation",
)
NOTES = (
    "Damping: added damping of buildings 1 and 2 in per cent of critical. Dashpot: damping constant of "
    "all links between the buildings. Needed: the gap for the confidence, and its 95 % interval; where "
    "there are bumpers, with their thickness, since contact of the bumpers counts as contact of the "
    "buildings. Apart: share of the simulated motions in which the existing gap prevents pounding. "
    "Within error: the difference is within the error of the simulation. Std: standard deviation of the "
    "relative displacement by linearization, which is too small where buildings yield. All measures are "
    "simulated with the same motions."
)
HEADS = "interval", "apart", "verdict", "std [cm]"
NO_DASHPOT = (
    "least dashpot between: not searched; it needs masses, and floors of both buildings at one level."
)
OF_DEVICES = (
    "Devices: mean | 95 % quantile over the simulated motions, without contact of the buildings, of the "
    "largest force, of the largest extension or compression (stroke), and of the energy that the device "
    "dissipates in a motion. Numbers are those of the buildings; 1.3 is floor 3 of building 1. The "
    "values are those of the analysis, without partial factors of codes."
)
TIMES = (
    "Times: largest displacement of buildings 1 and 2, relative to the building as built and alone. "
    "Pressed: the deepest compression of the contact; bumpers have to be thicker. Link: the largest "
    "force of links and dampers. What bumpers do to the buildings is visible only in these columns."
)


def answer_sections(table: xr.Dataset, case: Case) -> list[ViewSection]:
    """The answer, the measures in simulated motions and in records, and what their columns mean."""
    case = simulated_as(case, table)
    built = table.isel(measure=0)
    peaks = float(built.peak_mean_1), float(built.peak_mean_2)
    about = (_headline(table), shaking(table, case), scatter(case))
    notes = {"measure": NOTES, "device": OF_DEVICES, "record": TIMES}
    return [
        opening(case, doubts(table, pair_of(case), float(built.required_gap), peaks)),
        ViewSection("", texts([floors(case), *left_out(case)])),
        ViewSection("", [*texts(about), *unknowns(case, "needed gaps and shares are those")]),
        ViewSection("", [_motions(table)]),
        *_devices(table),
        *_in_records(table),
        ViewSection("", [Items(_remarks(table))]),
        ViewSection("", texts([text for name, text in notes.items() if name in table.dims])),
    ]


def _headline(table: xr.Dataset) -> str:
    """Whether the gap is enough as built, and which measures make it enough."""
    built = table.isel(measure=0)
    apart, wanted = float(built.no_pounding_probability), float(table.attrs["confidence"])
    sentence = (
        f"As built, the existing gap of {length(float(table.attrs['gap_m']))} prevents pounding in "
        f"{per_cent(apart, 1)} of the motions; the required share is {100 * wanted:.4g}{SPACE}%."
    )
    if not (table.kind == "least").any():
        sentence += " That is enough, so no further measure is searched."
    parts = [
        f"{row.measure.item()}, {WORDS.get(int(row.verdict), UNDECIDED)}"
        for row in along(table.where(table.kind == "given", drop=True), "measure")
    ]
    return f"{sentence} The measures of the file: {'; '.join(parts)}." if parts else sentence


def _motions(table: xr.Dataset) -> Table:
    heads = "measure", "damping [%]", "dashpot [MN s/m]", "needed [cm]", *HEADS
    meanings = table.verdict.attrs["flag_meanings"].replace("not_available", "none_found").split()
    rows = []
    for row in along(table, "measure"):
        needed, low, high = map(centimetres, with_interval(row, "required_gap"))
        rows.append(
            [
                cut(row.measure.item(), WIDE),
                _pair(row, "added_damping", "{:.1f}", 100),
                _dashpot(row),
                needed,
                f"{low} to {high}" if np.isfinite(float(row.required_gap)) else MISSING,
                per_cent(float(row.no_pounding_probability), 1),
                meanings[int(row.verdict)].replace("_", " "),
                centimetres(float(row.relative_displacement_std)),
            ]
        )
    return Table.of(heads, rows)


def _dashpot(row: xr.Dataset) -> str:
    """Constant of the dashpots between both, with their exponent where they are not linear."""
    constant, exponent = float(row.link_damping_constant) / 1e6, float(row.link_damping_exponent)
    shown = f" (a {exponent:g})" if np.isfinite(exponent) and exponent != 1 else ""
    return f"{short(constant)}{shown}"


def _devices(table: xr.Dataset) -> list[ViewSection]:
    """A table of all links and dampers; none without them."""
    if "device" not in table.dims:
        return []
    heads = ["measure", "device", "force [kN]", "stroke [cm]", "energy [kJ]"]
    rows = [
        [
            cut(row.measure.item(), WIDE),
            f"{row.device_kind.item()} {row.device_place.item()}",
            _mean_and_quantile(row, "device_force", lambda force: short(force / 1e3)),
            _mean_and_quantile(row, "device_stroke", centimetres),
            _mean_and_quantile(row, "device_energy", lambda energy: short(energy / 1e3)),
        ]
        for measure in along(table, "measure")
        for row in along(measure, "device")
        if row.device_kind.item()
    ]
    return [ViewSection("Devices", [Table.of(heads, rows, words=["device"])])]


def _mean_and_quantile(row: xr.Dataset, name: str, shown: Callable[[float], str]) -> str:
    return " | ".join(shown(float(row[f"{name}_{what}"])) for what in ("mean", "quantile"))


def _in_records(table: xr.Dataset) -> list[ViewSection]:
    """A table of each record, or of all of them where they are many; none without records."""
    if "quantile" in table.dims:
        what = (
            f"In {table.sizes['record']} records; the values are not exceeded in half of them and in "
            f"{_levels(table)[-1]} of them"
        )
        return [ViewSection(what, [_over_records(table)])]
    records = table.record.values if "record" in table.dims else ()
    return [ViewSection(f"In {name}", [_recorded(table.sel(record=name))]) for name in records]


def _recorded(table: xr.Dataset) -> Table:
    """The effect of each measure in a record."""
    heads = ["measure", "times", "impacts", "force [MN]", "pressed [cm]", "link [MN]"]
    rows = [
        [
            cut(row.measure.item(), WIDE),
            _pair(row, "amplification", "{:.2f}"),
            short(float(row.impacts)),
            short(float(row.largest_force) / 1e6),
            centimetres(float(row.deepest_compression)),
            short(float(row.largest_link_force) / 1e6),
        ]
        for row in along(table, "measure")
        if np.isfinite(float(row.amplification_1))
    ]
    return Table.of(heads, rows)


def _levels(table: xr.Dataset) -> list[str]:
    return [f"{100 * level:.4g}{SPACE}%" for level in table["quantile"].values]


def _over_records(table: xr.Dataset) -> Table:
    """The effect of each measure in many records, by quantiles."""
    heads = ["measure", "do not meet", *(f"times, {level}" for level in _levels(table))]
    heads += ["impacts", "force [MN]"]
    rows = []
    for row in along(table, "measure"):
        if not np.isfinite(float(row.record_no_pounding_probability)):
            continue
        each = along(row, "quantile")
        rows.append(
            [
                cut(row.measure.item(), WIDE),
                per_cent(float(row.record_no_pounding_probability)),
                *(_pair(at, "record_amplification", "{:.2f}") for at in each),
                " | ".join(short(float(at.record_impacts)) for at in each),
                " | ".join(short(float(at.record_largest_force) / 1e6) for at in each),
            ]
        )
    return Table.of(heads, rows)


def _remarks(table: xr.Dataset) -> list[str]:
    """Bumpers that are too thin, and what is missing, and why."""
    remarks = []
    for row in along(table, "measure"):
        name, thickness = row.measure.item(), float(row.bumper_thickness)
        deep = row.get("deepest_compression")
        if deep is not None and float(deep.max()) > thickness > 0:
            remarks.append(
                f"{name}: the bumpers, {length(thickness)} thick, would be compressed by "
                f"{length(float(deep.max()))} in {deep.idxmax().item()}; take thicker or stiffer ones."
            )
        if row.missing.item():
            remarks.append(f"{name}: {row.missing.item()}.")
    searched = table.measure.values[(table.kind == "least").values]
    if searched.size and not any("dashpot" in str(name) for name in searched):
        remarks.append(NO_DASHPOT)
    return remarks


def _pair(row: xr.Dataset, name: str, form: str, scale: float = 1.0) -> str:
    values = [scale * float(row[f"{name}_{n}"]) for n in (1, 2)]
    return " | ".join(form.format(value) for value in values) if np.isfinite(values).all() else MISSING
