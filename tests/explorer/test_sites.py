"""Forms whose ground is sought: fitted to a code's spectrum, or as strong as motions are to be."""

from __future__ import annotations

import dataclasses
import pickle

import numpy as np
import pytest
from cases import example_of_short_motion
from motions import write_at2

import stochlin as sl
from stochlin.analyses.cases.files.schema import FILE
from stochlin.analyses.explorer.form import GROUND, PGA, S0, SA, choices, numbers
from stochlin.analyses.explorer.formulas import gap_rules, recorded, spectra
from stochlin.analyses.explorer.opening import first_form, open_case, opened
from stochlin.analyses.explorer.pair import structures_of
from stochlin.analyses.explorer.saving import case_text, files_named
from stochlin.analyses.explorer.simulations import merge_tables
from stochlin.views.explorer import pictures, words
from stochlin.views.explorer.controls import read_entry, text_of

pytestmark = pytest.mark.invariant

G = 9.80665
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\nfilters = 1\n'
STRENGTHS = {"ag", "soil", "type", "sds", "sd1", "tl", "intensity", "pga", "sa", "sa_period", "scale"}


def case_of(site, folder):
    text = example_of_short_motion()
    start, end = text.index("[site]"), text.index("[motion]")
    return read(f"{text[:start]}[site]\n{site}\n{text[end:]}", folder)


def read(text, folder):
    (folder / "case.toml").write_text(text, encoding="utf-8")
    return sl.read_case(folder / "case.toml")


def changed(form, **values):
    """The form with other values of these controls of the site."""
    return form.changed({("site", name): value for name, value in values.items()})


def waits(form, **values):
    """Whether the ground has to be sought for these values."""
    return changed(form, **values).case().of_site.waits


def longer(form):
    return form.changed({("motion", "duration"): 30.0})


def intensity(case):
    return float(case.ground.intensity)


def delivered(case, periods=(1.0,)):
    return sl.charts.simulated_spectrum(
        case.ground, list(periods), case.duration, case.envelope, paths=1024
    )


def assert_saved(case, folder):
    """The case file that is saved has the same ground."""
    saved, frequency = read(case_text(case), folder), np.array([2.0, 8.0, 30.0])
    np.testing.assert_allclose(saved.ground.psd(frequency), case.ground.psd(frequency), rtol=1e-4)


def test_a_ground_that_is_not_known_yet_is_told_and_sought():
    form = changed(first_form(), ground="firm", measure=PGA, pga=0.3 * G)
    # Of a duration that no other test simulates: mean accelerations are measured once in a process.
    form = form.changed({("motion", "duration"): 19.75})
    sought = pickle.loads(pickle.dumps(form.case()))  # in the process beside the page
    assert sought == form.case()
    shares: list[float] = []
    sought.of_site.settled(shares.append)
    assert shares[-1] == pytest.approx(1)
    assert waits(form)
    for name, shaking in sought.of_site.found().items():
        form.known.keep(name, shaking)
    assert not waits(form)
    assert form.case().ground == sought.ground
    peak = delivered(form.case()).peak_ground_acceleration
    assert float(peak) == pytest.approx(0.3 * G, rel=1e-9)  # of the very motions
    assert not waits(form, pga=0.6 * G)  # no simulation for another strength
    stronger = changed(form, pga=0.6 * G).case()
    assert intensity(stronger) == pytest.approx(4 * intensity(sought))
    assert waits(longer(form))
    assert waits(form, measure=SA)


def test_a_spectral_acceleration_is_met_at_its_period():
    form = changed(first_form(), ground="soft", measure=SA, sa=0.8 * G, sa_period=0.5)
    table = delivered(form.case(), [0.5])
    assert table.pseudo_acceleration.item() == pytest.approx(0.8 * G, rel=1e-9)
    assert not waits(form)
    assert waits(form, sa_period=0.6)
    assert intensity(changed(form, measure=S0).case()) == form["site", "intensity"]


def test_white_noise_has_no_peak():
    form = changed(first_form(), ground="white_noise", measure=PGA)
    with pytest.raises(ValueError, match="white noise has no peak"):
        form.case().of_site.settled()
    by_response = changed(form, measure=SA).case()
    by_response.of_site.settled()
    assert not by_response.of_site.waits


@pytest.mark.slow
def test_a_code_in_a_file_is_held_with_its_fit(tmp_path):
    code = case_of(CODE, tmp_path)
    form, notes = opened(code)
    assert not any("spectrum" in note for note in notes)
    assert (form[GROUND], form["site", "soil"], waits(form)) == ("eurocode_8", "C", False)
    assert form.case().ground == code.ground
    half = changed(form, ag=0.125 * G).case()
    assert not half.of_site.waits
    assert intensity(half) == pytest.approx(intensity(code) / 4)
    assert float(gap_rules(half).gap[0]) < float(gap_rules(form.case()).gap[0])
    assert spectra(half).psd_ground.shape == spectra(form.case()).psd_ground.shape
    assert waits(form, soil="B")
    assert "filters = 1" in case_text(changed(form, soil="B").case())


