"""Figs. 1 and 2, of a motion: pseudo energy radius, energies and critical gap over the periods."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.motions import SHOWN_ENERGIES
from stochlin.views.figures.pictures import MEDIUM_PANEL, PICTURES, SQUARE, in_a_row, in_cm, planes
from stochlin.views.shared.blocks import typeset
from stochlin.views.shared.style import CURVES, quantity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# levels, of which those below 1 are unsafe
OF_RATIO = (0.5, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0)
TRACE: Any = {"color": "0.35", "lw": 0.7}
PEAK_LINE: Any = {"color": "#8c2d04", "linestyle": (0, (6, 1.5))}


@PICTURES.register("portrait")
def draw_portrait(figure: Figure, dataset: xr.Dataset) -> None:
    """Phase portrait with the circle of the pseudo energy radius, and the radius over time."""
    from matplotlib.patches import Circle

    plane, history = in_a_row(figure, 2, SQUARE)
    states = [in_cm(dataset[name]) for name in ("displacement", "velocity_over_frequency")]
    radius = in_cm(dataset.radius)
    largest = in_cm(dataset.pseudo_energy_radius)
    plane.plot(*states, label="motion", **TRACE)
    plane.add_patch(Circle((0, 0), float(largest), fill=False, lw=1.6, zorder=3, **PEAK_LINE))
    plane.set_aspect("equal", adjustable="datalim")
    plane.set(xlabel=quantity(states[0]), ylabel=quantity(states[1]))
    history.plot(dataset.time, radius, label=quantity(radius), color="0.1", lw=1.0)
    history.axhline(float(largest), label=quantity(largest), **PEAK_LINE)
    history.set(
        xlim=(float(dataset.time[0]), float(dataset.time[-1])), ylim=(0, 1.06 * float(largest))
    )
    history.set(xlabel=quantity(dataset.time), ylabel=quantity(radius))


@PICTURES.register("energies")
def draw_energies(figure: Figure, dataset: xr.Dataset) -> None:
    """Largest radius and energies so far over time, of the elastic and the yielding structure."""
    times = float(dataset.significant_begin), float(dataset.significant_end)
    shown = [("pseudo energy radius", "radius")]
    shown += [(f"{kind} energy", f"{kind}_energy_radius") for kind in SHOWN_ENERGIES]
    time = dataset.time
    factors = dataset.reduction_factor.values
    for axes, factor in zip(in_a_row(figure, 2, MEDIUM_PANEL, shared=True), factors, strict=True):
        axes.axvspan(*times, color="0.92", label="90 % of the motion's energy")
        for (label, name), (color, dash) in zip(shown, CURVES, strict=False):
            values = in_cm(dataset[name].sel(reduction_factor=factor)).values
            if values.max() > 0:
                values = np.maximum.accumulate(values) if name == "radius" else values
                axes.plot(time, values, label=label, color=color, linestyle=dash, lw=1.0)
        axes.set(xlim=(float(time[0]), float(time[-1])), ylim=(0, None), xlabel=quantity(time))
        axes.set_ylabel(quantity(in_cm(dataset.radius)))
        axes.set_title("elastic" if factor == 1 else f"R = {factor:g}", loc="left")
        axes.label_outer()


@PICTURES.register("critical_gap")
def draw_critical_gap(figure: Figure, dataset: xr.Dataset) -> None:
    """Peak of ``u_1 - u_2`` in the record, and eqs. (3) and (4) over it, over the periods."""
    over = "period_1", "period_2"
    largest = in_cm(dataset.separation.assign_attrs(dataset.critical_gap.attrs)).transpose(*over)
    ratio = dataset.critical_gap / dataset.separation.where(dataset.separation > 0)
    ratio = ratio.assign_attrs(units="1", long_name="eqs. (3) and (4) over the largest u1 - u2")
    left, right = in_a_row(figure, 2, SQUARE, shared=True)
    planes(figure, [left], [(typeset("largest u1 - u2"), largest)], _levels(float(largest.max())))
    shown = ratio.rename("ratio").transpose(*over).clip(OF_RATIO[0], OF_RATIO[-1], keep_attrs=True)
    planes(figure, [right], [("formula over record", shown)], np.array(OF_RATIO), thick=1.0)


def _levels(highest: float) -> np.ndarray:
    """Levels 0 and 1, 2, 3, 5, 10, ... from a thousandth of the highest value to beyond it."""
    from matplotlib.ticker import LogLocator

    lowest = highest / 1000
    series = np.asarray(
        LogLocator(subs=(1, 2, 3, 5), numticks=10).tick_values(lowest, 10 * highest)
    )
    series = series[series >= lowest]
    return np.array([0.0, *series[: np.searchsorted(series, highest) + 1]])
