"""Estimate of the effect of an impact on two structures, from their energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.pounding.histories import contacts
from stochlin.applications.pounding.rows import SIDES, Meeting, meetings
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import impact_loss, velocities_after_impact
from stochlin.models.arguments import Points, checked
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.contacts import Contact
from stochlin.models.contacts.elements import checked_value
from stochlin.models.parameters import Parameter, Range, expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_mode
from stochlin.solver.tables import labels

GAP = Range(include_lower=True, reason="in metres; positive is open")
RADIUS = Range(reason="in metres")
POINTS = 181
OF_IMPACT = "point", "direction_1", "direction_2"  # dimensions of the impacts at one contact
DIRECTIONS = [1, -1]  # of the velocities: to the right, and to the left


class Mode(NamedTuple):
    """The first mode of a structure as an oscillator."""

    frequency: xr.DataArray  # [rad/s]
    mass: float  # [kg], effective modal mass
    moves: Array  # (n,) [-], displacement of the floors over that of the oscillator
    levels: Array  # (n,) [m]; NaN for an oscillator
    valid: xr.DataArray


@checked
def pounding_estimate(
    first: AnyStructure,
    second: AnyStructure,
    gap: Parameter,
    contact: Contact,
    radius_1: Parameter,
    radius_2: Parameter,
    *,
    points: Points = POINTS,
) -> xr.Dataset:
    """Estimated change of the energy radii of two structures by an impact at any displacement.

    Structures with the energy radii ``r_i`` and the circular frequencies ``w_i`` that meet at
    ``u_1 = u_2 + gap`` have the velocities ``v_i = +-w_i sqrt(r_i^2 - u_i^2)``. Eq. (13) gives the
    velocities ``v_i'`` after the impact, and ``r_i'^2 = u_i^2 + (v_i'/w_i)^2`` the energy radii.

    A `ShearBuilding` is represented by its first mode. At the level of a contact, its energy radius is
    ``p r_i``, with the ``participation()`` ``p`` of this level, and its mass is ``m/p^2``, with the
    modal mass ``m`` (this is ``phi' M phi`` over the square of ``phi`` at the level). The impact changes
    the velocity of the mode, and so the energy radius at all levels by the same factor.

    Parameters
    ----------
    first, second : Structure or ShearBuilding
        Structures with a mass, ``first`` on the left. Only their masses and periods are used, those of
        the first mode for a building with storeys.
    gap : float or array
        Gap between the structures [m], not negative.
    contact : Contact
        Contact between the structures, of which only the coefficient of restitution is used.
    radius_1, radius_2 : float or array
        Energy radii ``r_i`` [m], positive, for instance the `pseudo_energy_radius` of each structure
        alone; for a `ShearBuilding` that of its ``oscillator()``.
    points : int
        Number of displacements of the impact, evenly spaced over the range that both structures reach.

    Returns
    -------
    xarray.Dataset
        Over ``point``, ``direction_1`` and ``direction_2`` (1 for a velocity to the right, -1 to the
        left) and the dimensions of the parameters, for buildings with storeys also over ``contact``, as
        in `pound`: ``contact_displacement_1/2`` [m], ``velocity_before_1/2`` and
        ``velocity_after_1/2`` [m/s] of the impact, ``radius_amplification_1/2`` [-] and ``energy_lost``
        [J]; NaN where the structures do not approach one another.
        ``largest_radius_amplification_1/2`` [-] is the largest over these dimensions, and 1 if the
        structures do not reach one another. ``status``.

    Raises
    ------
    ValueError, TypeError
        If a mass is missing, a scalar is out of range, a value is not a number, dimensions do not match,
        or ``points`` is not a whole number from 2. Cells of arrays that are out of range are NaN, with
        the status ``invalid_input``.

    Notes
    -----
    The estimate is for linear structures; after yielding the stiffness at the impact differs. It gives
    the possible effect of one impact at full energy; `pound` gives the response history. For buildings
    with storeys the estimate neglects that the impact also excites higher modes, which take part of the
    energy, and that the impact acts on a floor first, so that further impacts follow.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13); for buildings with storeys derived here.

    Examples
    --------
    >>> import stochlin as sl
    >>> soft = sl.Bilinear(period=1.2, damping=0.05, mass=2e5)
    >>> stiff = sl.Bilinear(period=0.6, damping=0.05, mass=4e5)
    >>> hit = sl.pounding_estimate(soft, stiff, 0.05, sl.Stereomechanical(0.65), 0.1, 0.08)
    >>> round(float(hit.largest_radius_amplification_1), 3)
    1.922
    """
    modes = [_mode(structure, role) for role, structure in (("first", first), ("second", second))]
    lengths = [
        xr.DataArray(checked_value("pounding_estimate", name, value, "m", allowed))
        for name, value, allowed in (
            ("gap", gap, GAP),
            ("radius_1", radius_1, RADIUS),
            ("radius_2", radius_2, RADIUS),
        )
    ]
    valid = contact.valid() & modes[0].valid & modes[1].valid & GAP.contains(lengths[0])
    valid = valid & RADIUS.contains(lengths[1]) & RADIUS.contains(lengths[2])
    space, *radii = (length.where(valid) for length in lengths)
    places = meetings([mode.levels for mode in modes])
    each = [_impacts(modes, place, space, contact, radii, int(points)) for place in places]
    storeys = not all(np.isnan(mode.levels).any() for mode in modes)
    table = xr.concat(each, "contact").merge(contacts(places, ())) if storeys else each[0]
    of_impact = [*OF_IMPACT, *["contact"] * storeys]
    for n in (1, 2):
        largest = table[f"radius_amplification_{n}"].max(of_impact).fillna(1.0)
        table[f"largest_radius_amplification_{n}"] = largest.where(valid)
    table["status"] = labels.status_where(valid)
    return labels.with_run_information(
        labels.label(table),
        "Energy estimate of a hit",
        f"pounding_estimate(points={points})",
        {"first": first, "second": second, "contact": contact},
    )


def _mode(structure: AnyStructure, role: str) -> Mode:
    expect(structure, STRUCTURES, role)
    oscillator = first_mode(structure)
    if oscillator.mass is None:
        raise ValueError(f"{role}: mass is not given; a hit needs it, in kg")
    w = 2 * np.pi / oscillator.arrays()["period"]
    moves, levels = np.ones(1), np.full(1, np.nan)
    if isinstance(structure, MultistoreyBuilding):
        moves, levels = structure.first_mode_moves().to_numpy(), structure.levels()
    return Mode(w, float(oscillator.mass), moves, levels, structure.valid())


def _impacts(
    modes: Sequence[Mode],
    place: Meeting,
    gap: xr.DataArray,
    contact: Contact,
    radii: Sequence[xr.DataArray],
    points: int,
) -> xr.Dataset:
    """Impacts at one contact at all displacements that both structures reach, in all directions."""
    e, w = xr.DataArray(contact.e), [mode.frequency for mode in modes]
    moves = [
        sum(share * float(mode.moves[floor]) for floor, share in place.shares(side).items())
        for side, mode in zip(SIDES, modes, strict=True)
    ]
    mass = [mode.mass / share**2 for mode, share in zip(modes, moves, strict=True)]
    r = [radius * abs(share) for radius, share in zip(radii, moves, strict=True)]
    low: Any = np.maximum(-r[0], gap - r[1])
    high: Any = np.minimum(r[0], gap + r[1])
    share = xr.DataArray(np.linspace(0, 1, points), dims="point")
    u1 = (low + share * (high - low)).where(high >= low)
    u = [u1, u1 - gap]
    signs = [labels.axis(name, "direction of the velocity", DIRECTIONS) for name in OF_IMPACT[1:]]
    v = [
        sign * frequency * np.sqrt(np.maximum(radius**2 - at**2, 0.0))
        for sign, frequency, radius, at in zip(signs, w, r, u, strict=True)
    ]
    approach = v[0] > v[1]
    after = velocities_after_impact(*v, *mass, e)
    table = {"energy_lost": (impact_loss(*mass, e) * (v[0] - v[1]) ** 2).where(approach)}
    for i, n in enumerate((1, 2)):
        table[f"contact_displacement_{n}"] = u[i]
        table[f"velocity_before_{n}"] = v[i].where(approach)
        table[f"velocity_after_{n}"] = after[i].where(approach)
        table[f"radius_amplification_{n}"] = (np.hypot(u[i], after[i] / w[i]) / r[i]).where(approach)
    return xr.Dataset(table).transpose(..., *OF_IMPACT)
