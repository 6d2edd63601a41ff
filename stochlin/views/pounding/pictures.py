"""Pictures of pounding: histories of a motion, and frequencies of peaks in many motions."""

from __future__ import annotations

import textwrap
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.applications.cases.pounding import (
    ENERGIES,
    closest_contacts,
    displacement_beside,
    energy_of,
)
from stochlin.applications.pounding.rows import SLAB_TO_COLUMN
from stochlin.messages import plain
from stochlin.models.descriptions import roles_in_words, three_digits
from stochlin.solver.tables.labels import CONVERGED
from stochlin.views.pounding.words import roof
from stochlin.views.shared.style import AS_GIVEN, CURVES, PAGE_WIDTH, filled, styled
from stochlin.views.shared.words import CENTIMETRES, along

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

WORDS = 0.5  # inches: around the panels
LINE_OF_MODELS = 0.135  # inches: of a line of text
# inches: heights of the panels
HISTORY_PANEL = 1.6
FREQUENCY_PANEL = 2.6
# characters of a line
WIDTH_OF_MODELS = 108
LABEL_WRAP = 22
LEGEND_NAME = 24
MEGA = 1e-6
KILO = 1e-3
MANY = 1e7  # J: from there on in MJ
CONTACT_LABEL = "contacts"
LABELS = ("from the ground", "damping", "yielding", CONTACT_LABEL, "motion, springs")  # of ENERGIES


@styled(AS_GIVEN)
def draw_pound(dataset: xr.Dataset) -> Figure:
    """Draw one dataset of ``stochlin pound``.

    Parameters
    ----------
    dataset : xarray.Dataset
        As `stochlin.pound_case` makes it, from memory or from file.

    Returns
    -------
    matplotlib.figure.Figure
        Of one record over time: for each gap the displacements of both sides, of buildings with
        storeys at the contact with the least clearance; forces of all impacts; energies. Impacts
        are marked. Of one building alone: its displacement, of the roof if it has storeys, and
        energies.

        Of many motions: the share of the motions with larger accelerations and displacements, with
        pounding and without, of buildings with storeys the largest acceleration of all floors and
        the displacement of the roof.

    Raises
    ------
    ValueError
        If the dataset is another one.
    """
    if "building" not in dataset.coords or "peak" not in dataset:
        what = f"dataset has the dimensions {tuple(dataset.dims)}"
        raise ValueError(f"{what}; allowed: one that 'stochlin pound' saves")
    return _histories(dataset) if "time" in dataset.dims else _frequencies(dataset)


def _histories(dataset: xr.Dataset) -> Figure:
    shown = closest_contacts(dataset) if "contact" in dataset.dims else []
    figure, panels = _panels(dataset, len(shown) + 2, 1, HISTORY_PANEL)
    for axes, number in zip(panels, shown, strict=False):
        _sides(axes, dataset, number)
    if shown:
        _forces(panels[-2], dataset)
    else:
        _alone(panels[0], dataset)
    _energies(panels[-1], dataset)
    for axes in panels:
        axes.set_xlim(float(dataset.time[0]), float(dataset.time[-1]))
        axes.tick_params(labelbottom=axes is panels[-1])
    for axes in (panel for panel in panels if panel.get_legend_handles_labels()[1]):
        axes.legend(loc="upper left", bbox_to_anchor=(1.02, 1.03), borderaxespad=0, fontsize=8)
    panels[-1].set_xlabel("time [s]")
    figure.suptitle(dataset.attrs["title"], x=0.01, ha="left", size=10)
    return figure


def _panels(
    dataset: xr.Dataset, rows: int, columns: int, height: float
) -> tuple[Figure, list[Axes]]:
    """A picture with panels of this height, and below them the models and the gaps in words."""
    from matplotlib.figure import Figure

    texts = [
        f"{name}: {three_digits(dataset.attrs[f'structure_{number}'])}"
        for number, name in enumerate(dataset.building.values, start=1)
    ]
    if "contact" in dataset.dims:
        widths = (CENTIMETRES * float(gap) for gap in np.atleast_1d(dataset.attrs["gaps"]))
        gaps = ", ".join(f"{width:.3g}" for width in widths)
        texts.append(f"{roles_in_words(dataset.attrs, 'contact')[0]}; gap {gaps} cm")
    texts += roles_in_words(dataset.attrs, "ground", "envelope")  # of simulated motions
    caption = filled(texts, WIDTH_OF_MODELS, "    ")
    total = rows * height + WORDS + LINE_OF_MODELS * len(caption.splitlines())
    figure = Figure(figsize=(PAGE_WIDTH, total), layout="constrained")
    figure.supxlabel(caption, x=0.01, ha="left", size=7.5)
    return figure, list(figure.subplots(rows, columns, squeeze=False).ravel())


