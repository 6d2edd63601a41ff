"""Effective properties and separation rules: formulas by other roads, limits and invariance."""

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import stochlin as sl
from stochlin import rules

pytestmark = pytest.mark.oracle

EFFECTIVE = rules.effective_rule_names(unverified=True)
GROUND = sl.KanaiTajimi(1.0, 0.3, intensity=0.01)


@pytest.mark.parametrize("name", EFFECTIVE)
def test_elastic_structures_keep_their_period_and_damping(name):
    rule = rules.effective_rule(name)
    mu = np.array([1e-3, 0.5, 1.0])
    np.testing.assert_array_equal(rule.period_ratio(mu, 0.05), 1)
    np.testing.assert_array_equal(rule.damping(mu, 0.05, 0.02), 0.02)


def loop_area(mu, alpha, points=100_000):
    """Area of a steady bilinear loop of amplitude mu, by the trapezoidal rule along its path."""
    down = np.linspace(mu, -mu, points)
    top = 1 + alpha * (mu - 1)
    force = np.maximum(top - (mu - down), -1 + alpha * (down + 1))
    return abs(2 * np.trapezoid(force, down))  # the way back is the same, mirrored


@pytest.mark.parametrize("alpha", [0.0, 0.05, 0.3])
@pytest.mark.parametrize("mu", [1.5, 4.0, 10.0])
def test_secant_rule_is_stiffness_and_energy_of_a_loop(mu, alpha):
    rule = rules.effective_rule("secant")
    secant = (1 + alpha * (mu - 1)) / mu
    assert float(rule.period_ratio(mu, alpha)) == pytest.approx(secant**-0.5, rel=1e-14)
    energy = loop_area(mu, alpha) / (2 * np.pi * secant * mu**2)
    # a kink between two of 1e5 points: 1e-5 of the area
    assert float(rule.damping(mu, alpha, 0.03)) - 0.03 == pytest.approx(energy, rel=1e-4)


@pytest.mark.parametrize(
    ("name", "mu", "period", "damping"),
    [
        ("iwan_1980", 2, 1.121, 0.0587),
        ("iwan_1980", 5, 1.44475384, 0.0981753273),
        ("fema_440", 2, 1.162, 0.038),
        ("fema_440", 5, 1.80, 0.1528),
        ("fema_440", 8, 2.17522489, 0.155878115),
        ("jeng_kasai_maison_1992_unverified", 3, 1.18, 0.206832261),
        ("kasai_jagiasi_jeng_1996_unverified", 3, 1.36, 0.298570557),
    ],
)
def test_fitted_rules_by_hand(name, mu, period, damping):
    """Worked out apart, in decimal arithmetic; nine digits."""
    rule = rules.effective_rule(name)
    assert float(rule.period_ratio(mu, 0.05)) == pytest.approx(period, rel=5e-9)
    assert float(rule.damping(mu, 0.05, 0.05)) - 0.05 == pytest.approx(damping, rel=5e-9)


PAIR = {"damping_1": 0.05, "damping_2": 0.03, "hardening_1": 0.05, "hardening_2": 0.1}


@given(st.floats(0.1, 5), st.floats(0.1, 5), st.floats(0.1, 20), st.floats(0.1, 20))
def test_rho_effective_is_eq_4_at_its_periods_and_dampings(one, two, mu_1, mu_2):
    for name in EFFECTIVE:
        table = rules.rho_effective(one, two, **PAIR, ductility_1=mu_1, ductility_2=mu_2, rule=name)
        rule = rules.effective_rule(name)
        period = one * rule.period_ratio(mu_1, 0.05)
        assert float(table.period_eq_1) == pytest.approx(float(period), rel=1e-15)
        assert 0 < float(table.rho) <= 1
        effective = [float(table[f"{x}_eq_{n}"]) for x in ("period", "damping") for n in (1, 2)]
        if max(effective[2:]) < 1:
            formula = float(sl.rho_white_noise(*effective).rho)
            assert float(table.rho) == pytest.approx(formula, rel=1e-14)


