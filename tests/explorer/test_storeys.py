"""Forms whose buildings have storeys: round trips, agreement with the verbs, what is refused."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.cases.files.schema import OSCILLATOR, REGULAR
from stochlin.analyses.explorer.form import OF_FILE, choices, groups, numbers
from stochlin.analyses.explorer.formulas import correlation, gap_rules, probability, spectra
from stochlin.analyses.explorer.opening import first_form, opened
from stochlin.analyses.explorer.pair import elastic_periods, for_codes, ratio_of, structures_of
from stochlin.analyses.explorer.saving import case_text, left_out
from stochlin.analyses.explorer.simulations import few_motions, merge_tables, simulations, with_motions
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import read_entry

pytestmark = pytest.mark.invariant

HEAD = """
[site]
ground = "firm"
intensity = "0.012 m^2/s^3"
[motion]
duration = "20 s"
envelope = "none"
"""
TAIL = """
[separation]
confidence = 0.9
existing = "8 cm"
[simulation]
paths = 128
"""
OFFICE = """
[building_1]
name = "Office"
period = "0.6 s"
storeys = 4
storey_height = "3.2 m"
floor_mass = "400 t"
damping = 0.05
hardening = 0.05
base_shear_coefficient = 0.15
"""
ANNEX = """
[building_2]
name = "Annex"
masses = ["300 t", "250 t", "200 t"]
stiffnesses = ["200 MN/m", "180 MN/m", "120 MN/m"]
heights = ["4 m", "3 m", "3.5 m"]
damping = 0.04
hardening = 0.1
yield_drifts = ["1 cm", "9 mm", "8 mm"]
dampers = ["0 N s/m", "100 kN s/m", "0 N s/m"]
p_delta = true
"""
SHOP = """
[building_2]
name = "Shop"
period = "0.4 s"
damping = 0.05
hardening = 0.1
reduction_factor = 3
height = "9 m"
storeys = 3
mass = "900 t"
"""
WEN = ANNEX.replace(
    "p_delta", 'law = "bouc_wen"\nbeta = 0.6\ngamma = [0.4, 0.3, 0.4]\nexponent = 2\np_delta'
)
RAYLEIGH = ANNEX + "damping_modes = [1, 2]\n"


def changed(form, **values):
    """The form with other values of controls of the buildings, named as in ``period_2``."""
    return form.changed({(f"building_{name[-1]}", name[:-2]): each for name, each in values.items()})


REGULARS = changed(
    first_form().changed({("simulation", "paths"): 128}),
    **{f"described_{n}": REGULAR for n in (1, 2)},
    storeys_1=4,
    storeys_2=3,
    period_1=0.6,
    period_2=0.45,
)
CASE = REGULARS.case()
ELASTIC = {"yields_1": False, "yields_2": False}


def regulars(**values):
    return changed(REGULARS, **values).case()


def read(folder, *buildings, replaced=("", "")):
    case = read_text("".join((HEAD, *buildings, TAIL)).replace(*replaced), folder)
    return case, *opened(case)


def read_text(text, folder):
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return sl.read_case(folder / "case.toml")


def assert_same(structures, others):
    for structure, other in zip(structures, others, strict=True):
        assert type(structure) is type(other)
        for name in ("law", "p_delta", "damping_modes"):
            assert getattr(structure, name, "") == getattr(other, name, "")
        ours, theirs = structure.arrays(), other.arrays()
        assert ours.keys() == theirs.keys()
        for name, array in ours.items():
            np.testing.assert_array_equal(array, theirs[name], err_msg=name)


@pytest.mark.parametrize("other", [ANNEX, SHOP.replace('mass = "900 t"\n', ""), WEN, RAYLEIGH])
@pytest.mark.parametrize("elastic", [False, True])
def test_a_form_holds_the_buildings_of_its_file_and_writes_them(other, elastic, tmp_path):
    office = OFFICE.replace("base_shear_coefficient = 0.15", "elastic = true") if elastic else OFFICE
    case, form, notes = read(tmp_path, office, other)
    assert not notes
    assert form["building_1", "described"] == REGULAR
    assert_same(structures_of(form.case()), structures_of(case))
    again, notes = opened(read_text(case_text(form.case()), tmp_path))
    assert not notes
    assert_same(structures_of(again.case()), structures_of(case))
    assert case_text(again.case()) == case_text(form.case())
    assert again == dataclasses.replace(form, file=again.file)


def test_what_changes_the_storeys_of_a_file(tmp_path):
    _, form, _ = read(tmp_path, OFFICE, ANNEX)
    period = 2 * form["building_2", "period"]
    moved = changed(form, period_2=period, strength_factor_2=1.5, damping_2=0.1)
    before, after = (structures_of(each.case())[1] for each in (form, moved))
    np.testing.assert_allclose(after.stiffnesses, np.divide(before.stiffnesses, 4), rtol=1e-12)
    shears = [np.multiply(b.stiffnesses, b.yield_drifts) for b in (before, after)]
    np.testing.assert_allclose(shears[1], 1.5 * shears[0], rtol=1e-12)
    free = dataclasses.replace(after, p_delta=False)
    assert float(free.periods()[0]) == pytest.approx(period, rel=1e-12)
    assert after.damping == 0.1
    for name in ("masses", "heights", "dampers"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
    assert not structures_of(changed(form, yields_2=False).case())[1].yields


@pytest.mark.parametrize(
    "replaced",
    [
        ('storey_height = "3.2 m"\n', 'heights = ["4 m", "3 m", "3 m", "3 m"]\n'),
        ("= 0.15\n", '= 0.15\ndampers = "1 MN s/m"\n'),
        ("= 0.15\n", '= 0.15\nlaw = "bouc_wen"\nbeta = 0.6\n'),
        ("= 0.15\n", "= 0.15\np_delta = true\n"),
        pytest.param(  # stronger than the slider, and doubtful
            ("= 0.15\n", "= 1.2\n"), marks=pytest.mark.filterwarnings("ignore::UserWarning")
        ),
    ],
)
def test_a_regular_building_with_more_is_held_storey_by_storey(replaced, tmp_path):
    office = OFFICE.replace("storeys = 4\n", "") if "heights" in replaced[1] else OFFICE
    case, form, _ = read(tmp_path, office, SHOP, replaced=replaced)
    assert form["building_1", "described"] == OF_FILE
    assert_same(structures_of(form.case())[:1], [case.first.structure])
    assert form["building_1", "storeys"] == 4  # to start from, if it is made regular


def test_contact_and_masses_of_a_mixed_case_are_kept(tmp_path):
    contact = '[contact]\nmodel = "kelvin"\nstiffness = "2000 MN/m"\nrestitution = 0.65\n'
    for other in (SHOP, ANNEX):
        replaced = "[simulation]", f"{contact}[simulation]"
        case, form, notes = read(tmp_path, OFFICE, other, replaced=replaced)
        assert not notes
        again = read_text(case_text(form.case()), tmp_path)
        assert again.contact == case.contact
        assert again.second.structure.mass == 9e5 if other is SHOP else again.second.weighed


def test_too_many_storeys_are_told(tmp_path):
    with pytest.raises(ValueError, match=r"case\.toml: Office has 61 storeys; allowed in the explorer"):
        read(tmp_path, OFFICE, SHOP, replaced=("storeys = 4", "storeys = 61"))


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("storeys", "61", "= 61 is out of range; allowed: a whole number from 1 to 60"),
        ("storeys", "2.5", "= 2.5 is no whole number; allowed: a whole number"),
        ("storey_height", "0.2", "= 0.2 is out of range; allowed: 1 <= value <= 20"),
        ("base_shear_coefficient", "1.5", r"allowed: 0 < value <= 1, finite \(a share of the w"),
        ("strength_factor", "0", "= 0 is out of range"),
    ],
)
def test_bad_storeys_are_refused_and_say_what_is_allowed(key, text, message):
    entries = [number for number in numbers() if number.place[1] == key]
    assert len(entries) == 2
    for number in entries:
        with pytest.raises(ValueError, match=message):
            read_entry(number, text)


def test_controls_are_those_of_the_description(tmp_path):
    def shown(form):
        places = (control.place for group in groups() for control in group.controls)
        return {key for name, key in places if name == "building_1" and form.uses((name, key))}

    common = {"described", "period", "damping", "yields", "hardening"}
    assert shown(first_form()) == common | {"strength", "reduction_factor"}
    regular = {"storeys", "storey_height", "base_shear_coefficient"}
    assert shown(REGULARS) == common | regular
    whole = changed(REGULARS, yields_1=False)
    assert shown(whole) == common - {"hardening"} | regular - {"base_shear_coefficient"}
    annex = ANNEX.replace("building_2", "building_1")
    _, form, _ = read(tmp_path, annex, SHOP)
    assert shown(form) == common | {"strength_factor"}
    drifts = 'yield_drifts = ["1 cm", "9 mm", "8 mm"]'
    _, form, _ = read(tmp_path, annex, SHOP, replaced=(drifts, "elastic = true"))
    assert shown(form) == common - {"hardening", "yields"}  # the file says no strength
    (choice,) = (choice for choice in choices() if choice.place == ("building_1", "described"))
    assert form.options(choice) == (OSCILLATOR, REGULAR, OF_FILE)
    assert first_form().options(choice) == (OSCILLATOR, REGULAR)


@pytest.fixture(scope="module")
def linearized():
    return sl.linearize_system(structures_of(CASE), CASE.ground)


def test_spectra_hold_the_variance_at_the_lower_roof():
    """But for less than 2 % of it, beyond the periods that are shown."""
    elastic = regulars(**ELASTIC)
    table = spectra(elastic)
    known = sl.linearize_system(structures_of(elastic), elastic.ground)
    assert table.attrs["height_m"] == 9
    for number, floor in ((1, "1.3"), (2, "2.3")):
        variance = 2 * np.trapezoid(table[f"displacement_psd_{number}"], table.frequency)
        sigma = float(known.displacement_std.sel(floor=floor))
        assert variance == pytest.approx(sigma**2, rel=0.02)


def test_correlation_is_that_of_linearize_system(linearized):
    shares: list[float] = []
    table = correlation(CASE, shares.append)
    assert shares[-1] == 1
    assert ratio_of(CASE) == pytest.approx(0.45 / 0.6, rel=1e-12)  # of the periods of the first modes
    own = table.sel(period_ratio=ratio_of(CASE))
    rho = float(linearized.rho.sel(floor="1.3", floor_2="2.3"))
    assert float(own.rho_linearized) == pytest.approx(rho, rel=1e-8)
    rho = float(sl.rho_white_noise(0.6, 0.45, 0.05, 0.05).rho)
    assert float(own.rho_white_noise) == pytest.approx(rho, rel=1e-12)
    assert "rho_drift" not in table
    other = table.isel(period_ratio=3)
    pair = structures_of(regulars(period_2=0.6 * float(other.period_ratio)))
    rho = float(sl.correlate(*pair, CASE.ground).rho.sel(floor="1.3", floor_2="2.3"))
    assert float(other.rho_linearized) == pytest.approx(rho, rel=1e-8)


def test_what_progress_raises_stops_a_correlation():
    class Enough(Exception):  # noqa: N818
        pass

    def stop(share: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        correlation(CASE, stop)


@pytest.fixture(scope="module")
def simulated():
    shares: list[float] = []
    tables = simulations(CASE, shares.append)
    assert shares == sorted(shares)
    return tables


def test_rules_by_linearization_are_those_of_separation(simulated):
    own, theirs = gap_rules(CASE), simulated["gaps"]
    rule = {"rule": "linearization"}
    for name in ("gap", "gap_at_height", "governing_height"):
        np.testing.assert_allclose(own[name].sel(rule), theirs[name].sel(rule), rtol=1e-9)
    assert float(own.rho.sel(rule="eq_3_linearized")) == pytest.approx(
        float(theirs.rho.sel(rule="eq_3_linearized")), rel=1e-8
    )
    assert "eq_3_drift" not in own.rule
    np.testing.assert_allclose(own.height, [3, 6, 9])


def test_simulations_of_storeys_answer_the_same_questions(simulated):
    assert list(simulated["correlation"].period_ratio) == [pytest.approx(0.75)]
    error = float(simulated["correlation"].rho_standard_error[0])
    assert 0 < error < 0.1
    rho = float(simulated["gaps"].rho.sel(rule="eq_3_simulated"))
    assert float(simulated["correlation"].rho[0]) == pytest.approx(rho, abs=4 * error)
    chances = few_motions(CASE)
    assert "confidence_of_no_pounding" not in chances
    np.testing.assert_array_equal(
        simulated["probability"].confidence_of_no_pounding_simulated,
        chances.confidence_of_no_pounding_simulated,
    )
    assert chances.attrs["paths"] == 128


@pytest.mark.slow
def test_few_motions_follow_a_slider():
    case = REGULARS.changed({("simulation", "paths"): 1024}).case()
    assert few_motions(case).attrs["paths"] == 512


def test_all_that_is_shown_of_storeys_becomes_one_file(simulated, tmp_path):
    tables = {"spectra": spectra(CASE), "correlation": correlation(CASE), **simulated}
    whole = merge_tables(CASE, tables)
    path = tmp_path / "explored.nc"
    path.write_bytes(as_netcdf(whole))
    with xr.open_dataset(path, engine="scipy") as read_again:
        for number, structure in enumerate(structures_of(CASE), start=1):
            for name in ("masses", "stiffnesses", "heights", "yield_drifts"):
                held = read_again[f"building_{number}_{name}"]
                np.testing.assert_array_equal(held, getattr(structure, name))
        np.testing.assert_array_equal(read_again.gaps_gap_at_height, simulated["gaps"].gap_at_height)
    numbers = [v for v in whole.data_vars.values() if v.dtype.kind == "f"]
    assert all("units" in array.attrs and "long_name" in array.attrs for array in numbers)


@pytest.mark.slow
@pytest.mark.parametrize(
    "values",
    [
        {},
        pytest.param({"described_2": OSCILLATOR}, marks=pytest.mark.slow),
        pytest.param({"yields_1": False}, marks=pytest.mark.slow),
    ],
)
def test_figures_and_words_of_storeys(values):
    case = regulars(**values)
    gaps = gap_rules(case)
    figure = charts.gaps_figure(gaps)
    (far,) = (note for note in figure["layout"]["annotations"] if note["y"] == "ASCE 41")
    gap = 100 * float(gaps.gap.sel(rule="asce_41"))  # 0.04 of the height, far beyond the others
    assert far["text"].startswith(f"{gap:.0f} cm")
    assert figure["layout"]["xaxis"]["range"][1] < gap
    by_height = [curve for curve in figure["data"] if curve.get("yaxis") == "y2"]
    assert len(by_height) == ("described_2" not in values)  # an oscillator meets the roof alone
    if by_height:
        assert by_height[0]["y"] == [3, 6, 9]
        assert "It is needed at 9" in words.gaps(gaps)
    assert "too small where storeys yield" in words.gaps(gaps)
    table = correlation(case)
    assert "9\N{NO-BREAK SPACE}m up" in words.correlation(table).replace("12", "9")
    formula, motions = probability(case), few_motions(case)
    assert with_motions(None, motions) is motions
    assert "by formula" not in words.probability(motions)
    json.dumps(charts.probability_figure(motions), allow_nan=False)
    chances = with_motions(formula, motions)
    assert with_motions(formula, None) is formula
    said = words.probability(chances)
    assert "by formula" in said
    assert "simulated by 128 motions (" in said
    for drawn in (
        figure,
        charts.spectra_figure(spectra(case), elastic_periods(case)),
        charts.correlation_figure(table),
        charts.probability_figure(chances),
    ):
        json.dumps(drawn, allow_nan=False)
    assert "no map of its bias for storeys" in words.caution_of_storeys(case)[0]


def test_buildings_that_move_as_one_have_no_gap_by_height():
    table = gap_rules(regulars(storeys_2=4, period_2=0.6))
    assert np.isnan(table.gap.sel(rule="linearization"))
    json.dumps(charts.gaps_figure(table), allow_nan=False)
    assert "It is needed at" not in words.gaps(table)


def test_storeys_that_stay_elastic_need_no_caution():
    assert words.caution_of_storeys(regulars(**ELASTIC)) == (words.ELASTIC, "")


def test_floors_that_are_not_level_are_told_and_codes_asked_so(tmp_path):
    aligned = {"separation": {"floors_align": True, "same_property": True}}
    form = dataclasses.replace(REGULARS, file=aligned)
    apart, level = (changed(form, storey_height_2=height).case() for height in (3.5, 3.0))
    assert [slab.level for slab in apart.slabs_on_columns] == pytest.approx([3, 3.5, 6, 7, 9, 10.5])
    assert not for_codes(apart)["floors_align"]
    assert for_codes(level)["floors_align"]
    assert left_out(apart, aligned) == [
        "The saved file says floors_align = false, since floor 1 of Building 1, at 3 m, meets the "
        "columns in storey 1 of Building 2."
    ]
    assert not left_out(level, aligned)
    for case, align in ((apart, False), (level, True)):  # read again without a warning
        assert for_codes(read_text(case_text(case), tmp_path))["floors_align"] == align
    gaps = [float(gap_rules(case).gap.sel(rule="eurocode_8")) for case in (apart, level)]
    assert gaps[1] < 0.8 * gaps[0]  # Eurocode 8 asks for 0.7 of it


@pytest.mark.slow
def test_where_the_weight_leaves_nothing_stationary_only_simulations_answer(tmp_path):
    replaced = "hardening = 0.1", "hardening = 0.0005"
    _, form, _ = read(tmp_path, OFFICE, ANNEX, replaced=replaced)
    case = form.case()
    for formula in (spectra, gap_rules, correlation):
        with pytest.raises(
            ValueError, match="structures, number 2: storey 1 has no stiffness after yielding"
        ):
            formula(case)
    assert float(few_motions(case).confidence_of_no_pounding_simulated[-1]) >= 0
    assert set(simulations(case)) == {"gaps", "probability"}
