"""A table of modes in stochlin's own plain form."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from typing import ClassVar

import numpy as np
import pandas as pd

from stochlin.analyses.buildings.mode_files.base import (
    MODE_FILES,
    MODE_NUMBERS,
    AskedModes,
    ModeFile,
    ModesOfFile,
    check_moving,
)
from stochlin.analyses.sheets.sheets import Sheet, with_unit
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.parameters import PERIODS, POSITIVE, Range
from stochlin.models.units import stated_size

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
    accepts: ClassVar[Sequence[str]] = ("mass_units", "length_units")

    @staticmethod
    def buildings(sheets: Sequence[Sheet]) -> Sequence[tuple[Sheet, Sheet]]:
        """Each sheet whose first line that is no comment begins with 'mode'."""
        contents = [sheet.without_comments() for sheet in sheets]
        begins = [sheet.cells[0].iloc[:1].str.lower().tolist() == [MODE] for sheet in contents]
        return [(sheet, sheet) for sheet, is_plain in zip(contents, begins, strict=True) if is_plain]

    @staticmethod
    def read(content: Sheet, asked: AskedModes) -> ModesOfFile:
        """The modes of the sheet."""
        names = content.cells[0].map(lambda title: with_unit(title)[0])
        titles = next(iter(names.index[names == LEVEL]), names.index[-1])
        floors = content.cells.loc[titles:].iloc[1:]
        if floors.empty:
            what = f"the floors are missing; allowed: {FLOORS}"
            raise content.error(content.cells.index[-1], None, what)
        first, *head = names.index[: names.index.get_loc(titles)]
        count = len(content.row(first)) - FIRST

        def over_modes(lines: Sequence[int], what: str, allowed: Range | None = None) -> Array:
            content.check_width(lines, FIRST + count)
            return content.numbers(content.cells.loc[lines, FIRST : FIRST + count - 1], what, allowed)

        numbers = over_modes([first], "mode number", MODE_NUMBERS)[0]
        if (np.diff(numbers, prepend=0) < 1).any() or (numbers % 1).any():
            what = "mode numbers are not 1, 2 and so on; allowed: increasing ones"
            raise content.error(first, None, what)
        lines = _lines(content, names[head])
        if PERIOD not in lines:
            what = "the periods are missing below; allowed: a line 'period [s]'"
            raise content.error([first, *head][-1], 0, what)
        unit = with_unit(content.cells.at[lines[PERIOD], 0])[1]
        if unit.lower() not in SECONDS:
            what = f"periods are in {brief(unit)}; allowed: 'period [s]'"
            raise content.error(lines[PERIOD], 0, what)
        if with_unit(content.cells.at[titles, 1])[0] != MASS:
            what = f"{brief(content.cells.at[titles, 1])} is not the title of the masses; {FLOORS}"
            raise content.error(titles, 1, what)
        sizes = (
            _size(content, titles, 0, "length", asked.length_units),
            _size(content, titles, 1, "mass", asked.mass_units),
        )
        levels, masses = (
            size * content.numbers(floors[[column]], what, POSITIVE)[:, 0]
            for column, (what, size) in enumerate(zip((LEVEL, MASS), sizes, strict=True))
        )
        shapes = over_modes(floors.index, "shape").T
        check_moving(numbers.astype(int).tolist(), np.abs(shapes).max(axis=1), content.name)
        modes = ModesOfFile(
            numbers.astype(int).tolist(),
            over_modes([lines[PERIOD]], PERIOD, PERIODS)[0],
            shapes,
            masses,
            levels,
        )
        if FACTOR not in lines:
            return modes
        factors = over_modes([lines[FACTOR]], "participation factor")[0]
        size = _size(content, lines[MODAL_MASS], 0, "mass", asked.mass_units)
        modal = size * over_modes([lines[MODAL_MASS]], MODAL_MASS, POSITIVE)[0]
        n = int(np.argmax(modal))
        check_moving([int(numbers[n])], (factors * (shapes @ masses))[n : n + 1], content.name, modal[n])
        return modes._replace(participation=factors, modal_masses=modal)


def _lines(sheet: Sheet, names: pd.Series) -> dict[str, int]:
    """The lines above the floors by their names; a ValueError for an unknown or a repeated one."""
    lines: dict[str, int] = {}
    for line, name in names.items():
        if name not in (PERIOD, FACTOR, MODAL_MASS) or name in lines:
            what = "is there twice" if name in lines else "is not known here"
            title = brief(sheet.cells.at[line, 0])
            raise sheet.error(
                line, 0, f"{title} {what}; allowed: {PERIOD} [s], {FACTOR}, {MODAL_MASS} [kg]"
            )
        lines[name] = line
    if (FACTOR in lines) != (MODAL_MASS in lines):
        there, other = (FACTOR, MODAL_MASS) if FACTOR in lines else (MODAL_MASS, FACTOR)
        what = f"{there} is given without {other}; allowed: both or neither"
        raise sheet.error(lines[there], 0, what)
    return lines


def _size(sheet: Sheet, line: int, column: int, quantity: str, unit: str | None) -> float:
    """The unit of a column or a line, in SI, from its title."""
    stated = with_unit(sheet.cells.at[line, column])[1]
    return stated_size(quantity, stated, unit, sheet.where(line, column))
