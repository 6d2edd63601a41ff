"""Pictures of chart datasets: curves, planes and spectra, readable in grey and at print size."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import cycle, product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.registry import Registry
from stochlin.views.charts.panels import (
    PRINT_STYLE,
    SCREEN_STYLE,
    arrange,
    bar_beside,
    in_a_row,
    legend,
    width_in_print,
)
from stochlin.views.charts.planes import contour_levels, plane
from stochlin.views.shared.style import CURVES, label_axis, plain_ticks, quantity, styled
from stochlin.views.shared.symbols import typeset
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Functions that draw the axes of a dataset into a figure, by its attribute ``chart`` or ``comparison``.
PICTURES: Registry[Callable[[Figure, xr.Dataset], None]] = Registry("chart", "stochlin.views.charts")
HEIGHT, PANEL, SQUARE = 4.6, 2.7, 2.9  # inches
SYMBOLS = {"damping": r"$\xi$", "reduction_factor": "R", "ductility": r"$\mu$"}
MARKERS = "os^Dvp"  # of the simulated points of each curve
LINES = {"rho": "ρ, linearized", "amplification": "D of standard deviations, linearized"}
TWICE = 1.96  # half a 95 % interval, in standard errors
POINTS: Any = {"ls": "none", "ms": 3.2, "mfc": "w", "mew": 0.8, "lw": 0.8, "zorder": 4}
SIMULATED = ("_of_peaks", "_simulated")  # endings; a picture has the first one, its comparison all
ENDINGS = ("_drift", "_effective", *SIMULATED, "_elastic", "_white_noise")  # of other methods
DECADES = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)  # ticks


@styled(SCREEN_STYLE)
def draw(dataset: xr.Dataset, *, comparison: bool = False, print_width: float | None = None) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result of the functions of ``stochlin.charts``, from memory or from file. Its attribute
        ``chart`` gives the kind of picture, and ``comparison`` that of its second picture.
    comparison : bool
        Whether to draw the second picture of the chart, with all methods beside one another.
    print_width : float, optional
        Width [m] of the picture in print, such as 0.084 for one column and 0.174 for two. It then has no
        title and no notes, and no text below 7 points. The default is a picture for the screen.

    Returns
    -------
    matplotlib.figure.Figure
        Figure with the legend above the panels and the parameters below them.

    Raises
    ------
    ValueError
        If the dataset is no chart, has no finite numbers or no comparison, or the width is out of range.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure

    kind = str(dataset.attrs.get("comparison", "")) if comparison else _kind(dataset)
    if not kind:
        raise ValueError("comparison = True; allowed: False, since this chart has no second picture")
    draw_axes = PICTURES.named(kind, "attribute chart")
    numbers = [array for array in dataset.data_vars.values() if array.dtype.kind == "f"]
    if numbers and not any(bool(np.isfinite(array).any()) for array in numbers):
        raise ValueError(
            "the chart has no finite number to draw; allowed: parameters in their ranges; its status "
            "names the cause"
        )
    with mpl.rc_context({} if print_width is None else PRINT_STYLE):
        figure = Figure(figsize=(width_in_print(print_width), HEIGHT))
        draw_axes(figure, dataset)
        arrange(figure, {} if print_width is not None else _words(dataset, comparison))
    return figure


def _words(dataset: xr.Dataset, comparison: bool) -> dict[str, str]:
    """Title, caption and comment of a picture; those of a plain one are about what it shows."""
    words = {key: str(dataset.attrs.get(key, "")) for key in ("title", "caption", "comment")}
    if comparison:
        return words
    return {key: str(dataset.attrs.get(f"plain_{key}", text)) for key, text in words.items()}


def _kind(dataset: xr.Dataset) -> str:
    """Kind of chart of a dataset, a name in `PICTURES`."""
    if "chart" in dataset.attrs:
        return str(dataset.attrs["chart"])
    dimensions, allowed = tuple(dataset.dims), ", ".join(PICTURES)
    raise ValueError(f"dataset over {dimensions} has no attribute chart; allowed: {allowed}")


def stem_of(dataset: xr.Dataset) -> str | None:
    """Name of the variable that other methods stand beside, if there are others."""
    keys = [str(key) for key in dataset]
    return next((key.removesuffix(end) for end in ENDINGS for key in keys if key.endswith(end)), None)


def shown(dataset: xr.Dataset) -> xr.DataArray:
    """Variable that a chart shows: the linearized one, or what there is in its place."""
    stem = stem_of(dataset)
    names = [] if stem is None else [f"{stem}{end}" for end in ("", "_drift", *SIMULATED)]
    names += [str(name) for name in dataset.data_vars if name != "status"]
    return dataset[next(name for name in names if name in dataset)]


def places(table: xr.DataArray, own: int) -> Iterator[tuple[str, dict[Hashable, Any]]]:
    """Titles of all panels, each with its position along all but so many last dimensions."""
    outer = table.dims[: max(0, table.ndim - own)]
    for values in product(*(table[dim].values for dim in outer)):
        titles = [title_of(dim, value) for dim, value in zip(outer, values, strict=True)]
        yield ", ".join(titles), dict(zip(outer, values, strict=True))


def title_of(dim: Hashable, value: Any) -> str:
    """What a panel or a curve is for: ``R = 4``, the name of a rule or of a ground."""
    if isinstance(value, str):
        return rule_label(value) if dim == "rule" else typeset(value)
    return f"{SYMBOLS.get(str(dim), dim)} = {value:g}"


@PICTURES.register("curves")
def _curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground, a curve for each strength, and its simulated points."""
    from matplotlib.lines import Line2D

    table = shown(dataset)
    names = [f"{stem_of(dataset)}{end}" for end in SIMULATED]
    points = next((dataset[name] for name in names if name in dataset), None)
    grounds = list(places(table, 2))
    every = in_a_row(
        figure, len(grounds), PANEL if len(grounds) > 1 else HEIGHT - 1.2, sharex=True, sharey=True
    )
    for axes, (title, place) in zip(every, grounds, strict=True):
        axes.set_title(title, loc="left")
        for (label, own), look, marker in zip(
            places(table.sel(place), 1), cycle(CURVES), cycle(MARKERS), strict=False
        ):
            curve = {**place, **own}
            row = table.sel(curve)
            if not bool(row.notnull().any()):
                continue
            style: Any = {"color": look[0], "label": label or quantity(table)}
            if points is None:
                axes.plot(row[row.dims[-1]], row, linestyle=look[1], **style)
                continue
            axes.plot(row[row.dims[-1]], row, linestyle=look[1], color=look[0])
            axes.plot([], [], linestyle=look[1], marker=marker, ms=3.2, mfc="w", mew=0.8, **style)
            draw_points(axes, dataset.sel(curve), str(points.name), marker=marker, color=look[0])
    set_axes(every, table, [table] if points is None else [table, points])
    more = []
    if points is not None:
        drawn = typeset(LINES.get(str(table.name), quantity(table)))
        more = [Line2D([], [], color="0.1", label=drawn)]
        more += [Line2D([], [], color="0.1", marker="o", label=quantity(points), **POINTS)]
    legend(figure, every, more=more)


