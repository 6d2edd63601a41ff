"""The picture of floors and storeys: accelerations, shears and forces on columns over height."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.analyses.cases.pounding import is_oscillator
from stochlin.views.pounding.pictures import caption_of
from stochlin.views.shared.screen import cut
from stochlin.views.shared.style import AS_GIVEN, CURVES, describe, legend_above, styled

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, HEAD, PANEL, AXIS, LINE = 7.2, 0.35, 2.9, 0.62, 0.135  # inches; the last of a line of text
LEFT, RIGHT, BETWEEN = 0.09, 0.98, 0.03  # of the width
NAME, IN_A_ROW = 24, 3  # characters of a name in the legend, and how many of them
MEGA = 1e-6
ALONE: Any = {"color": "0.35", "marker": "o", "mfc": "white", "ms": 4, "lw": 0.7}  # in a legend


@styled(AS_GIVEN)
def draw_floors(dataset: xr.Dataset) -> Figure:
    """Draw the floor accelerations, storey shears and forces on columns of one ``stochlin pound``.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `stochlin.charts.pound_case` makes them of rows with storeys, from memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        Side by side, over height: the largest accelerations and storey shears, each also for the
        building alone; where slabs hit columns, the largest force on each column.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "floor_level" not in dataset.coords:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: one that 'stochlin pound' "
            "saves of a row with storeys"
        )
    struck = "column_force" in dataset and bool((dataset.column_force > 0).any())
    labels = ["acceleration [g]", "storey shear [MN]", *["force on columns [MN]"] * struck]
    caption = caption_of(dataset)
    foot = AXIS + LINE * (caption.count("\n") + 1)
    legend = 1.4 * LINE * (1 + dataset.sizes["structure"] // IN_A_ROW)
    height = HEAD + legend + PANEL + foot
    figure = Figure(figsize=(WIDTH, height))
    wide = (RIGHT - LEFT - BETWEEN * (len(labels) - 1)) / len(labels)
    panels = [
        figure.add_axes((LEFT + n * (wide + BETWEEN), foot / height, wide, PANEL / height))
        for n in range(len(labels))
    ]
    for number, (name, style) in enumerate(looks_of(dataset)):
        _profiles(panels, dataset.isel(structure=number), levels_of(dataset, number), name, style)
        if struck:
            _columns(panels[2], dataset, number, style)
    if "contact" in dataset.dims:
        panels[0].plot([], [], label="open, thin: standing alone", **ALONE)
    for axes, name in zip(panels, labels, strict=True):
        axes.set(xlim=(0, None), ylim=(0, 1.04 * _top(dataset)), xlabel=name)
        axes.tick_params(labelleft=axes is panels[0])
    panels[0].set_ylabel("height [m]")
    legend_above(panels[0], IN_A_ROW, 8)
    describe(figure, LEFT, foot - AXIS, dataset.attrs["title"], caption)
    return figure


def looks_of(dataset: xr.Dataset) -> Iterator[tuple[str, dict[str, Any]]]:
    """The name of each building in a legend, and how its profile is drawn."""
    looks = cycle(zip(CURVES, "osD^vP", strict=True))
    for number, ((color, dash), marker) in zip(dataset.structure.values, looks, strict=False):
        name = str(dataset.building.sel(structure=number).item())
        style: dict[str, Any] = {"color": color, "linestyle": dash, "marker": marker, "ms": 4, "lw": 1.3}
        yield cut(f"{number} {name}", NAME), style


def profile(axes: Axes, levels: Any, with_hits: Any, alone: Any, name: str, style: Any) -> None:
    """Peaks over height; those of the building alone, if there are any, thin and open."""
    if alone is not None:
        axes.plot(alone, levels, **style | {"mfc": "white", "lw": 0.7})
    axes.plot(with_hits, levels, label=name, **style)


def _profiles(
    panels: Sequence[Axes], table: xr.Dataset, levels: np.ndarray, name: str, style: dict[str, Any]
) -> None:
    """Peaks of one building at its floors, and at the middle of its storeys."""
    middle = levels if is_oscillator(table) else 0.5 * (levels + np.append(0.0, levels[:-1]))
    for axes, peak, scale, at in (
        (panels[0], "peak_acceleration", 1 / constants.g, levels),
        (panels[1], "peak_storey_shear", MEGA, middle),
    ):
        with_hits, alone = (scale * table[f"{peak}{end}"].values[: at.size] for end in ("", "_alone"))
        profile(axes, at, with_hits, alone if "contact" in table.dims else None, name, style)


def _columns(axes: Axes, dataset: xr.Dataset, number: int, style: dict[str, Any]) -> None:
    """The largest force on each column of this building that a slab hits."""
    sides = {side: dataset[side].values == number + 1 for side in ("left", "right")}
    own = np.select([dataset.column.values == side for side in sides], list(sides.values()), False)
    hit = dataset.isel(contact=own & (dataset.column_force > 0).values)
    force = MEGA * hit.column_force.values
    axes.hlines(hit.level.values, 0, force, color=style["color"], lw=style["lw"])
    axes.plot(force, hit.level.values, **style | {"linestyle": "none"})


def levels_of(dataset: xr.Dataset, number: int) -> np.ndarray:
    """Heights of the floors of a building; an oscillator moves where it meets its neighbours."""
    levels = dataset.floor_level.values[number]
    if np.isfinite(levels).any():
        return levels[np.isfinite(levels)]
    beside = (dataset.left.values == number + 1) | (dataset.right.values == number + 1)
    return np.atleast_1d(np.nanmax(dataset.level.values[beside], initial=0.0))


def _top(dataset: xr.Dataset) -> float:
    contacts = dataset.level.values if "level" in dataset.coords else []
    return float(np.nanmax([*dataset.floor_level.values.ravel(), *contacts]))
