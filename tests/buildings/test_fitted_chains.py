"""Chains of storeys fitted to several modes: exact where there is one, nearest and doubted elsewhere."""

from typing import Any

import numpy as np
import pytest
import scipy.optimize

import stochlin as sl
from stochlin.messages import DoubtfulInput
from stochlin.models.buildings.chains import chain_modes, fitted_stiffnesses

pytestmark = pytest.mark.invariant

MASSES = np.array([2.6e5, 2e5, 2.2e5, 2e5, 1.2e5])
STIFFNESSES = np.array([5e8, 6e8, 4e8, 3.5e8, 2e8])
HEIGHTS = [4.2, 3.3, 3.3, 3.3, 3.3]


def modes_by_numpy(
    stiffnesses: np.ndarray, masses: np.ndarray = MASSES
) -> tuple[np.ndarray, np.ndarray]:
    """Periods and shapes (modes, floors) of a chain, by a dense eigenvalue problem."""
    n = masses.size
    drifts = np.eye(n) - np.eye(n, k=-1)
    root = np.sqrt(masses)
    matrix = drifts.T @ np.diag(stiffnesses) @ drifts / np.outer(root, root)
    squares, vectors = np.linalg.eigh(matrix)
    return 2 * np.pi / np.sqrt(squares), (vectors / root[:, None]).T


def modes_of_chain(count: int, **others: Any) -> sl.ModalBuilding:
    periods, shapes = modes_by_numpy(STIFFNESSES)
    sizes = np.array([-3.0, 0.2, 7.0, -1.0, 1.0])[:count, None]
    values: dict[str, Any] = {"masses": MASSES, "heights": HEIGHTS, "damping": 0.04} | others
    return sl.ModalBuilding(periods[:count], sizes * shapes[:count], **values)


@pytest.mark.parametrize("count", [2, 3, 5])
def test_modes_of_a_chain_give_back_the_chain(count: int) -> None:
    modes = modes_of_chain(count)
    chain = sl.ShearBuilding.fitted(modes, hardening=0.1, yield_drifts=0.01)
    np.testing.assert_allclose(chain.arrays()["stiffnesses"], STIFFNESSES, rtol=1e-9)
    assert (chain.damping, chain.hardening) == (0.04, 0.1)
    np.testing.assert_array_equal(chain.arrays()["heights"], HEIGHTS)
    misfit = chain.misfit(modes)
    np.testing.assert_allclose([misfit.period_error, misfit.shape_error], 0, atol=1e-9)
    assert misfit.mode.values.tolist() == list(range(1, count + 1))


def test_the_chain_is_found_from_far_away() -> None:
    """The shapes have any sign, and the start is off by up to 60 %."""
    periods, shapes = modes_by_numpy(STIFFNESSES)
    start = STIFFNESSES * [0.6, 1.5, 0.7, 1.4, 1.6]
    signs = np.array([1.0, -1.0, 1.0])[:, None]
    weights = np.array([0.8, 0.15, 0.05])
    found = fitted_stiffnesses(start, MASSES, 2 * np.pi / periods[:3], signs * shapes[:3], weights)
    np.testing.assert_allclose(found, STIFFNESSES, rtol=1e-9)


def test_the_fit_to_measured_modes_is_the_least_of_the_sum_of_squares() -> None:
    """The sum as documented, written out with dense eigenvalues, is flat there and less than nearby."""
    rng = np.random.default_rng(5)
    periods, shapes = modes_by_numpy(STIFFNESSES)
    periods = periods[:2] * [1.01, 0.97]
    shapes = shapes[:2] * (1 + 0.01 * rng.standard_normal((2, 5)))
    modes = sl.ModalBuilding(periods, shapes, masses=MASSES, heights=HEIGHTS, damping=0.05)
    weights = modes.effective_masses() / modes.effective_masses().sum()
    unit = shapes / np.sqrt(shapes**2 @ MASSES)[:, None]

    def squares(logarithms: np.ndarray) -> float:
        own_periods, own = modes_by_numpy(np.exp(logarithms))
        own = own[:2] * np.sign((own[:2] * unit) @ MASSES)[:, None]
        of_mode = np.log(own_periods[:2] / periods) ** 2 + (own - unit) ** 2 @ MASSES
        return float(weights @ of_mode)

    chain = sl.ShearBuilding.fitted(modes)
    best = np.log(chain.arrays()["stiffnesses"].to_numpy())
    slope = scipy.optimize.approx_fprime(best, squares, 1e-6)
    away = best + 0.02 * rng.standard_normal((20, 5))
    assert np.abs(slope).max() < 1e-5
    assert min(map(squares, away)) > squares(best)
    start = np.log(STIFFNESSES)
    other = scipy.optimize.minimize(squares, start, method="BFGS", options={"gtol": 1e-9}).x
    np.testing.assert_allclose(best, other, atol=1e-3)


