"""The augmented state matrix, entry by entry against the equations of motion."""

import cases
import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.oracle

TAU = 2 * np.pi


@pytest.mark.parametrize("link", [(), (sl.Link(1e6, 1e4, hardening=0.1, yield_displacement=1e-3),)])
def test_elastic_coefficients_are_the_start_of_the_loop(link):
    """Also with a yielding link, an elastic structure, and a strength by its reduction factor."""
    ground = sl.CloughPenzien(0.42, 0.6, 4.2, 0.6)
    pair = [
        sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4, mass=1e5),
        sl.Bilinear(0.7, 0.05, mass=1e5),
    ]
    space = sl.statespace(pair, ground, links=link)
    uy = float(sl.linearize(pair[0], ground).yield_displacement)
    assert space.yield_displacement.values.tolist() == pytest.approx(
        [uy, np.inf, 1e-3][: 2 + len(link)]
    )
    elastic = [sl.Bilinear(one.period, one.damping, mass=one.mass) for one in pair]
    plain = [sl.Link(1e6, 1e4)] if link else []
    x = sl.stationary_covariance(space)
    same = sl.stationary_covariance(sl.statespace(elastic, ground, [-1, -1], [0, 0], links=plain))
    rounding = {"rtol": 1e-9, "atol": 1e-20}
    np.testing.assert_allclose(x.sel(state=same.state, state_2=same.state_2), same, **rounding)
    np.testing.assert_allclose(x.sel(state="z_1"), x.sel(state="u_1"), **rounding)


def test_matrix_is_that_of_the_equations_of_motion():
    """Entry by entry against the system written down independently, states in another order."""
    structure = sl.Bilinear(1.3, 0.04, 0.2, reduction_factor=2)
    ground = sl.CloughPenzien(0.5, 0.6, high_pass_period=5.0, high_pass_damping=0.7, intensity=0.3)
    space = sl.statespace([structure], ground, [-0.8], [0.6])
    w, wg, wf = TAU / 1.3, TAU / 0.5, TAU / 5.0
    block = (w**2, 2 * 0.04 * w, 0.8 * w**2, -0.8, 0.6)
    matrix, noise = cases.augmented_system([block], (wg, 0.6, wf, 0.7))
    order = ["u_1", "v_1", "z_1", "xg", "xg_rate", "xf", "xf_rate"]
    shown = space.state_matrix.sel(state=order, state_2=order)
    np.testing.assert_allclose(shown, np.array(matrix, float), rtol=1e-15)
    np.testing.assert_array_equal(space.noise_vector.sel(state=order), noise)
    assert float(space.noise_intensity) == pytest.approx(TAU * 0.3, rel=1e-15)


def test_unstable_system_has_no_stationary_covariance():
    structure = sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=3)
    space = sl.statespace([structure], sl.WhiteNoise(), [0.9], [-0.1])
    with pytest.raises(ArithmeticError, match="not stable"):
        sl.stationary_covariance(space)


TOWER = sl.ShearBuilding([2e5, 1e5], [8e7, 5e7], [3.0, 3.0], 0.05, 0.1, yield_drifts=0.01)


def test_storeys_and_links_that_yield_have_states():
    pair = [TOWER, sl.Bilinear(1.0, 0.05, 0.1, yield_displacement=0.02, mass=1e5)]
    link = sl.Link(1e7, 1e4, hardening=0.2, yield_displacement=0.01, floors=(1, 1))
    c_eq, k_eq = [-0.9, -1, -0.7, -0.8], [1, 0, 2, 3]
    space = sl.statespace(pair, sl.KanaiTajimi(2.0, 0.3), c_eq, k_eq, links=[link])
    states = "xg xg_rate u_1.1 u_1.2 u_2 v_1.1 v_1.2 v_2 z_1.1 z_1.2 z_2"
    assert space.state.values.tolist() == [*states.split(), "z_link 1"]

    def entry(row, column):
        return float(space.state_matrix.sel(state=row, state_2=column))

    # Floor 1: both storeys beyond yield, and what is left of the link.
    assert entry("v_1.1", "u_1.1") == pytest.approx(-(0.1 * 8e7 + 0.1 * 5e7 + 0.2 * 1e7) / 2e5)
    assert entry("v_1.1", "u_1.2") == pytest.approx(0.1 * 5e7 / 2e5)
    assert entry("v_1.1", "z_1.2") == pytest.approx(0.9 * 5e7 / 2e5)
    assert [entry("z_1.2", name) for name in ("v_1.1", "v_1.2", "z_1.2")] == [-1, 1, 0]
    assert entry("v_1.1", "z_1.1") == pytest.approx(-0.9 * 8e7 / 2e5)
    assert entry("v_1.1", "z_link 1") == pytest.approx(-0.8 * 1e7 / 2e5)
    assert entry("v_2", "z_link 1") == pytest.approx(0.8 * 1e7 / 1e5)
    assert entry("v_2", "v_1.1") == pytest.approx(1e4 / 1e5)
    assert [entry("z_link 1", name) for name in ("v_1.1", "v_2", "z_link 1")] == [0.8, -0.8, -3]
    assert space.extension.sel(spring="1.2", state=["u_1.1", "u_1.2"]).values.tolist() == [-1, 1]
    assert space.stiffness.values.tolist() == pytest.approx([8e7, 5e7, 1e5 * TAU**2, 1e7])


def test_coefficients_are_one_an_element():
    ground = sl.WhiteNoise()
    with pytest.raises(ValueError, match=r"c_eq = \[-1\]; allowed: 2 .* elements 1\.1, 1\.2"):
        sl.statespace([TOWER], ground, [-1], [0])
    with pytest.raises(ValueError, match=r"c_eq = \[-0\.5, inf\]; allowed: 2 finite numbers"):
        sl.statespace([TOWER], ground, [-0.5, np.inf], [0, 0])
    stiff = sl.ShearBuilding([2e5], [8e7], [3.0], 0.05)
    with pytest.raises(ValueError, match=r"element 1\.1 has no strength.*allowed: c_eq = -1"):
        sl.statespace([stiff], ground, [-0.9], [0.1])
