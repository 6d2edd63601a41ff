"""Rayleigh damping: ratios of the modes, one matrix in every analysis, and what yielding storeys do."""

from contextlib import suppress
from typing import Any

import numpy as np
import pytest
import xarray as xr
from cases import assert_near
from hypothesis import given, reject
from hypothesis import strategies as st
from motions import from_sample_to_sample, shaking
from runge_kutta import Frame

import stochlin as sl
from stochlin.models.systems import tuned

MASSES, STIFFNESSES, HEIGHTS = [3e5, 2.8e5, 2.5e5, 2e5], [5e8, 4e8, 3.5e8, 2e8], [4.0, 3.2, 3.2, 3.2]
RAYLEIGH: dict[str, Any] = {"damping_model": "rayleigh", "damping_modes": (1, 3)}
YIELDING: dict[str, Any] = {"hardening": 0.05, "yield_drifts": [0.009, 0.008, 0.007, 0.007]}
FIRM = sl.KanaiTajimi(0.4, 0.6, 0.02)


def frame(**others: Any) -> sl.ShearBuilding:
    return sl.ShearBuilding(MASSES, STIFFNESSES, HEIGHTS, 0.05, **others)


def matrices(building: sl.ShearBuilding) -> tuple[np.ndarray, np.ndarray]:
    """Masses and stiffness, written out."""
    values = building.arrays()
    k = values["stiffnesses"].to_numpy() - building.geometric_stiffness()
    t = np.eye(k.size) - np.eye(k.size, k=-1)
    return np.diag(values["masses"].to_numpy()), t.T @ np.diag(k) @ t


def factors(building: sl.ShearBuilding, ratio: float, modes: tuple[int, int]) -> np.ndarray:
    """``a0`` and ``a1`` that give two modes the ratio, from two linear equations."""
    mass, stiffness = matrices(building)
    root = np.sqrt(np.diag(mass))
    w = np.sqrt(np.linalg.eigvalsh(stiffness / np.outer(root, root)))[[n - 1 for n in modes]]
    return np.linalg.solve(np.stack([1 / (2 * w), w / 2], axis=1), [ratio, ratio])


@st.composite
def damped(draw: st.DrawFn) -> sl.ShearBuilding:
    storeys = draw(st.integers(2, 9))

    def several(low: float, high: float) -> list[float]:
        return draw(st.lists(st.floats(low, high), min_size=storeys, max_size=storeys))

    modes = draw(st.lists(st.integers(1, storeys), min_size=2, max_size=2, unique=True))
    with suppress(ValueError):  # of a first mode with too much damping
        return sl.ShearBuilding(
            *(several(1e4, 1e6), several(1e8, 1e9), several(2.5, 6), draw(st.floats(0.01, 0.3))),
            p_delta=draw(st.booleans()),
            damping_model="rayleigh",
            damping_modes=(modes[0], modes[1]),
        )
    reject()


# --- The matrix and the ratios of the modes ---


@pytest.mark.invariant
@given(damped())
def test_the_matrix_is_that_of_masses_and_stiffness(building: sl.ShearBuilding) -> None:
    assert building.damping_modes is not None
    mass, stiffness = matrices(building)
    a0, a1 = factors(building, building.damping, building.damping_modes)
    wanted = a0 * mass + a1 * stiffness
    found = building.damping_matrix()
    np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())
    w = 2 * np.pi / building.periods().to_numpy()
    ratios = building.damping_ratios()
    np.testing.assert_allclose(ratios, a0 / (2 * w) + a1 * w / 2, rtol=1e-9)
    chosen = ratios.sel(mode=list(building.damping_modes))
    np.testing.assert_allclose(chosen, building.damping, rtol=1e-13)
    assert building.oscillator().damping == float(ratios[0])


@pytest.mark.invariant
def test_eigenvalues_of_the_state_matrix_have_the_ratios_of_all_modes() -> None:
    building = frame(**RAYLEIGH)
    space = sl.statespace([building], sl.WhiteNoise(0.01), [-1] * 4, [0] * 4)
    roots = np.linalg.eigvals(space.state_matrix.values)
    roots = roots[roots.imag > 0]
    roots = roots[np.argsort(abs(roots))]
    a0, a1 = factors(building, 0.05, (1, 3))
    w = 2 * np.pi / building.periods().to_numpy()
    np.testing.assert_allclose(abs(roots), w, rtol=1e-10)
    np.testing.assert_allclose(-roots.real / abs(roots), a0 / (2 * w) + a1 * w / 2, rtol=1e-10)


