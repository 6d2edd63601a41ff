"""Pictures of an answer about a gap: one column wide, and for print in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.optimize import isotonic_regression

from stochlin.views.separation.storeys import LINE, caption_of, draw_heights
from stochlin.views.separation.subjects import subject_of
from stochlin.views.separation.words import AT_LEAST, LESS, WITHIN, RuleLine, rows
from stochlin.views.shared.page import PAGE_STYLE
from stochlin.views.shared.style import (
    CURVES,
    filled,
    legend_above,
    name_rows,
    open_frame,
    styled,
    swatches,
)
from stochlin.views.shared.words import BEYOND, FAR, MISSING, with_interval
from stochlin.views.sites.pictures import draw_spectrum

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.analyses.cases.separation import CaseAnswer

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
NEAR, APART = 0.015, 0.038  # of the axis: gaps as near as this share a label; between labels


@styled(PAGE_STYLE)
def answer_figure(answer: CaseAnswer) -> Figure:
    """The picture that stands alone: over height where there are storeys, else the gaps by rule."""
    table = answer.table()
    if "height" in table.dims:
        return draw_heights(table)
    return rules_figure(answer, caption_of(table))


def rules_figure(answer: CaseAnswer, caption: str = "") -> Figure:
    """Gaps by rule, against the answer and its interval; below it the caption."""
    shown = [row for row in rows(answer) if row.verdict in VERDICTS]
    gaps = [100 * row.metres for row in shown]
    names = [filled([f"{row.number}  {row.label}"], NAME_WIDTH) for row in shown]
    wide = any("\n" in name for name in names)
    pitch = 0.34 if wide else 0.235
    foot = LINE * (caption.count("\n") + 2) if caption else 0.0
    height = pitch * len(shown) + 1.35 + foot
    figure, axes = _blank(height)
    figure.set_layout_engine("constrained", rect=(0, foot / height, 1, 1 - foot / height))
    figure.text(0.02, (foot - 0.5 * LINE) / height, caption, va="top", size=8.5, parse_math=False)
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
    """Probability of no pounding over the gap, with the gaps of the rules on it."""
    table, about = answer.separation, subject_of(answer.case)
    samples = 100 * np.sort(table.separation_samples.values)
    share = np.linspace(0, 1, 401)
    figure, axes = _blank(3.9)
    axes.plot(np.quantile(samples, share), share, color="0.1", zorder=3)
    shown = [row for row in rows(answer) if row.verdict in VERDICTS and row.probability != MISSING]
    gaps = {row.number: 100 * row.metres for row in shown}
    right = 1.06 * max(_farthest(answer, gaps.values()), samples[-1]) or 1
    now = 100 * answer.existing.attrs["gap_m"] if answer.existing is not None else np.inf
    if now < 1.6 * right:  # farther off it would squeeze the rest
        right = max(right, 1.3 * now)
        axes.axvline(now, color="#2166ac", lw=1.2, ls=(0, (6, 1.5, 1, 1.5)))
        axes.text(now + 0.01 * right, 0.02, f"existing {about.gap}", size=9, color="#1d4f86")
    axes.set(xlim=(0, right), ylim=(0, 1.02))
    far = [f"{row.number}: {row.gap} cm {BEYOND}" for row in shown if gaps[row.number] > right]
    axes.text(0.99 * right, 0.84, "\n".join(far), ha="right", va="top", size=9)
    shown = [row for row in shown if gaps[row.number] <= right]
    for row in shown:
        face, hatch = VERDICTS[row.verdict]
        chance = float(table.no_pounding_probability.sel(rule=row.rule))
        style: Any = {"color": face, "mec": EDGE, "mew": 0.8, "ls": "", "zorder": 4}
        axes.plot(gaps[row.number], chance, marker="s" if hatch else "o", ms=5.5, **style)
    _rule_numbers(axes, shown, gaps, right)
    confidence = answer.case.wanted.confidence
    axes.axhline(confidence, color="0.3", lw=0.9, ls=(0, (4, 2)))
    axes.text(0.01 * right, confidence + 0.015, f"{100 * confidence:g} %", size=9, color="0.2")
    axes.set_yticks(np.arange(0, 1.01, 0.2), [f"{p:.0f} %" for p in np.arange(0, 101, 20)])
    axes.set(xlabel=_axis(answer), ylabel=about.good)
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


def records_figure(answer: CaseAnswer) -> Figure:
    """Gaps that the recorded motions would have needed, against the answer; numbered as in the text."""
    gaps = 100 * answer.separation.record_separation.values
    if answer.over_records is not None:
        return _many_records(answer, gaps)
    figure, axes = _blank(0.3 * len(gaps) + 1.35)
    place = np.arange(len(gaps))
    axes.barh(place, gaps, 0.6, color="#d9d3c7", edgecolor=EDGE, lw=0.6, zorder=2)
    _answer_line(axes, answer)
    name_rows(axes, place, _named(answer.case.site.records))
    axes.set(xlim=(0, 1.04 * max(*gaps, 100 * float(answer.separation.gap[0])) or 1))
    axes.set(xlabel=_axis(answer))
    legend_above(axes, 3, 9)
    return figure


def _named(records: Iterable[str]) -> list[str]:
    """Names of records with their numbers; a dollar sign begins no formula."""
    numbered = (f"{n}  {name}".replace("$", r"\$") for n, name in enumerate(records, start=1))
    return [filled([label], NAME_WIDTH) for label in numbered]


def _many_records(answer: CaseAnswer, gaps: np.ndarray) -> Figure:
    """Share of the records for which a gap would have been enough, against the answer."""
    figure, axes = _blank(3.3)
    axes.ecdf(gaps, color="#6b5d45", lw=1.6, label="records")
    _answer_line(axes, answer)
    right = 1.04 * max(*gaps, 100 * float(answer.separation.gap[0])) or 1
    axes.set(xlim=(0, right), ylim=(0, 1.02), xlabel=_axis(answer), ylabel="share of the records")
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
    axes.axvline(100 * float(table.gap[0]), label="the answer, with its 95 % interval", **line)


def _rule_numbers(axes: Axes, shown: list[RuleLine], gaps: dict[int, float], right: float) -> None:
    """Numbers of the rules in a row above the curve, those at one gap together, each led to its gap."""
    groups: list[list[RuleLine]] = []
    for row in sorted(shown, key=lambda row: gaps[row.number]):
        if groups and gaps[row.number] - gaps[groups[-1][0].number] < NEAR * right:
            groups[-1].append(row)
        else:
            groups.append([row])
    at = [float(np.mean([gaps[row.number] for row in group])) for group in groups]
    apart = APART * right * np.arange(len(groups))
    place = isotonic_regression(np.array(at) - apart).x + apart  # as near as labels can stand
    for gap, label, group in zip(at, place, groups, strict=True):
        text = ", ".join(str(number) for number in sorted(row.number for row in group))
        line: Any = {"color": "0.6", "lw": 0.6, "clip_on": False, "zorder": 1}
        axes.plot([gap, gap, label], [1.0, 1.05, 1.1], **line)
        axes.text(label, 1.11, text, size=8.5, rotation=90, ha="center", va="bottom")
