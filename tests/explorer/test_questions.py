"""What a user asks of the page: does a number stay, does a file, does the strength; in a browser."""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest
from browser import wait
from cases import example_of_short_motion
from click.testing import CliRunner
from motions import write_at2

import stochlin as sl
from stochlin.analyses.explorer.form import numbers
from stochlin.analyses.explorer.opening import opened
from stochlin.views.command import main
from stochlin.views.explorer.controls import name_of, text_of

pytestmark = [pytest.mark.cli, pytest.mark.slow]  # in a browser

RECORD = '[[site.records]]\npath = "a.at2"\nname = "Record A"\n\n'
STOREYS = """
[building_2]
name = "Annex"
masses = ["300 t", "250 t"]
stiffnesses = ["200 MN/m", "180 MN/m"]
heights = ["4 m", "3.2 m"]
yield_drifts = "1 cm"
damping = 0.04
hardening = 0.1
p_delta = true
"""
SITE = 'spectrum = "site.csv"\nunits = "m/s^2"\nfilters = 1\n'


@pytest.fixture
def file(tmp_path):
    """The example with other numbers and a record; few motions."""
    motion = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=2)[0]
    write_at2(motion, tmp_path / "a.at2")
    text = sl.example_case().replace("[motion]", f"{RECORD}[motion]").replace('"4 s"', '"3.5 s"')
    text = text.replace("paths = 2048", "paths = 128").replace('"0.6 s"', '"0.8 s"', 1)
    path = tmp_path / "other.toml"
    path.write_text(text, encoding="utf-8")
    return path


def simulate(page):
    page.click("simulate")
    wait(lambda: page.text("told").startswith("Simulated:"))
    page.idle()


def saved(page, folder, name="other.toml"):
    page.click("save-case")
    return shutil.copy(page.downloaded(name), folder / "saved.toml")


@pytest.mark.parametrize("storeys", [False, True])
def test_one_label_has_one_number_before_and_after_the_simulation(page, storeys):
    if storeys:
        page.choose("Building 2 described as", "regular storeys")
        wait(lambda: page.shows("building_2.storeys"))
        page.enter("building_2.storeys", "2")
    page.enter("simulation.paths", "640")
    page.click("every")
    page.idle()
    rows, said = page.gaps(), page.text("panel=gaps")
    curves, chances = page.curve("correlation", 0), page.text("panel=probability")
    simulate(page)
    after = page.gaps()
    assert {label: after[label] for label in rows} == pytest.approx(rows, rel=1e-9)
    assert "simulation" in after.keys() - rows.keys()
    assert "SRSS" in after.keys() - rows.keys()
    ours = re.search(r"(linearized peaks|Linearization): [\d.]+", said)
    assert ours
    assert ours[0] in page.text("panel=gaps")
    assert "Simulated: " in page.text("panel=gaps")
    assert page.curve("correlation", 0) == curves
    for share in re.findall(r"[\d.]+\s% (?:by formula|corrected|simulated by \d+ motions)", chances):
        assert share in page.text("panel=probability")
    assert "simulated by 640 motions" in page.text("panel=probability")


def test_a_case_file_sets_the_sliders_and_is_saved_with_all_that_has_none(page, file):
    page.send(file, file.with_name("a.at2"))
    wait(lambda: page.value("motion.rise_end") == "3.5")
    page.idle()
    before = sl.read_case(file)
    form, _ = opened(before)
    for number in numbers():
        if form.uses(number.place):
            assert page.value(name_of(number.place)) == text_of(number, form), number.place
    assert page.text("alert") == ""
    wait(lambda: "Records: " in page.text("panel=gaps"))
    page.enter("building_2.period", "0.75")
    page.idle()
    simulate(page)
    told = page.text("panel=gaps").replace("\N{NO-BREAK SPACE}", " ")
    answer = re.search(r"Simulated: ([\d.]+) cm \(([^)]+)\)", told)
    assert answer
    path = saved(page, file.parent)
    assert "Keep the saved case file beside the files that it names: a.at2." in page.text("told")
    after = sl.read_case(path)
    for name in ("contact", "measures", "amplification_limit", "floors_align"):
        assert getattr(after, name) == getattr(before, name), name
    np.testing.assert_array_equal(after.records["Record A"], before.records["Record A"])
    assert (after.second.structure.mass, after.second.structure.period) == (1.5e6, 0.75)
    outcome = CliRunner().invoke(main, ["gap", str(path)])
    assert outcome.exit_code == 0, outcome.output
    first = f"Office block and Annex should stand {answer[1]} cm apart. 95 % interval: {answer[2]}."
    assert first in outcome.output.splitlines()
    outcome = CliRunner().invoke(main, ["pound", str(path)])
    assert outcome.exit_code == 0, outcome.output


