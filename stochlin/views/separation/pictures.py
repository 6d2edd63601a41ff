"""Pictures of an answer about a gap, one column wide, for print in grey; the first is to scale."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stochlin.messages import plain
from stochlin.views.separation.words import (
    NO_POUNDING,
    confidence,
    contact_level,
    gap_of,
    judged,
    needed,
    own_codes,
    share_of,
    subject_of,
)
from stochlin.views.shared.blocks import Picture
from stochlin.views.shared.inches import inches, with_inches
from stochlin.views.shared.page import PAGE_STYLE
from stochlin.views.shared.style import (
    AS_GIVEN,
    CAPTION_LINE,
    CAPTION_WIDTH,
    COLUMN_WIDTH,
    CURVES,
    caption_of,
    filled,
    legend_above,
    open_frame,
    styled,
)
from stochlin.views.shared.words import CENTIMETRES, length, rule_label, with_interval

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.applications.cases.reading.buildings import Building
    from stochlin.applications.cases.separation import CaseAnswer

PANEL_WITH_LEGEND = 3.4  # inches: of a panel with its axis and legend
# beside the simulation, where they are known
FORMULAS_DRAWN = ("eq_3_linearized", "linearization", "srss")
GREY = "0.75"
FACADE = 1.55  # inches: of a building
BETWEEN_FACADES = 1.5  # of what is between both
NAMES_HEIGHT = 0.4  # inches: of names
TALL = 1.75  # of buildings
GAP_ROW = 0.34  # of a gap
GAP_ROW_WITH_INCHES = 0.5
BAR = 0.78  # of the shares
LEGEND = 0.19  # inches: of a line
SIZE = 9  # points
BUILDING_NAME_WIDTH = 22  # characters of a name
LABEL = 24  # of the words beside a gap
# times the required gap: gaps beyond are told at the border of the picture, not drawn
LARGEST_GAP_DRAWN = 2.5
EMPTY = 10.0  # m: the height that a building is drawn with where none is known
EDGE_COLOR = "#1b1b1b"
FACES = ("#e8e2d4", "#d3dde8")
INTERVAL = "0.6"
LOOK_APART = ("#c6d9ea", "")
LOOK_POUNDING = ("#e0906a", "////")


def distribution_figure(answer: CaseAnswer) -> Figure:
    """Probability of no pounding over the gap, in the motions and, if many, the records."""
    table = answer.separation
    about = subject_of(answer.case)
    samples = CENTIMETRES * np.sort(table.separation_samples.values)
    share = np.linspace(0, 1, 401)
    figure, axes = _panel()
    axes.plot(np.quantile(samples, share), share, color="0.1", zorder=3, label="motions")
    right = samples[-1]
    if answer.over_records is not None:
        records = CENTIMETRES * table.record_separation.values
        axes.ecdf(records, color="#6b5d45", lw=1.6, label="records")
        right = max(right, records.max())
    if answer.existing is not None and (now := 100 * answer.existing.attrs["gap_m"]) < 1.6 * right:
        right = max(right, 1.3 * now)  # farther off it would squeeze the rest
        line: Any = {"color": "#2166ac", "lw": 1.2, "ls": (0, (6, 1.5, 1, 1.5))}
        axes.axvline(now, label=f"existing {about.gap}", **line)
    gap, low, high = (CENTIMETRES * end for end in with_interval(table.isel(rule=0), "gap"))
    if np.isfinite(high):
        axes.axvspan(low, high, color=GREY, lw=0, zorder=1.5)
    axes.axvline(gap, color="0.1", lw=1.2, ls=(0, (4, 2)), label="answer, 95 % interval")
    axes.axhline(
        answer.case.wanted.confidence, color="0.3", lw=0.9, ls=(0, (1, 1)), label="required"
    )
    axes.set_yticks(np.arange(0, 1.01, 0.2), [f"{p:.0f} %" for p in np.arange(0, 101, 20)])
    axes.set(xlim=(0, 1.04 * right or 1), ylim=(0, 1.02))
    axes.set(xlabel=f"{about.gap} [cm]", ylabel=about.good)
    legend_above(axes, 2, 9)
    return figure


@styled(AS_GIVEN | {"font.size": 10})
def draw_heights(dataset: xr.Dataset, caption: bool = True) -> Figure:
    """Draw the result of `stochlin.separation` for buildings with storeys.

    Parameters
    ----------
    dataset : xarray.Dataset
        The result for one pair, at least one of them a ``ShearBuilding``, or for one building; from
        memory or as ``stochlin gap`` saves it.
    caption : bool
        Whether to describe the case below the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The gap that is needed at each height, by simulation with its 95 % interval and by formulas,
        and the height that governs.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    if dataset.sizes.get("height", 0) < 2 or set(dataset.gap.dims) != {"rule"}:
        what = f"dataset has the dimensions {dict(dataset.sizes)}"
        raise ValueError(
            f"{what}; allowed: the separation of one pair that meets at several heights"
        )
    text = caption_of(dataset, CAPTION_WIDTH) if caption else ""
    figure, axes = _panel(CAPTION_LINE * len(text.splitlines()))
    _gaps(axes, dataset)
    legend_above(axes)
    axes.set(xlim=(0, None))
    figure.supxlabel(text, x=0.02, ha="left", size=8.5)
    return figure


