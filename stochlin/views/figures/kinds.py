"""Kinds of pictures that several charts have: curves, planes, and both methods beside one another."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.figures.charts import HEIGHT, MEMORY, PICTURES, is_slow
from stochlin.views.figures.panels import bar_beside, in_a_row, is_narrow, panels, places
from stochlin.views.shared.style import CURVES, label_axis, plain_ticks, quantity
from stochlin.views.shared.symbols import typeset
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import Colormap
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure

PANEL, SQUARE, SMALL_PANEL, SMALL_SQUARE = 2.7, 2.9, 1.75, 2.4  # inches
MARKERS = "os^Dvp", "x*1234"  # of the simulated points of each curve, and of those in finite motions
TWICE = 1.96  # half a 95 % interval, in standard errors
POINT: Any = {"ls": "none", "ms": 3.2, "mew": 0.8}
OPEN = "simulated, slow drift"  # label of open points
DECADES = (0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100)  # ticks
# Label and look of every variable in a comparison of methods; of simulated ones the marker.
METHODS: dict[str, tuple[str, Any]] = {
    "": ("linearized", {"color": CURVES[0][0], "linestyle": CURVES[0][1]}),
    "_drift": ("drift closure", {"color": CURVES[1][0], "linestyle": CURVES[1][1]}),
    "_elastic": ("elastic, this ground", {"color": "0.45", "linestyle": (0, (1, 1.5)), "lw": 0.9}),
    "_white_noise": ("elastic, eq. (4)", {"color": "0.6", "linestyle": "-", "lw": 0.9}),
}
SIMULATED = {"_of_peaks": "^", "_simulated": "o", "_in_motions": "x"}  # markers
EDGE = 0.05  # of an axis: labels of contours nearer to its ends would be cut
SHORT = 0.1  # of an axis: contours without a label
DIFFERENCES = np.array([0.1, 0.2, 0.4, 0.6, 0.8, 1.0, 1.5, 2.0])  # levels; within 0.1 is white


@PICTURES.register("curves")
def draw_curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground, a curve for each strength, and the points that ``points`` names."""
    table = shown(dataset)
    points = [dataset[name] for name in dataset.attrs.get("points", "").split()]
    grounds = list(places(table, 2))
    height = PANEL if len(grounds) > 1 else HEIGHT - 1.2
    every = in_a_row(figure, len(grounds), height, shared=True)
    for axes, (title, place) in zip(every, grounds, strict=True):
        axes.set_title(title, loc="left")
        looks = zip(places(table.sel(place), 1), cycle(CURVES), *map(cycle, MARKERS), strict=False)
        for (label, along), (color, dash), *markers in looks:
            row = table.sel({**place, **along})
            if not bool(row.notnull().any()):
                continue
            style: Any = {"color": color, "linestyle": dash, "label": label or quantity(table)}
            if points:  # on no point of the curve, but in the legend
                style |= {"marker": markers[0], "markevery": [], "ms": POINT["ms"]}
            for values, marker in zip(points, markers, strict=False):
                draw_points(axes, dataset.sel({**place, **along}), values, marker, color)
            axes.plot(row[row.dims[-1]], row, **style)
    set_axes(every, table, [table, *points])
    if points:
        text = typeset(table.attrs.get("curve_label", quantity(table)))
        every[0].plot([], [], color="0.1", label=text)
    for values, markers_of in zip(points, MARKERS, strict=False):
        draw_points(every[0], dataset, values, markers_of[0], "0.1", legend=True)


def shown(dataset: xr.Dataset) -> xr.DataArray:
    """Variable that a chart shows: the one that ``shows`` names, or the first one that is no status."""
    first = next(name for name in dataset.data_vars if name != "status")
    return dataset[dataset.attrs.get("shows", first)]


def draw_points(
    axes: Axes, dataset: xr.Dataset, points: xr.DataArray, marker: str, color: str, legend: bool = False
) -> None:
    """Simulated points with 95 % intervals, open where their plastic drift has a long memory.

    For the ``legend``, their names in place of the points.
    """
    error, *memory = points.attrs["ancillary_variables"].split()
    values = dataset[points.name]
    slow = is_slow(dataset) if memory else xr.zeros_like(values, bool)
    for label, where, face in ((quantity(points), ~slow, color), (OPEN, slow, "w")):
        part = values.where(where)
        if not bool(part.notnull().any()):
            continue
        look: Any = {"marker": marker, "color": color, "mfc": face, **POINT}
        if legend:
            axes.plot([], [], label=label, **look)
        else:
            bars = TWICE * dataset[error].values
            axes.errorbar(part[part.dims[-1]], part, bars, lw=0.8, zorder=4, **look)


def set_axes(every: Sequence[Axes], table: xr.DataArray, drawn: Sequence[xr.DataArray]) -> None:
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


