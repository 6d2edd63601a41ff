"""Panels of a chart, their legend, and the words around them, on the screen and in print."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.messages import brief
from stochlin.views.shared.style import filled, plain_ticks, quantity
from stochlin.views.shared.symbols import typeset

if TYPE_CHECKING:
    import numpy as np
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.figure import Figure

INCH = 0.0254  # m
WIDTH = 7.2  # inches, of a picture on the screen
NARROW = 5.0  # inches, below which panels stand in one column
PRINT_WIDTHS = 0.08, 0.25  # m, the range
# Of a picture in print, where no text is below 7 points; on the screen it is 8 to 10.
PRINT_STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.labelsize": 8,
    "legend.fontsize": 7.5,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "axes.linewidth": 0.6,
    "lines.linewidth": 1.2,
}
SCREEN_STYLE: Any = {"axes.titlesize": 9, "legend.fontsize": 8}
CAPTION_WIDTH, COMMENT_WIDTH, LABEL_WIDTH = 110, 125, 30  # characters
MARGIN = 0.1  # inches
FEW_TICKS = (0.1, 0.25, 1, 4)
CENTIMETRES = 100.0


def width_in_print(print_width: float | None) -> float:
    """Width of a picture in inches; on the screen without a width [m] in print."""
    if print_width is None:
        return WIDTH
    low, high = PRINT_WIDTHS
    if not isinstance(print_width, int | float) or not low <= print_width <= high:
        raise ValueError(
            f"print_width = {brief(print_width)} is out of range; allowed: {low:g} to {high:g} m, such "
            "as 0.084 and 0.174 for one and two columns"
        )
    return float(print_width) / INCH


def panels(figure: Figure, rows: int, columns: int, height: float, **options: Any) -> np.ndarray:
    """Axes ``height`` inches high, with room for what stands around them; rows first."""
    figure.set_layout_engine("constrained", w_pad=0.05, h_pad=0.05)
    figure.set_figheight(rows * height + 0.4)
    return figure.subplots(rows, columns, squeeze=False, **options)


def in_a_row(figure: Figure, count: int, height: float, **options: Any) -> list[Axes]:
    """Panels beside one another, or below one another in a narrow picture."""
    across = 1 if is_narrow(figure) else count
    return list(panels(figure, count // across, across, height, **options).ravel())


def is_narrow(figure: Figure) -> bool:
    """Whether a picture has the width of one column of print."""
    return bool(figure.get_figwidth() < NARROW)


def legend(figure: Figure, axes: Sequence[Axes], columns: int = 5, more: Sequence[Any] = ()) -> None:
    """The legend of all curves of these axes, which `arrange` places above them."""
    entries: dict[str, Any] = {}
    for panel in axes:
        for handle, text in zip(*panel.get_legend_handles_labels(), strict=True):
            entries.setdefault(textwrap.fill(text, LABEL_WIDTH), handle)
    entries |= {str(handle.get_label()): handle for handle in more}
    options: Any = {"loc": "upper left", "columnspacing": 1.2, "handlelength": 2.6, "borderaxespad": 0.0}
    for count in range(columns, 0, -1):  # as many columns as there is room for
        made = figure.legend(list(entries.values()), list(entries), ncols=count, **options)
        figure.draw_without_rendering()
        if count == 1 or made.get_window_extent().width < figure.bbox.width - 2 * MARGIN * figure.dpi:
            return
        made.remove()


def bar_beside(figure: Figure, filled_with: Any, axes: Sequence[Axes], table: xr.DataArray) -> Colorbar:
    """The bar of the shades of these axes with the name of the table; below them in a narrow picture."""
    where: Any = {"location": "bottom" if is_narrow(figure) else "right", "aspect": 30}
    bar = figure.colorbar(filled_with, ax=list(axes), label=quantity(table), format="%g", **where)
    bar.ax.grid(visible=False)
    return bar


def few_ticks(figure: Figure, every: Iterable[Axes]) -> None:
    """Plain numbers on axes of ratios, so few that they do not touch in a narrow picture."""
    if is_narrow(figure):
        for axes in every:
            low, high = axes.get_xlim()
            plain_ticks(axes.xaxis, [tick for tick in FEW_TICKS if low <= 1.001 * tick <= 1.002 * high])


def in_cm(table: xr.DataArray) -> xr.DataArray:
    """A length in centimetres."""
    return (CENTIMETRES * table).assign_attrs(table.attrs | {"units": "cm"}).rename(table.name)


def arrange(figure: Figure, attrs: Mapping[str, Any]) -> None:
    """Place legend and title above the panels, caption and comment below; they make the picture higher.

    A figure whose axes have places of their own keeps its size, and has the words at its edges.
    """
    title = typeset(attrs.get("title", ""))
    caption = typeset(filled(attrs.get("caption", "").splitlines(), CAPTION_WIDTH))
    comment = typeset(filled([attrs.get("comment", "")], COMMENT_WIDTH))
    high, low = (0.14 * len(text.splitlines()) + 0.06 * bool(text) for text in (caption, comment))
    engine: Any = figure.get_layout_engine()
    left = 0.1
    if engine is not None:
        figure.draw_without_rendering()
        keys = sum(key.get_window_extent().height / figure.dpi for key in figure.legends)
        head, body, left = 0.35 * bool(title), figure.get_figheight(), MARGIN / figure.get_figwidth()
        total = body + head + keys + high + low + MARGIN
        figure.set_figheight(total)
        engine.set(rect=(0, (high + low + MARGIN) / total, 1, body / total))
        for key in figure.legends:
            key.set_bbox_to_anchor((left, 1 - head / total), figure.transFigure)
        above, high = 0.08, high + low + 0.03
    else:
        total, above = figure.get_figheight(), 0.12
        high = max(0.62, high + low + 0.1)
    for text, top, size, style in (
        (title, 1 - above / total, 10, "normal"),
        (caption, high / total, 8, "normal"),
        (comment, (low + 0.03) / total, 7, "italic"),
    ):
        if text:
            figure.text(left, top, text, va="top", size=size, style=style)
