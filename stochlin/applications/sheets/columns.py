"""Columns of tables: which of them a reader takes, by quantities, and their numbers in SI.

A column is known by its title, by whatever the caller asks for, or as the only one that is left;
never by its place.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from math import isclose, isnan
from typing import NamedTuple

import numpy as np
import pandas as pd

from stochlin.applications.sheets.quantities import (
    INDEX_COLUMN,
    LEVEL_COLUMN,
    TIME_COLUMN,
    Quantity,
)
from stochlin.applications.sheets.sheets import Table, number_in, spelled, with_unit
from stochlin.applications.sheets.titles import Said
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import is_label, is_whole
from stochlin.models.parameters import Range
from stochlin.models.units import UNITS, likely_unit, stated_size

ColumnName = int | str
"""A column by its number, from 1, or by its title."""

BY = "by title or by number from 1"
COUNTED_FROM_1 = "columns are counted from 1"
_EMPTY_TITLE = re.compile(r"Unnamed: \d+(?:\.\d+)?(?:_level_\d+)?")  # a title that was empty
_STAMP = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d.*")
_ZONE = re.compile(r"(Z|[+-]\d\d:?\d\d)$")
_LISTED = 8  # columns in messages
_SHOWN = 3  # first numbers of a column without a title, in messages
_STATED = {"m/s^2": "acceleration", "m/s": "velocity", "m": "length", "N": "force"}


@dataclass(frozen=True)
class Column:
    """A column of a table: its number from 1, its title, and what this says.

    ``counts`` is whether it has no title and the numbers 0, 1, 2, ..., as indices are written.
    """

    number: int
    title: str
    said: Said
    counts: bool
    first: Sequence[str]  # cells of the first lines

    @property
    def label(self) -> str:
        """The column in messages."""
        return (
            f"{self.number} {brief(self.title)}" if self.title else f"{self.number} ({self.begins})"
        )

    @property
    def begins(self) -> str:
        """Its first cells."""
        return ", ".join([*self.first, "..."])

    @property
    def in_words(self) -> str:
        """The column with what it is."""
        names = [INDEX_COLUMN.name] if self.counts else [of.name for of in self.said.quantities]
        of = "" if self.said.base is None else "the logarithm of "
        parts = [f"{of}{' or '.join(names)}"] if names else []
        if self.said.damping is not None:
            parts.append(f"damping {self.said.damping:g}")
        if self.said.aside:
            parts.append(f"not as it stands, since it says {brief(self.said.aside.strip())}")
        return ": ".join([self.label, ", ".join(parts)]) if parts else self.label

    def is_unknown(self) -> bool:
        """Whether nothing says what it is."""
        return not (self.said.quantities or self.counts or self.said.aside)


class Need(NamedTuple):
    """What a reader needs of a table: a quantity, or another one from which it follows.

    ``argument`` is the name of that by which the caller asks for the column.
    """

    argument: str
    by_caller: ColumnName | None
    wanted: Sequence[Quantity]
    left: bool = False  # whether it may be the only column that is left
    optional: bool = False
    # as the caller states them, of a title that may mean several quantities
    units: str | None = None
    logarithms: bool = False  # whether it may be one
    period: float | None = None  # s, of a spectral acceleration
    damping: float | None = None

    @property
    def words(self) -> str:
        """What is allowed."""
        return " or ".join(of.name for of in self.wanted)

    def meaning(self, column: Column) -> Quantity | None:
        """The first of the wanted quantities that a column may be; None if it is none of them."""
        fits = [of for of in self.wanted if of in column.said.quantities]
        if self.units is not None and not column.said.unit:
            usual = [of for of in fits if of.usual or of is LEVEL_COLUMN or of.size(self.units)]
            fits = usual or fits
        return fits[0] if fits else None

    def is_sure_of(self, column: Column) -> bool:
        """Whether a column may be one of the wanted quantities only."""
        return sum(of in self.wanted for of in column.said.quantities) == 1

    def takes(self, column: Column) -> bool:
        """Whether a column may be taken without being asked for."""
        said = column.said
        base = said.base is None or (self.logarithms and not isnan(said.base))
        ordinate = said.period in (None, self.period)
        return not (said.aside or column.counts) and base and ordinate and self._is_damped(column)

    def _is_damped(self, column: Column) -> bool:
        """Whether a title states no other damping ratio than is asked for."""
        stated = column.said.damping
        wanted = self.damping
        return stated is None or wanted is None or isclose(stated, wanted, rel_tol=1e-6)

    def refusal(self, column: Column) -> str:
        """Why a column that is asked for is not taken, in words; empty if it is taken."""
        said = column.said
        meaning = self.meaning(column)
        lettered = isinstance(self.by_caller, str) and len(column.title) == 1  # as component V or W
        if said.quantities and meaning is None and not lettered:
            return f"is {' or '.join(of.name for of in said.quantities)}; allowed: {self.words}"
        if said.base is not None and (isnan(said.base) or not self.logarithms):
            either = ", or its log10 or ln" if self.logarithms else ""
            return f"is a logarithm; allowed: {self.words}{either}"
        if None not in (said.period, self.period) and said.period != self.period:
            return f"is that of {said.period:g} s; allowed: that of {self.period:g} s"
        if not self._is_damped(column):
            return (
                f"has a damping ratio of {said.damping:g}; give damping={said.damping:g}, or "
                "another"
            )
        return ""


class Choice(NamedTuple):
    """A column and the quantity for which it is taken."""

    table: Table
    column: Column
    quantity: Quantity
    by_caller: ColumnName | None

    @property
    def comment(self) -> str:
        """The column with the quantity for which it is taken."""
        of = "" if self.column.said.base is None else "the logarithm of "
        return f"column {self.column.label} is {of}{self.quantity.name}"

    def in_si(
        self, units: str | None = None, argument: str = "", allowed: Range | None = None
    ) -> Array:
        """The numbers in the unit of the quantity, without a logarithm.

        Its unit is that of the file, or ``units`` of the caller, by the name of this ``argument``.
        """
        table = self.table
        column = self.column.number - 1
        of = self.quantity
        line = table.units or table.titles or table.rows.index[0]
        unit = self.column.said.unit
        name = of.name.partition(" ")[2]
        if of is TIME_COLUMN and (stamps := _stamps(table, column)) is not None:
            return stamps
        if of.unit in _STATED:
            what = _STATED[of.unit]
            size = stated_size(what, unit, units, table.sheet.where(line, column), argument)
        elif (stated := of.size(unit or of.usual)) is not None:
            size = stated
        elif of.unit in ("1", "1/yr"):  # a remark
            size = 1.0
        else:
            units_of_quantity = ", ".join(UNITS.get(of.unit, (of.unit,)))
            cure = f"{likely_unit(unit, of.unit)}allowed: {units_of_quantity}"
            raise table.error(f"has the {name} in {brief(unit)}; {cure}")
        return size * self.numbers(allowed)

    def numbers(self, allowed: Range | None = None) -> Array:
        """The numbers as they are written, but without a logarithm."""
        table = self.table
        column = self.column.number - 1
        name = self.quantity.name.partition(" ")[2]
        if (base := self.column.said.base) is None:
            return table.numbers(column, name, allowed)
        with np.errstate(over="ignore"):
            values: Array = base ** table.numbers(column, f"logarithm of the {name}")
        finite = np.isfinite(values)
        if not finite.all():
            n = int(np.argmin(finite))
            raise table.sheet.error(
                table.rows.index[n], column, f"the {name} is beyond all numbers"
            )
        return values


def columns_of(table: Table) -> list[Column]:
    """The columns of a table with what their titles say.

    Raises a ValueError if more than one column of numbers, which may be an index, has no title
    below others, as those of ``0,5`` between commas.
    """
    first_line = table.rows.index[0]
    titled = len(table.title_cells)
    untitled = sum(n >= titled for n in table.sheet.columns_of_numbers(first_line))
    if titled and untitled > 1:
        table.sheet.check_width([first_line], titled)
    columns = []
    for n, title in enumerate([*table.title_cells, *[""] * table.width][: table.width]):
        shown = "" if _EMPTY_TITLE.fullmatch(title) else title
        cells = table.rows[n]
        first = [_shown(table, cell) for cell in cells.iloc[:_SHOWN]]
        counts = not shown and _counts(table, cells)
        columns.append(Column(n + 1, shown, table.said_of(n), counts, first))
    return columns


def in_words(columns: Sequence[Column]) -> str:
    """The columns of a table, for messages."""
    more = f" and {len(columns) - _LISTED} more" if len(columns) > _LISTED else ""
    shown = ", ".join(column.in_words for column in columns[:_LISTED])
    return f"{len(columns)} columns, {shown}{more}"


def check_one_kind(table: Table, column: int, what: str) -> None:
    """Raise a ValueError for the first line in which a column of names has a second name."""
    cells = table.rows[column]
    names = cells[cells != ""].drop_duplicates()
    has_numbers = any(table.sheet.columns_of_numbers(n) & {column} for n in names.index)
    if len(names) > 1 and not has_numbers:
        second = f"a second {what}, {brief(names.iloc[1])} beside {brief(names.iloc[0])}"
        raise table.sheet.error(names.index[1], column, f"{second}; export one of them")


def noted(choices: Sequence[Choice], converted: Collection[Quantity] = ()) -> dict[str, str]:
    """The attribute ``columns``, on those asked for by number, or of which others follow."""
    parts = []
    for choice in choices:
        changed = choice.quantity in converted or choice.column.said.base is not None
        if changed or is_whole(choice.by_caller):
            parts.append(f"{choice.comment}{', converted' if changed else ''}")
    return {"columns": "; ".join(parts)} if parts else {}


def chosen(
    table: Table, needs: Sequence[Need], cure: Callable[[], str] = str
) -> list[Choice | None]:
    """A column for each need, and None for an optional one without any.

    Raises a ValueError that names all columns and what to give, if several fit or none does, or for
    a column that is asked for and is another quantity; ``cure`` has another way out.
    """
    columns = columns_of(table)
    of_caller = {
        need.argument: _asked(table, columns, need) for need in needs if need.by_caller is not None
    }
    taken: dict[str, Column | None] = {**of_caller}
    for first, second in _twice(of_caller):
        raise table.error(
            f"has {brief(of_caller[first].label)} as {first} and as {second}; allowed: two columns"
        )
    for need in needs:
        if need.by_caller is None:
            free = [column for column in columns if column not in taken.values()]
            taken[need.argument] = _by_title(free, need)
    missing = [need for need in needs if taken[need.argument] is None]
    for need in [need for need in missing if need.left]:
        free = [column for column in columns if column not in taken.values()]
        left = [column for column in free if column.is_unknown()]
        certain = all(other.optional or other is need for other in missing)
        if certain and len(left) == 1 and not any(need.meaning(column) for column in free):
            taken[need.argument] = left[0]
    missing = [need for need in missing if taken[need.argument] is None and not need.optional]
    if missing:
        raise _missing(table, columns, missing, cure())
    choices: list[Choice | None] = []
    for need in needs:
        column = taken[need.argument]
        of = (column and need.meaning(column)) or need.wanted[0]
        choices.append(None if column is None else Choice(table, column, of, need.by_caller))
    return choices


def _by_title(columns: Sequence[Column], need: Need) -> Column | None:
    """The only column whose title says the first of the wanted quantities that some title says."""
    for of in need.wanted:
        fits = [column for column in columns if need.meaning(column) == of and need.takes(column)]
        if fits:
            fits = [column for column in fits if need.is_sure_of(column)] or fits
            return fits[0] if len(fits) == 1 else None
    return None


def _asked(table: Table, columns: Sequence[Column], need: Need) -> Column:
    """The column that the caller asks for, by its number or its title."""
    by_caller = need.by_caller
    shown = f"{need.argument} = {brief(need.by_caller)}"
    if is_whole(by_caller):
        if not 1 <= by_caller <= len(columns):
            allowed = f"allowed: 1 to {len(columns)}, since {COUNTED_FROM_1}"
            raise ValueError(f"{table.sheet.name}: {shown} is no column; {allowed}")
        column = columns[by_caller - 1]
    elif not is_label(by_caller):
        raise TypeError(f"{shown}; allowed: a title, or a number, since {COUNTED_FROM_1}")
    else:
        name = spelled(with_unit(str(by_caller))[0])
        exact = [column for column in columns if column.title == by_caller]
        titles = [spelled(with_unit(column.title)[0]) for column in columns]
        pairs = zip(columns, titles, strict=True)
        alike = [column for column, title in pairs if name and title == name]
        fitting = exact or alike
        if len(fitting) != 1:
            count = "is the title of several columns" if fitting else "is the title of no column"
            raise table.error(f"has {in_words(columns)}, and {shown} {count}; give it {BY}")
        (column,) = fitting
    if why := need.refusal(column):
        raise table.error(f"has column {column.label}, and {shown} {why}; correct a wrong title")
    return column


def _twice(chosen_by: dict[str, Column]) -> list[tuple[str, str]]:
    names = [*chosen_by]
    pairs = [(first, second) for n, first in enumerate(names) for second in names[n + 1 :]]
    return [pair for pair in pairs if chosen_by[pair[0]] == chosen_by[pair[1]]]


def _missing(
    table: Table, columns: Sequence[Column], needs: Sequence[Need], cure: str
) -> ValueError:
    """The error that columns are missing, or that several fit."""
    has = f"has {in_words(columns)}"
    ways = list[str]()
    example = dict[str, int]()
    for need in needs:
        may_be = [
            column.number for column in columns if need.meaning(column) or column.is_unknown()
        ]
        if not may_be:
            return table.error(f"{has}; allowed: a column of {need.words}{cure}")
        example[need.argument] = next((n for n in may_be if n not in example.values()), may_be[0])
        ways.append(f"{need.argument}= ({need.words})")
    shown = ", ".join(f"{argument}={number}" for argument, number in example.items())
    if len(columns) > _LISTED > len(table.rows):
        has += "; are its points side by side? write a line for each"
    return table.error(f"{has}; give {' and '.join(ways)} {BY}, as {shown}{cure}")


def _counts(table: Table, cells: pd.Series[str]) -> bool:
    """Whether cells are 0, 1, 2, ... or 1, 2, 3, ..., as indices are written."""
    start = _number(table, cells.iloc[0]) if len(cells) > 1 else None
    if start not in (0.0, 1.0) or _number(table, cells.iloc[1]) != start + 1:
        return False
    if cells.dtype.kind == "f":
        values = cells.to_numpy()
    else:
        read: Callable[[str], float | None] = partial(_number, table)
        values = np.array([read(cell) for cell in cells], dtype=float)
    return np.array_equal(values, start + np.arange(len(cells)))


def _shown(table: Table, cell: object) -> str:
    """A cell in messages."""
    number = _number(table, cell)
    return brief(cell) if number is None else f"{number:.4g}"


def _number(table: Table, cell: object) -> float | None:
    return cell if isinstance(cell, float) else number_in(str(cell), table.sheet.decimal)


def _stamps(table: Table, column: int) -> Array | None:
    """Seconds from the first date of a column of dates; None if it has others."""
    cells = table.rows[column]
    if cells.dtype.kind == "f" or not _STAMP.fullmatch(cells.iloc[0]):
        return None
    times = np.empty(len(cells), "datetime64[ns]")
    for n, text in enumerate(cells):
        try:
            times[n] = np.datetime64(_ZONE.sub("", text), "ns")
        except ValueError:
            what = f"{brief(text)} is no date with a time; allowed: as {cells.iloc[0]}"
            raise table.sheet.error(cells.index[n], column, what) from None
    seconds: Array = (times - times[0]) / np.timedelta64(1, "s")
    return seconds
