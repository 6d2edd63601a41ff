"""Pictures of recorded motions: Figs. 1 and 2, and the spectrum of the pseudo energy radius."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.records import ENERGIES
from stochlin.views.charts.charts import HEIGHT, PICTURES, SQUARE, finish
from stochlin.views.charts.panels import (
    CENTIMETRES,
    bar_beside,
    in_a_row,
    in_cm,
    is_narrow,
    legend,
    panels,
)
from stochlin.views.charts.planes import contours_of, label_contours, shades
from stochlin.views.shared.style import CURVES, plain_ticks, quantity
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TICKS = (0.1, 0.2, 0.5, 1, 2, 5)  # s


@PICTURES.register("portrait")
def draw_portrait(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 1: phase portrait with the circle of the pseudo energy radius, and the radius over time."""
    plane, history = in_a_row(figure, 2, SQUARE)
    trace: Any = {"color": "0.35", "lw": 0.7}
    circle: Any = {"color": "#8c2d04", "linestyle": (0, (6, 1.5))}
    states = [in_cm(dataset[name]) for name in ("displacement", "velocity_over_frequency")]
    radius, largest = in_cm(dataset.radius), in_cm(dataset.pseudo_energy_radius)
    plane.plot(*states, **trace)
    plane.plot(*(in_cm(dataset[f"circle_{state.name}"]) for state in states), **circle)
    plane.set_aspect("equal", adjustable="datalim")
    plane.set(xlabel=quantity(states[0]), ylabel=quantity(states[1]))
    history.plot(dataset.time, radius, label=quantity(radius), **trace)
    history.axhline(float(largest), label=quantity(largest), **circle)
    history.set(xlim=(float(dataset.time[0]), float(dataset.time[-1])), ylim=(0, 1.06 * float(largest)))
    history.set(xlabel=quantity(dataset.time), ylabel=quantity(radius))
    legend(figure, [history])


