"""Pictures of contact elements: Figs. 6, 7 and 8."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.views.charts.charts import PICTURES
from stochlin.views.charts.panels import in_a_row, is_narrow, legend, panels
from stochlin.views.shared.style import CURVES, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LINEAR = ("LinearSpring", "Kelvin", "NoTensionKelvin", "ImpactKelvin")
# Colour and dash of each element in all three figures.
LOOKS = {
    "Kelvin": CURVES[0],
    "ImpactKelvin": CURVES[1],
    "NoTensionKelvin": CURVES[2],
    "LinearSpring": CURVES[5],
    "Hertz": CURVES[5],
    "HertzDamp": CURVES[3],
    "Jankowski": CURVES[4],
}
OTHER_DASH = (0, (8, 1, 1, 1, 1, 1))  # for elements of extensions, in the same colours
LABELS = {
    "LinearSpring": "linear spring",
    "NoTensionKelvin": "Kelvin, no tension",
    "ImpactKelvin": "Impact Kelvin",
    "HertzDamp": "Hertz-damp",
}
SKETCHES = (
    ("(a) Kelvin element", r"$f = k\,d + c\,v$", ""),
    ("(b) Impact Kelvin element", r"$f = k\,d + c\,\max(v, 0)$", "in approach only"),
)
SYMBOLS = "while $d > 0$;\n$d = u_1 - u_2 - g$, and $v$ is its rate"
INK: Any = {"color": "0.1", "lw": 1.1, "solid_capstyle": "butt", "clip_on": False}


@PICTURES.register("contact_loops")
def draw_loops(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 6: sketches of two elements, and the force of all elements over the deformation."""
    across = 1 if is_narrow(figure) else 2
    every = list(panels(figure, 4 // across, across, 2.3).ravel())
    for axes, (title, law, note) in zip(every, SKETCHES, strict=False):
        _sketch(axes, title, law, note)
    looks = _looks(dataset)
    linear = {name: looks[name] for name in LINEAR if name in looks}
    others = {name: look for name, look in looks.items() if name not in LINEAR}
    headings = (
        (every[2], linear, "(c) elements with a linear spring"),
        (every[3], others, "(d) Hertz and other elements"),
    )
    every[3].sharey(every[2])
    for axes, shown, heading in headings:
        _curves(axes, dataset, shown, "scaled_deformation", "scaled_force")
        axes.axhline(0, color="0.4", lw=0.6)
        axes.set(xlim=(0, None), xlabel=quantity(dataset.scaled_deformation))
        axes.set_title(heading, loc="left")
        axes.legend(loc="upper left", bbox_to_anchor=(-0.02, -0.22), ncols=2, columnspacing=1)
    for axes in every[2::across]:
        axes.set_ylabel(quantity(dataset.scaled_force))


@PICTURES.register("contact_histories")
def draw_histories(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 7: deformation and force over time, from the beginning to the end of each contact."""
    upper, lower = panels(figure, 2, 1, 2.0, sharex=True).ravel()
    looks = _looks(dataset)
    for axes, variable in ((upper, "scaled_deformation"), (lower, "scaled_force")):
        _curves(axes, dataset, looks, "scaled_time", variable)
        for name, (color, _) in looks.items():
            end = dataset.sel(element=name).isel(point=-1)
            axes.plot(end.scaled_time, end[variable], color=color, marker="o", ms=3.5, ls="")
        axes.axhline(0, color="0.4", lw=0.6)
        axes.set_ylabel(quantity(dataset[variable]))
    lower.plot([], [], color="0.3", marker="o", ms=3.5, ls="", label="end of the contact")
    upper.set_xlim(0, 1.02 * float(dataset.scaled_time.max()))
    lower.set_xlabel(quantity(dataset.scaled_time))
    legend(figure, [lower], columns=3)


@PICTURES.register("restitution")
def draw_restitution(figure: Figure, dataset: xr.Dataset) -> None:
    """Fig. 8: coefficient of restitution over the damping ratio, or the damping factor of Hertz-damp."""
    [axes] = in_a_row(figure, 1, 3.4)
    above = axes.twiny()
    for name, (color, dash) in _looks(dataset).items():
        row = dataset.restitution.sel(element=name)
        axes.plot(dataset.damping_ratio, row, color=color, linestyle=dash, label=LABELS.get(name, name))
    color, dash = LOOKS["HertzDamp"]
    factor = dataset.damping_factor.values
    above.plot(factor, dataset.restitution_hertz_damp, color=color, linestyle=dash)
    axes.plot([], [], color=color, linestyle=dash, label="Hertz-damp, upper axis")
    above.grid(visible=False)
    above.set(xlim=(factor[0], factor[-1]), xlabel=quantity(dataset.damping_factor))
    axes.set(xlim=(float(dataset.damping_ratio[0]), float(dataset.damping_ratio[-1])), ylim=(0, 1))
    axes.set(xlabel=quantity(dataset.damping_ratio), ylabel=quantity(dataset.restitution))
    legend(figure, [axes])


def _looks(dataset: xr.Dataset) -> dict[str, tuple[str, Any]]:
    """Colour and dash of all elements of a dataset, those of the library first."""
    names = dataset.element.values.tolist()
    looks = {name: look for name, look in LOOKS.items() if name in names}
    others = [name for name in names if name not in LOOKS]
    colors = cycle(color for color, _ in CURVES)
    return looks | {name: (color, OTHER_DASH) for name, color in zip(others, colors, strict=False)}


def _curves(axes: Axes, dataset: xr.Dataset, looks: dict[str, tuple[str, Any]], x: str, y: str) -> None:
    for name, (color, dash) in looks.items():
        law = dataset.sel(element=name)
        axes.plot(law[x], law[y], color=color, linestyle=dash, label=LABELS.get(name, name))


def _sketch(axes: Axes, title: str, law: str, note: str) -> None:
    """Sketch of two masses with a gap, a spring and a dashpot between them."""
    from matplotlib.patches import Rectangle

    axes.set_axis_off()
    axes.set(xlim=(-0.03, 4.63), ylim=(-0.85, 1.2))
    for x, name in ((0.0, "$m_1$"), (3.75, "$m_2$")):
        axes.add_patch(Rectangle((x, 0), 0.85, 1.1, facecolor="0.88", edgecolor="0.1", lw=1.1))
        axes.text(x + 0.425, 0.55, name, ha="center", va="center")
    axes.plot([1.5, 1.5], [0.1, 1.0], **INK)  # contact plate
    axes.annotate("", (0.85, 0.55), (1.5, 0.55), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    axes.text(1.175, 0.62, "$g$", ha="center")
    _spring(axes, 1.5, 3.75, 0.82)
    _dashpot(axes, 1.5, 3.75, 0.28)
    axes.text(2.62, 1.02, "$k$", ha="center")
    axes.text(2.62, -0.16, f"$c$ {note}".strip(), ha="center", size=7.5)
    axes.set_title(title, loc="left")
    axes.text(0, -0.62, f"{law} {SYMBOLS}", size=7.5)


def _spring(axes: Axes, left: float, right: float, y: float) -> None:
    turns = np.linspace(left + 0.55, right - 0.55, 12)
    heights = y + 0.11 * np.array([0, *[1, -1] * 5, 0])
    axes.plot([left, *turns, right], [y, *heights, y], **INK)


def _dashpot(axes: Axes, left: float, right: float, y: float) -> None:
    middle = 0.5 * (left + right)
    axes.plot([left, middle], [y, y], **INK)
    axes.plot([middle, middle], [y - 0.1, y + 0.1], **INK)
    cup = np.array([-0.3, 0.3, 0.3, -0.3])
    axes.plot(middle + cup, y + 0.15 * np.array([1, 1, -1, -1]), **INK)
    axes.plot([middle + 0.3, right], [y, y], **INK)
