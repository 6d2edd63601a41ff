"""The picture of the probability of pounding over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.applications.probability.probability import STEM
from stochlin.models.descriptions import roles_in_words
from stochlin.views.shared.style import CURVES, NOTE_LINE, PAGE_WIDTH, filled, styled
from stochlin.views.shared.words import with_interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# inches
TITLE_HEIGHT = 0.38
TIME_AXIS_HEIGHT = 0.5
CONFIDENCE_PANEL = 2.6
CAPTION_CHARACTERS = 112  # characters of the caption
CURVES_OF = {STEM: "clustered crossings", f"{STEM}_poisson": "independent crossings"}


@styled()
def draw_pounding(dataset: xr.Dataset) -> Figure:
    """Draw the result of `pounding_probability` for one pair and one gap: the confidence over time.

    The simulated one, with its interval, stands at the end of the motion.
    """
    from matplotlib.figure import Figure

    if f"{STEM}_simulated" not in dataset or dataset[f"{STEM}_simulated"].dims:
        what = f"dataset has the dimensions {tuple(dataset.dims)}"
        raise ValueError(
            f"{what}; allowed: a simulated probability of one pair and one gap over time"
        )
    caption = filled(roles_in_words(dataset.attrs), CAPTION_CHARACTERS, "    ")
    foot = TIME_AXIS_HEIGHT + NOTE_LINE * (caption.count("\n") + 1)
    height = foot + CONFIDENCE_PANEL + TITLE_HEIGHT
    figure = Figure(figsize=(PAGE_WIDTH, height))
    time = dataset.time.values
    axes = figure.add_axes((0.1, foot / height, 0.6, CONFIDENCE_PANEL / height))
    present = ((name, label) for name, label in CURVES_OF.items() if name in dataset)
    for (color, dash), (name, label) in zip(CURVES, present, strict=False):
        axes.plot(time, dataset[name], color=color, linestyle=dash, label=label)
    share, low, high = with_interval(dataset, f"{STEM}_simulated")
    style: Any = {"color": CURVES[2][0], "capsize": 4, "clip_on": False}
    style["label"] = "simulated, 95 % interval"
    axes.errorbar(time[-1], share, [[share - low], [high - share]], fmt="o", **style)
    if "permanent_set_left_out" in dataset and dataset.permanent_set_left_out.any():
        end = dataset.attrs["strong_shaking_end_s"]
        axes.axvline(end, color="0.5", lw=0.8, label="end of strong shaking")
    axes.set(xlim=(time[0], time[-1]), ylim=(-0.02, 1.02))
    axes.set(ylabel="confidence of no pounding", xlabel="time [s]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1), borderaxespad=0)
    figure.text(0.1, 1 - 0.2 / height, dataset.attrs["title"], size=10)
    figure.text(0.1, (foot - TIME_AXIS_HEIGHT) / height, caption, va="top", size=7.5)
    return figure
