"""What the pictures share: curves told apart in grey, names of quantities, ratio axes, planes."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.analyses.tables.storage import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.contour import QuadContourSet
    from matplotlib.figure import Figure

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
TICKS = (0.1, 0.25, 0.5, 1, 2, 4)
NAMES = {
    "damping": r"$\xi$",
    "reduction_factor": "R",
    "rho": r"correlation coefficient $\rho$",
    "amplification": "amplification D, inelastic / elastic",
}


def ratio_ticks(axis: Axis, values: np.ndarray) -> None:
    """Label a logarithmic axis of period ratios with plain numbers."""
    from matplotlib.ticker import FixedLocator, NullLocator, StrMethodFormatter

    ticks = [t for t in TICKS if values[0] / 1.001 <= t <= values[-1] * 1.001]
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(StrMethodFormatter("{x:g}"))


def plane(axes: Axes, rho: xr.DataArray, levels: np.ndarray) -> QuadContourSet:
    """Filled contours of a table over two period ratios, with labelled lines."""
    from matplotlib import colormaps
    from matplotlib.colors import ListedColormap

    x, y = rho.period_ratio_1.values, rho.period_ratio_2.values
    # The upper part of cividis: lightness grows with the value, black lines stay legible on it.
    shades = ListedColormap(colormaps["cividis"](np.linspace(0.35, 1, 256)))
    filled = axes.contourf(x, y, rho.values.T, levels=levels, cmap=shades)
    lines = axes.contour(x, y, rho.values.T, levels=levels, colors="0.1", linewidths=0.6)
    axes.clabel(lines, levels=levels[::2], fontsize=7, fmt="%.1f")
    axes.grid(visible=False)
    axes.set_xscale("log")
    axes.set_yscale("log")
    ratio_ticks(axes.xaxis, x)
    ratio_ticks(axes.yaxis, y)
    axes.set_box_aspect(1)
    axes.set_xlabel("T1/Tg")
    axes.set_ylabel("T2/Tg")
    return filled


def tenths(*tables: xr.DataArray, at_most: float = 0.0) -> np.ndarray:
    """Contour levels in steps of .1 from the lowest value, or ``at_most``, up to the highest."""
    low = min(at_most, *(np.floor(float(table.min()) * 10) / 10 for table in tables))
    high = max(np.ceil(float(table.max()) * 10) / 10 for table in tables)
    return np.round(np.arange(low, high + 0.05, 0.1), 10)


FORMATS = ("png", "svg", "pdf")


def save(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Write a picture whole or not at all; ``.png``, ``.svg`` or ``.pdf``."""
    import matplotlib as mpl

    suffix = os.path.splitext(path)[1][1:].lower()
    if suffix not in FORMATS:
        raise ValueError(f"path = {os.fspath(path)!r} ends in {suffix!r}; allowed: {', '.join(FORMATS)}")
    undated = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}.get(suffix)
    with mpl.rc_context(STYLE), whole_file(path) as temporary:
        figure.savefig(temporary, dpi=200, metadata=undated)
