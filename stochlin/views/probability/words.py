"""The probability of pounding in plain words and short numbers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from stochlin.models.grounds import KanaiTajimi, WhiteNoise
from stochlin.models.laws.bilinear import Bilinear
from stochlin.views.shared.screen import paragraph
from stochlin.views.shared.uncertain import unknown_lines
from stochlin.views.shared.words import doubted, floors, over_records, scatter, shaking

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.cases.case import Case
    from stochlin.analyses.cases.probability import ProbabilityAnswer

ROWS = 11  # instants that are printed
COLUMNS = (
    ("formula", ""),
    ("Poisson", "_poisson"),
    ("corrected", "_corrected"),
    ("simulated", "_simulated"),
)
STEM = "confidence_of_no_pounding"
NOT_CORRECTED = (
    "No corrected confidence is given: the error of linearization is only known for bilinear "
    "oscillators on Kanai-Tajimi ground and white noise, within the range of its map; here {}."
)
MAPPED = KanaiTajimi, WhiteNoise  # grounds of the map
UNRELIABLE = (
    "Do not rely on the column {}: for buildings like these it may be far off. The column simulated has "
    "no such error."
)
NO_RECORDS = (
    "The records are not evaluated: the hybrid method is only available for bilinear oscillators."
)


def answer_lines(answer: ProbabilityAnswer) -> list[str]:
    """The lines for the screen."""
    case, gap, table, records = answer.case, answer.gap, answer.table, answer.records
    shown = [column for column in COLUMNS if _known(table, column[1])]
    lines = [
        *paragraph(doubted(answer.doubts())),
        case.title,
        f"{case.first.name} (left) and {case.second.name}, gap {gap:.4g} m, {case.duration:.4g} s",
        *paragraph(floors(case)),
        *paragraph(shaking(answer.shaking, case)),
        *paragraph(scatter(case)),
        *unknown_lines(case, "the simulated confidence is that"),
        "",
        "Confidence of no pounding up to each time",
        f"{'time [s]':>9}" + "".join(f"{name:>11}" for name, _ in shown) + f"{'95 % interval':>22}",
    ]
    step = max(1, (table.sizes["time"] - 1) // (ROWS - 1))
    lines += [_instant(table.isel(time=index), shown) for index in range(0, table.sizes["time"], step)]
    lines += [
        "",
        f"Gap for a confidence of {case.confidence:g}: {_formulas(table)}"
        f"{float(table.required_gap_simulated):.4f} m simulated "
        f"({float(table.required_gap_simulated_lower):.4f} to "
        f"{float(table.required_gap_simulated_upper):.4f})",
    ]
    if f"{STEM}_corrected" in table and not _known(table, "_corrected"):
        lines += paragraph(NOT_CORRECTED.format(_beyond_the_map(case)))
    if "governing_height" in table:
        lines.append(
            f"The formulas are for the worst height, {float(table.governing_height):.4g} m; the "
            "simulated confidence is for all heights at once."
        )
    last = table.isel(time=-1)
    for name, ending in shown:
        if int(table.get(f"caution{ending}", 0)) and bool(last[STEM + ending].notnull()):
            lines += paragraph(UNRELIABLE.format(name))
    yields = case.first.structure.yields or case.second.structure.yields
    if yields and bool(table.permanent_set.any()):
        end = table.attrs["strong_shaking_end_s"]
        lines.append(
            f"After {end:.3g} s the formula no longer includes the permanent set of yielding buildings."
        )
    if records is not None:
        for n in range(records.sizes["record"]):
            end = records.isel(record=n, record_time=-1)
            lines += paragraph(_in_record(end, gap, case.confidence), "  ")
    if answer.over_records is not None:
        lines += paragraph(over_records(answer.over_records, len(case.records), gap))
    elif case.records and records is None:
        lines.append(NO_RECORDS)
    if "comment" in table.attrs:
        lines += paragraph(table.attrs["comment"].replace("α", "hardening").replace("≤", "<="))
    return lines


def _known(table: xr.Dataset, ending: str) -> bool:
    """Whether there is such a confidence, at any instant."""
    return STEM + ending in table and bool(table[STEM + ending].notnull().any())


def _beyond_the_map(case: Case) -> str:
    """Why the error of linearization is not known for a case."""
    other = [b.name for b in case.pair if not isinstance(b.structure, Bilinear)]
    if other:
        return f"{other[0]} is no bilinear oscillator"
    if not isinstance(case.ground, MAPPED):
        return f"the ground is {case.ground.name}"
    return "the buildings are outside this range"


def _instant(row: xr.Dataset, shown: Sequence[tuple[str, str]]) -> str:
    values = "".join(_number(row[STEM + ending], 11) for _, ending in shown)
    low, high = (float(row[f"{STEM}_simulated_{end}"]) for end in ("lower", "upper"))
    return f"{float(row.time):9.2f}{values}{low:12.4f} to {high:.4f}"


def _formulas(table: xr.Dataset) -> str:
    known = bool(table.required_gap_corrected.notnull())
    corrected = f"{float(table.required_gap_corrected):.4f} m corrected, " if known else ""
    return f"{float(table.required_gap):.4f} m by formula, {corrected}"


def _number(value: xr.DataArray, width: int) -> str:
    """Four decimals; a word for values outside the map of the bias."""
    return f"{'unknown':>{width}}" if bool(value.isnull()) else f"{float(value):{width}.4f}"


def _in_record(end: xr.Dataset, gap: float, wanted: float) -> str:
    """The hybrid method at the end of a record, and why no phase may be safe."""
    apart = float(end.record_radius_difference)
    sentence = (
        f"Record {end.record.item()}, hybrid method: confidence {float(end[f'record_{STEM}']):.4f} with "
        f"one phase between the buildings, {float(end[f'record_{STEM}_fresh_phase']):.4f} with a new "
        f"phase every cycle (rho {float(end.record_rho):.3f}); gap for a confidence of "
        f"{wanted:g}: {float(end.record_required_gap):.4f} m. The record itself "
        f"needs {float(end.record_separation):.4f} m."
    )
    if apart <= gap:
        return sentence
    return (
        f"{sentence} The energy radii differ by up to {apart:.4f} m, so that no phase avoids pounding."
    )
