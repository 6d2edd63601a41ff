"""What was removed is named by no text, and whoever still uses it reads what to use instead."""

import inspect
import re
from pathlib import Path

import pytest
from cases import example_case
from commands import refused

import stochlin as sl
from stochlin.models.arguments import OneOf, checked
from stochlin.removed import REMOVED
from stochlin.views.command import NAMES_IN_REFUSAL

pytestmark = pytest.mark.invariant

ROOT = Path(sl.__file__).parents[1]
# Those that are no words of the language, and no names of a public submodule.
STILL = {*dir(sl.rules), *dir(sl.charts)}
LISTS = "CHANGELOG.md", "removed.toml"  # which name it
NAMES = {name for name in REMOVED.keys() - STILL if not re.fullmatch("[a-z]+", name)}


@pytest.fixture(autouse=True)
def gone(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("gone", "--gone"):
        monkeypatch.setitem(REMOVED, name, "the gap says it")


def texts() -> dict[str, str]:
    """All that a user may read: pages, notebooks, examples, docstrings of public names."""
    patterns = ("*.md", "docs/*.md", "docs/gallery/*.py", "notebooks/*.ipynb", "stochlin/**/*.toml")
    paths = [path for pattern in patterns for path in ROOT.glob(pattern) if path.name not in LISTS]
    read = {str(path.relative_to(ROOT)): path.read_text(encoding="utf-8") for path in paths}
    return read | {name: inspect.getdoc(getattr(sl, name)) or "" for name in sl.__all__}


def test_no_text_names_what_was_removed() -> None:
    assert all(re.fullmatch(r"[\w-]+", name) for name in NAMES)
    named = {place: NAMES & set(re.findall(r"[\w-]+", text)) for place, text in texts().items()}
    assert {place: names for place, names in named.items() if names} == {}


def test_no_public_name_is_among_them() -> None:
    assert not REMOVED.keys() & set(sl.__all__)


def test_python_says_what_to_use_instead() -> None:
    with pytest.raises(
        AttributeError, match="no attribute 'gone'; it was removed: the gap says it"
    ):
        _ = sl.gone  # type: ignore[attr-defined]
    with pytest.raises(AttributeError, match=r"charts' has no attribute 'gone'; it was removed"):
        _ = sl.charts.gone
    with pytest.raises(AttributeError, match="KanaiTajimi has no attribute 'gone'; it was removed"):
        _ = sl.KanaiTajimi.gone  # type: ignore[attr-defined]
    with pytest.raises(
        TypeError, match="KanaiTajimi: gone is no argument; it was removed: the gap"
    ):
        sl.KanaiTajimi(1.0, 0.6, gone=1)
    with pytest.raises(
        TypeError,
        match="named: gone is no argument; it was removed: the gap says it; allowed: depth",
    ):
        checked(named)(gone=1)
    with pytest.raises(TypeError, match="named: dept is no argument; did you mean 'depth'"):
        checked(named)(dept=1)
    with pytest.raises(ValueError, match="closure = 'gone' is not known; it was removed: the gap"):
        OneOf(("gaussian",))("closure", "gone")


def named(depth: float) -> float:
    return depth


def test_command_line_and_case_files_say_what_to_use_instead(tmp_path: Path) -> None:
    said = "; it was removed: the gap says it"
    assert f"No such command 'gone'{said}" in refused("gone")
    assert said in refused("gap", "--gone")
    pair = ("--period-1", "1s", "--period-2", "2s", "--hardening", 0.1, "--reduction-factor", 4)
    chosen = refused("rho", *pair, "--closure", "gone")
    assert (
        "--closure 'gone' is not available for Bilinear; it was removed: the gap says it" in chosen
    )
    written = "; was 'gone' = 'gone'?"
    assert NAMES_IN_REFUSAL.findall(written) == ["gone"]  # not the value, which the key may know
    case = tmp_path / "case.toml"
    case.write_text(example_case().replace("[site]", "[site]\ngone = 1"), encoding="utf-8")
    assert (
        "site.gone = 1 is not a key that is known here; it was removed: the gap says it"
        in refused("gap", case)
    )
