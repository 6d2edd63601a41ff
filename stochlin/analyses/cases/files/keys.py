"""Keys of a case file: what each one may say, its default, and its control in the explorer."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from stochlin.analyses.cases.files.quantities import Quantity
from stochlin.models.arguments import Whole
from stochlin.models.parameters import Model

Place = tuple[str | int, ...]
"""Names of the tables that contain a key, and the key; numbers count tables of the same name."""

NEEDED = object()  # default of a key that has none


class Column:
    """Kind of a key that names a column of a file, by its title or by its number from 0."""


Kind = Quantity | Whole | tuple[str, ...] | type[bool] | type[str] | type[Column]
"""What a key may say: a number with its unit, a whole number, one of some words, a text."""


class Slider(NamedTuple):
    """Control of a number in the explorer: range and step of its slider, in ``unit``.

    ``start`` is the value that a choice of the explorer begins with.
    """

    low: float
    high: float
    step: float
    start: float
    unit: str = ""


@dataclass(frozen=True)
class Key:
    """A key of a table; ``title`` is its name for readers, ``default`` its value if it is missing.

    ``ways`` are the ways to describe a building or a site to which it belongs, empty for all of them.
    ``noted`` is a key that no result depends on: it is checked, kept and shown.
    """

    name: str
    kind: Kind
    title: str = ""
    default: Any = NEEDED
    slider: Slider | None = None
    ways: tuple[str, ...] = ()
    noted: bool = False

    @property
    def label(self) -> str:
        """Name of the key for a reader."""
        return self.title or self.name.replace("_", " ").capitalize()

    @property
    def unit_size(self) -> float:
        """The unit of the slider in SI units."""
        unit = self.slider.unit if self.slider else ""
        return self.kind.spellings[unit] if unit and isinstance(self.kind, Quantity) else 1.0

    @property
    def allowed_in_words(self) -> str:
        """What the key may say, for the documentation."""
        if isinstance(self.kind, Quantity):
            units = "" if self.kind.units == "1" else f" in {', '.join(self.kind.spellings)}"
            return f"a number{units}; {self.kind.allowed}"
        if isinstance(self.kind, Whole):
            return str(self.kind)
        words = {bool: "true or false", str: "a text", Column: "a column, by its title or number"}
        return words[self.kind] if isinstance(self.kind, type) else ", ".join(self.kind)

    @property
    def example(self) -> str:
        """A value as it may be written in a file."""
        if isinstance(self.kind, Quantity):
            return self.kind.example
        if isinstance(self.kind, Whole):
            return str(self.kind.lowest)
        words = {bool: "true", str: '"..."', Column: "0"}
        return words[self.kind] if isinstance(self.kind, type) else f'"{self.kind[0]}"'


def declared(
    model: type[Model],
    name: str,
    title: str = "",
    slider: Slider | None = None,
    ways: tuple[str, ...] = (),
) -> Key:
    """The key of a parameter of a model, which has its unit and its range from there."""
    long_name = str(model.__dataclass_fields__[name].metadata["long_name"])
    return Key(
        name, Quantity.declared(model, name), title or long_name.capitalize(), slider=slider, ways=ways
    )


def table(*keys: Key) -> Mapping[str, Key]:
    """The keys by name."""
    return {key.name: key for key in keys}
