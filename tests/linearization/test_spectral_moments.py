"""First spectral moments against integrals over the real frequency axis, and exact limits."""

from itertools import chain

import cases
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.spectral_moments import difference_moments, displacement_moments
from stochlin.solver.linearization.equivalent_systems import solved_together
from stochlin.solver.linearization.peaks import response_moments

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

ACCURACY = 5e-12  # reached: 1.4e-12; the rule is built for 5e-13


def density(w, parameters):
    intensity, *filters = parameters
    result = intensity
    if filters:
        ratio, spread = (w / filters[0]) ** 2, 4 * filters[1] ** 2
        result = result * (1 + spread * ratio) / ((1 - ratio) ** 2 + spread * ratio)
    if filters[2:]:
        ratio, spread = (w / filters[2]) ** 2, 4 * filters[3] ** 2
        result = result * ratio**2 / ((1 - ratio) ** 2 + spread * ratio)
    return result


def transfer(w, system):
    w2, d, h, p, k = system
    s = 1j * w
    return (s + k) / ((s + k) * (s * s + d * s + w2) - h * (k + p * s))


def exact_moment(order, systems, parameters, resonances):
    """``2 Int_0^inf w^order S |H|^2 dw``, split finely around every resonance.

    On each part the integrand is so smooth that 60 points of Gauss and Legendre are exact to rounding.
    """
    points = {0.0}
    for w, xi in resonances:
        around = [w * (1 + sign * f * 0.7 * xi) for f in (0, 1, 3, 10, 30, 100, 300) for sign in (-1, 1)]
        points |= {float(x) for x in around if x > 0}
    low, high = min(points - {0.0}), max(points)
    points |= {low / 10**n for n in range(1, 6)} | {high * 10**n for n in range(1, 5)}

    def integrand(w):
        first, *others = (transfer(w, system) for system in systems)
        return w**order * density(w, parameters) * abs(first - sum(others)) ** 2

    x, weight = np.polynomial.legendre.leggauss(60)
    ends = np.sort(list(points))
    middle, half = 0.5 * (ends[1:] + ends[:-1])[:, None], 0.5 * np.diff(ends)[:, None]
    last, share = ends[-1], 0.5 * (1 + x)  # beyond the last point, over its ratio to the frequency
    beyond = (weight * 0.5 * last / share**2) @ integrand(last / share)
    return 2 * ((half * weight * integrand(middle + half * x)).sum() + beyond)


def in_a_row(system):
    return EquivalentSystem(*(np.array([float(x)]) for x in system))


def filter_of(parameters):
    intensity, *soil = parameters
    if not soil:
        return Filter(intensity)
    oscillator = Filter.kanai_tajimi(intensity, *soil[:2])
    return oscillator.clough_penzien(*soil[2:]) if soil[2:] else oscillator


def forcing(system, parameters):
    entries = filter_of(parameters).forcing(system)
    return Forcing(*(np.broadcast_to(x, system.stiffness.shape) for x in entries))


