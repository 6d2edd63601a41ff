"""The cases of the documentation: they run as printed, and the pages show what they print."""

import html
import re
import shlex
import shutil
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from typing import NamedTuple

import pytest
import xarray as xr
from commands import answered

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

DOCS = Path(__file__).parents[2] / "docs"
CASE = DOCS / "worked_case.toml"
# Files, the page for the file, and the least numbers of blocks and of numbers in bold.
CASES = {
    "worked_case": ([CASE], "worked_case.html", 7, 20),
    "from_tables": (sorted((DOCS / "from_tables").iterdir()), "case.html", 4, 3),
}
NUMBER = r"\d+\.?\d*"


def blocks(page: str, languages: str) -> list[str]:
    return re.findall(rf"^```({languages})\n(.*?)^```", page, re.DOTALL | re.MULTILINE)


def plain(text: str) -> str:
    """One line without the ends of lines, marks and the signs of a page that a screen has not."""
    text = re.sub(r"</?(?:i|sub|sup)>", "", text.replace("<sup>", "^"))
    text = html.unescape(re.sub(r"<[^>]+>", " ", text)).replace("m²/s³", "m^2/s^3")
    return " ".join(text.split())


@pytest.fixture(scope="module", autouse=True)
def one_fit() -> Iterator[None]:
    """Every command fits the same ground to the same spectrum, which takes longer than the rest."""
    fits: dict[str, object] = {}

    def fit(spectrum: xr.DataArray, **motion: object) -> object:
        key_of_fit = repr(
            (spectrum.to_dict(), sorted((key, motion[key]) for key in motion if motion[key]))
        )
        if key_of_fit not in fits:
            fits[key_of_fit] = sl.fit_ground(spectrum, **motion)
        return fits[key_of_fit]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("stochlin.applications.cases.reading.site.fit_ground", fit)
        yield


class Shown(NamedTuple):
    """A page of the documentation, and all that its commands and code print, in their order."""

    name: str
    page: str
    printed: str


@pytest.fixture(scope="module", params=CASES)
def shown(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Shown:
    """With the files of the case, which engineers have, and the page that is written."""
    name = request.param
    page = (DOCS / f"{name}.md").read_text(encoding="utf-8")
    folder = tmp_path_factory.mktemp(name)
    files, written, *_ = CASES[name]
    said: list[str] = []
    for file in files:
        shutil.copy(file, folder)
        said.append(file.read_text(encoding="utf-8"))
    names: dict[str, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("MPLBACKEND", "agg")
        for language, block in blocks(page, "python|console"):
            if language == "console":
                said += [answered(*shlex.split(line)[1:]).output for line in block.splitlines()]
            else:
                with redirect_stdout(StringIO()) as out:
                    exec(compile(block, f"{name}.md", "exec"), names)
                said.append(out.getvalue())
    said.append((folder / written).read_text(encoding="utf-8"))
    return Shown(name, page, plain("\n".join(said)))


def test_the_page_shows_what_is_printed(shown: Shown) -> None:
    texts = [block for _, block in blocks(shown.page, "text")]
    assert len(texts) >= CASES[shown.name][2]
    missing = [line for text in texts for line in text.splitlines() if plain(line) not in shown.printed]
    assert not missing


def test_every_number_of_the_text_is_printed(shown: Shown) -> None:
    """Those in bold are results; the others are input, which the case file and the code hold."""
    bold = [
        number
        for text in re.findall(r"\*\*(.+?)\*\*", shown.page)
        for number in re.findall(NUMBER, text)
    ]
    assert len(bold) >= CASES[shown.name][3]
    assert set(bold) <= set(re.findall(NUMBER, shown.printed))


def test_the_file_takes_the_spreads_of_the_page(tmp_path: Path) -> None:
    text = CASE.read_text(encoding="utf-8")
    page = (DOCS / "worked_case.md").read_text(encoding="utf-8")
    ((_, spread),) = blocks(page, "toml")
    for line in spread.splitlines():
        if "=" in line:
            text, count = re.subn(rf"^{line.split()[0]} = .*$", line, text, flags=re.MULTILINE)
            assert count == 1, line
    (tmp_path / "spread.toml").write_text(text, encoding="utf-8")
    case = sl.read_case(tmp_path / "spread.toml")
    assert list(case.uncertain) == ["Clinic", "Extension"]
