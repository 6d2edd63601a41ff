"""The shared style of the pictures: curves distinct in grey, names of quantities, ratio axes."""

from __future__ import annotations

import os
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial, wraps
from inspect import signature
from typing import TYPE_CHECKING, Any, Literal, ParamSpec

import numpy as np
import xarray as xr

from stochlin.files.storage import whole_file
from stochlin.messages import brief, check_names
from stochlin.models.arguments import checked
from stochlin.models.descriptions import roles_in_words
from stochlin.views.shared.blocks import PICTURE_FORMATS, typeset

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.figure import Figure

# Of every picture while it is drawn, and of nothing else; after STYLE.clear() the user's style
# holds.
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
SCREEN = 150
# inches
PAGE_WIDTH = 7.2  # of a picture as wide as a page
COLUMN_WIDTH = 4.6  # of one as wide as a column: a phone shows it at three quarters of its size
NOTE_LINE = 0.14  # of a line of notes, of 7.5 or 8 points
CAPTION_LINE = 0.17  # of a line of a caption, of 8.5 points
CAPTION_WIDTH = 66  # characters of such a line in a column
TICKS_OF_RATIOS = (0.1, 0.25, 0.5, 1, 2, 4)
BEFORE_UNIT = re.compile(r"(?<=\d) (?=[^\W\d])")
Arguments = ParamSpec("Arguments")


def styled(
    more: Mapping[str, Any] | None = None,
) -> Callable[[Callable[Arguments, Figure]], Callable[Arguments, Figure]]:
    """A decorator: the function draws in the package's style, and these settings."""

    def decorate(draw: Callable[Arguments, Figure]) -> Callable[Arguments, Figure]:
        @wraps(draw)
        def drawing(*args: Arguments.args, **kwargs: Arguments.kwargs) -> Figure:
            import matplotlib as mpl

            check_names(draw.__name__, kwargs, signature(draw).parameters)
            with mpl.rc_context(STYLE | dict(more or {})):
                return draw(*args, **kwargs)

        return drawing

    return decorate


def filled(lines: Iterable[str], width: int, hang: str = "") -> str:
    """The lines of a caption, none longer than so many characters; units stay with numbers."""
    fill = partial(textwrap.fill, width=width, subsequent_indent=hang, break_on_hyphens=False)
    return "\n".join(fill(BEFORE_UNIT.sub("\0", line)) for line in lines).replace("\0", " ")


def caption_of(dataset: xr.Dataset, width: int) -> str:
    """What is shown, the buildings, the ground and the motions, in lines of so many characters."""
    attrs = dataset.attrs
    lines = [attrs["title"], *roles_in_words(attrs, "first", "second", "ground", "envelope")]
    lines.append(f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}")
    return filled(lines, width, "    ")


@checked
def ratio_ticks(axis: Any, values: np.ndarray) -> None:
    """Label a logarithmic axis of period ratios with plain numbers."""
    axis.set_ticks([t for t in TICKS_OF_RATIOS if values[0] / 1.001 <= t <= values[-1] * 1.001])
    axis.set_ticks([], minor=True)
    axis.set_major_formatter("{x:g}")


def decade_ticks(axis: Axis) -> None:
    """Plain numbers 1, 2 and 5 of each decade on an axis that is logarithmic already."""
    from matplotlib.ticker import LogLocator

    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("")


def quantity(values: xr.DataArray) -> str:
    """The label of an axis: the long name of the variable, and its unit if it has one."""
    name = values.attrs.get("long_name", str(values.name))
    units = values.attrs.get("units", "1")
    return typeset(name if units == "1" else f"{name} [{units}]")


def label_axis(axes: Axes, way: Literal["x", "y"], values: xr.DataArray) -> None:
    """An axis of these values; of periods and their ratios it is logarithmic."""
    if str(values.name).startswith("period"):
        axes.set(**{f"{way}scale": "log"})
        ratio_ticks(axes.xaxis if way == "x" else axes.yaxis, values.values)
    axes.set(**{f"{way}label": quantity(values)})


def legend_above(axes: Axes, columns: int = 2, size: float = 8.5) -> None:
    """The legend above the axes, in so many columns; none where nothing has a label."""
    if axes.get_legend_handles_labels()[0]:
        axes.legend(
            loc="lower left", bbox_to_anchor=(-0.02, 1.0), ncols=columns,
            borderaxespad=0.2, fontsize=size, columnspacing=1.2, handlelength=2.6,
            labelspacing=0.25,
        )  # fmt: skip


def open_frame(axes: Axes, sides: Sequence[str] = ("top", "right")) -> None:
    """Axes without lines at these sides, and with the grid behind what is drawn."""
    axes.set_axisbelow(True)
    axes.spines[[*sides]].set_visible(False)


def save(figure: Figure, path: str | os.PathLike[str], dpi: float | None = None) -> None:
    """Write a picture whole or not at all; ``.png``, ``.svg`` or ``.pdf``.

    It has no date, and a ``.png`` names no program, so that the same picture gives the same file.
    """
    import matplotlib as mpl

    suffix = os.path.splitext(path)[1].lower()
    if suffix not in PICTURE_FORMATS:
        raise ValueError(
            f"path = {brief(os.fspath(path))}; allowed: an ending of {', '.join(PICTURE_FORMATS)}"
        )
    with mpl.rc_context(STYLE), whole_file(path) as temporary:
        _fix_layout(figure, dpi or PRINT)
        figure.savefig(temporary, dpi=dpi or PRINT, metadata=PICTURE_FORMATS[suffix])


def _fix_layout(figure: Figure, dpi: float) -> None:
    """Leave the axes where the layout engine puts them, to 1e-9 of the figure.

    The engine's solver orders its terms by addresses in memory, so that its last digits vary.
    """
    if figure.get_layout_engine() is None:
        return
    previous = figure.dpi
    figure.dpi = dpi
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    for axes in figure.axes:
        axes.set_position(np.round(axes.get_position(original=True).bounds, 9))
    figure.dpi = previous
