"""Linearization against 60 digits: its covariances where nearly singular, and its solutions."""

import cases
import mpmath
import numpy as np
import pytest
from mpmath import mpf
from sixty_digits import DIGITS, exact_covariance, exact_lyapunov, with_law

import stochlin as sl
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    motion_of,
    own_covariance,
    pair_covariance,
)
from stochlin.kernels.linearization.drift import HALF_CYCLES, factors, half_cycles
from stochlin.kernels.linearization.filters import Filter

pytestmark = pytest.mark.oracle

SLIPS = [1e-18, 1e-15, 1e-12, 1e-10, 1e-8, 1e-6, 1e-4, 1e-3, 1e-2, 1e-1]
WORST_RHO = 1e-13


def draw(rng, slip, relaxation, period=None, alpha=0.05):
    period = period or cases.log_uniform(rng, (0.15, 4.0))
    w, xi = 2 * np.pi / period, rng.uniform(0.01, 0.1)
    return EquivalentSystem(w * w, 2 * xi * w, (1 - alpha) * w * w, slip, relaxation * w)


def forcing(system, filters):
    wg, xig, *high_pass = (np.float64(x) for x in filters)
    ground = Filter.kanai_tajimi(np.float64(1.0), wg, xig)
    ground = ground.clough_penzien(*high_pass) if high_pass else ground
    return ground.forcing(system)


def errors(first, second, filters):
    """Largest relative error of the variances, and the error of rho."""
    systems = [EquivalentSystem(*map(np.float64, system)) for system in (first, second)]
    forcings = [forcing(system, filters) for system in systems]
    own = [own_covariance(s, f) for s, f in zip(systems, forcings, strict=True)]
    one, two = (motion_of(s, f) for s, f in zip(systems, forcings, strict=True))
    variances = pair_covariance(one, one) * pair_covariance(two, two)
    rho = float(pair_covariance(one, two) / np.sqrt(variances))
    with mpmath.workdps(DIGITS):
        x = exact_covariance([with_law(s) for s in systems], filters)
        entries = {"mu_mu": (0, 0), "v_v": (1, 1), "z_z": (2, 2), "v_z": (1, 2), "mu_z": (0, 2)}
        relative = [
            abs(float(getattr(own[n], name)) / x(3 * n + i, 3 * n + j) - 1)
            for n in range(2)
            for name, (i, j) in entries.items()
        ]
        exact = x(0, 3) / mpmath.sqrt(x(0, 0) * x(3, 3))
        return float(max(relative)), float(abs(rho - exact))


def check(first, second, filters):
    """In either order."""
    for pair in ((first, second), (second, first)):
        relative, absolute = errors(*pair, filters)
        assert relative < 1e-10
        assert absolute < WORST_RHO


@pytest.mark.parametrize("slip", SLIPS)
def test_moments_and_correlation_keep_their_digits_as_slip_vanishes(slip):
    rng = np.random.default_rng(18)
    for relaxation in (0.01 * slip, slip, min(100 * slip, 0.3)):
        soil = 2 * np.pi / cases.log_uniform(rng, (0.3, 3.0)), cases.log_uniform(rng, (0.03, 0.8))
        check(draw(rng, slip, relaxation), draw(rng, 2 * slip, 0.5 * relaxation), soil)


@pytest.mark.parametrize("fast", [10.0, 1e2, 1e3, 1e4, 1e5])
def test_moments_and_correlation_keep_their_digits_where_relaxation_is_fast(fast):
    """Far beyond yield; one structure, or both."""
    rng = np.random.default_rng(23)
    soil = 2 * np.pi / 1.3, 0.2
    for other in (0.1, 1.0, 0.7 * fast):
        for _ in range(3):
            pair = draw(rng, rng.uniform(0.1, 0.5), fast), draw(rng, rng.uniform(0.1, 0.9), other)
            check(*pair, soil)


def test_one_structure_hardly_yields_and_the_ground_is_that_of_clough_and_penzien():
    rng = np.random.default_rng(19)
    for tiny in (1e-18, 1e-12, 1e-7):
        check(draw(rng, 0.2, 0.1), draw(rng, tiny, tiny), (15.0, 0.6, 1.5, 0.6))


