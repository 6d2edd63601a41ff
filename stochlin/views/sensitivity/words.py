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
KINDS = f"±{SPACE}10{SPACE}%", f"16 to 84{SPACE}%"  # ranges of known and of uncertain inputs


class InputLine(NamedTuple):
    """One input as it is shown."""

    place: int  # in the dataset
    label: str
    range: str
    kind: str
    change: str


def rows(table: xr.Dataset, names: Mapping[str, str] = NAMES) -> list[InputLine]:
    """The inputs that change the gap: uncertain ones, then known ones, by decreasing influence."""
    moves = np.abs(table.gap_change).max("end").values
    order = np.lexsort((-moves, 1 - table.uncertain.values))
    least = NOTHING * max(float(table.gap), float(moves.max()))
    return [_row(table.isel(input=n), int(n), names) for n in order if moves[n] > least]


def asked(table: xr.Dataset) -> str:
    """The quantity of the answer: a gap, or the set-back of one building."""
    return "gap" if "second" in table.attrs else "set-back"


def _row(table: xr.Dataset, place: int, names: Mapping[str, str]) -> InputLine:
    role, _, key = str(table.input.item()).partition(".")
    unit, median = str(table.input_unit.item()), float(table.input_median)
    if unit == "1" and key in OF_STOREYS:  # a factor on all values
        unit = "times"
    else:
        unit, scale = shown_unit(unit, median)
        median *= scale
    low, high = (short(median * float(factor)) for factor in table.input_factor_at)
    digits = 1 if float(table.gap) >= LARGE_GAP else 2
    changes = [f"{CENTIMETRES * float(change):+.{digits}f}" for change in table.gap_change]
    return InputLine(
        place=place,
        label=f"{key.replace('_', ' ')} of {names[role]}",
        range=f"{low} to {high}{behind(unit)}",
        kind=KINDS[int(table.uncertain)],
        change=" / ".join(changes).replace("-", MINUS),
    )


def blocks(table: xr.Dataset, names: Mapping[str, str] = NAMES) -> list[Block]:
    """The result in sentences, and a row for each input."""
    shown, quantity = rows(table, names), asked(table)
    if not shown:
        return [Text("No parameter of the buildings or of the ground changes it.")]
    most = shown[0]
    sentences = [
        f"The {quantity} depends most on the {most.label}: at the ends of its range, {most.range} "
        f"({most.kind}), it changes by {most.change}{SPACE}cm."
    ]
    if table.uncertain.any():
        less = float(table.gap_of_medians / table.gap) - 1
        error = float(table.gap_of_medians_standard_error / table.gap)
        sentences.append(
            f"If all inputs were known to be at their medians, the {quantity} would be "
            f"{100 * abs(less):.0f} ± {per_cent(error)} {'smaller' if less < 0 else 'larger'}."
        )
    heads = ["input", "range", "of it", f"{quantity} [cm]"]
    return [*texts(sentences), Table.of(heads, [row[1:] for row in shown], ("range",))]
