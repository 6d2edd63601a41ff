"""Lengths in inches and feet beside those in centimetres and metres, for cases in these units."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from stochlin.views.shared.blocks import Block, Items, Row, TableBlock, TextBlock, ViewSection
from stochlin.views.shared.words import NBSP, centimetres, number

if TYPE_CHECKING:
    from stochlin.applications.cases.reading.case import Case

AS_WRITTEN = ("title", "file")  # looks of texts that are the user's
CM_PER_INCH = 2.54  # cm
METRES_PER_FOOT = 0.3048  # m
DIGITS = r"\d+(?:\.\d+)?"
LENGTHS = re.compile(rf"(?<![\w.])((?:{DIGITS} (?:to|and) )?{DIGITS})[ {NBSP}](cm|m)(?![\w/²³^])")
UNIT_CM = "[cm]"
UNIT_INCHES = "[in]"
BELOW = "alone"  # name of a row that has the unit of the row above


def inches(metres: float) -> str:
    """A length in inches, with its unit."""
    return f"{_in_inches(str(100 * metres))}{NBSP}in"


def with_inches(case: Case, text: str) -> str:
    """A text with its lengths also in inches and feet, if the case has lengths in these."""
    return LENGTHS.sub(_with_other, text) if case.in_inches else text


def sections_with_inches(case: Case, sections: Sequence[ViewSection]) -> list[ViewSection]:
    """Sections with all lengths also in inches and feet, if the case has lengths in these."""
    if not case.in_inches:
        return [*sections]
    return [
        replace(section, blocks=[_of_block(case, block) for block in section.blocks])
        for section in sections
    ]


def _with_other(lengths: re.Match[str]) -> str:
    """Lengths with the same in the other unit, which is not more exact."""
    if lengths[2] == "cm":
        return f"{lengths[0]} / {_in_inches(lengths[1])}{NBSP}in"
    feet = re.sub(DIGITS, lambda metres: number(float(metres[0]) / METRES_PER_FOOT), lengths[1])
    return f"{lengths[0]} / {feet}{NBSP}ft"


def _in_inches(text: str) -> str:
    """A text with all of its numbers in inches in place of centimetres: tenths, or two digits."""
    return re.sub(DIGITS, lambda length: centimetres(float(length[0]) / CM_PER_INCH / 100), text)


def _of_block(case: Case, block: Block) -> Block:
    if isinstance(block, TextBlock) and block.look not in AS_WRITTEN:
        return replace(block, text=with_inches(case, block.text))
    if isinstance(block, Items):
        return Items([with_inches(case, text) for text in block.texts])
    return _of_table(case, block) if isinstance(block, TableBlock) else block


def _of_table(case: Case, table: TableBlock) -> TableBlock:
    """A table with a column in inches after each in centimetres, and such rows after these rows."""
    heads = [
        twice
        for head in table.heads
        for twice in _twice(head, head, head.replace(UNIT_CM, UNIT_INCHES))
    ]
    rows: list[Row] = []
    group: list[Row] = []  # in inches, below those in centimetres
    for row in table.rows:
        first = with_inches(case, row.cells[0])
        cells = zip(table.heads, [first, *row.cells[1:]], strict=True)
        both = [twice for head, cell in cells for twice in _twice(head, cell, _in_inches(cell))]
        below = bool(group) and first.strip() == BELOW
        if not below:
            rows += group
            group = []
        rows.append(replace(row, cells=both))
        if UNIT_CM in first or below:
            values = (_in_inches(cell) for cell in row.cells[1:])
            group.append(replace(row, cells=[first.replace(UNIT_CM, UNIT_INCHES), *values]))
    return replace(table, heads=heads, rows=[*rows, *group])


def _twice(head: str, cell: str, converted: str) -> list[str]:
    """A cell, and below a head in centimetres what stands beside it."""
    return [cell, converted] if UNIT_CM in head else [cell]
