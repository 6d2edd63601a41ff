"""The clipped closure and Caughey's amplitude averaging against numerical integration."""

from itertools import pairwise

import cases
import mpmath
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import erfc, ndtr

import stochlin as sl
from stochlin.kernels.linearization.amplitude_averaging import equivalent_system
from stochlin.models.laws import bilinear

pytestmark = pytest.mark.oracle

TAU = 2 * np.pi
NARROW = sl.KanaiTajimi(period=1.0, damping=0.05)
NONE = np.empty((0, 1))


def clip(z):
    return np.clip(z, -1.0, 1.0)


def random_latent(count, seed):
    rng = np.random.default_rng(seed)
    sz = cases.log_uniform(rng, (0.25, 6.0), count)
    return np.stack(
        [cases.log_uniform(rng, (0.1, 10.0), count), sz, np.tanh(rng.uniform(-2, 2, count))], axis=1
    )


def clipped_moments(sv, sz, r):
    """``Var v, Var z, Cov(v, z)`` of ``z = clip(z~)``, by integration over ``t = z~/sz``."""

    def average(function):
        borders = np.unique([-cases.REACH, *np.clip([-1 / sz, 0, 1 / sz], -12, 12), cases.REACH])
        weighted = lambda t: function(t) * np.exp(-t * t / 2)  # noqa: E731
        accuracy = {"epsabs": 1e-15, "epsrel": 1e-12}
        return sum(quad(weighted, a, b, **accuracy)[0] for a, b in pairwise(borders)) / np.sqrt(TAU)

    return sv * sv, average(lambda t: clip(sz * t) ** 2), average(lambda t: r * sv * t * clip(sz * t))


def integrated_clipped(latent):
    """Second moments and regressed coefficients of the clipped density."""
    moments = clipped_moments(*latent)
    slip = cases.slip_moments(cases.beyond_yield, latent, edges=(1,), seen=clip)
    return np.array(moments), cases.regressed(slip, *moments)


def test_clipped_moments_and_regression_agree_with_integration():
    for latent in random_latent(80, seed=50):
        value = bilinear.clipped(latent[:, None], NONE)
        moments, coefficients = integrated_clipped(latent)
        np.testing.assert_allclose(value.covariance[:, 0], moments, rtol=1e-11, atol=1e-13)
        # The regression divides by the share of Var z that v leaves unexplained.
        left = 1 - moments[2] ** 2 / (moments[0] * moments[1])
        np.testing.assert_allclose(value.coefficients[:, 0], coefficients, rtol=1e-10 / left, atol=1e-12)


def test_clipped_jacobian_is_the_derivative():
    """Central differences, which lose digits where slip is rare: only a positive correlation is asked.

    At a fixed point ``Cov(v, z) = k_eq E[mu z]`` is positive.
    """
    step = 1e-6
    for latent in random_latent(40, seed=51):
        latent[2] = abs(latent[2])
        value = bilinear.clipped(latent[:, None], NONE)
        for moment in range(3):
            shift = np.zeros((3, 1))
            shift[moment] = step * latent[moment]
            up, down = (bilinear.clipped(latent[:, None] + s, NONE) for s in (shift, -shift))
            for name in ("coefficients", "covariance"):
                slope = (getattr(up, name) - getattr(down, name)) / (2 * shift[moment])
                exact = getattr(value, f"{name}_jacobian")[:, moment]
                scale = np.abs(getattr(value, name)).max() / abs(latent[moment])
                np.testing.assert_allclose(exact, slope, rtol=1e-6, atol=1e-8 * scale)


def clipped_table(count=4000, seed=52):
    rng = np.random.default_rng(seed)
    structure = sl.Bilinear(**cases.draw_structure(rng, cases.PRACTICE, count))
    ground = sl.KanaiTajimi(**cases.draw_ground(rng, cases.PRACTICE, count))
    return structure, ground, sl.linearize(structure, ground, "clipped")


def test_clipped_hysteretic_displacement_never_exceeds_yield():
    _, _, table = clipped_table()
    assert not table.status.any()
    assert bool((table.z_std < 1).all()), float(table.z_std.max())


