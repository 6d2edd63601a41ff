"""Pounding histories: against adaptive integration, limits, symmetry, scaling, and their own energy."""

from itertools import pairwise

import hypothesis.strategies as st
import numpy as np
import pytest
import xarray as xr
from cases import assert_near
from hypothesis import example, given, settings
from motions import finer, motion, shaking
from scipy.integrate import solve_ivp

import stochlin as sl
from stochlin.kernels.simulation import contacts as forces

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

CONTACTS = {
    "spring": sl.LinearSpring(5e7),
    "kelvin": sl.Kelvin(5e7, restitution=0.65),
    "no tension": sl.NoTensionKelvin(5e7, restitution=0.65),
    "impact kelvin": sl.ImpactKelvin(5e7, restitution=0.65),
    "hertz": sl.Hertz(1e9),
    "hertz-damp": sl.HertzDamp(1e9, restitution=0.65),
    "jankowski": sl.Jankowski(1e9, restitution=0.65),
    "stereomechanical": sl.Stereomechanical(0.65),
}
BALANCE = 1e-6  # promised; measured: 1e-9 and better


def synthetic(samples=600, seed=0, size=1.5):
    return shaking(samples, seed, size)


def soft(**other):
    given = {"hardening": 0.05, "yield_displacement": 0.03, "mass": 2e5} | other
    return sl.Bilinear(1.1, 0.05, **given)


def stiff(**other):
    given = {"hardening": 0.1, "yield_displacement": 0.015, "mass": 3e5} | other
    return sl.Bilinear(0.5, 0.05, **given)


# --- Energy -----------------------------------------------------------------------------------------


def check_energy(table, of_blows=1e-3):
    # After a blow within a step, the forces on the way to its end are taken to be those at its end.
    blows = "Stereomechanical" in table.attrs.get("contact", "")
    assert float(table.energy_balance_error.max()) < (of_blows if blows else BALANCE)
    lost = table.contact_lost_energy
    assert float(lost.min()) >= -1e-9 * float(abs(table.input_energy).max())
    if table.sizes["impact"]:
        assert float(table.energy_lost.sum()) == pytest.approx(float(lost[-1]), rel=1e-6)
    for name in ("kinetic_energy", "elastic_energy", "hysteretic_energy"):
        assert float(table[name].min()) >= -1e-9 * float(abs(table.input_energy).max())


@pytest.mark.parametrize("name", CONTACTS)
def test_energy_balances_for_every_contact(name):
    table = sl.pound([soft(), stiff()], 0.01, CONTACTS[name], synthetic())
    assert table.sizes["impact"] > 5
    assert (table.approach_velocity > 0).all()
    assert float(table.hysteretic_energy[-1].min()) > 0
    check_energy(table)
    if name in ("spring", "hertz"):
        assert float(abs(table.contact_lost_energy).max()) < 1e-6 * float(table.input_energy.max())


def test_work_of_every_storey_is_what_it_stores_and_dissipates():
    """Integrated from the histories of a tower whose storeys all yield, each by another drift."""
    tower = sl.ShearBuilding(
        [2e5] * 3, [2e8, 1.6e8, 1e8], [3.5] * 3, 0.05, hardening=0.05, yield_drifts=[0.006, 0.005, 0.004]
    )
    table = sl.pound([tower], motion=finer(synthetic(), 40)).isel(structure=0)
    drift = table.displacement.diff("floor", label="upper").combine_first(table.displacement)
    shear = table.storey_shear
    mean, moved = (shear + shear.shift(time=1)) / 2, drift.diff("time")
    work = (mean * moved).sum()
    last = table.isel(time=-1)
    assert (abs(drift).max("time") > np.array([0.006, 0.005, 0.004])).all()
    assert float(work) == pytest.approx(float(last.elastic_energy + last.hysteretic_energy), rel=2e-3)
    np.testing.assert_allclose(table.peak_storey_shear, abs(shear).max("time"), rtol=2e-3)


