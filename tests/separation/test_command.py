"""``stochlin gap``: the answer on the screen, in a file and on a page, and what it says of bad input."""

import html
import itertools
import re
import shutil
import subprocess
from html.parser import HTMLParser
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from cases import BLOCK, KIOSK, example_case, with_buildings, with_slow
from click.testing import Result
from commands import invoke, refused

import stochlin as sl
from stochlin.views.separation.pictures import draw_heights
from stochlin.views.shared.symbols import typeset_html

pytestmark = pytest.mark.cli

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LINKS = {"src", "href", "xlink:href", "srcset", "action"}
INLINE = {"i", "sub", "sup"}
VOID = {"meta", "br", "link", "img", "hr", "input"}
NASTY = '<script>alert("1")</script> & co'
PHONE, DESK = 390, 1100  # px


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
    text = invoke("gap", "--example").output
    return done(folder, text, "--picture", folder / "gap.png")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Done:
    """Records, text that is no HTML, buildings that may do without, a gap that is enough."""
    folder = tmp_path_factory.mktemp("site")
    time = 0.02 * np.arange(2000)
    noise = np.random.default_rng(3).normal(size=time.size)
    np.savetxt(folder / "wave.txt", 0.01 * np.convolve(noise, np.exp(-4 * time), "full")[: time.size])
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


@pytest.mark.slow
def test_the_table_fits_the_screen_and_any_console(example: Done, site: Done) -> None:
    for one in (example, site):
        shown = one.result.output.replace(str(one.folder), "")
        assert not [line for line in shown.splitlines() if len(line) > 100]
        shown.encode("ascii")


