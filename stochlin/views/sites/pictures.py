"""The response spectrum of motions beside the target: a picture for print, and its fit in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.applications.cases.separation import BAND
from stochlin.views.shared.style import (
    AS_GIVEN,
    COLUMN_WIDTH,
    CURVES,
    NOTE_LINE,
    decade_ticks,
    filled,
    legend_above,
    open_frame,
    styled,
)
from stochlin.views.shared.words import per_cent

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SPECTRUM_HEIGHT = 3.6  # inches
MOTIONS_WIDTH = 70  # characters
BAND_IN_WORDS = f"{BAND[0]:g} to {BAND[1]:g} times the periods of the buildings"


@styled(AS_GIVEN | {"font.size": 10})
def draw_spectrum(
    dataset: xr.Dataset, caption: bool = True, periods: Sequence[float] = ()
) -> Figure:
    """Draw the result of `stochlin.simulated_spectrum`.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from file.
    caption : bool
        Whether to describe below the chart the ground, duration, envelope and fit of the motions.
    periods : sequence of float
        Periods of buildings [s], which are marked. The fit is then described for their band, from
        0.2 of the shortest to 1.5 of the longest.

    Returns
    -------
    matplotlib.figure.Figure
        The response spectra over the period: the target, if there is one, and of the simulated
        motions the mean and the range from 16 to 84 %.

    Raises
    ------
    ValueError
        If the dataset is another one, or of one period.
    """
    from matplotlib.figure import Figure

    complete = "pseudo_acceleration_quantile" in dataset and "duration_s" in dataset.attrs
    if not complete or dataset.sizes["period"] < 2:
        what = f"dataset has the dimensions {dict(dataset.sizes)}"
        raise ValueError(
            f"{what}; allowed: what simulated_spectrum returns, of two periods or more"
        )
    text = filled(_caption(dataset, periods), MOTIONS_WIDTH) if caption else ""
    figure = Figure(
        (COLUMN_WIDTH, SPECTRUM_HEIGHT + NOTE_LINE * text.count("\n")), layout="constrained"
    )
    axes = figure.add_subplot()
    period = np.asarray(dataset.period)
    _spectra(axes, dataset)
    for number, mark in enumerate(periods, start=1):
        look: Any = {
            "color": CURVES[2][0],
            "lw": 1.0,
            "linestyle": (0, (1, 1)) if number == 1 else "-.",
        }
        axes.axvline(mark, label=f"building {number}", **look)
    axes.set(xscale="log", xlim=(period[0], period[-1]), xlabel="period [s]")
    decade_ticks(axes.xaxis)
    open_frame(axes, ("top",))
    legend_above(axes)
    figure.supxlabel(text, x=0.02, ha="left", size=8)
    return figure


def _spectra(axes: Axes, dataset: xr.Dataset) -> None:
    """The response spectra of the motions, and the target."""
    period: Any = dataset.period.values
    band: Any = (dataset.pseudo_acceleration_quantile.sel(quantile=q).values for q in (0.16, 0.84))
    axes.fill_between(period, *band, color="0.82", lw=0, label="motions, 16 to 84 %")
    color, dash = CURVES[1]
    black, solid = CURVES[0]
    mean = dataset.pseudo_acceleration.values
    axes.plot(period, mean, color=color, linestyle=dash, label="motions, mean")
    if "target" in dataset:
        axes.plot(period, dataset.target, color=black, linestyle=solid, lw=1.1, label="wanted")
    axes.set(ylim=(0, None), ylabel="spectral acceleration [m/s²]")
    in_g = (lambda acceleration: acceleration / constants.g, lambda ratio: ratio * constants.g)
    axes.secondary_yaxis("right", functions=in_g).set_ylabel("[g]")


def _caption(dataset: xr.Dataset, periods: Sequence[float]) -> list[str]:
    """A description of the motions and of their fit."""
    attrs = dataset.attrs
    source = dataset.target.attrs.get("source") if "target" in dataset else None
    wanted = [f"Target: {source}."] if source else []
    motions = [f"Damping {attrs['damping']:g}; motions of {attrs['duration_s']:.4g} s, "
               f"{attrs.get('envelope', 'stationary')}."]  # fmt: skip
    return [attrs["title"], *wanted, *fit_in_words(dataset, periods), *motions, attrs["ground"]]


def fit_in_words(dataset: xr.Dataset, periods: Sequence[float] = ()) -> list[str]:
    """Sentences about what `simulated_spectrum` returned; none without a target.

    With the ``periods`` of buildings [s], the fit is that in their band, if the spectrum reaches
    it.
    """
    if "target" not in dataset:
        return []
    shown = dataset
    where = ""
    if periods:
        low, high = BAND[0] * min(periods), BAND[1] * max(periods)
        inside = dataset.sel(period=slice(low, high))
        if inside.sizes["period"]:
            shown = inside
            where = f" from {low:.2g} to {high:.2g} s, {BAND_IN_WORDS}"
    away = shown.ratio - 1
    worst = shown.isel(period=int(abs(away).argmax("period")))
    return [
        f"Response spectrum, mean of the motions relative to the target{where}: off by "
        f"{per_cent(float((away**2).mean() ** 0.5), 1)} (root mean square), at most by "
        f"{per_cent(float(worst.ratio) - 1, 1, '+')}, at {float(worst.period):.2g} s."
    ]