@settings(max_examples=30)
@given(
    periods=st.tuples(*2 * [st.floats(0.2, 3.0)]),
    masses=st.tuples(*2 * [st.floats(1e4, 1e7)]),
    yields=st.tuples(*2 * [st.floats(0.002, 0.1)]),
    gap=st.floats(0.0, 0.03),
    name=st.sampled_from(sorted(set(CONTACTS) - {"hertz-damp"})),
    seed=st.integers(0, 10**6),
    bouc_wen=st.booleans(),
)
def test_energy_balances_for_any_pair(periods, masses, yields, gap, name, seed, bouc_wen):
    pair = [
        (sl.BoucWen if bouc_wen else sl.Bilinear)(
            period, 0.03, hardening=0.1, yield_displacement=uy, mass=mass
        )
        for period, mass, uy in zip(periods, masses, yields, strict=True)
    ]
    check_energy(sl.pound(pair, gap, CONTACTS[name], synthetic(200, seed=seed)))


# --- Another integrator -----------------------------------------------------------------------------


def check_convergence(pair, gap, contact, record, wanted):
    """Displacements with steps halved again and again: of second order, and by extrapolation to 1e-5."""
    size, errors, found = abs(wanted).max(), [], []
    for steps in (16, 32, 64, 128):
        table = sl.pound(pair, gap, contact, record, steps_per_contact=steps)
        assert table.sizes["impact"] >= 2
        found.append(table.displacement.T.values)
        errors.append(abs(found[-1] - wanted).max() / size)
    assert errors[0] < 1e-3
    assert errors[2] < errors[0] / 8  # 16 in the mean: where contact begins in a step is by chance
    extrapolated = (4 * found[3] - found[2]) / 3
    assert abs(extrapolated - wanted).max() < 1e-5 * size


def test_bilinear_pair_moves_as_by_another_integrator_with_events():
    pair, gap, contact = [soft(), stiff()], 0.002, CONTACTS["kelvin"]
    record = synthetic(200, size=3.0)
    table = sl.pound(pair, gap, contact, record)
    assert float(table.hysteretic_energy[-1].min()) > 0
    check_convergence(pair, gap, contact, record, by_events(pair, gap, contact, record))


def by_events(pair, gap, contact, record):
    """Displacements (2, samples) by DOP853 with scipy's own event location."""
    w = np.array([2 * np.pi / s.period for s in pair])
    mass, alpha, uy, xi = (
        np.array([getattr(s, name) for s in pair])
        for name in ("mass", "hardening", "yield_displacement", "damping")
    )
    k, _, c, *_ = contact.force_law(forces.reduced_mass(*mass))
    sides, closed = [0, 0], False

    def rates(t, x, ground, slope):
        u, v, y = x.reshape(3, 2)
        force = k * (u[0] - u[1] - gap) + c * (v[0] - v[1]) if closed else 0.0
        push = np.array([-force, force]) / mass
        a = -ground - slope * t - 2 * xi * w * v - w**2 * (alpha * u + (1 - alpha) * y) + push
        return np.concatenate([v, a, np.where(np.array(sides) == 0, v, 0.0)])

    def watches():
        ends = [lambda t, x, *_: x[0] - x[1] - gap]
        ends[0].direction = -1 if closed else 1
        for i in range(2):
            if sides[i]:
                end = lambda t, x, *_, i=i, s=sides[i]: s * x[2 + i]  # noqa: E731
                end.direction = -1
                ends.append(end)
            else:
                for s in (-1, 1):
                    end = lambda t, x, *_, i=i, s=s: s * x[4 + i] - uy[i]  # noqa: E731
                    end.direction, end.meaning = 1, s
                    ends.append(end)
            ends[-1].storey = ends[-2 if not sides[i] else -1].storey = i
        for end in ends:
            end.terminal = True
        return ends

    dt, state, found = float(record.time[1] - record.time[0]), np.zeros(6), [np.zeros(2)]
    for begin, finish in pairwise(record.to_numpy()):
        slope, t = (finish - begin) / dt, 0.0
        while t < dt:
            ends = watches()
            run = solve_ivp(
                rates,
                (t, dt),
                state,
                args=(begin, slope),
                method="DOP853",
                rtol=1e-11,
                atol=1e-14,
                events=ends,
                max_step=dt / 4,
            )
            t, state = run.t[-1], run.y[:, -1]
            if run.status == 1:
                [hit] = [n for n, times in enumerate(run.t_events) if times.size]
                if hit == 0:
                    closed = not closed
                else:
                    i = ends[hit].storey
                    sides[i] = 0 if sides[i] else ends[hit].meaning
        found.append(state[:2].copy())
    return np.array(found).T


# --- Limits and symmetry ----------------------------------------------------------------------------


