"""Simulation against exact results, earlier runs, itself at finer steps, and its own errors."""

import cases
import numpy as np
import pytest
import scipy.linalg
import scipy.stats

import stochlin as sl
from stochlin.solver.simulation import stationary_motions
from stochlin.solver.simulation.stationary_motions import (
    NOT_STATIONARY,
    _time_constant,
    simulate_moments,
    with_length,
)
from stochlin.solver.simulation.structures_in_motion import structures_in_motion
from stochlin.solver.tables import labels

pytestmark = pytest.mark.oracle

ERRORS = 4.0  # standard errors: beyond them once in 16 000 numbers
NOISE = sl.WhiteNoise(0.01)


def yielding(period, strength_ratio, hardening=0.05, model=sl.Bilinear):
    """``strength_ratio`` is elastic standard deviation over yield displacement."""
    return model(period, damping=0.05, hardening=hardening, reduction_factor=3 * strength_ratio)


def ensemble(structures, ground, **options):
    """Run of some oscillators, ready for `moments_of` with any seed."""
    relaxation_times = options.pop("relaxation_times")
    moving = structures_in_motion(structures, ground, None, True, **options)
    return with_length(moving.run, relaxation_times)


def moments_of(run, **plan):
    return simulate_moments(run.with_plan(**plan), np.eye(run.order.size), None)


# ---- (1) Values of an earlier simulation by other code, [standard error] ----


def test_yielding_structures_on_white_noise_have_the_ductilities_of_an_earlier_simulation():
    expected = np.array([0.6588, 1.3464, 3.1765, 0.8682])
    its_error = np.array([0.0041, 0.0051, 0.0081, 0.0014])
    structures = [yielding(1.0, ratio) for ratio in (0.5, 1.0, 2.0)] + [yielding(1.0, 1.0, 0.2)]
    table = sl.simulate(structures, NOISE, seed=11, relaxation_times=40)
    error = table.displacement_std_standard_error / table.displacement_std * table.ductility_std
    assert (error < its_error).all()
    assert (np.abs(table.ductility_std - expected) < ERRORS * np.hypot(error, its_error)).all()


HALF_A_DIGIT = 0.0005
ITS_SCATTER = 0.005  # allowed for the earlier simulation, whose errors of rho are not known

SERIES = {
    "white noise": (NOISE, [0.3, 0.5, 0.7, 0.8, 0.9], [0.372, 0.448, 0.585, 0.722, 0.895]),
    "narrow band": (
        sl.KanaiTajimi(1.0, 0.05),
        [0.5, 0.7, 0.9, 1.2, 1.5, 2.0],
        [0.649, 0.706, 0.820, 0.483, 0.262, 0.171],
    ),
}


@pytest.mark.parametrize(("ground", "ratios", "expected"), SERIES.values(), ids=SERIES.keys())
def test_yielding_pairs_have_the_correlations_of_an_earlier_simulation(ground, ratios, expected):
    structures = [yielding(ratio, 4 / 3) for ratio in (*ratios, 1.0)]
    table = sl.simulate(structures, ground, paths=512, seed=12, relaxation_times=40)
    rho, error = table.rho.values[-1, :-1], table.rho_standard_error.values[-1, :-1]
    assert (error < ITS_SCATTER).all()
    assert (np.abs(rho - expected) < ERRORS * error + HALF_A_DIGIT + ITS_SCATTER).all()


# ---- (2) Elastic structures: exact for any step ----

GROUNDS = {
    "white noise": lambda rng: sl.WhiteNoise(rng.uniform(0.1, 2)),
    "Kanai-Tajimi": lambda rng: sl.KanaiTajimi(rng.uniform(0.4, 2), rng.uniform(0.05, 0.8)),
    "Clough-Penzien": lambda rng: sl.CloughPenzien(
        rng.uniform(0.4, 2), rng.uniform(0.05, 0.8), rng.uniform(3, 6), rng.uniform(0.5, 1)
    ),
}
CASES = [(list(GROUNDS)[n % len(GROUNDS)], 100 + n) for n in range(20)]


