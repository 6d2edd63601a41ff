"""Second pictures of charts: linearization beside other methods, simulation and the difference."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import xarray as xr

from stochlin.views.charts.charts import (
    ENDINGS,
    PICTURES,
    SIMULATED,
    draw_points,
    finish,
    known,
    places,
    set_axes,
    shown,
    stem_of,
)
from stochlin.views.charts.panels import bar_beside, few_ticks, is_narrow, legend, panels
from stochlin.views.charts.planes import contour_levels, plane, signed_levels
from stochlin.views.shared.style import CURVES, quantity
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ELASTIC = (  # thin lines: ending of the variable, colour, dash and label
    ("_elastic", "0.45", (0, (1, 1.5)), "elastic, this ground"),
    ("_white_noise", "0.6", "-", "elastic, eq. (4)"),
)
MARKERS = {"_of_peaks": {"marker": "^", "mfc": "0.1"}, "_simulated": {"marker": "o"}}
SQUARE, PANEL = 2.4, 1.75  # inches


@PICTURES.register("compared_plane")
def _planes(figure: Figure, dataset: xr.Dataset) -> None:
    """Planes by linearization, drift closure and simulation, and the difference; a column a ground."""
    name = str(stem_of(dataset))
    methods = {"linearized": "", "drift closure": "_drift", "simulated": "_simulated"}
    tables = {
        title: known(dataset[f"{name}{end}"])
        for title, end in methods.items()
        if f"{name}{end}" in dataset
    }
    levels = contour_levels(*tables.values())
    if f"{name}_difference" in dataset:
        tables["difference"] = known(dataset[f"{name}_difference"])
    grounds = list(places(next(iter(tables.values())), 2))
    height = min(figure.get_figwidth() / len(grounds), SQUARE) + 0.1
    every = panels(figure, len(tables), len(grounds), height, sharex=True, sharey=True)
    labels, filled = [], []
    heads = [_in_lines(figure, ground) for ground, _ in grounds]
    for n, (row, (title, table)) in enumerate(zip(every, tables.items(), strict=True)):
        signed = title == "difference"
        for axes, head, (_, place) in zip(row, heads, grounds, strict=True):
            axes.set_title(title if n else f"{head}{title}", loc="left")
            steps = signed_levels(table) if signed else levels
            shades, label = plane(axes, table.sel(place), steps, signed=signed)
            axes.label_outer()
            labels.append(label)
        filled.append((shades, table, row))
    plain = [entry for entry in filled if not str(entry[1].name).endswith("_difference")]
    bar_beside(figure, plain[0][0], [axes for *_, row in plain for axes in row], plain[0][1])
    if len(plain) < len(filled):
        bar_beside(figure, filled[-1][0], list(filled[-1][2]), filled[-1][1])
    few_ticks(figure, every.ravel())
    finish(figure, labels)


@PICTURES.register("compared_curves")
def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each strength and ground, with all methods and the simulated points."""
    name = str(stem_of(dataset))
    table = shown(dataset)
    grounds = [place for _, place in places(table, 2)]
    strengths = list(places(table.sel(grounds[0]), 1))
    panel_places = [(title, {**ground, **own}) for title, own in strengths for ground in grounds]
    columns = min(2, len(panel_places))
    rows = -(-len(panel_places) // columns)
    every = list(panels(figure, rows, columns, PANEL, sharex=True, sharey=True).ravel())
    for axes in every[len(panel_places) :]:
        axes.remove()
    heads = [_in_lines(figure, title) for title, _ in places(table, 2)]
    for n, (axes, (title, place)) in enumerate(zip(every, panel_places, strict=False)):
        above = heads[n] if n < len(grounds) else ""
        axes.set_title(f"{above}{title}", loc="left")
        _panel(axes, dataset.sel(place), name)
    drawn = [dataset[f"{name}{end}"] for end in ("", *ENDINGS) if f"{name}{end}" in dataset]
    set_axes(every[: len(panel_places)], table.rename(name), drawn)
    if rows > 1:
        figure.supylabel(every[0].get_ylabel(), size="medium")
        for axes in every:
            axes.set_ylabel("")
    few_ticks(figure, every[: len(panel_places)])
    legend(figure, every[:1], columns=3)


def _in_lines(figure: Figure, ground: str) -> str:
    """The name of a ground above a panel, in two lines in a narrow picture."""
    return f"{ground.replace(', ', chr(10)) if is_narrow(figure) else ground}\n" if ground else ""


def _panel(axes: Axes, dataset: xr.Dataset, name: str) -> None:
    methods = _methods(dataset, name).items()
    for (text, table), (color, dash) in zip(methods, cycle(CURVES), strict=False):
        axes.plot(table[table.dims[-1]], table, color=color, linestyle=dash, label=text)
    for end in SIMULATED:
        if f"{name}{end}" in dataset:
            text = quantity(dataset[f"{name}{end}"])
            draw_points(axes, dataset, f"{name}{end}", color="0.1", label=text, **MARKERS[end])
    for end, color, dash, text in ELASTIC:
        if f"{name}{end}" in dataset:
            table = dataset[f"{name}{end}"]
            x = table[table.dims[-1]]
            axes.plot(x, table, color=color, linestyle=dash, lw=0.9, label=text, zorder=1.5)


def _methods(dataset: xr.Dataset, name: str) -> dict[str, xr.DataArray]:
    """Curves of a panel by their labels: linearized, drift closure, effective rules."""
    ends = {"linearized": "", "drift closure": "_drift"}
    curves = {text: dataset[f"{name}{end}"] for text, end in ends.items() if f"{name}{end}" in dataset}
    if "rule" in dataset.dims:
        rules = dataset.rule.values.tolist()
        curves |= {rule_label(rule): dataset[f"{name}_effective"].sel(rule=rule) for rule in rules}
    return curves