@pytest.mark.invariant
@pytest.mark.parametrize("modes", [(1, 2), (2, 1)])
def test_two_storeys_with_both_modes_have_modal_damping(modes: tuple[int, int]) -> None:
    given = MASSES[:2], STIFFNESSES[:2], HEIGHTS[:2], 0.04
    modal, rayleigh = (
        sl.ShearBuilding(*given, **own)
        for own in ({}, {"damping_model": "rayleigh", "damping_modes": modes})
    )
    np.testing.assert_allclose(rayleigh.damping_matrix(), modal.damping_matrix(), rtol=1e-13)
    both = [sl.linearize_system([each], FIRM).drift_std for each in (modal, rayleigh)]
    np.testing.assert_allclose(*both, rtol=1e-10)


@pytest.mark.invariant
def test_modal_damping_is_the_default_and_dampers_come_on_top() -> None:
    np.testing.assert_array_equal(
        frame().damping_matrix(), frame(damping_model="modal").damping_matrix()
    )
    assert "damping_model" not in frame().describe()
    assert frame(**RAYLEIGH).describe().endswith("damping_model=rayleigh, damping_modes=(1, 3))")
    np.testing.assert_array_equal(frame().damping_ratios(), 0.05)
    added = (
        frame(**RAYLEIGH, dampers=[2e6, 0, 0, 0]).damping_matrix() - frame(**RAYLEIGH).damping_matrix()
    )
    wanted = np.zeros((4, 4))
    wanted[0, 0] = 2e6
    np.testing.assert_allclose(added, wanted, rtol=0, atol=1e-8)


@pytest.mark.invariant
def test_all_ways_to_a_building_and_their_changes_keep_the_damping() -> None:
    """The ratio in the two modes does not depend on the stiffness, so that the matrix follows it."""
    buildings = [
        sl.ShearBuilding.regular(
            period=0.6, storeys=4, storey_height=3.0, mass=3e5, damping=0.05, **RAYLEIGH
        ),
        frame(**RAYLEIGH).stiffened(2.0),
        tuned(frame(**RAYLEIGH), 0.9),
        sl.ShearBuilding.regular(
            **{"period": sl.Uncertain(0.6, 0.2), "storeys": 4, "storey_height": 3.0, "mass": 3e5},
            **{"damping": sl.Uncertain(0.05, 0.1), **RAYLEIGH},
        ).median(),
    ]
    for building in buildings:
        assert building.damping_modes == (1, 3)
        np.testing.assert_allclose(building.damping_ratios()[[0, 2]], 0.05, rtol=1e-12)
        assert float(building.damping_ratios()[1]) < 0.05 < float(building.damping_ratios()[3])


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("own", "told"),
    [
        ({"damping_model": "rayleigh"}, r"damping_modes is not given; .* 1 to 4, as \[1, 3\]"),
        ({"damping_modes": (1, 3)}, r'damping_modes = \(1, 3\) belongs to damping_model = "rayleigh"'),
        (
            {"damping_model": "Raleigh"},
            "damping_model = 'Raleigh' is not known; did you mean 'rayleigh'",
        ),
        *[
            ({"damping_model": "rayleigh", "damping_modes": modes}, "damping_modes = .*two different")
            for modes in ((1, 1), (0, 1), (1, 5), (1, 2.0), (True, 2), (1,), (1, 2, 3), "13", 1, {1, 2})
        ],
    ],
)
def test_damping_that_does_not_fit_is_refused(own: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=f"^ShearBuilding: {told}"):
        frame(**own)


@pytest.mark.invariant
def test_a_first_mode_that_does_not_vibrate_is_refused() -> None:
    given = {"damping_model": "rayleigh", "damping_modes": (3, 4)}
    told = r"damping_modes = \(3, 4\) give mode 1 the damping ratio 1\.\d+; allowed: below 1"
    with pytest.raises(ValueError, match=told):
        sl.ShearBuilding(MASSES, STIFFNESSES, HEIGHTS, 0.6, **given)


