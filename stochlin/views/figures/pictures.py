"""Pictures of charts: curves, planes, all methods beside one another, and the words around them."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Hashable, Iterator, Sequence
from itertools import cycle, product
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.charts import DRIFT_MEMORY, is_slow
from stochlin.models.arguments import Number
from stochlin.models.parameters import Range
from stochlin.registry import Registry
from stochlin.views.shared.blocks import typeset
from stochlin.views.shared.style import (
    CURVES,
    NOTE_LINE,
    PAGE_WIDTH,
    decade_ticks,
    filled,
    label_axis,
    quantity,
    styled,
)
from stochlin.views.shared.words import CENTIMETRES, rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure
    from matplotlib.tri import Triangulation

# Functions that draw the axes of a dataset into a figure, by its attribute ``chart`` or
# ``comparison``.
PICTURES: Registry[Callable[[Figure, xr.Dataset], None]] = Registry(
    "chart", "stochlin.views.figures"
)
METRES_PER_INCH = 0.0254
NARROW_WIDTH = 5.0  # inches, below which panels stand in one column
PRINT_WIDTHS = Number(  # m
    Range(0.08, 0.25, True, True),
    "0.08 to 0.25 m, such as 0.084 and 0.174 for one and two columns",
)
# inches, heights
WIDE_PANEL = 3.4
MEDIUM_PANEL = 2.7
SMALL_PANEL = 1.75
SQUARE = 3.1
# Of a picture in print, where no text is below 7 points; on the screen it is 8 to 10.
PRINT_STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
}
SCREEN_STYLE: Any = {"axes.titlesize": 9, "legend.fontsize": 8}
# characters
NOTE_WIDTH = 120
LABEL_WIDTH = 30
AMPLE = 4.0  # inches: more than any legend
PANEL_PAD = 0.06  # around panels
THREE_LINES = 0.5  # inches: of three lines above a panel
ROOM = 0.065  # around a number on a line
SYMBOLS_OF_PARAMETERS = {"damping": r"$\xi$", "reduction_factor": "R"}
# markers of the simulated points of each curve, and of those in finite motions
MARKERS_OF_CURVES = "os^Dvp", "xxxxxx"
THIN = 0.8  # line width of other results
TWICE = 1.96  # half a 95 % interval, in standard errors
POINT: Any = {"ms": 3.6, "mew": 0.8, "elinewidth": 0.8, "zorder": 4}
OPEN = "simulated, drift slower than any motion"  # label of open points
CLEAR_EDGE = 0.05  # of an axis, in which no contour has its number
PLANES = {"rho": "linearized", "rho_drift": "drift closure", "rho_simulated": "simulated"}


@styled(SCREEN_STYLE)
def draw(
    dataset: xr.Dataset, *, comparison: bool = False, print_width: float | None = None
) -> Figure:
    """Draw one chart dataset.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result of the functions of ``stochlin.charts``, from memory or from file. Its attribute
        ``chart`` gives the kind of picture, and ``comparison`` that of its second picture.
    comparison : bool
        Whether to draw the second picture of the chart, with all methods beside one another.
    print_width : float, optional
        Width [m] of the picture in print, such as 0.084 for one column and 0.174 for two. It then
        has no title and no notes, and no text below 7 points. The default is a picture for the
        screen.

    Returns
    -------
    matplotlib.figure.Figure
        Figure with title and legend above the panels and the parameters below them.

    Raises
    ------
    ValueError
        If the dataset is no chart, has no finite numbers or no comparison, or the width is out of
        range.
    """
    import matplotlib as mpl
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    kind = "comparison" if comparison else "chart"
    draw_axes = PICTURES.named(dataset.attrs.get(kind), f"attribute {kind}")
    numbers = [array for array in dataset.data_vars.values() if array.dtype.kind == "f"]
    if numbers and not any(bool(np.isfinite(array).any()) for array in numbers):
        raise ValueError("the chart has no finite number to draw; its status names the cause")
    title = dataset.attrs.get("title", "")
    notes = [dataset.attrs.get(key, "") for key in ("caption", "comment")]
    width = width_in_print(print_width)
    with mpl.rc_context({} if print_width is None else PRINT_STYLE):
        figure = Figure(figsize=(width, SQUARE), layout=ConstrainedLayoutEngine(h_pad=PANEL_PAD))
        draw_axes(figure, dataset)
        arrange(figure, *((title, notes) if print_width is None else ("", [])))
    return figure


def width_in_print(print_width: float | None) -> float:
    """Width of a picture in inches; on the screen without a width [m] in print."""
    if print_width is None:
        return PAGE_WIDTH
    PRINT_WIDTHS("print_width", print_width)
    return float(print_width) / METRES_PER_INCH


def arrange(figure: Figure, title: str, notes: Sequence[str]) -> None:
    """Title and legend above the panels, notes below; they make the picture higher.

    The legend has every curve of axes that have no legend of their own.
    """
    entries: dict[str, Any] = {}
    for axes in figure.axes:
        if axes.get_legend() is None:
            for handle, text in zip(*axes.get_legend_handles_labels(), strict=True):
                entries.setdefault(textwrap.fill(text, LABEL_WIDTH), handle)
    text = typeset(filled([line for note in notes for line in note.splitlines()], NOTE_WIDTH))
    if text:
        figure.supxlabel(text, x=0.012, ha="left", size=7.5)
    height = figure.get_figheight()
    figure.set_figheight(height + AMPLE)
    for columns in range(max(1, len(entries)), 0, -1):
        head = figure.legend(
            list(entries.values()), list(entries), loc="outside upper left", title=typeset(title),
            ncols=columns, title_fontsize=10, alignment="left", borderaxespad=0.3, borderpad=0.2,
            columnspacing=1.2, handlelength=3.6,
        )  # fmt: skip
        if columns == 1 or head.get_window_extent().width < 0.98 * figure.bbox.width:
            break
        head.remove()
    figure.draw_without_rendering()
    above = head.get_window_extent().height / figure.dpi
    figure.set_figheight(height + above + NOTE_LINE * len(text.splitlines()))


def panels(
    figure: Figure, rows: int, columns: int, height: float, *, shared: bool = False
) -> list[Axes]:
    """Axes ``height`` inches high, with room for what stands around them; rows first."""
    figure.set_figheight(rows * height + 0.4)
    return list(figure.subplots(rows, columns, squeeze=False, sharex=shared, sharey=shared).ravel())


def in_a_row(figure: Figure, count: int, height: float, *, shared: bool = False) -> list[Axes]:
    """Panels beside one another, or below one another in a narrow picture."""
    across = 1 if is_narrow(figure) else count
    return panels(figure, count // across, across, height, shared=shared)


def is_narrow(figure: Figure) -> bool:
    """Whether a picture has the width of one column of print."""
    return bool(figure.get_figwidth() < NARROW_WIDTH)


def places(table: xr.DataArray, inner: int) -> Iterator[tuple[str, dict[Hashable, Any]]]:
    """Titles of all panels, each with its position along all but so many last dimensions."""
    outer = table.dims[: max(0, table.ndim - inner)]
    for values in product(*(table[dim].values for dim in outer)):
        titles = [title_of(dim, value) for dim, value in zip(outer, values, strict=True)]
        yield ", ".join(titles), dict(zip(outer, values, strict=True))


def title_of(dim: Hashable, value: Any) -> str:
    """What a panel or a curve is for: ``R = 4``, the name of a rule or of a ground."""
    if isinstance(value, str):
        return rule_label(value) if dim == "rule" else typeset(value)
    return f"{SYMBOLS_OF_PARAMETERS.get(str(dim), dim)} = {value:g}"


def curve_label(values: xr.DataArray) -> str:
    """What curves of a variable are called in a legend, if not by its name."""
    return typeset(values.attrs.get("curve_label", values.long_name))


def in_cm(table: xr.DataArray) -> xr.DataArray:
    """A length in centimetres."""
    return (CENTIMETRES * table).assign_attrs(table.attrs | {"units": "cm"}).rename(table.name)


def shown(dataset: xr.Dataset) -> xr.DataArray:
    """Variable that a chart shows: the one that ``shows`` names, or the first that is no status."""
    first = next(name for name in dataset.data_vars if name != "status")
    return dataset[dataset.attrs.get("shows", first)]


@PICTURES.register("curves")
def draw_curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground, a curve for each strength, and the points that ``points`` names."""
    table = shown(dataset)
    points = [dataset[name] for name in dataset.attrs.get("points", "").split()]
    beside = dataset.attrs.get("beside", "").split()  # other results, as thin lines
    grounds = list(places(table, 2))
    every = in_a_row(
        figure, len(grounds), MEDIUM_PANEL if len(grounds) > 1 else WIDE_PANEL, shared=True
    )
    for axes, (title, place) in zip(every, grounds, strict=True):
        axes.set_title(title, loc="left")
        looks = zip(
            places(table.sel(place), 1), cycle(CURVES), *map(cycle, MARKERS_OF_CURVES), strict=False
        )
        for (label, along), (color, dash), *markers in looks:
            row = table.sel({**place, **along})
            if not bool(row.notnull().any()):
                continue
            style: Any = {"color": color, "linestyle": dash, "label": label or quantity(table)}
            if points:  # on no point of the curve, but in the legend
                style |= {"marker": markers[0], "markevery": [], "ms": POINT["ms"]}
            curve = dataset.sel({**place, **along})
            looks_of_points = zip(points, markers, MARKERS_OF_CURVES, strict=False)
            for values, marker, all_markers in looks_of_points:
                draw_points(axes, curve, values, marker, color, all_markers[0])
            axes.plot(row[row.dims[-1]], row, **style)
            for name in beside:
                other = dataset[name].sel({**place, **along})
                axes.plot(other[other.dims[-1]], other, color=color, linestyle=dash, lw=THIN)
    set_axes(every, table, [table, *points])
    if points:
        every[0].plot([], [], color="0.1", label=curve_label(table))
    for name in beside:
        every[0].plot([], [], color="0.1", lw=THIN, label=curve_label(dataset[name]))


