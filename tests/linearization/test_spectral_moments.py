"""First spectral moments against integrals over the real frequency axis, and exact limits."""

import cases
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.spectral_moments import displacement_moments

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


def exact_first_moment(system, parameters, resonances):
    """``2 Int_0^inf w S |H|^2 dw``, split finely around every resonance.

    On each part the integrand is so smooth that 60 points of Gauss and Legendre are exact to
    rounding.
    """
    points = {0.0}
    for w, xi in resonances:
        around = [
            w * (1 + sign * f * 0.7 * xi) for f in (0, 1, 3, 10, 30, 100, 300) for sign in (-1, 1)
        ]
        points |= {float(x) for x in around if x > 0}
    low, high = min(points - {0.0}), max(points)
    points |= {low / 10**n for n in range(1, 6)} | {high * 10**n for n in range(1, 5)}

    def integrand(w):
        return w * density(w, parameters) * abs(transfer(w, system)) ** 2

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
        alpha, slip, relaxation = (
            cases.log_uniform(rng, r) for r in ((0.02, 0.5), *[(1e-4, 0.5)] * 2)
        )
        system = EquivalentSystem(1.0, 2 * xi, 1 - alpha, slip, relaxation)
        resonances += [(np.sqrt(alpha), xi), (relaxation * alpha, 0.5)]
    return in_a_row(system), [np.array([p]) for p in filters], resonances


@pytest.mark.parametrize("kind", [1, 3, 5], ids=["white", "kanai-tajimi", "clough-penzien"])
@pytest.mark.parametrize("seed", range(4))
def test_first_moment_over_period_ratios_of_ten_thousand(kind, seed):
    system, parameters, resonances = draw(seed, kind)
    got = displacement_moments(system, forcing(system, parameters), filter_of(parameters))
    expected = exact_first_moment([x[0] for x in system], [p[0] for p in parameters], resonances)
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
    expected = exact_first_moment([x[0] for x in system], [p[0] for p in parameters], resonances)
    assert float(got.l1[0]) == pytest.approx(expected, rel=ACCURACY)


@given(st.floats(1e-3, 0.999))
def test_white_noise_has_a_closed_form(damping):
    """``l1 = l0 w (1 - (2/pi) asin xi)/sqrt(1 - xi^2)``: Vanmarcke (1972)."""
    system = in_a_row(linear_system(np.float64(2.0), np.float64(damping)))
    parameters = [np.array([0.3])]
    l0, l1, _ = displacement_moments(system, forcing(system, parameters), filter_of(parameters))
    ratio = (2 / np.pi) * np.arccos(damping) / np.sqrt(1 - damping**2)
    np.testing.assert_allclose(l1, 2.0 * l0 * ratio, rtol=2e-12)
