"""Panels of a chart, and the words around them, on the screen and in print."""

from __future__ import annotations

import textwrap
from collections.abc import Hashable, Iterator, Sequence
from itertools import product
from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.messages import brief
from stochlin.views.shared.style import filled, quantity
from stochlin.views.shared.symbols import typeset
from stochlin.views.shared.words import rule_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
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
NOTE_WIDTH, LABEL_WIDTH = 120, 30  # characters
KEY, LETTER, LINE = 0.6, 0.054, 0.14  # inches: a key of the legend with its margins, a letter, a line
AMPLE = 4.0  # inches
CENTIMETRES = 100.0
SYMBOLS = {"damping": r"$\xi$", "reduction_factor": "R", "ductility": r"$\mu$"}


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
    return bool(figure.get_figwidth() < NARROW)


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
    return f"{SYMBOLS.get(str(dim), dim)} = {value:g}"


def bar_beside(figure: Figure, shades: Any, axes: Sequence[Axes], table: xr.DataArray) -> None:
    """The bar of the shades of these axes with the name of the table; below them in a narrow picture."""
    where: Any = {"location": "bottom" if is_narrow(figure) else "right", "aspect": 30}
    bar = figure.colorbar(shades, ax=list(axes), label=quantity(table), format="%g", **where)
    bar.ax.grid(visible=False)


def in_cm(table: xr.DataArray) -> xr.DataArray:
    """A length in centimetres."""
    return (CENTIMETRES * table).assign_attrs(table.attrs | {"units": "cm"}).rename(table.name)


def arrange(figure: Figure, title: str, *notes: str) -> None:
    """Title and legend above the panels, notes below; they make the picture higher.

    The legend has every curve of axes that have no legend of their own.
    """
    entries: dict[str, Any] = {}
    for axes in figure.axes:
        if axes.get_legend() is None:
            for handle, text in zip(*axes.get_legend_handles_labels(), strict=True):
                entries.setdefault(textwrap.fill(text, LABEL_WIDTH), handle)
    longest = max((len(line) for text in entries for line in text.splitlines()), default=0)
    head = figure.legend(
        list(entries.values()), list(entries), loc="outside upper left", title=typeset(title),
        ncols=max(1, int(figure.get_figwidth() / (KEY + LETTER * longest))), title_fontsize=10,
        alignment="left", borderaxespad=0.3, borderpad=0.2, columnspacing=1.2, handlelength=2.6,
    )  # fmt: skip
    text = typeset(filled([line for note in notes for line in note.splitlines()], NOTE_WIDTH))
    if text:
        figure.supxlabel(text, x=0.012, ha="left", size=7.5)
    height = figure.get_figheight()
    figure.set_figheight(height + AMPLE)  # no legend is as high
    figure.draw_without_rendering()
    above = head.get_window_extent().height / figure.dpi
    figure.set_figheight(height + above + LINE * len(text.splitlines()))
