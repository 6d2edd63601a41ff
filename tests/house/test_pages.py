"""Any Markdown viewer shows pages: links, pictures and anchors exist, and what the code says."""

import json
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

import pytest
from answers import pages
from house import pictures
from house.claims import ROOT
from PIL import Image

import stochlin as sl

pytestmark = pytest.mark.cli
DOCS = ROOT / "docs"
MADE = [DOCS / name for name in ("auto_gallery", "notebooks", "reference/generated")]  # by the site
AT_ROOT = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")]
FILES = [*AT_ROOT, *(page for page in sorted(DOCS.rglob("*.md")) if not {*MADE} & {*page.parents})]
LINK = re.compile(r"!?\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^()\s]+)\)")
CODE = re.compile(r"`[^`\n]+`")
WHOLE = re.compile(r"^(```+).*?^\1$", re.DOTALL | re.MULTILINE)
# Only the site understands these: roles, directives, fences with colons, labels.
OF_THE_SITE = re.compile(r"\{[\w:+-]+\}`|^ *```+ *\{|^:::|^\([\w-]+\)=$|^\.\. ", re.MULTILINE)


class Place(NamedTuple):
    """Something in a page."""

    file: Path
    line: int
    text: str

    def __str__(self) -> str:
        return f"{self.file.name}, line {self.line}: {self.text}"


def blanked(text: str, *patterns: str | re.Pattern[str]) -> str:
    """Without what a pattern matches, its lines left so that those below have their numbers."""
    for pattern in patterns:
        text = re.sub(pattern, lambda match: "\n" * match[0].count("\n"), text)
    return text


def places(file: Path, text: str, pattern: re.Pattern[str]) -> Iterator[Place]:
    for match in pattern.finditer(text):
        line = text.count("\n", 0, match.start(match.lastindex or 0)) + 1
        yield Place(file, line, match[match.lastindex or 0])


def anchors(text: str) -> set[str]:
    """Those of headings, as code hosts make them: no sign but hyphens; a number after the first."""
    seen: Counter[str] = Counter()
    made = set()
    for heading in re.findall(r"^#{1,6} +(.+?) *$", blanked(text, WHOLE), re.MULTILINE):
        words = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        anchor = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        made.add(f"{anchor}-{seen[anchor]}" if seen[anchor] else anchor)
        seen[anchor] += 1
    return made


def dead(file: Path, text: str) -> list[str]:
    """Links of a page to files or headings that are not in the repository."""
    return [
        str(link)
        for link in places(file, blanked(text, WHOLE, CODE), LINK)
        if not leads(link, text)
    ]


def leads(link: Place, text: str) -> bool:
    """Whether a link of a page with this text leads to what the repository has."""
    target, _, anchor = unquote(link.text).partition("#")
    if re.match(r"[a-z]+:", target):
        return True
    page = (link.file.parent / target).resolve()
    if target and (not page.exists() or {*MADE} & {*page.parents} or ROOT not in page.parents):
        return False
    return not anchor or anchor in anchors(page.read_text(encoding="utf-8") if target else text)


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_every_link_picture_and_anchor_of_a_page_exists(file: Path) -> None:
    assert dead(file, file.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(ROOT)))
def test_a_page_is_plain_markdown(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert [str(place) for place in places(file, text, OF_THE_SITE)] == []
    # A formula within a line of text ends in the same line: some viewers show it as text otherwise.
    prose = blanked(text, WHOLE, re.compile(r"^\$\$$.*?^\$\$$", re.DOTALL | re.MULTILINE), CODE)
    lines = enumerate(prose.splitlines(), 1)
    assert [f"{file.name}, line {number}" for number, line in lines if line.count("$") % 2] == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("A [page](nowhere.md).", "line 1: nowhere.md"),
        ("One line.\n\n![A picture\nof it](pictures/none.png)", "line 4: pictures/none.png"),
        (
            "```\n[code](none.md)\n```\n[a heading](theory.md#of-nothing)",
            "line 4: theory.md#of-nothing",
        ),
        ("# Here\n[there](#there)", "line 2: #there"),
        ("[what only the site has](auto_gallery/index.rst)", "line 1: auto_gallery/index.rst"),
    ],
)
def test_a_link_that_leads_nowhere_is_named_with_its_line(text: str, place: str) -> None:
    assert dead(DOCS / "page.md", text) == [f"page.md, {place}"]


