"""The set-back of a building: against its own peaks, a neighbour that hardly moves, and by hand."""

import numpy as np
import pytest
import xarray as xr
from motions import shaking

import stochlin as sl

GROUND = sl.named_ground("firm", intensity=0.01)
QUAKE = {"duration": 20.0, "envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 256, "seed": 3}
OFFICE = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4)
TOWER = sl.ShearBuilding(
    [4e5] * 4, [3e8] * 4, [3.0] * 4, 0.05, hardening=0.05, yield_drifts=0.008, p_delta=True
)
OF_ONE = {"simulation", "linearization", "cqc", "share_of_sum", "asce_7", "ubc_97", "eurocode_8"}


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("structure", "scatter"),
    [
        (OFFICE, 0.0),
        (sl.Bilinear(sl.Uncertain(1.0, 0.2), 0.05, 0.05, reduction_factor=4), 0.3),
        (TOWER, 0.0),
    ],
)
def test_it_is_the_largest_displacement_to_one_side(structure: object, scatter: float) -> None:
    table = sl.separation(structure, None, GROUND, **QUAKE, scatter=scatter)
    motions = sl.simulate([structure], GROUND, **QUAKE, scatter=scatter, quantiles=[0.9])
    towards = motions.peak_positive.values.max(axis=1)
    np.testing.assert_array_equal(table.separation_samples, towards)
    assert float(table.gap.sel(rule="simulation")) == np.quantile(towards, 0.9)
    assert float(table.peak_1) == np.quantile(motions.peak.values[:, -1], 0.9)
    assert float(table.gap_lower[0]) < float(table.gap[0]) < float(table.gap_upper[0])
    np.testing.assert_allclose(table.separation_mean, towards.mean(), rtol=1e-12)
    assert not [name for name in table.variables if str(name).endswith("_2")]
    assert table.attrs["title"].startswith("Set-back of one building from its property line")
    if "input_factor" in motions:
        np.testing.assert_array_equal(table.input_factor, motions.input_factor)


@pytest.mark.invariant
def test_a_building_stays_on_its_side_with_every_floor() -> None:
    table = sl.separation(TOWER, None, GROUND, **QUAKE, codes={"zone": "II"})
    motions = sl.simulate([TOWER], GROUND, **QUAKE)
    np.testing.assert_array_equal(table.height, TOWER.levels())
    by_floor = np.quantile(motions.peak_positive.values, 0.9, axis=0)
    np.testing.assert_array_equal(table.gap_at_height.sel(rule="simulation"), by_floor)
    np.testing.assert_array_equal(table.peak_at_height_1, np.quantile(motions.peak, 0.9, axis=0))
    assert float(table.governing_height.sel(rule="simulation")) == 12.0
    low, high = (table[f"gap_at_height_{end}"].sel(rule="simulation") for end in ("lower", "upper"))
    assert ((low < by_floor) & (by_floor < high)).all()
    by_hand = np.maximum(table.peak_at_height_1 + 0.003 * TOWER.levels(), 0.05)
    np.testing.assert_array_equal(table.gap_at_height.sel(rule="mexico_city"), by_hand)
    assert set(table.element.values) == {"1.1", "1.2", "1.3", "1.4"}


@pytest.mark.invariant
def test_rules_of_two_say_that_they_need_a_second() -> None:
    of_site = {"height_1": 24.0, "storeys_1": 7, "zone": "I"}
    table = sl.separation(OFFICE, None, GROUND, **QUAKE, codes=of_site)
    known = table.gap.notnull()
    assert set(table.rule.values[known]) >= OF_ONE | {
        "mexico_city",
        "mexico_city_simplified",
        "peru_e030",
        "iran_2800",
        "nsr_10",
        "nzs_1170_5",
    }
    for rule in table.rule.values[~known]:
        assert table.missing.sel(rule=rule).item().startswith("needs a second building")
    assert set(table.verdict.values[~known.values]) == {4}


