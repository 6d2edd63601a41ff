"""Linked buildings through a motion, with and without contact."""

import numpy as np
import pytest
import scipy.integrate
import scipy.linalg
from cases import assert_near
from motions import from_sample_to_sample, smooth_noise

import stochlin as sl

pytestmark = pytest.mark.oracle

FAR = 0.8  # [m]: no contact
SPRING = sl.LinearSpring(1e8)


def record(samples=300):
    return 2.0 * smooth_noise(samples, 7) / 3


def towers(**other):
    given = {"hardening": 0.05, "yield_drifts": 0.008} | other
    low = sl.ShearBuilding([2e5] * 2, [1e8, 8e7], [3.0] * 2, 0.05, **given)
    high = sl.ShearBuilding([2e5] * 4, [2e8] * 4, [3.2] * 4, 0.05, **given)
    return [low, high]


def integrated(row, motion, links):
    """Displacements by scipy, storeys and links as written, from kink to kink of the ground.

    ``links``: pairs of floors and functions of stretch, rate and slip to force and rate of slip.
    """
    first = np.concatenate([[0], np.cumsum([s.storeys for s in row])])
    n = first[-1]
    values = [{name: a.to_numpy() for name, a in s.arrays().items()} for s in row]
    mass, k = (np.concatenate([v[name] for v in values]) for name in ("masses", "stiffnesses"))
    uy = np.concatenate([np.broadcast_to(v["yield_drifts"], v["masses"].size) for v in values])
    alpha = np.repeat([float(v["hardening"]) for v in values], np.diff(first))
    weight = np.concatenate([s.geometric_stiffness() for s in row])
    damping = scipy.linalg.block_diag(*[s.damping_matrix() for s in row])
    lift = np.eye(n) - np.eye(n, k=-1)
    lift[first[1:-1], first[1:-1] - 1] = 0.0

    def rates(t, x, ground, slope):
        u, v, y = x[: 3 * n].reshape(3, n)
        drift, pace = lift @ u, lift @ v
        shear = (alpha * k - weight) * drift + (1 - alpha) * k * np.clip(y, -uy, uy)
        force = -lift.T @ shear - damping @ v - mass * (ground + slope * t)
        slips = np.zeros(len(links))
        for j, (one, two, law) in enumerate(links):
            pull, slips[j] = law(u[one] - u[two], v[one] - v[two], x[3 * n + j])
            force[one] -= pull
            force[two] += pull
        return np.concatenate(
            [v, force / mass, np.where((abs(y) >= uy) & (y * pace > 0), 0, pace), slips]
        )

    def mend(state):
        state[2 * n : 3 * n] = np.clip(state[2 * n : 3 * n], -uy, uy)
        return state

    options = {"method": "DOP853", "rtol": 1e-9, "atol": 1e-12, "max_step": 1e-3}
    return from_sample_to_sample(rates, motion, 3 * n + len(links), mend, **options)[:, :n]


BY_PARTS = {"floors": (1, 3), "structures": (1, 2)}


@pytest.mark.slow
@pytest.mark.parametrize("linked", [True, False], ids=["a yielding link", "the weight above"])
def test_buildings_move_as_by_another_integrator(linked):
    k, alpha, uy, c = 4e7, 0.1, 0.004, 1e5

    def bilinear(stretch, rate, slip):
        y = stretch - slip
        held = (1 - alpha) * k * np.clip(y, -uy, uy)
        return alpha * k * stretch + held + c * rate, rate if abs(y) >= uy and y * rate > 0 else 0.0

    link = sl.Link(k, c, hardening=alpha, yield_displacement=uy, **BY_PARTS) if linked else None
    row = towers() if linked else towers(hardening=0.02, p_delta=True)
    motion = (1 if linked else 2) * record(150)
    table = sl.pound(row, FAR, SPRING, motion, link=link, steps_per_contact=128 if linked else 64)
    if linked:
        assert float(abs(table.link_force[:, 0]).max()) > 1.05 * k * uy
    else:
        assert (0.02 * 8e7 - row[0].geometric_stiffness()).min() < 2e6
    wanted = integrated(row, motion, [(0, 4, bilinear)] * linked)
    parts = [table.displacement.values[:, b, : s.storeys] for b, s in enumerate(row)]
    assert_near(
        np.concatenate(parts, axis=1), wanted, 2e-5
    )  # scipy steps over the kinks of the laws
    assert float(table.energy_balance_error.max()) < (1e-6 if linked else 1e-8)


@pytest.mark.filterwarnings("ignore:pound. motion. its peak is 2.755 g")
def test_weight_that_eats_the_hardening_still_balances_or_falls_over():
    soft = {"hardening": 0.005, "yield_drifts": 0.02, "p_delta": True}
    weak = sl.ShearBuilding([2e5] * 3, [3e7, 2.5e7, 2e7], [3.0] * 3, 0.05, **soft)
    assert (0.005 * 3e7 - weak.geometric_stiffness())[0] < 0
    table = sl.pound([weak, towers()[1]], 0.01, sl.Kelvin(1e8, restitution=0.6), 0.5 * record())
    assert float(table.peak[0, 0]) > 0.02
    assert float(table.energy_balance_error.max()) < 1e-8
    with pytest.raises(
        ArithmeticError,
        match=r"structure 1 falls over \d.* s after the beginning: it has drifted",
    ):
        sl.pound([weak, towers()[1]], FAR, SPRING, 6 * record(1500))