def test_storeys_and_the_spectrum_of_a_file_are_kept(page, tmp_path):
    period = np.geomspace(0.05, 4.0, 60)
    values = sl.asce_7(9.8, 5.9, 8.0).interp(period=period).values
    rows = [f"{t:.6g},{a:.9g}" for t, a in zip(period, values, strict=True)]
    (tmp_path / "site.csv").write_text("\n".join(["T,Sa", *rows]), encoding="utf-8")
    text = example_of_short_motion()
    start, motion, second, rest, contact = (
        text.index(f"[{name}]") for name in ("site", "motion", "building_2", "separation", "contact")
    )
    site = f"{text[:start]}[site]\n{SITE}{text[motion:second]}"
    path = tmp_path / "other.toml"
    path.write_text(f"{site}{STOREYS}{text[rest:contact]}", encoding="utf-8")
    page.send(path, tmp_path / "site.csv")
    wait(lambda: page.shows("site.scale"))
    page.idle()
    assert "has this one slider: a factor on all of its accelerations" in page.text('about="site.scale"')
    assert page.shows("building_2.strength_factor")
    assert not page.shows("site.intensity")
    before = page.curve("spectra", 0)
    page.enter("site.scale", "0.5")  # a quarter of the power, without another fit
    page.idle()
    np.testing.assert_allclose(page.curve("spectra", 0), np.array(before) / 4, rtol=1e-9)
    opened_case, saved_case = sl.read_case(path), sl.read_case(saved(page, tmp_path))
    np.testing.assert_allclose(saved_case.spectrum, 0.5 * opened_case.spectrum, rtol=1e-12)
    ours, theirs = (case.second.structure.arrays() for case in (opened_case, saved_case))
    for name, array in ours.items():
        np.testing.assert_allclose(theirs[name], array, rtol=1e-12, err_msg=name)


def test_a_file_that_is_no_case_is_refused_in_the_words_of_its_reader(page, file):
    before = page.value("building_1.period"), page.curve("correlation", 0)
    text = file.read_text(encoding="utf-8")
    wrong = text.replace('period = "1.0 s"', 'period = "1.0 parsec"')
    file.write_text(wrong, encoding="utf-8")
    with pytest.raises(ValueError, match="unknown unit") as refused:
        sl.read_case(file)
    for files, message in (
        ([file, file.with_name("a.at2")], str(refused.value)),
        ([file.with_name("a.at2")], "0 case files are chosen; allowed: one"),
    ):
        page.send(*files)
        wait(lambda message=message: message in page.text("alert"))
    file.write_text(text, encoding="utf-8")
    page.send(file)
    wait(lambda: "choose the case file together with the files that it names" in page.text("alert"))
    assert (page.value("building_1.period"), page.curve("correlation", 0)) == before


def test_the_intensity_changes_a_strength_that_is_given_by_r_alone(page, tmp_path):
    assert "a stronger ground motion makes the building stronger" in page.text(
        'about="building_1.reduction_factor"'
    )
    page.choose("Strength of building 1 given by", "yield displacement")
    ways = [f"building_1.{key}" for key in ("yield_displacement", "reduction_factor")]
    wait(lambda: [*map(page.shows, ways)] == [True, False])
    page.idle()
    start = float(page.value("building_1.yield_displacement"))
    page.enter("site.intensity", "0.02")
    page.idle()
    assert float(page.value("building_1.yield_displacement")) == start
    case = sl.read_case(saved(page, tmp_path, "case.toml"))
    assert case.first.structure.yield_displacement == pytest.approx(0.01 * start, rel=1e-7)
    assert case.second.structure.reduction_factor == 4.0
    # It began with the strength by R before; building 2 is now stronger than it was.
    firm = sl.named_ground("firm", 0.01)
    for building, times in ((case.first, 1.0), (case.second, np.sqrt(2))):
        r4 = sl.Bilinear(building.structure.period, 0.05, 0.05, reduction_factor=4)
        was = float(sl.linearize(r4, firm).yield_displacement)
        now = float(sl.linearize(building.structure, case.ground).yield_displacement)
        assert now == pytest.approx(times * was, rel=1e-6)