@pytest.mark.parametrize("rule", EFFECTIVE)
def test_correlate_takes_linearized_peak_ductilities(rule):
    strength = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 4.0}
    periods = xr.DataArray([0.4, 0.7, -1.0], dims="first")
    pair = (
        sl.Bilinear(period=periods, peak_factor=2.5, **strength),
        sl.BoucWen(period=1.0, **strength),
    )
    table = sl.correlate(*pair, GROUND, method="effective", rule=rule)
    ductility = [
        p * sl.linearize(s, GROUND).ductility_std for p, s in zip((2.5, 3.0), pair, strict=True)
    ]
    direct = rules.rho_effective(
        periods[:2], 1.0, 0.05, 0.05, 0.05, 0.05, ductility[0][:2], ductility[1], rule
    )
    np.testing.assert_allclose(table.rho[:2], direct.rho, rtol=1e-14)
    np.testing.assert_array_equal(table.ductility_peak_1, ductility[0])
    assert np.isnan(table.rho[2])
    assert int(table.status[2]) == 3
    assert rule in table.attrs["rule"]
    assert "linearized" in table.attrs["comment"]


# ---- Rules of codes

SITE = {"height_1": 12.0, "height_2": 20.0, "zone": "II"}
SITE |= {"storeys_1": 3, "storeys_2": 9, "design_pga": 2.5}


@pytest.mark.parametrize(
    ("name", "two", "two_level", "one", "one_level"),
    [
        ("srss", 0.05, 0.05, 0.05, 0.05),
        ("share_of_sum", 0.07, 0.07, 0.07, 0.07),
        ("asce_7", 0.07, 0.07, 0.05, 0.05),
        ("canada", 0.05, 0.05, 0.05, 0.05),
        ("eurocode_8", 0.07, 0.07, 0.05, 0.035),
        ("ubc_97", 0.07, 0.07, 0.05, 0.05),
        ("mexico_city", *4 * (0.03 + 0.036 + 0.04 + 0.06,)),
        ("is_1893", 0.07, 0.07, 0.07, 0.07),
        ("taiwan", 0.042, 0.042, 0.042, 0.042),
        ("peru_e030", 0.036 + 0.06, 0.036 + 0.06, 0.072, 0.072),
        ("asce_41", 0.48, 0.48, 0.48, 0.48),
        ("mexico_city_simplified", *4 * (0.108 + 0.18,)),
        ("china_gb_50011", 0.1, 0.1, 0.1, 0.1),
        ("tbdy_2018", *4 * (0.03 + 0.01 * 6 / 3,)),
        ("ntc_2008", *4 * (0.07,)),
        ("ntc_2018", *4 * (0.07,)),
        ("iran_2800", *4 * (0.005 * 12 + 0.005 * 20,)),
        ("nsr_10", 0.03 * 20, 0.02 * 20, 0.03 * 20, 0.02 * 20),
        ("nzs_1170_5", *4 * (0.07,)),
    ],
)
def test_gaps_of_codes_are_those_by_hand(name, two, two_level, one, one_level):
    """Two properties and one, floors that are not level and level; 12 m beside 20 m."""
    rule = rules.code_rule(name)
    for same_property, gaps in ((False, (two, two_level)), (True, (one, one_level))):
        for level, gap in zip((False, True), gaps, strict=True):
            told = {"same_property": same_property, "floors_align": level}
            for same_system in (False, True):
                found = rule.gap(0.03, 0.04, **SITE, **told, same_system=same_system)
                assert float(found) == pytest.approx(gap, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "whole"), [("mexico_city", 0.142), ("mexico_city_simplified", 0.216)]
)
def test_mexico_city_halves_for_the_same_height_system_and_levels_only(name, whole):
    """NTC-Sismo 1.10: the same height, "estructuracion" and slabs at the same levels, all three."""
    rule, alike = rules.code_rule(name), {"floors_align": True, "same_system": True}
    heights = np.array([12.0, 12.1])
    assert rule.gap(0.03, 0.04, 12.0, heights, zone="II", **alike)[0] == pytest.approx(whole / 2)
    assert rule.gap(0.03, 0.04, 12.0, heights, zone="II", **alike)[1] > whole
    for lacking in alike:
        told = alike | {lacking: False}
        assert rule.gap(0.03, 0.04, 12.0, 12.0, zone="II", **told) == pytest.approx(
            whole, rel=1e-12
        )


