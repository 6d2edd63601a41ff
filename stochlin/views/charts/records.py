"""Pictures of recorded motions: Figs. 1 and 2, and the spectrum of the pseudo energy radius."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.analyses.charts.records import ENERGIES
from stochlin.views.charts.charts import AXES, PICTURES
from stochlin.views.shared.style import CURVES, contours_of, legend_beside, plain_ticks, shades
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TICKS = (0.1, 0.2, 0.5, 1, 2, 5)  # s
CENTIMETRES = 100.0


@PICTURES.register("portrait")
def draw_portrait(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 1: phase portrait with the circle of the pseudo energy radius, and the radius over time."""
    plane = figure.add_axes((0.1, 0.27, 0.36, 0.6))
    history = figure.add_axes((0.58, 0.27, 0.37, 0.6))
    trace: Any = {"color": "0.35", "lw": 0.7}
    circle: Any = {"color": "#8c2d04", "linestyle": (0, (6, 1.5))}
    states = ("displacement", "velocity_over_frequency")
    plane.plot(*(CENTIMETRES * dataset[name] for name in states), **trace)
    plane.plot(*(CENTIMETRES * dataset[f"circle_{name}"] for name in states), **circle)
    plane.set_aspect("equal", adjustable="datalim")
    plane.set(xlabel="$u$ [cm]", ylabel=r"$\dot u/\omega$ [cm]")
    largest = CENTIMETRES * float(dataset.pseudo_energy_radius)
    history.plot(dataset.time, CENTIMETRES * dataset.radius, **trace)
    history.axhline(largest, **circle)
    end = float(dataset.time[-1])
    history.text(end, 1.01 * largest, r"$r_{PER}$", color="#8c2d04", ha="right", va="bottom")
    history.set(xlim=(float(dataset.time[0]), end), ylim=(0, 1.12 * largest), xlabel="time [s]")
    history.set_ylabel("$r$ [cm]")


@PICTURES.register("energies")
def draw_energies(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 1b: radius and energies over time and period, elastic above, yielding below."""
    times = float(dataset.significant_begin), float(dataset.significant_end)
    shown = (
        ("pseudo energy\nradius", "radius", "pseudo_energy_radius"),
        *(
            (f"{kind} energy", f"{kind}_energy_radius", f"{kind}_energy_radius_at_end")
            for kind in ENERGIES
        ),
    )
    for row, factor in enumerate(dataset.reduction_factor.values):
        one, bottom = dataset.sel(reduction_factor=factor), 0.57 - 0.34 * row
        history = figure.add_axes((0.1, bottom, 0.28, 0.3))
        spectrum = figure.add_axes((0.46, bottom, 0.28, 0.3))
        history.axvspan(*times, color="0.92", label="5 to 95 % of the\nrecord's energy")
        for (label, over_time, at_end), (color, dash) in zip(shown, CURVES, strict=False):
            if float(one[at_end].max()) > 0:
                style: Any = {"color": color, "linestyle": dash, "lw": 1.0}
                spectrum.plot(one.period, CENTIMETRES * one[at_end], **style)
                values = (
                    np.maximum.accumulate(one[over_time].values)
                    if over_time == "radius"
                    else one[over_time]
                )
                history.plot(one.time, CENTIMETRES * values, label=label, **style)
        history.set(xlim=(float(one.time[0]), float(one.time[-1])), ylim=(0, None))
        history.set_ylabel("elastic [cm]" if factor == 1 else f"R = {factor:g} [cm]")
        spectrum.set(xscale="log", xlim=(float(one.period[0]), float(one.period[-1])), ylim=(0, None))
        plain_ticks(spectrum.xaxis, TICKS)
        for axes, name in ((history, "time [s]"), (spectrum, "period [s]")):
            axes.set_xlabel(name if row else "")
            axes.tick_params(labelbottom=bool(row))
    figure.legend(*history.get_legend_handles_labels(), loc="upper left", bbox_to_anchor=(0.765, 0.88))


@PICTURES.register("per_spectrum")
def draw_per_spectrum(figure: Figure, dataset: xr.Dataset) -> None:
    """Pseudo energy radius and peak displacement over the period."""
    axes = figure.add_axes(AXES)
    shown = (
        ("pseudo_energy_radius", "pseudo energy\nradius"),
        ("displacement_max", "largest\ndisplacement"),
    )
    for (name, label), (color, dash) in zip(shown, CURVES, strict=False):
        axes.plot(dataset.period, CENTIMETRES * dataset[name], color=color, linestyle=dash, label=label)
    axes.set_xscale("log")
    plain_ticks(axes.xaxis, TICKS)
    axes.set(xlim=(float(dataset.period[0]), float(dataset.period[-1])), ylim=(0, None))
    axes.set(xlabel="period [s]", ylabel="radius, displacement [cm]")
    legend_beside(axes)


@PICTURES.register("critical_gap")
def draw_critical_gap(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 2: peak of ``u_1 - u_2`` in the record, and eqs. (3) and (4), over the periods."""
    from matplotlib.colors import BoundaryNorm

    panels = (("separation", "largest u1 - u2"), ("critical_gap", "eqs. (3) and (4)"))
    highest = CENTIMETRES * max(float(dataset[name].max()) for name, _ in panels)
    levels = _one_two_five(highest)
    for n, (name, title) in enumerate(panels):
        axes = figure.add_axes((0.1 + 0.4 * n, 0.27, 0.36, 0.58))
        x, y = dataset.period_1.values, dataset.period_2.values
        gap = CENTIMETRES * dataset[name].transpose("period_2", "period_1").values
        axes.set(xscale="log", yscale="log")
        fill, draw_lines = contours_of(axes, x, y, gap)
        filled = fill(levels=levels, cmap=shades(), norm=BoundaryNorm(levels, 256))
        lines = draw_lines(levels=levels[1:], colors="0.1", linewidths=0.5)
        axes.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))
        axes.clabel(
            lines, manual=_first_crossings(x, y, gap, levels), fontsize=7, fmt="%g", inline_spacing=1
        )
        axes.set_title(typeset(title), loc="left", size=9)
        axes.grid(visible=False)
        axes.set_box_aspect(1)
        plain_ticks(axes.xaxis, TICKS)
        plain_ticks(axes.yaxis, TICKS)
        axes.set(xlabel="$T_1$ [s]", ylabel="$T_2$ [s]" if n == 0 else "")
        axes.tick_params(labelleft=n == 0)
    bar = figure.colorbar(
        filled, cax=figure.add_axes((0.885, 0.27, 0.02, 0.58)), label="gap [cm]", format="%g"
    )
    bar.ax.grid(visible=False)


