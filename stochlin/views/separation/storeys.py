"""The picture of a gap over height and of storey drifts: one column wide, and for print in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.separation.subjects import gap_of
from stochlin.views.shared.style import AS_GIVEN, CURVES, filled, legend_above, open_frame, styled
from stochlin.views.shared.words import roles_in_words, rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, PANEL, LOW, AXIS = 4.6, 2.5, 0.6, 0.55  # inches; a low panel is of one height
LEGEND, LINE, MARGIN = 0.17, 0.15, 0.05  # inches: lines of text, and above all of it
LEFT, RIGHT = 0.15, 0.97  # of the width
CAPTION = 66  # characters
FORMULAS = ("eq_3_linearized", "linearization", "srss")  # beside the simulation, where they are known
TICKS = 12  # at most, of storeys
GREY = "0.75"
CENTIMETRES = 100.0


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
        Above the gap that is needed at each height, by simulation with its 95 % interval and by
        formulas, and the height that governs; below the mean peak drift of each storey, and its drift
        at yield.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "height" not in dataset.dims or set(dataset.gap.dims) != {"rule"}:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: the separation of one pair of "
            "buildings, at least one of them with storeys"
        )
    text = caption_of(dataset) if caption else ""
    foot = LINE * (text.count("\n") + 1.5) if text else 0.0
    figure = Figure()
    panels = [figure.add_axes((0, n, 1, 1)) for n in (1, 0)]  # until their legends are known
    _gaps(panels[0], dataset)
    _drifts(panels[1], dataset)
    inner = [PANEL if dataset.sizes["height"] > 1 else LOW, PANEL]
    heads = [LEGEND * ((len(axes.get_legend_handles_labels()[1]) + 1) // 2) for axes in panels]
    height = sum(inner) + sum(heads) + AXIS * len(panels) + foot + MARGIN
    top = height - MARGIN
    figure.set_size_inches(WIDTH, height)
    for axes, own, head in zip(panels, inner, heads, strict=True):
        top -= own + head
        axes.set_position((LEFT, top / height, RIGHT - LEFT, own / height))
        top -= AXIS
        legend_above(axes)
        open_frame(axes)
        axes.set(xlim=(0, None))
    figure.text(0.02, foot / height, text, va="top", size=8.5)
    return figure


def _gaps(axes: Axes, dataset: xr.Dataset) -> None:
    """The gap at each height, by simulation with its interval and by formulas."""
    heights = dataset.height.values
    grounded = heights.size > 1  # a straight line from there to the first level
    heights = np.append(0.0, heights) if grounded else heights

    def at_height(name: str, rule: str) -> np.ndarray:
        values = CENTIMETRES * dataset[name].sel(rule=rule).values
        return np.append(0.0, values) if grounded else values

    low, high = (at_height(f"gap_at_height_{end}", "simulation") for end in ("lower", "upper"))
    for rule, (color, dash), marker in zip(("simulation", *FORMULAS), CURVES, "o^vD", strict=False):
        if not np.isfinite(dataset.gap.sel(rule=rule)):
            continue
        values = at_height("gap_at_height", rule)
        style: Any = {"color": color, "linestyle": dash, "marker": marker, "ms": 4, "lw": 1.3}
        style["markerfacecolor"] = color if rule == "simulation" else "none"
        axes.plot(
            values, heights, label="simulated" if rule == "simulation" else rule_label(rule), **style
        )
        if rule == "simulation" and np.isfinite(high).all():
            axes.fill_betweenx(heights, low, high, color=GREY, lw=0, label="its 95 % interval")
            if not grounded:
                axes.plot([low[0], high[0]], [heights[0]] * 2, color=GREY, lw=5, zorder=1)
    if grounded:
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
    axes.set(
        ylabel="height [m]", xlabel=f"{gap_of(dataset)} [cm] not exceeded in {share} of the motions"
    )
    if grounded:
        axes.set(ylim=(0, 1.04 * heights[-1]))
    else:
        axes.set_yticks(heights, [f"{heights[0]:.4g}"])


def _drifts(axes: Axes, dataset: xr.Dataset) -> None:
    """Mean peak drifts of the storeys of both buildings; an oscillator has none."""
    for number, (color, dash), marker in zip((1, 2), CURVES, "os", strict=False):
        there = (dataset.element_structure.values == number) & (dataset.storey.values > 0)
        if str(number) in dataset.element.values[there] or not there.any():
            continue
        own = dataset.isel(element=there)
        drift, storeys = CENTIMETRES * own.peak_drift_mean.values, own.storey.values
        style: Any = {"color": color, "linestyle": dash, "marker": marker, "ms": 3.5, "lw": 1.3}
        axes.plot(drift, storeys, label=f"building {number}, mean peak", **style)
        if float(own.ductility.max()) > 0:
            at_yield = drift / own.ductility.values
            style = {"color": color, "ls": "", "marker": "|" if number == 1 else "x", "ms": 6}
            axes.plot(at_yield, storeys, label=f"building {number}, at yield", **style)
    most = int(dataset.storey.max())
    axes.set(ylabel="storey", xlabel="drift [cm]", ylim=(0.5, most + 0.5))
    axes.set_yticks(range(1, most + 1, 1 + most // TICKS))


def caption_of(dataset: xr.Dataset) -> str:
    """What is shown, the buildings, the ground and the motions, in lines."""
    attrs = dataset.attrs
    lines = [attrs["title"], *roles_in_words(attrs, "first", "second", "ground", "envelope")]
    lines.append(f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}")
    return filled(lines, CAPTION, "    ")
