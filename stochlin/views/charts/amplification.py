"""Picture of Fig. 5b: amplification by linearization, and by simulation of deviations and peaks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.views.charts.charts import PICTURES, family, name_of
from stochlin.views.charts.comparisons import TWICE
from stochlin.views.shared.style import CURVES, label_axis, plain_ticks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINES = (("amplification", "linearized"), ("amplification_drift", "drift closure"))
POINTS: Any = {"linestyle": "none", "lw": 0.8, "color": "0.1"}
SIMULATED: Any = (
    ("amplification_of_peaks", "maxima, simulated", {"marker": "^", "ms": 3.2}),
    ("amplification_simulated", "std. deviations, simulated", {"marker": "o", "ms": 4.5, "mfc": "w"}),
)
TICKS = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)
SIZE = (7.2, 6.4)  # inches
LEFT, RIGHT, BOTTOM, TOP, BETWEEN = 0.1, 0.97, 0.215, 0.84, 0.035


@PICTURES.register("amplification")
def draw_amplification(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each reduction factor, all with the same axes."""
    figure.set_size_inches(*SIZE)
    table = dataset.amplification
    curves = list(family(table))
    across = min(len(curves), 2)
    rows = -(-len(curves) // across)
    wide = (RIGHT - LEFT - BETWEEN * (across - 1)) / across
    high = (TOP - BOTTOM - 1.4 * BETWEEN * (rows - 1)) / rows
    shown = [dataset[name] for name, *_ in (*LINES, *SIMULATED) if name in dataset]
    lowest, highest = min(float(one.min()) for one in shown), max(float(one.max()) for one in shown)
    for n, (title, place) in enumerate(curves):
        column, up = n % across, rows - 1 - n // across
        corner = LEFT + column * (wide + BETWEEN), BOTTOM + up * (high + 1.4 * BETWEEN)
        axes = figure.add_axes((*corner, wide, high))
        _panel(axes, dataset.sel(place))
        axes.text(0.97, 0.95, title, transform=axes.transAxes, ha="right", va="top", size=9)
        ends = 0.8 * lowest, 1.2 * highest
        axes.set(yscale="log", ylim=ends)
        plain_ticks(axes.yaxis, [tick for tick in TICKS if ends[0] <= tick <= ends[1]])
        below = n + across >= len(curves)
        if not below:
            axes.set_xlabel("")
        axes.tick_params(labelleft=column == 0, labelbottom=below)
    figure.text(
        0.03, 0.5 * (BOTTOM + TOP), name_of(table), rotation=90, va="center", ha="center", size=9
    )
    handles = axes.get_legend_handles_labels()
    figure.legend(
        *handles, loc="lower left", bbox_to_anchor=(LEFT - 0.01, TOP + 0.005), ncols=4, fontsize=8
    )


def _panel(axes: Axes, dataset: xr.Dataset) -> None:
    across = dataset.amplification[dataset.amplification.dims[-1]]
    for (name, label), (color, dash) in zip(LINES, CURVES, strict=False):
        if name in dataset:
            axes.plot(across, dataset[name], color=color, linestyle=dash, label=label)
    for name, label, marker in SIMULATED:
        if name in dataset:
            known = dataset[name].notnull().values
            error = TWICE * dataset[f"{name}_standard_error"].values
            x, y = across.values[known], dataset[name].values[known]
            axes.errorbar(x, y, error[known], label=label, **POINTS, **marker)
    axes.axhline(1, color="0.6", lw=0.8, zorder=1)
    label_axis(axes, "x", across)
    axes.set_xlim(float(across[0]), float(across[-1]))
