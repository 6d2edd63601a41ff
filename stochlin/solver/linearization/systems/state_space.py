"""State matrix of any number of linearized structures on one ground, and its stationary covariance.

`correlate` has a faster method for pairs of oscillators without links.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.gaussian import gaussian
from stochlin.kernels.linearization.systems.lyapunov import INACCURATE, UNSTABLE
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.springs import SpringLaw, Springs
from stochlin.kernels.linearization.systems.state_space import StateSpace, state_space
from stochlin.messages import brief
from stochlin.models.arguments import as_numbers, checked
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.parameters import Model, expect
from stochlin.models.structures import GAUSSIAN, AnyStructure
from stochlin.models.systems import Assembly, assembly_of, check_links
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

LINK_PREFIX = "link_"
ONE_SYSTEM = "a scalar, since this describes one system"


def problem_of(models: Mapping[str, Any], *, in_time: bool = False) -> tuple[Assembly, Springs]:
    """The `models_of` a system, or all cells, with strengths in metres; and what is linearized.

    In time, laws may have further states.
    """
    ground = models["ground"]
    values = models["ground"].arrays()
    structures = [
        strength_in_metres(m, ground) for m in models.values() if isinstance(m, AnyStructure)
    ]
    numbers = [
        int(role.removeprefix(LINK_PREFIX)) for role in models if role.startswith(LINK_PREFIX)
    ]
    placed_links = [models.get(f"{LINK_PREFIX}{n}") for n in range(1, 1 + max(numbers, default=0))]
    system = assembly_of(structures, placed_links)
    links = [placed.link.parts for placed in system.placed_links]
    shapes = [stick.system.mass.shape[:-1] for stick in system.sticks]
    shapes += [np.shape(value) for value in (*sum(links, ()), *values.values())]
    cells = math.prod(np.broadcast_shapes(*shapes))
    rows = [[np.broadcast_to(value, cells) for value in link] for link in links]
    columns = np.array(rows).reshape(len(rows), 5, cells).transpose(1, 2, 0)
    mass, damping, _, floors, *storeys = system.storeys.over_cells(cells)
    elements = [np.concatenate(both, axis=1) for both in zip(storeys, columns[:3], strict=True)]
    springs = System(mass, damping, system.extensions, floors, *elements)
    soil = ground.filter({name: np.broadcast_to(value, cells) for name, value in values.items()})
    # A strength that could not be computed is NaN.
    yielding = np.flatnonzero(~np.isposinf(springs.strength).all(axis=0))
    dashpots, exponents = columns[3:]
    power = np.flatnonzero(((exponents != 1) & (dashpots > 0)).any(axis=0))
    laws = _laws_of(system, cells, yielding.size, in_time)
    level = np.zeros(cells)
    return system, Springs(springs, soil, yielding, laws, dashpots, exponents, power, level)


def _laws_of(system: Assembly, cells: int, springs: int, in_time: bool) -> list[SpringLaw]:
    """Laws of so many springs that yield: those of structures, and of links the bilinear one."""
    laws = list[SpringLaw]()
    begin = 0
    for stick in system.sticks:
        mine = begin + np.arange(stick.yields.sum())
        if mine.size:
            values = stick.law_parameters[..., stick.yields, :]
            wide = np.broadcast_to(values, (cells, mine.size, values.shape[-1]))
            closures = stick.law.closure_in_time() if in_time else (stick.law.closure(GAUSSIAN),)
            laws.append(SpringLaw(mine, np.moveaxis(wide, -1, 0), *closures))
        begin += mine.size
    links = np.arange(begin, springs)
    return (
        [*laws, SpringLaw(links, np.empty((0, cells, links.size)), gaussian)]
        if links.size
        else laws
    )


def state_names(system: Assembly, problem: Springs) -> list[str]:
    """Names of the states: those of the ground, then displacements, velocities and ``z``."""
    names = [
        *problem.soil.states,
        *(f"{state}_{name}" for state in "uv" for name in system.coordinates),
    ]
    return [*names, *(f"z_{system.springs[spring]}" for spring in problem.yielding)]


def models_of(
    structures: Sequence[AnyStructure], ground: Ground, links: Sequence[Link | None] = ()
) -> dict[str, Model]:
    """Structures, ground and links by name; raises if an argument is of the wrong kind."""
    if not isinstance(structures, (list, tuple)):
        raise TypeError(f"structures = {brief(structures)}; allowed: a list of structures")
    if not structures:
        raise ValueError("structures = []; allowed: at least one structure")
    for number, structure in enumerate(structures, start=1):
        expect(structure, AnyStructure, f"structures, number {number}")
    return labels.named_models(structures, ground, check_links("links", links, len(structures)))


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

    An oscillator has the states ``u`` [m], ``v = u'`` [m/s] and ``z`` [m], the hysteretic
    displacement (here multiplied by the yield displacement), with ``z' = -c_eq v - k_eq z`` and
    ``u'' + 2 xi w u' + alpha w^2 u + (1 - alpha) w^2 z = f``. A building has these states for each
    floor, with ``z`` for the storey below it: ``z' = -c_eq d' - k_eq z`` with the drifts ``d = T
    u``, and ``M u'' + C u' + T' diag(alpha k) d + T' diag((1 - alpha) k) z = M 1 f``. With ``c_eq =
    -1`` and ``k_eq = 0`` an element is elastic (``z = d``). Elements without a strength have no
    state ``z``.

    Parameters
    ----------
    structures : sequence of Bilinear, BoucWen, Hysteretic or ShearBuilding
        The structures, with scalar parameters.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground, with scalar parameters.
    c_eq, k_eq : sequence of float, optional
        Equivalent coefficients [-] and [1/s] of all elements, as `linearize` and `linearize_system`
        return them: oscillators and storeys from the first structure to the last, from the ground
        up, and after them the links that yield. Without them all elements are elastic.
    links : sequence of Link or None, optional
        Links from each structure to the next, or between the structures that the ``structures`` of
        a link name; oscillators then need a mass.

    Returns
    -------
    xarray.Dataset
        For ``x' = A x + b n(t)``: the matrix ``A``, ``state_matrix`` over (``state``, ``state_2``);
        the vector ``b``, ``noise_vector`` over ``state``; and the intensity ``2 pi S0`` of the
        white noise ``n``, ``noise_intensity`` [m^2/s^3]. Also ``extension`` over (``spring``,
        ``state``), which gives the drifts of storeys and the extensions of links from the states,
        and ``stiffness`` [N/m] over ``spring``, the elastic stiffness; and ``yield_displacement``
        [m] over ``element``, by which `equivalent_coefficients` divides the moments, infinite
        without a strength. The names of the states of floor 3 of structure 2 end in ``_2.3``, those
        of oscillator 1 in ``_1``.

    Raises
    ------
    ValueError
        If there is no structure, a parameter is an array, the number of coefficients is not that of
        the elements, an element without a strength is to yield, or a link has an exponent.
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
    ['xg', 'xg_rate', 'u_1', 'u_2', 'v_1', 'v_2', 'z_1', 'z_2']
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
    models = models_of(structures, ground, links)
    for role, model in models.items():
        check_scalars(model, role, ONE_SYSTEM)
        if isinstance(model, Link) and model.is_power_law:
            what = f"{role}: damping_exponent = {model.exponent:g}; allowed: 1"
            raise ValueError(f"{what}, with the equivalent_damping_constant of linearize_system")
    system, problem = problem_of(models)
    elements = [*system.watched, *(system.springs[link] for link in system.yielding_links)]
    numbers = np.concatenate([system.of_watched, system.yielding_links])
    coefficients = np.tile([[-1.0], [0.0]], len(system.springs))
    for row, name, values in zip(coefficients, ("c_eq", "k_eq"), (c_eq, k_eq), strict=True):
        if values is not None:
            row[numbers[numbers >= 0]] = _of_elements(name, values, elements)[numbers >= 0]
    elastic = np.delete(coefficients, problem.yielding, axis=1) != [[-1.0], [0.0]]
    if elastic.any():
        first = np.delete(system.springs, problem.yielding)[elastic.any(axis=0)][0]
        what = f"element {first} has no strength, so that it stays elastic"
        raise ValueError(f"{what}; allowed: c_eq = -1 and k_eq = 0, or a yield displacement")
    c, k = coefficients[:, None, problem.yielding]
    written = state_space(problem, c, k, problem.dashpots)
    names = state_names(system, problem)
    extension = np.zeros((len(system.springs), len(names)))
    extension[:, written.blocks[1]] = written.extensions
    strength = in_elements(system, problem.system.strength, np.inf, np.inf)[0]
    space = xr.Dataset(
        {
            "state_matrix": (("state", "state_2"), written.matrix[0]),
            "noise_vector": ("state", written.noise[0]),
            "noise_intensity": ((), written.intensity[0], {"units": "m^2/s^3"}),
            "extension": (("spring", "state"), extension),
            "stiffness": ("spring", written.stiffness[0], {"units": "N/m"}),
            "yield_displacement": ("element", strength, {"units": "m"}),
        },
        coords={"state": names, "state_2": names, "spring": system.springs, "element": elements},
    )
    return labels.with_run_information(
        space,
        f"State space of {len(structures)} linearized structures, {ground.name} ground",
        "statespace()",
        models,
    )


def _of_elements(name: str, values: Sequence[float], elements: Sequence[str]) -> Array:
    """The coefficients of all elements, checked."""
    allowed = f"{len(elements)} finite numbers, for the elements {', '.join(elements)}"
    array = as_numbers(name, values, allowed)
    if array.shape != (len(elements),) or not np.isfinite(array).all():
        raise ValueError(f"{name} = {brief(values)}; allowed: {allowed}")
    return array


def in_elements(system: Assembly, values: Array, elastic: float, unknown: float) -> Array:
    """Values (c, s) of the springs for the elements of results; see `Assembly.of_elements`."""
    of_elements = system.of_elements(values, elastic, unknown)
    return np.concatenate([of_elements, values[:, system.yielding_links]], axis=1)


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
    For small ``k_eq`` the equation is nearly singular, and a solution can be wrong although its
    residual is tiny. The equation is therefore solved for drifts ``d`` and slips ``y = d - z``,
    balanced, and refined iteratively from the residual. Twelve digits are correct down to ``k_eq``
    of 1e-12 times the frequency. Below 1e-13 times the frequency, ``z = -c_eq d`` is used.

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
    kinds = space.state.str[:2]
    springs = space.indexes["spring"].get_indexer(space.state[kinds == "z_"].str[2:])
    response = StationaryResponse(
        StateSpace(
            space.state_matrix.values[None],
            space.noise_vector.values[None],
            space.noise_intensity.values[None],
            springs,
            space.extension[:, kinds == "u_"].values,
            space.stiffness.values[None],
        )
    )
    if not np.isfinite(response.covariance).all():
        raise ArithmeticError(INACCURATE if response.stable[0] else UNSTABLE)
    return xr.DataArray(
        response.covariance[0],
        dims=("state", "state_2"),
        coords={name: space.coords[name] for name in ("state", "state_2")},
        name="covariance",
    )
