"""Pictures of chart datasets: curves, planes and spectra, readable in grey and at print size."""

from __future__ import annotations

import textwrap
from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.views.charts.comparisons import draw_comparison
from stochlin.views.charts.contacts import draw_histories, draw_loops, draw_restitution
from stochlin.views.charts.records import draw_critical_gap, draw_per_spectrum, draw_portrait
from stochlin.views.shared.style import CURVES, NAMES, STYLE, plane, ratio_ticks, tenths

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIZE = (7.2, 4.6)  # inches: the width of a printed page
COMPARISONS = (("rho_elastic", "0.35", "x", "elastic"), ("rho_white_noise", "0.6", "o", "eq. (4)"))
CAPTION_WIDTH, COMMENT_WIDTH = 110, 125  # characters


def draw(dataset: xr.Dataset) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        As the functions of ``stochlin.analyses.charts.design``, ``record_charts`` and
        ``contact_charts`` make them, from memory or from file.

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
        elif any(str(name).endswith("_difference") for name in dataset):
            axes.remove()
            draw_comparison(figure, dataset)
        elif "circle_displacement" in dataset:
            axes.remove()
            draw_portrait(figure, dataset)
        elif "critical_gap" in dataset:
            axes.remove()
            draw_critical_gap(figure, dataset)
        elif "scaled_force" in dataset:
            axes.remove()
            # Springs without a dashpot have a loop, and no damping ratio to be compared at.
            (draw_loops if "LinearSpring" in dataset.element else draw_histories)(figure, dataset)
        elif "restitution_hertz_damp" in dataset:
            axes.remove()
            draw_restitution(figure, dataset)
        elif "pseudo_energy_radius" in dataset:
            draw_per_spectrum(axes, dataset)
        elif "period_ratio_2" in dataset.dims:
            _plane(figure, axes, dataset)
        elif "period_ratio" in dataset.dims:
            _curves(axes, dataset)
        else:
            raise ValueError(
                f"dataset has dimensions {tuple(dataset.dims)}; allowed: a chart, over period_ratio, "
                "over period_ratio_1 and period_ratio_2, of contact elements, or of a record"
            )
        figure.text(0.1, 0.935, dataset.attrs["title"], size=10)
        lines = dataset.attrs.get("caption", "").splitlines()
        caption = "\n".join(textwrap.fill(line, CAPTION_WIDTH) for line in lines)
        figure.text(0.1, 0.135, caption, va="top", size=8)
        comment = textwrap.fill(dataset.attrs.get("comment", ""), COMMENT_WIDTH)
        figure.text(0.1, 0.05, comment, va="top", size=7, style="italic")
    return figure


def _curves(axes: Axes, dataset: xr.Dataset) -> None:
    name = "rho" if "rho" in dataset else "amplification"
    table = dataset[name]
    (family,) = (d for d in table.dims if d != "period_ratio")
    x = table.period_ratio.values
    for (color, dash), value in zip(cycle(CURVES), table[family].values, strict=False):
        label = value if family == "rule" else f"{NAMES[str(family)]} = {value:g}"
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
    ratio_ticks(axes.xaxis, x)
    axes.set_xlabel(table.period_ratio.attrs.get("long_name", "period ratio"))
    axes.set_ylabel(NAMES[name])
    axes.set_xlim(x[0], x[-1])
    if name == "rho":
        low = min(float(dataset[v].min()) for v in dataset.data_vars if str(v).startswith("rho"))
        axes.set_ylim(min(0.0, np.floor(low * 10) / 10), 1.02)
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)


def _plane(figure: Figure, axes: Axes, dataset: xr.Dataset) -> None:
    filled = plane(axes, dataset.rho, tenths(dataset.rho))
    axes.set_anchor("W")
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