@pytest.mark.parametrize("high_pass", [(10.0, 5.0), (3.0, 0.6), (1e2, 2.0), (0.1, 0.05)])
def test_a_high_pass_filter_that_leaves_little_of_the_soil_s_motion(high_pass):
    """The ground is far faster than the structures, which move with what the filter leaves."""
    rng = np.random.default_rng(29)
    pair = draw(rng, 0.3, 0.2, 5.0), draw(rng, 0.1, 0.05, 0.3)
    relative, absolute = errors(*pair, (2 * np.pi / 0.01, 0.5, *high_pass))
    assert relative < 1e-9
    assert absolute < 1e-9


@pytest.mark.parametrize("slip", [1e-18, 1e-16, 1e-12, 1e-8, 1e-6, 1e-3, 1e-2])
def test_nearly_equal_structures_as_slip_vanishes(slip):
    """The worst conditioned pairs, also on ground of their period and damping: near-defective."""
    first = draw(np.random.default_rng(21), slip, slip)
    w = np.sqrt(first.stiffness)
    for soil in ((2 * np.pi, 0.05), (w, first.damping / (2 * w))):
        check(first, first._replace(stiffness=w * w * (1 + 1e-9)), soil)


@pytest.mark.parametrize("ratio", [1e-3, 1e-2, 1e2, 1e3])
@pytest.mark.parametrize("slip", [1e-16, 1e-6, 0.2])
def test_periods_far_apart_keep_their_digits(ratio, slip):
    rng = np.random.default_rng(41)
    relaxation = min(slip * 10 ** rng.uniform(-2, 2), 0.5)
    alphas = 10 ** rng.uniform(-3, 0, 2)
    pair = [draw(rng, slip, relaxation, *each) for each in zip((1.0, ratio), alphas, strict=True)]
    check(*pair, (2 * np.pi, 0.3))


# --- The fixed points: the closures and the covariance in 60 digits
# -----------------------------------


def slip_quadrant(sz, r):
    """``P(v > 0, z > 1)`` by Owen's integral, and the edge and corner of that quadrant."""
    h, q = 1 / sz, mpmath.sqrt((1 - r) * (1 + r))
    a = r / q
    knots = [0, a / 4, a / 2, a] if abs(a) < 8 else [0, 1, 2, 4, 8, a]
    tail = mpmath.quad(lambda t: mpmath.exp(-h * h * (1 + t * t) / 2) / (1 + t * t), knots)
    edge = mpmath.npdf(h) * mpmath.ncdf(a * h)
    corner = mpmath.exp(-((h / q) ** 2) / 2) / (2 * mpmath.pi)
    return mpmath.erfc(h / mpmath.sqrt(2)) / 4 + tail / (2 * mpmath.pi), edge, corner, h, q


def bilinear(vv, zz, vz):
    sv, sz = mpmath.sqrt(vv), mpmath.sqrt(zz)
    r = vz / (sv * sz)
    rate, edge, corner, h, q = slip_quadrant(sz, r)
    return 2 * rate, 2 * sv * h * (r * h * edge + q * corner)


def clipped(vv, zz, vz):
    """The Gaussian whose clipped ``z`` has this variance, and the regression of the slip rate."""

    # variance before clipping; that after it is concave, so that Newton's steps all go up
    free = zz
    for _ in range(100):
        h = 1 / mpmath.sqrt(free)
        slope = mpmath.erf(h / mpmath.sqrt(2)) - 2 * h * mpmath.npdf(h)
        step = (zz - mpmath.erfc(h / mpmath.sqrt(2))) / slope - free
        free += step
        if abs(step) < mpf(10) ** -30 * free:  # the next is about its square
            break
    else:
        raise AssertionError("no variance before clipping")
    sz = mpmath.sqrt(free)
    sv = mpmath.sqrt(vv)
    r = vz / (sv * sz * mpmath.erf(1 / (sz * mpmath.sqrt(2))))
    rate, edge, corner, h, q = slip_quadrant(sz, r)
    first = mpmath.ncdf(-h / q) / mpmath.sqrt(2 * mpmath.pi) + r * edge
    by_v, by_z = 2 * vv * (rate + r * (r * h * edge + q * corner)), 2 * sv * first
    determinant = vv * zz - vz * vz
    return (by_v * zz - by_z * vz) / determinant, (by_z * vv - by_v * vz) / determinant


