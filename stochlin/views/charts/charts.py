"""Pictures of chart datasets: curves, planes and spectra, readable in grey and at print size."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.registry import Registry
from stochlin.views.shared.style import (
    CURVES,
    NAMES,
    contour_levels,
    filled,
    label_axis,
    legend_beside,
    plane,
    quantity,
    styled,
)
from stochlin.views.shared.symbols import typeset
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Functions that draw the axes of a dataset into a figure, by its attribute ``chart``.
PICTURES: Registry[Callable[[Figure, xr.Dataset], None]] = Registry("chart", "stochlin.views.charts")
SIZE = (7.2, 4.6)  # inches: the width of a printed page
AXES = (0.1, 0.25, 0.64, 0.66)
COMPARISONS = (("rho_elastic", "0.35", "x", "elastic"), ("rho_white_noise", "0.6", "o", "eq. (4)"))
THIN: Any = {"lw": 0.8, "ms": 4, "mfc": "none", "markevery": 16}
CAPTION_WIDTH, COMMENT_WIDTH, LEGEND_WIDTH = 110, 125, 20  # characters
# Kinds of charts in older files without this attribute: the first one whose names the dataset has.
UNTOLD = (
    ("spectra", {"psd_record"}),
    ("compared_plane", {"rho_difference", "period_ratio_2"}),
    ("compared_curves", {"rho_difference"}),
    ("compared_curves", {"amplification_difference"}),
    ("portrait", {"circle_displacement"}),
    ("energies", {"input_energy_radius"}),
    ("critical_gap", {"critical_gap"}),
    ("contact_loops", {"scaled_force", "LinearSpring"}),
    ("contact_histories", {"scaled_force"}),
    ("restitution", {"restitution_hertz_damp"}),
    ("per_spectrum", {"pseudo_energy_radius", "period"}),
    ("plane", {"rho", "period_ratio_2"}),
    ("curves", {"period_ratio"}),
)


@styled()
def draw(dataset: xr.Dataset) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result of the functions of ``stochlin.charts``, from memory or from file. Its attribute
        ``chart`` gives the kind of picture.

    Returns
    -------
    matplotlib.figure.Figure
        Figure with the parameters below the axes and the legend beside them.

    Raises
    ------
    ValueError
        If the dataset is no chart, or has no finite numbers.
    """
    from matplotlib.figure import Figure

    draw_axes = PICTURES.named(_kind(dataset), "attribute chart")
    numbers = [array for array in dataset.data_vars.values() if array.dtype.kind == "f"]
    if numbers and not any(bool(np.isfinite(array).any()) for array in numbers):
        raise ValueError(
            "the chart has no finite number to draw; allowed: parameters in their ranges; its status "
            "names the cause"
        )
    figure = Figure(figsize=SIZE)
    draw_axes(figure, dataset)
    attrs = dataset.attrs
    figure.text(0.1, 0.935, typeset(attrs.get("title", "")), size=10)
    caption = filled(attrs.get("caption", "").splitlines(), CAPTION_WIDTH)
    comment = filled([attrs.get("comment", "")], COMMENT_WIDTH)
    # The caption is above the comment; line heights are in inches over that of the figure.
    low = max(0.05, (0.13 * len(comment.splitlines()) - 0.03) / figure.get_figheight())
    high = max(0.135, low + (0.134 * len(caption.splitlines()) + 0.03) / figure.get_figheight())
    figure.text(0.1, high, typeset(caption), va="top", size=8)
    figure.text(0.1, low, typeset(comment), va="top", size=7, style="italic")
    return figure


def _kind(dataset: xr.Dataset) -> str:
    """Kind of chart of a dataset, a name in `PICTURES`."""
    if "chart" in dataset.attrs:
        return str(dataset.attrs["chart"])
    names = {*map(str, dataset.variables), *map(str, dataset.dims)}
    names |= {*dataset["element"].values} if "element" in dataset else set()
    for kind, marks in UNTOLD:
        if marks <= names:
            return kind
    dimensions, allowed = tuple(dataset.dims), ", ".join(PICTURES)
    raise ValueError(f"dataset over {dimensions} has no attribute chart; allowed: {allowed}")


def _shown(dataset: xr.Dataset) -> xr.DataArray:
    """Variable that a chart shows: the first one except ``status``."""
    return dataset[next(name for name in dataset.data_vars if name != "status")]


def name_of(table: xr.DataArray) -> str:
    """Label of a variable for an axis or a colour bar."""
    return NAMES.get(str(table.name), quantity(table))


def family(table: xr.DataArray) -> Iterator[tuple[str, dict[Hashable, Any]]]:
    """Labels of all curves over the last dimension, each with its position along the first one."""
    if table.ndim == 1:
        yield quantity(table), {}
        return
    first, _ = table.dims
    for value in table[first].values:
        if isinstance(value, str):
            label = filled([rule_label(value)], LEGEND_WIDTH) if first == "rule" else value
        else:
            label = f"{NAMES.get(str(first), first)} = {value:g}"
        yield label, {first: value}


@PICTURES.register("curves")
def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    axes = figure.add_axes(AXES)
    table = _shown(dataset)
    across = table[table.dims[-1]]
    x = across.values
    for (color, dash), (label, place) in zip(cycle(CURVES), family(table), strict=False):
        axes.plot(x, table.sel(place), color=color, linestyle=dash, label=label)
    for other, color, marker, label in COMPARISONS:
        if other in dataset:
            axes.plot(x, dataset[other], color=color, marker=marker, label=label, **THIN)
    label_axis(axes, "x", across)
    axes.set(ylabel=name_of(table), xlim=(x[0], x[-1]))
    if table.name == "rho":
        low = min(float(dataset[v].min()) for v in dataset.data_vars if str(v).startswith("rho"))
        axes.set_ylim(min(0.0, np.floor(low * 10) / 10), 1.02)
    legend_beside(axes)


@PICTURES.register("plane")
def _plane(figure: Figure, dataset: xr.Dataset) -> None:
    axes = figure.add_axes(AXES)
    table = _shown(dataset)
    shades = plane(axes, table, contour_levels(table))
    axes.set_anchor("W")
    label = name_of(table)
    bar = figure.colorbar(shades, cax=figure.add_axes((0.57, 0.25, 0.025, 0.66)), label=label)
    bar.ax.grid(visible=False)


@PICTURES.register("spectra")
def _spectra(figure: Figure, dataset: xr.Dataset) -> None:
    axes = figure.add_axes(AXES)
    frequency = dataset.frequency.values
    shown = (
        ("psd_record", "0.75", "-", 0.6, "record, periodogram"),
        ("psd_smoothed", "0.35", "-", 1.2, "record, smoothed"),
        ("psd_ground", "#8c2d04", (0, (6, 1.5)), 1.8, "fitted ground"),
    )
    highest = max(float(dataset[name].max()) for name in ("psd_smoothed", "psd_ground"))
    power = int(np.floor(np.log10(highest)))
    scale, unit = (10.0**-power, f"$10^{{{power}}}$ ") if abs(power) > 1 else (1.0, "")
    for name, color, dash, width, label in shown:
        axes.plot(frequency, scale * dataset[name], color=color, linestyle=dash, lw=width, label=label)
    peak = frequency[int(dataset.psd_ground.values.argmax())]
    axes.set(xlim=(0, min(5 * peak, frequency[-1])), ylim=(0, 1.1 * scale * highest))
    axes.set(xlabel="circular frequency [rad/s]", ylabel=rf"two-sided PSD [{unit}m$^2$/s$^3$]")
    legend_beside(axes)