def test_least_distances_and_steps_of_mexico_city_and_china():
    """NTC-Sismo by zone, 50 mm at least; GB 50011: 6 m above 15 m, by the intensities 6 to 9."""
    zones = {"I": (0.05, 0.05), "II": (0.056, 0.054), "III": (0.092, 0.072)}
    for zone, (each, simplified) in zones.items():
        gap = rules.code_rule("mexico_city").gap(0.02, 0.02, 12.0, 12.0, zone=zone)
        assert float(gap) == pytest.approx(2 * each, rel=1e-12)
        gap = rules.code_rule("mexico_city_simplified").gap(0.9, 0.9, 6.0, 6.0, zone=zone)
        assert float(gap) == pytest.approx(2 * simplified, rel=1e-12)
    for step, wide in ((5.0, 0.124), (4.0, 0.13), (3.0, 0.14), (2.0, 0.16)):
        rule = rules.code_rule("china_gb_50011", step)
        assert float(rule.gap(0.9, 0.9, 21.0, 30.0)) == pytest.approx(wide, rel=1e-12)
        assert float(rule.gap(0.9, 0.9)) == float(rule.gap(0.9, 0.9, 15.0, 90.0)) == 0.1


def test_a_number_of_ones_own_stands_in_the_table_and_is_told():
    numbers = {"share_of_height": 0.01, "Fixed Distance": 0.08, "asce_41": 0.03, "share_of_sum": 1}
    table = sl.code_gaps(0.03, 0.04, **SITE, numbers=numbers)
    assert [n for n in table.rule.values if n not in rules.code_rule_names()] == [
        "share_of_height",
        "fixed_distance",
    ]
    for name, gap, told in (
        ("share_of_height", 0.12, "factor 0.01; the peaks are not used"),
        ("fixed_distance", 0.08, "distance 0.08; the peaks are not used"),
        ("asce_41", 0.36, "factor 0.03; 0.04 of the height"),
        ("share_of_sum", 0.07, "peaks are"),
    ):
        one = table.sel(rule=name)
        assert float(one.gap) == pytest.approx(gap, rel=1e-12)
        assert one.assumptions.item().startswith(told)
    assert "'asce_41': 0.03" in table.attrs["history"]


def test_peru_has_three_ways_to_be_the_largest_and_asks_for_more_as_of_2026():
    """2/3 of the peaks, 0.006 h or 30 mm; as of 2026 0.02 Z S h, Z = 0.45 and S = 1.05 at 15 m."""
    for name, number, peaks, height, gap in (
        ("peru_e030", None, 0.001, 2.0, 0.03),
        ("peru_e030", None, 0.001, 10.0, 0.06),
        ("peru_e030", None, 0.3, 10.0, 0.4),
        ("peru_e030_2026", 0.45 * 1.05, 0.01, 15.0, 0.14175),
    ):
        rule = rules.code_rule(name, number)
        within = rule.gap(peaks, peaks, height, 50.0, same_property=True)
        assert float(within) == pytest.approx(gap, rel=1e-12)
        assert float(rule.gap(peaks, None, height)) == pytest.approx(gap / 2, rel=1e-12)


def test_rules_without_their_data_are_nan_and_say_what_is_missing():
    table = sl.code_gaps(0.03, [0.04, -0.1], height_1=12.0)
    lacking = dict.fromkeys(("mexico_city", "mexico_city_simplified"), "height_2, zone")
    lacking |= dict.fromkeys(("peru_e030", "asce_41", "tbdy_2018"), "height_2")
    lacking |= dict.fromkeys(("ntc_2008", "ntc_2018"), "height_2, design_pga")
    lacking |= dict.fromkeys(("iran_2800", "nsr_10"), "height_2, storeys_1, storeys_2")
    lacking |= dict.fromkeys(
        ("srss", "share_of_sum", "asce_7", "canada", "eurocode_8", "ubc_97"), ""
    )
    lacking |= dict.fromkeys(("taiwan", "is_1893", "china_gb_50011", "nzs_1170_5"), "")
    for name in rules.code_rule_names():  # at least these
        chosen = table.sel(rule=name)
        missing = str(chosen.missing.item())
        assert missing == lacking.get(name, missing)
        expected = [3, 3] if missing else [0, 3]
        assert chosen.status.values.tolist() == expected
        assert np.isnan(chosen.gap).values.tolist() == [code == 3 for code in expected]


