"""Records as columns of text, or as one series in rows, below titles and names of columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from io import StringIO
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from stochlin.applications.records.formats import RecordFile, Series
from stochlin.applications.sheets.columns import ColumnName, Need, chosen, columns_of, noted
from stochlin.applications.sheets.quantities import ACCELERATION_COLUMN, TIME_COLUMN
from stochlin.applications.sheets.sheets import Table, number_in, table_of, text_sheet, with_unit
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.units import size_of

MOST_TITLES = 2
# Allowed deviation of a printed time from its even position, in time steps. Times at 1/300 s are
# printed 0.003, 0.007, 0.010. A lost sample deviates by 0.5 at least.
TIME_TOLERANCE = 0.25
LONGEST_STEP = 0.5  # s; no untitled column of longer ones is known to be a time
_ROWS_OF_A_SERIES = 5  # fewest numbers in a row; the usual components of a motion are three
# mean change along the rows of one series, over that from row to row; of three 0.3 to 1
_SMOOTHER = 0.7
_HEAD = 50  # lines in which the numbers begin
# Lines of other formats: "SAMPLING INTERVAL (sec) : 0.01", "UNITS OF ACCEL ARE SEC AND G/10".
_STATEMENT = re.compile(r"[:=]\s*\S|\bunits?\b", re.IGNORECASE)
_COMMA = re.compile(r"[-+]?\d+,\d{2,}")


class TextFile(NamedTuple):
    """A text of numbers, with the table in its first lines and what stands above its titles."""

    lines: Sequence[str]
    head: Table
    titles: Sequence[str]

    @classmethod
    def of(cls, name: str, lines: Sequence[str], skip: int) -> TextFile | None:
        """The text after ``skip`` lines; None if its head is not titles, column names and units."""
        lines = [*[""] * skip, *lines[skip:]]
        first = next((n for n, line in enumerate(lines) if line.strip()), 0)
        if (head := table_of(text_sheet(lines[: first + _HEAD], name))) is None:
            return None
        rows = [lines[n - 1].strip() for n in head.rows.index]
        if all(map(_COMMA.fullmatch, rows)) and any(",0" in row for row in rows):
            raise ValueError(f"{name} has decimal commas, as {brief(rows[0])}; allowed: points")
        above = [n for n in head.sheet.cells.index if n < head.rows.index[0]]
        texts = {n: " ".join(head.sheet.row(n)) for n in above}
        titles = [text for n, text in texts.items() if n not in (head.titles, head.units)]
        stated = any(map(_STATEMENT.search, texts.values() if head.width == 1 else titles))
        if not skip and (stated or len(titles) > MOST_TITLES):
            return None
        return cls(lines, head, titles)

    def series(
        self, column: ColumnName | None, time_column: ColumnName | None, wrapped: bool
    ) -> Series:
        """The record, from a column or from all numbers in their order."""
        count, dt = self._stated_above()
        if dt and self._rows_below() == count and (below := self._below()) is not None:
            return below.series(column, time_column, wrapped)._replace(dt=dt)
        in_rows = dt and time_column is None and len(self._words().split()) == count + 2
        if wrapped or in_rows:
            values = self._numbers()[2 if in_rows else 0 :]
            unit = self.units_of(self.head.said_of(0).unit)
            return Series(values, None, dt if in_rows else None, unit)
        table = self.table()
        needs = [
            Need(
                "time_column", self._time(table, column, time_column), (TIME_COLUMN,), optional=True
            ),
            Need("column", column, (ACCELERATION_COLUMN,), left=True),
        ]
        time, of_values = chosen(table, needs, self._ways_out)
        assert of_values is not None  # which is not optional
        values = of_values.numbers()
        if not of_values.column.said.quantities and _even_step(values):
            what = f"has column {of_values.column.label}, which rises by equal steps, as a time"
            raise table.error(
                f"{what}; allowed as column=: accelerations, or with a title that says so"
            )
        about = noted([choice for choice in (time, of_values) if choice])
        rows = 0 if of_values.column.title or time else _in_rows(table)
        units = self.units_of(of_values.column.said.unit)
        times = None if time is None else time.in_si()
        title = of_values.column.title
        return Series(values, times, None, units, about, rows, time_column is not None, title)

    def table(self) -> Table:
        """The table of all lines, as wide as the first: numbers by pandas, or else texts."""
        head = self.head
        sheet = self.head.sheet
        start = int(self.head.rows.index[0])
        text = "\n".join(self.lines[start - 1 :])
        below = enumerate(self.lines[start - 1 :], start)
        decimal = "." if sheet.separator == "," or "," not in text else ","
        options: dict[str, Any] = {"header": None, "decimal": decimal, "skipinitialspace": True}
        try:
            read = pd.read_csv(StringIO(text), sep=sheet.separator or r"\s+", **options)
        except ValueError:  # lines of unequal length
            read = pd.DataFrame([""])
        read = read.dropna(axis="columns", how="all")
        values = read.to_numpy()
        if (
            values.dtype.kind in "iuf"
            and [*read] == [*range(head.width)]
            and np.isfinite(values).all()
        ):
            lines = [number for number, line in below if line.strip()]
            return head._replace(rows=read.astype(float).set_axis(lines))
        whole = table_of(text_sheet(self.lines, sheet.name))
        assert whole is not None  # since it has a head
        for line in whole.rows.index:
            if (width := len(whole.sheet.row(line))) != head.width:
                allowed = f"{head.width}, as in the first row{self._or_wrapped()}"
                raise whole.sheet.error(line, None, f"{width} columns; allowed: {allowed}")
        return whole

    def units_of(self, stated: str) -> str | None:
        """The units that a column states, or units of acceleration in a title."""
        units = (stated, *(with_unit(title)[1] for title in self.titles))
        return next((unit for unit in units if size_of(unit, "m/s^2")), stated) or None

    def _words(self) -> str:
        """All numbers in their order, with white space between them."""
        sheet = self.head.sheet
        text = "\n".join(self.lines[self.head.rows.index[0] - 1 :])
        text = text.replace(sheet.separator or " ", " ")
        return text if sheet.separator == "," else text.replace(",", ".")

    def _numbers(self) -> Array:
        above = [""] * (self.head.rows.index[0] - 1)
        file = RecordFile(self.head.sheet.name, [*above, *self._words().split("\n")])
        return file.numbers(len(above) + 1, len(file.lines))

    def _stated_above(self) -> tuple[int, float | None]:
        """Number of samples and time step of a first row like ``1559 0.02``; None without one."""
        numbers = [
            number_in(cell, ".,") or 0.0 for cell in self.head.sheet.row(self.head.rows.index[0])
        ]
        step = min(numbers)
        count = max(numbers)
        stated = len(numbers) == 2 and 0 < step < 1 < count == round(count)
        return (int(count), step) if stated else (0, None)

    def _rows_below(self) -> int:
        """Number of lines below the first row, if they have columns."""
        lines = [line for line in self.lines[self.head.rows.index[0] :] if line.strip()]
        second = self.head.sheet.row(self.head.rows.index[1]) if len(self.head.rows) > 1 else ()
        return len(lines) if len(second) > 1 else 0

    def _below(self) -> TextFile | None:
        """The text without its first row."""
        first = int(self.head.rows.index[0])
        lines = [*self.lines[: first - 1], "", *self.lines[first:]]
        return TextFile.of(self.head.sheet.name, lines, 0)

    def _or_wrapped(self) -> str:
        """The other cure for rows of numbers without names."""
        count = len(self._words().split())
        return "" if self.head.titles else f", or wrapped=True for one series of {count} numbers"

    def _ways_out(self) -> str:
        """What else may be given for a table in which no column is known."""
        if not self.head.titles:
            return self._or_wrapped()
        # The lines above the table are titles, not remarks.
        named = not any(column.is_unknown() for column in columns_of(self.head))
        return "" if named else f", or skip={self.head.titles} without titles"

    def _time(
        self, table: Table, column: object, by_caller: ColumnName | None
    ) -> ColumnName | None:
        """The column of times that is asked for, or of unknown ones that at equal steps."""
        columns = columns_of(table)
        named = any(of.unit for other in columns for of in other.said.quantities)
        if (
            by_caller is not None
            or named
            or len(columns) == 1
            or not table.rows.dtypes.eq(float).all()
        ):
            return by_caller
        free = [other.number for other in columns if not other.counts and other.number != column]
        steps = [_even_step(table.numbers(number - 1, "number")) for number in free]
        even = [n for n, step in zip(free, steps, strict=True) if 0 < step <= LONGEST_STEP]
        return even[0] if len(even) == 1 else None


def _in_rows(table: Table) -> int:
    """Number of columns without names that may be rows of one series; 0 if they are not.

    They may where they are many, or where the numbers change less from column to column than from
    line to line.
    """
    many = table.width >= _ROWS_OF_A_SERIES
    if table.width == 1 or many or not table.rows.dtypes.eq(float).all():
        return table.width if many else 0
    values = table.rows.to_numpy()
    along = np.abs(np.diff(values.ravel(), axis=0)).mean()
    down = np.abs(np.diff(values, axis=0)).mean()
    return table.width if along < _SMOOTHER * down else 0


def _even_step(values: Array) -> float:
    """The step of numbers that rise by equal steps, as far as they are printed; 0 of others."""
    steps = np.diff(values)
    if steps.size < 2 or not np.isfinite(values).all() or steps.min() <= 0:
        return 0.0
    step = float(values[-1] - values[0]) / steps.size
    apart = np.abs(values - values[0] - step * np.arange(values.size))
    return step if (apart <= TIME_TOLERANCE * step).all() else 0.0
