"""The influence of the inputs on a gap: sentences, a row for each input, and the tornado chart."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from stochlin.models.buildings.shear import STOREY_PARAMETERS
from stochlin.models.descriptions import shown_unit
from stochlin.views.shared.blocks import Block, Picture, TableBlock, TextBlock, texts
from stochlin.views.shared.style import (
    AS_GIVEN,
    CAPTION_LINE,
    CAPTION_WIDTH,
    COLUMN_WIDTH,
    caption_of,
    filled,
    legend_above,
    open_frame,
    styled,
)
from stochlin.views.shared.words import CENTIMETRES, MINUS, NBSP, number, per_cent

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr
    from matplotlib.figure import Figure

NAMES_OF_ROLES = {"structure_1": "building 1", "structure_2": "building 2", "ground": "the ground"}
LARGE_GAP = 0.05  # [m]: from here on tenths of a centimetre tell enough of a change
NEGLIGIBLE_CHANGE = 1e-6  # of the gap: what moves it by less does not matter
INPUT_RANGES = f"±{NBSP}10{NBSP}%", f"16 to 84{NBSP}%"  # ranges of known and of uncertain inputs
LEGEND_HEIGHT = 0.28  # inches
AXIS = 0.5  # inches
INPUT_ROW = 0.48  # inches: of at most three lines
INPUT_NAME_WIDTH = 34  # characters on a line
AXES_LEFT = 0.47  # of the width
AXES_RIGHT = 0.97  # of the width
MOST_INPUTS = 14  # inputs that are drawn
BAR_STYLE: Any = {"edgecolor": "#1b1b1b", "lw": 0.6, "error_kw": {"lw": 1.0}}
END_LOOKS = {"low": ("#f2f2f2", "////", -0.19), "high": ("#7a9cbf", "", 0.19)}  # distinct in grey


class InputLine(NamedTuple):
    """One input as it is shown."""

    place: int  # in the dataset
    label: str
    range: str
    kind: str
    change: str


def rows(table: xr.Dataset, names: Mapping[str, str] = NAMES_OF_ROLES) -> list[InputLine]:
    """The inputs that change the gap: uncertain ones, then known ones, by decreasing influence."""
    moves = np.abs(table.gap_change).max("end").values
    order = np.lexsort((-moves, 1 - table.uncertain.values))
    least = NEGLIGIBLE_CHANGE * max(float(table.gap), float(moves.max()))
    return [_row(table.isel(input=n), int(n), names) for n in order if moves[n] > least]


def _row(table: xr.Dataset, place: int, names: Mapping[str, str]) -> InputLine:
    role, _, key = str(table.input.item()).partition(".")
    unit = str(table.input_unit.item())
    median = float(table.input_median)
    of_all = unit == "1" and key in STOREY_PARAMETERS  # a factor on all values
    unit, scale = ("times", 1.0) if of_all else shown_unit(unit, median)
    ends = [number(median * scale * float(factor)) for factor in table.input_factor_at]
    digits = 1 if float(table.gap) >= LARGE_GAP else 2
    changes = [f"{CENTIMETRES * float(change):+.{digits}f}" for change in table.gap_change]
    return InputLine(
        place=place,
        label=f"{key.replace('_', ' ')} of {names[role]}",
        range=f"{' to '.join(ends)}{NBSP}{unit.replace(' ', NBSP)}".rstrip(),
        kind=INPUT_RANGES[int(table.uncertain)],
        change=" / ".join(changes).replace("-", MINUS),
    )


def blocks(table: xr.Dataset, names: Mapping[str, str] = NAMES_OF_ROLES) -> list[Block]:
    """The result in sentences, a row for each input, and the chart."""
    shown = rows(table, names)
    quantity = _asked(table)
    if not shown:
        return [TextBlock("No parameter of the buildings or of the ground changes it.")]
    most = shown[0]
    sentences = [
        f"The {quantity} depends most on the {most.label}: at the ends of its range, {most.range} "
        f"({most.kind}), it changes by {most.change}{NBSP}cm."
    ]
    if table.uncertain.any():
        less = float(table.gap_of_medians / table.gap) - 1
        error = float(table.gap_of_medians_standard_error / table.gap)
        sentences.append(
            f"If all inputs were known to be at their medians, the {quantity} would be "
            f"{100 * abs(less):.0f} ± {per_cent(error)} {'smaller' if less < 0 else 'larger'}."
        )
    listed = TableBlock.of(
        ["input", "range", "of it", f"{quantity} [cm]"], [row[1:] for row in shown], ("range",)
    )
    text = (
        f"Change of the {quantity} with each input at the ends of its range; lines: standard "
        "errors."
    )
    draw = partial(draw_sensitivity, table, names, caption=False)
    return [
        *texts(sentences),
        listed,
        Picture(f"Influence of each input on the {quantity}", text, draw),
    ]


def _asked(table: xr.Dataset) -> str:
    """The quantity of the answer: a gap, or the set-back of one building."""
    return "gap" if "second" in table.attrs else "set-back"


@styled(AS_GIVEN | {"font.size": 9, "hatch.linewidth": 0.7})
def draw_sensitivity(
    dataset: xr.Dataset, names: Mapping[str, str] = NAMES_OF_ROLES, caption: bool = True
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
        How the gap changes with each input at the low and at the high end of its range, with
        standard errors. Uncertain inputs come first, below them known inputs, 10 % to either side.
        Inputs without influence on the gap are left out, and so are the smallest of more than 14.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "gap_change" not in dataset or "input" not in dataset.dims:
        what = f"dataset has the dimensions {tuple(dataset.dims)}"
        raise ValueError(f"{what}; allowed: a dataset that sensitivity returns")
    shown = rows(dataset, names)[:MOST_INPUTS]
    text = caption_of(dataset, CAPTION_WIDTH) if caption else ""
    foot = CAPTION_LINE * len(text.splitlines())
    place = np.arange(len(shown))
    high = INPUT_ROW * max(len(shown), 1)
    height = high + LEGEND_HEIGHT + AXIS + foot
    figure = Figure(figsize=(COLUMN_WIDTH, height))
    axes = figure.add_axes(
        (AXES_LEFT, (AXIS + foot) / height, AXES_RIGHT - AXES_LEFT, high / height)
    )
    drawn = dataset.isel(input=[row.place for row in shown])
    for end, (face, hatch, shift) in END_LOOKS.items():
        at_end = CENTIMETRES * drawn.sel(end=end)
        style = BAR_STYLE | {"color": face, "hatch": hatch, "label": f"input {end}"}
        axes.barh(
            place + shift, at_end.gap_change, 0.36, xerr=at_end.gap_change_standard_error, **style
        )
    reach = CENTIMETRES * (np.abs(drawn.gap_change) + drawn.gap_change_standard_error)
    right = max(1e-9, float(reach.max())) if shown else 1e-9
    axes.axvline(0, color="#1b1b1b", lw=0.8, zorder=4)
    labels = [f"{filled([row.label], INPUT_NAME_WIDTH)}\n{row.range}, {row.kind}" for row in shown]
    axes.set_yticks(place, labels)
    axes.tick_params(axis="y", length=0, labelsize=8.5)
    axes.grid(visible=False, axis="y")
    axes.set(xlim=(-1.05 * right, 1.05 * right), ylim=(np.max(place, initial=0.0) + 0.6, -0.6))
    axes.set_xlabel(f"change of the {_asked(dataset)} [cm]")
    open_frame(axes, ("top", "right", "left"))
    legend_above(axes)
    figure.text(0.02, foot / height, text, va="top", size=8.5)
    return figure
