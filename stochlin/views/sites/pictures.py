"""The response spectrum of motions relative to the target: one column wide, and for print in grey."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.views.shared.style import (
    AS_GIVEN,
    CURVES,
    filled,
    legend_above,
    open_frame,
    plain_ticks,
    styled,
)
from stochlin.views.shared.words import per_cent
from stochlin.views.sites.words import fit_in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, UPPER, LOWER, EDGES, LINE = 4.6, 2.4, 1.05, 1.2, 0.14  # inches; LINE is that of a line of text
CAPTION = 70  # characters
TICKS = (0.05, 0.1, 0.2, 0.5, 1, 2, 4, 10)  # s
WITHIN = 0.06  # what fits to spectra hold to
NORMAL = 1.96  # standard errors to either side of a 95 % interval
LEAST, MOST = 0.12, 1.2  # shown of the ratio, to either side of 1


@styled(AS_GIVEN | {"font.size": 10})
def draw_spectrum(dataset: xr.Dataset, caption: bool = True, periods: Sequence[float] = ()) -> Figure:
    """Draw the result of `stochlin.charts.simulated_spectrum`.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from file.
    caption : bool
        Whether to describe below the chart the ground, duration, envelope and fit of the motions.
    periods : sequence of float
        Periods of buildings [s], which are marked. The fit is then described for their band, from 0.2 of
        the shortest to 1.5 of the longest.

    Returns
    -------
    matplotlib.figure.Figure
        Above, the response spectra over the period: the target, and of the simulated motions the mean
        and the range from 16 to 84 %. Below, if there is a target, the ratio
        of the mean to it with its 95 % interval, and lines at 6 % to either side.

    Raises
    ------
    ValueError
        If the dataset is another one, or of one period.
    """
    from matplotlib.figure import Figure

    known = "pseudo_acceleration_quantile" in dataset and "duration_s" in dataset.attrs
    if not known or dataset.sizes["period"] < 2:
        raise ValueError(
            f"dataset has the dimensions {dict(dataset.sizes)}; allowed: what simulated_spectrum "
            "returns, of two periods or more"
        )
    text = filled(_caption(dataset, periods), CAPTION) if caption else ""
    heights = [UPPER, LOWER] if "target" in dataset else [UPPER]
    size = WIDTH, sum(heights) + EDGES + LINE * text.count("\n")
    figure = Figure(size, layout="constrained")
    panels = figure.subplots(len(heights), sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    period: Any = dataset.period.values
    _spectra(panels[0], dataset)
    for number, mark in enumerate(periods, start=1):
        look: Any = {"color": CURVES[2][0], "lw": 1.0, "linestyle": (0, (1, 1)) if number == 1 else "-."}
        for axes in panels:
            axes.axvline(mark, label=f"building {number}" if axes is panels[0] else None, **look)
    for axes in panels[1:]:
        _ratio(axes, dataset)
    for axes in panels:
        axes.set(xscale="log", xlim=(period[0], period[-1]))
        plain_ticks(axes.xaxis, [tick for tick in TICKS if period[0] <= tick <= period[-1] * 1.001])
        open_frame(axes, ("top",))
    panels[-1].set_xlabel("period [s]")
    legend_above(panels[0])
    figure.supxlabel(text, x=0.02, ha="left", size=8)
    return figure


def _spectra(axes: Axes, dataset: xr.Dataset) -> None:
    """The response spectra of the motions, and the target."""
    period: Any = dataset.period.values
    band: Any = (dataset.pseudo_acceleration_quantile.sel(quantile=q).values for q in (0.16, 0.84))
    axes.fill_between(period, *band, color="0.82", lw=0, label="motions, 16 to 84 %")
    (color, dash), (black, solid) = CURVES[1], CURVES[0]
    mean = dataset.pseudo_acceleration.values
    axes.plot(period, mean, color=color, linestyle=dash, label="motions, mean")
    if "target" in dataset:
        axes.plot(period, dataset.target, color=black, linestyle=solid, lw=1.1, label="wanted")
    axes.set(ylim=(0, None), ylabel="spectral acceleration [m/s²]")
    axes.secondary_yaxis("right", functions=(_in_g, _of_g)).set_ylabel("[g]")


def _in_g(acceleration: Any) -> Any:
    return acceleration / constants.g


def _of_g(acceleration: Any) -> Any:
    return acceleration * constants.g


def _ratio(axes: Axes, dataset: xr.Dataset) -> None:
    """The ratio of the mean of the motions to the target, with its interval."""
    period, ratio = dataset.period.values, dataset.ratio.values
    error: Any = NORMAL * dataset.ratio_standard_error.values
    color, dash = CURVES[1]
    axes.fill_between(period, ratio - error, ratio + error, color="0.75", lw=0)
    axes.plot(period, ratio, color=color, linestyle=dash)
    axes.axhline(1, color=CURVES[0][0], lw=0.9)
    for end in (1 - WITHIN, 1 + WITHIN):
        axes.axhline(end, color="0.3", lw=0.8, ls=(0, (1, 1.5)))
        beside = axes.get_yaxis_transform()
        axes.text(1.015, end, per_cent(end - 1, sign="+"), size=8, va="center", transform=beside)
    away = min(max(1.1 * float(np.abs(ratio - 1).max()), LEAST), MOST)
    axes.set(ylim=(max(1 - away, 0), 1 + away), ylabel="ratio")


def _caption(dataset: xr.Dataset, periods: Sequence[float]) -> list[str]:
    """A description of the motions and of their fit."""
    attrs = dataset.attrs
    source = dataset.target.attrs.get("source") if "target" in dataset else None
    wanted = [f"Target: {source}."] if source else []
    motions = [f"Damping {attrs['damping']:g}; motions of {attrs['duration_s']:.4g} s, "
               f"{attrs.get('envelope', 'stationary')}."]  # fmt: skip
    return [attrs["title"], *wanted, *fit_in_words(dataset, periods), *motions, attrs["ground"]]