def bouc_wen(beta, gamma, n):
    def coefficients(vv, zz, vz):
        sv, sz = mpmath.sqrt(vv), mpmath.sqrt(zz)
        r = vz / (sv * sz)
        q = mpmath.sqrt((1 - r) * (1 + r))
        angle = mpmath.acos(r)  # Wen's integral of sin^n, from the angle to pi/2, twice
        integral = 2 * mpmath.quad(lambda t: mpmath.sin(t) ** n, [angle, mpmath.pi / 2])
        even = 2 ** (n / 2) * mpmath.gamma((n + 2) / 2) / mpmath.pi * beta
        odd = 2 ** (n / 2) * mpmath.gamma((n + 1) / 2) / mpmath.sqrt(mpmath.pi) * gamma
        share = even * (2 / n * q ** (n + 1) + r * integral) + odd * r
        return sz**n * (even * integral + odd), n * sv * sz ** (n - 1) * share

    return coefficients


def solved_exactly(system, soil, forcing_scale, coefficients):
    """The equivalent system at the fixed point, by Newton's method from where ours ended."""
    w2, d, h, p, k = (mpf(float(value)) for value in system)

    def off(slip, relaxation):
        x = exact_covariance([(w2, d, h, slip - 1, relaxation)], soil)
        reached = coefficients(*(x(i, j) * forcing_scale for i, j in ((1, 1), (2, 2), (1, 2))))
        return reached[0] - slip, reached[1] - relaxation

    for _ in range(6):
        here, tiny = off(p, k), mpf(10) ** -28
        by_p = [(b - a) / (p * tiny) for a, b in zip(here, off(p * (1 + tiny), k), strict=True)]
        by_k = [(b - a) / (k * tiny) for a, b in zip(here, off(p, k * (1 + tiny)), strict=True)]
        determinant = by_p[0] * by_k[1] - by_p[1] * by_k[0]
        steps = (
            (here[1] * by_k[0] - here[0] * by_k[1]) / determinant,
            (here[0] * by_p[1] - here[1] * by_p[0]) / determinant,
        )
        p, k = p + steps[0], k + steps[1]
        if (
            max(abs(steps[0] / p), abs(steps[1] / k)) < mpf(10) ** -7
        ):  # the next is about its square
            break
    return w2, d, h, p - 1, k


@pytest.mark.slow
@pytest.mark.parametrize("soil", ["white noise", "Kanai-Tajimi", "Clough-Penzien"])
@pytest.mark.parametrize("law", ["bilinear", "clipped", "bouc_wen"])
def test_solutions_are_those_of_60_digits(law, soil):
    """From the elastic limit to a thousand times yield."""
    rng, worst = np.random.default_rng([24, len(law), len(soil)]), 1e-9
    for _ in range(6):
        values = [cases.draw_structure(rng, cases.BEYOND) for _ in range(2)]
        for one in values:
            one["reduction_factor"] = cases.log_uniform(rng, (0.7, 3e3))
        shape = {"beta": 0.6, "gamma": rng.uniform(-0.5, 1.5), "exponent": rng.uniform(1, 5)}
        if law == "bouc_wen":
            pair = [sl.BoucWen(**one, **shape) for one in values]
        else:
            pair = [sl.Bilinear(**one) for one in values]
        period, damping = cases.log_uniform(rng, (0.15, 4.0)), cases.log_uniform(rng, (0.03, 0.8))
        ground, filters = {
            "white noise": (sl.WhiteNoise(1.0), ()),
            "Kanai-Tajimi": (sl.KanaiTajimi(period, damping), (2 * np.pi / period, damping)),
            "Clough-Penzien": (
                sl.CloughPenzien(period, damping, 4 * period, 0.6),
                (2 * np.pi / period, damping, 0.5 * np.pi / period, 0.6),
            ),
        }[soil]
        closure = "clipped" if law == "clipped" else "gaussian"
        rho = float(sl.correlate(*pair, ground, closure=closure).rho)
        with mpmath.workdps(DIGITS):
            bouc = bouc_wen(*(mpf(float(shape[name])) for name in ("beta", "gamma", "exponent")))
            coefficients = {"bilinear": bilinear, "clipped": clipped, "bouc_wen": bouc}[law]
            exact_filters, blocks, sigmas = [mpf(float(x)) for x in filters], [], []
            for structure in pair:
                found = sl.linearize(structure, ground, closure)
                w, xi = 2 * np.pi / structure.period, structure.damping
                system = (
                    *(w * w, 2 * xi * w, (1 - structure.hardening) * w * w),
                    *(float(found.c_eq) + 1, float(found.k_eq)),
                )
                scale = 1 / mpf(float(found.yield_displacement)) ** 2
                blocks.append(solved_exactly(system, exact_filters, scale, coefficients))
                sigmas.append(float(found.displacement_std))
            x = exact_covariance(blocks, exact_filters)
            exact = [mpmath.sqrt(x(i, i)) for i in (0, 3)]
            for sigma, true in zip(sigmas, exact, strict=True):
                assert abs(sigma / true - 1) < worst
            assert abs(rho - x(0, 3) / (exact[0] * exact[1])) < worst


