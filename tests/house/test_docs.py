"""The documentation: its code runs as printed, its reference is complete, and the site builds."""

import importlib.util
import re
import runpy
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import numpy as np
import pytest
from cases import run_as_printed, with_slow
from house.claims import missing

import stochlin as sl

pytestmark = pytest.mark.cli

DOCS = Path(__file__).parents[2] / "docs"
PAGES = {path.stem: path.read_text(encoding="utf-8") for path in sorted(DOCS.glob("*.md"))}
SCRIPTS = sorted((DOCS / "gallery").glob("plot_*.py"))
THEORY, START = PAGES["theory"], PAGES["start"]
REFERENCE = (DOCS / "reference" / "index.md").read_text(encoding="utf-8")
PUBLIC = Path(sl.__file__).with_suffix(".pyi").read_text(encoding="utf-8")


# Their commands and their code need one another: tests/house/test_worked_case.py and, of a program that
# is killed, tests/tables/test_large_tables.py
CASES = "worked_case", "from_tables", "large_tables"
RUN_HERE = {name: text for name, text in PAGES.items() if name not in CASES}


# By tests/house/test_command.py.
DRAWN = "stochlin charts --record record.at2 --out site"


def blocks(text: str, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.DOTALL | re.MULTILINE)


def command_lines() -> list[str]:
    printed = "".join("".join(blocks(text, "console")) for text in RUN_HERE.values())
    lines = dict.fromkeys(line for line in printed.splitlines() if line)
    assert DRAWN in lines
    return [line for line in lines if line != DRAWN]


PROGRAMS = [name for name, text in RUN_HERE.items() if blocks(text, "python")]
LONG = {"stochlin gap case.toml --report gap.html"}
# Of half a second or more; `make test` runs the others, and the tests of what these call.
LONG_SCRIPTS = {
    DOCS / "gallery" / f"plot_{name}.py"
    for name in (
        *("02_linearized_and_simulated", "03_error_by_strength", "11_own_law"),
        *("12_error_by_way", "14_probability_over_time", "15_drift_closure", "16_error_of_closures"),
        *("17_gaps_in_earthquakes", "19_measures", "20_wall_beside_frame"),
    )
}


