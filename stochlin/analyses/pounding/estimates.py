"""What hits can do to structures in a row, from their energies alone."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.pounding.ensembles import NEIGHBOURS, neighbours
from stochlin.analyses.pounding.histories import SIDES, contacts
from stochlin.analyses.pounding.rows import Meeting, checked_gaps, meetings
from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_whole
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.pounding.contact import impact_loss, velocities_after_impact
from stochlin.messages import brief, sentence
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import checked
from stochlin.models.parameters import Parameter, Range, expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_mode

GAP = Range(include_lower=True, reason="in metres; positive is open")
RADIUS = Range(reason="in metres")
# Structure 1 is on the left: signs of both velocities with which structures can approach.
WAYS = {"towards each other": (1, -1), "both to the right": (1, 1), "both to the left": (-1, -1)}
PLACES = "point", "way"  # dimensions of all hits at one contact


class Mode(NamedTuple):
    """The first mode of a structure, as an oscillator whose energy has a radius."""

    frequency: xr.DataArray  # [rad/s]
    mass: float  # [kg]: effective modal mass
    moves: Array  # (n,) [-]: displacement of the floors over that of the oscillator
    levels: Array  # (n,) [m]; NaN of an oscillator
    valid: xr.DataArray


def pounding_estimate(
    first: AnyStructure,
    second: AnyStructure,
    gap: Parameter,
    contact: Contact,
    radius_1: Parameter,
    radius_2: Parameter,
    *,
    points: int = 181,
) -> xr.Dataset:
    """Estimated change of the energy radii of two structures by an impact at any displacement.

    Structures of the radii ``r_i`` that meet at ``u_1 = u_2 + gap`` have the velocities ``v_i = +-w_i
    sqrt(r_i^2 - u_i^2)``. Eq. (13) makes them ``v_i'``, and the radii ``r_i'^2 = u_i^2 + (v_i'/w_i)^2``.

    Of a `ShearBuilding` they are those of its first mode at the level where it is met: the radius
    there is ``p r_i``, with the ``participation()`` ``p`` of the level, and the mass that is hit
    ``m/p^2``, with the modal mass ``m`` (that is ``phi' M phi`` over the square of ``phi`` there). The
    hit changes the velocity of the mode, and so the radius of the mode by one factor at all levels.

    Parameters
    ----------
    first, second : Structure or ShearBuilding
        Oscillators with a mass; ``first`` on the left. Of the rest, only the periods count, of a
        building with storeys its first mode.
    gap : float or array
        [m], not negative.
    contact : Contact
        Only its coefficient of restitution counts.
    radius_1, radius_2 : float or array
        ``r_i`` [m], positive, for instance the `pseudo_energy_radius` of each structure alone; of a
        `ShearBuilding` that of its ``oscillator()``.
    points : int
        Places of meeting, evenly from one end to the other of where both structures can be.

    Returns
    -------
    xarray.Dataset
        Over ``point``, ``way`` (the signs of the velocities) and the dimensions of the parameters, with
        storeys also over ``contact``, as in `pound`: ``contact_displacement_1/2`` [m],
        ``velocity_before_1/2`` and ``velocity_after_1/2`` [m/s] there,
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
    says what one hit at full energy can do; a history is `pound`'s. For buildings with storeys, higher
    modes are left out, which the hit excites too and which take a part of its energy, and that it is
    a floor, not the mode, that is hit first: the rest of the building follows in more hits.
    `pounding_estimate_row` is for more than two, `pounding_estimate_error` says how far all that is off.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13). At storeys: derived here.

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
    modes = [_mode(structure, role) for role, structure in (("first", first), ("second", second))]
    g = _argument("gap", gap, GAP)
    r = [_argument("radius_1", radius_1, RADIUS), _argument("radius_2", radius_2, RADIUS)]
    valid = contact.valid() & modes[0].valid & modes[1].valid
    valid = valid & GAP.contains(g) & RADIUS.contains(r[0]) & RADIUS.contains(r[1])
    places = meetings([mode.levels for mode in modes])
    hits = [_hits(modes, place, g.where(valid), contact, r, int(points)) for place in places]
    storeys = any(isinstance(structure, ShearBuilding) for structure in (first, second))
    table = hits[0]
    if storeys:
        table = xr.concat(hits, "contact").merge(contacts(places, ()))
    of_one = [*PLACES, *["contact"] * storeys]
    for n in (1, 2):
        largest = table[f"radius_amplification_{n}"].max(of_one).fillna(1.0)
        table[f"largest_radius_amplification_{n}"] = largest.where(valid)
    table["status"] = labels.status_where(valid)
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        "Energy estimate of a hit",
        f"pounding_estimate(points={points})",
        {"first": first, "second": second, "contact": contact},
    )


