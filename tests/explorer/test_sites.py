"""Scenes whose ground is sought: fitted to a code's spectrum, or as strong as motions are to be."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest

import stochlin as sl
from stochlin.analyses.explorer.case_text import case_text
from stochlin.analyses.explorer.formulas import gap_rules, recorded, spectra
from stochlin.analyses.explorer.scene import Scene, scene_of
from stochlin.analyses.explorer.simulations import merge_tables
from stochlin.analyses.explorer.sites import PGA, SA
from stochlin.views.explorer import pictures, words
from stochlin.views.explorer.controls import NUMBERS, counts

pytestmark = pytest.mark.invariant

G = 9.80665
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\nfilters = 1\n'


def case_of(site, folder, path="case.toml"):
    text = sl.example_case()
    start, end = text.index("[site]"), text.index("[motion]")
    (folder / path).write_text(f"{text[:start]}[site]\n{site}\n{text[end:]}", encoding="utf-8")
    return sl.read_case(folder / path)


def delivered(scene, periods=(1.0,), **options):
    motion = scene.duration, scene.motion_envelope()
    return sl.simulated_spectrum(scene.ground(), list(periods), *motion, paths=1024, **options)


def test_a_ground_that_is_not_known_yet_is_told_and_sought():
    scene = Scene(site="firm", measure=PGA, pga=0.3 * G)
    assert not scene.settled
    with pytest.raises(ValueError, match="not known yet"):
        scene.ground()
    settled = scene.settle()
    assert settled.settled
    found = delivered(settled).peak_ground_acceleration
    assert float(found) == pytest.approx(0.3 * G, rel=1e-9)  # of the very motions
    stronger = dataclasses.replace(settled, pga=0.6 * G)
    assert stronger.settled  # no simulation for another strength
    assert stronger.ground().intensity == pytest.approx(4 * settled.ground().intensity)
    assert not dataclasses.replace(settled, duration=30.0).settled
    assert not dataclasses.replace(settled, measure=SA).settled
    assert pickle.loads(pickle.dumps(settled)) == settled  # from the process beside the page


def test_a_spectral_acceleration_is_met_at_its_period():
    scene = Scene(site="soft", measure=SA, sa=0.8 * G, sa_period=0.5).settle()
    assert delivered(scene, [0.5]).pseudo_acceleration.item() == pytest.approx(0.8 * G, rel=1e-9)
    assert not dataclasses.replace(scene, sa_period=0.6).settled
    assert dataclasses.replace(scene, measure="intensity S0").ground().intensity == scene.intensity


def test_white_noise_has_no_peak():
    scene = Scene(site="white_noise", measure=PGA)
    with pytest.raises(ValueError, match="white noise has no peak acceleration"):
        scene.settle()
    assert dataclasses.replace(scene, measure=SA).settle().settled


def test_a_code_in_a_file_is_held_with_its_fit_and_another_soil_is_fitted_anew(tmp_path):
    case = case_of(CODE, tmp_path)
    scene, notes = scene_of(case)
    assert not any("spectrum" in note for note in notes)
    assert (scene.site, scene.soil, scene.settled) == ("eurocode_8", "C", True)
    assert scene.ground() == case.ground
    half = dataclasses.replace(scene, ag=0.125 * G)
    assert half.ground().intensity == pytest.approx(case.ground.intensity / 4)
    assert float(gap_rules(half).gap[0]) < float(gap_rules(scene).gap[0])
    assert spectra(half).psd_ground.shape == spectra(scene).psd_ground.shape
    other = dataclasses.replace(scene, soil="B", ag=3.0)
    assert not other.settled
    other = other.settle()
    target = sl.eurocode_8(3.0, "B")
    table = sl.simulated_spectrum(other.ground(), target, other.duration, other.motion_envelope())
    assert float(abs(table.ratio.sel(period=slice(0.1, 4.0)) - 1).max()) < 0.06
    (tmp_path / "saved.toml").write_text(case_text(other), encoding="utf-8")
    saved = sl.read_case(tmp_path / "saved.toml")
    assert "filters = 2" in case_text(other)
    frequency = np.array([2.0, 8.0, 30.0])
    np.testing.assert_allclose(saved.ground.psd(frequency), other.ground().psd(frequency), rtol=1e-4)


def test_asce_7_is_held_and_scaled_as_one(tmp_path):
    site = 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\nfilters = 1\n'
    scene, _ = scene_of(case_of(site, tmp_path))
    assert (scene.site, scene.sds, scene.sd1, scene.tl) == ("asce_7", G, 0.6 * G, 8.0)
    twice = dataclasses.replace(scene, sds=2 * G, sd1=1.2 * G)
    assert twice.ground().intensity == pytest.approx(4 * scene.ground().intensity)
    assert not dataclasses.replace(scene, sd1=0.5 * G).settled
    assert all(line in case_text(twice) for line in ('tl = "8.0 s"', f'sds = "{2 * G!r} m/s^2"'))


def test_another_damping_is_held_by_the_parameters_of_its_ground(tmp_path):
    case = case_of(f"{CODE}damping = 0.1\n", tmp_path)
    scene, notes = scene_of(case)
    assert scene.site == "clough_penzien"
    assert scene.ground() == case.ground
    assert any("have the spectrum eurocode_8" in note for note in notes)


RECORDED = '[[site.records]]\npath = "{name}.at2"\nname = "{name}"\n'


@pytest.fixture
def recorded_case(tmp_path):
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=3)
    for name, motion in zip("abc", motions, strict=True):
        sl.to_at2(motion, tmp_path / f"{name}.at2")
    records = "".join(RECORDED.format(name=name) for name in "abc")
    return case_of(f'ground = "firm"\nintensity = "0.01 m^2/s^3"\n{records}', tmp_path)


def test_records_of_a_file_stand_beside_the_gaps_by_rule(recorded_case):
    scene, notes = scene_of(recorded_case)
    told = "The gaps of the records are shown beside those of the rules; "
    assert f"{told}a case file saved here contains no records." in notes
    table = recorded(scene)
    one, other = (structure_in_metres(scene, number) for number in (1, 2))
    expected = sl.recorded_gap(one, other, dict(recorded_case.records))
    np.testing.assert_array_equal(table.separation, expected.separation)
    rules = gap_rules(scene)
    figure = pictures.gaps_figure(rules, table)
    shown = next(curve for curve in figure["data"] if curve["name"] == "records")
    np.testing.assert_allclose(shown["x"], 100 * expected.separation.values)
    assert shown["text"] == ["a", "b", "c"]
    assert len(figure["data"]) == len(pictures.gaps_figure(rules)["data"]) + 1
    most = float(expected.separation.max())
    wide = dataclasses.replace(scene, gap=1.01 * most)
    assert "enough in 3 of 3" in words.records(recorded(wide))
    narrow = words.records(recorded(dataclasses.replace(scene, gap=1e-4)))
    assert "enough in 0 of 3" in narrow
    assert f"{100 * most:.1f}" in narrow
    assert words.records(None) == ""


def structure_in_metres(scene, number):
    structure = scene.structure(number)
    found = sl.linearize(structure, scene.ground()).yield_displacement.item()
    return dataclasses.replace(structure, reduction_factor=None, yield_displacement=found)


def test_scenes_know_records_by_their_file(recorded_case):
    scene, _ = scene_of(recorded_case)
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene
    assert hash(again) == hash(scene)
    np.testing.assert_array_equal(recorded(again).separation, recorded(scene).separation)
    data = merge_tables(scene, {"gaps": gap_rules(scene), "records": recorded(scene)})
    assert data.records_separation.dims == ("records_record",)
    with pytest.raises(ValueError, match="the scene has no record"):
        recorded(dataclasses.replace(scene, records=None))


@pytest.mark.parametrize(
    ("changed", "shown"),
    [
        ({}, {"intensity", "measure"}),
        ({"measure": PGA}, {"pga", "measure"}),
        ({"measure": SA}, {"sa", "sa_period", "measure"}),
        ({"site": "eurocode_8", "measure": PGA}, {"ag", "soil", "spectrum_type"}),
        ({"site": "asce_7"}, {"sds", "sd1", "tl"}),
    ],
)
def test_controls_of_the_strength_are_those_that_have_a_say(changed, shown):
    values = vars(Scene()) | changed
    names = {"ag", "soil", "spectrum_type", "sds", "sd1", "tl", "intensity", "pga", "sa", "sa_period"}
    assert {name for name in {*names, "measure"} if counts(name, values)} == shown
    assert not counts("ground_period", values)


def test_accelerations_are_entered_in_g():
    scene = Scene(ag=0.25 * G)
    assert NUMBERS["ag"].text(scene) == "0.25"
    assert NUMBERS["ag"].read("0.5") == pytest.approx(0.5 * G)
