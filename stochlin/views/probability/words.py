"""The probability of pounding in plain words and short numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from stochlin.applications.cases.rows import pair_of
from stochlin.views.shared.blocks import Block, Items, Table, Text, ViewSection, texts
from stochlin.views.shared.words import (
    SPACE,
    along,
    centimetres,
    floors,
    left_out,
    length,
    opening,
    over_records,
    scatter,
    shaking,
    with_interval,
    with_uncertainty,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.probability import ProbabilityAnswer

OFF = 0.1  # of a confidence by formula above the interval of the simulated one, of which a line warns
ROWS = 11  # instants that are printed
NAMES = (
    ("formula", ""),
    ("Poisson", "_poisson"),
    ("corrected", "_corrected"),
    ("simulated", "_simulated"),
)
STEM = "confidence_of_no_pounding"
UNRELIABLE = (
    "Do not rely on the column {}: for buildings like these it may be far off. The column simulated has "
    "no such error."
)
NO_RECORDS = "The records are not evaluated: the hybrid method is only available for oscillators."


def answer_sections(answer: ProbabilityAnswer) -> list[ViewSection]:
    """The course of the confidence, then the gap for the wanted one, cautions and records."""
    case, table = answer.case, answer.table
    first, second = (building.name for building in pair_of(case))
    duration = f"{case.site.course.duration:.4g}{SPACE}s"
    between = f"{first} (left) and {second}, gap {length(answer.gap)}, {duration}"
    about = (between, floors(case), *left_out(case), shaking(answer.shaking, case), scatter(case))
    shown = [column for column in NAMES if _known(table, column[1])]
    step = max(1, (table.sizes["time"] - 1) // (ROWS - 1))
    rows = [_instant(table.isel(time=n), shown) for n in range(0, table.sizes["time"], step)]
    heads = ("time [s]", *(name for name, _ in shown), "95 % interval")
    comment = table.attrs.get("comment", "").replace("α", "hardening").replace("≤", "<=")
    return [
        opening(case, answer.doubts()),
        ViewSection("", texts([*about, with_uncertainty(case, "the simulated confidence is that")])),
        ViewSection("Confidence of no pounding up to each time", [Table.of(heads, rows)]),
        ViewSection("", texts([_wanted(answer), *_cautions(answer, shown)])),
        ViewSection("", [*_of_records(answer), Text(comment)]),
    ]


def _wanted(answer: ProbabilityAnswer) -> str:
    """The gap for the wanted confidence, by formula and simulated."""
    table = answer.table
    simulated, low, high = with_interval(table, "required_gap_simulated")
    by_formula = (("required_gap", "by formula"), ("required_gap_corrected", "corrected"))
    known = [(name, word) for name, word in by_formula if name in table and table[name].notnull()]
    gaps = [f"{length(float(table[name]))} {word}" for name, word in known]
    gaps.append(f"{length(simulated)} simulated ({centimetres(low)} to {centimetres(high)})")
    wanted = 100 * answer.case.wanted.confidence
    return f"Gap for a confidence of {wanted:.4g}{SPACE}%: {', '.join(gaps)}."


def _cautions(answer: ProbabilityAnswer, shown: Sequence[tuple[str, str]]) -> list[str]:
    """What the formulas do not contain, where that matters here."""
    case, table = answer.case, answer.table
    cautions = []
    if "governing_height" in table:
        cautions.append(
            f"The formulas are for the worst height, {float(table.governing_height):.4g} m; the "
            "simulated confidence is for all heights at once."
        )
    last = table.isel(time=-1)
    most = float(last[f"{STEM}_simulated_lower"]) + OFF
    for name, ending in shown:
        if ending in ("", "_corrected") and float(last[STEM + ending]) > most:
            cautions.append(UNRELIABLE.format(name))
    yields = any(building.structure.yields for building in pair_of(case))
    if STEM in table and yields and bool(table.permanent_set.any()):
        end = f"{table.attrs['strong_shaking_end_s']:.3g} s"
        cautions.append(
            f"After {end} the formula no longer includes the permanent set of yielding buildings."
        )
    return cautions


def _of_records(answer: ProbabilityAnswer) -> list[Block]:
    """Each record by the hybrid method, or many of them together."""
    case, gap, records = answer.case, answer.gap, answer.records
    if answer.over_records is not None:
        return [Text(over_records(answer.over_records, len(case.site.records), gap))]
    if records is None:
        return [Text(NO_RECORDS if case.site.records else "")]
    ends = along(records.isel(record_time=-1), "record")
    return [Items([_in_record(end, gap, case.wanted.confidence) for end in ends])]


def _known(table: xr.Dataset, ending: str) -> bool:
    """Whether there is such a confidence, at any instant."""
    return STEM + ending in table and bool(table[STEM + ending].notnull().any())


def _instant(row: xr.Dataset, shown: Sequence[tuple[str, str]]) -> list[str]:
    """Four decimals; a word for values whose bias is unknown."""
    _, low, high = with_interval(row, f"{STEM}_simulated")
    values = [float(row[STEM + ending]) for _, ending in shown]
    shares = ["unknown" if np.isnan(value) else f"{value:.4f}" for value in values]
    return [f"{float(row.time):.2f}", *shares, f"{low:.4f} to {high:.4f}"]


def _in_record(end: xr.Dataset, gap: float, wanted: float) -> str:
    """The hybrid method at the end of a record, and why no phase may be safe."""
    apart = float(end.record_radius_difference)
    sentence = (
        f"Record {end.record.item()}, hybrid method: confidence {float(end[f'record_{STEM}']):.4f} "
        f"(rho {float(end.record_rho):.3f}); gap for a confidence of "
        f"{100 * wanted:.4g}{SPACE}%: {length(float(end.record_required_gap))}. The record itself "
        f"needs {length(float(end.record_separation))}."
    )
    if apart <= gap:
        return sentence
    return (
        f"{sentence} The energy radii differ by up to {length(apart)}, so that no phase avoids pounding."
    )
