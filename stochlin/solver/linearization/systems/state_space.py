"""State matrix of any number of linearized structures on one ground, and its stationary covariance.

`correlate` has a faster method for pairs of oscillators without links, and uses this one with the
argument ``solver="lyapunov"``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.systems.lyapunov import INACCURATE, UNSTABLE
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.state_space import (
    Mechanics,
    StateSpace,
    state_space,
)
from stochlin.messages import brief
from stochlin.models.arguments import as_numbers, checked
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.parameters import Model, expect
from stochlin.models.systems import (
    STRUCTURES,
    AnyStructure,
    Arrangement,
    arrangement_of,
    check_links,
)
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

ONE_SYSTEM = "a scalar, since this describes one system"


@dataclass(frozen=True)
class Equations:
    """Eqs. (5), (6), (8), (11) and (12) of structures on one ground, in one or several cells (c).

    The springs (s) are the elements of the structures, which are storeys or modes, and, after them, the
    links (l). The elements (e) are the springs that can have a hysteresis law: those of the structures
    and the links that yield. There are n coordinates.
    """

    arrangement: Arrangement
    ground: Ground

    @cached_property
    def springs(self) -> list[str]:
        """Names of the springs."""
        return [*self.arrangement.coordinates, *(tie.name for tie in self.arrangement.ties)]

    @property
    def first_link(self) -> int:
        """Number of the first link among the springs."""
        return int(self.arrangement.first_coordinate[-1])

    @property
    def reported_names(self) -> list[str]:
        """Names of the elements of results: the `watched` of the structures, and links that yield."""
        links = (self.springs[spring] for spring in self.elements[self.first_link :])
        return [*self.arrangement.watched, *links]

    def reported(self, values: Array, elastic: float, unknown: float | None = None) -> Array:
        """Values (..., e) of the elements for those of results; see `Arrangement.of_elements`."""
        unknown = elastic if unknown is None else unknown
        own = self.arrangement.of_elements(values, elastic, unknown)
        return np.concatenate([own, values[..., self.first_link :]], axis=-1)

    def from_reported(self, values: Array, elastic: float) -> Array:
        """Values (e,) of the elements from those of results, ``elastic`` where there is none."""
        links = np.arange(self.first_link, len(self.elements))
        number = np.concatenate([self.arrangement.of_watched, links])
        of_elements = np.full(len(self.elements), elastic)
        of_elements[number[number >= 0]] = values[number >= 0]
        return of_elements

    @cached_property
    def elements(self) -> Array:
        """Numbers of the springs that are elements (e,)."""
        n, ties = self.first_link, self.arrangement.ties
        return np.array([*range(n), *(n + i for i, tie in enumerate(ties) if tie.link.yields)])

    @cached_property
    def strength(self) -> Array:
        """Yield drifts of the elements (c, e) [m], infinite if elastic."""
        return self.system.strength[:, self.elements]

    @property
    def yields(self) -> Array:
        """Whether each element (e,) yields; a strength that could not be computed is NaN."""
        return np.asarray(~np.isposinf(self.strength).all(axis=0))

    @cached_property
    def system(self) -> System:
        """Elements and springs of links in all cells, without the dashpots of links."""
        storeys, links = self.arrangement.storeys.over_cells(self.cells), self._links
        post, couple, strength = (
            np.concatenate(parts, axis=1) for parts in zip(storeys[-3:], links[:3], strict=True)
        )
        mass, damping, _, shapes, *_ = storeys
        return System(mass, damping, self.arrangement.extensions, shapes, post, couple, strength)

    @cached_property
    def soil(self) -> Filter:
        """The filter of the ground in all cells."""
        parameters = self.ground.arrays().items()
        return self.ground.filter({n: np.broadcast_to(value, self.cells) for n, value in parameters})

    def states(self, own: Array) -> tuple[list[str], Array]:
        """Names of the states by structures, links last, and their numbers in a `StateSpace`.

        Elements with ``own`` (e,) have a ``z``.
        """
        first, coordinates = self.arrangement.first_coordinate, self.arrangement.coordinates
        of_ground = self.soil.states
        names = [*of_ground, *(f"{state}_{name}" for state in "uv" for name in coordinates)]
        names += [f"z_{self.springs[spring]}" for spring in self.elements[own]]
        structure = np.repeat(np.arange(first.size - 1), np.diff(first))
        with_links = np.append(structure, np.full(len(self.elements) - structure.size, first.size))
        ground = np.full(len(of_ground), -1)
        order = np.argsort(
            np.concatenate([ground, structure, structure, with_links[own]]), kind="stable"
        )
        return [names[state] for state in order], order

    def mechanics(self, own: Array) -> Mechanics:
        """Masses, springs and ground of all cells; elements with ``own`` (e,) have a state ``z``."""
        return Mechanics(self.elements[own], self.system, self.soil)

    def state_space(
        self, c_eq: Array, k_eq: Array, own: Array, dashpots: Array | None = None
    ) -> StateSpace:
        """Linear systems for coefficients of the elements (e,); those with ``own`` have a state ``z``.

        ``dashpots`` (c, l) [N s/m] replace the damping constants of the links.
        """
        c, k = (np.broadcast_to(a[..., own], (self.cells, int(own.sum()))) for a in (c_eq, k_eq))
        return state_space(self.mechanics(own), c, k, self.dashpots if dashpots is None else dashpots)

    @property
    def dashpots(self) -> Array:
        """Damping constants of the links (c, l), in N s/m for the exponent 1."""
        return self._links[3]

    @property
    def exponents(self) -> Array:
        """Exponents of the dashpots of the links (c, l)."""
        return self._links[4]

    @cached_property
    def cells(self) -> int:
        """Number of cells."""
        shapes = [stack.system.mass.shape[:-1] for stack in self.arrangement.stacks]
        shapes += [value.shape for tie in self.arrangement.ties for value in _of_link(tie.link)]
        shapes += [value.shape for value in self.ground.arrays().values()]
        return math.prod(np.broadcast_shapes(*shapes))

    @cached_property
    def _links(self) -> Array:
        """Post-yield stiffness, what yielding takes of it, strength, dashpot and exponent: (5, c, l)."""
        ties = self.arrangement.ties
        rows = [[np.broadcast_to(v, self.cells) for v in _of_link(tie.link)] for tie in ties]
        return np.array(rows).reshape(len(rows), 5, self.cells).transpose(1, 2, 0)


def _of_link(link: Link) -> list[Array]:
    """Post-yield stiffness, what yielding takes of it, strength, dashpot and exponent of a link."""
    values = link.cells()
    dashpot = values["damping_constant"], values.get("damping_exponent", 1.0)
    return [np.asarray(value) for value in (*link.springs, *dashpot)]


def checked_system(
    structures: Sequence[AnyStructure], ground: Ground, links: Sequence[Link | None]
) -> tuple[Link | None, ...]:
    """The links; raises if an argument is of the wrong kind."""
    if not isinstance(structures, (list, tuple)):
        raise TypeError(f"structures = {brief(structures)}; allowed: a list of structures")
    if not structures:
        raise ValueError("structures = []; allowed: at least one structure")
    for number, structure in enumerate(structures, start=1):
        expect(structure, STRUCTURES, f"structures, number {number}")
    return check_links("links", links, len(structures))


def check_one_system(
    structures: Sequence[AnyStructure], ground: Ground, links: Sequence[Link | None]
) -> None:
    """Raise a ValueError if a parameter of an oscillator, the ground or a link is an array."""
    models: list[tuple[Model, str]] = [(ground, "ground")]
    models += [(s, f"structures, number {n}") for n, s in enumerate(structures, start=1)]
    models += [(link, f"links, number {n}") for n, link in enumerate(links, start=1) if link is not None]
    for model, role in models:
        if not isinstance(model, MultistoreyBuilding):
            check_scalars(model, role, ONE_SYSTEM)


@checked
def statespace(
    structures: Sequence[AnyStructure],
    ground: Ground,
    c_eq: Sequence[float] | None = None,
    k_eq: Sequence[float] | None = None,
    *,
    links: Sequence[Link | None] = (),
) -> xr.Dataset:
    """State matrix of linearized structures on one ground, eqs. (5), (6), (8), (11) and (12).

    An oscillator has the states ``u`` [m], ``v = u'`` [m/s] and ``z`` [m], the hysteretic displacement
    (here multiplied by the yield displacement), with ``z' = -c_eq v - k_eq z`` and
    ``u'' + 2 xi w u' + alpha w^2 u + (1 - alpha) w^2 z = f``. A building has these states for each
    floor, with ``z`` for the storey below it: ``z' = -c_eq d' - k_eq z`` with the drifts ``d = T u``,
    and ``M u'' + C u' + T' diag(alpha k) d + T' diag((1 - alpha) k) z = M 1 f``. With ``c_eq = -1`` and
    ``k_eq = 0`` an element is elastic (``z = d``). Elements without a strength have no state ``z``.

    Parameters
    ----------
    structures : sequence of Bilinear, BoucWen, Hysteretic or ShearBuilding
        The structures, with scalar parameters.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    c_eq, k_eq : sequence of float, optional
        Equivalent coefficients [-] and [1/s] of all elements, as `linearize` and `linearize_system`
        return them: oscillators and storeys from the first structure to the last, from the ground up,
        and after them the links that yield. Without them all elements are elastic.
    links : sequence of Link or None, optional
        Links from each structure to the next, or between the structures that the ``structures`` of a
        link name; oscillators then need a mass.

    Returns
    -------
    xarray.Dataset
        For ``x' = A x + b n(t)``: the matrix ``A``, ``state_matrix`` over (``state``, ``state_2``); the
        vector ``b``, ``noise_vector`` over ``state``; and the intensity ``2 pi S0`` of the white noise
        ``n``, ``noise_intensity`` [m^2/s^3]. Also ``extension`` over (``spring``, ``state``), which
        gives the drifts of storeys and the extensions of links from the states, and ``stiffness`` [N/m]
        over ``spring``, the elastic stiffness; and ``yield_displacement`` [m] over ``element``, by which
        `equivalent_coefficients` divides the moments, infinite without a strength. The names of the
        states of floor 3 of structure 2 end in ``_2.3``, those of oscillator 1 in ``_1``.

    Raises
    ------
    ValueError
        If there is no structure, a parameter is an array, the number of coefficients is not that of the
        elements, an element without a strength is to yield, or a link has an exponent.
    TypeError
        If an argument is of the wrong kind.
    ArithmeticError
        If the elastic response to which a ``reduction_factor`` refers cannot be computed.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (12).

    Examples
    --------
    The procedure of the paper: state matrix, covariance, coefficients, repeated.

    >>> import numpy as np, stochlin as sl
    >>> ground = sl.KanaiTajimi(period=0.42, damping=0.6)
    >>> pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.0, 0.7)]
    >>> space = sl.statespace(pair, ground)
    >>> space.state.values.tolist()
    ['xg', 'xg_rate', 'u_1', 'v_1', 'z_1', 'u_2', 'v_2', 'z_2']
    >>> v, z, uy = ["v_1", "v_2"], ["z_1", "z_2"], space.yield_displacement.values
    >>> for _ in range(30):
    ...     x = sl.stationary_covariance(space).to_pandas()
    ...     vv, zz, vz = (np.diag(x.loc[a, b]) for a, b in ((v, v), (z, z), (v, z)))
    ...     moments = np.sqrt(vv) / uy, np.sqrt(zz) / uy, vz / np.sqrt(vv * zz)
    ...     new = sl.equivalent_coefficients(*moments)
    ...     space = sl.statespace(pair, ground, new.c_eq, new.k_eq)
    >>> rho = x.at["u_1", "u_2"] / np.sqrt(x.at["u_1", "u_1"] * x.at["u_2", "u_2"])
    >>> bool(abs(rho - sl.correlate(*pair, ground).rho) < 1e-9)
    True
    """
    links = checked_system(structures, ground, links)
    check_one_system(structures, ground, links)
    for number, link in enumerate(links, start=1):
        if link is not None and link.is_power_law:
            raise ValueError(
                f"links, number {number}: damping_exponent = {link.exponent:g}; allowed: 1, since this "
                "is a linear system. Give the link the equivalent_damping_constant of linearize_system"
            )
    equations = Equations(
        arrangement_of([strength_in_metres(s, ground) for s in structures], links), ground
    )
    elements, strength, own = equations.reported_names, equations.strength[0], equations.yields
    c, k = (
        equations.from_reported(_of_elements(name, values, elastic, elements), elastic)
        for name, values, elastic in (("c_eq", c_eq, -1.0), ("k_eq", k_eq, 0.0))
    )
    if (elastic := ~own & ((c != -1) | (k != 0))).any():
        raise ValueError(
            f"element {equations.springs[int(np.argmax(elastic))]} has no strength, so that it stays "
            "elastic; allowed: c_eq = -1 and k_eq = 0, or a structure with a yield displacement"
        )
    written = equations.state_space(c, k, own)
    names, order = equations.states(own)
    extension = np.zeros((len(equations.springs), len(names)))
    extension[:, written.blocks[1]] = written.extensions
    space = xr.Dataset(
        {
            "state_matrix": (("state", "state_2"), written.matrix[0][order[:, None], order]),
            "noise_vector": ("state", written.noise[0][order]),
            "noise_intensity": ((), written.intensity[0], {"units": "m^2/s^3"}),
            "extension": (("spring", "state"), extension[:, order]),
            "stiffness": ("spring", written.stiffness[0], {"units": "N/m"}),
            "yield_displacement": ("element", equations.reported(strength, np.inf), {"units": "m"}),
        },
        coords={"state": names, "state_2": names, "spring": equations.springs, "element": elements},
    )
    models = {f"structure_{n}": s for n, s in enumerate(structures, start=1)} | {"ground": ground}
    return labels.with_run_information(
        space,
        f"State space of {len(structures)} linearized structures, {ground.name} ground",
        "statespace()",
        models | {f"link_{n}": link for n, link in enumerate(links, start=1) if link is not None},
    )


def _of_elements(
    name: str, values: Sequence[float] | None, elastic: float, elements: Sequence[str]
) -> Array:
    """The coefficients of all elements; ``elastic`` if there are none."""
    allowed = f"{len(elements)} finite numbers, for the elements {', '.join(elements)}"
    array = as_numbers(name, [elastic] * len(elements) if values is None else values, allowed)
    if array.shape != (len(elements),) or not np.isfinite(array).all():
        raise ValueError(f"{name} = {brief(values)}; allowed: {allowed}")
    return array.astype(float)


@checked
def stationary_covariance(space: xr.Dataset) -> xr.DataArray:
    """Covariance ``X`` of the states, from ``A X + X A' + 2 pi S0 b b' = 0``.

    Parameters
    ----------
    space : xarray.Dataset
        Dataset of `statespace`.

    Returns
    -------
    xarray.DataArray
        Covariance over (``state``, ``state_2``), in the products of the units of the states.

    Raises
    ------
    ArithmeticError
        If the matrix is not stable, or so close to instability that the result is inaccurate.
    TypeError
        If ``space`` is not a dataset of `statespace`.

    Notes
    -----
    For small ``k_eq`` the equation is nearly singular, and a solution can be wrong although its residual
    is tiny. The equation is therefore solved for drifts ``d`` and slips ``y = d - z``, balanced, and
    refined iteratively from the residual. Twelve digits are correct down to ``k_eq`` of 1e-12 times the
    frequency. Below 1e-13 times the frequency, ``z = -c_eq d`` is used.

    References
    ----------
    Bartels, R. H. and Stewart, G. W. (1972), Commun. ACM 15, for the solver;
    Higham, N. J. (2002), Accuracy and Stability of Numerical Algorithms, for the refinement.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> one = sl.Bilinear(period=2 * np.pi, damping=0.05)
    >>> space = sl.statespace([one], sl.WhiteNoise(0.1 / np.pi), c_eq=[-1], k_eq=[0])
    >>> round(float(sl.stationary_covariance(space).sel(state="u_1", state_2="u_1")), 12)
    1.0
    """
    if not isinstance(space, xr.Dataset) or "state_matrix" not in space or "extension" not in space:
        raise TypeError(f"space = {brief(space)}; allowed: the dataset that statespace returns")
    names = [str(name) for name in space.state.values]
    springs = [str(name) for name in space.spring.values]
    kind = np.array([{"u_": 1, "v_": 2, "z_": 3}.get(name[:2], 0) for name in names])
    order = np.argsort(kind, kind="stable")
    inside = space.isel(state=order, state_2=order)
    response = StationaryResponse(
        StateSpace(
            inside.state_matrix.values[None],
            inside.noise_vector.values[None],
            np.array([float(space.noise_intensity)]),
            np.array([springs.index(names[n][2:]) for n in np.flatnonzero(kind == 3)], int),
            space.extension.values[:, kind == 1],
            space.stiffness.values[None],
        )
    )
    if not np.isfinite(response.covariance).all():
        raise ArithmeticError(INACCURATE if response.stable[0] else UNSTABLE)
    back = np.argsort(order)
    return xr.DataArray(
        response.covariance[0][back[:, None], back],
        dims=("state", "state_2"),
        coords={name: space.coords[name] for name in ("state", "state_2")},
        name="covariance",
    )
