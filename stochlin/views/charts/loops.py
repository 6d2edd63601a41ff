"""The picture of a hysteresis loop."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.analyses.charts.loops import hysteresis_loop
from stochlin.views.shared.style import CURVES, filled, open_frame, quantity, styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT, AXIS, LINE = 4.6, 3.2, 0.5, 0.14  # inches; of a line of text
LEFT = 0.15  # of the width
CAPTION = 70  # characters


def plot_loop(structure: Any, history: Any) -> Figure:
    """The picture of a structure's restoring force along a history of displacements.

    It is `stochlin.charts.draw_loop` of the result of `hysteresis_loop`, which gives the numbers.

    Parameters
    ----------
    structure : Bilinear, BoucWen, Hysteretic or another oscillator
        As in `hysteresis_loop`.
    history : array
        Displacements [m] from turn to turn, as in `hysteresis_loop`.

    Returns
    -------
    matplotlib.figure.Figure
        The loop, with its end as a dot, and the structure in words.

    Raises
    ------
    ValueError, TypeError
        As in `hysteresis_loop`.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (7).

    Examples
    --------
    >>> import stochlin as sl
    >>> rocking = sl.Flag(0.6, 0.05, hardening=0.05, yield_displacement=0.02)
    >>> figure = sl.plot_loop(rocking, [0.05, -0.05, 0.0])
    >>> figure.savefig("loop.pdf")  # doctest: +SKIP
    """
    return draw_loop(hysteresis_loop(structure, history))


@styled()
def draw_loop(dataset: xr.Dataset, caption: bool = True) -> Figure:
    """Draw the result of `stochlin.hysteresis_loop`: the restoring force over the displacement.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from file.
    caption : bool
        Whether to describe the structure below the picture.

    Returns
    -------
    matplotlib.figure.Figure
        The loop, with its end as a dot.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if not {"displacement", "force_per_mass"} <= {*dataset}:
        raise ValueError("the dataset has no loop; allowed: a result of stochlin.hysteresis_loop")
    text = filled([str(dataset.attrs["structure"])], CAPTION) if caption else ""
    foot = LINE * (text.count("\n") + 1.5) if text else 0.05
    figure = Figure((WIDTH, HEIGHT + AXIS + foot))
    whole = HEIGHT + AXIS + foot
    axes = figure.add_axes((LEFT, (AXIS + foot) / whole, 0.97 - LEFT, (HEIGHT - 0.1) / whole))
    open_frame(axes)
    [(color, dash), *_] = CURVES
    u, force = dataset.displacement, dataset.force_per_mass
    axes.plot(u, force, color=color, linestyle=dash, lw=1.0)
    axes.plot(u[-1:], force[-1:], color=color, marker="o", ms=4)
    for line in (axes.axhline, axes.axvline):
        line(0, color="0.6", lw=0.6, zorder=0)
    axes.set(xlabel=quantity(u), ylabel=quantity(force))
    figure.text(0.02, foot / whole, text, va="top", size=8)
    return figure
