"""Figs. 6 to 8: force, histories and restitution of contact elements."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp

from stochlin.applications.figures.charts import USUAL_SETTINGS, ChartSettings, register_chart
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation import contacts as kernel
from stochlin.models.arguments import checked
from stochlin.models.contacts.elements import CONTACTS, Damped, Element, WithRatio
from stochlin.solver.tables import labels

if TYPE_CHECKING:
    pass

METHOD: Any = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15}
LOOP_RESTITUTION = 0.65  # of Fig. 6
HISTORY_DAMPING = 0.5  # of Fig. 7, that of the paper
SCALES = "Two free masses of reduced mass m meet at velocity v0; linear springs: n = 1, τ = √(m/k)."
DIFFERENCES = (
    "The available text of the paper has the dashpot's sign reversed in eqs. (14) and (16), and no "
    "stiffness under the root of eq. (15): here c opposes the motion, c = 2 ξ √(k m)."
)
# longest contact time, times e and over tau; contacts with a small e last about 1/e
LONGEST_CONTACT = 1e3
CONTACT_VARIABLES = {
    "restitution": ("1", "coefficient of restitution"),
    "contact_damping": ("1", "damping parameter of the contact element"),
    "scaled_contact_time": ("1", "contact time over τ"),
    "scaled_time": ("1", "time t/τ"),
    "scaled_deformation": ("1", "deformation d/(v0 τ)"),
    "scaled_velocity": ("1", "rate of deformation over the approach velocity v0"),
    "scaled_force": ("1", "contact force f/(k (v0 τ)^n)"),
}
CONTACT_ELEMENT = "element", "contact element"


@register_chart("fig6", place=60)
@checked
def contact_loop_chart(settings: ChartSettings = USUAL_SETTINGS) -> xr.Dataset:
    """Fig. 6: force over deformation of all contact elements, damped ones with ``e = 0.65``.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts, of which ``points`` is used: about two points for each, at equal
        intervals of time during the contact.

    Returns
    -------
    xarray.Dataset
        Over (``element``, ``point``): ``scaled_deformation``, ``scaled_force``, ``scaled_velocity``
        and ``scaled_time`` [-]. Over ``element``: ``restitution``, ``contact_damping`` and
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
def contact_history_chart(settings: ChartSettings = USUAL_SETTINGS) -> xr.Dataset:
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
    >>> times = chart.scaled_contact_time.sel(element=["Kelvin", "ImpactKelvin"])
    >>> [round(float(t), 3) for t in times]
    [3.628, 2.78]
    """
    models = [kind(1.0, damping_ratio=HISTORY_DAMPING) for kind in _with_ratio()]
    title = f"Histories of deformation and contact force, ξ = {HISTORY_DAMPING:g}"
    return _histories("contact_histories", models, settings, title, "contact_history_chart()")


@register_chart("fig8", place=60)
@checked
def restitution_chart(settings: ChartSettings = USUAL_SETTINGS) -> xr.Dataset:
    """Fig. 8: coefficient of restitution over the damping ratio, 0 to 1, of the elements with one.

    Parameters
    ----------
    settings : ChartSettings, optional
        Parameters of the charts, of which ``points`` is used.

    Returns
    -------
    xarray.Dataset
        ``restitution`` [-] over (``element``, ``damping_ratio``). The picture shows the elements of
        the paper, Kelvin and Impact Kelvin.

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
    axis = labels.axis(*CONTACT_ELEMENT, [kind.__name__ for kind in kinds], units=None)
    chart = xr.Dataset(
        {"restitution": xr.concat([kind.restitution(ratio) for kind in kinds], axis)}
    )
    chart.attrs |= {
        "chart": "restitution",
        "caption": "Two free masses; ξ = c/(2 √(k m)).",
        "comment": "Eq. (15) of the paper is the curve of Kelvin alone.",
    }
    title = "Coefficient of restitution of contact elements"
    return labels.with_run_information(
        labels.label(chart, CONTACT_VARIABLES), title, "restitution_chart()", {}
    )


def _with_ratio() -> list[type[WithRatio]]:
    """All registered contact elements with a damping ratio."""
    return [kind for kind in CONTACTS.values() if issubclass(kind, WithRatio)]


def _histories(
    picture: str, models: Sequence[Element], settings: ChartSettings, title: str, call: str
) -> xr.Dataset:
    """Contacts of these elements from their beginning to their end."""
    names = [type(model).__name__ for model in models]
    motions = [_motion(model, settings.fine_points) for model in models]
    chart = xr.concat(motions, labels.axis(*CONTACT_ELEMENT, names, units=None))
    chart.attrs |= {"chart": picture, "caption": SCALES, "comment": DIFFERENCES}
    described = dict(zip(names, models, strict=True))
    return labels.with_run_information(
        labels.label(chart, CONTACT_VARIABLES), title, call, described
    )


def _motion(model: Element, points: int) -> xr.Dataset:
    """The contact up to the instant at which the bodies separate."""
    law = model.force_law(1.0)

    def rates(_: float, state: Array) -> tuple[float, float]:
        return state[1], -kernel.force(law, state[0], state[1], 1.0)

    def margin(_: float, state: Array) -> float:
        return float(kernel.separation_margin(law, state[0], state[1]))

    margin.terminal = True  # type: ignore[attr-defined]
    margin.direction = -1  # type: ignore[attr-defined]
    span = (0.0, LONGEST_CONTACT / float(model.e))
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