@pytest.mark.invariant
def test_buildings_of_one_storey_or_by_modes_have_no_rayleigh_damping() -> None:
    low = {"damping_model": "rayleigh", "damping_modes": (1, 2)}
    with pytest.raises(ValueError, match='two modes, and one storey has one; allowed: "modal"'):
        sl.ShearBuilding([1e5], [1e8], [3.0], 0.05, **low)
    by_modes = [0.5], [[0.6, 1.0]], [2e5] * 2, [3.0] * 2, 0.05
    with pytest.raises(
        TypeError, match="damping_model belongs to a ShearBuilding; allowed by modes: da"
    ):
        sl.ModalBuilding(*by_modes, **low)
    modes = xr.Dataset({"period": ("mode", [0.5]), "shape": (("mode", "floor"), [[0.6, 1.0]])}).assign(
        mass=("floor", [2e5] * 2), height=("floor", [3.0] * 2)
    )
    with pytest.raises(TypeError, match="damping_modes belongs to a ShearBuilding"):
        sl.ModalBuilding.from_table(modes, damping=0.05, damping_modes=(1, 2))


# --- Analyses ---


@pytest.mark.oracle
def test_stationary_response_is_that_of_the_modes_with_their_ratios() -> None:
    """Classical damping: modes with the ratios of Rayleigh damping move a chain just as well."""
    building = frame(**RAYLEIGH)
    modes = sl.ModalBuilding(
        building.periods().values,
        building._modes()[1].T.tolist(),
        *(MASSES, HEIGHTS, building.damping_ratios().values),
    )
    pairs = [[each, sl.Bilinear(0.6, 0.05)] for each in (building, modes)]
    tables = [sl.linearize_system(pair, FIRM) for pair in pairs]
    for name in ("displacement_std", "rho"):
        np.testing.assert_allclose(*(table[name] for table in tables), rtol=1e-8)
    usual = {"duration": 8.0, "paths": 32, "steps_per_period": 32}
    peaks = [sl.simulate(pair, FIRM, **usual).peak for pair in pairs]
    assert_near(*peaks, 1e-3)  # their time steps differ
    gaps = [
        sl.pounding_probability(*pair, FIRM, 0.05, duration=8.0, paths=0).confidence_of_no_pounding
        for pair in pairs
    ]
    np.testing.assert_allclose(*gaps, rtol=1e-6)
    moved = [sl.respond(each, shaking(200)).displacement.values for each in (building, modes)]
    assert_near(*moved, 1e-3)


def _by_scipy(building: sl.ShearBuilding, motion: xr.DataArray) -> tuple[np.ndarray, np.ndarray]:
    """Displacements of the floors of bilinear storeys, and energy in the dashpots [J], with time."""
    mass, stiffness = matrices(building)
    a0, a1 = factors(building, 0.05, (1, 3))
    damping, m, n = a0 * mass + a1 * stiffness, np.diag(mass), 4
    k, uy, alpha = np.array(STIFFNESSES), np.array(YIELDING["yield_drifts"]), YIELDING["hardening"]

    def rates(t: float, x: np.ndarray, ground: float, slope: float) -> np.ndarray:
        u, v, z = x[: 3 * n].reshape(3, n)
        drift, pace = np.diff(u, prepend=0.0), np.diff(v, prepend=0.0)
        shear = k * (alpha * drift + (1 - alpha) * np.clip(z, -uy, uy))
        drag = damping @ v
        net = shear - np.append(shear[1:], 0.0)
        slides = (abs(z) >= uy) & (z * pace > 0)
        gain = -(net + drag) / m - ground - slope * t
        return np.concatenate([v, gain, np.where(slides, 0.0, pace), [v @ drag]])

    def mend(state: np.ndarray) -> np.ndarray:
        state[2 * n : 3 * n] = np.clip(state[2 * n : 3 * n], -uy, uy)
        return state

    options = {"method": "DOP853", "rtol": 1e-8, "atol": 1e-11, "max_step": 2e-3}
    states = from_sample_to_sample(rates, motion, 3 * n + 1, mend, **options)
    return states[:, :n], states[:, -1]


