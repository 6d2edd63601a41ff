"""State matrix of any number of linearized structures on one ground, and its stationary covariance.

`correlate` has a faster method for pairs of oscillators without links; its tests compare both.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import as_numbers, check_scalars
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.augmented import Augmented, Solved
from stochlin.messages import brief
from stochlin.models.buildings import ShearBuilding
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure
from stochlin.models.systems import (
    STRUCTURES,
    AnyStructure,
    System,
    check_links,
    system_of,
)

ONE_SYSTEM = "a scalar, since this describes one system"


@dataclass(frozen=True)
class Equations:
    """Eqs. (5), (6), (8), (11) and (12) of structures on one ground.

    The springs (s) are the storeys and, after them, the links (t). The elements (e) are the springs that
    can have a hysteresis law: the storeys and the links that yield. There are n floors.
    """

    system: System
    ground: Ground

    @cached_property
    def springs(self) -> list[str]:
        """Names of the springs."""
        return [*self.system.floors, *(tie.name for tie in self.system.ties)]

    @cached_property
    def elements(self) -> Array:
        """Numbers of the springs that are elements (e,)."""
        n, ties = len(self.system.floors), self.system.ties
        return np.array([*range(n), *(n + i for i, tie in enumerate(ties) if tie.link.yields)])

    @cached_property
    def strength(self) -> Array:
        """Yield drifts of the elements (e,) [m], infinite if elastic."""
        return np.append(self.system.all("strength"), self._of_links("yield_displacement", yields=True))

    @cached_property
    def extensions(self) -> Array:
        """Factors (s, n) that give the extensions of the springs from the floor displacements."""
        return self.system.extensions

    def states(self, own: Array) -> list[str]:
        """Names of the states, by structures, links last; elements with ``own`` (e,) have a ``z``."""
        floors, first = self.system.floors, self.system.first
        names = [self.springs[spring] for spring in self.elements[own]]
        listed = list(self.ground.lone_filter().states)
        for begin, end in pairwise(first):
            here = floors[begin:end]
            listed += [f"{state}_{name}" for state in "uv" for name in here]
            listed += [f"z_{name}" for name in here if name in names]
        return listed + [f"z_{name}" for name in names if name not in floors]

    @cached_property
    def dashpots(self) -> Array:
        """Damping constants of the links (t,), in N s/m for the exponent 1."""
        return self._of_links("damping_constant")

    @cached_property
    def exponents(self) -> Array:
        """Exponents of the dashpots of the links (t,)."""
        return np.array([tie.link.exponent for tie in self.system.ties], float)

    def augmented(
        self, c_eq: Array, k_eq: Array, own: Array, dashpots: Array | None = None
    ) -> Augmented:
        """Linear system for coefficients of the elements (e,); those with ``own`` have a state ``z``.

        ``dashpots`` (t,) [N s/m] replace the damping constants of the links.
        """
        soil, n = self.ground.lone_filter(), len(self.system.floors)
        names = {name: i for i, name in enumerate(self.states(own))}
        springs = self.elements[own]
        u, v = (np.array([names[f"{s}_{floor}"] for floor in self.system.floors]) for s in "uv")
        z = np.array([names[f"z_{self.springs[spring]}"] for spring in springs], int)
        q = np.arange(len(soil.states))
        mass, t = self.system.all("mass")[:, None], self.extensions
        dampers = self.dashpots if dashpots is None else dashpots
        links = t[n:]
        damping = self.system.damping + (links.T * dampers) @ links
        stiffness = self.stiffness.copy()
        stiffness[springs] = self._post[springs]

        matrix, noise = np.zeros((len(names), len(names))), np.zeros(len(names))
        matrix[np.ix_(q, q)], noise[q], output = soil.arrays
        matrix[u, v] = 1.0
        matrix[np.ix_(v, q)] = output
        matrix[np.ix_(v, u)] = -((t.T * stiffness) @ t) / mass
        matrix[np.ix_(v, v)] = -damping / mass
        matrix[np.ix_(v, z)] = -(t.T * self._couple)[:, springs] / mass
        matrix[np.ix_(z, v)] = -c_eq[own, None] * t[springs]
        matrix[z, z] = -k_eq[own]
        if not q.size:
            noise[v] = 1.0
        of_noise = 2 * np.pi * float(self.ground.arrays()["intensity"])
        matrix += 0.0  # turns negative zeros, which a table would show, into 0
        return Augmented(matrix, noise, of_noise, u, v, z, springs, t, self.stiffness)

    @cached_property
    def stiffness(self) -> Array:
        """Elastic stiffness of the springs (s,) [N/m]."""
        return self._post + self._couple

    @property
    def of_links(self) -> tuple[Array, Array]:
        """Stiffness [N/m] of the links (t,) after yield, and that lost by yielding."""
        n = len(self.system.floors)
        return self._post[n:], self._couple[n:]

    @cached_property
    def _post(self) -> Array:
        return np.append(self.system.all("post"), [tie.link.spring[0] for tie in self.system.ties])

    @cached_property
    def _couple(self) -> Array:
        return np.append(self.system.all("couple"), [tie.link.spring[1] for tie in self.system.ties])

    def _of_links(self, name: str, *, yields: bool = False) -> Array:
        """Values of a parameter of all links, or of those that yield."""
        ties = [tie for tie in self.system.ties if tie.link.yields or not yields]
        return np.array([tie.link.number(name) for tie in ties], float)


def checked_system(
    structures: Sequence[AnyStructure], ground: Ground, links: Sequence[Link | None]
) -> tuple[Link | None, ...]:
    """The links; raises if an argument is of the wrong kind or an array, or a link has slack."""
    expect(ground, Ground, "ground")
    if not isinstance(structures, (list, tuple)):
        raise TypeError(f"structures = {brief(structures)}; allowed: a list of structures")
    if not structures:
        raise ValueError("structures = []; allowed: at least one structure")
    for number, structure in enumerate(structures, start=1):
        expect(structure, STRUCTURES, f"structures, number {number}")
        if isinstance(structure, Structure):
            check_scalars(structure, f"structures, number {number}", ONE_SYSTEM)
    check_scalars(ground, "ground", ONE_SYSTEM)
    links = check_links("links", links, len(structures))
    for number, link in enumerate(links, start=1):
        if link is not None:
            check_scalars(link, f"links, number {number}", ONE_SYSTEM)
            if link.slack is not None:
                raise ValueError(
                    f"links, number {number}: slack = {link.slack:g}; allowed: none, since a link with "
                    "slack only pulls, and linearization requires forces with zero mean; use simulate"
                )
    return links


def statespace(
    structures: Sequence[AnyStructure],
    ground: Ground,
    c_eq: Sequence[float],
    k_eq: Sequence[float],
    *,
    links: Sequence[Link | None] = (),
) -> xr.Dataset:
    """State matrix of linearized structures on one ground, eqs. (5), (6), (8), (11) and (12).

    An oscillator has the states ``u`` [m], ``v = u'`` [m/s] and ``z`` [m], the hysteretic displacement
    (here multiplied by the yield displacement), with ``z' = -c_eq v - k_eq z`` and
    ``u'' + 2 xi w u' + alpha w^2 u + (1 - alpha) w^2 z = f``. A building has these states for each
    floor, with ``z`` for the storey below it: ``z' = -c_eq d' - k_eq z`` with the drifts ``d = T u``,
    and ``M u'' + C u' + T' diag(alpha k) d + T' diag((1 - alpha) k) z = M 1 f``. An element with
    ``c_eq = -1`` and ``k_eq = 0`` is elastic (``z = d``). It has no state ``z``, with which the Lyapunov
    equation would be singular.

    Parameters
    ----------
    structures : sequence of Bilinear, BoucWen, Hysteretic or ShearBuilding
        The structures, with scalar parameters.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    c_eq, k_eq : sequence of float
        Equivalent coefficients [-] and [1/s] of all elements, as `linearize` and `linearize_system`
        return them: oscillators and storeys from the first structure to the last, from the ground up,
        and after them the links that yield.
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
        over ``spring``, the elastic stiffness. The names of the states of floor 3 of structure 2 end in
        ``_2.3``, those of oscillator 1 in ``_1``.

    Raises
    ------
    ValueError
        If there is no structure, a parameter is an array, the number of coefficients is not that of the
        elements, or a link has slack or an exponent.
    TypeError
        If an argument is of the wrong kind.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (12).

    Examples
    --------
    >>> import stochlin as sl
    >>> pair = [sl.Bilinear(period=T, damping=0.05) for T in (1.0, 2.0)]
    >>> space = sl.statespace(pair, sl.KanaiTajimi(2.0, 0.05), c_eq=[-1, -1], k_eq=[0, 0])
    >>> space.state.values.tolist()
    ['xg', 'xg_rate', 'u_1', 'v_1', 'u_2', 'v_2']
    """
    links = checked_system(structures, ground, links)
    for number, link in enumerate(links, start=1):
        if link is not None and link.is_power_law:
            raise ValueError(
                f"links, number {number}: damping_exponent = {link.exponent:g}; allowed: 1, since this "
                "is a linear system. Give the link the equivalent_damping_constant of linearize_system"
            )
    given = []
    for name, values in (("c_eq", c_eq), ("k_eq", k_eq)):
        given.append(as_numbers(name, values, "a number for every element").astype(float))
        if given[-1].ndim != 1:
            raise ValueError(f"{name} = {brief(values)}; allowed: a number for every element")
        if not np.isfinite(given[-1]).all():
            raise ValueError(f"{name} = {brief(list(values))}; allowed: finite numbers")
    equations = Equations(system_of([_of_any_strength(s) for s in structures], links), ground)
    elements = [equations.springs[spring] for spring in equations.elements]
    if not len(c_eq) == len(k_eq) == len(elements):
        raise ValueError(
            f"c_eq, k_eq have lengths {len(c_eq)}, {len(k_eq)}; allowed: {len(elements)}, one of each "
            f"kind for every element, {brief(elements)}"
        )
    own = (given[0] != -1) | (given[1] != 0)
    for element in np.flatnonzero(own[: len(equations.system.floors)]):
        number = int(np.searchsorted(equations.system.first, element, side="right"))
        structure = structures[number - 1]
        if structure.hardening is None:
            raise ValueError(
                f"{type(structure).__name__}, number {number}: hardening is not given; with c_eq = "
                f"{given[0][element]:g}, k_eq = {given[1][element]:g} it yields, and needs its hardening"
            )
    written, names = equations.augmented(given[0], given[1], own), equations.states(own)
    extension = np.zeros((len(equations.springs), len(names)))
    extension[:, written.displacements] = written.extensions
    space = xr.Dataset(
        {
            "state_matrix": (("state", "state_2"), written.matrix),
            "noise_vector": ("state", written.noise),
            "noise_intensity": ((), written.intensity, {"units": "m^2/s^3"}),
            "extension": (("spring", "state"), extension),
            "stiffness": ("spring", written.stiffness, {"units": "N/m"}),
        },
        coords={"state": names, "state_2": names, "spring": equations.springs},
    )
    models = {f"structure_{n}": s for n, s in enumerate(structures, start=1)} | {"ground": ground}
    return labels.with_run_information(
        space,
        f"State space of {len(structures)} linearized structures, {ground.name} ground",
        "statespace()",
        models | {f"link_{n}": link for n, link in enumerate(links, start=1) if link is not None},
    )


def _of_any_strength(structure: AnyStructure) -> Any:
    """The structure with some strength if it can yield; the equations do not depend on its value."""
    if structure.hardening is None:
        return structure
    if isinstance(structure, ShearBuilding):
        return replace(structure, yield_drifts=1.0)
    return replace(structure, yield_displacement=1.0, reduction_factor=None)


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
    u, v, z = (np.array([n for n, name in enumerate(names) if name[:2] == f"{k}_"], int) for k in "uvz")
    system = Augmented(
        space.state_matrix.values,
        space.noise_vector.values,
        float(space.noise_intensity),
        u,
        v,
        z,
        np.array([springs.index(names[n][2:]) for n in z], int),
        space.extension.values[:, u],
        space.stiffness.values,
    )
    return xr.DataArray(
        Solved(system).covariance,
        dims=("state", "state_2"),
        coords={name: space.coords[name] for name in ("state", "state_2")},
        name="covariance",
    )
