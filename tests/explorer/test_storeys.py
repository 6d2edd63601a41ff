"""Scenes whose buildings have storeys: round trips, agreement with the verbs, what is refused."""

from __future__ import annotations

import dataclasses
import json

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.explorer.buildings import OF_FILE, OSCILLATOR, REGULAR
from stochlin.analyses.explorer.case_scene import scene_of
from stochlin.analyses.explorer.case_text import case_text
from stochlin.analyses.explorer.formulas import correlation, gap_rules, probability, spectra
from stochlin.analyses.explorer.scene import Scene
from stochlin.analyses.explorer.simulations import few_motions, merge_tables, simulations, with_motions
from stochlin.analyses.tables.storage import as_netcdf
from stochlin.views.explorer import pictures as charts
from stochlin.views.explorer import words
from stochlin.views.explorer.controls import GROUPS, counts

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
REGULARS = Scene(
    **{f"description_{n}": REGULAR for n in (1, 2)},
    **{f"storey_height_{n}": 3.0 for n in (1, 2)},
    storey_count_1=4,
    storey_count_2=3,
    period_1=0.6,
    period_2=0.45,
    paths=128,
)


def read(folder, *buildings, **replaced):
    text = "".join((HEAD, *buildings, TAIL))
    for old, new in replaced.values():
        text = text.replace(old, new)
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    case = sl.read_case(path)
    return case, *scene_of(case)


def same(one, other):
    """Of structures."""
    assert type(one) is type(other)
    assert (getattr(one, "law", ""), getattr(one, "p_delta", "")) == (
        getattr(other, "law", ""),
        getattr(other, "p_delta", ""),
    )
    ours, theirs = one.arrays(), other.arrays()
    assert ours.keys() == theirs.keys()
    for name, array in ours.items():
        np.testing.assert_array_equal(array, theirs[name], err_msg=name)


@pytest.mark.parametrize("other", [ANNEX, SHOP.replace('mass = "900 t"\n', ""), WEN])
@pytest.mark.parametrize("elastic", [False, True])
def test_a_scene_holds_the_buildings_of_its_file_and_writes_them(other, elastic, tmp_path):
    one = OFFICE
    if elastic:
        one = one.replace("base_shear_coefficient = 0.15", "elastic = true")
    case, scene, notes = read(tmp_path, one, other)
    assert not notes
    assert scene.description_1 == REGULAR
    for held, building in zip(scene.structures(), case.buildings, strict=True):
        same(held, building.structure)
    (tmp_path / "again.toml").write_text(case_text(scene), encoding="utf-8")
    again, notes = scene_of(sl.read_case(tmp_path / "again.toml"))
    assert not notes
    for held, building in zip(again.structures(), case.buildings, strict=True):
        same(held, building.structure)
    assert case_text(again) == case_text(scene)
    assert again == dataclasses.replace(scene, envelope=again.envelope, case_file=again.case_file)


def test_what_changes_the_storeys_of_a_file(tmp_path):
    _, scene, _ = read(tmp_path, OFFICE, ANNEX)
    before = scene.structure(2)
    moved = dataclasses.replace(scene, period_2=2 * scene.period_2, strength_factor_2=1.5, damping_2=0.1)
    after = moved.structure(2)
    np.testing.assert_allclose(after.stiffnesses, before.stiffnesses / 4, rtol=1e-12)
    shears = [b.stiffnesses * b.yield_drifts for b in (before, after)]
    np.testing.assert_allclose(shears[1], 1.5 * shears[0], rtol=1e-12)
    free = dataclasses.replace(after, p_delta=False)
    assert float(free.periods()[0]) == pytest.approx(moved.period_2, rel=1e-12)
    assert after.damping == 0.1
    for name in ("masses", "heights", "dampers"):
        np.testing.assert_array_equal(getattr(after, name), getattr(before, name))
    assert not dataclasses.replace(scene, yields_2=False).structure(2).yields


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('storey_height = "3.2 m"\n', 'heights = ["4 m", "3 m", "3 m", "3 m"]\n'),
        ("= 0.15\n", '= 0.15\ndampers = "1 MN s/m"\n'),
        ("= 0.15\n", '= 0.15\nlaw = "bouc_wen"\nbeta = 0.6\n'),
        ("= 0.15\n", "= 0.15\np_delta = true\n"),
    ],
)
def test_a_regular_building_with_more_is_held_storey_by_storey(old, new, tmp_path):
    case, scene, _ = read(
        tmp_path, OFFICE.replace("storeys = 4\n" * ("heights" in new), ""), SHOP, one=(old, new)
    )
    assert scene.description_1 == OF_FILE
    same(scene.structure(1), case.first.structure)
    assert scene.storey_count_1 == 4  # to start from, if it is made regular


