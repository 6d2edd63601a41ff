"""Pounding histories: energy, symmetry, limits; another integrator is in the answers by CVODE."""

import hypothesis.strategies as st
import numpy as np
import pytest
import sympy
from cases import assert_near
from hypothesis import example, given, settings
from motions import finer, motion, shaking

import stochlin as sl

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


# --- Energy
# -----------------------------------------------------------------------------------------


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


def test_work_of_every_storey_is_what_it_stores_and_dissipates():
    """Integrated from the histories of a tower whose storeys all yield, each by another drift."""
    tower = sl.ShearBuilding(
        [2e5] * 3,
        [2e8, 1.6e8, 1e8],
        [3.5] * 3,
        0.05,
        hardening=0.05,
        yield_drifts=[0.006, 0.005, 0.004],
    )
    table = sl.pound([tower], motion=finer(synthetic(), 40)).isel(structure=0)
    drift = table.displacement.diff("floor", label="upper").combine_first(table.displacement)
    shear = table.storey_shear
    mean, moved = (shear + shear.shift(time=1)) / 2, drift.diff("time")
    work = (mean * moved).sum()
    last = table.isel(time=-1)
    assert (abs(drift).max("time") > np.array([0.006, 0.005, 0.004])).all()
    assert float(work) == pytest.approx(
        float(last.elastic_energy + last.hysteretic_energy), rel=2e-3
    )
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


@pytest.mark.parametrize("name", CONTACTS)
def test_energy_balances_for_every_contact(name):
    table = sl.pound([soft(), stiff()], 0.01, CONTACTS[name], synthetic())
    assert table.sizes["impact"] > 5
    assert (table.approach_velocity > 0).all()
    assert float(table.hysteretic_energy[-1].min()) > 0
    check_energy(table)
    if name in ("spring", "hertz"):
        assert float(abs(table.contact_lost_energy).max()) < 1e-6 * float(table.input_energy.max())


# --- Limits and symmetry
# ----------------------------------------------------------------------------


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


@pytest.mark.parametrize("name", ["kelvin", "stereomechanical"])
def test_silence_before_a_motion_only_delays_it(name):
    record, pair = np.r_[0.0, synthetic(300).values], [soft(), stiff()]
    plain, later = (
        sl.pound(pair, 0.01, CONTACTS[name], motion(values))
        for values in (record, np.r_[0, 0, record])
    )
    assert plain.sizes["impact"] == later.sizes["impact"] > 0
    for variable in ("displacement", "contact_force"):
        assert_near(later[variable].values[2:], plain[variable].values, 1e-8)
        assert (later[variable].values[:2] == 0).all()


@pytest.mark.parametrize(("name", "spring"), [("kelvin", 5e7), ("stereomechanical", 1e13)])
def test_three_that_lean_on_each_other_carry_the_force_along(name, spring):
    """At rest under a steady push: the displacements solve the equations of all springs."""
    row = [sl.Bilinear(period, 0.1, mass=2e5) for period in (2.0, 1.0, 0.4)]
    table = sl.pound(row, [0.0, 0.0], CONTACTS[name], motion(-np.ones(1500)))
    stiffness = np.diag([each.mass * (2 * np.pi / each.period) ** 2 for each in row])
    between = np.array([[1.0, -1.0, 0.0], [0.0, 1.0, -1.0]])
    at_rest = np.linalg.solve(stiffness + spring * between.T @ between, np.full(3, 2e5))
    np.testing.assert_allclose(table.displacement[-1], at_rest, rtol=1e-5)
    force = np.cumsum(2e5 - stiffness @ at_rest)[:2]
    np.testing.assert_allclose(table.contact_force[-1], force, rtol=1e-5)


# --- Chattering, touching, rest
# ---------------------------------------------------------------------


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


def test_a_response_that_overflows_is_named_and_no_record_alone_makes_one():
    v, z = sympy.symbols("v z")
    growing = sl.Hysteretic(1.0, 0.05, 0.5, yield_displacement=0.01, mass=2e5, law=v * (1 + z**2))
    with pytest.raises(
        ArithmeticError, match=r"no longer finite .* s after the beginning.*steps_per_contact"
    ):
        sl.pound([growing, stiff()], 0.01, CONTACTS["kelvin"], synthetic(60))
    with pytest.raises(ValueError, match=r"motion: record is .* allowed: at most 1e\+09 m/s\^2"):
        sl.pound([soft(), stiff()], 0.01, CONTACTS["kelvin"], synthetic(60) * 1e180)
    strong = sl.pound([soft(), stiff()], 0.01, CONTACTS["kelvin"], synthetic(60) * 1e8)
    assert np.isfinite(strong.displacement).all()