@pytest.mark.slow
def test_another_soil_is_fitted_anew(tmp_path):
    form, _ = opened(case_of(CODE.replace("filters = 1\n", ""), tmp_path))
    assert waits(form, soil="B", ag=3.0)
    other = changed(form, soil="B", ag=3.0).case()
    target = sl.eurocode_8(3.0, "B")
    table = sl.charts.simulated_spectrum(other.ground, target, other.duration, other.envelope)
    assert float(abs(table.ratio.sel(period=slice(0.1, 4.0)) - 1).max()) < 0.06
    assert len(other.ground.grounds) == 2
    assert_saved(other, tmp_path)


@pytest.mark.slow
def test_asce_7_is_held_and_scaled_as_one(tmp_path):
    site = 'spectrum = "asce_7"\nsds = "1 g"\nsd1 = "0.6 g"\ntl = "8 s"\nfilters = 1\n'
    form, _ = opened(case_of(site, tmp_path))
    values = [form["site", name] for name in ("ground", "sds", "sd1", "tl")]
    assert values == ["asce_7", G, 0.6 * G, 8.0]
    twice = changed(form, sds=2 * G, sd1=1.2 * G).case()
    assert intensity(twice) == pytest.approx(4 * intensity(form.case()))
    assert waits(form, sd1=0.5 * G)
    assert all(line in case_text(twice) for line in ('tl = "8 s"', 'sds = "2 g"', 'sd1 = "1.2 g"'))


@pytest.mark.slow
def test_another_damping_is_kept(tmp_path):
    code = case_of(f"{CODE}damping = 0.1\n", tmp_path)
    form, _ = opened(code)
    assert (form[GROUND], form.case().ground) == ("eurocode_8", code.ground)
    assert "damping = 0.1" in case_text(form.case())
    site = {key: value for key, value in form.file["site"].items() if key != "damping"}
    assert waits(dataclasses.replace(form, file={**form.file, "site": site}))


@pytest.mark.slow
def test_a_spectrum_of_a_file_has_its_own_scale(tmp_path):
    period = np.geomspace(0.05, 4.0, 60)
    values = sl.asce_7(G, 0.6 * G, 8.0).interp(period=period).values
    rows = [f"{t:.6g},{a:.9g}" for t, a in zip(period, values, strict=True)]
    (tmp_path / "site.csv").write_text("\n".join(["T,Sa", *rows]), encoding="utf-8")
    lines = 'spectrum = "site.csv"\nunits = "m/s^2"\nfilters = 1\n'
    scaled = case_of(f"{lines}scale = 0.5\n", tmp_path)
    of_file = sl.read_spectrum(tmp_path / "site.csv", units="m/s^2")
    np.testing.assert_allclose(scaled.spectrum, 0.5 * of_file)
    form, _ = opened(scaled)
    assert (form[GROUND], form["site", "scale"], form.case().ground) == (FILE, 0.5, scaled.ground)
    (grounds,) = (choice for choice in choices() if choice.place == GROUND)
    assert FILE in form.options(grounds)
    assert not waits(form, scale=1.0)  # another scale needs no fit, another motion does
    twice = changed(form, scale=1.0).case()
    assert intensity(twice) == pytest.approx(4 * intensity(scaled))
    assert waits(longer(form))
    assert files_named(twice) == ["site.csv"]
    assert_saved(twice, tmp_path)
    assert pickle.loads(pickle.dumps(twice)) == twice
    by_peak, _ = opened(case_of(f'{lines}pga = "0.3 g"\n', tmp_path))
    peak = delivered(by_peak.case()).peak_ground_acceleration
    assert float(peak) == pytest.approx(0.3 * G, rel=0.02)  # other motions than the file's
    assert 0 < by_peak["site", "scale"] != 1


def test_a_strength_by_a_peak_is_shown_as_the_file_gives_it(tmp_path):
    by_peak = case_of('ground = "firm"\npga = "0.3 g"\n', tmp_path)
    form, notes = opened(by_peak)
    assert not notes
    assert (form["site", "measure"], form["site", "pga"]) == (PGA, 0.3 * G)
    assert intensity(form.case()) == pytest.approx(intensity(by_peak), rel=1e-12)
    assert not waits(form, pga=0.6 * G)
    twice = changed(form, pga=0.6 * G).case()
    assert intensity(twice) == pytest.approx(4 * intensity(by_peak), rel=1e-12)
    assert 'pga = "0.6 g"' in case_text(twice)
    assert_saved(twice, tmp_path)


def write_records(folder):
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=3)
    for name, motion in zip("abc", motions, strict=True):
        write_at2(motion, folder / f"{name}.at2")