def test_far_apart_each_moves_as_alone():
    record = synthetic()
    pair = [soft(), stiff()]
    table = sl.pound(pair, 10.0, CONTACTS["kelvin"], record, steps_per_contact=128)
    assert table.sizes["impact"] == 0
    np.testing.assert_array_equal(table.amplification, 1.0)
    for n, structure in enumerate(pair):
        alone = sl.respond(structure, record)
        for name in ("displacement", "velocity"):
            assert_near(table[name][:, n], alone[name], 2e-5)
        spectrum = sl.response_spectrum(
            record,
            structure.period,
            0.05,
            hardening=structure.hardening,
            yield_displacement=structure.yield_displacement,
        )
        assert float(table.peak[n]) == pytest.approx(float(spectrum.displacement_max), rel=1e-3)


@pytest.mark.parametrize("name", CONTACTS)
def test_a_mirrored_row_moves_as_the_mirror_image(name):
    record, row = synthetic(300, size=3.0), [soft(), stiff(), soft(mass=1e5)]
    gaps = [0.01, 0.015]
    table = sl.pound(row, gaps, CONTACTS[name], record)
    mirror = sl.pound(row[::-1], gaps[::-1], CONTACTS[name], -record)
    assert set(table.impact_contact.values) == {1, 2}
    for variable, sign in (("displacement", -1), ("velocity", -1), ("contact_force", 1)):
        dim = "contact" if variable == "contact_force" else "structure"
        there = sign * mirror[variable].isel({dim: slice(None, None, -1)}).to_numpy()
        # Rounding differs, and grows from impact to impact.
        assert_near(there, table[variable], 1e-5)
    assert mirror.sizes["impact"] == table.sizes["impact"]


# --- Chattering, touching, rest ---------------------------------------------------------------------


def leaning(samples=3000):
    """A ground acceleration that comes and stays."""
    return motion(-np.clip(np.arange(samples) / 50, 0, 1), 0.02)


@pytest.mark.slow
@pytest.mark.parametrize("e", [0.0, 0.3, 0.9, 0.98])
def test_chattering_ends_in_contact(e):
    one = sl.Bilinear(1.5, 0.1, mass=2e5)
    two = sl.Bilinear(0.5, 0.1, mass=3e5)
    table = sl.pound([one, two], 0.01, sl.Stereomechanical(e), leaning())
    k1, k2 = (s.mass * (2 * np.pi / s.period) ** 2 for s in (one, two))
    u2 = (5e5 * 1.0 - k1 * 0.01) / (k1 + k2)  # at rest side by side
    last = table.isel(time=-1)
    assert float(last.displacement[1]) == pytest.approx(u2, rel=1e-5)
    assert float(last.displacement[0] - last.displacement[1]) == pytest.approx(0.01, abs=1e-6)
    assert float(last.contact_force[0]) == pytest.approx(2e5 * 1.0 - k1 * (u2 + 0.01), rel=1e-5)
    assert float(table.impact_duration[-1]) > 20
    check_energy(table)


# A blow within a row that is pressed together reaches all of it in the same instant.
@example([2.52, 2.0, 1.1, 0.15], [6.3e5, 5.8e5, 6.6e4, 5.8e5], 0.05, 153090)
@example([1.0, 1.0, 1.0, 2.0], [2.2e5, 1e4, 1e4, 5.9e5], 0.5, 2)
@pytest.mark.slow
@given(
    periods=st.lists(st.floats(0.15, 3.0), min_size=3, max_size=4),
    masses=st.lists(st.floats(1e4, 1e6), min_size=4, max_size=4),
    e=st.sampled_from([0.0, 0.001, 0.05, 0.5, 0.9]),
    seed=st.integers(0, 10**6),
)
def test_rows_that_touch_do_not_chatter_without_end(periods, masses, e, seed):
    row = [sl.Bilinear(t, 0.1, mass=m) for t, m in zip(periods, masses, strict=False)]
    touching, contact = [0.0] * (len(row) - 1), sl.Stereomechanical(e)
    table = sl.pound(row, touching, contact, synthetic(150, seed=seed), steps_per_contact=64)
    # The worst of 400 rows: an imbalance of 3.3e-4, 1739 impacts, overlap by 8e-6 of the peak.
    check_energy(table)
    assert table.sizes["impact"] < 5_000
    u, floors = table.displacement, len(row)
    for left in range(1, floors):
        overlap = (u.sel(structure=left) - u.sel(structure=left + 1)).max()
        assert float(overlap) < 1e-4 * float(table.peak.max())


