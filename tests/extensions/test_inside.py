"""Every example of the page as a file of the package: no test of what is listed or frozen fails."""

import re
import shutil
from pathlib import Path

import pytest
from commands import process
from extending import PAGE, examples

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

TESTS = Path(__file__).parents[1]
KIND = re.compile(r"^\| \[[^]]*\]\(#([\w-]+)\).*?`stochlin/([\w/]+)/[`<]", re.MULTILINE)
# What lists extensions, or compares what all of them give with frozen answers.
LISTED = (
    *("rules", "records/test_files.py", "cases/test_codes.py", "separation/test_set_back.py"),
    *("house/test_rooms_and_names.py", "house/test_messages.py", "house/test_copies.py"),
    *("house/test_models_are_values.py", "linearization/test_peaks.py", "answers/test_answers.py"),
)
OURS = "not independent and not manual"  # of other programs, and of the page that is made of them


def files() -> dict[str, str]:
    """The code of the page by the file of the package in which a contributor writes it."""
    folders = {anchor.replace("-", " "): place for anchor, place in KIND.findall(PAGE.read_text())}
    code = {title.lower(): text for title, text in examples().items()}
    assert code.keys() >= folders.keys()
    return {
        "views/added/command.py" if place == "views" else f"{place}/added.py": code[title]
        for title, place in folders.items()
    }


def test_the_page_has_an_example_for_every_registry() -> None:
    """As a link in its row, which `KIND` finds."""
    rows = re.findall(r"^\| .*? \| `stochlin\..*$", PAGE.read_text(), re.MULTILINE)
    assert len(rows) == len(files()) >= 11


def test_a_package_with_every_example_passes_the_tests_of_what_is_listed(tmp_path: Path) -> None:
    package = tmp_path / "stochlin"
    shutil.copytree(Path(sl.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    for name, code in files().items():
        path = package / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'"""An example."""\n\n{code}', encoding="utf-8")
    shutil.copytree(TESTS, tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("docs", "pyproject.toml", "CITATION.cff", "CHANGELOG.md"):
        source = TESTS.parent / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, tmp_path / name)
    paths = [str(tmp_path / "tests" / name) for name in LISTED]
    options = "-q", "-p", "no:cacheprovider", "-m", "not slow", "-k", OURS
    places = {"PYTHONPATH": f"{tmp_path}:{tmp_path / 'tests'}", "MPLBACKEND": "agg"}
    done = process(tmp_path, places, "-m", "pytest", *options, *paths)
    assert done.returncode == 0, done.stdout[-3000:]
