"""The first picture of the page: buildings to scale, gaps, and how often they are enough."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stochlin.views.separation.words import (
    SHARE,
    confidence,
    judged,
    meeting_level,
    needed,
    own_codes,
    share_of,
    subject_of,
)
from stochlin.views.shared.blocks import Picture
from stochlin.views.shared.page import PAGE_STYLE
from stochlin.views.shared.screen import cut
from stochlin.views.shared.style import AS_GIVEN, CURVES, filled, styled
from stochlin.views.shared.words import FAR, length, with_interval

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.applications.cases.reading.buildings import Building
    from stochlin.applications.cases.separation import CaseAnswer

WIDTH, FACADE, BETWEEN = 4.6, 1.55, 1.5  # inches: of all, of a building, of what is between both
HEAD, TALL, ROW, BAR = 0.4, 1.75, 0.34, 0.78  # inches: names, buildings, a gap, the shares
LEGEND = 0.26  # inches
SIZE = 9  # points
NAME, LABEL = 22, 24  # characters of a name, and of the words beside a gap
EMPTY = 10.0  # m: the height that a building is drawn with where none is known
CENTIMETRES = 100.0
EDGE, FACES, GREY = "#1b1b1b", ("#e8e2d4", "#d3dde8"), "0.6"
APART, POUND = ("#c6d9ea", ""), ("#e0906a", "////")


class Dimension(NamedTuple):
    """A gap as a dimension line below the buildings [m], with the ends of its interval."""

    label: str
    gap: float
    note: str = ""
    low: float = np.nan
    high: float = np.nan


def elevation_picture(answer: CaseAnswer) -> Picture:
    """The picture with its title and what it shows in words."""
    about = subject_of(answer.case)
    caption = (
        f"Heights and {about.gap}s have scales of their own. Grey: 95 % interval. Dashed: peak "
        f"displacements, not exceeded in {confidence(answer.case)} of the motions"
    )
    caption += "." if answer.case.alone else ", hardly ever both at one time."
    if answer.case.slabs:
        caption += " Crosses: slabs that meet columns."
    title = f"{about.the_buildings.capitalize()} and the {about.gap}"
    return Picture(title, caption, partial(elevation_figure, answer), beside=True)


@styled(PAGE_STYLE | AS_GIVEN)
def elevation_figure(answer: CaseAnswer) -> Figure:
    """Buildings with floors and displacements, gaps as dimension lines, and the share of motions."""
    from matplotlib.figure import Figure

    gaps = dimensions(answer)
    inches = {"shares": BAR, "gaps": ROW * len(gaps) + LEGEND, "buildings": TALL}
    height = sum(inches.values()) + HEAD
    figure, foot, panels = Figure(figsize=(WIDTH, height)), 0.0, {}
    for name, own in inches.items():
        panels[name] = figure.add_axes((0, foot / height, 1, own / height))
        panels[name].axis("off")
        foot += own
    right = _reach(answer, gaps)
    ends = -FACADE / BETWEEN * right, (1 + FACADE / BETWEEN) * right
    for name in ("gaps", "buildings"):
        panels[name].set_xlim(*ends)
    _draw_buildings(panels["buildings"], answer, ends)
    _draw_gaps(panels["gaps"], gaps, standing(answer), right)
    handles = panels["buildings"].get_legend_handles_labels()[0]
    panels["gaps"].legend(
        handles=handles, loc="lower left", ncols=2, fontsize=SIZE, handlelength=2.4, handletextpad=0.5,
        columnspacing=1.0, borderaxespad=0, borderpad=0.2,
    )  # fmt: skip
    _draw_shares(panels["shares"], answer)
    return figure


def standing(answer: CaseAnswer) -> float:
    """How far apart the buildings are drawn [m]: the existing gap, without one the required gap."""
    if answer.existing is None:
        return float(answer.separation.gap[0].fillna(0.0))
    return float(answer.existing.attrs["gap_m"])


def dimensions(answer: CaseAnswer) -> list[Dimension]:
    """The existing gap, the required one, and those of the codes that the case file names."""
    about, table, lines = subject_of(answer.case), answer.separation, []
    if answer.existing is not None:
        now = standing(answer)
        lines.append(Dimension(f"existing {about.gap}\n{length(now)}", now, judged(answer)))
    gap, low, high = with_interval(table.isel(rule=0), "gap")
    ends = f"\n({needed(answer).partition(';')[0]})" if np.isfinite(gap) else ""
    of_motions = f"in {confidence(answer.case)} of motions"
    lines.append(Dimension(f"required {length(gap)}{ends}", gap, of_motions, low, high))
    for row in own_codes(answer):
        size = f"\n{length(row.metres)}" if np.isfinite(row.metres) else ""
        lines.append(Dimension(f"{row.label}{size}", row.metres, row.verdict))
    return lines


def _reach(answer: CaseAnswer, gaps: list[Dimension]) -> float:
    """The length between both buildings that is drawn [cm]; gaps far beyond the answer are not."""
    table = answer.separation
    near = [line.gap for line in gaps if line.gap <= FAR * float(table.gap[0])]
    ends = [standing(answer), *near, *(line.high for line in gaps if np.isfinite(line.high))]
    peaks = (float(table[f"peak_{n}"]) for n in range(1, len(answer.case.buildings) + 1))
    return CENTIMETRES * max([*ends, *peaks]) or 1.0


def _draw_buildings(axes: Axes, answer: CaseAnswer, ends: tuple[float, float]) -> None:
    """Both buildings, or one and its property line, and slabs that meet columns."""
    case, apart = answer.case, CENTIMETRES * standing(answer)
    heights = [building.height or EMPTY for building in case.buildings]
    faces = [0.0, apart]
    for n, building in enumerate(case.buildings):
        _draw_building(axes, building, heights[n], FACES[n], faces[n], ends[n])
        displaced, levels = _displaced(answer, n + 1, min(heights))
        away = faces[n] + displaced if n == 0 else faces[n] - displaced
        label = f"peak {length(displaced[-1] / CENTIMETRES)}{meeting_level(answer)}"
        style: Any = {"color": CURVES[n + 1][0], "ls": (0, (4, 1.5)), "marker": "os"[n], "label": label}
        axes.plot(away, levels, lw=1.4, ms=3, zorder=4, clip_on=False, **style)
    if case.alone:
        axes.plot([apart, apart], [0, heights[0]], color=EDGE, lw=1.2, ls=(0, (8, 2, 1, 2)))
        axes.text(apart, 1.02 * heights[0], "property\nline", ha="center", va="bottom", size=SIZE)
    for slab in case.slabs:
        axes.plot(faces[slab.column_of - 1], slab.level, "x", color=EDGE, ms=5, zorder=5)
    axes.axhline(0, color=EDGE, lw=2.0, zorder=3)
    axes.set_ylim(0, max(heights))


def _draw_building(
    axes: Axes, building: Building, height: float, color: str, face: float, far: float
) -> None:
    """A building from its face on, with its floors, those of an oscillator dotted, and its name."""
    axes.fill([far, face, face, far], [0, 0, height, height], color=color, lw=0, zorder=1)
    axes.plot([far, face, face], [height, height, 0], color=EDGE, lw=1.2, zorder=2)
    dash: Any = "-" if building.has_storeys else (0, (1, 2))
    axes.hlines(_floors(building), face, far, color="0.45", lw=0.7, ls=dash, zorder=2)
    height_text = f"{height:.4g} m" if building.height else "height not given"
    name = f"{cut(building.name, NAME)}\n{height_text}"
    axes.text((face + far) / 2, 1.02 * height, name, ha="center", va="bottom", size=SIZE)


def _floors(building: Building) -> np.ndarray:
    """Levels of the floors [m]; of an oscillator as if its storeys were equal, if they are known."""
    if building.has_storeys:
        levels: np.ndarray = building.structure.levels()
        return levels
    if building.storeys is None or building.height is None:
        return np.empty(0)
    return np.linspace(0, building.height, building.storeys + 1)[1:]


def _displaced(answer: CaseAnswer, number: int, meeting: float) -> tuple[np.ndarray, np.ndarray]:
    """Peak displacements of a building [cm], and the levels where they are known [m]."""
    table = answer.separation
    if "height" in table.dims:
        peaks, levels = table[f"peak_at_height_{number}"].values, table.height.values
    else:
        peaks, levels = np.array([float(table[f"peak_{number}"])]), np.array([meeting])
    return CENTIMETRES * np.append(0.0, peaks), np.append(0.0, levels)


def _draw_gaps(axes: Axes, gaps: list[Dimension], apart: float, right: float) -> None:
    """A dimension line for each gap, its words to the left, the verdict to the right."""
    axes.set_ylim(len(gaps) - 0.5 + LEGEND / ROW, -0.5)
    places = 0.0, CENTIMETRES * apart
    axes.vlines(places, -0.5, len(gaps) - 0.5, color="0.5", lw=0.7, ls=(0, (1, 1.5)), zorder=1)
    low, high = axes.get_xlim()
    for row, line in enumerate(gaps):
        gap = CENTIMETRES * line.gap
        if np.isfinite(line.low):
            far = line.high if np.isfinite(line.high) else right / CENTIMETRES
            ends = [CENTIMETRES * line.low, CENTIMETRES * far]
            axes.plot(ends, [row, row], color=GREY, lw=7, solid_capstyle="butt", zorder=2)
        if np.isfinite(gap):
            drawn: Any = {"color": EDGE, "lw": 1.1, "ms": 9, "zorder": 3}
            axes.plot([0, min(gap, right)], [row, row], marker="|", **drawn)
        if gap > right:
            axes.plot(right, row, color=EDGE, marker=">", ms=6)
        style: Any = {"va": "center", "size": SIZE, "linespacing": 1.0}
        axes.text(low + 0.01 * (high - low), row, line.label, **style)
        axes.text(high - 0.01 * (high - low), row, filled([line.note], LABEL), ha="right", **style)


def _draw_shares(axes: Axes, answer: CaseAnswer) -> None:
    """A bar of all motions: those in which the gap is enough, with the interval, and the others."""
    about, now = subject_of(answer.case), answer.existing
    table = answer.separation.isel(rule=0) if now is None else now
    enough, *ends = (100 * value for value in with_interval(table, SHARE))
    axes.set(xlim=(-4, 104), ylim=(-1.15, 1.5))
    for left, wide, (face, hatch) in ((0, enough, APART), (enough, 100 - enough, POUND)):
        axes.barh(0, wide, 0.8, left, color=face, hatch=hatch, edgecolor=EDGE, lw=0.7)
    axes.plot(ends, [0, 0], color=EDGE, lw=2.5, solid_capstyle="butt")
    required = 100 * answer.case.wanted.confidence
    axes.plot([required, required], [-0.6, 0.6], color=EDGE, lw=1.2, ls=(0, (3, 1.5)))
    axes.text(required, -0.62, f"required {confidence(answer.case)}", ha="right", va="top", size=SIZE)
    which = "required" if now is None else "existing"
    title = f"{about.good.capitalize()}, {which} {about.gap}: {share_of(table)}"
    axes.text(-2.5, 0.62, title, va="bottom", size=SIZE)
    axes.text(0, -0.62, f"hatched: {about.meet}", va="top", size=SIZE)
