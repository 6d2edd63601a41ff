"""A table of modes in stochlin's own plain form."""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files

import numpy as np
import pandas as pd

from stochlin.applications.buildings.mode_files import (
    ADVICE_ON_FREQUENCIES,
    MODE_NUMBERS,
    AskedModes,
    ModesOfFile,
    check_moving,
    check_seconds,
)
from stochlin.applications.sheets.sheets import Sheet, Table, with_unit
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.buildings.base import MODE
from stochlin.models.parameters import PERIODS, POSITIVE, Range
from stochlin.models.units import stated_size

LEVEL_TITLE = "level"
MASS = "mass"
PERIOD_ROW = "period"
FACTOR_ROW = "participation"
MODAL_MASS = "modal mass"
KNOWN = PERIOD_ROW, FACTOR_ROW, MODAL_MASS  # lines above the floors
FIRST_MODE_COLUMN = 2  # column of the first mode, from 0: before it are level and mass
EXAMPLE = files(__package__).joinpath("example_modes.csv").read_text(encoding="utf-8")
HEADER = "a line 'mode,,1,2', the plain form"
FLOORS = (
    "titles 'level [m]', 'mass [kg]' and 'shape' for each mode, and below a line for each floor"
)


def sheets_in(sheets: Sequence[Sheet]) -> list[Sheet]:
    """Each sheet whose first line that is no comment begins with 'mode'."""
    contents = [sheet.without_comments() for sheet in sheets]
    return [sheet for sheet in contents if sheet.cells[0].iloc[:1].str.lower().tolist() == [MODE]]


def read(content: Sheet, choice: AskedModes) -> ModesOfFile:
    """The modes of a sheet, which begins with a line of mode numbers and one of periods.

    The first two columns of a floor are its level and its mass; each further column is a mode::

        mode,,1,2
        period [s],,0.5,0.18
        level [m],mass [t],shape,shape
        7,200,1,1
        3.5,200,0.62,-1.61

    Floors may be in any order, since levels are those above the ground. Lines ``participation`` and
    ``modal mass [t]`` may follow the periods. Text after # in the first column is a comment.
    """
    for argument in ("direction", "points", "tower"):
        if value := getattr(choice, argument):
            what = (
                f"{argument} = {brief(value)} has no meaning for {content.name}, which has {HEADER}"
            )
            raise ValueError(f"{what}; leave it out")
    names = content.cells[0].map(lambda title: with_unit(title)[0])
    titles = next(iter(names.index[names == LEVEL_TITLE]), names.index[-1])
    floors = Table("the table", content, titles, 0, content.cells.loc[titles:].iloc[1:])
    if floors.rows.empty:
        raise content.error(names.index[-1], None, f"the floors are missing; allowed: {FLOORS}")
    first, *head = names.index[: names.index.get_loc(titles)]
    columns = range(FIRST_MODE_COLUMN, len(content.row(first)))

    def over_modes(lines: Sequence[int], what: str, allowed: Range | None = None) -> Array:
        content.check_width(lines, columns.stop)
        return content.numbers(content.cells.loc[lines, [*columns]], what, allowed)

    numbers = over_modes([first], "mode number", MODE_NUMBERS)[0]
    if (np.diff(numbers, prepend=0) < 1).any() or (numbers % 1).any():
        raise content.error(
            first, None, "mode numbers are not 1, 2 and so on; allowed: increasing ones"
        )
    lines = _lines(content, names[head])
    if PERIOD_ROW not in lines:
        last = [first, *head][-1]
        raise content.error(last, 0, "a line 'period [s]' is missing below")
    check_seconds(
        with_unit(content.cells.at[lines[PERIOD_ROW], 0])[1], content.where(lines[PERIOD_ROW], 0)
    )
    shapes = over_modes(floors.rows.index, "shape").T
    modes = ModesOfFile(
        numbers.astype(int).tolist(),
        over_modes([lines[PERIOD_ROW]], PERIOD_ROW, PERIODS)[0],
        shapes,
        floors.in_si(MASS, "mass", choice.mass_units, POSITIVE),
        floors.in_si(LEVEL_TITLE, "length", choice.length_units, POSITIVE),
    )
    check_moving(modes.modes, np.abs(shapes).max(axis=1), content.name)
    if FACTOR_ROW not in lines:
        return modes
    factors = over_modes([lines[FACTOR_ROW]], "participation factor")[0]
    line = lines[MODAL_MASS]
    unit = with_unit(content.cells.at[line, 0])[1]
    size = stated_size("mass", unit, choice.mass_units, content.where(line, 0))
    modal = size * over_modes([line], MODAL_MASS, POSITIVE)[0]
    n = int(np.argmax(modal))
    loads = (factors * (shapes @ modes.masses))[n : n + 1]
    check_moving(modes.modes[n : n + 1], loads, content.name, modal[n])
    return modes._replace(participation=factors, modal_masses=modal)


def _lines(sheet: Sheet, names: pd.Series) -> dict[str, int]:
    """The lines above the floors by their names; a ValueError for an unknown or a repeated one."""
    lines: dict[str, int] = {}
    for line, name in names.items():
        if name not in KNOWN or name in lines:
            what = (
                "is there twice" if name in lines else f"is not known; allowed: {', '.join(KNOWN)}"
            )
            if name not in KNOWN and name.startswith(("freq", "omega", "circ", "ang")):
                what += f"; in 'period [s]' {ADVICE_ON_FREQUENCIES}"
            raise sheet.error(line, 0, f"{brief(sheet.cells.at[line, 0])} {what}")
        lines[name] = line
    if (FACTOR_ROW in lines) != (MODAL_MASS in lines):
        present = FACTOR_ROW if FACTOR_ROW in lines else MODAL_MASS
        absent = MODAL_MASS if FACTOR_ROW in lines else FACTOR_ROW
        what = f"{present} is given without {absent}; allowed: both or neither"
        raise sheet.error(lines[present], 0, what)
    return lines