@pytest.mark.parametrize("case", cases.with_slow(CASES, CASES[len(GROUNDS) :]), ids=str)
@pytest.mark.parametrize("steps", [8, 32], ids=["coarse", "fine"])
def test_elastic_structures_have_their_exact_moments_at_any_step(case, steps):
    kind, seed = case
    rng = np.random.default_rng(seed)
    ground = GROUNDS[kind](rng)
    parameters = zip(cases.log_uniform(rng, (0.4, 2.0), 4), rng.uniform(0.02, 0.1, 4), strict=True)
    structures = [sl.Bilinear(period, damping) for period, damping in parameters]
    options = {"paths": 128, "steps_per_period": steps, "relaxation_times": 40}
    table = sl.simulate(structures, ground, seed=seed, **options)
    sigma = np.array([sl.linearize(structure, ground).displacement_std for structure in structures])
    rho = np.array([[sl.correlate(a, b, ground).rho for b in structures] for a in structures])
    error = table.displacement_std_standard_error.values
    assert (error < 0.05 * sigma).all()
    assert (np.abs(table.displacement_std.values - sigma) < ERRORS * error).all()
    upper = np.triu_indices(len(structures), 1)
    off = (table.rho.values - rho)[upper] / table.rho_standard_error.values[upper]
    assert (np.abs(off) < ERRORS).all()
    np.testing.assert_allclose(np.diag(table.rho), 1, rtol=1e-14)
    np.testing.assert_array_equal(table.rho.values, table.rho.values.T)


# ---- (3) The errors that a run states, and its drift ----

REPEATS, PATHS = 2400, 64


@pytest.fixture(scope="module")
def repeated():
    """A short run of an elastic pair, many seeds; and the exact rho and standard deviations."""
    pair = [sl.Bilinear(period, 0.05) for period in (0.8, 1.0)]
    run = ensemble(pair, NOISE, paths=PATHS, seed=0, steps_per_period=8, relaxation_times=40.0)
    rho = float(sl.rho_white_noise(0.8, 1.0, 0.05, 0.05).rho)
    sigma = np.array([sl.linearize(structure, NOISE).displacement_std for structure in pair])
    return [moments_of(run, seed=seed) for seed in range(REPEATS)], rho, sigma


@pytest.mark.slow
def test_intervals_of_95_per_cent_cover_the_exact_values_in_95_per_cent_of_the_runs(repeated):
    moments, rho, sigma = repeated
    reach = scipy.stats.t.ppf(0.975, PATHS - 1)
    covered = [
        [
            abs(m.rho[0, 1] - rho) < reach * m.rho_error[0, 1],
            *(np.abs(m.displacement_std - sigma) < reach * m.displacement_error),
        ]
        for m in moments
    ]
    # The limits are 4.5 standard errors of the share, sqrt(0.95 * 0.05 / 2400) = 0.0044, from 0.95.
    share = np.mean(covered, axis=0)
    assert (share > 0.93).all()
    assert (share < 0.97).all()


@pytest.mark.slow
def test_drift_of_a_stationary_run_is_a_standard_normal_number(repeated):
    drift = np.array([m.drift for m in repeated[0]])
    assert np.abs(drift.mean(axis=0)).max() < ERRORS / np.sqrt(REPEATS)
    # Divided by an estimated error, it is Student's with 63 degrees: variance 63/61.
    spread = drift.std(axis=0) / np.sqrt((PATHS - 1) / (PATHS - 3))
    assert np.abs(spread - 1).max() < ERRORS / np.sqrt(2 * REPEATS)
    assert np.abs(drift).max() < NOT_STATIONARY


@pytest.mark.parametrize(("ratio", "hardening"), [(1.0, 0.02), (2.0, 0.05)])
def test_drift_tells_a_run_that_starts_recording_from_rest(ratio, hardening):
    structure = yielding(1.0, ratio, hardening)
    options = {"paths": 2048, "seed": 4, "steps_per_period": 16, "relaxation_times": 4.0}
    run = ensemble([structure], NOISE, **options)
    good = moments_of(run)
    assert np.abs(good.drift) < ERRORS
    early = moments_of(run, burn_in=0)
    assert early.drift > NOT_STATIONARY
    assert early.displacement_std < good.displacement_std - ERRORS * good.displacement_error


# ---- (4) Seeds and threads ----

MIXED = [
    yielding(1.0, 1.0),
    yielding(0.7, 2.0, 0.2, sl.BoucWen),
    sl.Bilinear(0.8, 0.05),
    yielding(1.2, 0.5, 0.1),
    sl.BoucWen(0.9, 0.03, 0.3, yield_displacement=0.05, beta=0.7, gamma=-0.3, exponent=2.0),
]
SHORT = {"paths": 96, "relaxation_times": 2.0, "steps_per_period": 12}


