"""Fig. 9: the gap that two yielding structures require in a motion, over their period ratio."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.applications.figures.fig9 import GAP, GAP_METHODS
from stochlin.views.figures.pictures import (
    PICTURES,
    POINT,
    SMALL_PANEL,
    is_narrow,
    panels,
    title_of,
)
from stochlin.views.shared.blocks import typeset
from stochlin.views.shared.style import CURVES, decade_ticks, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTHS = 1.6, 1.1, 1.1, 1.1  # of the curves of the methods
# of the axis of the period ratio
RATIO_LIMITS = (0.05, 1.0)
TICKS_BELOW_ONE = (0.2, 0.4, 0.6, 0.8, 1.0)


@PICTURES.register("required_gaps")
def draw_required_gaps(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each strength and ground; in a narrow picture grounds are beside one another."""
    across = "reduction_factor"
    down = "ground"
    if "ground" not in dataset.dims:
        dataset = dataset.expand_dims(ground=[""])
    if is_narrow(figure):
        across, down = down, across
    counts = dataset.sizes[down], dataset.sizes[across]
    every = np.array(panels(figure, *counts, SMALL_PANEL, shared=True)).reshape(counts)
    for place, axes in np.ndenumerate(every):
        _draw_gaps(axes, dataset.isel(dict(zip((down, across), place, strict=True))))
    for side, values in ((every[0], dataset[across]), (every[:, 0], dataset[down])):
        for axes, value in zip(side, values.values, strict=True):
            text = title_of(values.name, value)
            if values.name == across:
                axes.set_title(text.replace(", ", "\n"), loc="left")
            else:
                axes.set_ylabel(text)
    for axes in every[-1]:
        axes.set_xlabel(quantity(dataset.period_ratio))
    figure.supylabel(quantity(dataset[GAP]), size="medium")


def _draw_gaps(axes: Axes, panel: xr.Dataset) -> None:
    """The curve of the closure, the rules through the simulated points, and these."""
    ratio = panel.period_ratio
    looks = zip(GAP_METHODS.items(), CURVES, WIDTHS, strict=False)
    for (name, label), (color, dash), width in looks:
        if name in panel:
            row = panel[name].dropna("period_ratio")
            axes.plot(row.period_ratio, row, label=typeset(label), color=color, ls=dash, lw=width)
    if f"{GAP}_simulated" in panel:
        simulated = panel[f"{GAP}_simulated"]
        ends = [panel[f"{GAP}_simulated{end}"] for end in ("_lower", "_upper")]
        bars = [abs(end - simulated) for end in ends]
        axes.errorbar(
            ratio, simulated, bars, fmt="o", color="0.1", mfc="w", label="simulated", **POINT
        )
    axes.set(yscale="log", xlim=RATIO_LIMITS, xticks=TICKS_BELOW_ONE)
    axes.xaxis.set_major_formatter("{x:g}")
    decade_ticks(axes.yaxis)
