"""The frequency of pounding of a case: in words, as a table, and by the strength of the shaking."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import constants

from stochlin.applications.risk.rates import range_of_rate, shares_of_rate
from stochlin.models.hazards import HazardCurve
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.blocks import Block, Table, Text, texts
from stochlin.views.shared.style import decade_ticks, open_frame
from stochlin.views.shared.symbols import typeset
from stochlin.views.shared.words import (
    MISSING,
    SPACE,
    along,
    centimetres,
    length,
    per_cent,
    with_interval,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from stochlin.applications.cases.separation import CaseAnswer

GAPS = {"existing": "existing", "answer": "the answer above", "target": "for the risk allowed"}
SIZE = (4.6, 4.4)  # inches
LITTLE = 0.05  # of the rate, left out at either end
NOTICED = 0.1  # of the rate, or of the motions, that the hazard's table leaves out


def risk_blocks(answer: CaseAnswer) -> list[Block]:
    """The frequency of pounding for each gap of interest; empty where the case has no hazard."""
    table = answer.risk
    if table is None:
        return []
    rows = [_row(of_gap) for of_gap in along(table, "risk_gap")]
    heads = ("gap", "[cm]", "per year", "once in", f"in {table.attrs['risk_years']:g} years", "interval")
    note = (
        f"From {table.attrs['risk_paths']} motions at each of {table.sizes['risk_intensity']} "
        f"intensities of the hazard; the intervals, of 95{SPACE}%, are those of their sampling. "
        "Different years are taken as independent."
    )
    return [*texts(risk_sentences(answer)), Table.of(heads, rows), Text(note, "note")]


def risk_figure(answer: CaseAnswer) -> Figure:
    """Above, the probability of pounding by intensity; below, the share of the rate by intensity."""
    from matplotlib.figure import Figure

    assert answer.risk is not None
    risk, (name, units, unit) = answer.risk.isel(risk_gap=0), _measure(answer)
    figure = Figure(figsize=SIZE, layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    x = risk.risk_intensity.values / unit
    ends = [100 * risk[f"risk_pounding_probability_{end}"] for end in ("lower", "upper")]
    above.fill_between(x, *ends, color="0.75", lw=0, label="95 % interval")
    above.plot(x, 100 * risk.risk_pounding_probability, color="0.1", marker="o", ms=3, label="simulated")
    bad = "across the line" if answer.case.alone else "with pounding"
    above.set(ylim=(-2, 102), ylabel=f"motions\n{bad} [%]")
    above.legend(loc="upper left", fontsize=9)
    edges, share = shares_of_rate(risk)
    # What is weaker or stronger than all that is simulated is as wide as the interval beside it.
    first, last = edges[1] ** 2 / edges[2], edges[-2] ** 2 / edges[-3]
    edges = np.array([first, *edges[1:-1], last]) / unit
    style: Any = {"color": "0.8", "edgecolor": "0.1", "lw": 0.6, "zorder": 2}
    below.bar(edges[:-1], 100 * share, np.diff(edges), align="edge", **style)
    below.set(
        xscale="log",
        xlim=(edges[0], edges[-1]),
        xlabel=typeset(f"{name} [{units}]"),
        ylabel="share of the\nfrequency [%]",
    )
    decade_ticks(below.xaxis)
    open_frame(above)
    open_frame(below)
    return figure


def risk_caption(answer: CaseAnswer) -> str:
    """The caption of the picture."""
    assert answer.risk is not None
    return (
        f"With {length(float(answer.risk.risk_gap[0]))}, by intensity: above the share of motions in "
        f"which {subject_of(answer.case).meet}, below that of the annual frequency; the outermost bars "
        "contain all weaker and stronger shaking."
    )


def _row(risk: xr.Dataset) -> tuple[str, ...]:
    rate = float(risk.risk_annual_rate)
    share, low, high = (per_cent(value, 1) for value in with_interval(risk, "risk_probability_in_years"))
    return (
        GAPS[str(risk.risk_of.item())],
        centimetres(float(risk.risk_gap)),
        f"{rate:.2g}",
        _years(rate),
        share,
        f"{low} to {high}",
    )


def _years(rate: float) -> str:
    return f"{float(f'{1 / rate:.2g}'):.0f}{SPACE}years" if rate else MISSING


def risk_sentences(answer: CaseAnswer) -> list[str]:
    """The shaking that matters for the first of these gaps, and the gap for the risk allowed."""
    table = answer.risk
    assert table is not None
    about, risk = subject_of(answer.case), table.isel(risk_gap=0)
    which = "existing" if risk.risk_of.item() == "existing" else "required"
    gap = f"the {which} {about.gap} of {length(float(risk.risk_gap))}"
    sentences = [f"With {gap} {about.meet} in none of the motions, at any intensity of the hazard."]
    if float(risk.risk_annual_rate):
        sentences = [_strongest(answer, risk, gap)]
    if "risk_required_gap" in table:
        needed, *ends = with_interval(table, "risk_required_gap")
        sentences.append(
            f"For the risk allowed, {_allowed(answer)}, the {about.gap} is {length(needed)} "
            f"({' to '.join(map(centimetres, ends))})."
        )
    return sentences + _left_out(answer, risk)


def _allowed(answer: CaseAnswer) -> str:
    risk = answer.case.wanted.risk
    return f"{risk:g} per year (once in {_years(risk)})" if isinstance(risk, float) else str(risk)


def _left_out(answer: CaseAnswer, risk: xr.Dataset) -> list[str]:
    """The part beyond the table of the hazard, where it could be large."""
    sentences, rate, weakest = [], float(risk.risk_annual_rate), float(risk.risk_pounding_probability[0])
    name, units, unit = _measure(answer)
    if isinstance(answer.case.site.hazard, HazardCurve) and weakest > NOTICED:
        least = f"{float(risk.risk_intensity[0]) / unit:.2g}{SPACE}{units}"
        sentences.append(
            f"The hazard begins at {name} {least}, with which {subject_of(answer.case).meet} in "
            f"{per_cent(weakest)} of the motions. Weaker shaking is left out, so that the true "
            "frequency is higher: start the table at lower intensities."
        )
    if float(risk.risk_annual_rate_unseen) > NOTICED * rate:
        sentences.append(
            "Shaking stronger than that of the hazard table could add up to "
            f"{float(risk.risk_annual_rate_unseen):.2g} a year: extend the table to rarer shaking."
        )
    return sentences


def _strongest(answer: CaseAnswer, risk: xr.Dataset, gap: str) -> str:
    """The intensities that contribute nine tenths of the rate."""
    name, units, unit = _measure(answer)
    low, high = (end / unit for end in range_of_rate(risk, LITTLE))
    within = f"{low:.2g} to {high:.2g}{SPACE}{units}" if low else f"less than {high:.2g}{SPACE}{units}"
    if not np.isfinite(high):
        within = f"more than {low:.2g}{SPACE}{units}"
    return f"With {gap}, nine tenths of the annual frequency come from shaking of {name} {within}."


def _measure(answer: CaseAnswer) -> tuple[str, str, float]:
    """The name of the intensity of the hazard, its unit, and that in SI."""
    hazard = answer.case.site.hazard
    assert hazard is not None
    if hazard.measure == "intensity":
        return "S0", "m²/s³", 1.0
    name = "PGA" if hazard.period is None else f"Sa({hazard.period:.3g} s)"
    return name, "g", constants.g
