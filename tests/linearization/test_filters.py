"""Filters of any number of states: against closed forms, and in whole systems against Lyapunov."""

from dataclasses import dataclass

import cases
import numpy as np
import pytest
import scipy.integrate
import scipy.linalg

import stochlin as sl
from stochlin.kernels.linearization.covariance import EquivalentSystem, linear_system
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.spectral_moments import displacement_moments
from stochlin.kernels.simulation.stepping import LANES, filter_steps, ground_block
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Parameter, Range, parameter

pytestmark = pytest.mark.oracle

N = 300
# Of periods that differ by up to 60 the equations have a condition of some 1e5: reached is 7e-11.
CLOSE = 1e-10


def in_general(ground):
    """The same filter without its closed forms."""
    return Filter(ground.intensity, ground.states, ground.matrix, ground.noise, ground.output)


def draw(rng):
    def spread(low, high):
        return cases.log_uniform(rng, (low, high), N)

    w = spread(1, 60)
    soil = Filter.kanai_tajimi(spread(0.01, 1), spread(1, 60), spread(0.02, 0.9))
    layer = soil.clough_penzien(soil.fastest * spread(0.05, 0.3), spread(0.2, 1.2))
    damping, coupling = 2 * spread(0.005, 0.2) * w, (1 - spread(0.005, 0.5)) * w**2
    yielding = EquivalentSystem(w**2, damping, coupling, spread(1e-6, 0.6), w * spread(1e-6, 0.5))
    return soil, layer, {"elastic": linear_system(w, damping / 2 / w), "yielding": yielding}


@pytest.mark.parametrize("law", ["elastic", "yielding"])
@pytest.mark.parametrize("which", ["Kanai-Tajimi", "Clough-Penzien"])
def test_closed_forms_are_those_of_the_general_filter(which, law):
    soil, layer, systems = draw(np.random.default_rng(21))
    closed, system = soil if which == "Kanai-Tajimi" else layer, systems[law]
    general = in_general(closed)
    exact = closed.forcing(system)
    for found, expected in zip(general.forcing(system), exact, strict=True):
        np.testing.assert_allclose(found, expected, rtol=CLOSE)
    moments = [displacement_moments(system, exact, one).l1 for one in (general, closed)]
    np.testing.assert_allclose(*moments, rtol=CLOSE)
    spectra = [one.transmission(np.linspace(0.1, 90, N)) for one in (general, closed)]
    np.testing.assert_allclose(*spectra, rtol=CLOSE)
    np.testing.assert_array_less(general.fastest, closed.fastest * 1.5 + soil.fastest)
    one = general.at(slice(3, 4)).forcing(EquivalentSystem(*(row[3:4] for row in system)))
    np.testing.assert_allclose(np.ravel(one), [row[3] for row in exact], rtol=CLOSE)


def test_white_noise_is_a_filter_without_states():
    system = linear_system(np.array([2.0]), np.array([0.05]))
    noise = Filter(0.3)
    np.testing.assert_allclose(noise.forcing(system).velocity, np.pi * 0.3)
    assert noise.transmission(np.array([1.0, 2.0])).tolist() == [1, 1]
    assert noise.fastest == 0


def test_a_filter_whose_sizes_disagree_is_refused():
    with pytest.raises(ValueError, match=r"2 states has a matrix of rows of \[2, 1\].*allowed"):
        Filter(1.0, ("x", "v"), [[0, 1], [-1]], [0, 1], [1, 0])


@dataclass(frozen=True)
class Layers(Ground):
    """Two layers of soil that feel one another; the acceleration of the upper one."""

    name = "layers"
    period: Parameter = parameter("s", "ground period", Range())
    damping: Parameter = parameter("1", "damping ratio", Range())
    intensity: Parameter = parameter("m^2/s^3", "PSD", Range(), 1.0)

    @staticmethod
    def filter(values):
        w, ratio = 2 * np.pi / values["period"], values["damping"]
        stiffness = (2 * w**2, -(w**2)), (-(w**2), w**2)
        lower = [[-x for x in (*row, *(2 * ratio / w * k for k in row))] for row in stiffness]
        matrix = [[0, 0, 1, 0], [0, 0, 0, 1], *lower]
        return Filter(
            values["intensity"], tuple("abcd"), matrix, [0, 0, 1, 1], [-x for x in lower[1]]
        )


LAYERS = Layers(0.3, 0.2, 0.02)
PERIODS, DAMPING = (0.7, 1.0), 0.05
PAIR = [sl.Bilinear(period, DAMPING) for period in PERIODS]


