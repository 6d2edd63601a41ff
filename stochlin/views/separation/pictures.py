"""Pictures of an answer about a gap: one column wide, and for print in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stochlin.views.separation.rules import AT_LEAST, LESS, WITHIN, rows
from stochlin.views.separation.subjects import subject_of
from stochlin.views.shared.style import (
    CURVES,
    filled,
    legend_above,
    name_rows,
    open_frame,
    swatches,
)
from stochlin.views.shared.words import BEYOND, FAR, with_interval
from stochlin.views.sites.pictures import draw_spectrum

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.applications.cases.separation import CaseAnswer

WIDTH = 4.6  # inches: a phone shows it at three quarters of its size
NAME_WIDTH = 36  # characters of the name of a rule on one line
# Face, hatch: told apart in grey and in print.
VERDICTS = {
    "answer": ("#1b1b1b", ""),
    AT_LEAST: ("#c6d9ea", ""),
    LESS: ("#e0906a", "////"),
    WITHIN: ("#f2f2f2", "xx"),
    "no verdict": ("#ffffff", ""),
}
EDGE = "#1b1b1b"
DENSITY = "Power spectral density of the ground acceleration over period."
SPECTRUM = "Response spectra of the motions and of the target; below, the ratio with its 95 % interval."


def rules_figure(answer: CaseAnswer) -> Figure:
    """Gaps by rule, against the answer and its interval."""
    shown = [row for row in rows(answer) if row.verdict in VERDICTS]
    gaps = [100 * row.metres for row in shown]
    names = [filled([row.label], NAME_WIDTH) for row in shown]
    wide = any("\n" in name for name in names)
    pitch = 0.34 if wide else 0.235
    figure, axes = _blank(pitch * len(shown) + 1.35)
    place = np.arange(len(shown))
    right = 1.04 * _farthest(answer, gaps) or 1
    for at, (row, gap) in enumerate(zip(shown, gaps, strict=True)):
        face, hatch = VERDICTS[row.verdict]
        style: Any = {"color": face, "hatch": hatch, "edgecolor": EDGE, "lw": 0.6, "zorder": 2}
        axes.barh(at, min(gap, 2 * right), 0.68, **style)
        if gap > right:
            axes.text(0.98 * right, at, f"{row.gap} cm {BEYOND}", ha="right", va="center", size=9)
    _answer_line(axes, answer)
    name_rows(axes, place, names)
    axes.set(xlim=(0, right), xlabel=_axis(answer))
    verdicts = {row.verdict for row in shown}
    looks = {verdict: look for verdict, look in VERDICTS.items() if verdict in verdicts}
    figure.legend(
        handles=swatches(looks, EDGE), loc="outside upper center", ncols=3, fontsize=9,
        columnspacing=1.0, handlelength=1.4, handletextpad=0.5,
    )  # fmt: skip
    return figure


def distribution_figure(answer: CaseAnswer) -> Figure:
    """Probability of no pounding over the gap, in the motions and, if there are many, the records."""
    table, about = answer.separation, subject_of(answer.case)
    samples = 100 * np.sort(table.separation_samples.values)
    share = np.linspace(0, 1, 401)
    figure, axes = _blank(3.6)
    axes.plot(np.quantile(samples, share), share, color="0.1", zorder=3, label="motions")
    right = samples[-1]
    if answer.over_records is not None:
        records = 100 * table.record_separation.values
        axes.ecdf(records, color="#6b5d45", lw=1.6, label="records")
        right = max(right, records.max())
    if answer.existing is not None and (now := 100 * answer.existing.attrs["gap_m"]) < 1.6 * right:
        right = max(right, 1.3 * now)  # farther off it would squeeze the rest
        line: Any = {"color": "#2166ac", "lw": 1.2, "ls": (0, (6, 1.5, 1, 1.5))}
        axes.axvline(now, label=f"existing {about.gap}", **line)
    _answer_line(axes, answer)
    axes.axhline(answer.case.wanted.confidence, color="0.3", lw=0.9, ls=(0, (1, 1)), label="required")
    axes.set_yticks(np.arange(0, 1.01, 0.2), [f"{p:.0f} %" for p in np.arange(0, 101, 20)])
    axes.set(xlim=(0, 1.04 * right or 1), ylim=(0, 1.02), xlabel=_axis(answer), ylabel=about.good)
    legend_above(axes, 2, 9)
    return figure


def _farthest(answer: CaseAnswer, gaps: Iterable[float]) -> float:
    """The largest gap [cm] that is not so far off that it would squeeze the rest."""
    needed = 100 * float(answer.separation.gap[0])
    return max(gap for gap in gaps if gap <= FAR * needed) if needed > 0 else max(gaps)


def spectrum_figure(answer: CaseAnswer) -> Figure:
    """Spectrum of the site over period, with the periods of both buildings."""
    from matplotlib.ticker import NullFormatter, StrMethodFormatter

    spectrum = answer.spectrum
    if "target" in spectrum:
        return draw_spectrum(spectrum, False, answer.case.periods)
    figure, axes = _blank(3.3)
    period = spectrum.period.values
    axes.plot(period, spectrum.psd_ground, color=CURVES[1][0], label="ground")
    for n, building in enumerate(answer.case.buildings, start=1):
        color, dash = CURVES[0] if n == 1 else CURVES[2]
        axes.axvline(
            building.period,
            color=color,
            linestyle=(0, (1, 1)) if n == 1 else dash,
            label=f"building {n}",
        )
    axes.set_xscale("log")
    axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set(xlim=(period.min(), period.max()), ylim=(0, None))
    axes.yaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
    axes.set(xlabel="period [s]", ylabel="two-sided PSD [m$^2$/s$^3$]")
    legend_above(axes, 3, 9)
    return figure


def _axis(answer: CaseAnswer) -> str:
    return f"{subject_of(answer.case).gap} [cm]"


def _blank(height: float) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, height), layout="constrained")
    axes = figure.add_subplot()
    open_frame(axes)
    return figure, axes


def _answer_line(axes: Axes, answer: CaseAnswer) -> None:
    table = answer.separation
    low, high = (100 * end for end in with_interval(table.isel(rule=0), "gap")[1:])
    if np.isfinite(high):
        axes.axvspan(low, high, color="0.6", alpha=0.55, lw=0, zorder=1.5)
    line: Any = {"color": "#1b1b1b", "lw": 1.2, "ls": (0, (4, 2)), "zorder": 3}
    axes.axvline(100 * float(table.gap[0]), label="answer, 95 % interval", **line)
