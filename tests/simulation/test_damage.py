"""Residual drifts, dissipated energies, ductilities, damage indices: closed forms, other integrators."""

import numpy as np
import pytest
import scipy.integrate
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle

T, XI, ALPHA, UY = 0.6, 0.05, 0.05, 0.02
W = 2 * np.pi / T
USUAL = {"period": T, "damping": XI, "hardening": ALPHA, "yield_displacement": UY}
NAMES = ("residual_drift", "dissipated_energy", "peak_ductility", "cumulative_ductility")
LAWS = {
    "bilinear": sl.Bilinear(**USUAL),
    "Bouc-Wen": sl.BoucWen(**USUAL, beta=0.5, gamma=0.5, exponent=1.0),
    "Baber-Noori": sl.BoucWenBaberNoori(**USUAL, strength_decay=0.02, stiffness_decay=0.05),
    "modified Clough": sl.ModifiedClough(**USUAL),
    "flag": sl.Flag(**USUAL, beta=0.8),
}
GROUND = sl.KanaiTajimi(0.4, 0.6, 0.02)
SLOW = 60 * T  # in which a push rises and falls once


def one_storey(**changes):
    mass = 2e5
    own = {"hardening": ALPHA, "yield_drifts": UY} | changes
    return sl.ShearBuilding([mass], [mass * W**2], [3.0], XI, **own)


def frame(**changes):
    usual = {"hardening": ALPHA, "base_shear_coefficient": 0.1, "damping": XI, "mass": 1e5}
    regular = {"period": 0.5, "storeys": 3, "storey_height": 3.0}
    return sl.ShearBuilding.regular(**(regular | usual | changes))


def motion(size=3.0, seconds=12.0, still=0.0, dt=0.02):
    """A motion of this length and size, and then no motion at all."""
    time = dt * np.arange(round((seconds + still) / dt) + 1)
    shape = np.where(time < seconds, np.sin(np.pi * time / seconds), 0.0)
    noise = np.random.default_rng(1).standard_normal(round(seconds / dt) + 1)
    noise = np.pad(np.convolve(noise, np.ones(5) / 5, "same"), (0, time.size - noise.size))
    values = size * shape * (np.sin(8 * time) + noise)
    return xr.DataArray(values, dims="time", coords={"time": time})


def push(ductility):
    """A slow push of the ground that leads to about this ductility, and back."""
    time = np.linspace(0, SLOW, 601)
    most = W**2 * UY * (1 + ALPHA * (ductility - 1))
    return xr.DataArray(-most * np.sin(np.pi * time / SLOW) ** 2, dims="time", coords={"time": time})


def after_push(law, mu):
    """Displacement at rest over uy, and energy over ``(1 - alpha) w^2 uy^2``, after a push to ``mu``."""
    if law == "bilinear":
        return (1 - ALPHA) * (mu - 1), mu - 1
    if law == "flag":
        return 0.0, 0.8 * (mu - 1)
    zero = mu - mu**0.4  # where z is zero; from there towards the yield point on the other side
    rest = (1 - ALPHA) * zero / (ALPHA * (zero + 1) + 1 - ALPHA)
    z = -(zero - rest) / (zero + 1)
    way = 0.5 + (mu - 1) - 0.5 * (mu - zero) + 0.5 * z * (rest - zero)  # the work of z; signs cancel
    return rest, way - 0.5 * z**2


@pytest.mark.parametrize("ductility", [1.5, 4.0])
@pytest.mark.parametrize("law", ["bilinear", "modified Clough", "flag"])
def test_a_push_leaves_what_statics_says(law, ductility):
    table = sl.respond(LAWS[law], push(ductility), damage=True)
    mu = float(table.peak_ductility[-1])
    assert 1 < mu < 1.2 * ductility
    rest, spent = after_push(law, mu)
    assert float(table.residual_drift) == pytest.approx(rest * UY, abs=2e-3 * UY)
    energy = (1 - ALPHA) * (W * UY) ** 2 * spent
    assert float(table.dissipated_energy[-1]) == pytest.approx(energy, rel=2e-3)
    assert float(table.cumulative_ductility[-1]) == pytest.approx(1 + (1 - ALPHA) * spent, rel=2e-3)


@pytest.mark.parametrize("law", LAWS)
def test_what_remains_is_where_the_structure_stands_long_after(law):
    """For 40 of its decay times nothing moves the ground; the estimate has seen four of them."""
    still = 40 / (XI * W)
    table = sl.respond(LAWS[law], motion(), damage=True)
    later = sl.respond(LAWS[law], motion(still=still))
    end = float(later.displacement[-1])
    error = 1e-2 if law == "Baber-Noori" else 2e-3  # its stiffness in unloading decays
    assert float(table.residual_drift) == pytest.approx(end, abs=error * UY)
    if law not in ("flag", "modified Clough"):  # these return
        assert abs(end) > 0.02 * UY