@PICTURES.register("energies")
def draw_energies(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 1b: radius and energies over time and period, elastic above, yielding below."""
    times = float(dataset.significant_begin), float(dataset.significant_end)
    shown = (
        ("pseudo energy radius", "radius", "pseudo_energy_radius"),
        *(
            (f"{kind} energy", f"{kind}_energy_radius", f"{kind}_energy_radius_at_end")
            for kind in ENERGIES
        ),
    )
    across = 1 if is_narrow(figure) else 2
    every = panels(figure, 4 // across, across, 2.0).reshape(2, 2)
    for (history, spectrum), factor in zip(every, dataset.reduction_factor.values, strict=True):
        response = dataset.sel(reduction_factor=factor)
        history.axvspan(*times, color="0.92", label="5 to 95 % of the record's energy")
        for (label, over_time, at_end), (color, dash) in zip(shown, CURVES, strict=False):
            if float(response[at_end].max()) > 0:
                style: Any = {"color": color, "linestyle": dash, "lw": 1.0}
                values = in_cm(response[over_time])
                if over_time == "radius":
                    values = values.copy(data=np.maximum.accumulate(values.values))
                history.plot(response.time, values, label=label, **style)
                spectrum.plot(response.period, in_cm(response[at_end]), **style)
        history.set(xlim=(float(response.time[0]), float(response.time[-1])), ylim=(0, None))
        spectrum.set(
            xscale="log", xlim=(float(response.period[0]), float(response.period[-1])), ylim=(0, None)
        )
        plain_ticks(spectrum.xaxis, TICKS)
        strength = "elastic" if factor == 1 else f"R = {factor:g}"
        for axes, along in ((history, response.time), (spectrum, response.period)):
            axes.set(xlabel=quantity(along), ylabel=quantity(in_cm(response.radius)))
            axes.set_title(strength, loc="left")
    legend(figure, [history], columns=3)


@PICTURES.register("per_spectrum")
def draw_per_spectrum(figure: Figure, dataset: xr.Dataset) -> None:
    """Pseudo energy radius and peak displacement over the period."""
    [axes] = in_a_row(figure, 1, HEIGHT - 1.2)
    names = ("pseudo_energy_radius", "displacement_max")
    for name, (color, dash) in zip(names, CURVES, strict=False):
        table = in_cm(dataset[name])
        axes.plot(dataset.period, table, color=color, linestyle=dash, label=quantity(table))
    axes.set_xscale("log")
    plain_ticks(axes.xaxis, TICKS)
    axes.set(xlim=(float(dataset.period[0]), float(dataset.period[-1])), ylim=(0, None))
    axes.set(xlabel=quantity(dataset.period), ylabel=quantity(in_cm(dataset.pseudo_energy_radius)))
    legend(figure, [axes], columns=1)


@PICTURES.register("critical_gap")
def draw_critical_gap(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 2: peak of ``u_1 - u_2`` in the record, and eqs. (3) and (4), over the periods."""
    from matplotlib.colors import BoundaryNorm

    drawn = (("separation", "largest u1 - u2"), ("critical_gap", "eqs. (3) and (4)"))
    tables = [in_cm(dataset[name]) for name, _ in drawn]
    levels = _levels(max(float(table.max()) for table in tables))
    every = in_a_row(figure, 2, SQUARE, sharex=True, sharey=True)
    labels = []
    for axes, table, (_, title) in zip(every, tables, drawn, strict=True):
        x, y = dataset.period_1.values, dataset.period_2.values
        gap = table.transpose("period_2", "period_1").values
        axes.set(xscale="log", yscale="log")
        fill, draw_lines = contours_of(axes, x, y, gap)
        filled = fill(levels=levels, cmap=shades(), norm=BoundaryNorm(levels, 256))
        lines = draw_lines(levels=levels[1:], colors="0.1", linewidths=0.5)
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        labels.append(partial(label_contours, axes, lines, "%g"))
        axes.set_title(typeset(title), loc="left")
        axes.grid(visible=False)
        axes.set_box_aspect(1)
        plain_ticks(axes.xaxis, TICKS)
        plain_ticks(axes.yaxis, TICKS)
        axes.set(xlabel=quantity(dataset.period_1), ylabel=quantity(dataset.period_2))
        axes.label_outer()
    bar_beside(figure, filled, every, tables[1])
    finish(figure, labels)


@PICTURES.register("added_damping")
def draw_added_damping(figure: Figure, dataset: xr.Dataset) -> None:
    """Gap over added damping, with panels for damping in both structures and in each of them."""
    shown = (
        ("separation", "largest u1 - u2 in the record", "least_added_damping_recorded", "o"),
        ("critical_gap", "eqs. (3) and (4), energy radii", "least_added_damping", "s"),
    )
    gap = dataset.attrs.get("gap_m")
    highest = max(float(dataset[name].max()) for name, *_ in shown)
    every = in_a_row(figure, dataset.sizes["damped"], SQUARE, sharex=True, sharey=True)
    added = dataset.added_damping
    for axes, where in zip(every, dataset.damped.values, strict=True):
        curves = dataset.sel(damped=where)
        for (name, label, least, marker), (color, dash) in zip(shown, CURVES, strict=False):
            axes.plot(added, in_cm(curves[name]), color=color, linestyle=dash, label=typeset(label))
            if gap is not None and np.isfinite(curves[least]):
                place = float(curves[least]), CENTIMETRES * gap
                axes.plot(*place, marker=marker, ms=6, mfc="w", color=color, zorder=4)
        if gap is not None:
            axes.axhline(CENTIMETRES * gap, color="0.5", lw=1, label="existing gap")
        axes.set_title(f"added to {where}", loc="left")
        axes.set(xlim=(0, float(added[-1])), ylim=(0, 1.05 * CENTIMETRES * max(highest, gap or 0)))
        axes.set(xlabel=quantity(added), ylabel=quantity(in_cm(curves.critical_gap)))
        axes.label_outer()
    legend(figure, every[:1], columns=3)


def _levels(highest: float) -> list[float]:
    """Levels 0 and 1, 2, 3, 5, 10, ... from a thousandth of the highest value to beyond it."""
    decade = np.floor(np.log10(highest))
    series = [m * 10.0 ** (decade + n) for n in (-3, -2, -1, 0, 1) for m in (1, 2, 3, 5)]
    end = next(n for n, value in enumerate(series) if value >= highest)
    return [0.0, *(value for value in series[: end + 1] if value >= highest / 1000)]
