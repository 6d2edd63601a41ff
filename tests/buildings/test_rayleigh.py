"""Rayleigh damping: its matrix and modal ratios; the manual has frames that yield with it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.invariant

MASSES, STIFFNESSES, HEIGHTS = (
    [3e5, 2.8e5, 2.5e5, 2e5],
    [5e8, 4e8, 3.5e8, 2e8],
    [4.0, 3.2, 3.2, 3.2],
)


def frame(damping: float = 0.05, **others: Any) -> sl.ShearBuilding:
    return sl.ShearBuilding(MASSES, STIFFNESSES, HEIGHTS, damping, **others)


@pytest.mark.parametrize("modes", [(1, 3), (4, 1), (2, 3)])
@pytest.mark.parametrize("p_delta", [False, True])
def test_two_modes_have_the_ratio_by_masses_and_stiffness(
    modes: tuple[int, int], p_delta: bool
) -> None:
    """Factors follow from two linear equations, ratios from eigenvalues of the state matrix."""
    building = frame(damping_modes=modes, p_delta=p_delta, dampers=[2e6, 0, 0, 0])
    t = np.eye(4) - np.eye(4, k=-1)
    stiffness = t.T @ np.diag(STIFFNESSES - building.geometric_stiffness()) @ t
    root = np.sqrt(MASSES)
    w = np.sqrt(np.linalg.eigvalsh(stiffness / np.outer(root, root)))
    both = w[[n - 1 for n in modes]]
    a0, a1 = np.linalg.solve(np.stack([1 / (2 * both), both / 2], axis=1), [0.05, 0.05])
    wanted = a0 * np.diag(MASSES) + a1 * stiffness
    np.testing.assert_allclose(
        building.damping_matrix() - wanted, np.diag([2e6, 0, 0, 0]), atol=1e-2
    )
    ratios = building.damping_ratios()
    np.testing.assert_allclose(ratios, a0 / (2 * w) + a1 * w / 2, rtol=1e-9)
    assert building.oscillator().damping == float(ratios[0])
    without = frame(damping_modes=modes, p_delta=p_delta)
    space = sl.statespace([without], sl.WhiteNoise(0.01))
    roots = np.linalg.eigvals(space.state_matrix.values)
    roots = sorted(roots[roots.imag > 0], key=abs)
    np.testing.assert_allclose(-np.real(roots) / np.abs(roots), ratios, rtol=1e-9)
    # The ratios follow the new frequencies.
    stiffer = replace(without, stiffnesses=without.stiffnesses * 2.0)
    np.testing.assert_allclose(stiffer.damping_ratios().sel(mode=list(modes)), 0.05, rtol=1e-12)


@pytest.mark.parametrize(
    "modes", [(1, 1), (0, 1), (1, 5), (1, 2.0), (True, 2), (1,), (1, 2, 3), "13", 1, {1, 2}]
)
def test_modes_that_do_not_fit_are_refused(modes: Any) -> None:
    with pytest.raises(ValueError, match=r"^ShearBuilding: damping_modes = .*two different modes"):
        frame(damping_modes=modes)


def test_a_first_mode_that_does_not_vibrate_is_refused() -> None:
    told = r"damping_modes = \(3, 4\) give mode 1 the damping ratio 1\.\d+; allowed: below 1"
    with pytest.raises(ValueError, match=told):
        frame(0.6, damping_modes=(3, 4))
