"""Data of Figs. 6 to 8 of the paper: loops, histories and restitution of contact elements.

Two free bodies with the reduced mass ``m`` collide with the velocity ``v0``. With the scales
``tau = (m v0^(1-n)/k)^(1/(n+1))`` of time, ``v0 tau`` of deformation and ``k (v0 tau)^n`` of force, the
motion does not depend on stiffness, mass and velocity; for linear elements ``tau = sqrt(m/k)``. Linear
elements are solved in closed form, the others by a Runge-Kutta method of order 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple, TypeVar

import numpy as np
import xarray as xr
from scipy.integrate import solve_ivp

from stochlin.analyses.charts.charts import CHARTS
from stochlin.analyses.charts.settings import ChartSettings
from stochlin.analyses.charts.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation import contacts as kernel
from stochlin.messages import hyphenated
from stochlin.models.arguments import Number, Points, checked
from stochlin.models.contacts import Element, HertzDamp, LinearSpring
from stochlin.models.contacts.base import CONTACTS, RESTITUTION
from stochlin.models.contacts.damped import Damped, WithRatio
from stochlin.models.contacts.linear import LinearDamped
from stochlin.models.parameters import POSITIVE, Range

PARTING = Range(
    upper=1.0, include_lower=True, reason="from 1 on the contact of the Kelvin element never ends"
)
TOLERANCE = {"rtol": 1e-12, "atol": 1e-14}
SCALES = (
    "Two free masses of reduced mass m meet at velocity v0. Scales: τ = (m v0^(1-n)/k)^(1/(n+1)), v0 τ, "
    "k (v0 τ)^n;\n"
)
DIFFERENCES = (
    "The available text of the paper has the dashpot's sign reversed in eqs. (14) and (16), and no "
    "stiffness under the root of eq. (15): here c opposes the motion, c = 2 ξ √(k m)."
)
OWN = (
    "Eq. (15) of the paper is the curve of Kelvin alone. Hertz-damp has no damping ratio: the upper "
    "axis is its damping factor a."
)
LONGEST = 1e3  # longest contact time, times e and over tau; contacts with a small e last about 1/e


Kind = TypeVar("Kind", bound=Element)


class History(NamedTuple):
    """A contact from its beginning to its end, in dimensionless quantities."""

    time: Array
    deformation: Array
    velocity: Array


@checked
def contact_loop_chart(
    restitution: Annotated[float, Number(RESTITUTION)] = 0.65, points: Points = 201
) -> xr.Dataset:
    """Fig. 6: force over deformation of all contact elements, damped ones with equal restitution.

    Parameters
    ----------
    restitution : float
        Coefficient of restitution ``e`` [-] of the damped elements, in (0, 1].
    points : int
        Number of points of each loop, at least 2, at equal intervals of time during the contact.

    Returns
    -------
    xarray.Dataset
        Over (``element``, ``point``): ``scaled_deformation``, ``scaled_force``, ``scaled_velocity`` and
        ``scaled_time`` [-]. Over ``element``: ``restitution``, ``contact_damping`` and
        ``scaled_contact_time`` [-]. The area of a loop is the energy loss ``(1 - e^2)/2``.

    Raises
    ------
    ValueError, TypeError
        If the restitution is out of range or not a number, or there are less than two points.

    Examples
    --------
    >>> from stochlin.charts import contact_loop_chart
    >>> chart = contact_loop_chart(restitution=0.5)
    >>> round(float(chart.scaled_force.sel(element="ImpactKelvin").max()), 3)
    1.195
    """
    parameters: dict[str, Any] = {"stiffness": 1.0, "restitution": restitution}
    models = [kind(**parameters) if issubclass(kind, Damped) else kind(1.0) for kind in _kinds(Element)]
    title = f"Force and deformation of contact elements, e = {restitution:g}"
    call = f"contact_loop_chart(restitution={restitution:g})"
    return _histories("contact_loops", models, points, title, call)


@checked
def contact_history_chart(
    damping_ratio: Annotated[float, Number(PARTING)] = 0.5, points: Points = 201
) -> xr.Dataset:
    """Fig. 7: histories of deformation and force of the elements with a damping ratio.

    Parameters
    ----------
    damping_ratio : float
        Damping ratio ``xi`` [-], in [0, 1); from 1 on the contact of the Kelvin element never ends. That
        of the paper is 0.5.
    points : int
        Number of points of each history, at least 2.

    Returns
    -------
    xarray.Dataset
        As for `contact_loop_chart`.

    Raises
    ------
    ValueError, TypeError
        As in `contact_loop_chart`.

    Examples
    --------
    >>> from stochlin.charts import contact_history_chart
    >>> chart = contact_history_chart()
    >>> [round(float(t), 3) for t in chart.scaled_contact_time.sel(element=["Kelvin", "ImpactKelvin"])]
    [3.628, 2.78]
    """
    parameters: dict[str, Any] = {"stiffness": 1.0, "damping_ratio": damping_ratio}
    models = [kind(**parameters) for kind in _kinds(WithRatio)]
    title = f"Histories of deformation and contact force, ξ = {damping_ratio:g}"
    call = f"contact_history_chart(damping_ratio={damping_ratio:g})"
    return _histories("contact_histories", models, points, title, call)


@checked
def restitution_chart(
    largest: Annotated[float, Number(POSITIVE)] = 1.0, points: Points = 201
) -> xr.Dataset:
    """Fig. 8: coefficient of restitution over the damping of all damped elements.

    Parameters
    ----------
    largest : float
        Largest damping ratio [-] of the axis, positive.
    points : int
        Number of points along the axis, at least 2.

    Returns
    -------
    xarray.Dataset
        ``restitution`` [-] over (``element``, ``damping_ratio``), and ``restitution_hertz_damp`` [-]
        over ``damping_factor``, the factor ``a`` of the Hertz-damp contact. It is not a damping ratio,
        and goes up to twice ``largest``.

    Raises
    ------
    ValueError, TypeError
        If ``largest`` is out of range or not a number, or there are less than two points.

    Examples
    --------
    >>> from stochlin.charts import restitution_chart
    >>> chart = restitution_chart()
    >>> [round(float(e), 4) for e in chart.restitution.sel(damping_ratio=0.5)]
    [0.163, 0.2984, 0.5463, 0.5749]
    """
    classes = _kinds(WithRatio)
    along = np.linspace(0, largest, points)
    ratio = labels.axis("damping_ratio", "damping ratio of the contact", along)
    factor = labels.axis("damping_factor", "damping factor of the Hertz-damp contact", 2 * along)
    rows = [kind.restitution(ratio) for kind in classes]
    chart = xr.Dataset(
        {
            "restitution": xr.concat(rows, _elements([kind.__name__ for kind in classes])),
            "restitution_hertz_damp": HertzDamp.restitution(factor),
        }
    )
    caption = "Two free masses; ξ = c/(2 √(k m)), of Jankowski c/(2 √(k √d m))."
    chart.attrs |= {"chart": "restitution", "caption": caption, "comment": OWN}
    return labels.with_run_information(
        labels.label(chart, VARIABLES),
        "Coefficient of restitution of contact elements",
        f"restitution_chart(largest={largest:g})",
        {},
    )


def _kinds(base: type[Kind]) -> list[type[Kind]]:
    """All registered contact elements of a kind."""
    return [kind for kind in CONTACTS.values() if issubclass(kind, base)]


@CHARTS.register("fig6", place=60)
def _fig6(settings: ChartSettings) -> xr.Dataset:
    return contact_loop_chart(points=settings.fine_points)


@CHARTS.register("fig7", place=60)
def _fig7(settings: ChartSettings) -> xr.Dataset:
    return contact_history_chart(points=settings.fine_points)


@CHARTS.register("fig8", place=60)
def _fig8(settings: ChartSettings) -> xr.Dataset:
    return restitution_chart(points=settings.fine_points)


def _histories(
    picture: str, models: Sequence[Element], points: int, title: str, call: str
) -> xr.Dataset:
    names = [type(model).__name__ for model in models]
    chart = xr.Dataset(coords={"element": _elements(names)})
    histories = [
        _linear(m, points) if isinstance(m, LinearSpring | LinearDamped) else _integrated(m, points)
        for m in models
    ]
    over = ("element", "point")
    chart["scaled_time"] = (over, np.stack([history.time for history in histories]))
    chart["scaled_deformation"] = (over, np.stack([history.deformation for history in histories]))
    chart["scaled_velocity"] = (over, np.stack([history.velocity for history in histories]))
    forces = [_force(model, history) for model, history in zip(models, histories, strict=True)]
    chart["scaled_force"] = (over, np.stack(forces))
    chart["scaled_contact_time"] = ("element", [history.time[-1] for history in histories])
    chart["restitution"] = ("element", [model.e for model in models])
    chart["contact_damping"] = ("element", [getattr(model, "damping", 0.0) for model in models])
    described = dict(zip(names, models, strict=True))
    chart.attrs |= {"chart": picture, "caption": SCALES + _exponents(models), "comment": DIFFERENCES}
    return labels.with_run_information(labels.label(chart, VARIABLES), title, call, described)


def _exponents(models: Sequence[Element]) -> str:
    """Text with the exponent ``n`` of the springs."""
    curved: dict[float, list[str]] = {}
    for model in models:
        if (exponent := model.force_law(1.0).exponent) != 1:
            curved.setdefault(exponent, []).append(hyphenated(type(model).__name__))
    exponents = [f"n = {exponent:g} for {', '.join(names)}" for exponent, names in curved.items()]
    return "; ".join([*exponents, "n = 1 for linear springs."])


def _force(model: Element, history: History) -> Array:
    """Contact force; at both ends it has the force of the dashpot, although the deformation is 0."""
    within = np.maximum(history.deformation, np.finfo(float).tiny)
    return kernel.forces(model.force_law(1.0), within, history.velocity, 1.0)


def _linear(model: LinearSpring | LinearDamped, points: int) -> History:
    """Contact in closed form; elements damped in approach only are undamped after the turning point."""
    if isinstance(model, LinearSpring):
        return History(*_free_motion(np.linspace(0, model.contact_time(), points), 0.0))
    time = np.linspace(0, model.contact_time(model.damping), points)
    coefficient = model.force_law(1.0).damping
    damped = History(*_free_motion(time, 0.5 * coefficient))
    if not model.law.approach_only:
        return damped
    back = time - (time[-1] - np.pi / 2)  # time since the turning point, where d = e v0/w
    turned = back > 0
    return History(
        time,
        np.where(turned, model.e * np.cos(back), damped.deformation),
        np.where(turned, -model.e * np.sin(back), damped.velocity),
    )


def _free_motion(time: Array, xi: float) -> tuple[Array, Array, Array]:
    """Solution of ``y'' + 2 xi y' + y = 0``, ``y = 0``, ``y' = 1`` at 0: time, ``y`` and ``y'``."""
    root = np.sqrt(complex(xi * xi - 1))
    swing = np.sinh(root * time) / root if root else time.astype(complex)
    decay = np.exp(-xi * time)
    return time, decay * swing.real, decay * (np.cosh(root * time) - xi * swing).real


def _integrated(model: Element, points: int) -> History:
    """Contact by numerical integration up to the instant at which the bodies separate."""
    law = model.force_law(1.0)

    def rates(_: float, state: Array) -> tuple[float, float]:
        return state[1], -kernel.force(law, state[0], state[1], 1.0)

    def margin(_: float, state: Array) -> float:
        return kernel.separation_margin(law, state[0], state[1])

    margin.terminal, margin.direction = True, -1  # type: ignore[attr-defined]
    span = (0.0, LONGEST / float(model.e))
    solved = solve_ivp(
        rates, span, (0.0, 1.0), method="DOP853", events=margin, dense_output=True, **TOLERANCE
    )
    time = np.linspace(0, solved.t_events[0][0], points)
    return History(time, *solved.sol(time))


def _elements(names: list[str]) -> xr.DataArray:
    attrs = {"long_name": "contact element"}
    return xr.DataArray(names, dims="element", coords={"element": names}, name="element", attrs=attrs)