def gap_of(name, *values, **others):
    return lambda: rules.code_rule(name).gap(*values, **others)


def gaps(**change):
    return lambda: sl.code_gaps(**{"peak_1": 0.03, "peak_2": 0.04} | change)


TOWER = sl.ShearBuilding([4e5] * 2, [3e8] * 2, [3.0] * 2, 0.05)
SHED = sl.ShearBuilding([4e5], [3e8], [3.5], 0.05)
SPECTRUM = sl.eurocode_8(2.0, "B")


def of_modes(**change):
    return lambda: sl.code_gaps(**{"modes_1": TOWER, "spectrum": SPECTRUM} | change)


def separated(**change):
    usual = {"first": TOWER, "second": None, "ground": GROUND, "duration": 9.0}
    return lambda: sl.separation(**usual | change)


TWO = 0.03, 0.04
ALIKE = [sl.Bilinear([1.0, 2.0][:n] * 2, 0.05, 0.1, reduction_factor=2) for n in (1, 2)]
REFUSED = {
    r"rule = 'magic' .*elastic, secant, .*iwan_1980, fema_440": lambda: rules.effective_rule(
        "magic"
    ),
    "first, second and ground share a dim": lambda: sl.correlate(
        *ALIKE, GROUND, method="effective"
    ),
    "ductility_2 = 0 ": lambda: rules.rho_effective(
        1.0, 1.2, **PAIR, ductility_1=4.0, ductility_2=0
    ),
    r"name = 'mars' .*asce_7, .*fixed_distance": lambda: rules.code_rule("mars"),
    "value is not given; fixed_distance needs it": lambda: rules.code_rule("fixed_distance"),
    "value is not given; peru_e030_2026 needs it": lambda: rules.code_rule("peru_e030_2026"),
    r"value = 2\.0 is given to asce_7; allowed for share_": lambda: rules.code_rule("asce_7", 2.0),
    "factor = 0.0; allowed: a positive": lambda: rules.code_rule("share_of_sum", 0.0),
    "mexico_city needs height_1, height_2, zone, which is not given": gap_of("mexico_city", *TWO),
    "peru_e030 needs height_2, ": gap_of("peru_e030", *TWO, 12.0),
    "zone = 'IV' is not known; allowed: I, II, III": gap_of(
        "mexico_city", *TWO, 12.0, 12.0, zone="IV"
    ),
    "ntc_2018 needs design_pga, which": gap_of("ntc_2018", *TWO, 12.0, 12.0),
    "iran_2800 needs storeys_1, storeys_2, which": gap_of("iran_2800", *TWO, 12.0, 12.0),
    "nsr_10 needs storeys_1, which is not given": gap_of("nsr_10", 0.03, None, 12.0),
    "tbdy_2018 needs a second building": gap_of("tbdy_2018", 0.03, None, 12.0),
    "a name in numbers = 'mars' is not a known code rule": gaps(numbers={"mars": 0.1}),
    "asce_41: factor = 'a lot'; allowed: a positive number": gaps(numbers={"asce_41": "a lot"}),
    r"numbers = \[0.1\]; allowed: a mapping": gaps(numbers=[0.1]),
    "height_1 = 0 ": gaps(height_1=0.0),
    "peak_1 = -0.1": gaps(peak_1=-0.1),
    "floors_align = 'yes'": gaps(floors_align="yes"),
    "design_pga = 0 ": gaps(design_pga=0.0),
    r"storeys_1 = 0\.5 is out of range": gaps(storeys_1=0.5),
    "storeys_2 is given, of a second building": gaps(peak_2=None, storeys_2=3),
    "importance is given alone; give behaviour_1": gaps(importance_1=1.2),
    r"behaviour_2 = 0\.9 is out of range; allowed: 1 <= value": gaps(
        behaviour_1=2.0, behaviour_2=0.9
    ),
    "peak_1 is missing, or given beside": gaps(peak_1=None, peak_2=None),
    "peak_1 is missing, or given beside modes_1": gaps(modes_1=TOWER, spectrum=SPECTRUM),
    "modes_1 and spectrum go together": gaps(modes_2=TOWER),
    "modes_1 and spectrum go together, and": of_modes(spectrum=None),
    r"spectrum ends at 0\.06 s, and a mode has": of_modes(
        spectrum=SPECTRUM.sel(period=slice(0, 0.06))
    ),
    "modes_1: period is an array; allowed: numbers": of_modes(
        modes_1=sl.Bilinear([0.5, 0.6], 0.05)
    ),
    "height_1 = 12 m, but the storeys add up to 6 m": of_modes(height_1=12.0),
    "storeys_1 = 3, but that building has 2 storeys; leave it out": separated(
        codes={"storeys_1": 3}
    ),
    r"floors_align = True, but at 3, 3\.5 m only one": separated(
        second=SHED, codes={"floors_align": True}
    ),
    "floors_align is given, of a second building": separated(codes={"floors_align": True}),
    "codes has 'heigth_1', .*did you mean 'height_1'": separated(codes={"heigth_1": 3.0}),
    r"codes = \['zone'\]; allowed: a mapping": separated(codes=["zone"]),
    r"peak_1 = -0\.1 .*allowed: 0 <= value": lambda: sl.critical_gap(-0.1, 0.2, 0.5),
    r"rho = 1\.01 .*-1 <= value <= 1": lambda: sl.critical_gap(0.1, 0.2, 1.01),
}


