"""The frequency of pounding of a case, in words and as a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from stochlin.applications.risk.rates import range_of_rate
from stochlin.models.hazards import HazardCurve
from stochlin.views.separation.words import subject_of
from stochlin.views.shared.blocks import Block, TableBlock, TextBlock, texts
from stochlin.views.shared.words import (
    NBSP,
    NO_VALUE,
    along,
    centimetres,
    length,
    measure_of,
    per_cent,
    with_interval,
)

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.applications.cases.separation import CaseAnswer

LITTLE = 0.05  # of the rate, left out at either end
NOTICED = 0.1  # of the rate, or of the motions, that the hazard's table leaves out


def risk_blocks(answer: CaseAnswer) -> list[Block]:
    """The frequency of pounding for each gap of interest; empty where the case has no hazard."""
    table = answer.risk
    if table is None:
        return []
    heads = (
        "gap",
        "[cm]",
        "per year",
        "once in",
        f"in {table.attrs['risk_years']:g} years",
        "interval",
    )
    note = (
        f"From {table.attrs['risk_paths']} motions at each of {table.sizes['risk_intensity']} "
        f"intensities of the hazard; the intervals are those of their sampling, 95{NBSP}%, and "
        "include what shaking beyond the ends of the hazard can add. "
        "Different years are taken as independent."
    )
    rows = [_row(answer, of_gap) for of_gap in along(table, "risk_gap")]
    return [*texts(risk_sentences(answer)), TableBlock.of(heads, rows), TextBlock(note, "note")]


def _row(answer: CaseAnswer, risk: xr.Dataset) -> tuple[str, ...]:
    """A gap and its risk; of the gap for the allowed risk the interval, too."""
    gap = centimetres(float(risk.risk_gap))
    allowed = answer.case.wanted.risk
    names = {"existing": "existing", "answer": "the answer above", "target": f"for {allowed}"}
    if isinstance(allowed, float):
        names["target"] = f"for {allowed:g} per year"
    if risk.risk_of.item() == "target":
        ends = with_interval(risk, "risk_required_gap")[1:]
        gap = f"{gap} ({' to '.join(map(centimetres, ends))})"
    share, lower, upper = with_interval(risk, "risk_probability_in_years")
    interval = f"{per_cent(lower, 1)} to {per_cent(upper, 1)}"
    return names[str(risk.risk_of.item())], gap, *_frequency(risk), per_cent(share, 1), interval


def _frequency(risk: xr.Dataset) -> tuple[str, str]:
    """The annual frequency and return period; as a bound where the hazard leaves out much of it."""
    rate, _, most = with_interval(risk, "risk_annual_rate")
    unseen = float(risk.risk_annual_rate_unseen + risk.risk_annual_rate_unseen_weaker)
    if unseen > NOTICED * rate:
        return f"{rate:.2g} to {most:.2g}", f"{_years(most)} or more"
    return f"{rate:.2g}", _years(rate) if rate else NO_VALUE


def _years(rate: float) -> str:
    """The return period of an annual frequency, to two digits."""
    years = float(f"{1 / rate:.2g}")
    return f"{years:.0f}{NBSP}years" if years >= 1 else f"{years:g}{NBSP}years"


def risk_sentences(answer: CaseAnswer) -> list[str]:
    """The shaking that matters for the first of the gaps, and what the hazard leaves out."""
    assert answer.risk is not None
    risk = answer.risk.isel(risk_gap=0)
    meet = subject_of(answer.case).meet
    assert answer.case.site.hazard is not None
    name, units, unit = measure_of(answer.case.site.hazard)
    gap = f"With the gap of {length(float(risk.risk_gap))}"
    rate = float(risk.risk_annual_rate)
    beyond = float(risk.risk_annual_rate_unseen)
    sentences = [f"{gap}, {meet} in none of the motions, at any intensity of the hazard."]
    if rate:
        weaker, stronger = range_of_rate(risk, LITTLE)
        low = weaker / unit
        high = stronger / unit
        within = f"{low:.2g} to {high:.2g}" if low else f"less than {high:.2g}"
        within = within if np.isfinite(high) else f"more than {low:.2g}"
        sentences = [
            f"{gap}, nine tenths of the annual frequency come from shaking of {name} {within}"
            f"{NBSP}{units}."
        ]
    weakest = float(risk.risk_pounding_probability[0])
    if isinstance(answer.case.site.hazard, HazardCurve) and weakest > NOTICED:
        least = f"{float(risk.risk_intensity[0]) / unit:.2g}{NBSP}{units}"
        sentences.append(
            f"The hazard begins at {name} {least}, with which {meet} in {per_cent(weakest)} of the "
            "motions. Weaker shaking is left out, so that the true frequency is higher by up to "
            f"{float(risk.risk_annual_rate_unseen_weaker):.2g} a year, if the hazard goes on in a "
            "straight line in logarithms: start the table at lower intensities."
        )
    if beyond > NOTICED * rate:
        highest = f"{float(risk.risk_intensity[-1]) / unit:.2g}{NBSP}{units}"
        sentences.insert(
            0,
            f"The hazard curve ends at {name} {highest}. Stronger shaking could add up to "
            f"{beyond:.2g} a year to the frequency of pounding, which is in its interval: extend "
            "the table to rarer shaking.",
        )
    return sentences
