"""The shared style of the pictures: curves distinct in grey, names of quantities, ratio axes, planes."""

from __future__ import annotations

import os
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial, wraps
from typing import TYPE_CHECKING, Any, Literal, ParamSpec

import numpy as np
import xarray as xr

from stochlin.analyses.tables.storage import whole_file
from stochlin.messages import brief
from stochlin.views.shared.screen import PICTURES
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import ListedColormap
    from matplotlib.contour import ContourSet
    from matplotlib.figure import Figure

# Of every picture while it is drawn, and of nothing else; after STYLE.clear() the user's style holds.
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
AS_GIVEN = {"text.parse_math": False}  # where names are the user's
# Dark to light, each with a dash of its own: told apart in colour, in grey and by line style.
CURVES = (
    ("#1b1b1b", "-"),
    ("#8c2d04", (0, (6, 1.5))),
    ("#2166ac", (0, (4, 1.5, 1, 1.5))),
    ("#d07a00", (0, (2, 1))),
    ("#4d9a8a", (0, (6, 1.5, 1, 1.5, 1, 1.5))),
    ("#9e9ac8", (0, (1, 1))),
)
PRINT = 300  # points an inch
EDGE = 0.05  # of an axis: labels of contours nearer to its ends would be cut
SIGNED_STEPS = (0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.5, 2)  # of a difference of rho; within 0.1 is white
TICKS = (0.1, 0.25, 0.5, 1, 2, 4)
NAMES = {
    "damping": r"$\xi$",
    "reduction_factor": "R",
    "rho": r"correlation coefficient $\rho$",
    "amplification": "amplification D, inelastic / elastic",
}

Given = ParamSpec("Given")


def styled(
    more: Mapping[str, Any] | None = None,
) -> Callable[[Callable[Given, Figure]], Callable[Given, Figure]]:
    """A decorator: the function draws in the package's style, and these settings."""

    def decorate(draw: Callable[Given, Figure]) -> Callable[Given, Figure]:
        @wraps(draw)
        def drawing(*args: Given.args, **kwargs: Given.kwargs) -> Figure:
            import matplotlib as mpl

            with mpl.rc_context(STYLE | dict(more or {})):
                return draw(*args, **kwargs)

        return drawing

    return decorate


def filled(lines: Iterable[str], width: int, hang: str = "") -> str:
    """The lines of a caption, none longer than so many characters."""
    return "\n".join(textwrap.fill(line, width, subsequent_indent=hang) for line in lines)


def ratio_ticks(axis: Axis, values: np.ndarray) -> None:
    """Label a logarithmic axis of period ratios with plain numbers."""
    plain_ticks(axis, [t for t in TICKS if values[0] / 1.001 <= t <= values[-1] * 1.001])


def plain_ticks(axis: Axis, ticks: Sequence[float]) -> None:
    """Plain numbers on an axis that is logarithmic already."""
    from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))


def quantity(values: xr.DataArray) -> str:
    """The label of an axis: the long name of the variable, and its unit if it has one."""
    name, units = values.attrs.get("long_name", str(values.name)), values.attrs.get("units", "1")
    return typeset(name if units == "1" else f"{name} [{units}]")


def label_axis(axes: Axes, way: Literal["x", "y"], values: xr.DataArray) -> None:
    """An axis of these values; of periods and their ratios it is logarithmic."""
    if str(values.name).startswith("period"):
        axes.set(**{f"{way}scale": "log"})
        ratio_ticks(axes.xaxis if way == "x" else axes.yaxis, values.values)
    axes.set(**{f"{way}label": quantity(values)})


def legend_beside(axes: Axes) -> None:
    """The legend to the right of the axes."""
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)


def shades() -> ListedColormap:
    """The upper part of cividis: lightness grows with the value, black lines stay legible on it."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["cividis"](np.linspace(0.35, 1, 256)))


def signed_shades() -> ListedColormap:
    """White in the middle and darker to either side: lines with signs tell the sides apart in grey."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    return ListedColormap(colormaps["RdBu_r"](np.linspace(0.15, 0.85, 255)))


def plane(
    axes: Axes, table: xr.DataArray, levels: np.ndarray, *, cells: bool = False, signed: bool = False
) -> ContourSet | QuadMesh:
    """Filled contours of a table over its two dimensions, or its cells; with labelled lines.

    What is ``signed`` is white about zero, and its lines say their sign. Lines
    through cells are splines.
    """
    from matplotlib.colors import BoundaryNorm

    across, up = (table[name] for name in table.dims)
    label_axis(axes, "x", across)
    label_axis(axes, "y", up)
    place = across.values, up.values, table.values.T
    colours = signed_shades() if signed else shades()
    norm = BoundaryNorm(levels, colours.N)
    filled: ContourSet | QuadMesh
    if cells:
        edges = (_edges(one.values, axes.get_xscale() == "log") for one in (across, up))
        filled = axes.pcolormesh(*edges, place[2], cmap=colours, norm=norm)
        axes.set(xlim=(place[0][0], place[0][-1]), ylim=(place[1][0], place[1][-1]))
        _, draw_lines = contours_of(axes, *_refined(*place))
    else:
        fill, draw_lines = contours_of(axes, *place)
        filled = fill(levels=levels, cmap=colours, norm=norm)
    below = levels < float(table.max()) - 1e-9  # at the very top a line would be dots along a ridge
    digits = "%.1f" if str(table.name).startswith("rho") else "%g"
    labelled = below & (signed | (np.arange(levels.size) % 2 == 0))
    lines, _ = (
        draw_lines(levels=levels[shown], colors="0.1", linewidths=0.6)
        for shown in (labelled, below & ~labelled)
    )
    label_contours(axes, lines, "%+g" if signed else digits)
    axes.grid(visible=False)
    axes.set_box_aspect(1)
    return filled


