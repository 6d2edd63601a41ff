"""Planes: filled contours with labelled lines, on levels that several tables share."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.views.shared.style import label_axis

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colors import ListedColormap
    from matplotlib.contour import ContourSet

EDGE = 0.05  # of an axis: labels of contours nearer to its ends would be cut
SHORT = 0.1  # of an axis: contours without a label
SIGNED_STEPS = (0.1, 0.2, 0.4, 0.6, 0.8, 1, 1.5, 2)  # of a difference of rho; within 0.1 is white
FINE = 120  # intervals along an axis; fewer points are refined by splines


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
    axes: Axes, table: xr.DataArray, levels: np.ndarray, *, signed: bool = False
) -> tuple[ContourSet, Callable[[], None]]:
    """Filled contours of a table over its two dimensions, and what labels their lines in the end.

    What is ``signed`` is white about zero, and its lines say their sign. Few points are refined by
    splines, so that lines have no kinks. Labels cut the lines, and therefore need the final size.
    """
    from matplotlib.colors import BoundaryNorm

    across, up = (table[name] for name in table.dims)
    label_axis(axes, "x", across)
    label_axis(axes, "y", up)
    colours = signed_shades() if signed else shades()
    fill, draw_lines = contours_of(axes, *_refined(across.values, up.values, table.values.T))
    filled = fill(levels=levels, cmap=colours, norm=BoundaryNorm(levels, colours.N))
    below = levels < float(table.max()) - 1e-9  # at the very top a line would be dots along a ridge
    lines = draw_lines(levels=levels[below], colors="0.1", linewidths=0.6)
    axes.grid(visible=False)
    axes.set_box_aspect(1)
    return filled, partial(label_contours, axes, lines, "%+g" if signed else "%g")


def label_contours(axes: Axes, lines: ContourSet, digits: str) -> None:
    """A number on every contour, where other contours and numbers are far and no edge is near."""
    from scipy.spatial import KDTree

    inward = axes.transData + axes.transAxes.inverted()
    each = [inward.transform(segment) for segments in lines.allsegs for segment in segments]
    places: list[np.ndarray] = []
    for number, own in enumerate(each):
        inside = own[((own > EDGE) & (own < 1 - EDGE)).all(axis=1)]
        if (inside.max(axis=0, initial=0) - inside.min(axis=0, initial=1)).max() > SHORT:
            others = np.concatenate([*each[:number], *each[number + 1 :], *places, np.full((1, 2), 9.0)])
            places.append(inside[[KDTree(others).query(inside)[0].argmax()]])
    spots = inward.inverted().transform(np.reshape(places, (-1, 2)))
    axes.clabel(lines, manual=[*map(tuple, spots)], fontsize=7, fmt=digits, inline_spacing=1)


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
    """Few points by splines; unchanged if there are many, or if some are unknown."""
    from scipy.interpolate import RectBivariateSpline

    times = -(-FINE // (max(z.shape) - 1))
    if times == 1 or min(z.shape) < 4 or not np.isfinite(z).all():
        return x, y, z
    fine = [
        np.interp(np.arange(times * (n - 1) + 1) / times, np.arange(n), axis)
        for axis, n in ((x, x.size), (y, y.size))
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
