"""A pushover curve and its bilinear idealization, one column wide."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from stochlin.views.shared.style import AS_GIVEN, CURVES, filled, legend_above, open_frame, styled
from stochlin.views.shared.words import SPACE, length, rule_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WIDTH, HEIGHT, LEFT, HEAD, AXIS, LINE = 4.6, 2.6, 0.75, 0.5, 0.5, 0.14  # inches
CAPTION = 70  # characters
KILO, CENTI = 1e3, 1e-2


@styled(AS_GIVEN | {"font.size": 10})
def draw_pushover(dataset: xr.Dataset, caption: bool = True) -> Figure:
    """Draw a pushover curve and its idealization, the result of `stochlin.bilinear_of`.

    Parameters
    ----------
    dataset : xarray.Dataset
        From memory or from file.
    caption : bool
        Whether to describe the idealization below the chart.

    Returns
    -------
    matplotlib.figure.Figure
        Base shear over the displacement of the roof: the curve, the two lines of the idealization and
        its yield point.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "idealized_base_shear" not in dataset:
        raise ValueError(
            f"dataset has the dimensions {dict(dataset.sizes)}; allowed: what bilinear_of returns"
        )
    text = filled(_caption(dataset), CAPTION) if caption else ""
    foot = AXIS + LINE * (text.count("\n") + 1.5) if text else AXIS
    height = HEAD + HEIGHT + foot
    figure = Figure(figsize=(WIDTH, height))
    axes = figure.add_axes(
        (LEFT / WIDTH, foot / height, 0.97 - LEFT / WIDTH, HEIGHT / height),
        xlabel="displacement of the roof [cm]",
        ylabel="base shear [kN]",
    )
    corners = dataset.idealized_displacement.values / CENTI, dataset.idealized_base_shear.values / KILO
    (black, solid), (color, dash) = CURVES[:2]
    axes.plot(
        dataset.displacement.values / CENTI, dataset.base_shear.values / KILO,
        color=black, linestyle=solid, label="pushover curve",
    )  # fmt: skip
    axes.plot(*corners, color=color, linestyle=dash, label=f"idealization, {_method(dataset)}")
    axes.plot(*(along[1:2] for along in corners), "o", color=color, ms=5, zorder=3, label="yield point")
    axes.set(xlim=(0, None), ylim=(0, None))
    open_frame(axes)
    legend_above(axes)
    figure.text(0.02, (foot - AXIS) / height, text, va="top", size=8)
    return figure


def _method(dataset: xr.Dataset) -> str:
    return rule_label(dataset.attrs["method"])


def _caption(dataset: xr.Dataset) -> list[str]:
    """The curve, and the numbers of its idealization."""
    source = dataset.base_shear.attrs.get("source")
    taken = f"hardening ratio {float(dataset.hardening):.3g}"
    if abs(float(dataset.hardening - dataset.post_yield_ratio)) > 1e-9:
        taken += f" taken, {float(dataset.post_yield_ratio):.3g} in the idealization"
    share = float(dataset.effective_stiffness / dataset.initial_stiffness)
    return [
        f"{dataset.attrs['title']}, {_method(dataset)}" + (f": {source}." if source else "."),
        f"Yield at {length(float(dataset.yield_displacement))} and "
        f"{float(dataset.yield_force) / KILO:.4g}{SPACE}kN, {taken}; stiffness up to yield {share:.2f} "
        f"of that at the beginning; idealized up to {length(float(dataset.target_displacement))}.",
    ]