@pytest.fixture(autouse=True)
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A folder of its own, and pictures that go with the test."""
    import matplotlib as mpl
    import matplotlib.pyplot as plt

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "agg")
    with mpl.rc_context():
        yield
        plt.close("all")


@pytest.mark.parametrize("page", with_slow(PROGRAMS, {"buildings", "pounding", "probability", "sites"}))
def test_code_of_a_page_runs_from_top_to_bottom(page: str) -> None:
    namespace: dict[str, object] = {}
    for number, block in enumerate(blocks(PAGES[page], "python")):
        exec(compile(block, f"{page}.md, block {number}", "exec"), namespace)
    assert missing(f"docs/{page}.md", "code", namespace) == []


def test_first_chart_is_the_one_of_the_page() -> None:
    """Its numbers are those of the gallery, whose picture stands below it."""
    chart, gallery = {}, {}
    for block in blocks(START, "python")[:2]:
        exec(compile(block, "start.md", "exec"), chart)
    exec(compile(SCRIPTS[0].read_text(encoding="utf-8"), SCRIPTS[0].name, "exec"), gallery)
    np.testing.assert_array_equal(chart["table"].rho, gallery["yielding"].rho)
    assert Path("chart.png").exists()
    assert Path("chart.nc").exists()


@pytest.mark.parametrize("line", with_slow(command_lines(), LONG))
def test_command_lines_run(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("stochlin.views.explorer.server.serve", lambda *form, **options: None)
    monkeypatch.setattr("tempfile.tempdir", None)  # the command sets it
    run_as_printed(line, command_lines())


@pytest.mark.parametrize("page", PAGES)
def test_lines_of_case_files_on_a_page_are_toml(page: str) -> None:
    assert all(tomllib.loads(block) for block in blocks(PAGES[page], "toml"))


@pytest.mark.slow
@pytest.mark.parametrize("path", with_slow(SCRIPTS, LONG_SCRIPTS), ids=lambda path: path.stem)
def test_script_of_the_gallery_draws_pictures_for_a_page(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib.pyplot as plt

    monkeypatch.chdir(path.parent)  # as the site builds it
    runpy.run_path(str(path))
    assert plt.get_fignums()
    for number in plt.get_fignums():
        figure = plt.figure(number)
        figure.canvas.draw()
        assert max(figure.get_size_inches()) <= 7.2  # the width of a printed page


def test_the_reference_has_a_section_for_every_public_name() -> None:
    """Its lists are made from the names that stand below the same headings."""
    before, *_ = PUBLIC.partition("\n# ")
    assert "\nfrom " not in before
    assert re.findall("^# (.*)$", PUBLIC, re.MULTILINE) == re.findall(
        "^## (.*)$", REFERENCE, re.MULTILINE
    )


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_the_gallery_goes_through_public_doors(path: Path) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    found = {line.split()[1] for line in lines if re.match("(from|import) stochlin", line)}
    assert found <= {"stochlin", "stochlin.charts"}


def test_theory_has_every_equation_of_the_paper_and_its_code() -> None:
    tags = re.findall(r"\\tag\{([\d, ]+)\}", THEORY)
    assert sorted(int(number) for tag in tags for number in tag.split(",")) == list(range(1, 17))
    sections = re.split(r"^## ", THEORY, flags=re.MULTILINE)
    assert not [text.splitlines()[0] for text in sections if "\\tag" in text and "py:obj" not in text]


def test_subscripts_stand_beside_letters_with_dots() -> None:
    """The site sets an index of a letter with a dot below it, unless an empty group is between them."""
    notebooks = [
        path.read_text(encoding="utf-8") for path in (DOCS.parent / "notebooks").glob("*.ipynb")
    ]
    for text in (*PAGES.values(), *notebooks):
        assert not re.search(r"\\d?dot *(\{[^}]*\}|\\*[A-Za-z]+)_", text)


@pytest.mark.parametrize("page", PAGES)
def test_files_that_a_page_links_to_exist(page: str) -> None:
    for target in re.findall(r"\]\(([^)#]+\.(?:md|ipynb))", PAGES[page]):
        # The site takes the notebooks from the folder of the repository.
        assert (DOCS / target).exists() or (
            target.startswith("notebooks/") and (DOCS.parent / target).exists()
        )
    for target in re.findall(r"<(\.\./[^>]+)>", PAGES[page]):
        assert (DOCS / target).exists(), target


@pytest.mark.parametrize("page", PAGES)
def test_tests_that_a_page_names_exist(page: str) -> None:
    for name in re.findall(r"`(?:tests/)?(\w+/test_\w+[^`]*)`", PAGES[page]):
        assert (DOCS.parent / "tests" / name).exists(), name


def test_pages_show_pictures_of_the_gallery() -> None:
    stems = {path.stem for path in SCRIPTS}
    shown = re.findall(r"sphx_glr_(plot_\w+)_001\.png", "".join(PAGES.values()))
    assert shown
    assert set(shown) <= stems


class Links(HTMLParser):
    """Anchors and local targets of one page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.targets: list[tuple[str, str]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.anchors.add(str(values.get("id")))
        target = urlsplit(values.get("href") or values.get("src") or "")
        if not target.scheme and not target.netloc:
            self.targets.append((unquote(target.path), unquote(target.fragment)))


@pytest.mark.slow
@pytest.mark.skipif(
    importlib.util.find_spec("sphinx_gallery") is None, reason="the extra 'docs' is not installed"
)
def test_site_builds_without_warnings_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    made = shutil.ignore_patterns("auto_gallery", "generated")
    shutil.copytree(DOCS, "docs", ignore=made)
    shutil.copytree(DOCS.parent / "notebooks", "notebooks")
    shutil.copy(DOCS.parent / "CHANGELOG.md", ".")
    site = tmp_path / "site"
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "docs", str(site)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = {path: Links(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    assert len(pages) > len(sl.__all__)
    reference = (site / "reference" / "index.html").read_text(encoding="utf-8")
    assert not [name for name in sl.__all__ if f"generated/stochlin.{name}." not in reference]
    for path, links in pages.items():
        for target, anchor in links.targets:
            file = (path.parent / target).resolve() if target else path
            assert file.exists(), f"{path.name}: {target}"
            if anchor and file in pages:
                assert anchor in pages[file].anchors, f"{path.name}: {target}#{anchor}"
