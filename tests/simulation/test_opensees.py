"""The same pair of bilinear oscillators in OpenSeesPy: another code, another return map, equal steps."""

import numpy as np
import pytest
from opensees_models import add_oscillators, new_model, shake

from stochlin.kernels.simulation.stepping import LANES, bilinear_block

pytestmark = pytest.mark.oracle

PERIODS, DAMPING, HARDENING = (0.6, 1.0), 0.05, 0.05
YIELD = (0.012, 0.03)  # [m]
DT, STEPS = 0.01, 4000
PEAK_SHARE = 1e-8  # of the peak; both codes iterate or round at 1e-12 or so, over thousands of steps


def ground_acceleration():
    """Filtered noise with an envelope, zero at both ends, at the nodes of the steps [m/s^2]."""
    rng = np.random.default_rng(1985)
    t = np.arange(STEPS + 1) * DT
    phases = rng.uniform(0, 2 * np.pi, 40)
    rates = rng.uniform(2.0, 25.0, 40)
    waves = np.sin(rates * t[:, None] + phases).sum(axis=1)
    return 0.35 * waves * np.sin(np.pi * t / t[-1])


def displacements_in_opensees(ops, acceleration):
    """Nodal displacements (2, STEPS): a spring of Steel01 beside a dashpot for each unit mass."""
    new_model(ops)
    tops = add_oscillators(ops, PERIODS, (1.0, 1.0), YIELD, DAMPING, HARDENING)
    shake(ops, acceleration, DT, ("NormUnbalance", 1e-12, 50))
    found = np.empty((2, STEPS))
    for s in range(STEPS):
        assert ops.analyze(1, DT) == 0
        found[:, s] = [ops.nodeDisp(top, 1) for top in tops]
    return found


def displacements_here(acceleration):
    w, uy = 2 * np.pi / np.array(PERIODS), np.array(YIELD)
    stiff = (HARDENING * w**2, (1 - HARDENING) * w**2)
    laws = np.stack([2 * DAMPING * w, *stiff, 1 / uy], axis=1)
    mean = -0.5 * (acceleration[1:] + acceleration[:-1])
    f = np.repeat(mean[:, None], LANES, axis=1)
    out = np.empty((STEPS, 2, LANES))
    bilinear_block(f, DT, laws, *np.zeros((3, 2, LANES)), 1, out, 0)
    assert (out == out[..., :1]).all()  # equal motions, equal answers
    return out[..., 0].T * uy[:, None]


def test_pair_under_one_motion_moves_as_in_opensees(ops):
    acceleration = ground_acceleration()
    theirs, ours = displacements_in_opensees(ops, acceleration), displacements_here(acceleration)
    peaks = np.abs(theirs).max(axis=1, keepdims=True)
    assert (peaks[:, 0] / YIELD > 2).all()  # well beyond yield
    assert (np.abs(theirs[:, -200:].mean(axis=1)) / YIELD > 0.2).any()  # and with a lasting offset
    np.testing.assert_allclose(ours / peaks, theirs / peaks, rtol=0, atol=PEAK_SHARE)
    apart = np.abs(theirs[0] - theirs[1]).max()
    assert np.abs(ours[0] - ours[1]).max() == pytest.approx(apart, rel=PEAK_SHARE)
