"""The picture of the modes of a building: shapes over height, and effective masses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.shared.descriptions import in_words
from stochlin.views.shared.style import (
    AS_GIVEN,
    CURVES,
    describe,
    filled,
    legend_above,
    open_frame,
    styled,
)
from stochlin.views.shared.words import along

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, PANEL, HEAD, LINE, FOOT = 7.2, 3.2, 0.45, 0.17, 0.5  # inches
LEFT, MIDDLE, LAST, RIGHT = 0.09, 0.66, 0.76, 0.98  # of the width: where panels begin and end
CAPTION = 112  # characters
MARKERS = "osD^vP"


@styled(AS_GIVEN)
def draw_modes(dataset: xr.Dataset) -> Figure:
    """Draw the modes of a building as ``stochlin building`` saves them.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        The shapes of the first six modes over the height, as displacements of the floors over those of
        the oscillators of the modes, and beside them the effective masses of all modes.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    if "floor_move" not in dataset:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: one that 'stochlin building' "
            "saves"
        )
    from matplotlib.figure import Figure

    shown = dataset.isel(mode=slice(len(CURVES)))
    head = HEAD + LINE * (1 + (shown.sizes["mode"] + 1) // 2)
    caption = filled([in_words(dataset.attrs["building"])], CAPTION, "    ")
    foot = FOOT + LINE * (1 + caption.count("\n"))
    height = head + PANEL + foot
    figure = Figure(figsize=(WIDTH, height))
    shapes, masses = (
        figure.add_axes((left, foot / height, right - left, PANEL / height))
        for left, right in ((LEFT, MIDDLE), (LAST, RIGHT))
    )
    _shapes(shapes, shown)
    _masses(masses, dataset)
    describe(figure, LEFT, foot - FOOT, dataset.attrs["title"], caption)
    return figure


def _shapes(axes: Axes, dataset: xr.Dataset) -> None:
    """The displaced floors of each mode, from the ground up."""
    levels = np.append(0.0, dataset["level"].values)
    axes.axvline(0, color="0.5", lw=0.8)
    for mode, (color, dash), marker in zip(along(dataset, "mode"), CURVES, MARKERS, strict=False):
        style: Any = {"color": color, "linestyle": dash, "marker": marker, "ms": 3.5, "lw": 1.3}
        name = f"mode {mode['mode'].item()}, {float(mode['period']):.3g} s"
        axes.plot(np.append(0.0, mode["floor_move"].values), levels, label=name, **style)
    axes.set(ylim=(0, 1.03 * levels[-1]), ylabel="height [m]")
    axes.set_xlabel("displacement of the floor over that of the mode's oscillator")
    open_frame(axes)
    legend_above(axes)


def _masses(axes: Axes, dataset: xr.Dataset) -> None:
    """The share of the mass in each mode, and what all modes up to it have."""
    place, share = np.arange(dataset.sizes["mode"]), 100 * dataset["mass_share"].values
    axes.bar(place, share, color="0.75", edgecolor="0.2", lw=0.6, label="of the mode")
    axes.plot(place, np.cumsum(share), color=CURVES[0][0], marker="o", ms=3.5, lw=1, label="up to it")
    step = 1 + place.size // len(CURVES)
    axes.set_xticks(place[::step], dataset["mode"].values[::step])
    axes.set(ylim=(0, 105), xlabel="mode", ylabel="effective mass [%]")
    axes.grid(visible=False, axis="x")
    open_frame(axes)
    legend_above(axes, 1)