@pytest.mark.paper
def test_codes_of_one_building_by_hand() -> None:
    """The paper's families; ASCE 7-16 12.12.3; Eurocode 8 4.4.2.7; Mexico City 1.10; Peru 33.3."""
    stated = {"share_of_height": 0.005, "fixed_distance": 0.04, "share_of_sum": 0.8}
    one = sl.code_gaps([0.02, 0.1], None, height_1=10.0, zone="III", numbers=stated)
    by_hand = {
        "asce_7": [0.02, 0.1],
        "eurocode_8": [0.02, 0.1],
        "peru_e030": [0.03, 0.1 * 2 / 3],
        "share_of_sum": [0.016, 0.08],
        "share_of_height": [0.05, 0.05],
        "fixed_distance": [0.04, 0.04],
        "mexico_city": [0.08, 0.16],
        "mexico_city_simplified": [0.12, 0.12],
    }
    for rule, gaps in by_hand.items():
        np.testing.assert_allclose(one.gap.sel(rule=rule), gaps)
    low = sl.code_gaps(0.001, None, height_1=2.0, zone="I")
    assert float(low.gap.sel(rule="mexico_city")) == 0.05
    assert one.missing.sel(rule="canada").item().startswith("a second building")
    assert sl.code_gaps(0.02, None).missing.sel(rule="mexico_city").item() == "height_1, zone"
    assert sl.rules.code_rule("asce_7").gap(0.03, None) == 0.03


@pytest.mark.invariant
def test_what_an_existing_set_back_allows_and_how_often_it_is_crossed() -> None:
    quake = QUAKE | {"paths": 64}
    gap = float(sl.separation(OFFICE, None, GROUND, **quake).gap[0])
    found = sl.existing_gap(OFFICE, None, GROUND, gap=gap, **quake)
    assert float(found.required_gap) == gap
    assert float(found.largest_intensity) == pytest.approx(0.01, rel=2e-3)
    assert not [name for name in found.variables if str(name).endswith("_2")]
    assert found.attrs["title"].startswith("What an existing set-back allows")


@pytest.mark.invariant
def test_a_table_of_buildings_has_a_set_back_each() -> None:
    periods = xr.DataArray(
        [0.5, -1.0, 30.0, 1.0], dims="period", coords={"period": [0.5, -1, 30, 1.0]}
    )
    table = sl.separation(sl.Bilinear(periods, 0.05), None, GROUND, **QUAKE)
    one = sl.separation(sl.Bilinear(0.5, 0.05), None, GROUND, **QUAKE)
    assert table.gap.isel(period=0).equals(one.gap.assign_coords(period=0.5))
    assert table.gap.isel(period=[1, 2]).isnull().all()
    assert float(table.gap.sel(rule="simulation").isel(period=3)) > 0


@pytest.mark.oracle
def test_the_risk_of_crossing_a_line_is_that_of_the_peaks_of_a_linear_building() -> None:
    """Of a motion the line is reached at ``S0`` times the square of the gap over its peak."""
    quake = QUAKE | {"paths": 64}
    linear, hazard = sl.Bilinear(0.7, 0.05), sl.PowerLawHazard(k0=1e-4, k=1.2, measure="intensity")
    towards = sl.simulate([linear], GROUND, **quake).peak_positive.values[:, 0]
    gap = 3 * float(np.median(towards))
    by_hand = float(np.mean(hazard.frequency(xr.DataArray(0.01 * (gap / towards) ** 2))))
    table = sl.pounding_risk(linear, None, GROUND, gap, hazard, **quake)
    assert float(table.annual_rate) == pytest.approx(by_hand, rel=0.01)
    needed = sl.required_gap(linear, None, GROUND, hazard, risk=by_hand, **quake)
    assert float(needed.required_gap) == pytest.approx(gap, rel=0.01)
    assert "crossing its property line" in table.attrs["title"]


@pytest.mark.invariant
def test_its_peak_is_that_beside_a_neighbour_on_the_same_motions() -> None:
    """A softer neighbour leaves the time steps as they are."""
    beside = sl.separation(OFFICE, sl.Bilinear(1.7, 0.05), GROUND, **QUAKE)
    alone = sl.separation(OFFICE, None, GROUND, **QUAKE)
    for name in (
        "peak_1",
        "peak_mean_1",
        "ductility_1",
        "yield_displacement_1",
        "reduction_factor_1",
    ):
        assert float(alone[name]) == float(beside[name]), name


@pytest.mark.oracle
@pytest.mark.parametrize(
    "structure",
    [
        sl.Bilinear(1.0, 0.05, 0.05, yield_displacement=0.02),
        sl.BoucWen(1.0, 0.05, 0.05, yield_displacement=0.02),
        TOWER,
    ],
    ids=["bilinear", "bouc_wen", "tower"],
)
def test_in_a_record_it_is_the_largest_displacement_of_respond(structure: sl.Bilinear) -> None:
    record = shaking(300, 0, 2.0)
    motion = sl.respond(structure, record, refine=8).displacement
    table = sl.recorded_gap(structure, None, record)
    assert float(table.separation) == pytest.approx(float(motion.max()), rel=1e-3)
    roof = motion if motion.ndim == 1 else motion[:, -1]
    assert float(table.peak_1) == pytest.approx(float(abs(roof).max()), rel=1e-3)