class Page(HTMLParser):
    """What there is in a page; raises where tags do not close in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert not self.open, self.open

    @property
    def text(self) -> str:
        """All words on one line."""
        return " ".join("".join(self.words).split())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)
        self.words.append("" if tag in INLINE else " ")

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag
        self.words.append("" if tag in INLINE else " ")

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.words.append(data)


def test_the_page_needs_nothing_else_and_can_be_read_aloud(example: Done, site: Done) -> None:
    for text in (example.page, site.page):
        page = Page(text)
        assert not {"script", "link", "iframe", "img"} & {tag for tag, _ in page.tags}
        assert not re.search(r"@import|url\((?!#)", text)
        targets = [value for _, attrs in page.tags for key, value in attrs.items() if key in LINKS]
        ids = [attrs["id"] for _, attrs in page.tags if "id" in attrs]
        assert len(ids) == len(set(ids))
        assert {f"#{name}" for name in ids} >= {*targets, *re.findall(r"(?<=url\()[^)]+", text)}
        assert ("html", {"lang": "en"}) in page.tags
        drawn = [attrs for tag, attrs in page.tags if tag == "svg"]
        assert len(drawn) == 2
        assert all(attrs["role"] == "img" and len(attrs["aria-label"]) > 40 for attrs in drawn)
        levels = [int(tag[1]) for tag, _ in page.tags if re.fullmatch("h[1-6]", tag)]
        assert (levels[0], levels.count(1)) == (1, 1)
        assert all(deeper - level <= 1 for level, deeper in itertools.pairwise(levels))
        assert all("scope" in attrs for tag, attrs in page.tags if tag == "th")
    _, _, case = Page(example.page).text.partition("The case")
    assert "case.toml. Date, prepared by, checked by:" in case
    assert f"stochlin {sl.__version__}: separation(duration=20, confidence=0.9, paths=2048" in case


def test_symbols_are_set_with_indices_and_names_of_the_user_are_not(example: Done) -> None:
    told = typeset_html("T1 < Tg: S0, ξg and rho of 2 m^2, T1.toml", ["T1.toml", "T1"])
    assert told == (
        "T1 &lt; <i>T</i><sub>g</sub>: <i>S</i><sub>0</sub>, <i>ξ</i><sub>g</sub> and <i>ρ</i> of "
        "2 m<sup>2</sup>, T1.toml"
    )
    for index in "0a":
        assert f"<i>S</i><sub>{index}</sub>" in example.page
    without_file = re.sub("(?s)<pre.*?</pre>", "", example.page)
    assert not re.search(r"\b(S0|Sa|rho)\b", Page(without_file.replace("<sub>", "<sub> ")).text)


def test_text_of_the_user_stays_text_and_the_page_warns_of_what_is_doubtful(site: Done) -> None:
    assert site.result.exit_code == 0, site.result.output
    words = Page(site.page).text
    assert NASTY not in site.page
    assert NASTY in words
    assert "Record Gap [cm] Peak 1 at 15 m [cm]" in words
    assert re.search(r"keeps them apart in [\d.]+.% of the motions \([^)]*\)\. Verdict: enough; ", words)


OFFICE = BLOCK.format(n=1, period=0.5, storeys=3, height=3.2)
ANNEX = BLOCK.format(n=2, period=0.3, storeys=2, height=3.5)


@pytest.fixture(scope="module")
def storeyed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Done]:
    """Floors that are not level, and a building beside an oscillator, each with its picture."""
    found = {}
    for name, second in (("uneven", ANNEX), ("mixed", KIOSK.format(n=2))):
        folder = tmp_path_factory.mktemp(name)
        text = with_buildings(OFFICE, second).replace("align = true", "align = false")
        found[name] = done(folder, few(text), "--picture", folder / "gap.svg")
        assert found[name].result.exit_code == 0, found[name].result.output
    return found


@pytest.mark.slow
def test_storeys_are_told_and_drawn_from_the_saved_data(storeyed: dict[str, Done]) -> None:
    for name, one in storeyed.items():
        shown = " ".join(one.result.output.split())
        with xr.open_dataset(one.folder / "gap.nc") as table:
            for variable in table.data_vars.values():
                assert "long_name" in variable.attrs
            first = table.isel(element=table.element_structure.values == 1)
            worst = first.isel(element=int(first.ductility.argmax("element")))
            drift = 100 * float(worst.peak_drift_mean)
            told = f"{drift:.1f} cm, {drift / 3.2:.2f} % of its height"
            told += f", ductility {float(worst.ductility):.1f}"
            assert f"storey {int(worst.storey)} of Block 1, {told}" in shown
            if name == "uneven":  # beside an oscillator there is one height
                figure = draw_heights(table)
                line = figure.axes[0].get_lines()[0]
                gaps = 100 * table.gap_at_height.sel(rule="simulation")
                np.testing.assert_allclose(line.get_xdata()[1:], gaps)
                caption = figure.get_supxlabel()
                assert "shear building (masses 3 times 300 t" in caption
                assert "128 motions of 20 s" in caption
        assert ("The gap over the height" in one.page) == (name == "uneven")
        assert (one.folder / "gap.svg").read_text(encoding="utf-8").startswith("<?xml")
    assert "that of the roof of Block 1, 9.6 m up, although it is 4 m high" in " ".join(
        storeyed["mixed"].result.output.split()
    )


def test_a_bad_file_writes_nothing(tmp_path: Path) -> None:
    text = example_case().replace('period = "0.6 s"', "period = 0.6", 1)
    one = done(tmp_path, text)
    assert one.result.exit_code == 2
    line = text[: text.index("period = 0.6")].count("\n") + 1
    shown = " ".join(one.result.output.split())
    assert f"case.toml, line {line}: building_2.period = 0.6 has no unit" in shown
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        ((), "stochlin gap --example > case.toml"),
        (("nowhere.toml",), "nowhere.toml"),
        (("case.toml", "--report", "case.toml"), "allowed: .html or .htm"),
        (("case.toml", "--picture", "t.nc"), "allowed: .png or .svg or .pdf"),
    ],
)
def test_commands_with_wrong_files_are_refused(
    arguments: tuple[str, ...], says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(example_case())
    assert says in refused("gap", *arguments)
    assert (tmp_path / "case.toml").read_text() == example_case()
    assert len(list(tmp_path.iterdir())) == 1


def rendered(page: str, wide: int, tall: int, measure: str, folder: Path) -> list[int]:
    """Whole numbers that a script measures on a page (``inner``) in a window of this size [px]."""
    frame = folder / "frame.html"
    frame.write_text(
        f"""<!doctype html><meta charset="utf-8"><iframe srcdoc="{html.escape(page)}" width="{wide}"
        height="{tall}" style="border: 0" onload="
          const inner = this.contentDocument, root = inner.documentElement;
          {measure}
          document.title = found.map(Math.round).join(' ')">
        </iframe>""",
        encoding="utf-8",
    )
    command = [str(CHROMIUM), "--headless=new", "--no-sandbox", "--disable-gpu", "--dump-dom"]
    command += ["--window-size=1400,900"]
    command += [f"--user-data-dir={folder / 'profile'}", "--virtual-time-budget=5000", frame.as_uri()]
    dumped = subprocess.run(command, capture_output=True, text=True, check=True, timeout=120).stdout
    found = re.search(r"<title>([-\d ]+)</title>", dumped)
    assert found, dumped[:500]
    return [int(number) for number in found[1].split()]


@pytest.mark.skipif(CHROMIUM is None, reason="there is no Chromium to render the page in")
@pytest.mark.parametrize(
    "name", with_slow(["example", "example at a desk", "site"], {"example at a desk", "site"})
)
def test_the_page_fits_a_phone_and_breaks_no_number(
    name: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    wide = DESK if "desk" in name else PHONE
    measure = """const tables = [...inner.querySelectorAll('.scroll')];
          const over = tables.map(e => e.scrollWidth - e.clientWidth);
          const lines = e => {
            const range = inner.createRange(); range.selectNodeContents(e);
            return range.getClientRects().length;
          };
          const broken = [...inner.querySelectorAll('dd, td')].filter(e =>
            !e.children.length && !e.textContent.trim().includes(' ') && lines(e) > 1);
          const found = [root.clientWidth, root.scrollWidth, Math.max(...over), broken.length];"""
    page = request.getfixturevalue(name.split(maxsplit=1)[0]).page
    width, needed, within_table, broken = rendered(page, wide, 800, measure, tmp_path)
    assert 0 < width <= wide
    assert needed <= width
    assert not broken
    if name != "site":  # of names as long as they may be, a table scrolls within itself
        assert within_table <= 0
