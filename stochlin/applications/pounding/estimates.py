"""Estimate of the effect of an impact on two structures, from their energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.pounding.histories import contacts
from stochlin.applications.pounding.rows import SIDES, Meeting, meetings
from stochlin.applications.pounding.variables import VARIABLES
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import impact_loss, velocities_after_impact
from stochlin.models.arguments import Points, checked
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import checked_value
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Parameter, Range, expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_mode
from stochlin.solver.tables import labels

GAP = Range(include_lower=True, reason="in metres; positive is open")
RADIUS = Range(reason="in metres")
# Signs of the velocities with which two structures, number 1 on the left, can approach one another.
WAYS = {"towards each other": (1, -1), "both to the right": (1, 1), "both to the left": (-1, -1)}
POINTS = 181
PLACES = "point", "way"  # dimensions of the impacts at one contact


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
        Over ``point``, ``way`` (the signs of the velocities) and the dimensions of the parameters, for
        buildings with storeys also over ``contact``, as in `pound`: ``contact_displacement_1/2`` [m],
        ``velocity_before_1/2`` and ``velocity_after_1/2`` [m/s] of the impact,
        ``radius_amplification_1/2`` [-] and ``energy_lost`` [J]; NaN where the structures do not
        approach one another. ``largest_radius_amplification_1/2`` [-] is the largest over these
        dimensions, and 1 if the structures do not reach one another. ``status``.

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
    g = _argument("gap", gap, GAP)
    r = [_argument("radius_1", radius_1, RADIUS), _argument("radius_2", radius_2, RADIUS)]
    table = _estimate(modes, g, contact, r, int(points))
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        "Energy estimate of a hit",
        f"pounding_estimate(points={points})",
        {"first": first, "second": second, "contact": contact},
    )


def largest_by_one_impact(
    structures: Sequence[Bilinear], gaps: Array, contact: Contact, radii: Array
) -> Array:
    """Largest amplification of each structure's energy radius by one impact on either side [-].

    As `pounding_estimate` gives it, for one radius (n,) [m] each. It is NaN for a radius out of
    range and for its neighbours.
    """
    modes = [_mode(structure, f"structure {n}") for n, structure in enumerate(structures, 1)]
    largest = np.ones(len(modes))
    for left, gap in enumerate(gaps):
        two = slice(left, left + 2)
        both = [xr.DataArray(radius) for radius in radii[two]]
        estimate = _estimate(modes[two], xr.DataArray(gap), contact, both, POINTS)
        growth = [float(estimate[f"largest_radius_amplification_{n}"]) for n in (1, 2)]
        largest[two] = np.maximum(largest[two], growth)
    return largest


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


def _estimate(
    modes: Sequence[Mode],
    gap: xr.DataArray,
    contact: Contact,
    radii: Sequence[xr.DataArray],
    points: int,
) -> xr.Dataset:
    """Dataset of `pounding_estimate`, without labels."""
    valid = contact.valid() & modes[0].valid & modes[1].valid
    valid = valid & GAP.contains(gap) & RADIUS.contains(radii[0]) & RADIUS.contains(radii[1])
    places = meetings([mode.levels for mode in modes])
    e = xr.DataArray(contact.e)
    hits = [_hits(modes, place, gap, valid, e, radii, points) for place in places]
    storeys = not all(np.isnan(mode.levels).any() for mode in modes)
    table = xr.concat(hits, "contact").merge(contacts(places, ())) if storeys else hits[0]
    of_one = [*PLACES, *["contact"] * storeys]
    for n in (1, 2):
        largest = table[f"radius_amplification_{n}"].max(of_one).fillna(1.0)
        table[f"largest_radius_amplification_{n}"] = largest.where(valid)
    table["status"] = labels.status_where(valid)
    return table


def _hits(
    modes: Sequence[Mode],
    place: Meeting,
    gap: xr.DataArray,
    valid: xr.DataArray,
    restitution: xr.DataArray,
    radii: Sequence[xr.DataArray],
    points: int,
) -> xr.Dataset:
    """Impacts at one contact for all points and ways; cells that are not valid are NaN.

    ``valid`` has the dimensions and coordinates of all others. In between, values have dimensions only,
    which takes a fraction of the time.
    """
    arrays = [gap, restitution, *radii, *(mode.frequency for mode in modes)]
    parts: list[Any] = [each.variable for each in xr.align(valid, *arrays, join="inner")]
    usable, g, e, *others = parts
    g, radii, w = g.where(usable), others[:2], others[2:]
    moves = [
        sum(share * float(mode.moves[floor]) for floor, share in place.shares(side).items())
        for side, mode in zip(SIDES, modes, strict=True)
    ]
    mass = [mode.mass / share**2 for mode, share in zip(modes, moves, strict=True)]
    r = [radius * abs(share) for radius, share in zip(radii, moves, strict=True)]
    low, high = np.maximum(-r[0], g - r[1]), np.minimum(r[0], g + r[1])
    share = xr.Variable("point", np.linspace(0, 1, points))
    u1 = (low + share * (high - low)).where(high >= low)
    u = [u1, u1 - g]
    signs = [xr.Variable("way", list(each)) for each in zip(*WAYS.values(), strict=True)]
    v = [signs[i] * w[i] * np.sqrt(np.maximum(r[i] ** 2 - u[i] ** 2, 0.0)) for i in range(2)]
    approach = v[0] > v[1]
    after = velocities_after_impact(v[0], v[1], mass[0], mass[1], e)
    table: dict[str, xr.Variable] = {}
    for i in range(2):
        n = i + 1
        table[f"contact_displacement_{n}"] = u[i]
        table[f"velocity_before_{n}"] = v[i].where(approach)
        table[f"velocity_after_{n}"] = after[i].where(approach)
        table[f"radius_amplification_{n}"] = (np.hypot(u[i], after[i] / w[i]) / r[i]).where(approach)
    loss = impact_loss(mass[0], mass[1], e) * (v[0] - v[1]) ** 2
    table["energy_lost"] = loss.where(approach)
    return xr.Dataset(table, coords=valid.coords).assign_coords(way=list(WAYS))


def _argument(name: str, value: Any, allowed: Range) -> xr.DataArray:
    return xr.DataArray(checked_value("pounding_estimate", name, value, "m", allowed))