@PICTURES.register("compared_curves")
def compare_curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each strength and ground, with all methods and the simulated points."""
    table = shown(dataset)
    grounds = list(places(table, 2))
    strengths = list(places(table.sel(grounds[0][1]), 1))
    columns = len(grounds) if len(grounds) > 1 or len(strengths) == 1 else 2
    rows = -(-len(grounds) * len(strengths) // columns)
    every = panels(figure, rows, columns, SMALL_PANEL, shared=True)
    named = [(f"{name}\n" if name else "", place) for name, place in grounds]
    for n, (strength, along) in enumerate(strengths):
        for axes, (name, place) in zip(every[n * len(grounds) :], named, strict=False):
            axes.set_title(f"{name if n == 0 else ''}{strength}", loc="left")
            _compared(axes, dataset.sel({**place, **along}), str(table.name))
    for axes in every[len(grounds) * len(strengths) :]:
        axes.remove()
    ends = [f"{table.name}{end}" for end in (*METHODS, "_effective", *SIMULATED)]
    drawn = every[: len(grounds) * len(strengths)]
    set_axes(drawn, table, [dataset[name] for name in ends if name in dataset])
    figure.supylabel(quantity(table), size="medium")
    for axes in drawn:
        axes.set_ylabel("")


def _compared(axes: Axes, dataset: xr.Dataset, stem: str) -> None:
    """All methods in one panel."""
    lines = [(dataset.get(f"{stem}{end}"), text, look) for end, (text, look) in METHODS.items()]
    for rule, (color, dash) in zip(dataset.get("rule", []), CURVES[2:], strict=False):
        effective = dataset[f"{stem}_effective"].sel(rule=rule)
        lines.append((effective, rule_label(rule.item()), {"color": color, "linestyle": dash}))
    for curve, text, look in lines:
        if curve is not None:
            axes.plot(curve[curve.dims[-1]], curve, label=text, **look)
    for end, marker in SIMULATED.items():
        if (points := dataset.get(f"{stem}{end}")) is not None:
            draw_points(axes, dataset, points, marker, "0.1")
            draw_points(axes, dataset, points, marker, "0.1", legend=True)


@PICTURES.register("plane")
def draw_plane(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground."""
    table = shown(dataset)
    grounds = list(places(table, 2))
    every = in_a_row(figure, len(grounds), SQUARE, shared=True)
    named = [(title, table.sel(place)) for title, place in grounds]
    planes(figure, every, named, contour_levels(table))
    number_contours(figure)


@PICTURES.register("compared_planes")
def compare_planes(figure: Figure, dataset: xr.Dataset) -> None:
    """Planes by linearization, drift closure and simulation, and the difference; a column a ground."""
    methods = {"rho": "linearized", "rho_drift": "drift closure", "rho_simulated": "simulated"}
    tables = {text: simulated_part(dataset[name]) for name, text in methods.items() if name in dataset}
    if "simulated" in tables:
        difference = tables["linearized"] - tables["simulated"]
        name = "ρ, linearized minus simulated"
        tables["difference"] = difference.assign_attrs(units="1", long_name=name)
    grounds = list(places(shown(dataset), 2))
    across = len(grounds)
    height = min(figure.get_figwidth() / across, SMALL_SQUARE) + 0.1
    every = panels(figure, len(tables), across, height, shared=True)
    line = "\n" if is_narrow(figure) else ", "
    heads = [f"{name}\n".replace(", ", line).lstrip() for name, _ in grounds]
    named = [
        (f"{head if n == 0 else ''}{text}", table.sel(place))
        for n, (text, table) in enumerate(tables.items())
        for head, (_, place) in zip(heads, grounds, strict=True)
    ]
    count = across * sum(text != "difference" for text in tables)
    alike = contour_levels(*(table for text, table in tables.items() if text != "difference"))
    planes(figure, every[:count], named[:count], alike)
    if count < len(every):
        largest = float(np.abs(tables["difference"]).max())
        levels = DIFFERENCES[: 1 + np.searchsorted(DIFFERENCES, largest)]
        planes(figure, every[count:], named[count:], np.concatenate([-levels[::-1], levels]))
    if "simulated" in tables:
        memory, limit = simulated_part(dataset[MEMORY]), dataset.attrs["longest_memory_s"]
        for axes, (_, place) in zip(every[-2 * across :], [*grounds, *grounds], strict=True):
            x, y = (memory[name].values for name in memory.dims[-2:])
            values = memory.sel(place).values.T
            if values.max() > limit:
                axes.contourf(x, y, values, [limit, values.max()], colors="none", hatches=["////"])
    number_contours(figure)