def cantilever(modes: int, floors: int = 40) -> dict[str, Any]:
    """Modes of an Euler-Bernoulli cantilever, by the roots of its characteristic equation."""
    b = np.array([1.8751040687, 4.6940911330, 7.8547574382, 10.9955407349])[:modes]
    x = b[:, None] * np.arange(1, floors + 1) / floors
    share = ((np.sinh(b) - np.sin(b)) / (np.cosh(b) + np.cos(b)))[:, None]
    masses = np.full(floors, 3e5)
    masses[-1] /= 2
    return {
        "periods": 0.8 * (b[0] / b) ** 2,
        "shapes": np.cosh(x) - np.cos(x) - share * (np.sinh(x) - np.sin(x)),
        "masses": masses,
        "heights": [3.0] * floors,
        "damping": 0.05,
    }


def test_of_a_wall_the_fit_says_how_wrong_a_chain_is() -> None:
    """Four modes of a cantilever: no chain has them; numbers are those of its own modes."""
    wall = sl.ModalBuilding(**cantilever(4))
    with pytest.warns(DoubtfulInput, match=r"periods of the nearest one are off by -?\d") as caught:
        chain = sl.ShearBuilding.fitted(wall)
    misfit = chain.misfit(wall)
    for kind in ("period_error", "shape_error"):
        for error in misfit[kind].values:
            assert f"{error:.1%}" in str(caught[0].message)
    assert misfit.shape_error.min() > 0.1
    assert misfit.period_error[2] > 1
    w, shapes = chain_modes(wall.arrays()["masses"].to_numpy(), chain.arrays()["stiffnesses"].to_numpy())
    ratio = 2 * np.pi / w[:4] / wall.arrays()["periods"].to_numpy()
    np.testing.assert_allclose(misfit.period_error, ratio - 1, rtol=1e-12)
    masses = wall.arrays()["masses"].to_numpy()
    own, given = (
        (table.T @ masses / (table.T**2 @ masses) * table).T
        for table in (shapes[:, :4], wall.arrays()["shapes"].to_numpy().T)
    )
    apart = np.abs(own - given).max(axis=1) / np.abs(given).max(axis=1)
    np.testing.assert_allclose(misfit.shape_error, apart, rtol=1e-12)


def test_one_mode_alone_is_kept_and_the_others_tell_the_error() -> None:
    """Of a wall by its first mode the second period is nearly three times too long."""
    values = cantilever(1)
    with pytest.warns(DoubtfulInput, match="of the mass"):
        first = sl.ModalBuilding(**values)
    chain = sl.ShearBuilding.fitted(first)
    np.testing.assert_allclose(chain.misfit(first).period_error, 0, atol=1e-9)
    shape, masses = values["shapes"][0], values["masses"]
    drifts = np.diff(shape, prepend=0.0)
    k = (2 * np.pi / 0.8) ** 2 * (masses * shape)[::-1].cumsum()[::-1] / drifts
    second = modes_by_numpy(k, masses)[0][1]
    misfit = chain.misfit(sl.ModalBuilding(**cantilever(4)))
    wanted = cantilever(4)["periods"][1]
    assert float(misfit.period_error[1]) == pytest.approx(second / wanted - 1, rel=1e-9)
    assert misfit.period_error[1] > 1.6


def test_the_weight_above_does_not_change_the_fit() -> None:
    modes = modes_of_chain(3)
    chain = sl.ShearBuilding.fitted(modes, p_delta=True)
    np.testing.assert_allclose(chain.arrays()["stiffnesses"], STIFFNESSES, rtol=1e-9)


def test_an_uncertain_damping_makes_an_uncertain_chain() -> None:
    chain: Any = sl.ShearBuilding.fitted(modes_of_chain(3), damping=sl.Uncertain(0.05, 0.2))  # type: ignore[arg-type]
    assert chain.median().damping == 0.05


def test_what_cannot_be_fitted_is_said() -> None:
    with pytest.raises(TypeError, match=r"fitted: modes = \[0\.5\]; allowed: a ModalBuilding"):
        sl.ShearBuilding.fitted([0.5])  # type: ignore[arg-type]
    several = modes_of_chain(2, damping=[0.05, 0.03])
    with pytest.raises(ValueError, match="damping is not given, and the modes have different ratios"):
        sl.ShearBuilding.fitted(several)
    assert sl.ShearBuilding.fitted(several, damping=0.03).damping == 0.03
    values = {"masses": [2e5, 2e5], "heights": [3.0, 3.0], "damping": 0.05}
    swayed = sl.ModalBuilding([0.5, 0.4], [[1.0, 0.9], [-0.9, 1.0]], **values)
    with pytest.raises(ValueError, match=r"shape does not grow in storey 2, from 1 to 0\.9"):
        sl.ShearBuilding.fitted(swayed)
    given = {"participation": [1.3, 0.3], "modal_masses": [3.6e5, 3e4]}
    corner = sl.ModalBuilding([0.5, 0.4], [[0.5, 1.0], [0.4, 1.0]], **values, **given)
    with pytest.raises(ValueError, match="shapes of modes 1 and 2 are not orthogonal"):
        sl.ShearBuilding.fitted(corner)
    with pytest.raises(ValueError, match=r"modes has 2 modes of 2 floors; allowed: .* of 5 floors"):
        sl.ShearBuilding.fitted(modes_of_chain(3)).misfit(swayed)
