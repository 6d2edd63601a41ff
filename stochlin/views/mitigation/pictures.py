"""A picture of measures against pounding: the gap that each needs, and its effect in records."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.shared.style import AS_GIVEN, CURVES, describe, filled, legend_above, styled
from stochlin.views.shared.words import along, roles_in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH, ROW, HEAD, FOOT, LINE = 7.2, 0.26, 0.4, 0.64, 0.14  # inches
NAMES, MIDDLE, LAST, ALONE = 0.34, 0.64, 0.97, 0.8  # of the width: where panels begin and end
NAME, CAPTION = 38, 112  # characters
MARKERS = ("o", "s", "^", "D", "v", "P")


@styled(AS_GIVEN)
def draw_measures(dataset: xr.Dataset) -> Figure:
    """Draw the table of `stochlin.mitigate`, from memory or from file.

    One line for each measure: the gap for the confidence with its interval, compared with the existing
    gap; with records, also the amplification of both buildings.
    """
    if "required_gap" not in dataset or "measure" not in dataset.dims:
        raise ValueError(
            f"dataset has the dimensions {tuple(dataset.dims)}; allowed: a dataset that mitigate returns"
        )
    from matplotlib.figure import Figure

    recorded = "record" in dataset.dims
    caption = _caption(dataset)
    foot = FOOT + LINE * (caption.count("\n") + 1)
    count = dataset.sizes["measure"]
    named = _named(dataset) if recorded else []
    head = HEAD + LINE * max(4, 2 + sum(1 + name.count("\n") for name in named))
    height = head + ROW * (count + 0.6) + foot
    figure = Figure(figsize=(WIDTH, height))
    end = MIDDLE if recorded else ALONE
    box = (foot / height, ROW * (count + 0.6) / height)
    gaps = figure.add_axes((NAMES, box[0], end - NAMES, box[1]))
    _gaps(gaps, dataset)
    panels = [gaps]
    if recorded:
        panels.append(figure.add_axes((MIDDLE + 0.03, box[0], LAST - MIDDLE - 0.03, box[1])))
        _amplifications(panels[1], dataset, named)
    for axes in panels:
        axes.set_ylim(count - 0.4, -0.6)
        axes.set_yticks(range(count))
        axes.tick_params(labelleft=axes is gaps, length=0)
        legend_above(axes, 1, 7)
    gaps.set_yticklabels([filled([str(n)], NAME) for n in dataset.measure.values], size=7.5)
    describe(figure, 0.02, foot - FOOT, dataset.attrs["title"], caption)
    return figure


def _gaps(axes: Axes, dataset: xr.Dataset) -> None:
    place = np.arange(dataset.sizes["measure"])
    needed = 100 * dataset.required_gap.values
    low, high = (100 * dataset[f"required_gap_{end}"].values for end in ("lower", "upper"))
    high = np.where(np.isfinite(high), high, needed)
    least = dataset.kind.values == "least"
    for group, face, label in ((~least, CURVES[0][0], "as built, given"), (least, "white", "least")):
        shown = group & np.isfinite(needed)
        if shown.any():
            ends = [(needed - low)[shown], (high - needed)[shown]]
            style: Any = {"fmt": "o", "color": CURVES[0][0], "ms": 5, "lw": 1, "capsize": 2}
            axes.errorbar(
                needed[shown], place[shown], xerr=ends, markerfacecolor=face, label=label, **style
            )
    thickness = 100 * dataset.bumper_thickness.values
    thick = np.isfinite(needed) & (thickness > 0)
    if thick.any():
        begin = needed[thick] - thickness[thick]
        axes.hlines(
            place[thick], begin, needed[thick], color="0.6", lw=4, zorder=1, label="thickness of bumpers"
        )
    for row in place[~np.isfinite(needed)]:
        axes.text(
            *(0.02, row, "none found"), transform=axes.get_yaxis_transform(), size=7, va="center",
            bbox={"color": "white", "pad": 1},
        )  # fmt: skip
    gap = 100 * float(dataset.attrs["gap_m"])
    axes.axvline(gap, color=CURVES[2][0], linestyle=CURVES[2][1], label="existing gap")
    axes.set(
        xlim=(0, None),
        xlabel=f"gap needed for {100 * float(dataset.attrs['confidence']):.4g} % confidence [cm]",
    )


def _named(dataset: xr.Dataset) -> list[str]:
    """Names of the records, or of their quantiles where they are many, as the legend can hold them."""
    if "quantile" in dataset.dims:
        shares = 100 * dataset["quantile"].values
        return [f"not exceeded in {share:.4g} % of the records" for share in shares]
    return [filled([str(record)], NAME) for record in dataset.record.values]


def _amplifications(axes: Axes, dataset: xr.Dataset, named: list[str]) -> None:
    place = np.arange(dataset.sizes["measure"])
    many = "quantile" in dataset.dims  # of more records than can be told apart
    style: Any = {"linestyle": "none", "ms": 5, "color": CURVES[1][0]}
    for number, (name, marker) in enumerate(zip(named, cycle(MARKERS), strict=False)):
        peaks = dataset.isel({"quantile" if many else "record": number})
        for n, face, label in ((1, CURVES[1][0], name), (2, "white", None)):
            values = peaks[f"{'record_' * many}amplification_{n}"]
            at = place + 0.12 * (2 * n - 3)
            axes.plot(values, at, marker=marker, markerfacecolor=face, label=label, **style)
    for name, face in (("building 1", "0.35"), ("building 2", "white")):
        axes.plot([], [], **style | {"color": "0.35"}, marker="o", markerfacecolor=face, label=name)
    axes.axvline(1, color="0.5", lw=0.8)
    axes.set_xlabel("peak, relative to that\nas built and alone")


def _caption(dataset: xr.Dataset) -> str:
    attrs = dataset.attrs
    lines = roles_in_words(attrs, "first", "second", "ground", "contact")
    motions = f"{attrs['paths']} motions of {attrs['duration_s']:g} s, seed {attrs['seed']}"
    lines.append(f"{motions}; bars: 95 % interval")
    for row in along(dataset, "measure"):
        if row.kind.item() == "given":
            lines.append(f"{row.measure.item()}: {row.description.item()}")
    return filled(lines, CAPTION, "    ")