@pytest.mark.parametrize("message", REFUSED)
def test_what_cannot_be_is_refused(message):
    with pytest.raises((ValueError, TypeError), match=message):
        REFUSED[message]()


@pytest.mark.parametrize("name", EFFECTIVE)
def test_effective_rules_are_continuous_where_yielding_begins(name):
    """Iwan's damping begins like the power 0.371 of the distance: 1e-12 of it is 3e-5 of 0.0587."""
    rule = rules.effective_rule(name)
    assert float(rule.period_ratio(1 + 1e-12, 0.05)) == pytest.approx(1, abs=1e-10)
    assert float(rule.damping(1 + 1e-12, 0.05, 0.05)) == pytest.approx(0.05, abs=3e-6)


@pytest.mark.parametrize("name", EFFECTIVE)
@given(st.floats(1, 20), st.floats(1.0001, 3), st.floats(0.001, 0.5), st.floats(0.01, 0.2))
def test_more_ductility_is_a_longer_period_and_no_less_damping(name, mu, factor, alpha, xi):
    """But for a step of FEMA 440 between two pieces of its fit."""
    rule = rules.effective_rule(name)
    low, high = (float(rule.period_ratio(m, alpha)) for m in (mu, mu * factor))
    assert high >= low * (1 - (0.104 / 1.774 if name == "fema_440" else 1e-14))
    assert float(rule.damping(mu, alpha, xi)) >= xi


@settings(max_examples=30)
@given(*2 * [st.floats(1e-3, 1)], *2 * [st.floats(3, 100)], *3 * [st.booleans()])
def test_codes_do_not_ask_which_building_is_first(one, two, h_1, h_2, aligned, lot, system):
    """Nor for less where a peak grows, or where less is known to be favourable."""
    storeys = round(1 + h_1 / 4), round(1 + h_2 / 4)
    here = {
        "storeys_1": storeys[0],
        "storeys_2": storeys[1],
        "importance_1": 1.2,
        "design_pga": 2.0,
    }
    there = {
        "storeys_1": storeys[1],
        "storeys_2": storeys[0],
        "importance_2": 1.2,
        "design_pga": 2.0,
    }
    facts = "III", lot, system
    for name in rules.code_rule_names():
        rule = rules.code_rule(name)
        gap = float(rule.gap(one, two, h_1, h_2, aligned, *facts, **here))
        mirrored = float(rule.gap(two, one, h_2, h_1, aligned, *facts, **there))
        assert gap == pytest.approx(mirrored, rel=1e-14), name
        assert float(rule.gap(1.5 * one, two, h_1, h_2, aligned, *facts, **here)) >= gap, name
        for safer in (
            (False, *facts),
            (aligned, "III", False, system),
            (aligned, "III", lot, False),
        ):
            assert float(rule.gap(one, two, h_1, h_2, *safer, **here)) >= gap * (1 - 1e-14), name
