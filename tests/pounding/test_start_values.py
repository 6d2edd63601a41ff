"""Throws, and motions that go on from the end of others: exact values, bits, and refusals."""

import re

import numpy as np
import pytest
import xarray as xr
from motions import motion, shaking

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

KELVIN = sl.Kelvin(1e8, restitution=0.65)
SOFT = sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.05, mass=2e5)
STIFF = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02, mass=3e5)
TOWER = sl.ShearBuilding(
    [2e5] * 3,
    [2e8, 1.6e8, 1e8],
    [3.5] * 3,
    0.05,
    hardening=0.05,
    yield_drifts=0.008,
    law="bouc_wen",
)
DAMPER = sl.Link(1e7, 1e6, damping_exponent=0.5, floors=(1, 2))
ROWS = {
    "wall in space": ([SOFT, STIFF, sl.Wall("space")], [0.01, 0.05], KELVIN, None),
    "columns and a damper": ([TOWER, TOWER], 0.01, sl.HertzDamp(1e9, restitution=0.6), DAMPER),
    "blows": ([SOFT, STIFF], 0.01, sl.Stereomechanical(0.4), None),
    "alone": ([TOWER], (), None, None),
}
OF_WHOLE = ("peak", "peak_acceleration", "peak_storey_shear", "peak_base_shear", "amplification")


def still(seconds: float, dt: float = 1e-3) -> xr.DataArray:
    return motion(np.zeros(round(seconds / dt) + 1), dt)


def over_time(table: xr.Dataset) -> dict[str, np.ndarray]:
    return {
        n: v.transpose("time", ...).values for n, v in table.data_vars.items() if "time" in v.dims
    }


@pytest.mark.parametrize("name", ROWS)
@pytest.mark.parametrize("cut", [100, 160])
def test_a_motion_in_two_parts_has_the_bits_of_one(name, cut):
    row, gaps, contact, link = ROWS[name]
    record = shaking(300)
    whole = sl.pound(row, gaps, contact, record, link=link)
    first = sl.pound(row, gaps, contact, record[: cut + 1], link=link)
    second = sl.pound(row, gaps, contact, record[cut:], link=link, start=first.end_state)
    parts = over_time(first), over_time(second)
    for variable, values in over_time(whole).items():
        joined = np.concatenate([parts[0][variable], parts[1][variable][1:]])
        np.testing.assert_array_equal(joined, values, err_msg=variable)
    for variable in OF_WHOLE:
        np.testing.assert_array_equal(second[variable], whole[variable])


def test_many_motions_begin_as_one_does():
    thrown = sl.Start(velocity=[0.5, -0.5])
    motions = xr.concat([shaking(200, seed) for seed in (0, 1)], "path", coords="minimal")
    many = sl.pound([SOFT, STIFF], 0.01, KELVIN, motions, start=thrown)
    for n in (0, 1):
        alone = sl.pound([SOFT, STIFF], 0.01, KELVIN, motions[n], start=thrown)
        np.testing.assert_array_equal(many.peak[n], alone.peak)


@pytest.mark.parametrize("contact", [sl.LinearSpring(1e6), sl.Hertz(1e8), sl.Stereomechanical(1.0)])
def test_momentum_and_energy_of_a_throw(contact):
    # Two masses that nothing holds, but for springs of 12 days.
    free = [sl.Bilinear(1e6, 1e-12, mass=mass) for mass in (100.0, 300.0)]
    table = sl.pound(free, 0.1, contact, still(1.0), start=sl.Start(velocity=[1.0, 0.0]))
    before, after = 100.0, table.velocity[-1].values
    assert table.sizes["impact"] == 1
    assert 100.0 * after[0] + 300.0 * after[1] == pytest.approx(before, rel=1e-9)
    assert float(table.kinetic_energy[-1].sum()) == pytest.approx(50.0, rel=1e-9)
    np.testing.assert_allclose(after, [-0.5, 0.5], rtol=1e-8)
    assert float(table.energy_balance_error.max()) < 1e-9
    np.testing.assert_array_equal(table.input_energy, [[50.0, 0.0]] * table.time.size)


