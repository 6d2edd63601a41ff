"""The worked case of the documentation: it runs as printed, and the page shows what it prints."""

import html
import re
import shlex
import shutil
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest
import xarray as xr
from commands import answered

import stochlin as sl

pytestmark = [pytest.mark.cli, pytest.mark.slow]

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "worked_case.md").read_text(encoding="utf-8")
CASE = DOCS / "worked_case.toml"
NUMBER = r"\d+\.?\d*"
RUN = re.findall(r"^```(python|console)\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)


def plain(text: str) -> str:
    """One line without the ends of lines, marks and the signs of a page that a screen has not."""
    text = re.sub(r"</?(?:i|sub|sup)>", "", text.replace("<sup>", "^"))
    text = html.unescape(re.sub(r"<[^>]+>", " ", text)).replace("m²/s³", "m^2/s^3")
    return " ".join(text.split())


@pytest.fixture(scope="module", autouse=True)
def one_fit() -> Iterator[None]:
    """Every command fits the same ground to the same spectrum, which takes longer than the rest."""
    found: dict[str, object] = {}

    def fit(spectrum: xr.DataArray, **motion: object) -> object:
        given = repr((spectrum.to_dict(), sorted((key, motion[key]) for key in motion if motion[key])))
        if given not in found:
            found[given] = sl.fit_ground(spectrum, **motion)
        return found[given]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("stochlin.analyses.cases.sites.design_spectrum.fit_ground", fit)
        yield


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> str:
    """All that commands and code of the page print, in its order, and the page that is written."""
    folder = tmp_path_factory.mktemp("worked_case")
    shutil.copy(CASE, folder)
    said: list[str] = []
    names: dict[str, object] = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setenv("MPLBACKEND", "agg")
        for language, block in RUN:
            if language == "console":
                result = answered(*shlex.split(block)[1:])
                said.append(result.output)
            else:
                with redirect_stdout(StringIO()) as out:
                    exec(compile(block, "worked_case.md", "exec"), names)
                said.append(out.getvalue())
    said.append((folder / "worked_case.html").read_text(encoding="utf-8"))
    return plain("\n".join(said))


def test_the_page_shows_what_is_printed(printed: str) -> None:
    blocks = re.findall(r"^```text\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    assert len(blocks) >= 7
    missing = [line for block in blocks for line in block.splitlines() if plain(line) not in printed]
    assert not missing


def test_every_number_of_the_text_is_printed(printed: str) -> None:
    """Those in bold are results; the others are input, which the case file and the code hold."""
    bold = [one for text in re.findall(r"\*\*(.+?)\*\*", PAGE) for one in re.findall(NUMBER, text)]
    assert len(bold) >= 20
    assert set(bold) <= set(re.findall(NUMBER, printed))


def test_the_file_takes_the_spreads_of_the_page(tmp_path: Path) -> None:
    text = CASE.read_text(encoding="utf-8")
    (spread,) = re.findall(r"^```toml\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    for line in spread.splitlines():
        if "=" in line:
            text, found = re.subn(rf"^{line.split()[0]} = .*$", line, text, flags=re.MULTILINE)
            assert found == 1, line
    (tmp_path / "spread.toml").write_text(text, encoding="utf-8")
    assert list(sl.read_case(tmp_path / "spread.toml").uncertain) == ["Clinic", "Extension"]