def _sides(axes: Axes, dataset: xr.Dataset, number: int) -> None:
    """Both sides of a gap in one frame: the distance between the curves is open."""
    contact = dataset.isel(contact=number)

    def place(side: str) -> np.ndarray:
        return CENTIMETRES * displacement_beside(dataset, side).isel(contact=number).values

    left = place("left")
    right = place("right") + CENTIMETRES * float(contact.gap)
    time = dataset.time.values
    axes.fill_between(time, left, np.maximum(left, right), color="0.9", lw=0, label="open")
    names = [("wall", *dataset.building.values)[int(contact[side])] for side in ("left", "right")]
    for values, name, (color, dash) in zip((left, right), names, CURVES, strict=False):
        label = textwrap.fill(str(name), LABEL_WRAP)
        axes.plot(time, values, color=color, linestyle=dash, lw=0.9, label=label)
    hits = dataset.impact_time.values[dataset.impact_contact.values == number + 1]
    hits = hits[(hits >= time[0]) & (hits <= time[-1])]
    struck = "level" in dataset.coords and str(contact.kind.item()) == SLAB_TO_COLUMN
    if hits.size:
        marker, color = ("X", "#b2182b") if struck else ("v", "#2166ac")
        style: Any = {"marker": marker, "color": color, "ls": "", "ms": 5, "clip_on": False}
        transform = axes.get_xaxis_transform()
        axes.plot(hits, np.full(hits.size, 1.0), transform=transform, label="impact", **style)
    if "level" in dataset.coords:
        where = f"{float(contact.level):.4g} m up"
        if struck:
            where += ", SLAB AGAINST COLUMN"
        axes.text(0.01, 0.97, where, transform=axes.transAxes, va="top", size=8)
    axes.set_ylabel("place [cm]")


def _alone(axes: Axes, dataset: xr.Dataset) -> None:
    """The displacement of a single building, at its roof."""
    building = dataset.isel(structure=0)
    color, _ = CURVES[0]
    name = textwrap.fill(str(building.building.item()), LABEL_WRAP)
    place = CENTIMETRES * roof(building).displacement
    axes.plot(dataset.time, place, color=color, lw=0.9, label=name)
    axes.set_ylabel("roof [cm]" if "floor" in dataset.dims else "place [cm]")


def _forces(axes: Axes, dataset: xr.Dataset) -> None:
    """The largest force of every impact; of impacts without a force the velocity of approach."""
    name = "largest_force"
    scale = MEGA
    label = "force [MN]"
    if bool(dataset.largest_force.isnull().any()):
        name = "approach_velocity"
        scale = 1.0
        label = "approach [m/s]"
    axes.vlines(dataset.impact_time, 0, scale * dataset[name], color=CURVES[0][0], lw=1.2)
    if not dataset.sizes["impact"]:
        axes.text(0.5, 0.5, "no impact", transform=axes.transAxes, ha="center", va="center")
    axes.set(ylim=(0, None), ylabel=label)


def _energies(axes: Axes, dataset: xr.Dataset) -> None:
    """Energies of all buildings together over time."""
    histories = [energy_of(dataset, where).values for where in ENERGIES]
    scale, unit = (MEGA, "MJ") if histories[0].max() >= MANY else (KILO, "kJ")
    for values, label, (color, dash) in zip(histories, LABELS, CURVES, strict=False):
        if label != CONTACT_LABEL or "contact" in dataset.dims:
            axes.plot(
                dataset.time, scale * values, color=color, linestyle=dash, lw=1.2, label=label
            )
    axes.set(ylim=(0, None), ylabel=f"energy [{unit}]")


def _frequencies(dataset: xr.Dataset) -> Figure:
    meets = "neighbours" in dataset.dims
    figure, panels = _panels(dataset, 1, 2, FREQUENCY_PANEL)
    accelerations, displacements = panels
    dataset = dataset.isel({dataset.status.dims[0]: dataset.status.values == CONVERGED})
    for building, (color, dash) in zip(along(dataset, "structure"), cycle(CURVES), strict=False):
        name = plain(f"{int(building.structure)} {building.building.item()}", LEGEND_NAME)
        for end, style in (("", {"lw": 1.6, "label": name}), ("_alone", {"lw": 0.6}))[: 1 + meets]:
            look: Any = {"color": color, "linestyle": dash, "complementary": True} | style
            shaken = building[f"peak_acceleration{end}"].max({*building.peak.dims} & {"floor"})
            accelerations.ecdf(shaken.values / constants.g, **look)
            displacements.ecdf(CENTIMETRES * roof(building)[f"peak{end}"].values, **look)
    accelerations.set(xlim=(0, None), xlabel="acceleration [g]", ylim=(0, 1.02))
    displacements.set(xlim=(0, None), xlabel="displacement [cm]", ylim=(0, 1.02))
    accelerations.set_ylabel("share of motions with more")
    if meets:
        accelerations.plot([], [], color="0.35", lw=0.7, label="thin: alone")
    figure.legend(
        *accelerations.get_legend_handles_labels(), loc="outside upper left", ncols=3, fontsize=8,
        title=dataset.attrs["title"], title_fontsize=10, alignment="left",
    )  # fmt: skip
    return figure