@pytest.mark.parametrize("building", [frame(), frame(p_delta=True, base_shear_coefficient=0.15)])
def test_storeys_stand_long_after_where_their_residual_drifts_say(building):
    still = 20 * T / (2 * np.pi * XI)
    table = sl.respond(building, motion(), damage=True)
    later = sl.respond(building, motion(still=still))
    end = later.storey_drift[-1].values
    np.testing.assert_allclose(table.residual_drift, end, rtol=0, atol=1e-3 * abs(end).max())
    assert table.dissipated_energy.dims == ("time", "element")


@pytest.mark.slow
def test_energies_and_rest_follow_an_ode_solver():
    """Energy by its definition, the work of the hysteretic force without what the spring z stores."""
    record = motion()
    time = record.time.values

    def rates(t, x):
        u, v, z, _ = x
        ground = np.interp(t, time, record.values, right=0.0)
        rate = v / UY
        dz = rate * (1 - abs(z) * (0.5 * np.copysign(1, rate * z) + 0.5))
        force = W**2 * (ALPHA * u + (1 - ALPHA) * UY * z)
        spent = (1 - ALPHA) * W**2 * UY * z * (v - UY * dz)
        return [v, -ground - 2 * XI * W * v - force, dz, spent]

    table = sl.respond(LAWS["Bouc-Wen"], record, damage=True)
    end = time[-1] + 12 / (XI * W)
    known = scipy.integrate.solve_ivp(
        rates, (0, end), np.zeros(4), t_eval=[*time, end], max_step=0.02, rtol=1e-8, atol=1e-10
    )
    energy = known.y[3, :-1]
    np.testing.assert_allclose(table.dissipated_energy, energy, rtol=0, atol=2e-3 * energy[-1])
    assert float(table.residual_drift) == pytest.approx(known.y[0, -1], abs=2e-3 * UY)


@pytest.mark.parametrize("law", LAWS)
def test_energies_balance_for_every_law(law):
    table = sl.respond(LAWS[law], motion(), damage=True)
    kinds = ("viscous", "hysteretic", "kinetic", "elastic")
    gone = sum(table[f"{kind}_energy_per_mass"] for kind in kinds)
    entered = table.input_energy_per_mass
    np.testing.assert_allclose(gone, entered, rtol=0, atol=1e-4 * float(abs(entered).max()))
    np.testing.assert_allclose(table.dissipated_energy, table.hysteretic_energy_per_mass, rtol=1e-12)
    steps = table.cumulative_ductility.diff("time")
    # Work of z from a loaded state may come back for a moment, for the laws of Bouc and Wen.
    assert float(steps.min()) > -1e-2 * float(table.cumulative_ductility[-1])


def test_the_sum_over_storeys_is_what_the_building_dissipates():
    table = sl.respond(frame(), motion(), damage=True)
    whole = table.dissipated_energy.sum("element") / 3e5
    np.testing.assert_allclose(whole, table.hysteretic_energy_per_mass, rtol=1e-12)


def test_crowds_of_oscillators_give_what_the_engine_gives():
    """An oscillator has a loop of its own; a building of one storey is stepped by the engine."""
    alone = sl.Bilinear(**USUAL, mass=2e5)
    options = {"paths": 64, "duration": 12.0, "damage": True}
    crowd = sl.simulate([alone, sl.Bilinear(1.0, 0.05)], GROUND, **options)
    engine = sl.simulate([one_storey()], GROUND, **options)
    for name in NAMES:
        found, wanted = crowd[name][:, 0].values, engine[name][:, 0].values
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9 * abs(wanted).max(), err_msg=name)
    # The other stays elastic.
    ends = {"residual_drift": 0.0, "dissipated_energy": 0.0, "peak_ductility": 0.0}
    for name, value in (ends | {"cumulative_ductility": 1.0}).items():
        np.testing.assert_array_equal(crowd[name][:, 1], value)
    np.testing.assert_allclose(engine.hysteretic_energy[:, 0], engine.dissipated_energy[:, 0])


def test_damage_changes_no_peak_and_has_its_statistics():
    pair = [LAWS["bilinear"], LAWS["modified Clough"]]
    plain, table = (sl.simulate(pair, GROUND, paths=96, duration=8.0, damage=d) for d in (False, True))
    for name in plain.data_vars:
        np.testing.assert_array_equal(table[name], plain[name])
    for name in NAMES:
        samples = abs(table[name].values)
        np.testing.assert_allclose(table[f"{name}_mean"], samples.mean(axis=0))
        error = samples.std(axis=0, ddof=1) / np.sqrt(96)
        np.testing.assert_allclose(table[f"{name}_mean_standard_error"], error)
        np.testing.assert_allclose(
            table[f"{name}_quantile"], np.quantile(samples, [0.5, 0.84, 0.95], axis=0)
        )
        assert (table[f"{name}_quantile_lower"] <= table[f"{name}_quantile"]).all()
    np.testing.assert_allclose(table.peak_ductility, table.peak / UY)