def test_a_seed_gives_one_answer_whatever_the_number_of_threads(monkeypatch):
    tables = []
    for threads, seed in ((1, 7), (2, 7), (2, 8)):
        available = range(threads)
        monkeypatch.setattr("os.sched_getaffinity", lambda _, these=available: these, raising=False)
        tables.append(sl.simulate(MIXED[:3], sl.KanaiTajimi(1.0, 0.2), seed=seed, **SHORT))
    for name in ("displacement_std", "rho", "rho_standard_error"):
        np.testing.assert_array_equal(tables[0][name], tables[1][name], err_msg=name)
    assert (tables[1].displacement_std != tables[2].displacement_std).all()


def test_paths_come_in_whole_groups_and_progress_ends_at_one():
    shares = []
    table = sl.simulate(MIXED[:1], NOISE, **SHORT | {"paths": 65}, progress=shares.append)
    assert table.attrs["paths"] == 96
    np.testing.assert_allclose(shares, [1 / 3, 2 / 3, 1])


# --- Structures that yield rarely -----------------------------------------------------------------


@pytest.mark.parametrize(
    "ground",
    [
        sl.KanaiTajimi(1.0, 0.3, intensity=0.01),
        sl.ParallelGround(
            [sl.KanaiTajimi(T, 0.6) for T in (0.4, 0.8)]
        ),  # no closure knows its drift
    ],
    ids=["soil", "parallel"],
)
def test_a_drift_that_takes_too_long_is_not_resolved_and_keeps_its_simulated_value(ground):
    """At R = 0.7 the drift takes 1e5 s to settle: the run is that of the other structure."""
    rare, usual = yielding(1.0, 0.7 / 3), yielding(0.9, 1.0)
    table = sl.simulate([rare, usual], ground, paths=32)
    assert table.attrs["memory_s"] < 1000
    meanings = table.status.attrs["flag_meanings"].split()
    assert [meanings[code] for code in table.status.values] == ["not_resolved", "converged"]
    for name in ("displacement_std", "ductility_std", "rho"):
        assert np.isfinite(table[name]).all()
    assert (table.displacement_std_standard_error > 0).all()
    elastic = sl.linearize(sl.Bilinear(1.0, 0.05), ground, "gaussian")
    error = float(table.displacement_std_standard_error[0])
    # it lacks the drift, so that it is hardly more than the vibration
    assert float(table.displacement_std[0]) < 1.2 * float(elastic.displacement_std) + ERRORS * error
    alone = sl.simulate([usual], ground, paths=32)
    assert float(alone.displacement_std[0]) == pytest.approx(
        float(table.displacement_std[1]), rel=0.02
    )


@pytest.mark.extreme
def test_floors_and_linked_structures_are_not_resolved_where_one_storey_is_not(monkeypatch):
    monkeypatch.setattr(stationary_motions, "MOST_STEPS_FOR_DRIFT", 1e3)
    tower = sl.ShearBuilding([2e5] * 2, [8e7] * 2, [3.0] * 2, 0.05, 0.05, [0.001, 0.01])
    other = sl.Bilinear(0.9, 0.05, mass=1e5)
    options = {"paths": 32, "relaxation_times": 1.0}
    free, tied = (
        sl.simulate([tower, other], NOISE, link=link, **options) for link in (None, sl.Link(1e6))
    )
    assert (free.status.values == [labels.NOT_RESOLVED] * 2 + [labels.CONVERGED]).all()
    assert (tied.status.values == labels.NOT_RESOLVED).all()


@pytest.mark.parametrize(
    ("signs", "motions", "constant"),
    [
        # At lag 1 the autocorrelation is -1, of 64 independent products: 0 + 2/8.
        ("+-+-+-+-", 16, -1 / np.log(0.25)),
        # It is 1/2 and 1/3 at lags 1 and 2, each with two standard errors above 0.6; then 0, of 25.
        ("++++-", 25, -3 / np.log(0.4)),
        # No two of the products differ: nothing decays.
        ("++++++++", 16, np.inf),
    ],
)
def test_a_time_constant_is_that_of_the_autocorrelation_two_standard_errors_above(
    signs, motions, constant
):
    history = np.repeat([[1.0 if sign == "+" else -1.0] for sign in signs], motions, axis=1)
    assert _time_constant(0.3 * history) == pytest.approx(constant, rel=1e-12)
