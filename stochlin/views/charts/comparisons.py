"""Pictures of a chart by linearization beside the same by simulation, and their difference."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.views.shared.style import CURVES, NAMES, plane, ratio_ticks, tenths

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TWICE = 1.96  # standard errors of a 95 % interval


def draw_comparison(figure: Figure, dataset: xr.Dataset) -> None:
    """Draw planes or curves of both methods into a figure."""
    if "period_ratio_2" in dataset.dims:
        _planes(figure, dataset)
    else:
        _curves(figure, dataset)


def _planes(figure: Figure, dataset: xr.Dataset) -> None:
    levels = tenths(dataset.rho, dataset.rho_simulated)
    panels = (
        ("linearized", dataset.rho, levels),
        ("simulated", dataset.rho_simulated, levels),
        ("difference", dataset.rho_difference, tenths(dataset.rho_difference, at_most=-0.1)),
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
        bar.set_label(r"$\rho$" if n < 2 else r"$\rho$ linearized less simulated", size=8)


def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    name = "rho" if "rho" in dataset else "amplification"
    upper = figure.add_axes((0.1, 0.5, 0.64, 0.41))
    lower = figure.add_axes((0.1, 0.25, 0.64, 0.21), sharex=upper)
    x = dataset.period_ratio.values
    for (color, dash), value in zip(cycle(CURVES), dataset.reduction_factor.values, strict=False):
        one = dataset.sel(reduction_factor=value)
        upper.plot(x, one[name], color=color, linestyle=dash, label=f"R = {value:g}, linearized")
        upper.errorbar(
            x,
            one[f"{name}_simulated"],
            yerr=TWICE * one[f"{name}_standard_error"],
            color=color,
            linestyle="none",
            marker="o",
            ms=3,
            lw=1,
            label=f"R = {value:g}, simulated",
        )
        lower.plot(x, one[f"{name}_difference"], color=color, linestyle=dash)
    lower.axhline(0, color="0.5", lw=0.8)
    lower.set_xscale("log")
    ratio_ticks(lower.xaxis, x)
    upper.tick_params(labelbottom=False)
    upper.set_xlim(x[0], x[-1])
    if float(np.abs(dataset[f"{name}_simulated"]).max()) > 5:
        upper.set_yscale("log")
    lower.set_xlabel(dataset.period_ratio.attrs.get("long_name", "period ratio"))
    upper.set_ylabel(NAMES[name].split(",")[0])
    lower.set_ylabel("difference")
    upper.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)