def test_free_vibration_after_a_displacement():
    k = [2e8, 1.6e8, 1e8]
    tower = sl.ShearBuilding([2e5] * 3, k, [3.5] * 3, 0.05)
    stiffness = np.diag([k[0] + k[1], k[1] + k[2], k[2]]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    shape = np.linalg.eigh(stiffness)[1][:, 0]
    start = sl.Start(displacement=0.01 * shape / shape[-1])
    table = sl.pound([tower], motion=still(2.0), start=start, steps_per_contact=64)
    w = 2 * np.pi / float(tower.periods()[0])
    wd, t = w * np.sqrt(1 - 0.05**2), table.time.values
    roof = 0.01 * np.exp(-0.05 * w * t) * (np.cos(wd * t) + 0.05 * w / wd * np.sin(wd * t))
    np.testing.assert_allclose(table.displacement[:, 0, 2], roof, atol=1e-6)
    assert float(table.peak[0, 2]) == 0.01


@pytest.mark.parametrize(
    ("start", "error", "said"),
    [
        (
            sl.Start(velocity=[1.0]),
            ValueError,
            "has 1 value; allowed: 2, one for each structure, floor or mode: 1, 2",
        ),
        (sl.Start(displacement=[0.1] * 3), ValueError, "displacement has 3 values; allowed: 2"),
        (
            sl.Start([0.02, 0.0], [1.0, 0.0]),
            ValueError,
            r"contact 1 is -0.01 m and closes at 1 m/s",
        ),
        (
            sl.Start([0.02, 0.0], [-1.0, 0.0]),
            ValueError,
            r"contact 1 is -0.01 m and opens at 1 m/s",
        ),
        (
            sl.Start([0.0, 0.03]),
            ValueError,
            "drift of 2 is 0.03 m; allowed: up to 0.02 m, at which",
        ),
        (
            xr.DataArray(np.zeros(3), dims="state"),
            ValueError,
            r"allowed: the end_state, \d+ numbers",
        ),
        (1.0, TypeError, "start = 1.0; allowed: a Start, or the end_state of the motion before"),
    ],
)
def test_starts_that_do_not_fit_are_refused(start, error, said):
    with pytest.raises(error, match=said):
        sl.pound([SOFT, STIFF], 0.01, KELVIN, shaking(), start=start)


def test_no_motion_goes_on_from_one_of_other_arguments():
    record, wall = shaking(200), sl.Wall()
    first = sl.pound([SOFT, STIFF], 0.01, KELVIN, record[:101]).end_state
    others = {
        r"with structure_1 = .* 1.2 s, .*; allowed: that of one with structure_1 = .* 0.6 s": (
            [STIFF, SOFT],
            0.01,
            KELVIN,
            None,
        ),
        r"with contact = Kelvin .*; allowed: that of one with contact = Stereomechanical": (
            [SOFT, STIFF],
            0.01,
            sl.Stereomechanical(0.4),
            None,
        ),
        r"with gaps = 0.01 m; allowed: that of one with gaps = 0.02 m, or a Start": (
            [SOFT, STIFF],
            0.02,
            KELVIN,
            None,
        ),
        r"without wall_right; allowed: that of one with wall_right = Wall": (
            [SOFT, STIFF, wall],
            [0.01, 0.01],
            KELVIN,
            None,
        ),
        r"without link_1; allowed: that of one with link_1 = Link": (
            [SOFT, STIFF],
            0.01,
            KELVIN,
            sl.Link(1e7, 1e6),
        ),
    }
    for said, (row, gaps, contact, link) in others.items():
        with pytest.raises(ValueError, match=f"start is the end_state of a motion {said}"):
            sl.pound(row, gaps, contact, record[100:], link=link, start=first)
    with pytest.raises(ValueError, match=r"with function = pound; allowed: .* function = respond"):
        sl.respond(SOFT, record[100:], start=first)
    with pytest.raises(ValueError, match=r"with structure = .*; allowed: .* structure = .* 0.6 s"):
        sl.respond(STIFF, record[100:], start=sl.respond(SOFT, record[:101]).end_state)
    finer = sl.pound([SOFT, STIFF], 0.01, KELVIN, record[100:], start=first, steps_per_contact=32)
    assert float(finer.energy_balance_error.max()) < 1e-9


def test_no_motion_goes_on_from_a_fall():
    falling = sl.Bilinear(1.2, 0.05, -0.1, yield_displacement=0.02)
    fallen = sl.respond(falling, shaking(400))
    assert fallen.attrs["collapse_s"] > 0
    with pytest.raises(ValueError, match=r"start has NaN, .* falls; allowed: the end_state of one"):
        sl.respond(falling, shaking(400), start=fallen.end_state)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"velocity": [0.0, -50.0]}, r"velocity = 50: .*; is it in cm/s or km/h\?"),
        ({"displacement": 3.0}, r"displacement = 3: .*; is it in cm\?"),
        ({"ground_velocity": 30.0}, "ground_velocity = 30: usual are 0 to 2 m/s"),
    ],
)
def test_implausible_start_values_are_doubted(values, said):
    [text] = sl.Start(**values).doubts()
    assert re.match(said, text)
    assert not [*sl.Start([0.5, -0.5], [2.0, 0.0]).doubts()]


def test_start_values_are_finite_and_in_their_units():
    with pytest.raises(ValueError, match=r"velocity is in 'cm/s', .*; allowed: m/s, so convert"):
        sl.Start(velocity=xr.DataArray([1.0], dims="case", attrs={"units": "cm/s"}))
    with pytest.raises(
        ValueError, match=r"Start: displacement = .*; allowed: a list of finite numbers"
    ):
        sl.Start(displacement=[0.0, np.nan])


def test_a_ground_that_is_still_needs_a_start():
    with pytest.raises(ValueError, match="only zeros"):
        sl.pound([SOFT], motion=still(1.0))


def test_results_say_how_motions_begin():
    pair, record = [SOFT, STIFF], shaking(200)
    start = sl.Start(velocity=[0.5, 0.0], displacement=[0.01, -0.02], ground_velocity=0.1)
    said = "Start (displacement 1, -2 cm, velocity 0.5, 0 m/s, ground velocity 0.1 m/s)"
    table = sl.pound(pair, 0.1, KELVIN, record, start=start)
    assert table.attrs["start"] == said
    motions = {"duration": 2.0, "paths": 32, "start": start}
    assert sl.simulate(pair, sl.WhiteNoise(0.01), **motions).attrs["start"] == said
    on = sl.pound(pair, 0.1, KELVIN, record, start=table.end_state)
    assert on.attrs["start"] == "end_state of the motion before"
    alone = sl.respond(SOFT, record, start=sl.Start(velocity=0.5))
    assert alone.attrs["start"] == "Start (velocity 0.5 m/s)"
    assert "start" not in sl.respond(SOFT, record).attrs
    many = sl.Start(displacement=0.01 * np.arange(20))
    assert many.describe() == "Start (displacement 0 to 19 cm in 20 coordinates)"