def draw_points(axes: Axes, dataset: xr.Dataset, name: str, **look: Any) -> None:
    """Simulated points with their 95 % intervals, where they are known."""
    values = dataset[name]
    error = f"{name}_standard_error"
    if error not in dataset:
        error = f"{name.removesuffix('_simulated')}_standard_error"
    known = values.notnull().values
    x = values[values.dims[-1]].values[known]
    bars = TWICE * dataset[error].values[known] if error in dataset else None
    axes.errorbar(x, values.values[known], bars, **{**POINTS, **look})


def set_axes(every: list[Axes], table: xr.DataArray, drawn: list[xr.DataArray]) -> None:
    """Labels and ends of panels that share their axes."""
    across = table[table.dims[-1]]
    low, high = min(float(array.min()) for array in drawn), max(float(array.max()) for array in drawn)
    for axes in every:
        label_axis(axes, "x", across)
        axes.set(ylabel=quantity(table), xlim=(float(across[0]), float(across[-1])))
        if str(table.name).startswith("rho"):
            axes.set_ylim(min(0.0, np.floor(low * 10) / 10), 1.03)
        elif low > 0 and high > 5 * low:
            axes.set(yscale="log", ylim=(0.85 * low, 1.15 * high))
            plain_ticks(axes.yaxis, [tick for tick in DECADES if 0.85 * low <= tick <= 1.15 * high])
        axes.label_outer()


@PICTURES.register("plane")
def _plane(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground."""
    table = known(shown(dataset))
    levels = contour_levels(table)
    grounds = list(places(table, 2))
    every = in_a_row(figure, len(grounds), SQUARE, sharex=True, sharey=True)
    labels = []
    for axes, (title, place) in zip(every, grounds, strict=True):
        axes.set_title(title, loc="left")
        filled, label = plane(axes, table.sel(place), levels)
        axes.label_outer()
        labels.append(label)
    bar_beside(figure, filled, every, table)
    finish(figure, labels)


def finish(figure: Figure, labels: Sequence[Callable[[], Any]]) -> None:
    """Label contours, once the panels have their sizes."""
    figure.draw_without_rendering()
    for label in labels:
        label()


def known(table: xr.DataArray) -> xr.DataArray:
    """A variable without the rows and columns that were not simulated."""
    for dim in table.dims[-2:]:
        table = table.dropna(dim, how="all")
    return table


@PICTURES.register("spectra")
def _spectra(figure: Figure, dataset: xr.Dataset) -> None:
    [axes] = in_a_row(figure, 1, HEIGHT - 1.2)
    frequency = dataset.frequency.values
    drawn = (
        ("psd_record", "0.75", "-", 0.6, "record, periodogram"),
        ("psd_smoothed", "0.35", "-", 1.2, "record, smoothed"),
        ("psd_ground", "#8c2d04", (0, (6, 1.5)), 1.8, "fitted ground"),
    )
    highest = max(float(dataset[name].max()) for name in ("psd_smoothed", "psd_ground"))
    power = int(np.floor(np.log10(highest)))
    scale, unit = (10.0**-power, f"10^({power}) ") if abs(power) > 1 else (1.0, "")
    for name, color, dash, width, label in drawn:
        axes.plot(frequency, scale * dataset[name], color=color, linestyle=dash, lw=width, label=label)
    peak = frequency[int(dataset.psd_ground.values.argmax())]
    axes.set(xlim=(0, min(5 * peak, frequency[-1])), ylim=(0, 1.1 * scale * highest))
    density = dataset.psd_ground.copy(deep=False)
    density.attrs["units"] = f"{unit}{density.attrs['units']}"
    axes.set(xlabel=quantity(dataset.frequency), ylabel=quantity(density))
    legend(figure, [axes])
