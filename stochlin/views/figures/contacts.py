"""Figs. 6 to 8: loops, histories and restitution of contact elements.

Two free bodies with the reduced mass ``m`` collide with the velocity ``v0``. With the scales ``tau
= (m v0^(1-n)/k)^(1/(n+1))`` of time, ``v0 tau`` of deformation and ``k (v0 tau)^n`` of force, the
motion does not depend on stiffness, mass and velocity; for linear elements ``tau = sqrt(m/k)``. The
motion is integrated by a Runge-Kutta method of order 8.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from stochlin.applications.figures.contacts import LOOP_RESTITUTION
from stochlin.views.figures.pictures import PICTURES, in_a_row, is_narrow, panels
from stochlin.views.shared.style import CURVES, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

ELEMENTS_OF_PAPER = {"Kelvin": "Kelvin", "ImpactKelvin": "Impact Kelvin"}
SKETCHES = (
    ("(a) Kelvin element", r"$f = k\,d + c\,v$", ""),
    ("(b) Impact Kelvin element", r"$f = k\,d + c\,\max(v, 0)$", "in approach only"),
)
MEANING_OF_SYMBOLS = "while $d > 0$;\n$d = u_1 - u_2 - g$, and $v$ is its rate"
INK: Any = {"color": "0.1", "lw": 1.1, "solid_capstyle": "butt", "clip_on": False}


@PICTURES.register("contact_loops")
def draw_loops(figure: Figure, dataset: xr.Dataset) -> None:
    """Sketches of the two elements of the paper, and their forces over the deformation."""
    rows = ["a", "b", "c"] if is_narrow(figure) else ["ab", "cc"]
    figure.set_figheight(2.3 * len(rows) + 0.4)
    first, second, loops = figure.subplot_mosaic("\n".join(rows)).values()
    for axes, sketch in zip((first, second), SKETCHES, strict=True):
        _sketch(axes, *sketch)
    _curves(loops, dataset, "scaled_deformation", "scaled_force")


@PICTURES.register("contact_histories")
def draw_histories(figure: Figure, dataset: xr.Dataset) -> None:
    """Deformation and force over time, from the beginning to the end of each contact."""
    for axes, variable in zip(panels(figure, 2, 1, 2.0), ("deformation", "force"), strict=True):
        end: Any = {"marker": "o", "ms": 3.5, "markevery": [-1]}
        _curves(axes, dataset, "scaled_time", f"scaled_{variable}", **end)
        axes.label_outer()
    axes.plot([], [], color="0.3", marker="o", ms=3.5, ls="", label="end of the contact")


@PICTURES.register("restitution")
def draw_restitution(figure: Figure, dataset: xr.Dataset) -> None:
    """Coefficient of restitution over the damping ratio."""
    [axes] = in_a_row(figure, 1, 3.4)
    _curves(axes, dataset, "damping_ratio", "restitution")
    of_loops: Any = {"color": "0.4", "lw": 0.8, "linestyle": ":"}
    axes.axhline(LOOP_RESTITUTION, label=f"e = {LOOP_RESTITUTION:g}, as in Fig. 6", **of_loops)
    axes.set(xlim=(0, 1), ylim=(0, 1))


def _curves(axes: Axes, dataset: xr.Dataset, x: str, y: str, **style: Any) -> None:
    """A curve for each element of the paper; the data have the others, too."""
    for (name, label), (color, dash) in zip(ELEMENTS_OF_PAPER.items(), CURVES, strict=False):
        element = dataset.sel(element=name)
        axes.plot(element[x], element[y], color=color, linestyle=dash, label=label, **style)
    axes.axhline(0, color="0.4", lw=0.6)
    axes.set(xlim=(0, None), xlabel=quantity(dataset[x]), ylabel=quantity(dataset[y]))


def _sketch(axes: Axes, title: str, law: str, note: str) -> None:
    """Sketch of two masses with a gap, a spring and a dashpot between them."""
    from matplotlib.patches import Rectangle

    axes.set_axis_off()
    axes.set(xlim=(-0.03, 4.63), ylim=(-0.85, 1.2))
    for x, name in ((0.0, "$m_1$"), (3.75, "$m_2$")):
        axes.add_patch(Rectangle((x, 0), 0.85, 1.1, facecolor="0.88", edgecolor="0.1", lw=1.1))
        axes.text(x + 0.425, 0.55, name, ha="center", va="center")
    turns = np.linspace(2.05, 3.2, 12)
    zigzag = 0.82 + 0.11 * np.array([0, *[1, -1] * 5, 0])
    for across, up in (
        ([1.5, 1.5], [0.1, 1.0]),  # contact plate
        ([1.5, *turns, 3.75], [0.82, *zigzag, 0.82]),  # spring
        ([1.5, 2.625, 2.625, 2.625], [0.28, 0.28, 0.18, 0.38]),  # piston
        ([2.325, 2.925, 2.925, 2.325], [0.43, 0.43, 0.13, 0.13]),  # cylinder
        ([2.925, 3.75], [0.28, 0.28]),
    ):
        axes.plot(across, up, **INK)
    axes.annotate("", (0.85, 0.55), (1.5, 0.55), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    for x, y, text in ((1.175, 0.62, "$g$"), (2.62, 1.02, "$k$"), (2.62, -0.16, f"$c$ {note}")):
        axes.text(x, y, text.strip(), ha="center")
    axes.set_title(title, loc="left")
    axes.text(0, -0.62, f"{law} {MEANING_OF_SYMBOLS}", size=7.5)