@pytest.mark.filterwarnings("ignore::UserWarning")  # a doubtful coefficient
def test_a_building_stronger_than_the_slider_is_held_storey_by_storey(tmp_path):
    case, scene, _ = read(tmp_path, OFFICE, SHOP, one=("coefficient = 0.15", "coefficient = 1.2"))
    assert scene.description_1 == OF_FILE
    same(scene.structure(1), case.first.structure)


def test_contact_and_masses_of_a_mixed_case_are_kept(tmp_path):
    contact = '[contact]\nmodel = "kelvin"\nstiffness = "2000 MN/m"\nrestitution = 0.65\n'
    for other in (SHOP, ANNEX):
        case, scene, notes = read(
            tmp_path, OFFICE, other, one=("[simulation]", f"{contact}[simulation]")
        )
        assert not notes
        (tmp_path / "again.toml").write_text(case_text(scene), encoding="utf-8")
        again = sl.read_case(tmp_path / "again.toml")
        assert again.contact == case.contact
        assert again.second.structure.mass == 9e5 if other is SHOP else again.second.weighed


def test_too_many_storeys_are_told(tmp_path):
    with pytest.raises(ValueError, match=r"case\.toml: Office has 61 storeys; allowed in the explorer"):
        read(tmp_path, OFFICE, SHOP, one=("storeys = 4", "storeys = 61"))


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"storey_count_1": 61}, "storey_count_1 = 61; allowed: a whole number from 1 to 60"),
        ({"storey_count_2": 2.5}, "storey_count_2 = 2.5; allowed: a whole number"),
        ({"storey_height_1": 0.2}, "storey_height_1 = 0.2 is out of range; allowed: 1 <= value <= 20"),
        ({"base_shear_coefficient_1": 1.5}, r"allowed: 0 < value <= 1, finite \(a share of the w"),
        ({"strength_factor_2": 0}, "strength_factor_2 = 0"),
        (
            {"description_1": "tower"},
            "description_1 = 'tower' is not known; allowed: oscillator, regular",
        ),
        ({"description_1": OF_FILE}, "allowed: oscillator, regular storeys$"),
    ],
)
def test_bad_storeys_are_refused_and_say_what_is_allowed(changed, message):
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(Scene(), **changed)


def test_controls_are_those_of_the_description(tmp_path):
    def shown(scene):
        values = dataclasses.asdict(scene)
        names = [control.name for group in GROUPS for control in group.controls]
        return {name for name in names if name.endswith("_1") and counts(name, values)}

    common = {f"{name}_1" for name in ("description", "period", "damping", "yields", "hardening")}
    assert shown(Scene()) == common | {"strength_by_1", "reduction_factor_1"}
    regular = {"storey_count_1", "storey_height_1", "base_shear_coefficient_1"}
    assert shown(REGULARS) == common | regular
    whole = dataclasses.replace(REGULARS, yields_1=False)
    assert shown(whole) == common - {"hardening_1"} | regular - {"base_shear_coefficient_1"}
    one, two = ANNEX.replace("building_2", "building_1"), SHOP
    _, scene, _ = read(tmp_path, one, two)
    assert shown(scene) == common | {"strength_factor_1"}
    drifts = 'yield_drifts = ["1 cm", "9 mm", "8 mm"]'
    _, scene, _ = read(tmp_path, one, two, one=(drifts, "elastic = true"))
    assert shown(scene) == common - {"hardening_1", "yields_1"}  # the file says no strength
    (choice,) = (c for g in GROUPS for c in g.controls if c.name == "description_1")
    assert choice.offered(scene) == (OSCILLATOR, REGULAR, OF_FILE)
    assert choice.offered(Scene()) == (OSCILLATOR, REGULAR)


