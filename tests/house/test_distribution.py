"""What the wheel and the source archive contain; ``make dist`` builds both in ``dist``."""

import re
import subprocess
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

import stochlin as sl

pytestmark = pytest.mark.cli

ROOT = Path(__file__).parents[2]
LEFT_OUT = (".ci/", ".gitignore", "figures/")  # of the source archive
SHOWN = "figures/fig4b.png"  # by the README
RECORDS = (".at2", ".v1", ".v2", ".smc")
SYNTHETIC = "stochlin/applications/cases/example_record.at2"


def built(pattern: str) -> Path:
    """The file in ``dist`` for this version."""
    archives = sorted((ROOT / "dist").glob(f"stochlin-{sl.__version__}{pattern}"))
    if not archives:
        pytest.skip("nothing is built for this version: 'make dist' builds it")
    return archives[-1]


def tracked() -> set[str]:
    command = ["git", "-C", str(ROOT), "ls-files"]
    return set(subprocess.run(command, capture_output=True, text=True, check=True).stdout.split())


def test_the_wheel_is_the_package_with_its_data_and_nothing_else() -> None:
    with zipfile.ZipFile(built("-*.whl")) as wheel:
        names = set(wheel.namelist())
    own = {name for name in names if ".dist-info/" not in name}
    assert own == {name for name in tracked() if name.startswith("stochlin/")}
    kinds = {".nc", ".html", ".css", ".js", ".toml", ".at2", ".typed"}
    assert {Path(name).suffix for name in own} >= kinds
    for name in ("entry_points.txt", "licenses/LICENSE"):
        assert f"stochlin-{sl.__version__}.dist-info/{name}" in names


def test_the_source_archive_has_all_that_the_tests_need_and_no_measured_record() -> None:
    with tarfile.open(built(".tar.gz")) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    wanted = {name for name in tracked() if not name.startswith(LEFT_OUT)} | {SHOWN}
    assert names - {"PKG-INFO", ".gitignore"} == wanted
    assert {name for name in names if name.lower().endswith(RECORDS)} == {SYNTHETIC}


def test_the_version_is_the_same_wherever_it_stands() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    changes = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    date = re.findall(r'^date-released: "(.*)"$', citation, re.MULTILINE)[0]
    assert f"\nversion: {sl.__version__}\n" in citation
    assert f"\n## {sl.__version__} ({date})\n" in changes


def test_the_citation_and_the_package_state_the_same() -> None:
    citation = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    for key in ("cff-version", "message", "title", "authors", "abstract", "license", "keywords"):
        assert re.search(rf"^{key}:", citation, re.MULTILINE), key
    authors = citation[citation.index("\nauthors:") : citation.index("\nkeywords:")]
    assert re.findall(r'name: "(.*)"', authors) == [author["name"] for author in project["authors"]]
    assert f"\nlicense: {project['license']}\n" in citation
    assert project["description"] in citation
