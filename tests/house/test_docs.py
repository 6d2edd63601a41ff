"""README and docs: commands and code run as printed, links lead somewhere, the site builds."""

import html
import importlib.util
import re
import runpy
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import redirect_stdout
from html.parser import HTMLParser
from io import StringIO
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
import xarray as xr
from cases import run_as_printed, with_slow
from commands import answered
from house import pictures
from house.claims import ROOT, missing

import stochlin as sl

pytestmark = pytest.mark.cli

DOCS = ROOT / "docs"
SCRIPTS = sorted((DOCS / "gallery").glob("plot_*.py"))
PAGES = {
    path: path.read_text(encoding="utf-8") for path in (ROOT / "README.md", *DOCS.glob("*.md"))
}
README, THEORY = PAGES[ROOT / "README.md"], PAGES[DOCS / "theory.md"]
# Pages whose commands and code need one another, with the files of their cases.
WORKED = {
    "worked_case": [DOCS / "worked_case.toml"],
    "from_tables": sorted((DOCS / "from_tables").iterdir()),
}
# Their programs are run as such: tests/tables/test_large_tables.py, tests/cases/test_services.py
RUN_HERE = [path for path in PAGES if path.stem not in (*WORKED, "large_tables", "services")]
WRITTEN, NUMBER = {".toml", ".csv", ".html"}, re.compile(r"\d+\.?\d*")
ELSEWHERE = {
    "stochlin warmup",  # it would compile everything
    "stochlin charts",  # tests/answers/charts_of_every_figure
}