def simulated_part(table: xr.DataArray) -> xr.DataArray:
    """A variable without the rows and columns that were not simulated."""
    for dim in table.dims[-2:]:
        table = table.dropna(dim, how="all")
    return table


def planes(
    figure: Figure, every: Sequence[Axes], tables: Sequence[tuple[str, xr.DataArray]], levels: np.ndarray
) -> None:
    """Filled contours of tables by their titles, on these levels, and the bar of their shades."""
    from matplotlib.colors import BoundaryNorm

    shades = _shades(levels)
    for axes, (title, table) in zip(every, tables, strict=True):
        across, up = (table[name] for name in table.dims)
        label_axis(axes, "x", across)
        label_axis(axes, "y", up)
        fill, draw_lines = _contours(axes, across.values, up.values, table.values.T)
        filled = fill(levels=levels, cmap=shades, norm=BoundaryNorm(levels, shades.N))
        below = levels < float(table.max()) - 1e-9  # at the very top a line would be dots along a ridge
        draw_lines(levels=levels[below], colors="0.1", linewidths=0.6)
        axes.set_title(title, loc="left")
        axes.grid(visible=False)
        axes.set_box_aspect(1)
        axes.label_outer()
    bar_beside(figure, filled, every, tables[0][1])


def _shades(levels: np.ndarray) -> Colormap:
    """The upper part of cividis, where lightness grows with the value and black lines are legible.

    For levels alike on both sides of zero, white in the middle and darker to either side.
    """
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    if _signed(levels):
        return ListedColormap(colormaps["RdBu_r"](np.linspace(0.15, 0.85, 255)))
    return ListedColormap(colormaps["cividis"](np.linspace(0.35, 1, 256)))


def _signed(levels: Any) -> bool:
    """Whether levels are those of a difference."""
    return bool(levels[0] < 0 and 0 not in levels)


def _contours(axes: Axes, x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[Any, Any]:
    """What fills the contours of a table, and what draws their lines.

    A table of equal axes is cut into triangles along its diagonal: a narrow ridge on it stays whole.
    """
    if not np.array_equal(x, y) or not np.isfinite(z).all():
        return partial(axes.contourf, x, y, z), partial(axes.contour, x, y, z)
    from matplotlib.tri import Triangulation

    number = np.arange(z.size).reshape(z.shape)
    corner, above, right, opposite = (
        number[rows, columns].ravel()
        for columns in (slice(None, -1), slice(1, None))
        for rows in (slice(None, -1), slice(1, None))
    )
    triangles = np.concatenate([[corner, right, opposite], [corner, opposite, above]], axis=1).T
    across, up = np.meshgrid(x, y)
    mesh = Triangulation(across.ravel(), up.ravel(), triangles)
    return partial(axes.tricontourf, mesh, z.ravel()), partial(axes.tricontour, mesh, z.ravel())


def contour_levels(*tables: xr.DataArray) -> np.ndarray:
    """Levels for all tables: of rho tenths, from zero or the lowest value up to the highest."""
    from matplotlib.ticker import MaxNLocator

    low, high = min(float(table.min()) for table in tables), max(float(table.max()) for table in tables)
    if not str(tables[0].name).startswith("rho"):
        return np.asarray(MaxNLocator(10).tick_values(low, high))
    first, last = min(0.0, np.floor(low * 10) / 10), np.ceil(high * 10) / 10
    return np.round(np.arange(first, last + 0.05, 0.1), 10) + 0.0  # no -0


def number_contours(figure: Figure) -> None:
    """A number on every contour line, once the panels have their sizes: numbers cut the lines."""
    from matplotlib.contour import ContourSet

    figure.draw_without_rendering()
    for axes in figure.axes:
        for lines in [each for each in axes.collections if isinstance(each, ContourSet)]:
            if not lines.filled:
                _number(axes, lines)


def _number(axes: Axes, lines: ContourSet) -> None:
    """Numbers where other contours and numbers are far and no edge is near."""
    from scipy.spatial import KDTree

    inward = axes.transData + axes.transAxes.inverted()
    each = [inward.transform(segment) for segments in lines.allsegs for segment in segments]
    spots: list[np.ndarray] = []
    for number, line in enumerate(each):
        inside = line[((line > EDGE) & (line < 1 - EDGE)).all(axis=1)]
        if (inside.max(axis=0, initial=0) - inside.min(axis=0, initial=1)).max() > SHORT:
            others = np.concatenate([*each[:number], *each[number + 1 :], *spots, np.full((1, 2), 9.0)])
            spots.append(inside[[KDTree(others).query(inside)[0].argmax()]])
    chosen = inward.inverted().transform(np.reshape(spots, (-1, 2)))
    digits = "%+g" if _signed(lines.levels) else "%g"
    axes.clabel(lines, manual=[*map(tuple, chosen)], fontsize=7, fmt=digits, inline_spacing=1)
