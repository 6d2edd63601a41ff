"""The fast path, block by block and in closed form, against the augmented state matrix it replaces."""

import cases
import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.oracle

TAU = 2 * np.pi


def full_covariance(structures, ground):
    """Linearize each structure alone, then solve all of them in one Lyapunov equation."""
    tables = [sl.linearize(structure, ground) for structure in structures]
    space = sl.statespace(
        structures, ground, [float(t.c_eq) for t in tables], [float(t.k_eq) for t in tables]
    )
    return tables, sl.stationary_covariance(space)


def check(structures, ground, tolerance=1e-10):
    """Every moment of every structure, and the correlation of every pair.

    The general solver's own error, which grows as 1/k_eq, is the larger one here.
    """
    tables, x = full_covariance(structures, ground)

    def moment(a, b):
        return float(x.sel(state=a, state_2=b))

    def correlation(a, b):
        return moment(a, b) / np.sqrt(moment(a, a) * moment(b, b))

    for i, table in enumerate(tables, start=1):
        assert float(table.displacement_std) ** 2 == pytest.approx(
            moment(f"u_{i}", f"u_{i}"), rel=tolerance
        )
        assert float(table.velocity_std) ** 2 == pytest.approx(moment(f"v_{i}", f"v_{i}"), rel=tolerance)
        if int(table.status) == 0:
            z = float(table.z_std * table.yield_displacement)
            assert z**2 == pytest.approx(moment(f"z_{i}", f"z_{i}"), rel=tolerance)
            found = float(table.velocity_z_corr)
            assert found == pytest.approx(correlation(f"v_{i}", f"z_{i}"), abs=tolerance)
    for i, first in enumerate(structures, start=1):
        for j, second in enumerate(structures[i:], start=i + 1):
            rho = float(sl.correlate(first, second, ground).rho)
            assert rho == pytest.approx(correlation(f"u_{i}", f"u_{j}"), abs=tolerance)


def draw_ground(rng, kind):
    soil = cases.draw_ground(rng, cases.PRACTICE) | {"intensity": cases.log_uniform(rng, (1e-3, 10))}
    if kind is sl.WhiteNoise:
        return sl.WhiteNoise(soil["intensity"])
    if kind is sl.KanaiTajimi:
        return sl.KanaiTajimi(**soil)
    high_pass = {
        "high_pass_period": cases.log_uniform(rng, (2, 20)),
        "high_pass_damping": rng.uniform(0.1, 1.2),
    }
    return sl.CloughPenzien(**soil, **high_pass)


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("kind", [sl.WhiteNoise, sl.KanaiTajimi, sl.CloughPenzien])
def test_three_structures_at_once(kind, seed):
    """Two yielding ones and an elastic one between them."""
    rng = np.random.default_rng([30, seed])
    yielding = [sl.Bilinear(**cases.draw_structure(rng, cases.PRACTICE)) for _ in range(2)]
    elastic = sl.Bilinear(period=cases.log_uniform(rng, (0.15, 4.0)), damping=rng.uniform(0.01, 0.1))
    check([yielding[0], elastic, yielding[1]], draw_ground(rng, kind))


def test_oscillator_tuned_to_the_ground_is_defective_and_no_trouble():
    """Equal period and damping of structure and soil leave the state matrix short of eigenvectors."""
    tuned = sl.Bilinear(period=2.0, damping=0.05)
    ground = sl.KanaiTajimi(period=2.0, damping=0.05)
    space = sl.statespace([tuned], ground, [-1], [0])
    assert np.linalg.cond(np.linalg.eig(space.state_matrix.values).eigenvectors) > 1e6
    check([tuned, sl.Bilinear(period=1.3, damping=0.02)], ground)
    check([tuned, sl.Bilinear(2.0, 0.05, hardening=0.1, reduction_factor=3)], ground)


@pytest.mark.parametrize("strength", [{}, {"hardening": 0.05, "reduction_factor": 4.0}])
def test_two_identical_structures_move_as_one(strength):
    twins = [sl.Bilinear(period=0.7, damping=0.05, **strength) for _ in range(2)]
    ground = sl.KanaiTajimi(period=0.7, damping=0.05)
    check(twins, ground)
    assert float(sl.correlate(*twins, ground).rho) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("link", [(), (sl.Link(1e6, 1e4, hardening=0.1, yield_displacement=1e-3),)])
def test_elastic_coefficients_are_the_start_of_the_loop(link):
    """Also with a link that yields, an elastic structure, and a strength by its reduction factor."""
    ground = sl.CloughPenzien(0.42, 0.6, 4.2, 0.6)
    pair = [sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4, mass=1e5), sl.Bilinear(0.7, 0.05, mass=1e5)]
    space = sl.statespace(pair, ground, links=link)
    uy = float(sl.linearize(pair[0], ground).yield_displacement)
    assert space.yield_displacement.values.tolist() == pytest.approx([uy, np.inf, 1e-3][: 2 + len(link)])
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
    stiff = sl.ShearBuilding([2e5], [8e7], [3.0], 0.05)
    with pytest.raises(ValueError, match=r"element 1\.1 has no strength.*allowed: c_eq = -1"):
        sl.statespace([stiff], ground, [-0.9], [0.1])
