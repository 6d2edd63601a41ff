"""Steps of hysteresis laws against adaptive integrators, and against each other."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stochlin.kernels.simulation.laws import (
    BOUC_WEN,
    LINEAR_BOUC_WEN,
    OTHER_LAW,
    advance,
    by_number,
)
from stochlin.kernels.simulation.stepping import LANES

pytestmark = pytest.mark.oracle

RNG = np.random.default_rng(5)
RATES = RNG.normal(0, 3, LANES)
BEFORE = RNG.uniform(-0.95, 0.95, (1, LANES))


def lanes(*parameters):
    return np.repeat(np.array(parameters, float)[:, None], LANES, axis=1)


def after(dt, steps=1, *, own, rates=RATES, before=BEFORE):
    """States of the Bouc-Wen law after so many steps."""
    law = by_number((LINEAR_BOUC_WEN if (own[2] == 1).all() else BOUC_WEN,))
    old, new = np.empty_like(before), before.copy()
    for _ in range(steps):
        old[:] = new
        advance(law, OTHER_LAW, LANES, rates, old, own, dt / steps, new)
    return new


@pytest.mark.parametrize("own", [(0.5, 0.5, 1.0), (0.7, -0.3, 2.5), (0.6, 0.4, 1.5)], ids=str)
def test_bouc_wen_is_of_fourth_order(own):
    beta, gamma, n = own

    def law(t, z):
        size = np.abs(z) ** n
        return RATES - size * (beta * np.abs(RATES) * np.sign(z) + gamma * RATES)

    away = np.where(RATES * BEFORE > 0, BEFORE, 0.1 * np.sign(RATES))  # sign z does not change
    exact = solve_ivp(law, (0, 0.3), away[0], method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
    errors = [
        np.abs(after(0.3, steps, own=lanes(*own), before=away)[0] - exact).max()
        for steps in (8, 16, 32)
    ]
    assert errors[0] < 2e-3
    assert 3.5 < np.log2(errors[1] / errors[2]) < 4.4


@pytest.mark.slow
@pytest.mark.parametrize("n", [1.0, 4.0, 20.0])
def test_long_steps_are_divided(n):
    """A step in which the extension moves many times the yield extension ends at the strength."""
    end = after(1.0, own=lanes(0.5, 0.5, n), rates=np.where(RATES > 0, 60.0, -60.0))
    np.testing.assert_allclose(end[0], np.sign(RATES), rtol=0, atol=0.01)


def test_no_lane_depends_on_another():
    mixed = lanes(0.5, 0.5, 1.0)
    mixed[2, ::3] = 2.5
    rates = RATES * np.where(
        np.arange(LANES) % 2, 1.0, 30.0
    )  # every second lane needs shorter steps
    whole = after(0.05, own=mixed, rates=rates)
    for lane in range(LANES):
        of_one = [
            np.repeat(x[..., lane : lane + 1], LANES, axis=-1) for x in (mixed, rates, BEFORE)
        ]
        alone = after(0.05, own=of_one[0], rates=of_one[1], before=of_one[2])
        assert alone[0, 0] == whole[0, lane]
