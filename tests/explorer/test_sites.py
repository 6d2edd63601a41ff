"""Scenes whose ground is sought: fitted to a code's spectrum, or as strong as motions are to be."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest
from cases import example_of_short_motion

import stochlin as sl
from stochlin.analyses.explorer.case_scene import open_case, scene_of
from stochlin.analyses.explorer.case_text import case_text, files_named
from stochlin.analyses.explorer.formulas import gap_rules, recorded, spectra
from stochlin.analyses.explorer.scene import Scene
from stochlin.analyses.explorer.simulations import merge_tables
from stochlin.analyses.explorer.sites import OF_FILE, PGA, S0, SA
from stochlin.views.explorer import pictures, words
from stochlin.views.explorer.controls import NUMBERS, counts

pytestmark = pytest.mark.invariant

G = 9.80665
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\nfilters = 1\n'


def case_of(site, folder, path="case.toml"):
    text = example_of_short_motion()
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
    assert dataclasses.replace(scene, measure=S0).ground().intensity == scene.intensity


def test_white_noise_has_no_peak():
    scene = Scene(site="white_noise", measure=PGA)
    with pytest.raises(ValueError, match="white noise has no peak acceleration"):
        scene.settle()
    assert dataclasses.replace(scene, measure=SA).settle().settled


@pytest.mark.slow
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


@pytest.mark.slow
def test_asce_7_is_held_and_scaled_as_one(tmp_path):
    site = 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\nfilters = 1\n'
    scene, _ = scene_of(case_of(site, tmp_path))
    assert (scene.site, scene.sds, scene.sd1, scene.tl) == ("asce_7", G, 0.6 * G, 8.0)
    twice = dataclasses.replace(scene, sds=2 * G, sd1=1.2 * G)
    assert twice.ground().intensity == pytest.approx(4 * scene.ground().intensity)
    assert not dataclasses.replace(scene, sd1=0.5 * G).settled
    assert all(line in case_text(twice) for line in ('tl = "8.0 s"', f'sds = "{2 * G!r} m/s^2"'))


@pytest.mark.slow
def test_another_damping_is_kept(tmp_path):
    case = case_of(f"{CODE}damping = 0.1\n", tmp_path)
    scene, _ = scene_of(case)
    assert (scene.site, scene.ground()) == ("eurocode_8", case.ground)
    assert "damping = 0.1" in case_text(scene)
    assert not dataclasses.replace(scene, spectrum_damping=0.05).settled


@pytest.mark.slow
def test_a_spectrum_of_a_file_has_its_own_scale(tmp_path):
    period = np.geomspace(0.05, 4.0, 60)
    values = sl.asce_7(G, 0.6 * G, 8.0).interp(period=period).values
    rows = [f"{t:.6g},{a:.9g}" for t, a in zip(period, values, strict=True)]
    (tmp_path / "site.csv").write_text("\n".join(["T,Sa", *rows]), encoding="utf-8")
    lines = 'spectrum = "site.csv"\nunits = "m/s^2"\nfilters = 1\n'
    case = case_of(f"{lines}scale = 0.5\n", tmp_path)
    np.testing.assert_allclose(
        case.spectrum, 0.5 * sl.read_spectrum(tmp_path / "site.csv", units="m/s^2")
    )
    scene, _ = scene_of(case)
    assert (scene.site, scene.spectrum_scale, scene.ground()) == (OF_FILE, 0.5, case.ground)
    assert scene.site in scene.sites()
    twice = dataclasses.replace(scene, spectrum_scale=1.0)
    assert twice.settled  # another scale needs no fit, another motion does
    assert twice.ground().intensity == pytest.approx(4 * case.ground.intensity)
    assert not dataclasses.replace(scene, duration=30.0).settled
    assert files_named(twice) == ["site.csv"]
    (tmp_path / "saved.toml").write_text(case_text(twice), encoding="utf-8")
    saved, frequency = sl.read_case(tmp_path / "saved.toml"), np.array([2.0, 8.0, 30.0])
    np.testing.assert_allclose(saved.ground.psd(frequency), twice.ground().psd(frequency), rtol=1e-4)
    assert pickle.loads(pickle.dumps(twice)) == twice
    by_peak, _ = scene_of(case_of(f'{lines}pga = "0.3 g"\n', tmp_path))
    found = delivered(by_peak).peak_ground_acceleration
    assert float(found) == pytest.approx(0.3 * G, rel=0.02)  # other motions than the file's
    assert 0 < by_peak.spectrum_scale != 1


def test_a_strength_by_a_peak_is_shown_as_the_file_gives_it(tmp_path):
    scene, notes = scene_of(case := case_of('ground = "firm"\npga = "0.3 g"\n', tmp_path))
    assert not notes
    assert (scene.measure, scene.pga, scene.settled) == (PGA, 0.3 * G, True)
    assert scene.ground().intensity == pytest.approx(case.ground.intensity, rel=1e-12)
    twice = dataclasses.replace(scene, pga=0.6 * G)
    assert twice.ground().intensity == pytest.approx(4 * case.ground.intensity, rel=1e-12)
    assert "# so that the mean peak ground acceleration of the motions is 0.6 g" in case_text(twice)


def test_records_suite_hazard_and_risk_of_a_file_stay_in_it(tmp_path):
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=3)
    for name, motion in zip("abc", motions, strict=True):
        sl.to_at2(motion, tmp_path / f"{name}.at2")
    (tmp_path / "suite.csv").write_text("file\nb.at2\nc.at2\n", encoding="utf-8")
    site = (
        'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'
        '[[site.records]]\npath = "a.at2"\nname = "One \\"quoted\\""\nscale = 1.5\n'
        '[site.suite]\npath = "suite.csv"\npga = "0.3 g"\n'
        '[site.hazard]\nmeasure = "pga"\nk0 = 1e-4\nk = 2\nunits = "g"\n'
    )
    case = case_of(site, tmp_path)
    scene, _ = scene_of(case)
    assert files_named(scene) == ["a.at2", "suite.csv"]
    (tmp_path / "saved.toml").write_text(case_text(scene), encoding="utf-8")
    saved = sl.read_case(tmp_path / "saved.toml")
    assert saved.hazard == case.hazard
    assert list(saved.records) == list(case.records) == ['One "quoted"', "b.at2", "c.at2"]
    for name, record in case.records.items():
        np.testing.assert_array_equal(saved.records[name], record)


def sent(folder, *names):
    return {name: (folder / name).read_bytes() for name in names}


def test_a_case_is_opened_with_the_files_that_it_names(tmp_path):
    (tmp_path / "records").mkdir()
    motion = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=2)[0]
    sl.to_at2(motion, tmp_path / "records" / "a.at2")
    site = 'ground = "firm"\nintensity = "0.01 m^2/s^3"\n[[site.records]]\npath = "records/a.at2"\n'
    case = case_of(site, tmp_path)
    files = sent(tmp_path, "case.toml") | sent(tmp_path / "records", "a.at2")
    scene, _ = open_case(files)
    np.testing.assert_array_equal(scene.records["a.at2"], case.records["a.at2"])
    assert scene.period_1 == case.first.period
    del files["a.at2"]
    with pytest.raises(
        ValueError, match=r"line \d+: site.records.path = .*choose the case file together"
    ) as told:
        open_case(files)
    assert "tmp" not in str(told.value)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({}, "0 case files are chosen; allowed: one"),
        ({"a.toml": b"", "b.toml": b""}, "2 case files are chosen"),
        ({"a.toml": b"\xff\xfe"}, "a.toml is no TOML file"),
        ({"a.toml": b"[site"}, "a.toml, line 1: '.site' is no TOML file's text"),
        ({"a.toml": b"x = 1\n"}, "a.toml, line 1: x = 1 is not a key that is known here"),
    ],
)
def test_what_is_no_case_is_refused_in_the_words_of_its_reader(files, message):
    with pytest.raises(ValueError, match=message):
        open_case(files)


RECORDED = '[[site.records]]\npath = "{name}.at2"\nname = "{name}"\n'


@pytest.fixture
def recorded_case(tmp_path):
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=3)
    for name, motion in zip("abc", motions, strict=True):
        sl.to_at2(motion, tmp_path / f"{name}.at2")
    records = "".join(RECORDED.format(name=name) for name in "abc")
    return case_of(f'ground = "firm"\nintensity = "0.01 m^2/s^3"\n{records}', tmp_path)


def test_records_of_a_file_stand_beside_the_gaps_by_rule(recorded_case):
    scene, _ = scene_of(recorded_case)
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
        recorded(dataclasses.replace(scene, case_file=None))


@pytest.mark.parametrize(
    ("changed", "shown"),
    [
        ({}, {"intensity", "measure"}),
        ({"measure": PGA}, {"pga", "measure"}),
        ({"measure": SA}, {"sa", "sa_period", "measure"}),
        ({"site": "eurocode_8", "measure": PGA}, {"ag", "soil", "spectrum_type"}),
        ({"site": "asce_7"}, {"sds", "sd1", "tl"}),
        ({"site": OF_FILE}, {"spectrum_scale"}),
    ],
)
def test_controls_of_the_strength_are_those_that_have_a_say(changed, shown):
    values = vars(Scene()) | changed
    names = {
        "ag",
        "soil",
        "spectrum_type",
        "sds",
        "sd1",
        "tl",
        "intensity",
        "pga",
        "sa",
        "sa_period",
        "spectrum_scale",
    }
    assert {name for name in {*names, "measure"} if counts(name, values)} == shown
    assert not counts("ground_period", values)


def test_accelerations_are_entered_in_g():
    scene = Scene(ag=0.25 * G)
    assert NUMBERS["ag"].text(scene) == "0.25"
    assert NUMBERS["ag"].read("0.5") == pytest.approx(0.5 * G)