def fenced(text: str) -> list[tuple[str, str]]:
    """Language and text of every block."""
    return re.findall(r"^```(\S*)[^\n]*\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)


def blocks(text: str, *languages: str) -> list[str]:
    return [block for language, block in fenced(text) if language in languages]


def command_lines() -> list[str]:
    shells = {path: ("", "sh") for path in PAGES if path.stem in ("README", "start")}
    text = "".join(
        "".join(blocks(PAGES[path], "console", *shells.get(path, ()))) for path in RUN_HERE
    )
    lines = [line.split("  #")[0].strip() for line in text.replace("\\\n", " ").splitlines()]
    printed = {re.sub(" +", " ", line) for line in lines if line.startswith("stochlin ")}
    assert printed >= ELSEWHERE
    return sorted(printed - ELSEWHERE)


LONG = {
    "stochlin charts fig3b --curves jeng_kasai_maison_1992_unverified,iwan_1980",
    # others are drawn
    "stochlin charts fig5a --damping 0.02 --hardening 0.1 --format pdf --out out",
    "stochlin charts fig4b --print-width 84mm --format pdf --out out",  # tests/charts/test_print.py
    "stochlin charts fig4b --ground-dampings 0.05,0.2,0.6 --comparison",
    "stochlin gap case.toml --report gap.html",  # there is one with another name
    "stochlin gap case.toml --report gap.html --out gap.nc",
    "stochlin mitigate case.toml --out measures.csv",
    "stochlin gap case.toml --details",  # the README's
    "stochlin probability case.toml",  # tests/answers/probability_of_the_example
    "stochlin pound case.toml --motions 100",  # there is one with a picture
    "stochlin pound case.toml --picture pound.png",
}
# Of half a second or more; `make test` runs the others, and the tests of what these call.
PROGRAMS = {path.stem: path for path in RUN_HERE if blocks(PAGES[path], "python")}
del PROGRAMS["README"]


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


@pytest.mark.parametrize("line", with_slow(command_lines(), LONG))
def test_command_lines_run(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # It would serve until it is interrupted; tests/explorer/test_page.py lets it.
    monkeypatch.setattr("stochlin.views.explorer.server.serve", lambda *form, **options: None)
    monkeypatch.setattr("tempfile.tempdir", None)  # the command sets it
    run_as_printed(line, command_lines())


@pytest.mark.parametrize(
    "page", with_slow(PROGRAMS, {"buildings", "pounding", "probability", "sites"})
)
def test_code_of_a_page_runs_from_top_to_bottom(page: str) -> None:
    namespace: dict[str, object] = {}
    for number, block in enumerate(blocks(PAGES[PROGRAMS[page]], "python")):
        exec(compile(block, f"{page}.md, block {number}", "exec"), namespace)
    assert missing(f"docs/{page}.md", "code", namespace) == []


def test_code_and_case_file_of_the_readme_print_what_it_shows(tmp_path: Path) -> None:
    gaps, solved = blocks(README, "text")
    with redirect_stdout(StringIO()) as printed:
        exec(compile(blocks(README, "python")[0], "README.md", "exec"), {})
    # The last change is rounding error.
    assert printed.getvalue().splitlines()[:-1] == solved.splitlines()[:-1]
    assert xr.load_dataset("rho.nc").rho.notnull().all()
    Path("case.toml").write_text("".join(blocks(README, "toml")), encoding="utf-8")
    lines = iter(answered("gap", "case.toml", "--details").output.splitlines())
    assert all(line in lines for line in gaps.splitlines())


def as_on_a_screen(text: str) -> str:
    """One line without the ends of lines, marks and the signs of a page that a screen has not."""
    text = re.sub(r"</?(?:i|sub|sup)>", "", text.replace("<sup>", "^"))
    text = html.unescape(re.sub(r"<[^>]+>", " ", text)).replace("m²/s³", "m^2/s^3")
    return " ".join(text.split())


@pytest.mark.slow
@pytest.mark.parametrize("name", WORKED)
def test_a_worked_case_shows_what_its_commands_and_code_print(name: str) -> None:
    """Numbers in bold are results; the others are input, which the files and the code hold."""
    page, said, names = PAGES[DOCS / f"{name}.md"], "", {"__name__": name}
    for file in WORKED[name]:
        shutil.copy(file, file.name)
    for language, block in fenced(page):
        with redirect_stdout(StringIO()) as printed:
            if language == "python":
                exec(compile(block, f"{name}.md", "exec"), names)
            elif language == "console":
                for line in block.splitlines():
                    printed.write(answered(*shlex.split(line)[1:]).output)
        said += printed.getvalue()
    texts = [
        path.read_text(encoding="utf-8") for path in Path().iterdir() if path.suffix in WRITTEN
    ]
    said = as_on_a_screen("\n".join([said, *texts]))
    shown = "".join(blocks(page, "text")).splitlines()
    assert [line for line in shown if as_on_a_screen(line) not in said] == []
    numbers = {
        number for text in re.findall(r"\*\*(.+?)\*\*", page) for number in NUMBER.findall(text)
    }
    assert numbers <= set(NUMBER.findall(said))


@pytest.mark.slow
@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_script_of_the_gallery_draws_pictures_for_a_page(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import matplotlib.pyplot as plt

    lines = path.read_text(encoding="utf-8").splitlines()
    imported = {line.split()[1] for line in lines if re.match("(from|import) stochlin", line)}
    assert imported <= {"stochlin", "stochlin.charts"}
    monkeypatch.chdir(path.parent)  # as the site builds it
    runpy.run_path(str(path))
    stale = [
        each.name
        for each in pictures.shown().get(path, ())
        if pictures.differs(each, pictures.figure_of(each))
    ]
    assert stale == [], "`make docs` draws them"
    assert plt.get_fignums()
    for number in plt.get_fignums():
        figure = plt.figure(number)
        figure.canvas.draw()
        assert max(figure.get_size_inches()) <= 7.2  # the width of a printed page


def test_theory_has_every_equation_of_the_paper_and_its_code() -> None:
    tags = re.findall(r"\\tag\{([\d, ]+)\}", THEORY)
    assert sorted(int(number) for tag in tags for number in tag.split(",")) == list(range(1, 17))
    sections = re.split(r"^## ", THEORY, flags=re.MULTILINE)
    assert not [
        text.splitlines()[0] for text in sections if "\\tag" in text and "(reference/" not in text
    ]


def test_pages_are_written_in_what_the_site_understands_and_name_tests_that_exist() -> None:
    notebooks = {path: path.read_text(encoding="utf-8") for path in ROOT.glob("notebooks/*.ipynb")}
    for path, text in (PAGES | notebooks).items():
        # The site sets an index of a letter with a dot below it, unless an empty group is between
        # them.
        assert not re.search(r"\\d?dot *(\{[^}]*\}|\\*[A-Za-z]+)_", text), path
    for path, text in PAGES.items():
        assert all(tomllib.loads(block) for block in blocks(text, "toml")), path
        for name in re.findall(r"`(?:tests/)?(\w+/test_\w+[^`]*)`", text):
            assert (ROOT / "tests" / name).exists(), name


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
    importlib.util.find_spec("sphinx_gallery") is None, reason="the group 'docs' is not installed"
)
def test_site_builds_without_warnings_and_its_links_lead_somewhere(tmp_path: Path) -> None:
    shutil.copytree(DOCS, "docs", ignore=shutil.ignore_patterns("auto_gallery", "generated"))
    shutil.copytree(ROOT / "notebooks", "notebooks")
    shutil.copy(ROOT / "CHANGELOG.md", ".")
    site = tmp_path / "site"
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "docs", str(site)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    pages = {path: Links(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    reference = (site / "reference" / "index.html").read_text(encoding="utf-8")
    assert not [name for name in sl.__all__ if f"generated/stochlin.{name}." not in reference]
    for path, links in pages.items():
        for target, anchor in links.targets:
            file = (path.parent / target).resolve() if target else path
            assert file.exists(), f"{path.name}: {target}"
            if anchor and file in pages:
                assert anchor in pages[file].anchors, f"{path.name}: {target}#{anchor}"
