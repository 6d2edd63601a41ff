"""``stochlin gap``: the answer on screen, in a file and on a page; what it says of bad input."""

import html
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from cases import BLOCK, example_case, with_buildings
from click.testing import Result
from commands import invoke, refused

import stochlin as sl
from stochlin.views.separation.pictures import draw_heights
from stochlin.views.shared.blocks import typeset_html

pytestmark = pytest.mark.cli

NASTY = '<script>alert("1")</script> & co'


class Done(NamedTuple):
    result: Result
    folder: Path

    @property
    def page(self) -> str:
        return (self.folder / "gap.html").read_text(encoding="utf-8")


def done(folder: Path, text: str, *more: object) -> Done:
    (folder / "case.toml").write_text(text, encoding="utf-8")
    out = ("--details", "--report", folder / "gap.html", "--out", folder / "gap.nc", *more)
    return Done(invoke("gap", folder / "case.toml", *out), folder)


def few(text: str) -> str:
    """The case with few motions, and without the existing gap, whose answers take long."""
    return text.replace("2048", "128").replace('existing = "5 cm"', "")


@pytest.fixture(scope="module")
def example(tmp_path_factory: pytest.TempPathFactory) -> Done:
    folder = tmp_path_factory.mktemp("example")
    text = invoke("gap", "--example").output.replace("2048", "256")
    return done(folder, text, "--picture", folder / "gap.png")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Done:
    """Records, text that is no HTML, buildings that may do without, a gap that is enough."""
    folder = tmp_path_factory.mktemp("site")
    time = 0.02 * np.arange(2000)
    noise = np.random.default_rng(3).normal(size=time.size)
    np.savetxt(
        folder / "wave.txt", 0.01 * np.convolve(noise, np.exp(-4 * time), "full")[: time.size]
    )
    record = '[[site.records]]\npath = "wave.txt"\nunits = "g"\ndt = "0.02 s"\n'
    text = example_case().replace("[motion]", f"{record}name = '{NASTY}'\n{record}\n[motion]")
    text = text.replace('"Annex"', f"'{NASTY}'").replace('existing = "5 cm"', 'existing = "90 cm"')
    text = text.replace('"Office block and annex"', f"'{NASTY}'")
    text = text.replace('"24 m"', '"20 m"').replace("2048", "256")
    text = text.replace("\nreduction_factor = 4\nheight", "\nductility = 3\nheight")
    return done(folder, text)


def test_the_answer_comes_first_and_is_the_librarys(example: Done) -> None:
    output = example.result.output
    assert example.result.exit_code == 0, output
    with xr.open_dataset(example.folder / "gap.nc") as table:
        gap = 100 * float(table.gap.sel(rule="simulation"))
        probability = 100 * float(table.existing_no_pounding_probability)
        rules = [str(name) for name in table.rule.values if not table.missing.sel(rule=name).item()]
        assert table.gap.attrs["units"] == "m"
    assert f"Office block and Annex should stand {gap:.1f} cm apart." in output
    assert f"keeps them apart in {probability:.1f} %" in output
    verdicts = "answer|at least the answer|less than the answer|within error|no verdict"
    shown = re.findall(rf"^(\w+) .*  (?:{verdicts})\b", output, re.MULTILINE)
    assert shown[0] == "simulation"
    assert sorted(shown) == sorted(rules)
    assert "mexico_city of simulated peaks: needs zone" in output


def test_the_page_needs_nothing_else_and_can_be_read_aloud(example: Done, site: Done) -> None:
    for done_case in (example, site):
        page, shown = done_case.page, done_case.result.output.replace(str(done_case.folder), "")
        long = [line for line in shown.splitlines() if len(line) > 100]
        assert all(line.startswith("Warning: ") for line in long)
        shown.encode("ascii")
        assert not re.search(r"<(script|link|iframe|img)\b|@import|url\((?!#)", page)
        ids = re.findall(r'\bid="([^"]+)"', page)
        assert len(ids) == len(set(ids))
        assert {*ids} >= {*re.findall(r'(?:url\(|href=")#([^")]+)', page)}
        assert page.count('<svg role="img" aria-label="') == page.count("<svg") == 2
        assert page.count("<h1") == 1
        assert all("scope=" in head for head in re.findall(r"<th\b[^>]*>", page))
    end = words(example.page).partition("The case")[2]
    assert re.search(r"case\.toml: gap [\d.]+.cm\. Date, prepared by, checked by:", end)
    assert end.endswith(f"stochlin {sl.__version__}.")


def words(page: str) -> str:
    """The text of a page on one line, as a reader has it."""
    shown = re.sub(r"(?s)<style.*?</style>|</?(?:i|sub|sup)>", "", page)
    return " ".join(html.unescape(re.sub(r"<[^>]+>", " ", shown)).split())


def test_symbols_are_set_with_indices_and_text_of_the_user_stays_text(site: Done) -> None:
    typeset = typeset_html("T1 < Tg: S0, ξg and rho of 2 m^2, T1.toml", ["T1.toml", "T1"])
    assert typeset == (
        "T1 &lt; <i>T</i><sub>g</sub>: <i>S</i><sub>0</sub>, <i>ξ</i><sub>g</sub> and <i>ρ</i> of "
        "2 m<sup>2</sup>, T1.toml"
    )
    assert site.result.exit_code == 0, site.result.output
    text = words(site.page)
    assert NASTY not in site.page
    assert NASTY in text
    assert "Record Gap [cm] Peak 1 at 15 m [cm]" in text
    assert re.search(
        r"keeps them apart in [\d.]+.% of the motions \([^)]*\)\. Verdict: enough; ", text
    )


OFFICE = BLOCK.format(n=1, period=0.5, storeys=3, height=3.2)
ANNEX = BLOCK.format(n=2, period=0.3, storeys=2, height=3.5)


@pytest.mark.slow
def test_gaps_over_the_height_are_drawn(tmp_path: Path) -> None:
    text = few(with_buildings(OFFICE, ANNEX).replace("align = true", "align = false"))
    done(tmp_path, text)
    with xr.open_dataset(tmp_path / "gap.nc") as table:
        assert all("long_name" in variable.attrs for variable in table.data_vars.values())
        figure = draw_heights(table)
        line = figure.axes[0].get_lines()[0]
        gaps = 100 * table.gap_at_height.sel(rule="simulation")
        np.testing.assert_allclose(line.get_xdata()[1:], gaps)
        assert "128 motions of 20 s" in figure.get_supxlabel()


def test_a_bad_file_writes_nothing(tmp_path: Path) -> None:
    text = example_case().replace('period = "0.6 s"', "period = 0.6", 1)
    one = done(tmp_path, text)
    assert one.result.exit_code == 2
    line = text[: text.index("period = 0.6")].count("\n") + 1
    shown = " ".join(one.result.output.split())
    assert f"case.toml, line {line}: building_2.period = 0.6 has no unit" in shown
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


def test_commands_with_wrong_files_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(example_case())
    assert "stochlin gap --example > case.toml" in refused("gap")
    assert "nowhere.toml" in refused("gap", "nowhere.toml")
    assert "allowed: .html or .htm" in refused("gap", "case.toml", "--report", "case.toml")
    assert "allowed: .png or .svg or .pdf" in refused("gap", "case.toml", "--picture", "t.nc")
    assert (tmp_path / "case.toml").read_text() == example_case()
    assert len(list(tmp_path.iterdir())) == 1
