"""Records as columns of text, or as one series in rows, below titles and names of columns."""

from __future__ import annotations

import re
from collections.abc import Sequence
from io import StringIO
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from stochlin.applications.records.formats import RecordFile, Series
from stochlin.applications.sheets.sheets import Table, number_in, table_of, text_sheet, with_unit
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.units import size_of

Column = int | str

MOST_TITLES = 2
_HEAD = 50  # lines in which the numbers begin
# Lines of other formats: "SAMPLING INTERVAL (sec) : 0.01", "UNITS OF ACCEL ARE SEC AND G/10".
_STATEMENT = re.compile(r"[:=]\s*\S|\bunits?\b", re.IGNORECASE)
_COMMA = re.compile(r"[-+]?\d+,\d{2,}")


class Text(NamedTuple):
    """A text of numbers, with the table in its first lines and what stands above its titles."""

    lines: Sequence[str]
    head: Table
    titles: Sequence[str]

    @classmethod
    def of(cls, name: str, lines: Sequence[str], skip: int) -> Text | None:
        """The text after ``skip`` lines; None if its head is not titles, names and units of columns."""
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

    def series(self, column: Column | None, time_column: Column | None, wrapped: bool) -> Series:
        """The record, from a column or from all numbers in their order."""
        dt = self._step_above() if time_column is None else None
        if wrapped or dt is not None:
            values = self._numbers()[2 if dt else 0 :]
            return Series(values, None, dt, self.units_of(0), " ".join(self.titles))
        time = None if time_column is None else self.head.column(time_column, several=False)
        chosen = self._chosen(column, time)
        table = self.table()
        values = table.numbers(chosen, "number")
        times = None if time is None else table.seconds(time, "time")
        named = self.head.title_cells[chosen] if self.head.titles else ""
        nameless = 0 if named or time is not None else self.head.width
        return Series(values, times, None, self.units_of(chosen), named, nameless=nameless)

    def table(self) -> Table:
        """The table of all lines, as wide as the first: numbers by pandas, or texts if it has others."""
        head, sheet, start = self.head, self.head.sheet, int(self.head.rows.index[0])
        text, below = "\n".join(self.lines[start - 1 :]), enumerate(self.lines[start - 1 :], start)
        decimal = "." if sheet.separator == "," or "," not in text else ","
        options: dict[str, Any] = {"header": None, "decimal": decimal, "skipinitialspace": True}
        try:
            read = pd.read_csv(StringIO(text), sep=sheet.separator or r"\s+", **options)
        except ValueError:  # lines of unequal length
            read = pd.DataFrame([""])
        read = read.dropna(axis="columns", how="all")
        values = read.to_numpy()
        if values.dtype.kind in "iuf" and [*read] == [*range(head.width)] and np.isfinite(values).all():
            lines = [number for number, line in below if line.strip()]
            return head._replace(rows=read.astype(float).set_axis(lines))
        whole = table_of(text_sheet(self.lines, sheet.name))
        assert whole is not None  # since it has a head
        for line in whole.rows.index:
            if (width := len(whole.sheet.row(line))) != head.width:
                allowed = f"{head.width}, as in the first row{self._or_wrapped()}"
                raise whole.sheet.error(line, None, f"{width} columns; allowed: {allowed}")
        return whole

    def units_of(self, column: int) -> str | None:
        """Units in the name of a column, or units of acceleration in a title."""
        stated = self.head.unit_of(column)
        units = (stated, *(with_unit(title)[1] for title in self.titles))
        return next((unit for unit in units if size_of(unit, "m/s^2")), stated) or None

    def _words(self) -> str:
        """All numbers in their order, with white space between them."""
        sheet, text = self.head.sheet, "\n".join(self.lines[self.head.rows.index[0] - 1 :])
        text = text.replace(sheet.separator or " ", " ")
        return text if sheet.separator == "," else text.replace(",", ".")

    def _numbers(self) -> Array:
        above = [""] * (self.head.rows.index[0] - 1)
        file = RecordFile(self.head.sheet.name, [*above, *self._words().split("\n")])
        return file.numbers(len(above) + 1, len(file.lines))

    def _step_above(self) -> float | None:
        """The time step in a first row with the number of samples and it, ``1559 0.02``."""
        numbers = [number_in(cell, ".,") or 0.0 for cell in self.head.sheet.row(self.head.rows.index[0])]
        step, count = min(numbers), max(numbers)
        if len(numbers) != 2 or not 0 < step < 1 < count == round(count):
            return None
        return step if len(self._words().split()) == count + 2 else None

    def _or_wrapped(self) -> str:
        """The other cure for rows of numbers without names."""
        count = len(self._words().split())
        return "" if self.head.titles else f", or wrapped=True for one series of {count} numbers"

    def _chosen(self, column: Column | None, time: int | None) -> int:
        """The column that is asked for, or the only one but the time."""
        left = [n for n in range(self.head.width) if n != time]
        if column is None and len(left) != 1:
            has = f"column is missing: {self.head.sheet.name} has {self.head.in_words}"
            raise ValueError(f"{has}; give column={self._or_wrapped()}")
        chosen = left[0] if column is None else self.head.column(column, several=False)
        if chosen == time:
            raise ValueError(f"column = {brief(column)} is that of the time; allowed: another one")
        return chosen