def test_clipped_solution_is_a_fixed_point():
    """From the response alone: find the density with these moments, regress, compare."""
    _, _, table = clipped_table()
    for case in range(0, table.sizes["case"], 200):
        row = table.isel(case=case)
        sv = float(row.velocity_std / row.yield_displacement)
        var_z = float(row.z_std) ** 2
        sz = brentq(lambda s, seek=var_z: clipped_moments(1.0, s, 0.0)[1] - seek, 0.01, 100, xtol=1e-14)
        inside = 1 - 2 * ndtr(-1 / sz)  # Cov(v, z) = r sv sz P(|z~| < 1), by Stein's lemma
        r = float(row.velocity_z_corr) * np.sqrt(var_z) / (sz * inside)
        _, (slip, k) = integrated_clipped((sv, sz, r))
        assert float(row.c_eq) + 1 == pytest.approx(slip, rel=1e-7)
        assert float(row.k_eq) == pytest.approx(k, rel=1e-7)


@pytest.mark.parametrize(("strength_ratio", "simulated"), [(0.5, 0.6588), (1.0, 1.3464), (2.0, 3.1765)])
def test_clipping_moves_the_displacement_towards_the_simulated_one(strength_ratio, simulated):
    """White noise, five per cent damping and hardening: own Monte Carlo to .6 % or better."""
    structure = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=3 * strength_ratio)
    gaussian, clipped = (
        float(sl.linearize(structure, sl.WhiteNoise(), closure).ductility_std)
        for closure in ("gaussian", "clipped")
    )
    assert gaussian < clipped < simulated


def test_far_beyond_yield_the_gaussian_z_is_impossible_and_the_clipped_one_is_not():
    """Far beyond yield z sits at +-1: the Gaussian closure lets it exceed 1, clipping does not."""
    structure = sl.Bilinear(1.0, 0.02, 0.02, reduction_factor=30.0)
    assert float(sl.linearize(structure, NARROW, "gaussian").z_std) > 1
    assert 0.7 < float(sl.linearize(structure, NARROW, "clipped").z_std) < 1


def caughey(sigma, alpha):
    """``(weq/w)^2`` and ``2 xieq weq/w`` without the viscous part, by QUADPACK."""
    lam = 2 * sigma**2

    def integrand(z):
        return (z**-3 + 1 / (lam * z)) * np.sqrt(z - 1) * np.exp(-z * z / lam)

    end = max(2.0, np.sqrt(700 * lam))
    borders = np.unique([1.0, 1.2, 2.0, *np.geomspace(2, end, 6)])
    integral = sum(quad(integrand, a, b, epsabs=1e-16, epsrel=1e-11)[0] for a, b in pairwise(borders))
    ratio = 1 - 8 * (1 - alpha) / np.pi * integral
    friction = 2 * (1 - alpha) / np.sqrt(np.pi * lam) * erfc(1 / np.sqrt(lam)) / np.sqrt(ratio)
    return ratio, friction


def averaged(sigma, alpha, w=1.0, xi=0.05):
    return equivalent_system(*(np.array([float(x)]) for x in (sigma, w, xi, alpha)))


@pytest.mark.parametrize(("sigma", "ratio"), [(1.0, 0.618711), (2.0, 0.306761)])
def test_caugheys_equivalent_stiffness(sigma, ratio):
    assert averaged(sigma, 0.05).stiffness[0] == pytest.approx(ratio, abs=5.1e-7)  # six digits are known


def test_caugheys_averages_agree_with_integration():
    rng = np.random.default_rng(53)
    for sigma, alpha in zip(
        cases.log_uniform(rng, (0.1, 100), 60), rng.uniform(0.001, 1, 60), strict=True
    ):
        ratio, friction = caughey(sigma, alpha)
        system = averaged(sigma, alpha, w=1.7, xi=0.03)
        assert system.stiffness[0] == pytest.approx(1.7**2 * ratio, rel=1e-9)
        assert system.damping[0] == pytest.approx(1.7 * (2 * 0.03 + friction), rel=1e-9)


