"""Pictures of an answer about a gap: one column wide, and for print in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stochlin.views.separation.words import gap_of, subject_of
from stochlin.views.shared.style import (
    AS_GIVEN,
    CURVES,
    filled,
    legend_above,
    open_frame,
    styled,
)
from stochlin.views.shared.words import roles_in_words, rule_label, with_interval

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stochlin.applications.cases.separation import CaseAnswer

WIDTH = 4.6  # inches: a phone shows it at three quarters of its size
PANEL, LINE = 3.4, 0.17  # inches: of a panel with its axis and legend, of a line of text
CAPTION = 66  # characters
FORMULAS = ("eq_3_linearized", "linearization", "srss")  # beside the simulation, where they are known
GREY = "0.75"
CENTIMETRES = 100.0


def distribution_figure(answer: CaseAnswer) -> Figure:
    """Probability of no pounding over the gap, in the motions and, if there are many, the records."""
    table, about = answer.separation, subject_of(answer.case)
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
    axes.axhline(answer.case.wanted.confidence, color="0.3", lw=0.9, ls=(0, (1, 1)), label="required")
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
        The gap that is needed at each height, by simulation with its 95 % interval and by formulas, and
        the height that governs.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    if dataset.sizes.get("height", 0) < 2 or set(dataset.gap.dims) != {"rule"}:
        raise ValueError(
            f"dataset has the dimensions {dict(dataset.sizes)}; allowed: the separation of one pair of "
            "buildings with storeys, which could meet at several heights"
        )
    text = caption_of(dataset) if caption else ""
    figure, axes = _panel(LINE * len(text.splitlines()))
    _gaps(axes, dataset)
    legend_above(axes)
    axes.set(xlim=(0, None))
    figure.supxlabel(text, x=0.02, ha="left", size=8.5)
    return figure


def _panel(foot: float = 0.0) -> tuple[Figure, Axes]:
    """A figure with one panel, and so many inches below it."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, PANEL + foot), layout="constrained")
    axes = figure.add_subplot()
    open_frame(axes)
    return figure, axes


def _gaps(axes: Axes, dataset: xr.Dataset) -> None:
    """The gap from the ground to each height, by simulation with its interval and by formulas."""
    heights = np.append(0.0, dataset.height.values)

    def at_height(name: str, rule: str) -> np.ndarray:
        return np.append(0.0, CENTIMETRES * dataset[name].sel(rule=rule).values)

    for rule, (color, dash), marker in zip(("simulation", *FORMULAS), CURVES, "o^vD", strict=False):
        if not np.isfinite(dataset.gap.sel(rule=rule)):
            continue
        style: Any = {"color": color, "linestyle": dash, "marker": marker, "ms": 4, "lw": 1.3}
        style["markerfacecolor"] = color if rule == "simulation" else "none"
        label = "simulated" if rule == "simulation" else rule_label(rule)
        axes.plot(at_height("gap_at_height", rule), heights, label=label, **style)
    low, high = (at_height(f"gap_at_height_{end}", "simulation") for end in ("lower", "upper"))
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


def caption_of(dataset: xr.Dataset) -> str:
    """What is shown, the buildings, the ground and the motions, in lines."""
    attrs = dataset.attrs
    lines = [attrs["title"], *roles_in_words(attrs, "first", "second", "ground", "envelope")]
    lines.append(f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}")
    return filled(lines, CAPTION, "    ")
