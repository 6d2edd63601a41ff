"""What matters for a gap: exact cases, and finite differences of independent runs."""

import numpy as np
import pytest

import stochlin as sl

GROUND = sl.named_ground("firm", intensity=0.01)
SHAPE = sl.AminAng(2.0, 8.0, 0.5)
MOTION = {"duration": 12.0, "envelope": SHAPE}
SECOND = sl.Bilinear(1.0, 0.05, 0.05, yield_displacement=0.03)


def uncertain(median, size=0.2):
    return sl.Uncertain(median, size)


def relative_changes(table, name):
    """Changes of the gap at both ends of the range of an input, over the gap."""
    return (table.gap_change.sel(input=name) / table.gap).values


@pytest.mark.oracle
def test_linear_gaps_go_with_the_root_of_the_intensity():
    first, second = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    table = sl.sensitivity(first, second, GROUND, **MOTION, paths=64)
    ends = np.sqrt([0.9, 1.1]) - 1
    np.testing.assert_allclose(relative_changes(table, "ground.intensity"), ends, rtol=1e-9)
    errors = table.gap_change_standard_error.sel(input="ground.intensity") / table.gap
    assert (errors < 0.02).all()  # of the quantile itself, which the change is in proportion to


@pytest.mark.slow
@pytest.mark.invariant
def test_the_gap_is_that_of_separation_with_the_same_motions():
    first = sl.Bilinear(uncertain(0.6), 0.05, 0.05, reduction_factor=uncertain(3.0, 0.3))
    table = sl.sensitivity(first, SECOND, GROUND, **MOTION, paths=64, seed=3)
    same = sl.separation(first, SECOND, GROUND, **MOTION, paths=64, seed=3)
    for name in ("gap", "gap_lower", "gap_upper"):
        assert float(table[name]) == pytest.approx(float(same[name][0]), rel=1e-9)
    known = sl.separation(first.median(), SECOND, GROUND, **MOTION, paths=64, seed=3)
    low, high = (float(known[f"gap_{end}"][0]) for end in ("lower", "upper"))
    assert low < float(table.gap_of_medians) < high  # other steps, other motions
    assert list(table.input.values[table.uncertain == 1]) == list(same.input.values)


@pytest.mark.invariant
def test_the_set_back_of_one_building():
    first = sl.Bilinear(uncertain(0.6), 0.05)
    table = sl.sensitivity(first, None, GROUND, **MOTION, paths=64, seed=3)
    same = sl.separation(first, None, GROUND, **MOTION, paths=64, seed=3)
    assert float(table.gap) == pytest.approx(float(same.gap[0]), rel=1e-9)
    ends = np.sqrt([0.9, 1.1]) - 1
    np.testing.assert_allclose(relative_changes(table, "ground.intensity"), ends, rtol=1e-9)
    assert not [name for name in table.input.values if name.startswith("structure_2")]
    assert "set-back" in table.attrs["title"]


@pytest.mark.slow
@pytest.mark.invariant
@pytest.mark.extreme
def test_ends_of_a_range():
    """16 and 84 % of what is uncertain, 10 % of what is known; none beyond what a model takes."""
    first = sl.Bilinear(uncertain(0.6), 0.05, 0.95, yield_displacement=0.02)
    table = sl.sensitivity(first, SECOND, GROUND, **MOTION, paths=32)
    factor = table.input_factor_at.sel
    np.testing.assert_allclose(
        factor(input="structure_1.period"), np.exp([-0.199, 0.199]), rtol=1e-3
    )
    np.testing.assert_allclose(factor(input="structure_1.damping"), [0.9, 1.1])
    np.testing.assert_allclose(factor(input="structure_1.hardening"), [0.9, 1.0])
    assert float(table.gap_change.sel(input="structure_1.hardening", end="high")) == 0
    names = [str(name) for name in table.input.values]
    assert "structure_1.peak_factor" not in names
    assert "ground.intensity" in names


@pytest.mark.slow
@pytest.mark.invariant
def test_numbers_of_buildings_with_storeys_are_varied_storey_by_storey():
    """By the numbers of a regular one where some are uncertain; else each array by one factor."""
    usual = {"storeys": 2, "storey_height": 3.0, "mass": 2e5, "damping": 0.05}
    first = sl.ShearBuilding.regular(period=uncertain(0.5), **usual)
    second = sl.ShearBuilding.regular(period=0.8, **usual)
    table = sl.sensitivity(first, second, GROUND, **MOTION, paths=32)
    named = dict(zip(table.input.values, table.input_unit.values, strict=True))
    assert named["structure_1.period"] == "s"
    assert "structure_1.storeys" not in named
    assert named["structure_2.stiffnesses"] == "1"
    assert float(table.input_median.sel(input="structure_2.stiffnesses")) == 1
    weightless = relative_changes(table, "structure_1.mass")  # stiffness goes with it
    np.testing.assert_allclose(weightless, 0, atol=1e-9)
    stiffer, heavier = (
        np.ptp(relative_changes(table, f"structure_2.{name}")) for name in ("stiffnesses", "masses")
    )
    assert stiffer == pytest.approx(heavier, rel=0.2)  # both over 10 %, hence not quite


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize("size", [0.0, 0.2])
def test_changes_against_two_independent_runs(size):
    def pair(period=1.0, strength=1.0):
        first = sl.Bilinear(
            uncertain(0.6, size) if size else 0.6, 0.05, 0.05, yield_displacement=0.02
        )
        known = {"damping": 0.05, "hardening": 0.05, "yield_displacement": 0.03 * strength}
        return first, sl.Bilinear(1.0 * period, **known)

    table = sl.sensitivity(*pair(), GROUND, **MOTION, paths=512)
    for name in ("period", "strength"):
        ends = [
            sl.simulate(
                pair(**{name: factor}), GROUND, **MOTION, paths=4096, seed=seed, quantiles=[0.9]
            ).isel(quantile=0, structure=0, structure_2=1)
            for factor, seed in ((0.9, 1), (1.1, 2))
        ]
        gaps = [float(one.separation_quantile) for one in ends]
        errors = [
            float(one.separation_quantile_upper - one.separation_quantile_lower) / 3.92
            for one in ends
        ]
        key = {"period": "period", "strength": "yield_displacement"}[name]
        one = table.sel(input=f"structure_2.{key}")
        own = one.gap_change_standard_error  # their sum is at least that of the difference
        change = float(one.gap_change.diff("end").item())
        assert abs(change - (gaps[1] - gaps[0])) < 3.5 * np.hypot(own.sum(), np.hypot(*errors))
        assert (own < np.hypot(*errors) * np.sqrt(8)).all()  # of as many other motions
