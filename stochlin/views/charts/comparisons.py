"""Pictures of linearized charts with other methods, nonlinear simulation and the difference."""

from __future__ import annotations

import textwrap
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.charts.charts import PICTURES, family, name_of
from stochlin.views.shared.style import CURVES, contour_levels, label_axis, plane, signed_levels
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

POINTS: Any = {"ls": "none", "marker": "o", "ms": 3.2, "mfc": "w", "mew": 0.8, "lw": 0.8, "zorder": 4}
SIMULATED: Any = {"color": "0.1", "label": "simulated, 95 % interval"} | POINTS
ELASTIC = (  # thin lines: variable, colour, dash and label
    ("rho_elastic", "0.45", (0, (1, 1.5)), "elastic, this ground"),
    ("rho_white_noise", "0.6", "-", "elastic, eq. (4)"),
)
BESIDE = ("_simulated", "_drift", "_effective")
TWICE = 1.96  # half a 95 % interval, in standard errors
WIDTH = 7.2  # width of the figure; this and the following lengths are in inches
# Four planes: their size, left edges, lowest edge, and distance of their lower edges.
SQUARE, LEFT, DOWN, STEP = 2.4, (0.72, 3.5), 1.55, 2.75
# Panels of curves: space below and above, height, space between rows, space between columns.
BELOW, ABOVE, PANEL, BETWEEN, ASIDE = 1.5, 1.6, 1.8, 0.28, 0.3
LABEL_WIDTH = 30  # characters


@PICTURES.register("compared_plane")
def _planes(figure: Figure, dataset: xr.Dataset) -> None:
    """Planes by linearization, drift closure and simulation, and the difference.

    Simulated values are drawn as cells, the others as contours.
    """
    name = _compared(dataset)
    figure.set_size_inches(WIDTH, 7.6)
    rho = {"linearized": dataset[name], "drift closure": dataset.get(f"{name}_drift")}
    rho |= {"simulated": _known(dataset, f"{name}_simulated")}
    shown = {title: table for title, table in rho.items() if table is not None}
    difference = _known(dataset, f"{name}_difference")
    levels = contour_levels(*shown.values())
    places = [(x, y) for y in (DOWN + STEP, DOWN) for x in LEFT]
    symbol = r"$\rho$" if name == "rho" else name
    for (title, table), place in zip(shown.items(), places, strict=False):
        axes = _square(figure, title, place)
        filled = plane(axes, table, levels, cells=title == "simulated")
        _outer(axes, left=place[0] == LEFT[0], bottom=place[1] == DOWN)
    _bar(figure, filled, places[1], symbol)
    last = places[len(shown)]
    axes = _square(figure, "linearized less simulated", last)
    filled = plane(axes, difference, signed_levels(difference), cells=True, signed=True)
    _outer(axes, left=last[0] == LEFT[0], bottom=True)
    _bar(figure, filled, last, f"difference of {symbol}")


def _square(figure: Figure, title: str, place: tuple[float, float]) -> Axes:
    axes = _axes(figure, *place, SQUARE, SQUARE)
    axes.set_title(title, loc="left", size=9)
    return axes


def _bar(figure: Figure, filled: Any, place: tuple[float, float], text: str) -> Colorbar:
    x, y = place
    bar = figure.colorbar(filled, cax=_axes(figure, x + SQUARE + 0.15, y, 0.15, SQUARE))
    bar.ax.grid(visible=False)
    bar.ax.tick_params(labelsize=8)
    bar.set_label(text, size=8)
    return bar


