"""Estimates of the effect of impacts on structures in a row, from their energies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.analyses.pounding.ensembles import NEIGHBOURS, neighbours
from stochlin.analyses.pounding.histories import contacts
from stochlin.analyses.pounding.rows import SIDES, Meeting, checked_gaps, meetings
from stochlin.analyses.pounding.variables import VARIABLES
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import impact_loss, velocities_after_impact
from stochlin.messages import brief, sentence
from stochlin.models.arguments import Points, checked
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.contacts import Contact
from stochlin.models.contacts.base import checked_value
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Parameter, Range, expect
from stochlin.models.systems import STRUCTURES, AnyStructure, first_mode

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
    `pounding_estimate_row` is for more than two structures; `pounding_estimate_error` measures the error
    of the estimate.

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


@checked
def pounding_estimate_row(
    structures: Sequence[AnyStructure],
    gaps: npt.ArrayLike,
    contact: Contact,
    radii: Sequence[Parameter],
    *,
    points: Points = POINTS,
) -> xr.Dataset:
    """Estimated change of the energy radii in a row, by one impact and by a chain of impacts.

    One impact is estimated by `pounding_estimate` for each two neighbours. In a chain, the energy radii
    after the impact at the first gap are those before the impact at the next gap, and so on, once
    through the row from the left and once from the right. A building in the middle then has impacts from
    both sides. At every gap, each structure has the impact that is worst for it; this need not be the
    same impact for both.

    Parameters
    ----------
    structures : list of Structure and ShearBuilding
        At least two structures from left to right, as in `pounding_estimate`.
    gaps : list of float
        Gaps between neighbours [m], not negative; for two structures one number is enough.
    contact : Contact
        As in `pounding_estimate`.
    radii : list of float or array
        Energy radius of each structure [m], as in `pounding_estimate`.
    points : int
        As in `pounding_estimate`.

    Returns
    -------
    xarray.Dataset
        Over ``structure`` and the dimensions of the radii: ``largest_radius_amplification`` [-] by one
        impact on either side, and ``chain_radius_amplification`` [-] by a chain of impacts. Over
        ``neighbours`` and ``side``: ``radius_amplification`` [-], the largest by one impact at this gap
        for the structure on this side. ``status``.

    Raises
    ------
    ValueError, TypeError
        As in `pounding_estimate`, or if the number of gaps or radii is wrong.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (1) and (13); chains of impacts are derived here.

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
    modes = [_mode(structure, f"structures, number {n}") for n, structure in enumerate(structures, 1)]
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

    grown, single = _by_one_impact(modes, spaces, contact, alone, int(points))
    chain = list(single)
    for order in (range(count - 1), range(count - 2, -1, -1)):
        now = list(alone)
        for left in order:
            growth = grown[left]
            if left != order[0]:
                two = slice(left, left + 2)
                growth = _growth(modes[two], spaces[left], contact, now[two], int(points))
            for n, growth_there in enumerate(growth, start=left):
                now[n] = now[n] * growth_there
                chain[n] = xr.ufuncs.maximum(chain[n], now[n] / alone[n])
    about = {"long_name": "structure"}
    table = xr.Dataset(
        {
            "largest_radius_amplification": _along("structure", single),
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


def largest_by_one_impact(
    structures: Sequence[Bilinear], gaps: Array, contact: Contact, radii: Array
) -> Array:
    """Largest amplification of each structure's energy radius by one impact on either side [-].

    As `pounding_estimate_row` gives it, for one radius (n,) [m] each. It is NaN for a radius out of
    range and for its neighbours.
    """
    modes = [_mode(structure, f"structure {n}") for n, structure in enumerate(structures, 1)]
    _, single = _by_one_impact(modes, gaps, contact, [xr.DataArray(r) for r in radii], POINTS)
    return np.array([float(growth) for growth in single])


def _by_one_impact(
    modes: Sequence[Mode], gaps: Array, contact: Contact, radii: Sequence[xr.DataArray], points: int
) -> tuple[list[list[xr.DataArray]], list[xr.DataArray]]:
    """Largest amplifications by one impact at each gap, of both sides, and of each structure."""
    pairs = [(slice(left, left + 2), gap) for left, gap in enumerate(gaps)]
    grown = [_growth(modes[two], gap, contact, radii[two], points) for two, gap in pairs]
    single = [xr.DataArray(1.0)] * len(modes)
    for left, growth in enumerate(grown):
        for side in range(2):
            single[left + side] = xr.ufuncs.maximum(single[left + side], growth[side])
    return grown, single


def _growth(
    modes: Sequence[Mode], gap: float, contact: Contact, radii: Sequence[xr.DataArray], points: int
) -> list[xr.DataArray]:
    """Largest amplifications of the energy radii of two neighbours by one impact."""
    estimate = _estimate(modes, xr.DataArray(gap), contact, radii, points)
    return [estimate[f"largest_radius_amplification_{n}"] for n in (1, 2)]


def _along(dim: str, arrays: Sequence[xr.DataArray]) -> xr.DataArray:
    """Arrays of different dimensions, broadcast and concatenated along the new dimension ``dim``."""
    like = xr.broadcast(*[array.reset_coords(drop=True) for array in arrays])
    return xr.concat(like, dim)


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
