"""Buildings with many storeys: structures that are not linked are solved one by one."""

import numpy as np
import pytest
import scipy.linalg

import stochlin as sl
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.kernels.linearization.systems.state_space import state_space
from stochlin.kernels.linearization.systems.substitution import Linear
from stochlin.models.systems import arrangement_of
from stochlin.solver.linearization.systems.state_space import springs_of

pytestmark = pytest.mark.oracle

GROUNDS = {
    "white noise": sl.WhiteNoise(0.01),
    "Kanai-Tajimi": sl.KanaiTajimi(1.0, 0.3, intensity=0.01),
}


def building(storeys):
    return sl.ShearBuilding.regular(
        period=0.1 * storeys,
        storeys=storeys,
        storey_height=3.0,
        mass=1e6,
        damping=0.05,
        hardening=0.05,
        base_shear_coefficient=0.08,
    )


def problem_of(storeys, ground, links=()):
    return springs_of(arrangement_of([building(n) for n in storeys], links), GROUNDS[ground])


def coefficients(problem, seed):
    rng, shape = np.random.default_rng(seed), problem.strength.shape
    return Linear(rng.uniform(0.02, 0.6, shape), rng.uniform(0.2, 4, shape), problem.dashpots)


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize(
    ("storeys", "linked"),
    [
        ((1, 1), False),
        ((3, 2), False),
        ((3, 2), True),
        ((13,), False),
        ((24, 15), False),
        ((24, 15), True),
    ],
)
def test_covariance_is_that_of_scipy_for_the_whole_matrix(storeys, ground, linked):
    """In units of the standard deviations; scipy solves for all states together."""
    links = [sl.Link(1e6, 1e4, structures=(1, 2))] if linked else []
    problem = problem_of(storeys, ground, links)
    linear = coefficients(problem, 35)
    system = state_space(problem, linear.slip - 1, linear.relaxation, linear.dashpots)
    found = StationaryResponse(system).covariance[0]
    matrix, noise = system.matrix[0], system.noise[0]
    std = np.sqrt(np.diagonal(found))
    right = system.intensity[0] * np.outer(noise / std, noise / std)
    known = scipy.linalg.solve_continuous_lyapunov(matrix * std / std[:, None], -right)
    np.testing.assert_allclose(found / np.outer(std, std), known, atol=1e-7)


@pytest.mark.invariant
def test_a_building_beside_another_is_as_it_is_alone():
    """Each is solved in its own states and those of the ground."""
    ground = GROUNDS["Kanai-Tajimi"]
    pair = sl.linearize_system([building(24), building(15)], ground)
    for number, storeys in ((1, 24), (2, 15)):
        alone = sl.linearize_system([building(storeys)], ground)
        for name in ("c_eq", "k_eq"):
            own = [str(e).startswith(f"{number}") for e in pair.element.values]
            np.testing.assert_allclose(pair[name][own], alone[name], rtol=1e-8)
