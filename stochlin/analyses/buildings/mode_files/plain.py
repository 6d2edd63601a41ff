"""A table of modes in stochlin's own plain form."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from typing import ClassVar

import numpy as np

from stochlin.analyses.buildings.mode_files.base import (
    MODE_FILES,
    MODE_NUMBERS,
    AskedModes,
    ModeFile,
    ModesOfFile,
)
from stochlin.analyses.buildings.sheets import Sheet, SheetRow, with_unit, without_comments
from stochlin.analyses.buildings.units import size_stated
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.parameters import PERIODS, POSITIVE, Range

MODE, LEVEL, MASS, PERIOD = "mode", "level", "mass", "period"
FACTOR, MODAL_MASS = "participation", "modal mass"
FIRST = 2  # column of the first mode, from 0: before it are level and mass
EXAMPLE = files(__package__).joinpath("example_modes.csv").read_text(encoding="utf-8")
SECONDS = ("s", "sec")
FLOORS = "titles 'level [m]', 'mass [kg]' and 'shape' for each mode, and below a line for each floor"


@MODE_FILES.register("plain", 1)
class PlainModes(ModeFile):
    """A line of mode numbers and one of periods, then a line for each floor.

    The first two columns are the level and the mass of a floor; each further column is a mode::

        mode,,1,2
        period [s],,0.5,0.18
        level [m],mass [t],shape,shape
        7,200,1,1
        3.5,200,0.62,-1.61

    Floors may be in any order, since levels are those above the ground. Lines ``participation`` and
    ``modal mass [t]`` may follow the periods. Text after # in the first column is a comment.
    """

    header: ClassVar[str] = "a line 'mode,,1,2', the plain form"
    takes: ClassVar[Sequence[str]] = ("mass_units", "length_units")

    @staticmethod
    def buildings(sheets: Sequence[Sheet]) -> Sequence[Sequence[Sheet]]:
        """Each sheet whose first line that is no comment begins with 'mode'."""
        contents = map(without_comments, sheets)
        return [[rows] for rows in contents if rows and rows[0].cell(0).lower() == MODE]

    @staticmethod
    def read(sheets: Sequence[Sheet], asked: AskedModes) -> ModesOfFile:
        """The modes of the only sheet."""
        rows = sheets[0]
        at = next((n for n, row in enumerate(rows) if with_unit(row.cell(0))[0] == LEVEL), None)
        if at in (None, len(rows) - 1):
            raise rows[-1].error(None, f"the floors are missing; allowed: {FLOORS}")
        head, titles, floors = rows[:at], rows[at], rows[at + 1 :]
        count = len(head[0].cells) - FIRST
        numbers = _over_modes(head[0], count, "mode number", MODE_NUMBERS)
        if (np.diff(numbers, prepend=0) < 1).any() or (numbers % 1).any():
            raise head[0].error(None, "mode numbers are not 1, 2 and so on; allowed: increasing ones")
        lines = _lines(head[1:])
        if PERIOD not in lines:
            raise head[-1].error(0, "the periods are missing below; allowed: a line 'period [s]'")
        if (unit := with_unit(lines[PERIOD].cell(0))[1].lower()) not in SECONDS:
            raise lines[PERIOD].error(0, f"periods are in {brief(unit)}; allowed: 'period [s]'")
        if with_unit(titles.cell(1))[0] != MASS:
            raise titles.error(1, f"{brief(titles.cell(1))} is not the title of the masses; {FLOORS}")
        level_size = _size(titles, 0, "length", asked.length_units)
        mass_size = _size(titles, 1, "mass", asked.mass_units)
        factors, modal = lines.get(FACTOR), lines.get(MODAL_MASS)
        return ModesOfFile(
            numbers.astype(int).tolist(),
            _over_modes(lines[PERIOD], count, PERIOD, PERIODS),
            np.array([_over_modes(row, count, "shape") for row in floors]).T,
            mass_size * np.array([row.number(1, MASS, POSITIVE) for row in floors]),
            level_size * np.array([row.number(0, LEVEL, POSITIVE) for row in floors]),
            factors and _over_modes(factors, count, "participation factor"),
            modal
            and _size(modal, 0, "mass", asked.mass_units)
            * _over_modes(modal, count, MODAL_MASS, POSITIVE),
        )


def _lines(rows: Sequence[SheetRow]) -> dict[str, SheetRow]:
    """The lines above the floors by their names; a ValueError for an unknown or a repeated one."""
    lines: dict[str, SheetRow] = {}
    for row in rows:
        name, _ = with_unit(row.cell(0))
        if name not in (PERIOD, FACTOR, MODAL_MASS) or name in lines:
            what = "is given twice" if name in lines else "is not known here"
            raise row.error(
                0, f"{brief(row.cell(0))} {what}; allowed: {PERIOD} [s], {FACTOR}, {MODAL_MASS} [kg]"
            )
        lines[name] = row
    if (FACTOR in lines) != (MODAL_MASS in lines):
        given, other = (FACTOR, MODAL_MASS) if FACTOR in lines else (MODAL_MASS, FACTOR)
        raise lines[given].error(0, f"{given} is given without {other}; allowed: both or neither")
    return lines


def _over_modes(row: SheetRow, count: int, what: str, allowed: Range | None = None) -> Array:
    """The numbers of a line, one for each mode."""
    row.check_width(FIRST + count)
    return np.array([row.number(FIRST + n, what, allowed) for n in range(count)])


def _size(row: SheetRow, column: int, quantity: str, asked: str | None) -> float:
    """The unit of a column or a line, in SI, from its title."""
    where = f"{row.where}, column {column + 1}"
    return size_stated(quantity, with_unit(row.cell(column))[1], asked, where)
