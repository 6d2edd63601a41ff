"""What a hit can do to two structures, from their energies alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_whole
from stochlin.kernels.pounding.contact import impact_loss, velocities_after_impact
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import checked
from stochlin.models.parameters import Parameter, Range, expect
from stochlin.models.structures import Structure

GAP = Range(include_lower=True, reason="in metres; positive is open")
RADIUS = Range(reason="in metres")
# Structure 1 is on the left: signs of both velocities with which structures can approach.
WAYS = {"towards each other": (1, -1), "both to the right": (1, 1), "both to the left": (-1, -1)}


def pounding_estimate(
    first: Structure,
    second: Structure,
    gap: Parameter,
    contact: Contact,
    radius_1: Parameter,
    radius_2: Parameter,
    *,
    points: int = 181,
) -> xr.Dataset:
    """What a hit does to the energy radii of two structures, wherever they may meet.

    Structures of the radii ``r_i`` that meet at ``u_1 = u_2 + gap`` have the velocities ``v_i = +-w_i
    sqrt(r_i^2 - u_i^2)``. Eq. (13) makes them ``v_i'``, and the radii ``r_i'^2 = u_i^2 + (v_i'/w_i)^2``.

    Parameters
    ----------
    first, second : Structure
        With a mass; ``first`` on the left. Of the rest, only the periods count.
    gap : float or array
        [m], not negative.
    contact : Contact
        Only its coefficient of restitution counts.
    radius_1, radius_2 : float or array
        ``r_i`` [m], positive, for instance the `pseudo_energy_radius` of each structure alone.
    points : int
        Places of meeting, evenly from one end to the other of where both structures can be.

    Returns
    -------
    xarray.Dataset
        Over ``point``, ``way`` (the signs of the velocities) and the dimensions of the parameters:
        ``contact_displacement_1/2`` [m], ``velocity_before_1/2`` and ``velocity_after_1/2`` [m/s],
        ``radius_amplification_1/2`` [-], ``energy_lost`` [J]; NaN where the structures do not approach
        each other. ``largest_radius_amplification_1/2`` [-]: the largest of all, 1 where the structures
        do not reach each other. ``status``.

    Raises
    ------
    ValueError, TypeError
        If a mass is missing, a scalar is out of range, a value is not a number, dimensions do not fit,
        or ``points`` is not a whole number from 2. Cells of arrays that are out of range are NaN, with
        the status ``invalid_input``.

    Notes
    -----
    An estimate for linear structures: after yielding, the stiffness at the hit is not that of ``w``. It
    says what one hit at full energy can do; a history is `pound`'s.

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
    expect(contact, Contact, "contact")
    check_whole("points", points, 2)
    w, mass, valid = [], [], contact.valid()
    for role, structure in (("first", first), ("second", second)):
        expect(structure, Structure, role)
        if structure.mass is None:
            raise ValueError(f"{role}: mass is not given; a hit needs it, in kg")
        w.append(2 * np.pi / structure.arrays()["period"])
        mass.append(float(structure.mass))
        valid = valid & structure.valid()
    g = _argument("gap", gap, GAP)
    r = [_argument("radius_1", radius_1, RADIUS), _argument("radius_2", radius_2, RADIUS)]
    valid = valid & GAP.contains(g) & RADIUS.contains(r[0]) & RADIUS.contains(r[1])
    low, high = xr.ufuncs.maximum(-r[0], g - r[1]), xr.ufuncs.minimum(r[0], g + r[1])
    share = xr.DataArray(np.linspace(0, 1, int(points)), dims="point")
    u1 = (low + share * (high - low)).where((high >= low) & valid)
    u = [u1, u1 - g]
    signs = xr.DataArray(list(WAYS.values()), dims=("way", "structure"), coords={"way": list(WAYS)})
    v = [
        signs.isel(structure=i) * w[i] * np.sqrt(np.maximum(r[i] ** 2 - u[i] ** 2, 0.0))
        for i in range(2)
    ]
    approach = v[0] > v[1]
    after = velocities_after_impact(v[0], v[1], mass[0], mass[1], xr.DataArray(contact.e))
    table = xr.Dataset()
    for i in range(2):
        n = i + 1
        table[f"contact_displacement_{n}"] = u[i]
        table[f"velocity_before_{n}"] = v[i].where(approach)
        table[f"velocity_after_{n}"] = after[i].where(approach)
        growth = (np.hypot(u[i], after[i] / w[i]) / r[i]).where(approach)
        table[f"radius_amplification_{n}"] = growth
        largest = growth.max(("point", "way")).fillna(1.0)
        table[f"largest_radius_amplification_{n}"] = largest.where(valid)
    loss = impact_loss(mass[0], mass[1], contact.e) * (v[0] - v[1]) ** 2
    table["energy_lost"] = loss.where(approach)
    table["status"] = labels.status_where(valid)
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        "Energy estimate of a hit",
        f"pounding_estimate(points={points})",
        {"first": first, "second": second, "contact": contact},
    )


def _argument(name: str, value: Any, allowed: Range) -> xr.DataArray:
    return xr.DataArray(checked("pounding_estimate", name, value, "m", allowed))