def test_records_suite_hazard_and_risk_of_a_file_stay_in_it(tmp_path):
    write_records(tmp_path)
    (tmp_path / "suite.csv").write_text("file\nb.at2\nc.at2\n", encoding="utf-8")
    site = (
        'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'
        '[[site.records]]\npath = "a.at2"\nname = "One \\"quoted\\""\nscale = 1.5\n'
        '[site.suite]\npath = "suite.csv"\npga = "0.3 g"\n'
        '[site.hazard]\nmeasure = "pga"\nk0 = 1e-4\nk = 2\nunits = "g"\n'
    )
    of_file = case_of(site, tmp_path)
    form, _ = opened(of_file)
    assert files_named(form.case()) == ["a.at2", "suite.csv"]
    saved = read(case_text(form.case()), tmp_path)
    assert saved.hazard == of_file.hazard
    assert list(saved.records) == list(of_file.records) == ['One "quoted"', "b.at2", "c.at2"]
    for name, record in of_file.records.items():
        np.testing.assert_array_equal(saved.records[name], record)


def test_a_case_is_opened_with_the_files_that_it_names(tmp_path):
    (tmp_path / "records").mkdir()
    write_records(tmp_path / "records")
    site = 'ground = "firm"\nintensity = "0.01 m^2/s^3"\n[[site.records]]\npath = "records/a.at2"\n'
    of_file = case_of(site, tmp_path)
    paths = tmp_path / "case.toml", tmp_path / "records" / "a.at2"
    files = {path.name: path.read_bytes() for path in paths}
    form, _ = open_case(files)
    np.testing.assert_array_equal(form.case().records["a.at2"], of_file.records["a.at2"])
    assert form["building_1", "period"] == of_file.first.period
    del files["a.at2"]
    with pytest.raises(
        ValueError, match=r"line \d+: site.records.path = .*choose the case file together"
    ) as refusal:
        open_case(files)
    assert "tmp" not in str(refusal.value)


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


@pytest.fixture
def recorded_case(tmp_path):
    write_records(tmp_path)
    records = (f'[[site.records]]\npath = "{name}.at2"\nname = "{name}"\n' for name in "abc")
    return case_of(f'ground = "firm"\nintensity = "0.01 m^2/s^3"\n{"".join(records)}', tmp_path)


def test_records_of_a_file_stand_beside_the_gaps_by_rule(recorded_case):
    form, _ = opened(recorded_case)
    table, rules = recorded(form.case()), gap_rules(form.case())
    pair = (in_metres(structure, recorded_case.ground) for structure in structures_of(form.case()))
    expected = sl.recorded_gap(*pair, dict(recorded_case.records))
    np.testing.assert_array_equal(table.separation, expected.separation)
    figure = pictures.gaps_figure(rules, table)
    shown = next(curve for curve in figure["data"] if curve["name"] == "records")
    np.testing.assert_allclose(shown["x"], 100 * expected.separation.values)
    assert shown["text"] == ["a", "b", "c"]
    assert len(figure["data"]) == len(pictures.gaps_figure(rules)["data"]) + 1
    most = float(expected.separation.max())
    wide, narrow = (
        words.records(recorded(form.changed({("separation", "existing"): gap}).case()))
        for gap in (1.01 * most, 1e-4)
    )
    assert "enough in 3 of 3" in wide
    assert "enough in 0 of 3" in narrow
    assert f"{100 * most:.1f}" in narrow
    assert words.records(None) == ""


def in_metres(structure, ground):
    displacement = sl.linearize(structure, ground).yield_displacement.item()
    return dataclasses.replace(structure, reduction_factor=None, yield_displacement=displacement)


def test_cases_know_records_by_their_file(recorded_case, tmp_path):
    form, _ = opened(recorded_case)
    before = form.case()
    for path in tmp_path.glob("*.at2"):  # what was read is not read again
        path.unlink()
    after = pickle.loads(pickle.dumps(form.case()))
    assert after == before
    assert hash(after) == hash(before)
    np.testing.assert_array_equal(recorded(after).separation, recorded(before).separation)
    data = merge_tables(before, {"gaps": gap_rules(before), "records": recorded(before)})
    assert data.records_separation.dims == ("records_record",)
    with pytest.raises(ValueError, match="the case has no record"):
        recorded(first_form().case())


@pytest.mark.parametrize(
    ("changes", "shown"),
    [
        ({}, {"intensity", "measure"}),
        ({"measure": PGA}, {"pga", "measure"}),
        ({"measure": SA}, {"sa", "sa_period", "measure"}),
        ({"ground": "eurocode_8", "measure": PGA}, {"ag", "soil", "type"}),
        ({"ground": "asce_7"}, {"sds", "sd1", "tl"}),
        ({"ground": FILE}, {"scale"}),
    ],
)
def test_controls_of_the_strength_are_those_that_have_a_say(changes, shown):
    form = changed(first_form(), **changes)
    assert {name for name in {*STRENGTHS, "measure"} if form.uses(("site", name))} == shown
    assert not form.uses(("site", "period"))


def test_accelerations_are_entered_in_g():
    (ag,) = (number for number in numbers() if number.place == ("site", "ag"))
    assert text_of(ag, changed(first_form(), ag=0.25 * G)) == "0.25"
    assert read_entry(ag, "0.5") == pytest.approx(0.5 * G)
