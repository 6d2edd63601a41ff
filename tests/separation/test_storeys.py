"""Gaps, probabilities and measures of buildings with storeys: limits, consistency, bad input."""

import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.oracle

FIRM = sl.named_ground("firm", intensity=0.012)
QUAKE = {"duration": 12.0, "envelope": sl.AminAng(3.0, 8.0, 0.35)}
FEW = {"paths": 128, "seed": 3} | QUAKE


def building(storeys, height=3.2, period=None):
    return sl.ShearBuilding.regular(
        period=period or 0.14 * storeys,
        storeys=storeys,
        storey_height=height,
        mass=3e5,
        damping=0.05,
        hardening=0.1,
        base_shear_coefficient=0.2,
    )


@pytest.fixture(scope="module")
def answer():
    return sl.separation(building(3), building(2, 3.5), FIRM, **FEW)


def test_a_building_alone_is_kept_from_its_line_at_all_floors():
    table = sl.separation(building(3), None, FIRM, **FEW)
    floors = sl.simulate([building(3)], FIRM, **FEW).peak_positive
    np.testing.assert_allclose(table.separation_samples, floors.max("floor"), rtol=1e-12)


def test_buildings_of_one_storey_get_the_answer_of_oscillators():
    one, two = building(1, period=0.5), building(1, period=0.7)
    storeys = sl.separation(one, two, FIRM, **FEW)
    heights = {"height_1": 3.2, "height_2": 3.2, "storeys_1": 1, "storeys_2": 1}
    plain = sl.separation(one.oscillator(), two.oscillator(), FIRM, codes=heights, **FEW)
    assert storeys.height.values.tolist() == [3.2]
    other = ("first_passage_drift", "eq_3_drift", "eq_3_paper")
    known = [name for name in plain.rule.values if name not in other]
    for name in ("gap", "no_pounding_probability", "rho"):
        np.testing.assert_allclose(
            storeys[name].sel(rule=known), plain[name].sel(rule=known), rtol=1e-7, err_msg=name
        )
    for name in ("ductility_1", "yield_displacement_2", "reduction_factor_1", "peak_2"):
        assert float(storeys[name]) == pytest.approx(float(plain[name]), rel=1e-8), name


def test_one_gap_holds_at_all_heights_and_each_height_asks_for_no_more(answer):
    gap, at_height = answer.gap.sel(rule="simulation"), answer.gap_at_height.sel(rule="simulation")
    assert answer.height.values.tolist() == pytest.approx([3.2, 3.5, 6.4, 7.0])
    assert float(gap) == pytest.approx(
        float(np.quantile(answer.separation_samples, 0.9)), rel=1e-12
    )
    assert float(gap) >= float(at_height.max())
    assert float(answer.governing_height[0]) == float(
        at_height.height[int(np.argmax(at_height.values))]
    )
    codes = answer.gap_at_height.sel(rule="srss")
    peaks = np.hypot(answer.peak_at_height_1, answer.peak_at_height_2)
    np.testing.assert_allclose(codes, peaks, rtol=1e-12)
    assert float(answer.gap.sel(rule="srss")) == pytest.approx(float(codes.max()), rel=1e-12)


def test_linearized_rule_is_that_of_the_system(answer):
    table = sl.linearize_system([building(3), building(2, 3.5)], FIRM)
    floors = {name: float(table.displacement_std.sel(floor=name)) for name in ("1.2", "1.3", "2.2")}
    rho = table.rho.sel(floor_2="2.2")
    share = (7.0 - 6.4) / 3.2  # of the third storey of the first at the roof of the second
    one = {"1.2": 1 - share, "1.3": share}
    shared = sum(w * float(rho.sel(floor=f)) * floors[f] * floors["2.2"] for f, w in one.items())
    own = float(table.rho.sel(floor="1.2", floor_2="1.3")) * floors["1.2"] * floors["1.3"]
    variance = sum((w * floors[f]) ** 2 for f, w in one.items()) + 2 * share * (1 - share) * own
    expected = shared / (np.sqrt(variance) * floors["2.2"])
    assert float(answer.rho.sel(rule="eq_3_linearized")) == pytest.approx(expected, rel=1e-9)


def test_finite_motions_are_answered_where_there_is_no_stationary_one():
    """The weight takes a storey's hardening: linearized numbers are missing, the rest is there."""
    soft = sl.ShearBuilding(
        [4e5] * 2, [4e7] * 2, [3.0] * 2, 0.05, 0.05, yield_drifts=0.02, p_delta=True
    )
    measures = {"dampers": sl.Measure(0.1, 0.1)}
    table = sl.mitigate(soft, building(2), FIRM, gap=0.5, measures=measures, **FEW)
    assert np.isfinite(table.required_gap).all()
    assert np.isnan(table.rho).all()
    answer = sl.separation(soft, building(2), FIRM, **FEW)
    assert np.isfinite(answer.gap.sel(rule="simulation"))
    assert "no stationary value" in answer.missing.sel(rule="eq_3_linearized").item()
