"""The probability of pounding in plain words and short numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stochlin.applications.cases.rows import pair_of, simulated_as
from stochlin.applications.cases.shaking import doubts
from stochlin.applications.probability.probability import STEM
from stochlin.views.shared.blocks import TableBlock, TextBlock, ViewSection, texts
from stochlin.views.shared.inches import sections_with_inches
from stochlin.views.shared.words import (
    NBSP,
    along,
    centimetres,
    floors,
    left_out,
    length,
    opening,
    strength,
    with_interval,
    with_uncertainty,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.reading.case import Case

# of a confidence by formula above the interval of the simulated one, of which a line warns
UNSAFE_EXCESS = 0.1
ROWS = 11  # instants that are printed
COLUMNS_OF_FORMULAS = {"clustered crossings": STEM, "independent crossings": f"{STEM}_poisson"}
UNRELIABLE = (
    "Do not rely on the formula: for buildings like these it may be far off. The simulated "
    "confidence has no such error."
)


def answer_sections(table: xr.Dataset, case: Case, gap: float) -> list[ViewSection]:
    """The simulated confidence and gap, then the course by formula, and cautions."""
    case = simulated_as(case, table)
    first, second = pair_of(case)
    duration = f"{case.site.course.duration:.4g}{NBSP}s"
    between = f"{first.name} (left) and {second.name}, gap {length(gap)}, {duration}"
    about = (between, floors(case), *left_out(case), *strength(table, case))
    formulas = {head: name for head, name in COLUMNS_OF_FORMULAS.items() if name in table}
    step = max(1, (table.sizes["time"] - 1) // (ROWS - 1))
    rows = [
        [
            f"{float(instant.time):.2f}",
            *(f"{float(instant[name]):.4f}" for name in formulas.values()),
        ]
        for instant in along(table, "time")[::step]
    ]
    comment = table.attrs.get("comment", "").replace("α", "hardening").replace("≤", "<=")
    sections = [
        opening(case, doubts(table)),
        ViewSection(
            "", texts([*about, with_uncertainty(case, "the simulated confidence is that")])
        ),
        ViewSection("", texts([_simulated(table), _wanted(table)])),
        ViewSection(
            "By formula, the confidence of no pounding up to each time",
            [TableBlock.of(("time [s]", *formulas), rows)] if formulas else [],
        ),
        ViewSection("", texts(_cautions(table, case))),
        ViewSection("", [TextBlock(comment)]),
    ]
    return sections_with_inches(case, sections)


def _simulated(table: xr.Dataset) -> str:
    """The confidence by simulation, with its interval."""
    share, low, high = with_interval(table, f"{STEM}_simulated")
    ends = f"95{NBSP}% interval {low:.4f} to {high:.4f}"
    return f"Confidence of no pounding, simulated: {share:.4f} ({ends})."


def _wanted(table: xr.Dataset) -> str:
    """The gap for the wanted confidence, by formula and simulated."""
    simulated, low, high = with_interval(table, "required_gap_simulated")
    by_formula = f"{length(float(table.required_gap))} by formula, " if STEM in table else ""
    return (
        f"Gap for a confidence of {100 * table.attrs['confidence']:.4g}{NBSP}%: {by_formula}"
        f"{length(simulated)} simulated ({centimetres(low)} to {centimetres(high)})."
    )


def _cautions(table: xr.Dataset, case: Case) -> list[str]:
    """What the formulas do not contain, where that matters here."""
    cautions = []
    if "governing_height" in table:
        cautions.append(
            f"The formulas are for the worst height, {float(table.governing_height):.4g} m; the "
            "simulated confidence is for all heights at once."
        )
    if STEM in table and float(table[STEM][-1] - table[f"{STEM}_simulated_lower"]) > UNSAFE_EXCESS:
        cautions.append(UNRELIABLE)
    yields = any(building.structure.yields for building in pair_of(case))
    if (
        STEM in table
        and yields
        and "permanent_set_left_out" in table
        and table.permanent_set_left_out.any()
    ):
        end = f"{table.attrs['strong_shaking_end_s']:.3g} s"
        cautions.append(
            f"After {end} the formula no longer includes the permanent set of yielding buildings."
        )
    return cautions