@pytest.mark.parametrize("structure", [sl.Bilinear(T, 1e-3, ALPHA, 0.01), frame(damping=1e-3)])
def test_yielding_dissipates_what_white_noise_puts_in(structure):
    """The noise puts in ``pi S0`` per unit of mass and time; hardly anything is left or damped."""
    s0, duration = 0.02, 40.0
    table = sl.simulate([structure], sl.WhiteNoise(s0), paths=256, duration=duration, damage=True)
    mass = 3e5 if "element" in table.dims else 1.0
    energy = table.dissipated_energy.sum(table.dissipated_energy.dims[1]) / mass
    share = float(energy.mean()) / (np.pi * s0 * duration)
    error = float(energy.std()) / 16 / (np.pi * s0 * duration)
    assert 0.93 - 3 * error < share < 1 + 3 * error


def test_masses_scale_energies_and_lengths_scale_drifts():
    first, second = frame(), frame(mass=3e5)
    tables = [sl.respond(s, motion(), damage=True) for s in (first, second)]
    np.testing.assert_allclose(tables[1].dissipated_energy, 3 * tables[0].dissipated_energy, rtol=1e-6)
    for name in ("residual_drift", "peak_ductility", "cumulative_ductility"):
        np.testing.assert_allclose(tables[1][name], tables[0][name], rtol=1e-6, atol=1e-9)
    law = sl.ModifiedClough
    wide = law(**USUAL | {"yield_displacement": 3 * UY})
    one, other = (sl.respond(s, motion(a), damage=True) for s, a in ((law(**USUAL), 3.0), (wide, 9.0)))
    np.testing.assert_allclose(other.residual_drift, 3 * one.residual_drift, rtol=1e-6)
    np.testing.assert_allclose(other.cumulative_ductility, one.cumulative_ductility, rtol=1e-6)


def test_uncertain_structures_have_their_own_strengths():
    options = {"paths": 32, "duration": 8.0, "damage": True}
    usual = frame()
    known = sl.simulate([usual], GROUND, **options)
    strength = sl.Uncertain(np.array([0.02, 0.02, 0.02]), 0.3)
    parts = {name: usual.arrays()[name].values for name in ("masses", "stiffnesses", "heights")}
    drawn = sl.ShearBuilding(**parts, damping=XI, hardening=ALPHA, yield_drifts=strength)
    table = sl.simulate([drawn], GROUND, **options)
    uy = 0.02 * table.input_factor.values
    np.testing.assert_allclose(table.peak_ductility, table.peak_drift.values / uy)
    capacity = parts["stiffnesses"] * uy**2
    wanted = 1 + table.dissipated_energy.values / capacity
    np.testing.assert_allclose(table.cumulative_ductility, wanted)
    assert known.residual_drift.shape == table.residual_drift.shape


def test_modes_that_yield_have_the_damage_of_a_building_by_its_modes():
    shapes = [[0.4, 0.8, 1.0], [1.0, 0.2, -0.56]]
    building = sl.ModalBuilding(
        [0.6, 0.2], shapes, [1e5] * 3, [3.0] * 3, 0.05, hardening=0.05, yield_displacements=[0.01, 0.01]
    )
    table = sl.simulate([building], GROUND, paths=32, duration=8.0, damage=True)
    of_storeys = table.storey.values > 0
    for name in NAMES[1:]:
        assert np.isnan(table[name].values[:, of_storeys]).all()
        assert np.isfinite(table[name].values[:, ~of_storeys]).all()
    at_rest = table.residual_drift.values
    assert np.isfinite(at_rest).all()
    assert abs(at_rest).max() > 1e-4
    whole = table.dissipated_energy.values[:, ~of_storeys].sum(axis=1)
    np.testing.assert_allclose(table.hysteretic_energy[:, 0], whole)


def test_pounding_ends_in_other_damage_and_alone_in_that_of_respond():
    left, right = (sl.ModifiedClough(**USUAL, mass=2e5), one_storey())
    record = motion()
    bumper = sl.Kelvin(1e8, restitution=0.65)
    table = sl.pound([left, right], 0.02, bumper, record, damage=True)
    for number, structure in enumerate((left, right)):
        own = sl.respond(structure, record, damage=True)
        for name in NAMES:
            values = np.ravel(own[name].values)[-1]
            assert float(table[f"{name}_alone"][number]) == pytest.approx(
                values, rel=3e-3, abs=2e-3 * UY
            ), name
    assert int(table.impacts[0]) > 0
    np.testing.assert_allclose(table.hysteretic_energy[-1], table.dissipated_energy, rtol=1e-12)
    changed = abs(table.dissipated_energy / table.dissipated_energy_alone - 1)
    assert float(changed.max()) > 0.01
    many = sl.pound([left, right], 0.02, bumper, [record, 0.5 * record], damage=True)
    for name in NAMES:
        np.testing.assert_array_equal(many[name][0], table[name])
    samples = abs(many.residual_drift.values)
    np.testing.assert_allclose(many.residual_drift_mean, samples.mean(axis=0))
    np.testing.assert_allclose(many.hysteretic_energy, many.dissipated_energy.values)