@PICTURES.register("added_damping")
def draw_added_damping(figure: Figure, dataset: xr.Dataset) -> None:
    """Gap over added damping, with panels for damping in both structures and in each of them."""
    shown = (
        ("separation", "largest u1 - u2 in the record", "least_added_damping_recorded", "o"),
        ("critical_gap", "eqs. (3) and (4), energy radii", "least_added_damping", "s"),
    )
    added = 100 * dataset.added_damping.values
    gap = dataset.attrs.get("gap_m")
    highest = max(float(dataset[name].max()) for name, *_ in shown)
    for n, where in enumerate(dataset.damped.values):
        axes = figure.add_axes((0.1 + 0.3 * n, 0.25, 0.265, 0.53))
        one = dataset.sel(damped=where)
        for (name, label, least, marker), (color, dash) in zip(shown, CURVES, strict=False):
            axes.plot(added, CENTIMETRES * one[name], color=color, linestyle=dash, label=typeset(label))
            if gap is not None and np.isfinite(one[least]):
                place = 100 * float(one[least]), CENTIMETRES * gap
                axes.plot(*place, marker=marker, ms=6, mfc="w", color=color, zorder=4)
        if gap is not None:
            axes.axhline(CENTIMETRES * gap, color="0.5", lw=1, label="existing gap")
        axes.set_title(f"added to {where}", loc="left", size=9)
        axes.set(xlim=(0, added[-1]), ylim=(0, 1.05 * CENTIMETRES * max(highest, gap or 0)))
        axes.set(xlabel="added damping [%]", ylabel="gap [cm]" if n == 0 else "")
        axes.tick_params(labelleft=n == 0)
    handles = axes.get_legend_handles_labels()
    figure.legend(*handles, loc="lower left", bbox_to_anchor=(0.09, 0.83), ncols=3, fontsize=8)


def _first_crossings(
    x: np.ndarray, y: np.ndarray, gap: np.ndarray, levels: list[float]
) -> list[tuple[float, float]]:
    """Positions of contour labels on the lines that reach the left side, away from the diagonal."""
    column = min(len(x) // 12, len(x) - 1)
    above = [gap[:, column] > level for level in levels[1:]]
    return [(x[column], y[int(np.argmax(over))]) for over in above if over.any() and not over[0]]


def _one_two_five(highest: float) -> list[float]:
    """Levels 0 and 1, 2, 5, 10, ... from a hundredth of the highest value to beyond it."""
    decade = np.floor(np.log10(highest))
    series = [m * 10.0 ** (decade + n) for n in (-2, -1, 0, 1) for m in (1, 2, 5)]
    end = next(n for n, value in enumerate(series) if value >= highest)
    return [0.0, *(value for value in series[: end + 1] if value >= highest / 100)]