def whole(ground):
    """Matrix and noise of ``u_1, v_1, u_2, v_2`` and the filter."""
    soil = ground.lone_filter().arrays
    m = soil.noise.size
    matrix, noise = np.zeros((4 + m, 4 + m)), np.zeros((4 + m, 4 + m))
    for at, period in zip((0, 2), PERIODS, strict=True):
        w = 2 * np.pi / period
        matrix[at, at + 1] = 1
        matrix[at + 1, at : at + 2] = -(w**2), -2 * DAMPING * w
        matrix[at + 1, 4:] = soil.output
    matrix[4:, 4:] = soil.matrix
    noise[4:, 4:] = 2 * np.pi * ground.intensity * np.outer(soil.noise, soil.noise)
    return matrix, noise


def stationary(ground):
    matrix, noise = whole(ground)
    return scipy.linalg.solve_continuous_lyapunov(matrix, -noise)


def test_elastic_structures_are_exact():
    x = stationary(LAYERS)
    table = sl.correlate(*PAIR, LAYERS)
    assert float(table.rho) == pytest.approx(x[0, 2] / np.sqrt(x[0, 0] * x[2, 2]), rel=1e-9)
    both = sl.linearize(sl.Bilinear(np.array(PERIODS), DAMPING), LAYERS)
    np.testing.assert_allclose(both.displacement_std**2, x[[0, 2], [0, 2]], rtol=1e-9)
    np.testing.assert_allclose(both.velocity_std**2, x[[1, 3], [1, 3]], rtol=1e-9)
    order = ["u_1", "v_1", "u_2", "v_2"]
    found = sl.stationary_covariance(sl.statespace(PAIR, LAYERS)).sel(state=order, state_2=order)
    np.testing.assert_allclose(found, x[:4, :4], rtol=0, atol=1e-10 * x[:4, :4].max())


@pytest.mark.parametrize("closure", ["gaussian", "drift"])
def test_yielding_structures_are_those_of_their_state_space(closure):
    structure = sl.Bilinear(0.8, 0.05, 0.1, reduction_factor=3)
    table = sl.linearize(structure, LAYERS, closure)
    assert int(table.status) == 0
    if closure == "gaussian":
        space = sl.statespace([structure], LAYERS, [float(table.c_eq)], [float(table.k_eq)])
        variance = float(sl.stationary_covariance(space).sel(state="u_1", state_2="u_1"))
        assert float(table.displacement_std) == pytest.approx(np.sqrt(variance), rel=1e-8)
    assert np.isnan(table.bias)


def test_spectrum_integrates_to_the_variances():
    soil = LAYERS.lone_filter().arrays
    covariance = stationary(LAYERS)
    w = np.concatenate([np.linspace(0, 400, 200_001), np.geomspace(400, 1e7, 25_001)[1:]])
    psd = LAYERS.psd(w)
    assert psd.attrs["units"] == "m^2/s^3"
    variance = 2 * scipy.integrate.trapezoid(psd.values, w)
    # Beyond 1e7 rad/s is 1e-5 of it.
    assert variance == pytest.approx(soil.output @ covariance[4:, 4:] @ soil.output, rel=3e-5)
    own = (2 * np.pi / PERIODS[0]) ** 2
    response = psd.values / ((own - w**2) ** 2 + (2 * DAMPING * w) ** 2 * own)
    moments = [2 * scipy.integrate.trapezoid(w**order * response, w) for order in range(3)]
    assert moments[0] == pytest.approx(covariance[0, 0], rel=1e-7)
    peak = sl.peak_response(PAIR[0], LAYERS, duration=20.0)
    bandwidth = np.sqrt(1 - moments[1] ** 2 / (moments[0] * moments[2]))
    assert float(peak.bandwidth) == pytest.approx(bandwidth, rel=1e-6)


def stepped(steps, start, xi):
    q, f = start.copy(), np.empty_like(xi)
    ground_block(steps)(xi, q, f)
    return q, f


@pytest.mark.parametrize(
    "ground",
    [
        LAYERS,
        sl.KanaiTajimi(0.5, 0.4),
        sl.CloughPenzien(0.5, 0.4, 3.0, 0.6),
        sl.ParallelGround([sl.CloughPenzien(0.5, 0.4, 3.0, 0.6), sl.KanaiTajimi(0.2, 0.3)]),
    ],
    ids=lambda g: type(g).__name__,
)
def test_compiled_steps_are_those_of_the_matrices(ground):
    """Of any size, and in parts where states do not act on one another."""
    soil = ground.lone_filter().arrays
    steps = filter_steps(*soil, 0.7, 0.02)
    rng = np.random.default_rng(5)
    start, xi = rng.standard_normal((soil.noise.size, LANES)), rng.standard_normal((7, LANES))
    q, forces = start.copy(), []
    for number in xi:
        forces.append(steps.row @ q + steps.direct * number)
        q = steps.transition @ q + steps.gain[:, None] * number
    found, f = stepped(steps, start, xi)
    np.testing.assert_allclose(found, q, rtol=0, atol=1e-12 * np.abs(q).max())
    np.testing.assert_allclose(f, forces, rtol=0, atol=1e-12 * np.abs(forces).max())