# --- Shear buildings
# --------------------------------------------------------------------------------


# --- The estimate
# -----------------------------------------------------------------------------------


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
    both_left, apart = (hit.energy_lost.sel(direction_1=-1, direction_2=way) for way in (-1, 1))
    assert 0 < int(both_left.notnull().sum()) < 7
    assert apart.isnull().all()
    radii = np.abs([hit.contact_displacement_1.values, hit.contact_displacement_2.values]).max(
        axis=1
    )
    np.testing.assert_allclose(radii, [0.05, 0.04], rtol=1e-12)  # the ends of what both reach


# --- Scales and limits
# --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", CONTACTS)
def test_identical_buildings_never_pound(name):
    assert sl.pound([soft(), soft()], 1e-6, CONTACTS[name], synthetic()).sizes["impact"] == 0


@pytest.mark.parametrize(
    ("kind", "stiffness", "exponent"), [(sl.Kelvin, 5e7, 1.0), (sl.HertzDamp, 1e9, 1.5)]
)
def test_masses_have_no_scale_and_lengths_go_with_the_motion(kind, stiffness, exponent):
    heavier, longer = 16.0, 2.5
    contact = kind(stiffness, restitution=0.65)
    other_contact = kind(heavier * longer ** (1 - exponent) * stiffness, restitution=0.65)
    usual = sl.pound([soft(), stiff()], 0.01, contact, synthetic())
    pair = [
        soft(mass=heavier * 2e5, yield_displacement=longer * 0.03),
        stiff(mass=heavier * 3e5, yield_displacement=longer * 0.015),
    ]
    longer_motion = (longer * synthetic()).assign_attrs(synthetic().attrs)
    other = sl.pound(pair, longer * 0.01, other_contact, longer_motion)
    assert usual.sizes["impact"] == other.sizes["impact"] > 3
    size = float(usual.peak.max())
    np.testing.assert_allclose(other.displacement / longer, usual.displacement, atol=1e-6 * size)
    np.testing.assert_allclose(
        other.largest_force, heavier * longer * usual.largest_force, rtol=1e-5, atol=1.0
    )


def test_a_neighbour_that_is_very_heavy_does_not_feel_the_blows():
    record, wall = synthetic(300), stiff(mass=1e12)
    table = sl.pound([soft(), wall], 0.005, sl.Stereomechanical(0.5), record, steps_per_contact=128)
    assert table.sizes["impact"] >= 2
    alone = sl.respond(wall, record).displacement
    assert_near(table.displacement[:, 1], alone, 1e-5)


def test_a_motion_with_silence_in_it_is_the_same_sampled_more_densely():
    shaken = synthetic(200, size=3.0).values
    quiet = np.concatenate([shaken, np.zeros(300), shaken[::-1], np.zeros(300)])
    fine = np.interp(np.arange(2 * quiet.size - 1) / 2, np.arange(quiet.size), quiet)
    pair = [soft(), stiff()]
    coarse, dense = (
        sl.pound(pair, 0.01, CONTACTS["kelvin"], each)
        for each in (motion(quiet), motion(fine, 0.01))
    )
    assert coarse.sizes["impact"] == dense.sizes["impact"] > 0
    allowed = 4 * float(coarse.step_error) * float(coarse.peak.max())
    np.testing.assert_allclose(coarse.displacement, dense.displacement[::2], rtol=0, atol=allowed)


@pytest.mark.slow
def test_a_law_with_memory_pounds_and_forgets_nothing():
    """Without wear it is the law of Bouc and Wen; with it, the energy is accounted for, too."""
    v, z, e = sympy.symbols("v z e")
    slip = (sympy.Abs(v) * z + v * sympy.Abs(z)) / 2
    parts = [{"mass": 2e5, "yield_displacement": 0.03}, {"mass": 3e5, "yield_displacement": 0.015}]
    periods = 1.1, 0.5

    def worn(wear):
        law = {"z": (v - (1 + wear * e) * slip) / (1 + wear * e), "e": z * v}
        return [
            sl.Hysteretic(T, 0.05, 0.1, law=law, **p) for T, p in zip(periods, parts, strict=True)
        ]

    plain = [sl.BoucWen(T, 0.05, 0.1, **part) for T, part in zip(periods, parts, strict=True)]
    record = synthetic(300, size=3.0)
    known, same, less = (
        sl.pound(each, 0.01, CONTACTS["kelvin"], record) for each in (plain, worn(0.0), worn(0.05))
    )
    assert known.sizes["impact"] == same.sizes["impact"] > 3
    assert_near(same.displacement, known.displacement, 1e-5)
    assert float(abs(less.displacement - known.displacement).max()) > 0.01 * float(known.peak.max())
    for table in (same, less):
        check_energy(table)
