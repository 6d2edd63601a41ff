"""Numbers in words are those that are computed."""

import itertools
import re

import pytest
from cases import with_slow
from house import claims

pytestmark = pytest.mark.cli
ELSEWHERE, ASSUMED = "code", "given"  # the first: test_docs.py
LONG = {
    "bias",
    "stationary",
    "motions",
    "crossings",
    "methods",
    "calculator",
    "hard_cautions",
    "example",
    "finite",
}
SOURCES = {source for sources in claims.CLAIMS.values() for source in sources} - {ELSEWHERE}
PAGES = [file for file, sources in claims.CLAIMS.items() if ASSUMED in sources]


@pytest.mark.extreme  # dampers and peaks of scans
@pytest.mark.parametrize("source", with_slow(sorted(SOURCES), LONG))
def test_numbers_in_words_are_computed(source: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    names = getattr(claims, source)()
    missing = {file: claims.missing(file, source, names) for file in claims.CLAIMS}
    assert {file: words for file, words in missing.items() if words} == {}


@pytest.mark.parametrize("file", PAGES)
def test_every_percentage_and_length_in_the_prose_of_a_page_is_claimed(file: str) -> None:
    text = (claims.ROOT / file).read_text(encoding="utf-8")
    prose = claims.plain(re.sub(r"^```.*?^```$|^\|.*?$", "", text, flags=re.DOTALL | re.MULTILINE))
    for words in itertools.chain.from_iterable(claims.CLAIMS[file].values()):
        parts = [re.escape(part) for part in re.split(r"\{.*?\}", claims.plain(words))]
        if any(parts):
            prose = re.sub(".{1,25}?".join(parts), "", prose)
    assert re.findall(r"(?:\S+ ){4}[\d.)]+ (?:%|cm|mm)(?!\w)", prose) == []
