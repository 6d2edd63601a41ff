"""CQC of the difference of two buildings: exact for linear ones, its limits, and beside codes."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.applications.separation.storeys import (
    combine_modes,
    facing_heights,
    modes_of,
    oscillators_of,
    weights_at,
)
from stochlin.messages import DoubtfulInput
from stochlin.models.systems import assembly_of

pytestmark = pytest.mark.oracle

GROUND = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.02)
TALL = sl.ShearBuilding([2e5, 2e5, 2e5, 1.5e5], [4e8, 3.6e8, 3e8, 2.2e8], [3.5] * 4, damping=0.05)
LOW = sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], heights=[3.5] * 2, damping=0.05)
SKEW = sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], [3.0, 4.2], damping=0.05)  # floors not level
WHITE = sl.WhiteNoise(0.01)
SPECTRUM = sl.eurocode_8(ag=2.5, soil="C")
ONE, OTHER = sl.Bilinear(0.5, 0.05), sl.Bilinear(0.62, 0.05)


def by_codes(first, second, **options):
    return sl.code_gaps(modes_1=first, modes_2=second, spectrum=SPECTRUM, **options)


def of_peaks(factor, first, second, ground):
    """Gap at each height if the peak of each mode is a factor times its standard deviation."""
    system = assembly_of([first, second])
    modes, heights = modes_of(system), facing_heights(system)
    std = sl.linearize(oscillators_of(modes), ground).displacement_std.values
    peaks, rho = combine_modes(modes, factor * std, ground, weights_at(system, heights))
    return sl.critical_gap(*peaks, rho).gap.values


def test_peaks_in_one_proportion_to_standard_deviations_give_it_to_the_difference():
    """The Lyapunov equation of the storeys knows no modes; all modes have one damping ratio."""
    gaps = of_peaks(3.2, TALL, LOW, WHITE)
    table = sl.linearize_system([TALL, LOW], WHITE).relative_displacement_std
    exact = [float(table.sel(floor=f"1.{n}", floor_2=f"2.{n}")) for n in (1, 2)]
    np.testing.assert_allclose(gaps, 3.2 * np.array(exact), rtol=1e-9)


def test_floors_that_are_not_level_move_with_the_floors_about_them():
    gaps = of_peaks(1.0, TALL, SKEW, GROUND)
    names = ["1.1", "1.2", "1.3", "2.1", "2.2"]
    table = sl.linearize_system([TALL, SKEW], GROUND)
    sigma = table.displacement_std.sel(floor=names).values
    covariance = table.rho.sel(floor=names, floor_2=names).values * np.outer(sigma, sigma)
    own = {3.0: [3 / 3.5, 0, 0], 3.5: [1, 0, 0], 7.0: [0, 1, 0], 7.2: [0, 1 - 0.2 / 3.5, 0.2 / 3.5]}
    other = {3.0: [1, 0], 3.5: [1 - 0.5 / 4.2, 0.5 / 4.2], 7.0: [0.2 / 4.2, 4 / 4.2], 7.2: [0, 1]}
    rows = [np.array([*own[height], *(-share for share in other[height])]) for height in own]
    np.testing.assert_allclose(gaps, [np.sqrt(row @ covariance @ row) for row in rows], rtol=1e-9)


def test_two_oscillators_are_combined_by_eq_3_and_eq_4():
    table, peaks = by_codes(ONE, OTHER), []
    for period in (0.5, 0.62):
        # the plateau of Eurocode 8 and what follows
        ordinate = 2.5 * 1.15 * 2.5 * min(1, 0.6 / period)
        peaks.append(ordinate * (period / (2 * np.pi)) ** 2)
    rho = float(sl.rho_white_noise(0.5, 0.62, 0.05, 0.05).rho)
    expected = float(sl.critical_gap(*peaks, rho).gap)
    gap = float(table.cqc.sel(rule="srss"))
    assert gap == pytest.approx(expected, rel=2e-5)  # the spectrum is interpolated
    assert float(table.rho) == pytest.approx(rho, rel=1e-12)
    assert "height" not in table.dims


def test_the_rule_is_that_of_the_paper_for_elastic_oscillators():
    table = sl.separation(ONE, OTHER, GROUND, 15.0, paths=32)
    rules = table.sel(rule=["cqc", "eq_3_paper"])
    for name in ("gap", "rho"):
        assert float(rules[name][0]) == pytest.approx(float(rules[name][1]), rel=1e-12)
    assert table.kind.sel(rule="cqc").item() == "response_spectrum"


@pytest.mark.extreme
def test_equal_buildings_need_no_gap_and_a_rigid_one_asks_for_the_displacement_of_the_other():
    assert (by_codes(TALL, TALL).cqc.sel(rule="srss") == 0).all()
    rigid = sl.ShearBuilding([1.5e5] * 2, [2.5e14, 2e14], heights=[3.5] * 2, damping=0.05)
    table = by_codes(TALL, rigid).sel(rule="srss")
    alone = sl.code_gaps(modes_1=TALL, spectrum=SPECTRUM).peak_1.sel(height=[3.5, 7.0])
    np.testing.assert_allclose(table.cqc, alone, rtol=1e-5)
    assert (table.peak_2 < 1e-5 * table.peak_1).all()


def test_codes_apply_their_factors_to_both():
    """Eurocode 8 divides by q and multiplies by it; ASCE 7 divides by R and multiplies by Cd."""
    factors = {"behaviour_1": 3.0, "behaviour_2": 5.0, "deflection_1": 2.5, "deflection_2": 4.5}
    plain = by_codes(TALL, LOW)
    table = by_codes(TALL, LOW, importance_1=1.25, importance_2=1.25, **factors)
    for name in ("gap", "cqc"):
        by_ec8 = (t[name].sel(rule="eurocode_8") for t in (table, plain))
        np.testing.assert_allclose(*by_ec8, rtol=1e-12)
    first, second = 2.5 / 3 * plain.peak_1, 4.5 / 5 * plain.peak_2
    expected = sl.critical_gap(first, second, plain.rho).gap
    np.testing.assert_allclose(table.cqc.sel(rule="asce_7"), expected, rtol=1e-12)
    np.testing.assert_allclose(table.gap.sel(rule="asce_7"), first + second, rtol=1e-12)
    assert np.isnan(table.cqc.sel(rule=["srss", "asce_41"])).all()
    lacking = (
        by_codes(TALL, LOW, deflection_1=2.5, deflection_2=4.5).missing.sel(rule="asce_7").item()
    )
    assert lacking == "behaviour_1 (response modification coefficient R), behaviour_2"


def test_each_code_combines_the_displacements_of_each_building():
    table = by_codes(TALL, LOW, same_property=True)
    root = np.hypot(table.peak_1, table.peak_2)
    np.testing.assert_allclose(table.gap.sel(rule="asce_7"), root, rtol=1e-12)
    np.testing.assert_allclose(table.gap.sel(rule="asce_41"), 0.04 * table.height, rtol=1e-12)
    correlated = root**2 - 2 * table.rho * table.peak_1 * table.peak_2
    np.testing.assert_allclose(table.cqc.sel(rule="asce_7") ** 2, correlated, rtol=1e-12)
    beside = by_codes(TALL, ONE)  # a tank as high as the building
    assert beside.height.values.tolist() == [14.0]


def test_dampers_add_to_the_damping_of_modes():
    """Dampers in proportion to the stiffness of the storeys add half of it times the frequency."""
    k = TALL.arrays()["stiffnesses"].values
    damped = sl.ShearBuilding([2e5, 2e5, 2e5, 1.5e5], k, [3.5] * 4, 0.05, dampers=0.002 * k)
    modes = modes_of(assembly_of([damped]))
    np.testing.assert_allclose(modes.damping, 0.05 + 0.002 * np.pi / modes.period, rtol=1e-12)
    strong = sl.ShearBuilding([2e5, 2e5, 2e5, 1.5e5], k, [3.5] * 4, 0.05, dampers=0.1 * k)
    with pytest.raises(
        ValueError, match=r"the mode of 0.0828 s has the damping ratio 3\.84; allowed .* 1$"
    ):
        by_codes(strong, LOW)
    missing = sl.separation(strong, LOW, GROUND, 4.0, paths=32).missing.sel(rule="cqc").item()
    assert missing.startswith("the mode of")


def test_another_damping_ratio_than_that_of_the_spectrum_is_doubtful():
    above = xr.DataArray(SPECTRUM[SPECTRUM.period >= 0.1])
    with pytest.warns(DoubtfulInput, match=r"0\.05, and the modes have 0\.02 to 0\.05: its"):
        table = sl.code_gaps(modes_1=TALL, modes_2=sl.Bilinear(0.5, 0.02), spectrum=above)
    assert np.isfinite(table.cqc.sel(rule="srss")).all()


def test_the_same_structural_system_counts_where_roofs_are_level():
    """Mexico City halves at each level for four storeys beside four, never for four beside two."""
    facts = {"zone": "II", "floors_align": True}
    for other, share in ((TALL, 0.5), (LOW, 1.0)):
        usual, alike = (
            by_codes(TALL, other, **facts, same_system=same).gap.sel(rule="mexico_city")
            for same in (False, True)
        )
        np.testing.assert_allclose(alike, share * usual, rtol=1e-14)


@pytest.mark.filterwarnings("ignore:.*masses = 200")
def test_order_units_of_mass_and_strength_of_shaking_do_not_matter():
    here = by_codes(TALL, SKEW).cqc.sel(rule="srss")
    in_tonnes = replace(TALL, masses=TALL.masses / 1e3, stiffnesses=TALL.stiffnesses / 1e3)
    for same in (by_codes(SKEW, TALL), by_codes(in_tonnes, SKEW)):
        np.testing.assert_allclose(same.cqc.sel(rule="srss"), here, rtol=1e-11)
    thrice = sl.code_gaps(modes_1=TALL, modes_2=SKEW, spectrum=3 * SPECTRUM)
    np.testing.assert_allclose(thrice.cqc.sel(rule="srss"), 3 * here, rtol=1e-11)