def pounding_estimate_row(
    structures: Sequence[AnyStructure],
    gaps: npt.ArrayLike,
    contact: Contact,
    radii: Sequence[Parameter],
    *,
    points: int = 181,
) -> xr.Dataset:
    """Estimated change of the energy radii in a row, by one impact each and by successive impacts.

    One hit: `pounding_estimate` of each two neighbours. A chain: a hit at the first gap leaves both its
    structures with the radii that it makes of them; with these the hit at the next gap follows, and so
    on, once through the row from the left and once from the right. A building in the middle is so hit
    from both sides. At every gap each structure has the hit that is worst for it, not both the same one.

    Parameters
    ----------
    structures : list of Structure and ShearBuilding
        From left to right, at least two, as in `pounding_estimate`.
    gaps : list of float
        Between neighbours [m], not negative; for two structures a number will do.
    contact : Contact
        Only its coefficient of restitution counts.
    radii : list of float or array
        One for each structure, as in `pounding_estimate` [m].
    points : int
        As in `pounding_estimate`.

    Returns
    -------
    xarray.Dataset
        Over ``structure`` and the dimensions of the radii: ``largest_radius_amplification`` [-], of one
        hit at either side, and ``chain_radius_amplification`` [-], of a chain. Over ``neighbours`` and
        ``side``: ``radius_amplification`` [-], the largest of one hit at that gap for the structure on
        that side. ``status``.

    Raises
    ------
    ValueError, TypeError
        As in `pounding_estimate`, or if the number of gaps or radii does not fit.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13). Chains: derived here.

    Examples
    --------
    >>> import stochlin as sl
    >>> row = [sl.Bilinear(period=T, damping=0.05, mass=2e5) for T in (1.2, 0.6, 0.9)]
    >>> blow = sl.Stereomechanical(0.65)
    >>> worst = sl.pounding_estimate_row(row, [0.02, 0.02], blow, [0.1, 0.06, 0.08])
    >>> worst.largest_radius_amplification.round(2).values
    array([1.18, 1.19, 1.14])
    >>> worst.chain_radius_amplification.round(2).values
    array([1.37, 1.33, 1.31])
    """
    if not isinstance(structures, (list, tuple)) or len(structures) < 2:
        raise ValueError(
            f"structures = {brief(structures)}; allowed: a list of at least two, left to right"
        )
    count = len(structures)
    for number, structure in enumerate(structures, start=1):
        _mode(structure, f"structures, number {number}")
    spaces = checked_gaps(gaps, count)
    if not isinstance(radii, (list, tuple)) or len(radii) != count:
        raise ValueError(
            f"radii = {brief(radii)}; allowed: a list of {count}, one for each structure, in metres"
        )
    alone = [
        _argument(f"radii, number {number}", radius, RADIUS) for number, radius in enumerate(radii, 1)
    ]
    try:
        xr.align(*alone, join="exact")
    except ValueError as error:
        raise ValueError(f"radii: their dimensions do not fit: {sentence(error)}") from error

    def hit(left: int, now: Sequence[xr.DataArray]) -> list[xr.DataArray]:
        first, second = structures[left : left + 2]
        radius_1, radius_2 = now[left : left + 2]
        found = pounding_estimate(
            first, second, spaces[left], contact, radius_1, radius_2, points=points
        )
        return [found[f"largest_radius_amplification_{n}"] for n in (1, 2)]

    grown = [hit(left, alone) for left in range(count - 1)]
    one = [xr.DataArray(1.0)] * count
    for left, growth in enumerate(grown):
        for side in range(2):
            one[left + side] = xr.ufuncs.maximum(one[left + side], growth[side])
    chain = list(one)
    for order in (range(count - 1), reversed(range(count - 1))):
        now = list(alone)
        for left in order:
            for n, growth_there in enumerate(hit(left, now), start=left):
                now[n] = now[n] * growth_there
                chain[n] = xr.ufuncs.maximum(chain[n], now[n] / alone[n])
    about = {"long_name": "structure"}
    table = xr.Dataset(
        {
            "largest_radius_amplification": _along("structure", one),
            "chain_radius_amplification": _along("structure", chain),
            "radius_amplification": _along(NEIGHBOURS, [_along("side", growth) for growth in grown]),
        },
        coords={
            "structure": ("structure", np.arange(1, count + 1), about),
            "side": ("side", list(SIDES), {"long_name": "side of the gap"}),
            **neighbours(count),
        },
    )
    table["status"] = labels.status_where(table.chain_radius_amplification.notnull().all("structure"))
    models = {f"structure_{n}": each for n, each in enumerate(structures, start=1)}
    return labels.with_run_information(
        labels.label(table, VARIABLES),
        "Energy estimate of hits in a row",
        f"pounding_estimate_row(points={points})",
        {**models, "contact": contact},
    ).assign_attrs(gaps=spaces.tolist())


