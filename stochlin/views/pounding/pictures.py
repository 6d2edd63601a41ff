"""Pictures of pounding: both sides of every gap, the forces of contacts, and the energies."""

from __future__ import annotations

import textwrap
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.analyses.cases.pounding import (
    ENERGIES,
    displacement_beside,
    energy_of,
    hardest_contacts,
    hardness,
)
from stochlin.analyses.pounding.rows import COLUMN
from stochlin.views.shared.descriptions import roles_in_words
from stochlin.views.shared.style import AS_GIVEN, CURVES, describe, filled, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WIDTH = 7.2  # inches
GAP, FORCE, ENERGY, CLOSE_UP = 1.6, 1.2, 1.6, 1.6  # inches: heights of the panels
HEAD, BETWEEN, AXIS, LINE = 0.35, 0.15, 0.52, 0.135  # inches: above, between, below a time axis, of text
LEFT, RIGHT = 0.11, 0.72  # of the width
CAPTION = 108  # characters
NAME = 22  # characters of a line in a legend
AROUND = 1.5  # s: of the close-up, to both sides of the hardest impact
CENTIMETRES, MEGA, KILO = 100.0, 1e-6, 1e-3
MANY = 1e7  # J: from there on in MJ
CONTACTS = "contacts"
LABELS = ("from the ground", "damping", "yielding", CONTACTS, "motion, springs")  # of ENERGIES


