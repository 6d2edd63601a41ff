"""The picture of the probability of pounding over time."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from stochlin.views.shared.style import CURVES, describe, filled, legend_beside, styled
from stochlin.views.shared.words import roles_in_words

if TYPE_CHECKING:
    from collections.abc import Hashable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDE, HEAD, FOOT, LINE = 7.2, 0.38, 0.5, 0.14  # inches
PANELS, BETWEEN = (2.05, 1.4, 1.25), (0.22, 0.72, 0.0)  # inches: panels, and the space below each
WIDTH = 112  # characters of the caption
NAME = 22  # characters of a line in a legend
ESTIMATES = (
    ("", "crossings in clumps"),
    ("_poisson", "Poisson crossings"),
    ("_corrected", "bias corrected"),
)
SIZES = (
    ("difference_std", "$u_1 - u_2$ by formula"),
    ("radius_1", "radius, building 1"),
    ("difference_std_corrected", "bias corrected"),
    ("radius_2", "radius, building 2"),
    ("difference_std_simulated", "simulated"),
)


@styled()
def draw_pounding(dataset: xr.Dataset) -> Figure:
    """Draw the result of `pounding_probability` for one pair and one gap, over ``time`` alone.

    Confidence of no pounding above, standard deviations or radii below; of a case with records, as
    ``stochlin probability`` saves it, the confidence in each record by the hybrid method below these.
    """
    stem = "confidence_of_no_pounding"
    if _dims_of(dataset, stem) != ("time",):
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: a probability of pounding over "
            "time alone, so select one pair and one gap"
        )
    recorded = f"record_{stem}" in dataset
    figure, (upper, lower, *below) = _captioned(dataset, 2 + recorded)
    time = dataset.time.values
    _estimates(upper, dataset, stem, time)
    upper.set(ylim=(-0.02, 1.02), ylabel="confidence of no pounding")
    upper.tick_params(labelbottom=False)
    for (color, dash), (name, label) in zip(CURVES, SIZES, strict=False):
        if known(dataset, name):
            lower.plot(time, dataset[name], color=color, linestyle=dash, label=label)
    radii = "radius_1" in dataset
    ylabel = "energy radius [m]" if radii else "standard deviation [m]"
    lower.set(ylabel=ylabel, xlabel="time [s]")
    if "permanent_set" in dataset and bool(dataset.permanent_set.any()):
        for axes in (upper, lower):
            end = dataset.attrs["strong_shaking_end_s"]
            axes.axvline(end, color="0.5", lw=0.8, label="end of strong shaking")
    for axes in (upper, lower):
        axes.set_xlim(time[0], time[-1])
        legend_beside(axes)
    if recorded:
        _records(below[0], dataset, f"record_{stem}")
    return figure


def _dims_of(dataset: xr.Dataset, name: str) -> tuple[Hashable, ...]:
    """Dimensions of a probability by formula, or of the simulated one where there is no formula."""
    present = [each for each in (name, f"{name}_simulated") if each in dataset]
    return dataset[present[0]].dims if present else ()


def known(dataset: xr.Dataset, name: str) -> bool:
    """Whether there is a curve to draw under this name."""
    return name in dataset and int(dataset[name].notnull().sum()) > 1


def _captioned(dataset: xr.Dataset, count: int) -> tuple[Figure, list[Axes]]:
    """A figure with so many panels below each other, and a description of the case."""
    from matplotlib.figure import Figure

    caption = filled(roles_in_words(dataset.attrs), WIDTH, "    ")
    foot = FOOT + LINE * (caption.count("\n") + 1)
    height = HEAD + sum(PANELS[:count]) + sum(BETWEEN[: count - 1]) + foot
    figure, top, panels = Figure(figsize=(WIDE, height)), height - HEAD, []
    for high, space in zip(PANELS[:count], BETWEEN, strict=False):
        panels.append(figure.add_axes((0.1, (top - high) / height, 0.6, high / height)))
        top -= high + space
    describe(figure, 0.1, foot - FOOT, dataset.attrs["title"], caption)
    return figure, panels


def _estimates(axes: Axes, dataset: xr.Dataset, stem: str, x: np.ndarray) -> None:
    present = [estimate for estimate in ESTIMATES if known(dataset, stem + estimate[0])]
    for (color, dash), (ending, label) in zip(CURVES, present, strict=False):
        axes.plot(x, dataset[stem + ending], color=color, linestyle=dash, label=label)
    simulated = f"{stem}_simulated"
    if simulated in dataset:
        band = dataset[f"{simulated}_lower"], dataset[f"{simulated}_upper"]
        axes.fill_between(x, *band, color="0.8", label="simulated, 95 %")
    if simulated in dataset and not present:
        axes.plot(x, dataset[simulated], color=CURVES[0][0], label="simulated")


def _records(axes: Axes, dataset: xr.Dataset, name: str) -> None:
    """The confidence in each record by the hybrid method."""
    for (color, dash), record in zip(cycle(CURVES), dataset.record.values, strict=False):
        course = dataset.sel(record=record)
        label = filled([str(record).replace("$", r"\$")], NAME)
        axes.plot(course.record_time, course[name], color=color, linestyle=dash, label=label)
    axes.set(ylim=(-0.02, 1.02), xlim=(0, float(dataset.record_time[-1])))
    axes.set(xlabel="time from the beginning of the record [s]", ylabel="confidence")
    axes.set_title("in each record, by the hybrid method", loc="left", size=9)
    legend_beside(axes)