@PICTURES.register("compared_curves")
def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each curve of the chart, with the other methods and the simulated points."""
    name = _compared(dataset)
    curves = list(family(dataset[name]))
    across = len(curves) if len(curves) < 4 else 2 if len(curves) == 4 else 3
    rows = -(-len(curves) // across)
    figure.set_size_inches(WIDTH, BELOW + ABOVE + rows * PANEL + (rows - 1) * BETWEEN)
    wide = (WIDTH - LEFT[0] - 0.25 - ASIDE * (across - 1)) / across
    lowest, highest = _ends(dataset, name)
    for n, (title, place) in enumerate(curves):
        x, up = LEFT[0] + n % across * (wide + ASIDE), rows - 1 - n // across
        axes = _axes(figure, x, BELOW + up * (PANEL + BETWEEN), wide, PANEL)
        _panel(axes, dataset.sel(place), name)
        axes.set_title(title if place else "", loc="left", size=9)
        label_axis(axes, "x", dataset[dataset[name].dims[-1]])
        axes.set_ylabel(name_of(dataset[name]).split(",")[0])
        _outer(axes, left=n % across == 0, bottom=n + across >= len(curves))
        if name == "rho":
            axes.set_ylim(min(0.0, np.floor(lowest * 10) / 10), 1.03)
        else:
            axes.set(yscale="log" if highest > 5 else "linear", ylim=(0.9 * lowest, 1.1 * highest))
    legend: Any = {"loc": "upper left", "ncols": 3, "fontsize": 8, "columnspacing": 1.5}
    high = BELOW + rows * PANEL + (rows - 1) * BETWEEN + 0.85
    corner = LEFT[0] / WIDTH, high / figure.get_figheight()
    figure.legend(*axes.get_legend_handles_labels(), bbox_to_anchor=corner, borderaxespad=0, **legend)


def _panel(axes: Axes, dataset: xr.Dataset, name: str) -> None:
    x = dataset[dataset[name].dims[-1]].values
    shown = _methods(dataset, name).items()
    for (text, table), (color, dash) in zip(shown, cycle(CURVES), strict=False):
        axes.plot(x, table, color=color, linestyle=dash, label=textwrap.fill(text, LABEL_WIDTH))
    if f"{name}_simulated" in dataset:
        error = TWICE * dataset[f"{name}_standard_error"]
        axes.errorbar(x, dataset[f"{name}_simulated"], error, **SIMULATED)
    for other, color, dash, text in ELASTIC:
        if other in dataset:
            axes.plot(x, dataset[other], color=color, linestyle=dash, lw=0.9, label=text, zorder=1.5)
    axes.set_xlim(x[0], x[-1])


def _methods(dataset: xr.Dataset, name: str) -> dict[str, xr.DataArray]:
    """Curves of a panel by their labels: linearized, drift closure, effective rules."""
    found = {"linearized": dataset[name]}
    if f"{name}_drift" in dataset:
        found["drift closure"] = dataset[f"{name}_drift"]
    if "rule" in dataset.dims:
        rules = dataset.rule.values.tolist()
        found |= {rule_label(rule): dataset[f"{name}_effective"].sel(rule=rule) for rule in rules}
    return found


def _ends(dataset: xr.Dataset, name: str) -> tuple[float, float]:
    """Lowest and highest value in the panels."""
    names = [key for key, *_ in ELASTIC] + [f"{name}_simulated"]
    shown = [*_methods(dataset, name).values(), *(dataset[key] for key in names if key in dataset)]
    return min(float(one.min()) for one in shown), max(float(one.max()) for one in shown)


def _axes(figure: Figure, x: float, y: float, width: float, height: float) -> Axes:
    """Axes with a position and size in inches."""
    high = figure.get_figheight()
    return figure.add_axes((x / WIDTH, y / high, width / WIDTH, height / high))


def _outer(axes: Axes, *, left: bool, bottom: bool) -> None:
    """Remove tick labels and axis labels that are not at the left or lower edge."""
    axes.tick_params(labelleft=left, labelbottom=bottom)
    if not left:
        axes.set_ylabel("")
    if not bottom:
        axes.set_xlabel("")


def _known(dataset: xr.Dataset, name: str) -> xr.DataArray:
    """A simulated variable without the rows and columns that were not simulated."""
    table = dataset[name]
    for dim in table.dims:
        table = table.dropna(dim, how="all")
    return table


def _compared(dataset: xr.Dataset) -> str:
    """Name of the variable of the chart that is compared with other methods."""
    return next(str(name) for name in dataset if any(f"{name}{end}" in dataset for end in BESIDE))