@pytest.fixture(scope="module")
def linearized():
    return sl.linearize_system(REGULARS.structures(), REGULARS.ground())


def test_spectra_hold_the_variance_at_the_lower_roof():
    """But for less than 2 % of it, beyond the periods that are shown."""
    elastic = dataclasses.replace(REGULARS, yields_1=False, yields_2=False)
    table = spectra(elastic)
    known = sl.linearize_system(elastic.structures(), elastic.ground())
    assert table.attrs["height_m"] == 9
    for number, floor in ((1, "1.3"), (2, "2.3")):
        variance = 2 * np.trapezoid(table[f"displacement_psd_{number}"], table.frequency)
        sigma = float(known.displacement_std.sel(floor=floor))
        assert variance == pytest.approx(sigma**2, rel=0.02)


def test_correlation_is_that_of_linearize_system(linearized):
    shares: list[float] = []
    table = correlation(REGULARS, shares.append)
    assert shares[-1] == 1
    own = table.sel(period_ratio=REGULARS.period_2 / REGULARS.period_1)
    rho = float(linearized.rho.sel(floor="1.3", floor_2="2.3"))
    assert float(own.rho_linearized) == pytest.approx(rho, rel=1e-8)
    assert float(own.rho_white_noise) == float(sl.rho_white_noise(0.6, 0.45, 0.05, 0.05).rho)
    assert "rho_drift" not in table
    other = table.isel(period_ratio=3)
    pair = REGULARS.structure(1), REGULARS.structure(2, 0.6 * float(other.period_ratio))
    rho = float(sl.correlate(*pair, REGULARS.ground()).rho.sel(floor="1.3", floor_2="2.3"))
    assert float(other.rho_linearized) == pytest.approx(rho, rel=1e-8)


def test_what_progress_raises_stops_a_correlation():
    class Enough(Exception):  # noqa: N818
        pass

    def stop(share: float) -> None:
        raise Enough

    with pytest.raises(Enough):
        correlation(REGULARS, stop)


@pytest.fixture(scope="module")
def simulated():
    shares: list[float] = []
    tables = simulations(REGULARS, shares.append)
    assert shares == sorted(shares)
    return tables


def test_rules_by_linearization_are_those_of_separation(simulated):
    own, theirs = gap_rules(REGULARS), simulated["gaps"]
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
    chances = few_motions(REGULARS)
    assert "confidence_of_no_pounding" not in chances
    np.testing.assert_array_equal(
        simulated["probability"].confidence_of_no_pounding_simulated,
        chances.confidence_of_no_pounding_simulated,
    )
    assert chances.attrs["paths"] == 128


@pytest.mark.slow
def test_few_motions_follow_a_slider():
    assert few_motions(dataclasses.replace(REGULARS, paths=1024)).attrs["paths"] == 512


def test_all_that_is_shown_of_storeys_becomes_one_file(simulated, tmp_path):
    tables = {"spectra": spectra(REGULARS), "correlation": correlation(REGULARS), **simulated}
    whole = merge_tables(REGULARS, tables)
    path = tmp_path / "explored.nc"
    path.write_bytes(as_netcdf(whole))
    with xr.open_dataset(path, engine="scipy") as read_again:
        for number, structure in enumerate(REGULARS.structures(), start=1):
            for name in ("masses", "stiffnesses", "heights", "yield_drifts"):
                held = read_again[f"building_{number}_{name}"]
                np.testing.assert_array_equal(held, getattr(structure, name))
        np.testing.assert_array_equal(read_again.gaps_gap_at_height, simulated["gaps"].gap_at_height)
    numbers = [v for v in whole.data_vars.values() if v.dtype.kind == "f"]
    assert all("units" in array.attrs and "long_name" in array.attrs for array in numbers)