def test_buildings_that_lean_on_each_other_rest_where_they_stand_long_after():
    """One yields towards an elastic one; the gap is then closed, and the contact balances both."""
    left, right = one_storey(yield_drifts=0.01), one_storey(hardening=None, yield_drifts=None)
    time = 0.02 * np.arange(1001)
    values = np.where(time < 2.0, -4.0 * np.sin(np.pi * time / 2.0) ** 2, 0.0)
    record = xr.DataArray(values, dims="time", coords={"time": time})
    bumper = sl.LinearSpring(1e7)
    table, later = (
        sl.pound([left, right], 0.0, bumper, each, damage=True) for each in (record[:151], record)
    )
    still = later.displacement.isel(time=-1).values.ravel()
    np.testing.assert_allclose(table.residual_drift, still, rtol=0, atol=1e-2 * abs(still).max())
    assert float(later.contact_force[-1, 0]) > 0
    assert float(table.residual_drift[0]) < 0.9 * float(table.residual_drift_alone[0])


def test_the_gap_has_the_damage_of_its_simulation():
    pair = sl.Bilinear(**USUAL), sl.ModifiedClough(0.9, 0.05, 0.05, 0.02)
    options = {"duration": 10.0, "paths": 128, "damage": True}
    table = sl.separation(*pair, GROUND, **options)
    motions = sl.simulate(list(pair), GROUND, quantiles=[0.9], **options)
    for name in NAMES:
        for end in ("", "_mean", "_mean_standard_error"):
            np.testing.assert_array_equal(table[f"{name}{end}"], motions[f"{name}{end}"])
        np.testing.assert_array_equal(table[f"{name}_quantile"], motions[f"{name}_quantile"][0])
    index = sl.park_ang(table, 6.0, 0.1)
    np.testing.assert_allclose(index.park_ang_of_structure, index.park_ang)


def by_hand(ductility, cumulative, energy):
    over = ("path", "element")
    columns = {"peak_ductility": ductility, "cumulative_ductility": cumulative}
    return xr.Dataset(
        {name: (over, np.array(values, float)) for name, values in columns.items()}
        | {"dissipated_energy": (over, np.array(energy, float))},
        coords={"element": ["1.1", "1.2"], "element_structure": ("element", [1, 1])},
    )


def test_the_index_of_park_and_ang_by_hand():
    table = by_hand([[3, 1], [2, 4]], [[11, 1], [6, 21]], [[10, 0], [5, 15]])
    index = sl.park_ang(table, 5.0, 0.1)
    np.testing.assert_allclose(index.park_ang, [[0.8, 0.2], [0.5, 1.2]])
    np.testing.assert_allclose(index.park_ang_of_structure[:, 0], [0.8, (2.5 + 18) / 20])
    np.testing.assert_allclose(index.park_ang_mean, [0.65, 0.7])
    error = np.std([[0.8, 0.2], [0.5, 1.2]], axis=0, ddof=1) / np.sqrt(2)
    np.testing.assert_allclose(index.park_ang_mean_standard_error, error)
    limits = xr.DataArray([5.0, np.nan], dims="element", coords={"element": ["1.1", "1.2"]})
    only = sl.park_ang(table, limits, 0.1)
    assert np.isnan(only.park_ang[:, 1]).all()
    np.testing.assert_allclose(only.park_ang[:, 0], [0.8, 0.5])


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: sl.simulate([LAWS["flag"]], GROUND, damage=True), "give a duration"),
        (lambda: sl.park_ang(sl.linearize(LAWS["bilinear"], GROUND), 5, 0.1), "damage=True"),
        (lambda: sl.park_ang(by_hand([[1, 1]], [[1, 1]], [[0, 0]]), 1.0, 0.1), "ultimate_ductility = 1"),
        (lambda: sl.park_ang(by_hand([[1, 1]], [[1, 1]], [[0, 0]]), 5.0, -0.1), "beta = -0.1"),
        (
            lambda: sl.respond(sl.Bilinear(T, 1e-7, ALPHA, UY), motion(), damage=True),
            "more damping",
        ),
    ],
)
def test_bad_input_is_named(call, words):
    with pytest.raises(ValueError, match=words):
        call()