@pytest.mark.parametrize(
    ("filters", "close"),
    [
        ((), 1e-12),
        ((4.8, 0.2), 1e-11),
        ((3.1, 0.03), 1e-11),
        ((4.8, 0.2, 0.6, 0.6), 1e-11),
        (
            (3.0, 0.6, 3.0, 0.6),
            1e-8,
        ),  # equal oscillators, for which the matrix exponential is taken
    ],
)
def test_half_cycles_are_those_of_the_exponential(filters, close):
    """Also where the structure hardly yields, slips almost freely, or has a pole of the soil."""
    rng, extremes = np.random.default_rng(29), [(1e-14, 1e-14), (0.9997, 0.1), (0.999, 0.5)]
    systems = [draw(rng, slip, relaxation) for slip, relaxation in extremes]
    systems += [
        draw(rng, rng.uniform(0.01, 0.9), cases.log_uniform(rng, (1e-4, 2.0))) for _ in range(4)
    ]
    if filters:
        w, xi = filters[:2]
        systems += [
            EquivalentSystem(w * w, 2 * xi * w, 0.9 * w * w, e, e * w) for e in (1e-12, 1e-6)
        ]
    cells = EquivalentSystem(*np.array(systems).T)
    ground = Filter.kanai_tajimi(1.0, *filters[:2]) if filters else Filter(1.0)
    found = half_cycles(cells, ground.clough_penzien(*filters[2:]) if filters[2:] else ground)
    for n, system in enumerate(systems):
        with mpmath.workdps(DIGITS):
            matrix, noise = cases.augmented_system([with_law(system)], list(map(mpf, filters)))
            covariance, states = exact_lyapunov(matrix, noise), range(len(matrix))
            state = mpmath.matrix([covariance(i, 2) for i in states])
            variance, rate = state[2], mpmath.matrix([matrix[2]])
            whole = mpmath.matrix([[covariance(i, j) for j in states] for i in states])
            time = mpmath.pi * mpmath.sqrt(variance / (rate * whole * rate.T)[0])
            step, exact = mpmath.expm(mpmath.matrix(matrix) * time), []
            for _ in range(HALF_CYCLES):
                state = step * state
                exact.append(float(state[2] / variance))
        np.testing.assert_allclose(found.time[n], float(time), rtol=1e-11)
        np.testing.assert_allclose(found.memory[:, n], exact, rtol=0, atol=close)


def test_cubics_are_factored_with_relative_errors_of_their_coefficients():
    """Of poles of one structure from a creep of 1e-8 to a relaxation of 1e6."""
    rng = np.random.default_rng(31)
    real, b1, b0 = 10 ** rng.uniform([[-8], [-3], [-3]], [[6], [1], [1]], (3, 200))
    root, linear, constant = factors(real + b1, b0 + real * b1, real * b0)
    for n in range(root.size):
        with mpmath.workdps(DIGITS):
            s, b, c = (mpf(float(x[n])) for x in (root, linear, constant))
            product = b - s, c - s * b, -s * c
            a2, a1, a0 = (
                mpf(x) for x in (real[n] + b1[n], b0[n] + real[n] * b1[n], real[n] * b0[n])
            )
            errors = [abs(x / y - 1) for x, y in zip(product, (a2, a1, a0), strict=True)]
        assert max(errors) < 8e-15
