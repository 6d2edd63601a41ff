"""Estimate of the effect of an impact on two structures, from their energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.simulation.contacts import impact_loss, velocities_after_impact
from stochlin.models.arguments import Points, checked
from stochlin.models.contacts.elements import Contact, checked_value
from stochlin.models.parameters import Model, Parameter, Range, check_alignment, expect
from stochlin.models.structures import Structure
from stochlin.models.systems import check_mass
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import check_names

OPEN_GAP = Range(include_lower=True, reason="in metres; positive is open")
ENERGY_RADIUS = Range(reason="in metres")
POINTS_OF_IMPACT = 181
IMPACT_DIMENSIONS = "point", "direction_1", "direction_2"  # of the impacts at one contact
SIGNS_OF_VELOCITY = [1, -1]  # of the velocities: to the right, and to the left


@checked
def pounding_estimate(
    first: Structure,
    second: Structure,
    gap: Parameter,
    contact: Contact,
    radius_1: Parameter,
    radius_2: Parameter,
    *,
    points: Points = POINTS_OF_IMPACT,
) -> xr.Dataset:
    """Estimated change of the energy radii of two structures by an impact at any displacement.

    Structures with the energy radii ``r_i`` and the circular frequencies ``w_i`` that meet at
    ``u_1 = u_2 + gap`` have the velocities ``v_i = +-w_i sqrt(r_i^2 - u_i^2)``. Eq. (13) gives the
    velocities ``v_i'`` after the impact, and ``r_i'^2 = u_i^2 + (v_i'/w_i)^2`` the energy radii.

    Parameters
    ----------
    first, second : Bilinear, BoucWen or Hysteretic
        Structures with a mass, ``first`` on the left. Only their masses and periods are used. That
        of a building with storeys is its ``oscillator()``, which meets the other one with all of
        its mass.
    gap : float or array
        Gap between the structures [m], not negative.
    contact : Contact
        Contact between the structures, of which only the coefficient of restitution is used.
    radius_1, radius_2 : float or array
        Energy radii ``r_i`` [m], positive, for instance the `pseudo_energy_radius` of each
        structure alone.
    points : int
        Number of displacements of the impact, evenly spaced over the range that both structures
        reach.

    Returns
    -------
    xarray.Dataset
        Over ``point``, ``direction_1`` and ``direction_2`` (1 for a velocity to the right, -1 to
        the left) and the dimensions of the parameters: ``contact_displacement_1/2`` [m],
        ``velocity_before_1/2`` and ``velocity_after_1/2`` [m/s] of the impact,
        ``radius_amplification_1/2`` [-] and ``energy_lost`` [J]; NaN where the structures do not
        approach one another. ``largest_radius_amplification_1/2`` [-] is the largest over these
        dimensions, and 1 if the structures do not reach one another. ``status``.

    Raises
    ------
    ValueError, TypeError
        If a mass is missing, a scalar is out of range, a value is not a number, dimensions do not
        match, or ``points`` is not a whole number from 2. Cells of arrays that are out of range are
        NaN, with the status ``invalid_input``.

    Notes
    -----
    The estimate is for linear structures; after yielding the stiffness at the impact differs. It
    gives the possible effect of one impact at full energy; `pound` gives the response history.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13).

    Examples
    --------
    >>> import stochlin as sl
    >>> soft = sl.Bilinear(period=1.2, damping=0.05, mass=2e5)
    >>> stiff = sl.Bilinear(period=0.6, damping=0.05, mass=4e5)
    >>> hit = sl.pounding_estimate(soft, stiff, 0.05, sl.Stereomechanical(0.65), 0.1, 0.08)
    >>> round(float(hit.largest_radius_amplification_1), 3)
    1.922
    """
    for role, structure in (("first", first), ("second", second)):
        expect(structure, Structure, role)
        check_mass(structure, role)
    lengths = [
        xr.DataArray(checked_value("pounding_estimate", name, value, "m", allowed))
        for name, value, allowed in (
            ("gap", gap, OPEN_GAP),
            ("radius_1", radius_1, ENERGY_RADIUS),
            ("radius_2", radius_2, ENERGY_RADIUS),
        )
    ]
    models: tuple[Model, ...] = first, second, contact
    arrays = [*lengths, *(array for model in models for array in model.arrays().values())]
    check_alignment("gap, radii, structures and contact", *arrays)
    names = [name for array in arrays for name in (*array.dims, *array.coords)]
    check_names(names, {"status", *IMPACT_DIMENSIONS})
    valid = contact.valid() & first.valid() & second.valid()
    for length, allowed in zip(lengths, (OPEN_GAP, ENERGY_RADIUS, ENERGY_RADIUS), strict=True):
        valid = valid & allowed.contains(length)
    valid_lengths = [length.where(valid) for length in lengths]
    table = _impacts((first, second), valid_lengths[0], contact, valid_lengths[1:], int(points))
    for n in (1, 2):
        largest = table[f"radius_amplification_{n}"].max(IMPACT_DIMENSIONS).fillna(1.0)
        table[f"largest_radius_amplification_{n}"] = largest.where(valid)
    table["status"] = labels.status_where(valid)
    return labels.with_run_information(
        labels.label(table),
        "Energy estimate of a hit",
        f"pounding_estimate(points={points})",
        {"first": first, "second": second, "contact": contact},
    )


def _impacts(
    structures: Sequence[Structure],
    gap: xr.DataArray,
    contact: Contact,
    r: Sequence[xr.DataArray],
    points: int,
) -> xr.Dataset:
    """Impacts at all displacements that both structures reach, in all directions."""
    e = xr.DataArray(contact.e)
    mass = [structure.arrays()["mass"] for structure in structures]
    w = [2 * np.pi / structure.arrays()["period"] for structure in structures]
    low: Any = np.maximum(-r[0], gap - r[1])
    high: Any = np.minimum(r[0], gap + r[1])
    share = xr.DataArray(np.linspace(0, 1, points), dims="point")
    u1 = (low + share * (high - low)).where(high >= low)
    u = [u1, u1 - gap]
    _, *directions = IMPACT_DIMENSIONS
    about = "direction of the velocity"
    signs = [labels.axis(name, about, SIGNS_OF_VELOCITY) for name in directions]
    v = [
        sign * frequency * np.sqrt(np.maximum(radius**2 - displacement**2, 0.0))
        for sign, frequency, radius, displacement in zip(signs, w, r, u, strict=True)
    ]
    approach = v[0] > v[1]
    after = velocities_after_impact(v[0], v[1], mass[0], mass[1], e)
    energy_lost = impact_loss(mass[0], mass[1], e) * (v[0] - v[1]) ** 2
    table = {"energy_lost": energy_lost.where(approach)}
    for i, n in enumerate((1, 2)):
        table[f"contact_displacement_{n}"] = u[i]
        table[f"velocity_before_{n}"] = v[i].where(approach)
        table[f"velocity_after_{n}"] = after[i].where(approach)
        radius = np.hypot(u[i], after[i] / w[i])
        table[f"radius_amplification_{n}"] = (radius / r[i]).where(approach)
    return xr.Dataset(table).transpose(..., *IMPACT_DIMENSIONS)