@styled(AS_GIVEN)
def draw_pound(dataset: xr.Dataset) -> Figure:
    """Draw one dataset of ``stochlin pound``.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `stochlin.charts.pound_case` makes them, from memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        Over time: for each gap the displacements of both sides, of buildings with storeys at the contact
        that is hit hardest; forces of all impacts; energies. Impacts are marked. Of one building alone:
        its displacement, of the roof if it has storeys, and energies.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    from matplotlib.figure import Figure

    if "energy_share" not in dataset:
        raise ValueError(
            f"dataset has dimensions {tuple(dataset.dims)}; allowed: one that 'stochlin pound' saves"
        )
    shown = hardest_contacts(dataset) if "contact" in dataset.dims else []
    hits = bool(dataset.sizes.get("impact"))
    over_time = len(shown) + 2  # panels, the last of them energies
    heights = [*[GAP] * len(shown), FORCE if shown else GAP, ENERGY, *[CLOSE_UP] * hits]
    caption = caption_of(dataset)
    foot = AXIS + LINE * (caption.count("\n") + 1) + 0.1
    height = HEAD + sum(heights) + BETWEEN * (len(heights) - 1) + AXIS * hits + foot
    figure = Figure(figsize=(WIDTH, height))
    panels, top = [], height - HEAD
    for number, panel_height in enumerate(heights):
        top -= panel_height + (AXIS * hits if number == over_time else 0)
        box = (LEFT, top / height, RIGHT - LEFT, panel_height / height)
        panels.append(figure.add_axes(box))
        top -= BETWEEN
    for axes, number in zip(panels, shown, strict=False):
        _sides(axes, dataset, number)
    if shown:
        _forces(panels[len(shown)], dataset, shown)
    else:
        _roof(panels[0], dataset)
    _energies(panels[over_time - 1], dataset)
    for axes in panels[:over_time]:
        axes.set_xlim(float(dataset.time[0]), float(dataset.time[-1]))
        axes.tick_params(labelbottom=axes is panels[over_time - 1])
    if hits:
        _close_up(panels[-1], dataset)
    for axes in (panel for panel in panels if panel.get_legend_handles_labels()[1]):
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.03), borderaxespad=0, fontsize=8)
    for axes in {panels[over_time - 1], panels[-1]}:
        axes.set_xlabel("time [s]")
    describe(figure, LEFT, foot - AXIS, dataset.attrs["title"], caption)
    return figure


def _sides(axes: Axes, dataset: xr.Dataset, number: int) -> None:
    """Both sides of a gap in one frame: the distance between the curves is open."""
    contact = dataset.isel(contact=number)
    gap = float(contact.gap)
    beside = (displacement_beside(dataset, side) for side in ("left", "right"))
    left, right = (side.isel(contact=number).values for side in beside)
    left, right = CENTIMETRES * left, CENTIMETRES * (right + gap)
    time = dataset.time.values
    axes.fill_between(time, left, np.maximum(left, right), color="0.9", lw=0, label="open")
    for values, name, (color, dash) in zip(
        (left, right), _names(dataset, contact), CURVES, strict=False
    ):
        axes.plot(time, values, color=color, linestyle=dash, lw=0.9, label=name)
    hits = dataset.impact_time.values[dataset.impact_contact.values == number + 1]
    hits = hits[(hits >= time[0]) & (hits <= time[-1])]
    struck = "level" in dataset.coords and str(contact.kind.item()) == COLUMN
    if hits.size:
        style: Any = {"marker": "v", "color": "#2166ac", "ls": "", "ms": 4, "clip_on": False}
        if struck:
            style |= {"marker": "X", "color": "#b2182b", "ms": 6}
        transform = axes.get_xaxis_transform()
        axes.plot(hits, np.full(hits.size, 1.0), transform=transform, label="impact", **style)
    if "level" in dataset.coords:
        where = f"{float(contact.level):.4g} m up{', SLAB AGAINST COLUMN' * struck}"
        axes.text(0.01, 0.97, where, transform=axes.transAxes, va="top", size=8)
    axes.set_ylabel("place [cm]")


def _roof(axes: Axes, dataset: xr.Dataset) -> None:
    """The displacement of a single building, at its roof."""
    table = dataset.isel(structure=0)
    place = table.displacement.isel(floor=-1) if "floor" in table.dims else table.displacement
    (color, _), name = CURVES[0], textwrap.fill(str(table.building.item()), NAME)
    axes.plot(dataset.time, CENTIMETRES * place, color=color, lw=0.9, label=name)
    axes.set_ylabel("roof [cm]" if "floor" in table.dims else "place [cm]")


def _close_up(axes: Axes, dataset: xr.Dataset) -> None:
    """Both sides of the gap around the impact that is hardest, or fastest where there are no forces."""
    hardest = dataset.isel(impact=int(dataset[hardness(dataset)].argmax("impact")))
    at = float(hardest.impact_time)
    window = dataset.isel(time=np.abs(dataset.time.values - at) <= AROUND)
    _sides(axes, window, int(hardest.impact_contact) - 1)
    axes.set_xlim(float(window.time[0]), float(window.time[-1]))
    axes.set_title("around the hardest impact", loc="left", size=9, pad=7)


def _names(dataset: xr.Dataset, contact: xr.Dataset) -> list[str]:
    """Names of the buildings on both sides of a contact, as a legend can hold them."""
    names = dataset.building.values[[int(contact[side]) - 1 for side in ("left", "right")]]
    return [textwrap.fill(str(name), NAME) for name in names]


def _forces(axes: Axes, dataset: xr.Dataset, shown: list[int]) -> None:
    """The largest force of every impact; of impacts without a force the velocity of approach."""
    if not dataset.sizes["impact"]:
        axes.text(0.5, 0.5, "no impact", transform=axes.transAxes, ha="center", va="center")
        axes.set(yticks=[], ylabel="force")
        return
    name = hardness(dataset)
    forces = name == "largest_force"
    scale = MEGA if forces else 1.0
    for number, (color, _), marker in zip(shown, cycle(CURVES), cycle("osD^v"), strict=False):
        same = dataset.left.values == int(dataset.left[number])  # all contacts across this gap
        mine = same[dataset.impact_contact.values - 1]
        time, values = dataset.impact_time.values[mine], scale * dataset[name].values[mine]
        axes.vlines(time, 0, values, color=color, lw=0.8)
        label = " |\n".join(_names(dataset, dataset.isel(contact=number)))
        axes.plot(time, values, color=color, marker=marker, ls="", ms=3, label=label)
    axes.set(ylim=(0, None), ylabel="force [MN]" if forces else "approach [m/s]")


def _energies(axes: Axes, dataset: xr.Dataset) -> None:
    histories = [energy_of(dataset, where).values for where in ENERGIES]
    many = histories[0].max() >= MANY
    for values, label, (color, dash) in zip(histories, LABELS, CURVES, strict=False):
        if label == CONTACTS and "contact" not in dataset.dims:
            continue
        scaled = (MEGA if many else KILO) * values
        axes.plot(dataset.time, scaled, color=color, linestyle=dash, lw=1.2, label=label)
    axes.set(ylim=(0, None), ylabel="energy [MJ]" if many else "energy [kJ]")


def caption_of(dataset: xr.Dataset) -> str:
    """The buildings, the contact, the gaps and the source of the motions, in lines."""
    texts = [
        f"{name}: {dataset.attrs[f'structure_{number}']}"
        for number, name in enumerate(dataset.building.values, start=1)
    ]
    if "contact" in dataset.dims:
        widths = (CENTIMETRES * float(gap) for gap in np.atleast_1d(dataset.attrs["gaps"]))
        gaps = ", ".join(f"{width:.3g}" for width in widths)
        texts.append(f"{roles_in_words(dataset.attrs, 'contact')[0]}; gap {gaps} cm")
    texts += roles_in_words(dataset.attrs, "ground", "envelope")  # of simulated motions
    return filled(texts, CAPTION, "    ")