def label_contours(axes: Axes, lines: ContourSet, digits: str) -> None:
    """Numbers on all of these contours, none of them so near to the edge that it would be cut."""
    style: Any = {"fontsize": 6.5, "fmt": digits}
    tried = axes.clabel(lines, inline=False, **style)
    places = np.reshape([text.get_position() for text in tried], (-1, 2))
    for text in tried:
        text.remove()
    within = axes.transAxes.inverted().transform(axes.transData.transform(places))
    inside = ((within > EDGE) & (within < 1 - EDGE)).all(axis=1)
    axes.clabel(lines, manual=[tuple(place) for place in places[inside]], inline_spacing=1, **style)


def _edges(centres: np.ndarray, logarithmic: bool) -> np.ndarray:
    """The edges between cells around these centres."""
    values = np.log(centres) if logarithmic else centres
    inner = 0.5 * (values[1:] + values[:-1])
    edges = np.concatenate([[2 * values[0] - inner[0]], inner, [2 * values[-1] - inner[-1]]])
    return np.exp(edges) if logarithmic else edges


def contours_of(
    axes: Axes, x: np.ndarray, y: np.ndarray, z: np.ndarray
) -> tuple[Callable[..., ContourSet], Callable[..., ContourSet]]:
    """What fills the contours of a table, and what draws their lines.

    A table of equal axes is cut into triangles along its diagonal: a narrow ridge on it stays whole.
    """
    if x.shape != y.shape or not np.allclose(x, y) or not np.isfinite(z).all():
        return partial(axes.contourf, x, y, z), partial(axes.contour, x, y, z)
    from matplotlib.tri import Triangulation

    number = np.arange(z.size).reshape(z.shape)
    corner, right, above, opposite = (
        number[rows, columns].ravel()
        for rows in (slice(None, -1), slice(1, None))
        for columns in (slice(None, -1), slice(1, None))
    )
    triangles = np.concatenate([[corner, right, opposite], [corner, opposite, above]], axis=1).T
    across, up = np.meshgrid(x, y)
    mesh = Triangulation(across.ravel(), up.ravel(), triangles)
    return partial(axes.tricontourf, mesh, z.ravel()), partial(axes.tricontour, mesh, z.ravel())


def _refined(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Few cells by splines, so that lines have no kinks; unchanged where some are unknown."""
    from scipy.interpolate import RectBivariateSpline

    if min(z.shape) < 4 or not np.isfinite(z).all():
        return x, y, z
    fine = [
        np.interp(np.arange(0, n - 0.9, 0.25), np.arange(n), one)
        for one, n in ((x, x.size), (y, y.size))
    ]
    between = RectBivariateSpline(y, x, z)(fine[1], fine[0])
    return fine[0], fine[1], between.clip(z.min(), z.max())


def signed_levels(table: xr.DataArray) -> np.ndarray:
    """Levels of a difference, alike on both sides of zero; of rho from 0.1 to 0.4 at least."""
    from matplotlib.ticker import MaxNLocator

    largest = float(np.abs(table).max())
    if str(table.name).startswith("rho"):
        beyond = [step for step in SIGNED_STEPS if step < largest]
        levels = np.array(SIGNED_STEPS[: max(3, len(beyond) + 1)])
    else:
        levels = np.asarray(MaxNLocator(5).tick_values(0, largest))[1:]
    return np.concatenate([-levels[::-1], levels])


def contour_levels(*tables: xr.DataArray) -> np.ndarray:
    """Levels for all tables: of rho tenths, from zero or the lowest value up to the highest."""
    from matplotlib.ticker import MaxNLocator

    low, high = min(float(table.min()) for table in tables), max(float(table.max()) for table in tables)
    if not str(tables[0].name).startswith("rho"):
        return np.asarray(MaxNLocator(10).tick_values(low, high))
    first, last = min(0.0, np.floor(low * 10) / 10), np.ceil(high * 10) / 10
    return np.round(np.arange(first, last + 0.05, 0.1), 10) + 0.0  # no -0


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture whole or not at all; ``.png``, ``.svg`` or ``.pdf``."""
    import matplotlib as mpl

    suffix = os.path.splitext(path)[1][1:].lower()
    if f".{suffix}" not in PICTURES:
        allowed = ", ".join(ending[1:] for ending in PICTURES)
        raise ValueError(f"path = {brief(os.fspath(path))} ends in {brief(suffix)}; allowed: {allowed}")
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
    with mpl.rc_context(STYLE), whole_file(path) as temporary:
        figure.savefig(temporary, dpi=PRINT, metadata=undated)
