"""Pictures of a chart by linearization beside the same by simulation, and their difference."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.charts.charts import PICTURES, family, name_of
from stochlin.views.shared.style import CURVES, contour_levels, label_axis, legend_beside, plane

if TYPE_CHECKING:
    from matplotlib.figure import Figure

POINTS: Any = {"linestyle": "none", "marker": "o", "ms": 3, "lw": 1}
TWICE = 1.96  # standard errors of a 95 % interval


@PICTURES.register("compared_plane")
def _planes(figure: Figure, dataset: xr.Dataset) -> None:
    name = _compared(dataset)
    symbol = r"$\rho$" if name == "rho" else name
    linearized, simulated, difference = (
        dataset[name + end] for end in ("", "_simulated", "_difference")
    )
    levels = contour_levels(linearized, simulated)
    panels = (
        ("linearized", linearized, levels),
        ("simulated", simulated, levels),
        ("difference", difference, contour_levels(difference, at_most=-0.1)),
    )
    for n, (title, table, at) in enumerate(panels):
        axes = figure.add_axes((0.09 + 0.305 * n, 0.42, 0.27, 0.45))
        filled = plane(axes, table, at)
        axes.set_title(title, loc="left", size=9)
        if n:
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
        bar = figure.colorbar(
            filled, cax=figure.add_axes((0.09 + 0.305 * n, 0.25, 0.27, 0.025)), orientation="horizontal"
        )
        bar.ax.grid(visible=False)
        bar.ax.tick_params(labelsize=7)
        bar.set_ticks(at[::2].tolist())
        bar.set_label(symbol if n < 2 else f"{symbol} linearized less simulated", size=8)


@PICTURES.register("compared_curves")
def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    name = _compared(dataset)
    upper = figure.add_axes((0.1, 0.5, 0.64, 0.41))
    lower = figure.add_axes((0.1, 0.25, 0.64, 0.21), sharex=upper)
    across = dataset[dataset[name].dims[-1]]
    x = across.values
    for (color, dash), (label, place) in zip(cycle(CURVES), family(dataset[name]), strict=False):
        one = dataset.sel(place)
        upper.plot(x, one[name], color=color, linestyle=dash, label=f"{label}, linearized")
        error = TWICE * one[f"{name}_standard_error"]
        points = f"{label}, simulated"
        upper.errorbar(x, one[f"{name}_simulated"], error, color=color, label=points, **POINTS)
        lower.plot(x, one[f"{name}_difference"], color=color, linestyle=dash)
    lower.axhline(0, color="0.5", lw=0.8)
    label_axis(lower, "x", across)
    upper.tick_params(labelbottom=False)
    upper.set_xlim(x[0], x[-1])
    if float(np.abs(dataset[f"{name}_simulated"]).max()) > 5:
        upper.set_yscale("log")
    upper.set_ylabel(name_of(dataset[name]).split(",")[0])
    lower.set_ylabel("difference")
    legend_beside(upper)


def _compared(dataset: xr.Dataset) -> str:
    return next(str(name) for name in dataset if f"{name}_difference" in dataset)