def test_amplitude_average_goes_from_the_elastic_to_the_hardening_stiffness():
    assert averaged(0.05, 0.1).stiffness[0] == pytest.approx(1, rel=1e-12)
    assert averaged(0.05, 0.1).damping[0] == pytest.approx(0.1, rel=1e-12)
    stiffness = [averaged(s, 0.1).stiffness[0] for s in (0.3, 0.6, 1, 2, 5, 20, 1e3)]
    assert stiffness == sorted(stiffness, reverse=True)
    assert stiffness[-1] == pytest.approx(0.1, rel=2e-2)


def test_narrow_band_solution_is_a_fixed_point():
    """An elastic oscillator of equivalent period and damping responds with the sigma that made it."""
    rng = np.random.default_rng(54)
    structure = sl.Bilinear(**cases.draw_structure(rng, cases.PRACTICE, 30))
    ground = sl.KanaiTajimi(**cases.draw_ground(rng, cases.PRACTICE, 30))
    table = sl.linearize(structure, ground, "narrow_band")
    equivalent = sl.Bilinear(period=table.period_eq, damping=table.damping_eq)
    response = sl.linearize(equivalent, ground)
    np.testing.assert_allclose(response.displacement_std, table.displacement_std, rtol=1e-9)
    assert table.z_std.isnull().all()
    for case in range(30):
        sigma, alpha = float(table.ductility_std[case]), float(structure.hardening[case])
        ratio, friction = caughey(sigma, alpha)
        elastic = float(structure.period[case])
        assert float(table.period_eq[case]) == pytest.approx(elastic / np.sqrt(ratio), rel=1e-8)
        damping = (2 * float(structure.damping[case]) + friction) / (2 * np.sqrt(ratio))
        assert float(table.damping_eq[case]) == pytest.approx(damping, rel=1e-8)


@pytest.mark.parametrize("sigma", [3.0, 30.0, 1e3, 1e4, 1e6])
def test_stiffness_after_yielding_keeps_its_digits(sigma):
    """Of what is left of the stiffness nearly all is a difference of nearly equal numbers."""
    with mpmath.workdps(30):
        lam = 2 * mpmath.mpf(sigma) ** 2
        end = mpmath.sqrt(mpmath.sqrt(1 + 150 * lam))

        def density(s):
            z = 1 + s * s
            return 2 * s * s * mpmath.exp(-z * z / lam) * (z**-3 + 1 / (lam * z))

        knots = [0, *(2.0**k for k in range(-3, 40) if 2.0**k < end), end]
        left = 1 - 8 * (1 - mpmath.mpf(0.01)) / mpmath.pi * mpmath.quad(density, knots)
    assert averaged(sigma, 0.01).stiffness[0] == pytest.approx(float(left), rel=1e-12)


def test_of_several_solutions_the_least_is_taken():
    """It grows out of the elastic response; a stiff structure on a lake bed may have three."""
    structure = {"period": 0.1514, "damping": 0.0168, "hardening": 0.0244}
    ground = sl.KanaiTajimi(2.2316, 0.0655)
    table = sl.linearize(sl.Bilinear(**structure, reduction_factor=1.5823), ground, "narrow_band")
    solution, uy = float(table.ductility_std), float(table.yield_displacement)

    def excess(sigma):
        """What the system equivalent to this response responds with, over it."""
        w = np.full(sigma.size, TAU / structure["period"])
        system = equivalent_system(sigma, w, structure["damping"], structure["hardening"])
        root = np.sqrt(system.stiffness)
        elastic = sl.Bilinear(period=TAU / root, damping=system.damping / (2 * root))
        return sl.linearize(elastic, ground).displacement_std.values / uy / sigma

    assert (excess(np.geomspace(0.02, 0.999 * solution, 400)) > 1).all()
    assert excess(np.array([solution]))[0] == pytest.approx(1, abs=1e-9)
    assert (excess(np.geomspace(1.001 * solution, 100, 400)) > 1).any()


@pytest.mark.parametrize("closure", ["gaussian", "clipped", "narrow_band"])
def test_strong_structure_is_the_elastic_one_under_every_closure(closure):
    strong = sl.Bilinear(0.7, 0.05, 0.05, reduction_factor=0.1)
    elastic = sl.linearize(sl.Bilinear(0.7, 0.05), NARROW)
    table = sl.linearize(strong, NARROW, closure)
    assert float(table.displacement_std) == pytest.approx(float(elastic.displacement_std), rel=1e-12)