@pytest.mark.slow
@pytest.mark.oracle
def test_a_yielding_frame_moves_and_is_damped_as_by_another_integrator() -> None:
    building, motion = frame(**YIELDING, **RAYLEIGH), 3 * shaking(100)
    wanted, energy = _by_scipy(building, motion)
    drifts = abs(np.diff(wanted, axis=1, prepend=0.0)).max(axis=0)
    assert (drifts / YIELDING["yield_drifts"]).max() > 2
    assert_near(sl.respond(building, motion).displacement.values, wanted, 1e-3)
    neighbour = sl.Bilinear(0.3, 0.05, mass=2e5)
    table = sl.pound([building, neighbour], 5.0, sl.LinearSpring(1e8), motion, steps_per_contact=64)
    assert_near(table.displacement.values[:, 0, :4], wanted, 1e-4)
    assert float(table.viscous_energy.sel(structure=1)[-1]) == pytest.approx(energy[-1], rel=1e-3)
    assert float(table.energy_balance_error.max()) < 1e-6


# --- Damping on the stiffness of before yielding: the numbers of the page ---

M, K = 1e5 * np.array([3, 3, 3, 3, 3, 2.4]), 1e8 * np.array([4.2, 4, 3.6, 3.1, 2.5, 1.8])
UY = np.array([12, 12, 11, 10, 9, 8]) / 1000
FORCES = ((0.02, 0.062, 0.147), (0.05, 0.083, 0.198))  # S0, largest forces over the strength
SHAKING = ((0.02, 1.8, 0.97), (0.05, 3.1, 0.955))  # S0, mean ductility, least ratio of drifts


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize(("intensity", "ductility", "least"), SHAKING)
def test_drifts_are_a_little_smaller_than_with_damping_on_the_tangent_stiffness(
    intensity: float, ductility: float, least: float
) -> None:
    """By a program that has both, in the same motions."""
    step, own = 0.005, 1 / (2 * UY[:, None] ** 3)
    noise = np.random.default_rng(0).standard_normal((3000, 512)) * np.sqrt(2 * np.pi * intensity / step)
    initial, tangent = (
        Frame(M, K, 0.05, 0.05, 3, own, own, (1, 3), later).peaks(noise, step)[0].mean(axis=1)
        for later in (False, True)
    )
    assert np.mean(initial / UY) == pytest.approx(ductility, abs=0.1)
    ratio = initial / tangent
    assert ratio.min() == pytest.approx(least, abs=0.004)
    assert ratio.max() < 1.01


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize(
    ("intensity", "dashpots", "whole"), [(0.02, 0.062, 0.147), (0.05, 0.083, 0.198)]
)
def test_dashpots_of_yielding_storeys_carry_a_small_share_of_their_strength(
    intensity: float, dashpots: float, whole: float
) -> None:
    """Medians over motions of the largest force of a storey's dashpot, and of all damping above it."""
    law = {"beta": 0.5, "gamma": 0.5, "exponent": 3.0}
    frames = [
        sl.ShearBuilding(
            *(M, K, [3.2] * 6, 0.05, 0.05, UY), law="bouc_wen", law_parameters=law, **damping
        )
        for damping in (RAYLEIGH, {})
    ]
    motions = sl.simulated_motions(sl.WhiteNoise(intensity), 15.0, paths=16, step=0.02)
    rates = [
        np.stack([sl.respond(each, motion).velocity.values for motion in motions]) for each in frames
    ]
    _, a1 = factors(frames[0], 0.05, (1, 3))
    strength = K * UY
    largest = abs(a1 * K * np.diff(rates[0], axis=-1, prepend=0.0)).max(axis=1) / strength
    assert np.median(largest, axis=0).max() == pytest.approx(dashpots, rel=0.08)
    for each, velocities in zip(frames, rates, strict=True):
        forces = (velocities @ each.damping_matrix())[..., ::-1].cumsum(axis=-1)[..., ::-1]
        shares = np.median(abs(forces).max(axis=1) / strength, axis=0)
        assert shares.max() == pytest.approx(whole, rel=0.08)
