"""The whole problem as one linear system: the readable definition, and the oracle of the fast path.

Any number of structures stand on one ground. Without links they act on one another in no way, and
`correlate` is the quick road to their correlation; linked ones are solved here.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import scipy.linalg
import xarray as xr

from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import as_numbers
from stochlin.messages import brief
from stochlin.models.grounds import Ground
from stochlin.models.links import Link, check_linked
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure

FloatArray = npt.NDArray[np.float64]

UNSTABLE = "state_matrix is not stable; allowed: eigenvalues with negative real parts"
ROUNDING = 1e-12  # share of the largest coefficient that an eigenvalue may miss 0 by


def statespace(
    structures: Sequence[Structure],
    ground: Ground,
    c_eq: Sequence[float],
    k_eq: Sequence[float],
    *,
    links: Sequence[Link] = (),
) -> xr.Dataset:
    """Augmented state matrix of linearized structures on one ground: eqs. (5), (6), (8), (11), (12).

    Each structure has the states ``u`` [m], ``v = u'`` [m/s] and ``z`` (times the yield
    displacement, [m]):
    ``u'' + 2 xi w u' + alpha w^2 u + (1 - alpha) w^2 z = f``, ``z' = -c_eq v - k_eq z``. In the
    elastic limit, ``c_eq = -1`` and ``k_eq = 0`` (which is ``z = u``), it has only the first
    two: with ``z`` the Lyapunov equation would be singular.

    Parameters
    ----------
    structures : sequence of Bilinear, BoucWen or Hysteretic
        With scalar parameters.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        With scalar parameters.
    c_eq, k_eq : sequence of float
        Equivalent coefficients [-] and [1/s], one each a structure, as `linearize` returns them.
    links : sequence of Link, optional
        From each structure to the next; the structures then need a mass.

    Returns
    -------
    xarray.Dataset
        ``state_matrix`` over (``state``, ``state_2``), ``noise_vector`` over ``state``, and
        ``noise_intensity`` ``2 pi S0`` [m^2/s^3]: ``x' = A x + b n(t)``.

    Raises
    ------
    ValueError
        If there is no structure, a parameter is an array, or the coefficients are not one a structure.

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
    expect(ground, Ground, "ground")
    for name, given, kind in (("structures", structures, Structure), ("links", links, Link)):
        if not isinstance(given, (list, tuple)):
            raise TypeError(f"{name} = {brief(given)}; allowed: a list of {name}")
        for n, one in enumerate(given, start=1):
            expect(one, kind, f"{name}, number {n}")
    for name, values in (("c_eq", c_eq), ("k_eq", k_eq)):
        if as_numbers(name, values, "a number for every structure").ndim != 1:
            raise ValueError(f"{name} = {brief(values)}; allowed: a number for every structure")
    if not structures or not len(structures) == len(c_eq) == len(k_eq):
        raise ValueError(
            f"structures, c_eq, k_eq have lengths {len(structures)}, {len(c_eq)}, {len(k_eq)}; allowed: "
            "at least one structure, and one coefficient of each kind for every structure"
        )
    if not np.isfinite([*c_eq, *k_eq]).all():
        raise ValueError(
            f"c_eq = {brief(list(c_eq))}, k_eq = {brief(list(k_eq))}; allowed: finite numbers"
        )
    for name in ground.arrays():
        _scalar(ground, name)
    soil = ground.lone_filter()
    names, (matrix, noise, output) = list(soil.states), soil.arrays
    for number, (structure, c, k) in enumerate(zip(structures, c_eq, k_eq, strict=True), start=1):
        block, states = _structure_matrix(structure, c, k)
        names += [f"{state}_{number}" for state in states]
        coupling = np.zeros((len(states), len(matrix)))
        coupling[1, : output.size] = output
        matrix = np.block([[matrix, np.zeros((len(matrix), len(states)))], [coupling, block]])
        force = np.zeros(len(states))
        force[1] = 0.0 if output.size else 1.0
        noise = np.append(noise, force)
    _add_links(matrix, names, structures, links)
    space = xr.Dataset(
        {
            "state_matrix": (("state", "state_2"), matrix),
            "noise_vector": ("state", noise),
            "noise_intensity": ((), 2 * np.pi * _scalar(ground, "intensity"), {"units": "m^2/s^3"}),
        },
        coords={"state": names, "state_2": names},
    )
    return labels.with_run_information(
        space,
        f"State space of {len(structures)} linearized structures, {ground.name} ground",
        "statespace()",
        {f"structure_{n}": s for n, s in enumerate(structures, start=1)} | {"ground": ground},
    )


def _add_links(
    matrix: FloatArray, names: list[str], structures: Sequence[Structure], links: Sequence[Link]
) -> None:
    """Write the forces of the links over the masses into the rows of the velocities."""
    if links and len(links) != len(structures) - 1:
        raise ValueError(
            f"links has length {len(links)}; allowed: none, or one fewer than structures, "
            f"{len(structures) - 1}"
        )
    for number, link in enumerate(links, start=1):
        masses = check_linked(*structures[number - 1 : number + 1])
        constants = {"u": _link(link, "stiffness"), "v": _link(link, "damping_constant")}
        for own, other, mass in ((number, number + 1, masses[0]), (number + 1, number, masses[1])):
            row = names.index(f"v_{own}")
            for state, constant in constants.items():
                matrix[row, names.index(f"{state}_{own}")] -= constant / mass
                matrix[row, names.index(f"{state}_{other}")] += constant / mass


