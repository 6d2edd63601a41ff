"""The same structures in other coordinates: displacements of floors, and modes of vibration."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg

import stochlin as sl
from stochlin.kernels.basics.systems import System
from stochlin.solver.linearization.systems.systems import equations_of, response_of, solve_equations
from stochlin.solver.linearization.tolerance import USUAL

pytestmark = pytest.mark.oracle

TALL = sl.ShearBuilding([2e5] * 3, [3e8, 2.5e8, 2e8], [3.0] * 3, 0.05, 0.05, yield_drifts=0.008)
LOW = sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], [3.0] * 2, 0.05, 0.1, yield_drifts=0.006)
GROUND = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.02)
LINK = sl.Link(stiffness=4e7, damping_constant=3e6, floors=(2, 2))


def in_modes(system: System) -> System:
    """The system in the coordinates of its undamped elastic modes, each with participation one."""
    mass = system.mass[0]
    _, modes = scipy.linalg.eigh(system.stiffness[0], np.diag(mass))
    participation = modes.T @ mass
    modes = modes * participation
    return system._replace(
        mass=participation[None] ** 2,
        damping=modes.T @ system.damping @ modes,
        extensions=system.extensions @ modes,
        shapes=system.shapes @ modes,
    )


def motion(equations):
    """Coefficients of the elements, and standard deviations of floors, pairs of floors and springs."""
    solution, system = solve_equations(equations, USUAL), equations.system
    response = response_of(equations, solution)
    floors = system.shapes
    apart = (floors[:, None] - floors).reshape(-1, floors.shape[1])[1:]
    apart = apart[np.abs(apart).max(axis=1) > 0]
    assert response.residual.max() < USUAL.rtol
    return (
        solution.c_eq,
        solution.k_eq,
        response.std(floors),
        response.std(apart),
        response.std(system.extensions, rates=True),
    )


@pytest.mark.parametrize("links", [(), (LINK,)])
@pytest.mark.parametrize("yields", [False, True])
def test_modes_as_coordinates_change_nothing(links, yields):
    pair = [TALL, LOW]
    if not yields:
        pair = [replace(building, hardening=None, yield_drifts=None) for building in pair]
    floors, modes = (equations_of(pair, GROUND, links) for _ in range(2))
    modes.__dict__["system"] = in_modes(floors.system)
    for one, two in zip(motion(floors), motion(modes), strict=True):
        np.testing.assert_allclose(two, one, rtol=1e-8)