def test_a_motion_that_overflows_is_named():
    with pytest.raises(
        ArithmeticError, match=r"no longer finite .* s after the beginning.*steps_per_contact"
    ):
        sl.pound([soft(), stiff()], 0.01, CONTACTS["kelvin"], synthetic(60) * 1e180)


# --- Shear buildings --------------------------------------------------------------------------------


def tower(storeys, stiffness=4e8, **other):
    given = {"hardening": 0.05, "yield_drifts": 0.006} | other
    return sl.ShearBuilding([2e5] * storeys, [stiffness] * storeys, [3.0] * storeys, 0.05, **given)


@pytest.mark.parametrize("name", ["kelvin", "stereomechanical", "jankowski"])
def test_one_storey_is_one_degree_of_freedom(name):
    record = synthetic(300)
    oscillators, buildings = [soft(), stiff()], []
    for s in oscillators:
        k = s.mass * (2 * np.pi / s.period) ** 2
        drift = {"hardening": s.hardening, "yield_drifts": s.yield_displacement}
        buildings.append(sl.ShearBuilding([s.mass], [k], [3.0], s.damping, **drift))
    one = sl.pound(oscillators, 0.01, CONTACTS[name], record)
    two = sl.pound(buildings, 0.01, CONTACTS[name], record)
    assert one.sizes["impact"] == two.sizes["impact"] > 3
    for variable in ("displacement", "velocity"):
        assert_near(two[variable].isel(floor=0), one[variable], 1e-7)


def test_elastic_tower_alone_follows_its_modes():
    record, building = synthetic(300), tower(3, hardening=None, yield_drifts=None)
    table = sl.pound([building, tower(2)], 5.0, CONTACTS["kelvin"], record, steps_per_contact=128)
    wanted = np.zeros((record.size, 3))
    mass, shapes = 2e5, building._modes()[1]
    for period, shape in zip(building.periods().values, shapes.T, strict=True):
        alone = sl.respond(sl.Bilinear(period, 0.05), record).displacement.to_numpy()
        wanted += np.outer(alone, shape) * (shape.sum() * mass)
    found = table.displacement.sel(structure=1)
    assert_near(found, wanted, 1e-5)


# --- The estimate -----------------------------------------------------------------------------------


def test_estimate_conserves_momentum_and_loses_the_energy_of_eq_13():
    first, second = soft(), stiff()
    hit = sl.pounding_estimate(first, second, 0.02, sl.Stereomechanical(0.4), [0.05, 0.1], 0.06)
    before = 2e5 * hit.velocity_before_1 + 3e5 * hit.velocity_before_2
    after = 2e5 * hit.velocity_after_1 + 3e5 * hit.velocity_after_2
    xr.testing.assert_allclose(before, after, rtol=1e-12)
    energy = 0.0
    for n, (structure, r) in enumerate(
        [(first, xr.DataArray([0.05, 0.1], dims="case")), (second, 0.06)]
    ):
        k = structure.mass * (2 * np.pi / structure.period) ** 2
        growth = hit[f"radius_amplification_{n + 1}"]
        energy = energy + 0.5 * k * (r * r) * (growth**2 - 1)
    np.testing.assert_allclose(-energy, hit.energy_lost.transpose(*energy.dims), rtol=1e-9, atol=1e-6)
    inside = hit.contact_displacement_1 - hit.contact_displacement_2
    np.testing.assert_allclose(inside, 0.02, rtol=1e-9)


def test_estimate_of_one_elastic_hit_is_what_the_history_does():
    """Two free vibrations of given radii, one hit: the radii after it, but for damping."""
    contact = sl.Stereomechanical(0.5)
    first = sl.Bilinear(1.0, 1e-9, mass=2e5)
    second = sl.Bilinear(0.6, 1e-9, mass=3e5)
    hit = sl.pounding_estimate(first, second, 0.03, contact, 0.05, 0.04, points=7)
    chosen = hit.isel(point=3).sel(direction_1=1, direction_2=-1)
    u, v = float(chosen.contact_displacement_1), float(chosen.velocity_after_1)
    radius = np.hypot(u, v / (2 * np.pi / 1.0))
    assert float(chosen.radius_amplification_1) == pytest.approx(radius / 0.05, rel=1e-12)
    assert np.isnan(hit.energy_lost.sel(direction_1=1, direction_2=1)).any()
