"""Every example of the page as a file of the package: no test of what is listed or frozen turns red."""

import re
import shutil
from pathlib import Path

import pytest
from commands import process

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

TESTS = Path(__file__).parents[1]
PAGE = TESTS.parent / "docs" / "extending.md"
KIND = re.compile(r"^\| \[[^]]*\]\(#([\w-]+)\).*?`stochlin/([\w/]+)/[`<]", re.MULTILINE)
# What lists extensions, or compares what all of them give with frozen answers.
LISTED = (
    *("rules", "records/test_files.py", "cases/test_codes.py", "separation/test_set_back.py"),
    *("house/test_rooms_and_names.py", "house/test_messages.py", "house/test_copies.py"),
    *("house/test_models_are_values.py", "answers/test_answers.py"),
)
OURS = "not independent and not manual"  # of other programs, and of the page that is made of them


def examples() -> dict[str, str]:
    """The code of the page by the file of the package in which a contributor writes it."""
    page = PAGE.read_text(encoding="utf-8")
    folders = dict(KIND.findall(page))
    files = {}
    for section in re.split(r"^## ", page, flags=re.MULTILINE)[1:]:
        anchor = section.partition("\n")[0].lower().replace(" ", "-")
        code = re.search(r"^```py\n(.*?)^```", section, re.DOTALL | re.MULTILINE)
        if code and anchor in folders:
            place = folders[anchor]
            files["views/added/command.py" if place == "views" else f"{place}/added.py"] = code[1]
    return files


def test_a_package_with_every_example_passes_the_tests_of_what_is_listed(tmp_path: Path) -> None:
    package = tmp_path / "stochlin"
    shutil.copytree(Path(sl.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))
    files = examples()
    assert len(files) >= 8
    for name, code in files.items():
        path = package / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(f'"""An example."""\n\n{code}', encoding="utf-8")
    (package / "views" / "added" / "__init__.py").write_text('"""An example."""\n')
    shutil.copytree(TESTS, tmp_path / "tests", ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("docs", "pyproject.toml", "CITATION.cff", "CHANGELOG.md"):
        source = TESTS.parent / name
        (shutil.copytree if source.is_dir() else shutil.copy)(source, tmp_path / name)
    paths = [str(tmp_path / "tests" / name) for name in LISTED]
    options = "-q", "-p", "no:cacheprovider", "-m", "not slow", "-k", OURS
    places = {"PYTHONPATH": f"{tmp_path}:{tmp_path / 'tests'}", "MPLBACKEND": "agg"}
    done = process(tmp_path, places, "-m", "pytest", *options, *paths)
    assert done.returncode == 0, done.stdout[-3000:]