def _panel(foot: float = 0.0) -> tuple[Figure, Axes]:
    """A figure with one panel, and so many inches below it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(COLUMN_WIDTH, PANEL_WITH_LEGEND + foot), layout="constrained")
    axes = figure.add_subplot()
    open_frame(axes)
    return figure, axes


def _gaps(axes: Axes, dataset: xr.Dataset) -> None:
    """The gap from the ground to each height, by simulation with its interval and by formulas."""
    heights = np.append(0.0, dataset.height.values)

    def at_height(name: str, rule: str) -> np.ndarray:
        return np.append(0.0, CENTIMETRES * dataset[name].sel(rule=rule).values)

    rules = "simulation", *FORMULAS_DRAWN
    for rule, (color, dash), marker in zip(rules, CURVES, "o^vD", strict=False):
        if not np.isfinite(dataset.gap.sel(rule=rule)):
            continue
        style: Any = {"color": color, "linestyle": dash, "marker": marker, "ms": 4, "lw": 1.3}
        style["markerfacecolor"] = color if rule == "simulation" else "none"
        label = "simulated" if rule == "simulation" else rule_label(rule)
        axes.plot(at_height("gap_at_height", rule), heights, label=label, **style)
    low = at_height("gap_at_height_lower", "simulation")
    high = at_height("gap_at_height_upper", "simulation")
    if np.isfinite(high).all():
        axes.fill_betweenx(heights, low, high, color=GREY, lw=0, label="95 % interval")
    governs = float(dataset.governing_height.sel(rule="simulation"))
    style = {"color": "0.35", "lw": 0.8, "ls": (0, (1, 1.5))}
    axes.axhline(governs, label=f"governs: {governs:.4g} m up", **style)
    whole = CENTIMETRES * float(dataset.gap.sel(rule="simulation"))
    axes.axvline(whole, color="0.1", lw=0.9, ls=(0, (4, 2)), label="one for all heights")
    if "existing_gap_m" in dataset.attrs:
        now = CENTIMETRES * float(dataset.attrs["existing_gap_m"])
        style = {"color": "0.35", "lw": 1.0, "ls": (0, (8, 2, 1, 2, 1, 2))}
        axes.axvline(now, label=f"existing {gap_of(dataset)}", **style)
    share = f"{100 * float(dataset.attrs['confidence']):.4g} %"
    quantity = f"{gap_of(dataset)} [cm] not exceeded in {share} of the motions"
    axes.set(ylabel="height [m]", xlabel=quantity, ylim=(0, 1.04 * heights[-1]))


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
        "displacements."
    )
    if not answer.case.alone:
        caption += " Both buildings rarely reach them at the same time."
    if answer.case.slabs:
        caption += " Crosses: slabs that meet columns."
    title = f"{about.the_buildings.capitalize()} and the {about.gap}"
    return Picture(title, caption, partial(elevation_figure, answer), beside=True)


@styled(PAGE_STYLE | AS_GIVEN)
def elevation_figure(answer: CaseAnswer) -> Figure:
    """Buildings with floors and displacements, gaps as dimension lines and the share of motions."""
    from matplotlib.figure import Figure

    gaps = dimensions(answer)
    legend = LEGEND * (len(answer.case.buildings) + 1)
    row = GAP_ROW_WITH_INCHES if answer.case.in_inches else GAP_ROW
    heights = (TALL, row * len(gaps) + legend, BAR)
    height = sum(heights) + NAMES_HEIGHT
    figure = Figure(figsize=(COLUMN_WIDTH, height))
    whole = {"left": 0, "right": 1, "bottom": 0, "hspace": 0}
    grid = whole | {"top": 1 - NAMES_HEIGHT / height, "height_ratios": heights}
    above, below, shares = figure.subplots(3, 1, gridspec_kw=grid)
    right = _reach(answer, gaps)
    ends = -FACADE / BETWEEN_FACADES * right, (1 + FACADE / BETWEEN_FACADES) * right
    for axes in figure.axes:
        axes.axis("off")
        axes.set_xlim(*ends)
    _draw_buildings(above, answer, ends)
    below.set_ylim(len(gaps) - 0.5 + legend / row, -0.5)
    _draw_gaps(below, gaps, drawn_gap(answer), right)
    below.legend(
        handles=above.get_legend_handles_labels()[0], loc="lower left",
        fontsize=SIZE, title_fontsize=SIZE,
        title=f"peak displacement, not exceeded in {confidence(answer.case)} of motions",
        alignment="left", labelspacing=0.2, handlelength=2.4, handletextpad=0.5, borderaxespad=0,
        borderpad=0.2,
    )  # fmt: skip
    _draw_shares(shares, answer)
    return figure


def drawn_gap(answer: CaseAnswer) -> float:
    """How far apart the buildings are drawn [m]: the existing gap, without one the required gap."""
    if answer.existing is None:
        return float(answer.separation.gap[0].fillna(0.0))
    return float(answer.existing.attrs["gap_m"])


def dimensions(answer: CaseAnswer) -> list[Dimension]:
    """The existing gap, the required one, and those of the codes that the case file names."""
    about = subject_of(answer.case)
    table = answer.separation
    lines = []
    if answer.existing is not None:
        now = drawn_gap(answer)
        lines.append(Dimension(f"existing {about.gap}\n{length(now)}", now, judged(answer)))
    gap, low, high = with_interval(table.isel(rule=0), "gap")
    ends = f"\n({needed(answer).partition(';')[0]})" if np.isfinite(gap) else ""
    of_motions = f"in {confidence(answer.case)} of motions"
    lines.append(Dimension(f"required {length(gap)}{ends}", gap, of_motions, low, high))
    for row in own_codes(answer):
        size = f"\n{length(row.metres)}" if np.isfinite(row.metres) else ""
        lines.append(Dimension(f"{row.label}{size}", row.metres, row.verdict))
    if not answer.case.in_inches:
        return lines
    return [line._replace(label=f"{line.label}\n{inches(line.gap)}") for line in lines]


def _reach(answer: CaseAnswer, gaps: list[Dimension]) -> float:
    """The length between both buildings that is drawn [cm]; gaps far beyond the answer are not."""
    table = answer.separation
    near = [line.gap for line in gaps if line.gap <= LARGEST_GAP_DRAWN * float(table.gap[0])]
    ends = [drawn_gap(answer), *near, *(line.high for line in gaps if np.isfinite(line.high))]
    peaks = (float(table[f"peak_{n}"]) for n in range(1, len(answer.case.buildings) + 1))
    return CENTIMETRES * max([*ends, *peaks]) or 1.0


def _draw_buildings(axes: Axes, answer: CaseAnswer, ends: tuple[float, float]) -> None:
    """Both buildings, or one and its property line, and slabs that meet columns."""
    case = answer.case
    apart = CENTIMETRES * drawn_gap(answer)
    heights = [building.height or EMPTY for building in case.buildings]
    faces = [0.0, apart]
    for n, building in enumerate(case.buildings):
        _draw_building(axes, building, heights[n], FACES[n], faces[n], ends[n])
        name = with_inches(case, _name(building))
        middle = (faces[n] + ends[n]) / 2
        axes.text(middle, 1.02 * heights[n], name, ha="center", va="bottom", size=SIZE)
        displaced, levels = _displaced(answer, n + 1, min(heights))
        away = faces[n] + displaced if n == 0 else faces[n] - displaced
        size = f"{length(displaced[-1] / CENTIMETRES)}{contact_level(answer)}"
        label = f"{plain(building.name, BUILDING_NAME_WIDTH)}: {with_inches(case, size)}"
        style: Any = {
            "color": CURVES[n + 1][0],
            "ls": (0, (4, 1.5)),
            "marker": "os"[n],
            "label": label,
        }
        axes.plot(away, levels, lw=1.4, ms=3, zorder=4, clip_on=False, **style)
    if case.alone:
        axes.plot([apart, apart], [0, heights[0]], color=EDGE_COLOR, lw=1.2, ls=(0, (8, 2, 1, 2)))
        axes.text(apart, 1.02 * heights[0], "property\nline", ha="center", va="bottom", size=SIZE)
    for slab in case.slabs:
        axes.plot(faces[slab.column_of - 1], slab.level, "x", color=EDGE_COLOR, ms=5, zorder=5)
    axes.axhline(0, color=EDGE_COLOR, lw=2.0, zorder=3)
    axes.set_ylim(0, max(heights))


def _draw_building(
    axes: Axes, building: Building, height: float, color: str, face: float, far: float
) -> None:
    """A building from its face on, with its floors, those of an oscillator dotted."""
    axes.fill([far, face, face, far], [0, 0, height, height], color=color, lw=0, zorder=1)
    axes.plot([far, face, face], [height, height, 0], color=EDGE_COLOR, lw=1.2, zorder=2)
    dash: Any = "-" if building.has_storeys else (0, (1, 2))
    axes.hlines(_floors(building), face, far, color="0.45", lw=0.7, ls=dash, zorder=2)


def _name(building: Building) -> str:
    """The name of a building, and its height."""
    height = f"{building.height:.4g} m" if building.height else "height not given"
    return f"{plain(building.name, BUILDING_NAME_WIDTH)}\n{height}"


def _floors(building: Building) -> np.ndarray:
    """Levels of floors [m]; of an oscillator as if its storeys were equal, if they are known."""
    if building.has_storeys:
        levels: np.ndarray = building.structure.levels()
        return levels
    if building.storeys is None or building.height is None:
        return np.empty(0)
    return np.linspace(0, building.height, building.storeys + 1)[1:]


def _displaced(answer: CaseAnswer, number: int, roof: float) -> tuple[np.ndarray, np.ndarray]:
    """Peak displacements of a building [cm], and the levels where they are known [m]."""
    table = answer.separation
    if "height" in table.dims:
        peaks = table[f"peak_at_height_{number}"].values
        levels = table.height.values
    else:
        peaks = np.array([float(table[f"peak_{number}"])])
        levels = np.array([roof])
    return CENTIMETRES * np.append(0.0, peaks), np.append(0.0, levels)


def _draw_gaps(axes: Axes, gaps: list[Dimension], apart: float, right: float) -> None:
    """A dimension line for each gap, its words to the left, the verdict to the right."""
    places = 0.0, CENTIMETRES * apart
    axes.vlines(places, -0.5, len(gaps) - 0.5, color="0.5", lw=0.7, ls=(0, (1, 1.5)), zorder=1)
    low, high = axes.get_xlim()
    for row, line in enumerate(gaps):
        gap = CENTIMETRES * line.gap
        if np.isfinite(line.low):
            far = line.high if np.isfinite(line.high) else right / CENTIMETRES
            ends = [CENTIMETRES * line.low, CENTIMETRES * far]
            axes.plot(ends, [row, row], color=INTERVAL, lw=7, solid_capstyle="butt", zorder=2)
        if np.isfinite(gap):
            drawn: Any = {"color": EDGE_COLOR, "lw": 1.1, "ms": 9, "zorder": 3}
            axes.plot([0, min(gap, right)], [row, row], marker="|", **drawn)
        if gap > right:
            axes.plot(right, row, color=EDGE_COLOR, marker=">", ms=6)
        style: Any = {"va": "center", "size": SIZE, "linespacing": 1.0}
        axes.text(low + 0.01 * (high - low), row, line.label, **style)
        axes.text(high - 0.01 * (high - low), row, filled([line.note], LABEL), ha="right", **style)


def _draw_shares(axes: Axes, answer: CaseAnswer) -> None:
    """A bar of all motions: those in which the gap is enough, with the interval, and the others."""
    about = subject_of(answer.case)
    now = answer.existing
    table = answer.separation.isel(rule=0) if now is None else now
    percentages = [100 * share for share in with_interval(table, NO_POUNDING)]
    enough = percentages[0]
    axes.set(xlim=(-4, 104), ylim=(-1.15, 1.5))
    for left, wide, (face, hatch) in (
        (0, enough, LOOK_APART),
        (enough, 100 - enough, LOOK_POUNDING),
    ):
        axes.barh(0, wide, 0.8, left, color=face, hatch=hatch, edgecolor=EDGE_COLOR, lw=0.7)
    axes.plot(percentages[1:], [0, 0], color=EDGE_COLOR, lw=2.5, solid_capstyle="butt")
    required = 100 * answer.case.wanted.confidence
    axes.plot([required, required], [-0.6, 0.6], color=EDGE_COLOR, lw=1.2, ls=(0, (3, 1.5)))
    axes.text(
        required, -0.62, f"required {confidence(answer.case)}", ha="right", va="top", size=SIZE
    )
    which = "required" if now is None else "existing"
    title = f"{about.good.capitalize()}, {which} {about.gap}: {share_of(table)}"
    axes.text(-2.5, 0.62, title, va="bottom", size=SIZE)
    axes.text(0, -0.62, f"hatched: {about.meet}", va="top", size=SIZE)