@pytest.mark.parametrize(
    "changed",
    [
        {},
        *(
            pytest.param(one, marks=pytest.mark.slow)
            for one in ({"description_2": OSCILLATOR}, {"yields_1": False})
        ),
    ],
)
def test_figures_and_words_of_storeys(changed):
    scene = dataclasses.replace(REGULARS, **changed)
    gaps = gap_rules(scene)
    figure = charts.gaps_figure(gaps)
    (far,) = (note for note in figure["layout"]["annotations"] if note["y"] == "ASCE 41")
    gap = 100 * float(gaps.gap.sel(rule="asce_41"))  # 0.04 of the height, far beyond the others
    assert far["text"].startswith(f"{gap:.0f} cm")
    assert figure["layout"]["xaxis"]["range"][1] < gap
    by_height = [curve for curve in figure["data"] if curve.get("yaxis") == "y2"]
    assert len(by_height) == ("description_2" not in changed)  # an oscillator meets the roof alone
    if by_height:
        assert by_height[0]["y"] == [3, 6, 9]
        assert "It is needed at 9" in words.gaps(gaps)
    assert "too small where storeys yield" in words.gaps(gaps)
    table = correlation(scene)
    assert "9\N{NO-BREAK SPACE}m up" in words.correlation(table).replace("12", "9")
    formula, motions = probability(scene), few_motions(scene)
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
        charts.spectra_figure(spectra(scene), (scene.period_1, scene.period_2)),
        charts.correlation_figure(table),
        charts.probability_figure(chances),
    ):
        json.dumps(drawn, allow_nan=False)
    assert "no map of its bias for storeys" in words.caution_of_storeys(scene)[0]


def test_buildings_that_move_as_one_have_no_gap_by_height():
    table = gap_rules(dataclasses.replace(REGULARS, storey_count_2=4, period_2=REGULARS.period_1))
    assert np.isnan(table.gap.sel(rule="linearization"))
    json.dumps(charts.gaps_figure(table), allow_nan=False)
    assert "It is needed at" not in words.gaps(table)


def test_storeys_that_stay_elastic_need_no_caution():
    elastic = dataclasses.replace(REGULARS, yields_1=False, yields_2=False)
    assert words.caution_of_storeys(elastic) == (words.ELASTIC, "")


def test_floors_that_are_not_level_are_told_and_codes_asked_so():
    common = {"floors_align": True, "same_property": True}
    scene = dataclasses.replace(REGULARS, storey_height_2=3.5, **common)
    assert [slab.level for slab in scene.slabs_on_columns] == pytest.approx([3, 3.5, 6, 7, 9, 10.5])
    assert not scene.for_codes()["floors_align"]
    assert "floors_align = false" in case_text(scene)
    assert dataclasses.replace(REGULARS, floors_align=True).for_codes()["floors_align"]
    apart, level = (
        float(gap_rules(one).gap.sel(rule="eurocode_8"))
        for one in (scene, dataclasses.replace(scene, storey_height_2=3.0))
    )
    assert level < 0.8 * apart  # Eurocode 8 asks for 0.7 of it


@pytest.mark.slow
def test_where_the_weight_leaves_nothing_stationary_only_simulations_answer(tmp_path):
    _, scene, _ = read(tmp_path, OFFICE, ANNEX, one=("hardening = 0.1", "hardening = 0.0005"))
    for formula in (spectra, gap_rules, correlation):
        with pytest.raises(
            ValueError, match="structures, number 2: the weight above takes all post-yield"
        ):
            formula(scene)
    assert float(few_motions(scene).confidence_of_no_pounding_simulated[-1]) >= 0
    assert set(simulations(scene)) == {"gaps", "probability"}