@PICTURES.register("compared_curves")
def compare_curves(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each strength and ground, with all variables whose names begin alike."""
    table = shown(dataset).transpose("reduction_factor", ...)
    methods = [
        values for name, values in dataset.data_vars.items()
        if str(name).startswith(str(table.name)) and not str(name).endswith("_error")
    ]  # fmt: skip
    every_place = list(places(table, 1))
    columns = dataset.sizes.get("ground", 1)
    every = panels(figure, len(every_place) // columns, columns, SMALL_PANEL, shared=True)
    for axes, (title, place) in zip(every, every_place, strict=True):
        axes.set_title(title.replace(", ", "\n") if is_narrow(figure) else title, loc="left")
        looks = iter(cycle(CURVES))
        markers = iter("o^x")
        here = dataset.sel(place)
        for values in methods:
            if "ancillary_variables" in values.attrs:
                marker = next(markers)
                draw_points(axes, here, values, marker, "0.1", marker)
            else:
                color, dash = next(looks)
                curve = here[values.name]
                axes.plot(
                    curve[curve.dims[-1]], curve, label=curve_label(values), color=color, ls=dash
                )
    set_axes(every, table, methods)
    figure.supylabel(quantity(table), size="medium")
    for axes in every:
        axes.set_ylabel("")


def draw_points(
    axes: Axes, dataset: xr.Dataset, points: xr.DataArray, marker: str, color: str, in_legend: str
) -> None:
    """Simulated points with 95 % intervals, open where their plastic drift has a long memory.

    In the legend they are black, and have the marker ``in_legend``.
    """
    error, *memory = points.attrs["ancillary_variables"].split()
    values = dataset[points.name]
    slow = is_slow(dataset) if memory else xr.zeros_like(values, bool)
    for label, where, inside in ((quantity(points), ~slow, None), (OPEN, slow, "w")):
        part = values.where(where)
        if bool(part.notnull().any()):
            bars = TWICE * dataset[error].values
            axes.errorbar(
                part[part.dims[-1]], part, bars, fmt=marker, color=color, mfc=inside, **POINT
            )
            axes.errorbar([], [], [], fmt=in_legend, color="0.1", mfc=inside, label=label, **POINT)


def set_axes(every: Sequence[Axes], table: xr.DataArray, drawn: Sequence[xr.DataArray]) -> None:
    """Labels and ends of panels that share their axes."""
    across = table[table.dims[-1]]
    low, high = (
        min(float(array.min()) for array in drawn),
        max(float(array.max()) for array in drawn),
    )
    for axes in every:
        label_axis(axes, "x", across)
        axes.set(ylabel=quantity(table), xlim=(float(across[0]), float(across[-1])))
        if str(table.name).startswith("rho"):
            axes.set_ylim(min(0.0, np.floor(low * 10) / 10), 1.03)
        elif low > 0 and high > 5 * low:
            axes.set(yscale="log", ylim=(0.85 * low, 1.15 * high))
            decade_ticks(axes.yaxis)
        axes.label_outer()


@PICTURES.register("plane")
def draw_plane(figure: Figure, dataset: xr.Dataset) -> None:
    """A panel for each ground."""
    table = shown(dataset)
    named = [(title, table.sel(place)) for title, place in places(table, 2)]
    planes(figure, in_a_row(figure, len(named), SQUARE, shared=True), named, contour_levels(table))


@PICTURES.register("plane_and_simulation")
def draw_plane_and_simulation(figure: Figure, dataset: xr.Dataset) -> None:
    """The planes of linearization and of simulation, in a column for each ground."""
    compare_planes(figure, dataset.drop_vars("rho_drift"))


@PICTURES.register("compared_planes")
def compare_planes(figure: Figure, dataset: xr.Dataset) -> None:
    """A column of planes for each ground; that of simulation is white where the drift is slow."""
    tables = {text: dataset[name] for name, text in PLANES.items() if name in dataset}
    if DRIFT_MEMORY in dataset:
        first, second = tables["simulated"].dims[-2:]
        drawn = tables["simulated"].dropna(first, how="all").dropna(second, how="all")
        tables["simulated"] = drawn.where(~is_slow(dataset))
    apart = "\n" if is_narrow(figure) else ", "
    named = [
        (f"{title}\n{text}".strip().replace(", ", apart), table.sel(place))
        for text, table in tables.items()
        for title, place in places(table, 2)
    ]
    columns = len(named) // len(tables)
    height = min(
        figure.get_figwidth() / columns + (THREE_LINES if is_narrow(figure) else 0.0), SQUARE
    )
    every = panels(figure, len(tables), columns, height, shared=True)
    planes(figure, every, named, contour_levels(*tables.values()))


def planes(
    figure: Figure,
    every: Sequence[Axes],
    tables: Sequence[tuple[str, xr.DataArray]],
    levels: np.ndarray,
    thick: float | None = None,
) -> None:
    """Filled contours of tables by their titles, on these levels, and the bar of their shades.

    The shades are the upper part of cividis, where lightness grows with the value and black lines
    are legible. The line of one level may be thick. The bar stands below a narrow picture.
    """
    from matplotlib import colormaps
    from matplotlib.colors import BoundaryNorm, ListedColormap

    shades = ListedColormap(colormaps["cividis"](np.linspace(0.35, 1, 256)))
    lines = []
    for axes, (title, table) in zip(every, tables, strict=True):
        first, second = table.dims
        across = table[first]
        up = table[second]
        label_axis(axes, "x", across)
        label_axis(axes, "y", up)
        mesh = _triangles(across.values, up.values, table.values)
        filled = axes.tricontourf(*mesh, levels, cmap=shades, norm=BoundaryNorm(levels, shades.N))
        # At the very top a line would be dots along a ridge.
        below = levels < float(table.max()) - 1e-9
        widths = np.where(levels[below] == thick, 1.5, 0.6)
        lines.append(axes.tricontour(*mesh, levels[below], colors="0.1", linewidths=widths))
        axes.set_title(title, loc="left")
        axes.grid(visible=False)
        axes.set_box_aspect(1)
        axes.label_outer()
    where: Any = {"location": "bottom" if is_narrow(figure) else "right", "aspect": 30}
    label = quantity(tables[0][1])
    bar = figure.colorbar(filled, ax=list(every), label=label, format="%g", **where)
    bar.ax.grid(visible=False)
    figure.draw_without_rendering()  # numbers cut the lines: the panels must have their sizes
    for axes, drawn in zip(every, lines, strict=True):
        _number(axes, drawn)


def _triangles(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[Triangulation, np.ndarray]:
    """The plane of a table in triangles along its diagonal: a narrow ridge on it stays whole."""
    from matplotlib.tri import Triangulation

    corner = np.arange(z.size).reshape(z.shape)[:-1, :-1].ravel()
    right = corner + y.size
    opposite = corner + y.size + 1
    above = corner + 1
    triangles = np.concatenate([[corner, right, opposite], [corner, opposite, above]], axis=1).T
    across, up = np.meshgrid(x, y, indexing="ij")
    unknown = ~np.isfinite(z.ravel()[triangles]).all(axis=1)
    mesh = Triangulation(across.ravel(), up.ravel(), triangles, unknown)
    return mesh, np.ma.masked_invalid(z.ravel())


def contour_levels(*tables: xr.DataArray) -> np.ndarray:
    """Levels for all tables: of rho tenths, from zero or the lowest value up to the highest."""
    from matplotlib.ticker import MaxNLocator

    low, high = (
        min(float(table.min()) for table in tables),
        max(float(table.max()) for table in tables),
    )
    if not str(tables[0].name).startswith("rho"):
        return np.asarray(MaxNLocator(10).tick_values(low, high))
    first = min(0.0, np.floor(low * 10) / 10)
    last = np.ceil(high * 10) / 10
    return np.round(np.arange(first, last + 0.05, 0.1), 10) + 0.0  # no -0


def _number(axes: Axes, lines: ContourSet) -> None:
    """A number on every long contour line that has room, where others are far.

    Those of matplotlib would be cut.
    """
    from scipy.spatial import KDTree

    inward = axes.transData + axes.transAxes.inverted()
    contours = [inward.transform(segment) for segments in lines.allsegs for segment in segments]
    room = ROOM * axes.figure.dpi / axes.get_window_extent().height
    spots = list[np.ndarray]()
    far = np.full((1, 2), 9.0)
    for number, line in enumerate(contours):
        inside = line[((line > CLEAR_EDGE) & (line < 1 - CLEAR_EDGE)).all(axis=1)]
        if len(inside) and np.ptp(inside, axis=0).max() > 2 * CLEAR_EDGE:
            others = np.concatenate([*contours[:number], *contours[number + 1 :], far])
            away = [
                KDTree(points).query(inside)[0]
                for points in (others, np.concatenate([*spots, far]))
            ]
            free = np.minimum(away[0], away[1] / 2)  # a number is longer than high
            if free.max() > room:
                spots.append(inside[[free.argmax()]])
    chosen = inward.inverted().transform(np.reshape(spots, (-1, 2)))
    axes.clabel(lines, manual=[*map(tuple, chosen)], fontsize=7, fmt="%g", inline_spacing=1)
