"""The table of rules: what it has is what its parts say, and the parts agree with the samples."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

FIRM = sl.named_ground("firm", intensity=0.01)
QUAKE = sl.AminAng(4.0, 15.0, 0.35)
SHORT = {"paths": 512, "envelope": QUAKE}
VERDICTS = {
    "answer": 0,
    "at least": 1,
    "less": 2,
    "within_error": 3,
    "not_available": 4,
    "no_verdict": 5,
}
COMBINED = {"asce_7", "canada", "eurocode_8", "ubc_97", "is_1893", "taiwan", "peru_e030"}
OF_SITE = {"height_1": 20.0, "height_2": 30.0, "storeys_1": 6, "storeys_2": 9, "design_pga": 2.0}
COMBINED |= {"tbdy_2018", "ntc_2008", "ntc_2018", "iran_2800", "nzs_1170_5"}


def building(period, **options):
    return sl.Bilinear(period, 0.05, **({"hardening": 0.05, "reduction_factor": 4.0} | options))


@pytest.fixture(scope="module")
def table():
    pair = building(0.6), building(1.0)
    return sl.separation(*pair, FIRM, 30.0, confidence=0.8, codes=OF_SITE, **SHORT)


def row(table, rule):
    return table.sel(rule=rule)


def test_answer_is_the_quantile_of_the_simulated_separation(table):
    pair = [building(0.6), building(1.0)]
    motions = sl.simulate(pair, FIRM, duration=30.0, quantiles=[0.8], **SHORT)
    samples = motions.separation[:, 0, 1].values
    np.testing.assert_array_equal(table.separation_samples, samples)
    answer = row(table, "simulation")
    assert float(answer.gap) == pytest.approx(np.quantile(samples, 0.8), rel=1e-12)
    assert float(answer.gap_lower) < float(answer.gap) < float(answer.gap_upper)
    assert float(answer.no_pounding_probability) == pytest.approx(0.8, abs=2 / 512)
    assert float(answer.error) == 0


def test_rules_are_fed_with_the_peaks_of_the_simulation(table):
    first, second = float(table.peak_1), float(table.peak_2)
    assert float(row(table, "srss").gap) == pytest.approx(np.hypot(first, second), rel=1e-12)
    assert float(row(table, "share_of_sum").gap) == pytest.approx(first + second, rel=1e-12)
    rho = row(table, "eq_3_elastic").rho
    assert float(rho) == pytest.approx(
        float(sl.rho_white_noise(0.6, 1.0, 0.05, 0.05).rho), rel=1e-12
    )
    for rule in table.rule.values:
        if str(rule).startswith("eq_3") and rule != "eq_3_paper":
            expected = sl.critical_gap(first, second, float(row(table, rule).rho)).gap
            assert float(row(table, rule).gap) == pytest.approx(float(expected), rel=1e-12)


def test_probability_and_error_are_those_of_the_samples(table):
    samples = table.separation_samples.values
    answer = float(row(table, "simulation").gap)
    for rule in table.rule.values:
        gap = float(row(table, rule).gap)
        if np.isnan(gap):
            assert row(table, rule).missing.item()
            assert int(row(table, rule).verdict) == VERDICTS["not_available"]
            continue
        if rule not in COMBINED:
            assert float(row(table, rule).no_pounding_probability) == np.mean(samples <= gap)
        assert float(row(table, rule).error) == pytest.approx(gap / answer - 1, abs=1e-12)


def test_what_a_code_makes_of_simulated_peaks_has_no_verdict(table):
    """It defines displacements of its own; families of rules, and codes by height, are judged."""
    assert {
        str(n) for n in table.rule.values[table.verdict.values == VERDICTS["no_verdict"]]
    } == COMBINED
    for rule in COMBINED:
        for end in ("", "_lower", "_upper"):
            assert np.isnan(row(table, rule)[f"no_pounding_probability{end}"])
    for rule in ("srss", "share_of_sum", "asce_41", "china_gb_50011"):
        assert int(row(table, rule).verdict) in (1, 2, 3)
    assert "has no verdict" in table.attrs["comment"]


def test_equal_buildings_ask_for_no_gap():
    equal = sl.separation(building(0.8), building(0.8), FIRM, 20.0, **SHORT)
    assert float(row(equal, "simulation").gap) == 0
    for rule in ("eq_3_linearized", "eq_3_drift", "eq_3_paper", "linearization"):
        assert float(row(equal, rule).gap) == 0
    assert int(row(equal, "srss").verdict) == VERDICTS["at least"]
    assert np.isnan(row(equal, "srss").error)


def test_records_stand_beside_the_rules(table):
    time = 0.02 * np.arange(800)
    shape = np.random.default_rng(3).standard_normal(800) * np.sin(np.pi * time / 16)
    record = xr.DataArray(shape, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})
    pair = (building(0.6), building(1.0))
    with_records = sl.separation(
        *pair, FIRM, 30.0, records={"one": record, "two": 2 * record}, **SHORT
    )
    strengths = [float(table[f"yield_displacement_{n}"]) for n in (1, 2)]
    alone = sl.recorded_gap(
        *(
            sl.Bilinear(T, 0.05, 0.05, yield_displacement=u)
            for T, u in zip((0.6, 1.0), strengths, strict=True)
        ),
        {"one": record, "two": 2 * record},
    )
    np.testing.assert_allclose(with_records.record_separation, alone.separation, rtol=1e-9)


@pytest.mark.slow
def test_rules_that_need_linearization_are_not_available_far_beyond_yield():
    """The simulation answers, and so do the rules that are fed with it; the others say why not."""
    weak, elastic = building(0.6, reduction_factor=1e300), sl.Bilinear(1.0, 0.05)
    table = sl.separation(weak, elastic, sl.named_ground("firm", intensity=0.01), 10.0, paths=128)
    gap = table.gap.to_series()
    assert gap["simulation"] > 0
    assert gap["share_of_sum"] > gap["simulation"]
    for rule in ("eq_3_linearized", "eq_3_paper"):
        assert np.isnan(gap[rule])
    assert "shaking too strong" in str(table.missing.sel(rule="eq_3_linearized").values)
    assert table.missing.sel(rule="eq_3_paper").item()


def test_gaps_go_with_the_motion(table):
    louder = sl.named_ground("firm", intensity=0.04)
    pair = building(0.6), building(1.0)
    other = sl.separation(*pair, louder, 30.0, confidence=0.8, codes=OF_SITE, **SHORT)
    for rule in ("simulation", "srss", "linearization", "eq_3_iwan_1980", "eq_3_paper"):
        assert float(row(other, rule).gap / row(table, rule).gap) == pytest.approx(2, rel=1e-9), (
            rule
        )
