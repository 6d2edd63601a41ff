"""The report of OpenSees' command ``modalProperties``, with the floors below it."""

from __future__ import annotations

import re
import warnings
from collections.abc import Sequence
from typing import ClassVar, NamedTuple

import numpy as np

from stochlin.analyses.buildings.mode_files.base import (
    LEAST_SHARE,
    MODE_FILES,
    AskedModes,
    ModeFile,
    ModesOfFile,
    chosen_direction,
)
from stochlin.analyses.buildings.sheets import Sheet, SheetRow, with_unit
from stochlin.analyses.buildings.units import size_stated
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput, brief, listed
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Range

REPORT = "# MODAL ANALYSIS REPORT"
SIZE, PERIODS, TOTAL = "DOMAIN SIZE", "EIGENVALUE ANALYSIS", "TOTAL FREE MASS OF THE STRUCTURE"
FACTORS, MASSES, FLOORS = "MODAL PARTICIPATION FACTORS", "MODAL PARTICIPATION MASSES", "FLOORS"
BY_HAND = "'* FLOORS:', '# LEVEL[m] MASS[kg] MODE-1 ...' and a line for each floor, as the manual shows"
UNLIKE = 0.02  # largest difference of masses that should be the same, as a share of the whole
_BLOCK = re.compile(r"\*\s*(?:\d+\.\s*)?(.*?)\s*:?\s*$")


class Report(NamedTuple):
    """One block of the report: its titles, and its lines of numbers."""

    titles: SheetRow
    rows: list[SheetRow]

    def column(self, title: str) -> int:
        """Number of the column of this title."""
        if title not in self.titles.cells:
            raise self.titles.error(None, f"there is no column {title}; allowed: a report of OpenSees")
        return self.titles.cells.index(title)

    def numbers(self, title: str, allowed: Range | None = None) -> Array:
        """The numbers of a column."""
        column = self.column(title)
        return np.array([row.number(column, title, allowed) for row in self.rows])


@MODE_FILES.register("opensees", 3)
class OpenSeesModes(ModeFile):
    """What ``modalProperties('-file', 'tower.txt')`` writes, followed by a block with the floors.

    The report has no shapes and no units. The block is written by the model's script, of one node on
    each floor: its level, the mass of the floor, and what ``nodeEigenvector`` returns for each mode::

        * FLOORS:
        # LEVEL[m] MASS[kg] MODE-1 MODE-2
        3.5 200000 0.62 -1.61
        7.0 200000 1.0 1.0

    The time unit of the model is taken to be the second. Participation factors are those of the
    eigenvectors as they are stored, so that the report is printed without ``-unorm``.

    References
    ----------
    OpenSees documentation, ``modalProperties`` command; the report is written by
    ``DomainModalProperties::print`` of its source, SRC/domain/domain/DomainModalProperties.cpp.
    """

    header: ClassVar[str] = f"'{REPORT}' of OpenSees"
    takes: ClassVar[Sequence[str]] = ("direction", "mass_units", "length_units")

    @staticmethod
    def recognizes(sheets: Sequence[Sheet]) -> bool:
        """Whether the first line is that of the report."""
        return " ".join(sheets[0][0].cell(0).split()) == REPORT

    @staticmethod
    def read(sheets: Sequence[Sheet], asked: AskedModes) -> ModesOfFile:
        """The modes of the report and of the floors below it."""
        blocks = _blocks(sheets[0])
        size = _block(blocks, SIZE).rows[0].number(0, "domain size")
        known = dict.fromkeys(("UX", "UY", "UZ") if size == 3 else ("UX",))
        axis = chosen_direction(asked, known, "the report").replace("U", "M")
        floors = _block(blocks, FLOORS)
        levels, masses, shapes, mass_size = _floors(floors, asked)
        total = mass_size * float(_block(blocks, TOTAL).numbers(axis, POSITIVE)[0])
        if abs(masses.sum() - total) > UNLIKE * total:
            raise floors.titles.error(
                1,
                f"the floors have {masses.sum() / total:.1%} of the total free mass of the report; "
                "allowed: all floors, with all their mass",
            )
        periods = _block(blocks, PERIODS).numbers("PERIOD", POSITIVE)
        modal = mass_size * _block(blocks, MASSES).numbers(axis, NOT_NEGATIVE)
        factors = _block(blocks, FACTORS).numbers(axis)
        if not periods.size == modal.size == factors.size == len(shapes):
            raise floors.titles.error(
                None,
                f"{len(shapes)} modes of the floors and {periods.size} of the report; allowed: the same",
            )
        moving = modal >= LEAST_SHARE * total
        numbers = np.arange(1, periods.size + 1)
        apart = np.abs(factors * (shapes @ masses) - modal)[moving] > UNLIKE * total
        if apart.any():
            told = listed(numbers[moving][apart])
            warnings.warn(
                f"{floors.titles.where}: the shapes of mode {told} times the participation factors of "
                "the report do not give its modal masses; right for an edge of a building that turns, "
                "else print the report without -unorm",
                DoubtfulInput,
                stacklevel=4,
            )
        return ModesOfFile(
            numbers[moving].tolist(),
            periods[moving],
            shapes[moving],
            masses,
            levels,
            factors[moving],
            modal[moving],
            numbers[~moving].tolist(),
        )


def _blocks(sheet: Sheet) -> dict[str, Report]:
    """The blocks by their names; the titles of a block are its last comment before the numbers."""
    blocks: dict[str, Report] = {}
    name = ""
    for row in sheet:
        words = " ".join(row.cells)
        if match := _BLOCK.match(words):
            name = match[1].upper()
            blocks[name] = Report(SheetRow(row.where, ()), [])
            continue
        cells = tuple(words.removeprefix("#").split())
        if name and not words.startswith("#"):
            blocks[name].rows.append(SheetRow(row.where, cells))
        elif name and set(words) - set("#- "):
            blocks[name] = blocks[name]._replace(titles=SheetRow(row.where, cells))
    return blocks


def _block(blocks: dict[str, Report], name: str) -> Report:
    """The block of this name; a ValueError if it is missing or has no numbers."""
    if name in blocks and blocks[name].rows:
        return blocks[name]
    last = next(reversed(blocks.values())).titles if blocks else SheetRow("the file", ())
    cure = f"write {BY_HAND}" if name == FLOORS else "print the report again, whole"
    raise last.error(None, f"block {brief(name)} is missing after this one; {cure}")


def _floors(block: Report, asked: AskedModes) -> tuple[Array, Array, Array, float]:
    """Levels [m], masses [kg] and shapes (modes, floors), and the unit of the masses in SI."""
    titles = block.titles
    names = [with_unit(title) for title in titles.cells]
    if [name for name, _ in names[:2]] != ["level", "mass"] or len(names) < 3:
        raise titles.error(None, f"these are not the titles of the floors; allowed: {BY_HAND}")
    sizes = [
        size_stated(quantity, unit, asks, f"{titles.where}, column {column}")
        for column, (quantity, (_, unit), asks) in enumerate(
            zip(("length", "mass"), names[:2], (asked.length_units, asked.mass_units), strict=True), 1
        )
    ]
    for row in block.rows:
        if len(row.cells) != len(names):
            raise row.error(None, f"{len(row.cells)} numbers for {len(names)} titles; allowed: as many")
    levels, masses = (
        size * np.array([row.number(column, name, POSITIVE) for row in block.rows])
        for column, (name, size) in enumerate(zip(("level", "mass"), sizes, strict=True))
    )
    shapes = [[row.number(n, "shape") for row in block.rows] for n in range(2, len(names))]
    return levels, masses, np.array(shapes), sizes[1]