def test_links_that_lead_somewhere_are_not_named() -> None:
    headings = (
        "# A `b` [c](index.md)\n# A b c\n[x](#a-b-c) [y](#a-b-c-1) [out](https://example.org)\n"
    )
    links = "[`mitigate`](reference/index.md#mitigate) `[w](none.md)` ![p](pictures/explorer.png)"
    assert dead(DOCS / "page.md", headings + links) == []


def test_pages_show_what_the_code_says() -> None:
    stale = [
        f"{block.page.relative_to(ROOT)}, line {block.line}: {block.what} is stale, "
        "see `make answers`"
        for block in pages.blocks()
        if block.shown != block.now
    ]
    assert stale == []


def test_a_stale_part_of_a_page_is_written_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = tmp_path / "docs" / "page.md"
    page.parent.mkdir()
    page.write_text(
        "Words.\n\n<!-- keys: motion -->\nold\n<!-- end of keys -->\n\nMore.\n", encoding="utf-8"
    )
    monkeypatch.setattr(pages, "DOCS", page.parent)
    (block,) = pages.blocks()
    assert (block.line, block.what, block.shown) == (3, "keys: motion", "old\n")
    assert list(pages.rewritten()) == ["docs/page.md: written"]
    assert list(pages.rewritten()) == []
    text = page.read_text(encoding="utf-8")
    assert text.startswith("Words.\n\n<!-- keys: motion -->\n\n| key |")
    assert text.endswith("|\n\n<!-- end of keys -->\n\nMore.\n")


def test_the_reference_has_every_public_name_below_its_heading() -> None:
    text = (DOCS / "reference" / "index.md").read_text(encoding="utf-8")
    parts = re.split(r"^## (.*)\n", text, flags=re.MULTILINE)[1:]
    shown = dict(zip(parts[::2], parts[1::2], strict=True))
    listed = {
        heading: re.findall(r"^### (.+)$", part, re.MULTILINE) for heading, part in shown.items()
    }
    assert listed == pages.sections()
    names = {name.partition(".")[0] for names in listed.values() for name in names}
    assert names == {*sl.__all__}
    # Two names with one anchor could not both be linked to.
    anchored = [re.sub(r"\.", "", name).lower() for names in listed.values() for name in names]
    assert not {*anchored} & {heading.lower() for heading in listed}
    assert len({*anchored}) == len(anchored)


def test_pictures_of_the_pages_are_small_and_all_are_shown() -> None:
    drawn = {picture for of_script in pictures.shown().values() for picture in of_script}
    assert {*pictures.PICTURES.iterdir()} == drawn | {pictures.PICTURES / "explorer.png"}
    for picture in pictures.PICTURES.iterdir():
        assert picture.stat().st_size <= pictures.LARGEST, picture.name
    for picture in drawn:
        with Image.open(picture) as image:
            assert json.loads(image.info[pictures.SUMMARY]), picture.name


def test_a_picture_is_compared_by_what_it_shows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    import matplotlib.pyplot as plt

    figure, panel = plt.subplots()
    (line,) = panel.plot([1.0, 2.0, 4.0], [1.0, 3.0, float("nan")])
    panel.set_title("period")
    picture = tmp_path / "a_1.png"
    assert pictures.differs(picture, figure)
    pictures.write(picture, figure)
    assert not pictures.differs(picture, figure)
    line.set_ydata([1.0, 3.0 * (1 + 1e-5), float("nan")])
    assert not pictures.differs(picture, figure)
    line.set_ydata([1.0, 3.1, float("nan")])
    assert pictures.differs(picture, figure)
    line.set_ydata([1.0, 3.0, float("nan")])
    panel.set_title("frequency")
    assert pictures.differs(picture, figure)
    plt.close(figure)