def _along(dim: str, arrays: Sequence[xr.DataArray]) -> xr.DataArray:
    """Arrays of different dimensions, one after the other along one of their own."""
    like = xr.broadcast(*[array.reset_coords(drop=True) for array in arrays])
    return xr.concat(like, dim)


def _mode(structure: AnyStructure, role: str) -> Mode:
    expect(structure, STRUCTURES, role)
    oscillator = first_mode(structure)
    if oscillator.mass is None:
        raise ValueError(f"{role}: mass is not given; a hit needs it, in kg")
    w = 2 * np.pi / oscillator.arrays()["period"]
    moves, levels = np.ones(1), np.full(1, np.nan)
    if isinstance(structure, ShearBuilding):
        moves, levels = structure.participation().to_numpy(), structure.levels()
    return Mode(w, float(oscillator.mass), moves, levels, structure.valid())


def _hits(
    modes: Sequence[Mode],
    place: Meeting,
    gap: xr.DataArray,
    contact: Contact,
    radii: Sequence[xr.DataArray],
    points: int,
) -> xr.Dataset:
    """All hits at one contact; the gap is NaN where nothing is to be said."""
    moves = [_moves(place, side, mode.moves) for side, mode in zip(SIDES, modes, strict=True)]
    mass = [mode.mass / share**2 for mode, share in zip(modes, moves, strict=True)]
    r = [radius * abs(share) for radius, share in zip(radii, moves, strict=True)]
    low, high = xr.ufuncs.maximum(-r[0], gap - r[1]), xr.ufuncs.minimum(r[0], gap + r[1])
    share = xr.DataArray(np.linspace(0, 1, points), dims="point")
    u1 = (low + share * (high - low)).where(high >= low)
    u = [u1, u1 - gap]
    signs = xr.DataArray(list(WAYS.values()), dims=("way", "structure"), coords={"way": list(WAYS)})
    w = [mode.frequency for mode in modes]
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
        table[f"radius_amplification_{n}"] = (np.hypot(u[i], after[i] / w[i]) / r[i]).where(approach)
    loss = impact_loss(mass[0], mass[1], contact.e) * (v[0] - v[1]) ** 2
    table["energy_lost"] = loss.where(approach)
    return table


def _moves(place: Meeting, side: str, floors: Array) -> float:
    """How far a side of a contact moves, floor or column, where its floors move so far."""
    floor = place.floor_left if side == SIDES[0] else place.floor_right
    share = place.share if place.struck == side else 1.0
    below = float(floors[floor - 1]) if floor else 0.0
    return share * float(floors[floor]) + (1 - share) * below


def _argument(name: str, value: Any, allowed: Range) -> xr.DataArray:
    return xr.DataArray(checked("pounding_estimate", name, value, "m", allowed))
