"""Sections of blocks: the screen and the page say the same, each in its own way."""

from __future__ import annotations

import html
import re

import pytest
from matplotlib.figure import Figure

from stochlin.views.shared.blocks import Items, Picture, Row, TableBlock, TextBlock, ViewSection
from stochlin.views.shared.page import page
from stochlin.views.shared.screen import lines

pytestmark = pytest.mark.cli
SECTIONS = [
    ViewSection("", [TextBlock("", "doubt"), TextBlock("Block & annex", "title")]),
    ViewSection(
        "Nothing here", [TextBlock(""), Items([]), TableBlock.of(("rule", "gap [cm]"), [])]
    ),
    ViewSection(
        "The rules",
        [
            TableBlock(
                ("rule", "gap [cm]", "verdict"),
                [
                    Row(("srss", "9.5", "safe"), label="1 SRSS"),
                    Row(("sum", "12.0", "within error")),
                ],
                words=("verdict",),
            ),
            TextBlock("The gap depends on rho.", "note"),
            Items(["one", "two"]),
        ],
    ),
    ViewSection("On paper", [TextBlock("height 9.6 m")], on_screen=False),
    ViewSection("On screens", [TextBlock("needs zone")], on_page=False),
]


def test_the_screen_has_a_line_between_sections_and_around_tables() -> None:
    assert lines(SECTIONS) == [
        "Block & annex",
        "",
        "The rules:",
        "",
        "rule  gap [cm]  verdict",
        "srss       9.5  safe",
        "sum       12.0  within error",
        "",
        "The gap depends on rho.",
        "  one",
        "  two",
        "",
        "On screens:",
        "needs zone",
    ]


def test_a_table_that_is_hardly_too_wide_moves_together() -> None:
    cells = ("a" * 33, "b" * 33, "c" * 32)
    (line,) = (
        line for line in lines([ViewSection("", [TableBlock.of("xyz", [cells])])]) if "b" in line
    )
    assert line == " ".join(cells)


def test_columns_are_as_wide_as_their_signs_are_on_the_screen() -> None:
    rows = [("S0", "0.01 m²/s³", "1"), ("T", "0.5 s", "2")]
    *_, first, second = lines([ViewSection("", [TableBlock.of("abc", rows, ("b",))])])
    assert first.index("1", 8) == second.index("2")


def test_the_page_has_the_same_and_leaves_out_what_is_empty() -> None:
    text = page("A title", SECTIONS, ["foot"], ["annex"])
    body = text.partition("<main>")[2]
    words = " ".join(html.unescape(re.sub("<[^>]+>", " ", body)).split())
    for part in (
        "Block & annex",
        "1 SRSS 9.5 safe",
        "sum 12.0 within error",
        "height 9.6 m",
        "foot",
    ):
        assert part in words
    assert "depends on <i>ρ</i>" in body
    assert "Gap [cm]" in words
    for absent in ("Nothing here", "On screens", "needs zone", 'class="doubt"'):
        assert absent not in body


def test_pictures_are_within_the_page_with_their_words() -> None:
    text = page("A title", [ViewSection("Pictures", [Picture("Gaps", "By rule.", Figure)] * 2)], [])
    assert text.count('aria-label="Gaps. By rule."') == 2
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))