def draw(seed, kind):
    """A structure, elastic for even seeds, its ground, and their resonances."""
    rng = np.random.default_rng([7, seed, kind])
    xi, wg, xig = (cases.log_uniform(rng, r) for r in ((0.005, 0.2), (0.01, 100), (0.03, 0.9)))
    wf = wg * cases.log_uniform(rng, (0.05, 0.3))
    filters = [1.0, wg, xig, wf, 0.6][:kind]
    resonances = [(1.0, xi), (wg, xig), (wf, 0.6)][: (kind + 1) // 2]
    system = linear_system(np.float64(1.0), np.float64(xi))
    if seed % 2:
        alpha, slip, relaxation = (cases.log_uniform(rng, r) for r in ((0.02, 0.5), *[(1e-4, 0.5)] * 2))
        system = EquivalentSystem(1.0, 2 * xi, 1 - alpha, slip, relaxation)
        resonances += [(np.sqrt(alpha), xi), (relaxation * alpha, 0.5)]
    other = linear_system(np.float64(cases.log_uniform(rng, (0.3, 3))), np.float64(0.04))
    return in_a_row(system), in_a_row(other), [np.array([p]) for p in filters], resonances


@pytest.mark.parametrize("kind", [1, 3, 5], ids=["white", "kanai-tajimi", "clough-penzien"])
@pytest.mark.parametrize("seed", range(4))
def test_first_moment_over_period_ratios_of_ten_thousand(kind, seed):
    system, _, parameters, resonances = draw(seed, kind)
    got = displacement_moments(system, forcing(system, parameters), filter_of(parameters))
    expected = exact_moment(1, [[x[0] for x in system]], [p[0] for p in parameters], resonances)
    assert float(got.l1[0]) == pytest.approx(expected, rel=ACCURACY)


@pytest.mark.parametrize("damping", [0.005, 0.05])
@pytest.mark.parametrize("detuning", [0.0, 1e-9, 1e-5])
@pytest.mark.parametrize("kind", [3, 5])
def test_first_moment_where_the_state_matrix_is_defective(damping, detuning, kind):
    """Structure, soil and high-pass oscillator alike: poles of multiplicity two and three."""
    system = in_a_row(linear_system(np.float64(1.0), np.float64(damping)))
    parameters = [np.array([x]) for x in (1.0, 1 + detuning, damping, 1 - detuning, damping)[:kind]]
    got = displacement_moments(system, forcing(system, parameters), filter_of(parameters))
    resonances = [(1.0, damping)]
    expected = exact_moment(1, [[x[0] for x in system]], [p[0] for p in parameters], resonances)
    assert float(got.l1[0]) == pytest.approx(expected, rel=ACCURACY)


@pytest.mark.parametrize(("seed", "kind"), [(0, 1), (1, 1), (2, 3), (3, 3), (4, 5), (5, 5)])
def test_all_moments_of_a_difference(seed, kind):
    first, second, parameters, resonances = draw(seed, kind)
    pair = [(one, forcing(one, parameters)) for one in (first, second)]
    got = difference_moments(*pair[0], *pair[1], filter_of(parameters))
    systems = [[x[0] for x in one] for one in (first, second)]
    resonances = [*resonances, (float(np.sqrt(second.stiffness[0])), 0.04)]
    for order, moment in enumerate(got):
        expected = exact_moment(order, systems, [p[0] for p in parameters], resonances)
        # Clough-Penzien far from the structures leaves the l0 of both 1e-12
        assert float(moment[0]) == pytest.approx(expected, rel=2 * ACCURACY)


@given(st.floats(1e-3, 0.999))
def test_white_noise_has_a_closed_form(damping):
    """``l1 = l0 w (1 - (2/pi) asin xi)/sqrt(1 - xi^2)``: Vanmarcke (1972)."""
    system = in_a_row(linear_system(np.float64(2.0), np.float64(damping)))
    parameters = [np.array([0.3])]
    l0, l1, _ = displacement_moments(system, forcing(system, parameters), filter_of(parameters))
    ratio = (2 / np.pi) * np.arccos(damping) / np.sqrt(1 - damping**2)
    np.testing.assert_allclose(l1, 2.0 * l0 * ratio, rtol=2e-12)


structures = st.fixed_dictionaries(
    {
        "period": st.floats(0.1, 5),
        "damping": st.floats(0.005, 0.2),
        "hardening": st.floats(0.02, 0.8),
        "reduction_factor": st.floats(0.5, 8),
    }
)
grounds = st.builds(sl.KanaiTajimi, st.floats(0.2, 4), st.floats(0.03, 0.9))


@given(structures, structures, grounds)
def test_moments_are_those_of_a_spectrum(first, second, ground):
    """Positive, ``l1^2 <= l0 l2``, and the variances that the covariances give."""
    solved = [solved_together((sl.Bilinear(**one),), ground, "gaussian") for one in (first, second)]
    for one in solved:
        l0, l1, l2 = (float(x) for x in response_moments(one))
        assert 0 < l1 <= np.sqrt(l0 * l2)
        assert np.sqrt(l0) == pytest.approx(one.values["displacement_std"].item(), rel=1e-12)
        assert np.sqrt(l2) == pytest.approx(one.values["velocity_std"].item(), rel=1e-12)
    rho = float(sl.correlate(sl.Bilinear(**first), sl.Bilinear(**second), ground).rho)
    values = [one.values for one in solved]
    gap = float(sl.critical_gap(*(own["displacement_std"].item() for own in values), rho).gap)
    parts = ((EquivalentSystem(*own["system"]), Forcing(*own["forcing"])) for own in values)
    l0, l1, l2 = (float(x[0]) for x in difference_moments(*chain(*parts), ground.lone_filter()))
    if 1 - rho > 1e-6:  # the difference keeps 1 - rho of the digits
        assert np.sqrt(l0) == pytest.approx(gap, rel=1e-8)
        assert 0 < l1 <= np.sqrt(l0 * l2) * (1 + 1e-8)
