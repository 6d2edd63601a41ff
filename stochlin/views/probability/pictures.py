"""The picture of the probability of pounding over time."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from stochlin.views.shared.style import CURVES, describe, filled, legend_beside, styled
from stochlin.views.shared.words import roles_in_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDE, HEAD, FOOT, LINE = 7.2, 0.38, 0.5, 0.14  # inches
UPPER, LOWER, BETWEEN = 2.05, 1.4, 0.22  # inches: panels, and the space between them
WIDTH = 112  # characters of the caption
STEM = "confidence_of_no_pounding"
CONFIDENCES = {
    STEM: "crossings in clumps",
    f"{STEM}_poisson": "Poisson crossings",
    f"{STEM}_simulated": "simulated",
}
DEVIATIONS = {
    "difference_std": "$u_1 - u_2$ by formula",
    "difference_std_simulated": "simulated",
}


@styled()
def draw_pounding(dataset: xr.Dataset) -> Figure:
    """Draw the result of `pounding_probability` for one pair and one gap, over ``time`` alone.

    Confidence of no pounding above, standard deviations below.
    """
    from matplotlib.figure import Figure

    if f"{STEM}_simulated" not in dataset or dataset[f"{STEM}_simulated"].dims != ("time",):
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: a simulated probability of "
            "pounding over time alone, so select one pair and one gap"
        )
    caption = filled(roles_in_words(dataset.attrs), WIDTH, "    ")
    foot = FOOT + LINE * (caption.count("\n") + 1)
    height = foot + LOWER + BETWEEN + UPPER + HEAD
    figure, time = Figure(figsize=(WIDE, height)), dataset.time.values
    upper = figure.add_axes((0.1, (foot + LOWER + BETWEEN) / height, 0.6, UPPER / height))
    lower = figure.add_axes((0.1, foot / height, 0.6, LOWER / height))
    band = dataset[f"{STEM}_simulated_lower"], dataset[f"{STEM}_simulated_upper"]
    upper.fill_between(time, *band, color="0.8", label="simulated, 95 %")
    for axes, curves in ((upper, CONFIDENCES), (lower, DEVIATIONS)):
        present = ((name, label) for name, label in curves.items() if name in dataset)
        for (color, dash), (name, label) in zip(CURVES, present, strict=False):
            axes.plot(time, dataset[name], color=color, linestyle=dash, label=label)
        if dataset.permanent_set.any():
            end = dataset.attrs["strong_shaking_end_s"]
            axes.axvline(end, color="0.5", lw=0.8, label="end of strong shaking")
        axes.set_xlim(time[0], time[-1])
        legend_beside(axes)
    upper.set(ylim=(-0.02, 1.02), ylabel="confidence of no pounding")
    upper.tick_params(labelbottom=False)
    lower.set(ylabel="standard deviation [m]", xlabel="time [s]")
    describe(figure, 0.1, foot - FOOT, dataset.attrs["title"], caption)
    return figure
