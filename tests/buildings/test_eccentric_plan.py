"""A building whose plan turns: three slabs on eccentric columns, in numpy.

Each slab moves along the gap, across it and turns about its centre. A `ModalBuilding` of the corner
has only the motion along the gap there, and must move and pound like the whole.
"""

import itertools

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
import xarray as xr

import stochlin as sl

STOREY, WIDTH, DEPTH, XI = 3.6, 14.0, 20.0, 0.05  # m; width along the gap
MASSES = np.array([3e5, 3e5, 2.4e5])  # kg
# Columns: place (x, y) [m] from the centre of the slab, stiffness of a storey along and across the
# gap [N/m]. A solid wall at y = -10 m, an open front at y = 10 m.
COLUMNS = [
    *[(x, -10.0, 9e7, 2e7) for x in (-7.0, 0.0, 7.0)],
    (-7.0, 0.0, 2.5e7, 2.5e7),
    (7.0, 0.0, 2.5e7, 1.5e7),
    (-7.0, 10.0, 2e7, 3e7),
    *[(x, 10.0, 2e7, 2e7) for x in (0.0, 7.0)],
]
WALL, FRONT = -10.0, 10.0  # y of the corners
DT = 0.02
SAMPLES, FINE = DT * np.arange(301), DT / 10 * np.arange(3001)
SHAKING = 4.0 * np.sin(2 * np.pi * SAMPLES * (0.8 + 0.3 * SAMPLES)) * np.sin(np.pi * SAMPLES / 6)
MOTION = xr.DataArray(SHAKING, dims="time", coords={"time": SAMPLES}, attrs={"units": "m/s^2"})
TURNING = (WIDTH**2 + DEPTH**2) / 12  # square of the radius of gyration [m^2]
MASS = np.kron(MASSES, [1.0, 1.0, TURNING])
PUSHED = np.tile([1.0, 0.0, 0.0], 3)  # by the ground
SHEAR = sum(
    kx * np.outer(along, along) + ky * np.outer(across, across)
    for x, y, kx, ky in COLUMNS
    for along, across in [(np.array([1, 0, -y]), np.array([0, 1, x]))]
)
STIFFNESS = np.kron(np.array([[2, -1, 0], [-1, 2, -1], [0, -1, 1]]), SHEAR)
SQUARES, VECTORS = scipy.linalg.eigh(STIFFNESS, np.diag(MASS))
OWN = MASS[:, None] * VECTORS
DAMPING = OWN * (2 * XI * np.sqrt(SQUARES)) @ OWN.T
PERIODS, ALONG = 2 * np.pi / np.sqrt(SQUARES), VECTORS.T @ (MASS * PUSHED)
NEIGHBOUR = sl.ShearBuilding([2e5] * 3, [3e8, 2.5e8, 1.5e8], [STOREY] * 3, XI)
BESIDE = NEIGHBOUR.system()


def corner_rows(y: float) -> np.ndarray:
    """Displacement along the gap of the corners at ``y`` by the coordinates of the slabs."""
    return np.kron(np.eye(3), [1.0, 0.0, -y])


def by_modes(periods, shapes, factors, masses) -> sl.ModalBuilding:
    return sl.ModalBuilding(
        *(periods, shapes, MASSES, [STOREY] * 3, XI), participation=factors, modal_masses=masses
    )


def corner(y: float) -> sl.ModalBuilding:
    return by_modes(PERIODS, (corner_rows(y) @ VECTORS).T, ALONG, ALONG**2)


def exact_history(mass, damping, stiffness, pushed) -> np.ndarray:
    """Displacements at the fine times, for ground acceleration linear between the samples."""
    n, dt = mass.size, FINE[1]
    a = np.zeros((2 * n + 2, 2 * n + 2))
    a[:n, n : 2 * n] = np.eye(n)
    a[n : 2 * n, :n], a[n : 2 * n, n : 2 * n] = -stiffness / mass[:, None], -damping / mass[:, None]
    a[n : 2 * n, -2], a[-2, -1] = -pushed, 1.0
    move, state, found = scipy.linalg.expm(a * dt), np.zeros(2 * n + 2), np.zeros((FINE.size, n))
    ground = np.interp(FINE, SAMPLES, SHAKING)
    for i, (now, then) in enumerate(itertools.pairwise(ground), 1):
        state[-2:] = now, (then - now) / dt
        state = move @ state
        found[i] = state[:n]
    return found


HISTORY = exact_history(MASS, DAMPING, STIFFNESS, PUSHED)


@pytest.mark.parametrize("y", [WALL, FRONT])
def test_a_corner_moves_as_that_of_the_whole_plan(y: float) -> None:
    exact, table = HISTORY @ corner_rows(y).T, sl.respond(corner(y), MOTION)
    peaks = np.abs(exact).max(axis=0)
    np.testing.assert_allclose(table.displacement, exact[::10], rtol=0, atol=2e-4 * peaks[-1])
    mass, damping, *_ = BESIDE
    gaps = sl.recorded_gap(corner(y), NEIGHBOUR, MOTION)
    apart = exact - exact_history(mass, damping, BESIDE.stiffness, np.ones(3))
    np.testing.assert_allclose(gaps.separation_at_height, apart.max(axis=0), rtol=2e-4)
    np.testing.assert_allclose(gaps.separation, apart.max(), rtol=1e-4)
    np.testing.assert_allclose(gaps.peak_1, peaks[-1], rtol=1e-4)


@pytest.mark.extreme
def test_a_blow_at_a_corner_turns_the_plan() -> None:
    """Springs between the floors of the corner and a neighbour, by DOP853 of scipy."""
    gap, spring = 0.02, 2e7
    mass, pushed = np.append(MASS, BESIDE.mass), np.append(PUSHED, np.ones(3))
    stiffness = scipy.linalg.block_diag(STIFFNESS, BESIDE.stiffness)
    damping = scipy.linalg.block_diag(DAMPING, BESIDE.damping)
    row = np.hstack([corner_rows(FRONT), -np.eye(3)])

    def rate(t, state):
        q, v = state[:12], state[12:]
        force = spring * np.maximum(row @ q - gap, 0.0)
        ground = np.interp(t, SAMPLES, SHAKING)
        return np.append(v, (-damping @ v - stiffness @ q - row.T @ force) / mass - pushed * ground)

    solved = scipy.integrate.solve_ivp(
        rate,
        (0, SAMPLES[-1]),
        np.zeros(24),
        "DOP853",
        SAMPLES,
        max_step=DT / 2,
        rtol=1e-7,
        atol=1e-10,
    )
    table = sl.pound([corner(FRONT), NEIGHBOUR], gap, sl.LinearSpring(spring), MOTION)
    for n, exact in enumerate([corner_rows(FRONT) @ solved.y[:9], solved.y[9:12]], 1):
        ours, size = table.displacement.sel(structure=n).T, np.abs(exact).max()
        np.testing.assert_allclose(ours, exact, rtol=0, atol=1e-3 * size)
    alone = np.abs(HISTORY @ corner_rows(FRONT).T).max()
    assert abs(float(table.peak[0, -1]) / alone - 1) > 0.1  # so that the blows matter
