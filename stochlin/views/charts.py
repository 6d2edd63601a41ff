"""Pictures of chart datasets: curves, planes and spectra, readable in grey and at print size."""

from __future__ import annotations

import os
import textwrap
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.analyses.storage import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")
SIZE = (7.2, 4.6)  # inches: the width of a printed page
STYLE: Any = {
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.grid": True,
    "grid.color": "0.88",
    "grid.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "legend.frameon": False,
    "svg.hashsalt": "stochlin",  # the same input gives the same file
}
# Dark to light, each with a dash of its own: told apart in colour, in grey and by line style.
CURVES = (
    ("#1b1b1b", "-"),
    ("#8c2d04", (0, (6, 1.5))),
    ("#2166ac", (0, (4, 1.5, 1, 1.5))),
    ("#d07a00", (0, (2, 1))),
    ("#4d9a8a", (0, (6, 1.5, 1, 1.5, 1, 1.5))),
    ("#9e9ac8", (0, (1, 1))),
)
COMPARISONS = (("rho_elastic", "0.35", "x", "elastic"), ("rho_white_noise", "0.6", "o", "eq. (4)"))
CAPTION_WIDTH = 110  # characters
TICKS = (0.1, 0.25, 0.5, 1, 2, 4)
NAMES = {
    "damping": r"$\xi$",
    "reduction_factor": "R",
    "rho": r"correlation coefficient $\rho$",
    "amplification": "amplification D, inelastic / elastic",
}


def draw(dataset: xr.Dataset) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `stochlin.analyses.design_charts` makes them, from memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        With the parameters below the axes and the legend beside them.

    Raises
    ------
    ValueError
        If the dataset is no chart.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=SIZE)
        axes = figure.add_axes((0.1, 0.25, 0.64, 0.66))
        if "psd_record" in dataset:
            _spectra(axes, dataset)
        elif "period_ratio_2" in dataset.dims:
            _plane(figure, axes, dataset)
        elif "period_ratio" in dataset.dims:
            _curves(axes, dataset)
        else:
            raise ValueError(
                f"dataset has dimensions {tuple(dataset.dims)}; allowed: a chart, over period_ratio, "
                "over period_ratio_1 and period_ratio_2, or a record's spectra"
            )
        axes.set_title(dataset.attrs["title"], loc="left")
        lines = dataset.attrs.get("caption", "").splitlines()
        caption = "\n".join(textwrap.fill(line, CAPTION_WIDTH) for line in lines)
        figure.text(0.1, 0.135, caption, va="top", size=8)
        figure.text(0.1, 0.03, dataset.attrs.get("comment", ""), va="top", size=7, style="italic")
    return figure


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture whole or not at all; ``.png``, ``.svg`` or ``.pdf``."""
    import matplotlib as mpl

    suffix = os.path.splitext(path)[1][1:].lower()
    if suffix not in FORMATS:
        raise ValueError(f"path = {os.fspath(path)!r} ends in {suffix!r}; allowed: {', '.join(FORMATS)}")
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
    with mpl.rc_context(STYLE), whole_file(path) as temporary:
        figure.savefig(temporary, dpi=200, metadata=undated)


def _curves(axes: Axes, dataset: xr.Dataset) -> None:
    name = "rho" if "rho" in dataset else "amplification"
    table = dataset[name]
    (family,) = (d for d in table.dims if d != "period_ratio")
    x = table.period_ratio.values
    for (color, dash), value in zip(cycle(CURVES), table[family].values, strict=False):
        label = f"{NAMES[str(family)]} = {value:g}"
        axes.plot(x, table.sel({family: value}), color=color, linestyle=dash, label=label)
    for other, color, marker, label in COMPARISONS:
        if other in dataset:
            axes.plot(
                x,
                dataset[other],
                color=color,
                lw=0.8,
                marker=marker,
                ms=4,
                mfc="none",
                markevery=16,
                label=label,
            )
    axes.set_xscale("log")
    _ratio_ticks(axes.xaxis, x)
    axes.set_xlabel(table.period_ratio.attrs.get("long_name", "period ratio"))
    axes.set_ylabel(NAMES[name])
    axes.set_xlim(x[0], x[-1])
    if name == "rho":
        low = min(float(dataset[v].min()) for v in dataset.data_vars if str(v).startswith("rho"))
        axes.set_ylim(min(0.0, np.floor(low * 10) / 10), 1.02)
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)


def _plane(figure: Figure, axes: Axes, dataset: xr.Dataset) -> None:
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    rho = dataset.rho
    x, y = rho.period_ratio_1.values, rho.period_ratio_2.values
    lowest = np.floor(float(rho.min()) * 10) / 10
    levels = np.round(np.arange(min(lowest, 0.0), 1.01, 0.1), 10)
    # The upper part of cividis: lightness grows with the value, black lines stay legible on it.
    shades = ListedColormap(colormaps["cividis"](np.linspace(0.35, 1, 256)))
    filled = axes.contourf(x, y, rho.values.T, levels=levels, cmap=shades)
    lines = axes.contour(x, y, rho.values.T, levels=levels, colors="0.1", linewidths=0.6)
    axes.clabel(lines, levels=levels[::2], fontsize=7, fmt="%.1f")
    axes.grid(visible=False)
    axes.set_xscale("log")
    axes.set_yscale("log")
    _ratio_ticks(axes.xaxis, x)
    _ratio_ticks(axes.yaxis, y)
    axes.set_box_aspect(1)
    axes.set_anchor("W")
    axes.set_xlabel("T1/Tg")
    axes.set_ylabel("T2/Tg")
    bar = figure.colorbar(filled, cax=figure.add_axes((0.57, 0.25, 0.025, 0.66)), label=NAMES["rho"])
    bar.ax.grid(visible=False)


def _spectra(axes: Axes, dataset: xr.Dataset) -> None:
    frequency = dataset.frequency.values
    shown = (
        ("psd_record", "0.75", "-", 0.6, "record, periodogram"),
        ("psd_smoothed", "0.35", "-", 1.2, "record, smoothed"),
        ("psd_ground", "#8c2d04", (0, (6, 1.5)), 1.8, "fitted ground"),
    )
    for name, color, dash, width, label in shown:
        axes.plot(frequency, dataset[name], color=color, linestyle=dash, lw=width, label=label)
    peak = frequency[int(dataset.psd_ground.values.argmax())]
    axes.set_xlim(0, min(5 * peak, frequency[-1]))
    highest = max(float(dataset[name].max()) for name in ("psd_smoothed", "psd_ground"))
    axes.set_ylim(0, 1.1 * highest)
    axes.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
    axes.set_xlabel("circular frequency [rad/s]")
    axes.set_ylabel(r"two-sided PSD [m$^2$/s$^3$]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)


def _ratio_ticks(axis: Axis, values: np.ndarray) -> None:
    from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

    ticks = [t for t in TICKS if values[0] / 1.001 <= t <= values[-1] * 1.001]
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))