def _link(link: Link, name: str) -> float:
    value = link.arrays()[name]
    if value.ndim:
        raise ValueError(f"Link: {name} is an array; allowed here: a scalar")
    return float(value)


def stationary_covariance(space: xr.Dataset) -> xr.DataArray:
    """Covariance ``X`` of the states, from ``A X + X A' + 2 pi S0 b b' = 0``.

    Parameters
    ----------
    space : xarray.Dataset
        As `statespace` returns it.

    Returns
    -------
    xarray.DataArray
        Over (``state``, ``state_2``), in the products of the units of the states.

    Raises
    ------
    ArithmeticError
        If the matrix is not stable or the result is not a covariance: a small residual alone
        does not show that a Lyapunov solver was right.

    References
    ----------
    Bartels, R. H. and Stewart, G. W. (1972), Commun. ACM 15, for the solver.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> one = sl.Bilinear(period=2 * np.pi, damping=0.05)
    >>> space = sl.statespace([one], sl.WhiteNoise(0.1 / np.pi), c_eq=[-1], k_eq=[0])
    >>> round(float(sl.stationary_covariance(space).sel(state="u_1", state_2="u_1")), 12)
    1.0
    """
    if not isinstance(space, xr.Dataset) or "state_matrix" not in space:
        raise TypeError(f"space = {brief(space)}; allowed: the dataset that statespace returns")
    matrix = space.state_matrix.values
    drive = _drive(space)
    if np.linalg.eigvals(matrix).real.max() >= 0:
        raise ArithmeticError(UNSTABLE)
    return _as_covariance(scipy.linalg.solve_continuous_lyapunov(matrix, -drive), space)


def covariance_by_slip(space: xr.Dataset) -> xr.DataArray:
    """What `stationary_covariance` finds, to all digits where yielding dies out.

    The Lyapunov equation is nearly singular there. In terms of the slip ``y = u - z`` this concerns a
    few of its equations only; each is scaled by its largest coefficient, and elimination keeps the
    digits. For few states: the number of unknowns is that of the states squared.
    """
    names = list(space.state.values)
    turn = np.eye(len(names))  # from z to y, and back
    for n, name in enumerate(names):
        if str(name).startswith("z_"):
            turn[n, n], turn[n, names.index(f"u{name[1:]}")] = -1.0, 1.0
    matrix = turn @ space.state_matrix.values @ turn
    fastest = np.abs(matrix).max()
    if np.linalg.eigvals(matrix).real.max() > ROUNDING * fastest:
        raise ArithmeticError(UNSTABLE)
    identity = np.eye(len(names))
    equations = np.kron(matrix, identity) + np.kron(identity, matrix)
    right = -(turn @ _drive(space) @ turn.T).ravel()
    scale = np.abs(equations).max(axis=1)
    try:
        moments = np.linalg.solve(equations / scale[:, None], right / scale)
    except np.linalg.LinAlgError as error:
        raise ArithmeticError(UNSTABLE) from error
    return _as_covariance(turn @ moments.reshape(matrix.shape) @ turn.T, space)


def _drive(space: xr.Dataset) -> FloatArray:
    noise = space.noise_vector.values
    return float(space.noise_intensity) * np.outer(noise, noise)


def _as_covariance(moments: FloatArray, space: xr.Dataset) -> xr.DataArray:
    covariance = 0.5 * (moments + moments.T)
    scale = np.sqrt(np.abs(np.diag(covariance)))
    if np.linalg.eigvalsh(covariance / np.outer(scale, scale)).min() < -1e-8:
        raise ArithmeticError(
            "the Lyapunov solution is not a covariance: the system is too near singular"
        )
    return xr.DataArray(covariance, dims=("state", "state_2"), coords=space.coords, name="covariance")


def _structure_matrix(structure: Structure, c_eq: float, k_eq: float) -> tuple[FloatArray, list[str]]:
    w = 2 * np.pi / _scalar(structure, "period")
    damping = 2 * _scalar(structure, "damping") * w
    if c_eq == -1 and k_eq == 0:
        return np.array([[0, 1], [-(w**2), -damping]]), ["u", "v"]
    alpha = _scalar(structure, "hardening")
    motion = [-alpha * w**2, -damping, -(1 - alpha) * w**2]
    return np.array([[0, 1, 0], motion, [0, -c_eq, -k_eq]]), ["u", "v", "z"]


def _scalar(model: Structure | Ground, name: str) -> float:
    if name not in model.arrays():
        raise ValueError(f"{type(model).__name__}: {name} is not given; allowed here: a scalar")
    value = model.arrays()[name]
    if value.ndim:
        raise ValueError(
            f"{type(model).__name__}: {name} is an array over {value.dims}; allowed: a scalar, since "
            "this describes one system"
        )
    return float(value)
