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


def of(table, name):
    """Elasticity of an input, and its standard error."""
    one = table.sel(input=name)
    return float(one.elasticity), float(one.elasticity_standard_error)


@pytest.mark.oracle
def test_linear_gaps_go_with_the_root_of_the_intensity():
    first, second = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    table = sl.sensitivity(first, second, GROUND, **MOTION, paths=64)
    elasticity, error = of(table, "ground.intensity")
    assert elasticity == pytest.approx((np.sqrt(1.1) - np.sqrt(0.9)) / 0.2, rel=1e-9)
    one = table.sel(input="ground.intensity")
    assert float(one.slope) == pytest.approx(elasticity * float(table.gap) / 0.01, rel=1e-12)
    ends = (np.sqrt([0.9, 1.1]) - 1) * float(table.gap)
    np.testing.assert_allclose(one.gap_change, ends, rtol=1e-9)
    assert error < 0.2  # of the quantile itself, which the change is in proportion to


@pytest.mark.slow
@pytest.mark.invariant
def test_elasticities_have_no_unit():
    """All times twice as long, and all lengths three times, change none of them."""

    def table(time, length):
        first, second = (
            sl.Bilinear(time * T, 0.05, 0.05, yield_displacement=length * 0.02) for T in (0.6, 1.0)
        )
        ground = sl.KanaiTajimi(uncertain(time * 0.4), 0.6, 0.01 * length**2 / time**3)
        shape = sl.AminAng(2.0 * time, 8.0 * time, 0.5 / time)
        return sl.sensitivity(first, second, ground, 12.0 * time, envelope=shape, paths=32)

    usual, other = table(1, 1), table(2, 3)
    assert float(other.gap) == pytest.approx(3 * float(usual.gap), rel=1e-6)
    np.testing.assert_allclose(other.elasticity, usual.elasticity, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(other.gap_change, 3 * usual.gap_change, rtol=1e-5, atol=1e-6)


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
    assert of(table, "ground.intensity")[0] == pytest.approx(0.5, abs=1e-3)
    assert not [name for name in table.input.values if name.startswith("structure_2")]
    assert "set-back" in table.attrs["title"]


@pytest.mark.slow
@pytest.mark.invariant
def test_ends_of_a_range():
    """16 and 84 % of what is uncertain, 10 % of what is known; no value beyond what a model takes."""
    first = sl.Bilinear(uncertain(0.6), 0.05, 0.95, yield_displacement=0.02)
    table = sl.sensitivity(first, SECOND, GROUND, **MOTION, paths=32)
    factor = table.input_factor_at.sel
    np.testing.assert_allclose(factor(input="structure_1.period"), np.exp([-0.199, 0.199]), rtol=1e-3)
    np.testing.assert_allclose(factor(input="structure_1.damping"), [0.9, 1.1])
    np.testing.assert_allclose(factor(input="structure_1.hardening"), [0.9, 1.0])
    assert np.isfinite(table.slope).all()
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
    assert of(table, "structure_1.mass")[0] == pytest.approx(0, abs=1e-9)  # stiffness goes with it
    stiffer, heavier = (of(table, f"structure_2.{name}")[0] for name in ("stiffnesses", "masses"))
    assert stiffer == pytest.approx(-heavier, rel=0.2)  # both over 10 %, hence not quite


@pytest.mark.oracle
@pytest.mark.slow
@pytest.mark.parametrize("size", [0.0, 0.2])
def test_slopes_against_two_independent_runs(size):
    def pair(period=1.0, strength=1.0):
        first = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02)
        known = {"damping": 0.05, "hardening": 0.05, "yield_displacement": 0.03 * strength}
        median = 1.0 * period
        return first, sl.Bilinear(uncertain(median, size) if size else median, **known)

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
            float(one.separation_quantile_upper - one.separation_quantile_lower) / 3.92 for one in ends
        ]
        by_differences = (gaps[1] - gaps[0]) / 0.2 / float(table.gap)
        error = np.hypot(*errors) / 0.2 / float(table.gap)
        key = {"period": "period", "strength": "yield_displacement"}[name]
        elasticity, own = of(table, f"structure_2.{key}")
        assert abs(elasticity - by_differences) < 3.5 * np.hypot(own, error)
        assert own < error * np.sqrt(8)  # of as many other motions


def test_arrays_and_structures_of_the_wrong_kind_are_refused():
    with pytest.raises(ValueError, match="scalars"):
        sl.sensitivity(sl.Bilinear([0.5, 0.6], 0.05), SECOND, GROUND, **MOTION, paths=32)
    with pytest.raises(TypeError, match="first"):
        sl.sensitivity(0.5, SECOND, GROUND, **MOTION, paths=32)
