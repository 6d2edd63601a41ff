"""Figs. 6 to 8: loops, histories and restitution of contact elements.

Two free bodies with the reduced mass ``m`` collide with the velocity ``v0``. With the scales
``tau = (m v0^(1-n)/k)^(1/(n+1))`` of time, ``v0 tau`` of deformation and ``k (v0 tau)^n`` of force, the
motion does not depend on stiffness, mass and velocity; for linear elements ``tau = sqrt(m/k)``. The
motion is integrated by a Runge-Kutta method of order 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation import contacts as kernel
from stochlin.models.arguments import checked
from stochlin.models.contacts.elements import CONTACTS, Damped, Element, WithRatio
from stochlin.solver.tables import labels
from stochlin.views.figures.charts import USUAL, ChartSettings, register_chart
from stochlin.views.figures.pictures import PICTURES, in_a_row, is_narrow, panels
from stochlin.views.shared.style import CURVES, quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

LOOP_RESTITUTION = 0.65  # of Fig. 6
HISTORY_DAMPING = 0.5  # of Fig. 7, that of the paper
METHOD: Any = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
SCALES = "Two free masses of reduced mass m meet at velocity v0; linear springs: n = 1, τ = √(m/k)."
DIFFERENCES = (
    "The available text of the paper has the dashpot's sign reversed in eqs. (14) and (16), and no "
    "stiffness under the root of eq. (15): here c opposes the motion, c = 2 ξ √(k m)."
)
LONGEST = 1e3  # longest contact time, times e and over tau; contacts with a small e last about 1/e
VARIABLES = {
    "restitution": ("1", "coefficient of restitution"),
    "contact_damping": ("1", "damping parameter of the contact element"),
    "scaled_contact_time": ("1", "contact time over τ"),
    "scaled_time": ("1", "time t/τ"),
    "scaled_deformation": ("1", "deformation d/(v0 τ)"),
    "scaled_velocity": ("1", "rate of deformation over the approach velocity v0"),
    "scaled_force": ("1", "contact force f/(k (v0 τ)^n)"),
}
ELEMENT = "element", "contact element"
OF_PAPER = {"Kelvin": "Kelvin", "ImpactKelvin": "Impact Kelvin"}
SKETCHES = (
    ("(a) Kelvin element", r"$f = k\,d + c\,v$", ""),
    ("(b) Impact Kelvin element", r"$f = k\,d + c\,\max(v, 0)$", "in approach only"),
)
SYMBOLS = "while $d > 0$;\n$d = u_1 - u_2 - g$, and $v$ is its rate"
INK: Any = {"color": "0.1", "lw": 1.1, "solid_capstyle": "butt", "clip_on": False}


@register_chart("fig6", place=60)
@checked
def contact_loop_chart(settings: ChartSettings = USUAL) -> xr.Dataset:
    """Fig. 6: force over deformation of all contact elements, damped ones with ``e = 0.65``.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts, of which ``points`` is used: about two points for each, at equal
        intervals of time during the contact.

    Returns
    -------
    xarray.Dataset
        Over (``element``, ``point``): ``scaled_deformation``, ``scaled_force``, ``scaled_velocity`` and
        ``scaled_time`` [-]. Over ``element``: ``restitution``, ``contact_damping`` and
        ``scaled_contact_time`` [-]. The area of a loop is the energy loss ``(1 - e^2)/2``.

    Examples
    --------
    >>> from stochlin.charts import contact_loop_chart
    >>> chart = contact_loop_chart()
    >>> round(float(chart.scaled_force.sel(element="ImpactKelvin").max()), 3)
    0.821
    """
    parameters: dict[str, Any] = {"stiffness": 1.0, "restitution": LOOP_RESTITUTION}
    kinds = [kind for kind in CONTACTS.values() if issubclass(kind, Element)]
    models = [kind(**parameters) if issubclass(kind, Damped) else kind(1.0) for kind in kinds]
    title = f"Force and deformation of contact elements, e = {LOOP_RESTITUTION:g}"
    return _histories("contact_loops", models, settings, title, "contact_loop_chart()")


@register_chart("fig7", place=60)
@checked
def contact_history_chart(settings: ChartSettings = USUAL) -> xr.Dataset:
    """Fig. 7: histories of deformation and force of the elements with a damping ratio, 0.5.

    Parameters
    ----------
    settings : ChartSettings, optional
        As for `contact_loop_chart`.

    Returns
    -------
    xarray.Dataset
        As for `contact_loop_chart`.

    Examples
    --------
    >>> from stochlin.charts import contact_history_chart
    >>> chart = contact_history_chart()
    >>> [round(float(t), 3) for t in chart.scaled_contact_time.sel(element=["Kelvin", "ImpactKelvin"])]
    [3.628, 2.78]
    """
    models = [kind(1.0, damping_ratio=HISTORY_DAMPING) for kind in _with_ratio()]
    title = f"Histories of deformation and contact force, ξ = {HISTORY_DAMPING:g}"
    return _histories("contact_histories", models, settings, title, "contact_history_chart()")


@register_chart("fig8", place=60)
@checked
def restitution_chart(settings: ChartSettings = USUAL) -> xr.Dataset:
    """Fig. 8: coefficient of restitution over the damping ratio, 0 to 1, of the elements with one.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts, of which ``points`` is used.

    Returns
    -------
    xarray.Dataset
        ``restitution`` [-] over (``element``, ``damping_ratio``). The picture shows the elements of the
        paper, Kelvin and Impact Kelvin.

    Examples
    --------
    >>> from stochlin.charts import restitution_chart
    >>> chart = restitution_chart()
    >>> [round(float(e), 4) for e in chart.restitution.sel(damping_ratio=0.5)]
    [0.163, 0.2984, 0.5463, 0.5749]
    """
    along = np.linspace(0, 1, settings.fine_points)
    ratio = labels.axis("damping_ratio", "damping ratio ξ of the contact", along)
    kinds = _with_ratio()
    axis = labels.axis(*ELEMENT, [kind.__name__ for kind in kinds], units=None)
    chart = xr.Dataset({"restitution": xr.concat([kind.restitution(ratio) for kind in kinds], axis)})
    chart.attrs |= {
        "chart": "restitution",
        "caption": "Two free masses; ξ = c/(2 √(k m)).",
        "comment": "Eq. (15) of the paper is the curve of Kelvin alone.",
    }
    title = "Coefficient of restitution of contact elements"
    return labels.with_run_information(labels.label(chart, VARIABLES), title, "restitution_chart()", {})


def _with_ratio() -> list[type[WithRatio]]:
    """All registered contact elements with a damping ratio."""
    return [kind for kind in CONTACTS.values() if issubclass(kind, WithRatio)]


def _histories(
    picture: str, models: Sequence[Element], settings: ChartSettings, title: str, call: str
) -> xr.Dataset:
    """Contacts of these elements from their beginning to their end."""
    names = [type(model).__name__ for model in models]
    motions = [_motion(model, settings.fine_points) for model in models]
    chart = xr.concat(motions, labels.axis(*ELEMENT, names, units=None))
    chart.attrs |= {"chart": picture, "caption": SCALES, "comment": DIFFERENCES}
    described = dict(zip(names, models, strict=True))
    return labels.with_run_information(labels.label(chart, VARIABLES), title, call, described)


def _motion(model: Element, points: int) -> xr.Dataset:
    """The contact up to the instant at which the bodies separate."""
    law = model.force_law(1.0)

    def rates(_: float, state: Array) -> tuple[float, float]:
        return state[1], -kernel.force(law, state[0], state[1], 1.0)

    def margin(_: float, state: Array) -> float:
        return float(kernel.separation_margin(law, state[0], state[1]))

    margin.terminal = True  # type: ignore[attr-defined]
    margin.direction = -1  # type: ignore[attr-defined]
    span = (0.0, LONGEST / float(model.e))
    solved = solve_ivp(rates, span, (0.0, 1.0), events=margin, dense_output=True, **METHOD)
    end = solved.t_events[0][0]
    time = np.linspace(0, end, points)
    deformation, velocity = solved.sol(time)
    # At both ends the force is that of the dashpot, although the deformation is 0.
    inside = np.maximum(deformation, np.finfo(float).tiny)
    force = [kernel.force(law, d, v, 1.0) for d, v in zip(inside, velocity, strict=True)]
    over_time = {"time": time, "deformation": deformation, "velocity": velocity, "force": force}
    motion = xr.Dataset({f"scaled_{name}": ("point", values) for name, values in over_time.items()})
    numbers = {"restitution": model.e, "contact_damping": getattr(model, "damping", 0.0)}
    return motion.assign(scaled_contact_time=end, **numbers)


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
    for (name, label), (color, dash) in zip(OF_PAPER.items(), CURVES, strict=False):
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
    axes.text(0, -0.62, f"{law} {SYMBOLS}", size=7.5)
