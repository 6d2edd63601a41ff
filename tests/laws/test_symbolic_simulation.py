"""Simulation of laws written in sympy, against compiled laws and an exact linear case."""

import numpy as np
import pytest
import sympy

import stochlin as sl
from stochlin.kernels.simulation.law_stepping import law_block, law_middle
from stochlin.kernels.simulation.stepping import LANES, bouc_wen_block
from stochlin.models.laws import bilinear

pytestmark = pytest.mark.oracle

V, Z = sympy.symbols("v z")
GROUND = sl.KanaiTajimi(1.0, 0.3)
BOUC_WEN = V - 0.7 * sympy.Abs(V) * sympy.Abs(Z) * Z + 0.2 * V * Z**2  # beta 0.7, gamma -0.2, n 2


def test_block_of_a_law_moves_as_the_compiled_one():
    law = np.array([[0.6, 4.0, 36.0, 1.0], [0.2, 1.0, 9.0, 2.0]])
    extra = np.tile([0.7, -0.2, 2.0], (2, 1))
    f = np.random.default_rng(1).standard_normal((600, LANES)) * 8
    runs = []
    expression = sympy.lambdify((V, Z, sympy.Symbol("own")), BOUC_WEN, "math")
    for block, parameters in (
        (law_block(law_middle(expression)), law),
        (bouc_wen_block, np.hstack([law, extra])),
    ):
        state, out = np.zeros((3, 2, LANES)), np.empty((300, 2, LANES))
        block(f, 1 / 32, parameters, *state, 2, out, 0)
        runs.append((out, state))
    scale = np.abs(runs[0][0]).max()
    for one, other in zip(*runs, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-6 * scale)


@pytest.mark.slow
def test_law_in_sympy_gives_the_table_of_the_compiled_law():
    options = {"reduction_factor": 4.0}
    pair = [
        sl.Hysteretic(1.0, 0.05, 0.1, law=BOUC_WEN, **options),
        sl.BoucWen(1.0, 0.05, 0.1, beta=0.7, gamma=-0.2, exponent=2.0, **options),
        sl.Hysteretic(1.0, 0.05, 0.1, law=V - Z * sympy.Abs(V), **options),
    ]
    table = sl.simulate(pair, GROUND, paths=32, relaxation_times=5)
    sigma = table.displacement_std.values
    assert sigma[0] == pytest.approx(sigma[1], rel=1e-6)
    assert float(table.rho[0, 1]) == pytest.approx(1, abs=1e-9)
    assert abs(sigma[2] / sigma[0] - 1) > 1e-3  # laws are not mixed up


def test_maxwell_element_has_the_variance_of_its_linear_system():
    damper = sl.Hysteretic(1.0, 0.05, 0.3, yield_displacement=0.1, law=V - 3 * Z)
    spring = sl.Bilinear(0.7, 0.05)
    table = sl.simulate([damper, spring], GROUND, paths=512, seed=5)
    exact = sl.correlate(damper, spring, GROUND)
    off = float(table.displacement_std[0] - exact.displacement_std_1)
    assert abs(off) < 4 * float(table.displacement_std_standard_error[0])
    assert abs(float(table.rho[0, 1] - exact.rho)) < 4 * float(table.rho_standard_error[0, 1])


def test_law_with_jumps_approaches_the_return_map_as_the_step_shrinks():
    written = sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=4, law=bilinear.symbolic())
    mapped = sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=4)
    off = []
    for steps in (32, 128):
        options = {"steps_per_period": steps, "paths": 32, "relaxation_times": 10}
        sigma = sl.simulate([written, mapped], GROUND, **options).displacement_std.values
        off.append(abs(sigma[0] / sigma[1] - 1))
    assert off[0] < 0.03
    assert off[1] < 0.4 * off[0]
