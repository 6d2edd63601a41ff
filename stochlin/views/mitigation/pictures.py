"""A picture of measures against pounding: the gap that each needs."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.shared.style import (
    AS_GIVEN,
    CURVES,
    describe,
    filled,
    legend_above,
    name_rows,
    styled,
)
from stochlin.views.shared.words import along, roles_in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, ROW, HEAD, FOOT, LINE = 7.2, 0.26, 0.96, 0.64, 0.14  # inches
LEFT, RIGHT = 0.34, 0.8  # of the width
NAME, CAPTION = 38, 112  # characters


@styled(AS_GIVEN)
def draw_measures(dataset: xr.Dataset) -> Figure:
    """Draw the table of `stochlin.mitigate`, from memory or from file.

    One line for each measure: the gap for the confidence with its interval, compared with the existing
    gap.
    """
    if "required_gap" not in dataset or "measure" not in dataset.dims:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: a dataset that mitigate returns"
        )
    from matplotlib.figure import Figure

    caption = _caption(dataset)
    foot = FOOT + LINE * (caption.count("\n") + 1)
    rows = ROW * (dataset.sizes["measure"] + 0.6)
    height = HEAD + rows + foot
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.add_axes((LEFT, foot / height, RIGHT - LEFT, rows / height))
    _gaps(axes, dataset)
    name_rows(
        axes,
        np.arange(dataset.sizes["measure"]),
        [filled([str(n)], NAME) for n in dataset.measure.values],
        7.5,
    )
    legend_above(axes, 1, 7)
    describe(figure, 0.02, foot - FOOT, dataset.attrs["title"], caption)
    return figure


def _gaps(axes: Axes, dataset: xr.Dataset) -> None:
    place = np.arange(dataset.sizes["measure"])
    needed = 100 * dataset.required_gap.values
    low, high = (100 * dataset[f"required_gap_{end}"].values for end in ("lower", "upper"))
    high = np.where(np.isfinite(high), high, needed)
    least = dataset.kind.values == "least"
    for group, face, label in ((~least, CURVES[0][0], "as built, given"), (least, "white", "least")):
        shown = group & np.isfinite(needed)
        if shown.any():
            ends = [(needed - low)[shown], (high - needed)[shown]]
            style: Any = {"fmt": "o", "color": CURVES[0][0], "ms": 5, "lw": 1, "capsize": 2}
            axes.errorbar(
                needed[shown], place[shown], xerr=ends, markerfacecolor=face, label=label, **style
            )
    for row in place[~np.isfinite(needed)]:
        axes.text(
            *(0.02, row, "none found"), transform=axes.get_yaxis_transform(), size=7, va="center",
            bbox={"color": "white", "pad": 1},
        )  # fmt: skip
    gap = 100 * float(dataset.attrs["gap_m"])
    axes.axvline(gap, color=CURVES[2][0], linestyle=CURVES[2][1], label="existing gap")
    axes.set(
        xlim=(0, None),
        xlabel=f"gap needed for {100 * float(dataset.attrs['confidence']):.4g} % confidence [cm]",
    )


def _caption(dataset: xr.Dataset) -> str:
    attrs = dataset.attrs
    lines = roles_in_words(attrs, "first", "second", "ground")
    motions = f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}"
    lines.append(f"{motions}; bars: 95 % interval")
    for row in along(dataset, "measure"):
        if row.kind.item() == "given":
            lines.append(f"{row.measure.item()}: {row.description.item()}")
    return filled(lines, CAPTION, "    ")
