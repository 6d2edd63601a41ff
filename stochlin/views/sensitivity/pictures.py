"""The tornado chart of the inputs of a gap: one column wide, and for print in grey."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from stochlin.views.sensitivity.words import CENTIMETRES, NAMES, asked, rows
from stochlin.views.shared.style import (
    AS_GIVEN,
    filled,
    legend_above,
    name_rows,
    open_frame,
    styled,
    swatches,
)
from stochlin.views.shared.words import roles_in_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.figure import Figure

WIDTH, HEAD, AXIS, LINE, MARGIN = 4.6, 0.28, 0.5, 0.15, 0.05  # inches
ROW = 0.48  # inches: an input, whose label may have three lines
NAME, CAPTION = 34, 66  # characters on a line
LEFT, RIGHT = 0.47, 0.97  # of the width
MOST = 14  # inputs that are drawn
EDGE = "#1b1b1b"
ENDS = {"low": ("#f2f2f2", "////"), "high": ("#7a9cbf", "")}  # face, hatch: told apart in grey


@styled(AS_GIVEN | {"font.size": 9, "hatch.linewidth": 0.7})
def draw_sensitivity(
    dataset: xr.Dataset, names: Mapping[str, str] = NAMES, caption: bool = True
) -> Figure:
    """Draw what `stochlin.sensitivity` returns: a bar for every input, the longest on top.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from a file.
    names : mapping
        Names of ``structure_1``, ``structure_2`` and ``ground`` in the chart.
    caption : bool
        Whether to describe the case below the chart.

    Returns
    -------
    matplotlib.figure.Figure
        How the gap changes with each input at the low and at the high end of its range, with standard
        errors. Uncertain inputs come first, below them known inputs, 10 % to either side.
        Inputs without influence on the gap are left out, and so are the smallest of more than 14.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "gap_change" not in dataset or "input" not in dataset.dims:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: a dataset that sensitivity "
            "returns"
        )
    shown = rows(dataset, names)[:MOST]
    text = _caption(dataset) if caption else ""
    foot = LINE * (text.count("\n") + 1.5) if text else 0.0
    labels = [f"{filled([row.label], NAME)}\n{row.range}, {row.kind}" for row in shown]
    place, high = np.arange(len(shown)), ROW * max(len(shown), 1)
    height = high + HEAD + AXIS + foot + MARGIN
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.add_axes((LEFT, (AXIS + foot) / height, RIGHT - LEFT, high / height))
    changes, errors = (
        CENTIMETRES * dataset[f"gap_change{end}"].values for end in ("", "_standard_error")
    )
    right = 1e-9
    for at, row in zip(place, shown, strict=True):
        for n, (end, shift) in enumerate((("low", -0.19), ("high", 0.19))):
            change, error = changes[row.place, n], errors[row.place, n]
            face, hatch = ENDS[end]
            style: Any = {"color": face, "hatch": hatch, "edgecolor": EDGE, "lw": 0.6, "zorder": 2}
            axes.barh(at + shift, change, 0.36, **style)
            axes.plot([change - error, change + error], [at + shift] * 2, color=EDGE, lw=1.0, zorder=3)
            right = max(right, abs(change) + error)
    axes.axvline(0, color=EDGE, lw=0.8, zorder=4)
    name_rows(axes, place, labels, 8.5)
    axes.set(xlim=(-1.05 * right, 1.05 * right), xlabel=f"change of the {asked(dataset)} [cm]")
    open_frame(axes, ("top", "right", "left"))
    legend_above(axes, handles=swatches({f"input {end}": look for end, look in ENDS.items()}, EDGE))
    figure.text(0.02, foot / height, text, va="top", size=8.5)
    return figure


def _caption(dataset: xr.Dataset) -> str:
    attrs = dataset.attrs
    result = (
        f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}; {asked(dataset)} "
        f"{CENTIMETRES * float(dataset.gap):.1f} cm with {100 * attrs['confidence']:.4g} % confidence. "
        "Lines: standard errors."
    )
    models = roles_in_words(attrs, "first", "second", "ground", "envelope")
    return filled([attrs["title"], *models, result], CAPTION, "    ")
