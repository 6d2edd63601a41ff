"""The influence of the inputs on a gap in plain words and short numbers, for the screen and the page."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from stochlin.models.buildings import OF_STOREYS
from stochlin.models.descriptions import shown_unit
from stochlin.views.shared.blocks import Block, Table, Text, texts
from stochlin.views.shared.words import MINUS, SPACE, behind, per_cent, short

if TYPE_CHECKING:
    from collections.abc import Mapping

    import xarray as xr

NAMES = {"structure_1": "building 1", "structure_2": "building 2", "ground": "the ground"}
CENTIMETRES = 100.0
LARGE_GAP = 0.05  # [m]: from here on tenths of a centimetre tell enough of a change
NOTHING = 1e-6  # of the gap: what moves it by less does not matter
EXAMPLE = "10 % to either side as an example"
COLUMNS = "[cm]: its change if the input is at either end of its range."


class InputLine(NamedTuple):
    """One input as it is shown."""

    place: int  # in the dataset
    label: str
    uncertain: bool
    low: str
    high: str
    range: str
    change: str


def rows(table: xr.Dataset, names: Mapping[str, str] = NAMES) -> list[InputLine]:
    """The inputs that change the gap: uncertain ones, then known ones, by decreasing influence."""
    moves = np.abs(table.gap_change).max("end").values
    uncertain = table.uncertain.values.astype(bool)
    order = np.lexsort((-moves, ~uncertain))
    there = moves > NOTHING * max(float(table.gap), float(moves.max()))
    some = bool(uncertain.any())
    return [_row(table.isel(input=n), int(n), names, some) for n in order if there[n]]


def asked(table: xr.Dataset) -> str:
    """The quantity of the answer: a gap, or the set-back of one building."""
    return "gap" if "second" in table.attrs else "set-back"


def note(table: xr.Dataset) -> str:
    """The meaning of the columns."""
    if not table.uncertain.any():
        return f"Range: {EXAMPLE}. {COLUMNS}"
    return (
        "Range: for uncertain inputs, from the 16 % to the 84 % quantile; for known inputs (in "
        f"brackets), {EXAMPLE}. {COLUMNS}"
    )


def _row(table: xr.Dataset, place: int, names: Mapping[str, str], some_uncertain: bool) -> InputLine:
    role, _, key = str(table.input.item()).partition(".")
    uncertain = bool(table.uncertain)
    label = f"{key.replace('_', ' ')} of {names[role]}"
    low, high = (_value(table, key, float(factor)) for factor in table.input_factor_at)
    digits = 1 if float(table.gap) >= LARGE_GAP else 2
    changes = [_signed(CENTIMETRES * float(change), digits) for change in table.gap_change]
    number, _, unit = low.partition(SPACE)
    return InputLine(
        place=place,
        label=f"({label})" if some_uncertain and not uncertain else label,
        uncertain=uncertain,
        low=low,
        high=high,
        range=f"{number} to {high}" if unit else f"{low} to {high}",
        change=" / ".join(changes),
    )


def _value(table: xr.Dataset, key: str, factor: float) -> str:
    """An input at an end of its range; for an array, the factor on the given values."""
    unit, median = str(table.input_unit.item()), float(table.input_median)
    if unit == "1" and key in OF_STOREYS:
        return f"{factor:.2f}{SPACE}times"
    unit, scale = shown_unit(unit, median)
    return f"{short(scale * median * factor)}{behind(unit)}"


def _signed(value: float, digits: int) -> str:
    rounded = round(value, digits)
    return f"{rounded:+.{digits}f}".replace("-", MINUS) if rounded else f"{0:.{digits}f}"


def sentences(table: xr.Dataset, names: Mapping[str, str] = NAMES) -> list[str]:
    """The result in sentences."""
    shown = rows(table, names)
    if not shown:
        return ["No parameter of the buildings or of the ground changes it."]
    most = shown[0]
    begin = (
        "Among the uncertain inputs"
        if most.uncertain
        else ("Among all inputs, each changed by 10 % to either side")
    )
    low, high = most.change.split(" / ")
    text = [
        f"{begin}, the {asked(table)} depends most on the {most.label.strip('()')}: {most.low} would "
        f"change it by {low}{SPACE}cm, {most.high} by {high}{SPACE}cm."
    ]
    if not table.uncertain.any():
        return text
    less = float(table.gap_of_medians / table.gap) - 1
    error = float(table.gap_of_medians_standard_error / table.gap)
    word = "smaller" if less < 0 else "larger"
    text.append(
        f"If all inputs were known to be at their medians, the {asked(table)} would be "
        f"{100 * abs(less):.0f} ± {per_cent(error)} {word}."
    )
    return text


def blocks(table: xr.Dataset, names: Mapping[str, str] = NAMES) -> list[Block]:
    """The sentences, a row for each input, and the meaning of the columns."""
    heads = ["input", "range", f"{asked(table)} [cm]"]
    cells = [(row.label, row.range, row.change) for row in rows(table, names)]
    meaning = [Text(note(table), "note")] if cells else []
    return [*texts(sentences(table, names)), Table.of(heads, cells, ("range",)), *meaning]
