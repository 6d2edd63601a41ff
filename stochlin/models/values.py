"""Models are values: compared by what they describe, arrays included, and written as Python.

A dataclass would compare its fields by ``==``, which for arrays is no truth value.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import MISSING, Field, fields
from typing import Any, ClassVar

import numpy as np
import xarray as xr

CASE = "case"  # the dimension of plain arrays
MOST_WRITTEN = 1000  # numbers of an array; numpy writes out as many
NAN = "not a number"  # stands for each NaN, which is not equal to itself


class ByValue:
    """Base of the dataclasses that are equal, and have one hash, if their fields describe the same.

    Arrays are compared by their values, and labelled ones by their dimensions and coordinates as
    well; NaN is equal to NaN. Fields that dataclasses do not compare take no part, nor does
    anything cached.
    """

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        # A dataclass makes these three anew wherever the class itself does not have them.
        for name in ("__eq__", "__hash__", "__repr__"):
            if name not in vars(cls):
                setattr(cls, name, getattr(cls, name))

    def __eq__(self, other: object) -> bool:
        """Whether the other one is of the same class and describes the same."""
        if type(other) is not type(self):
            return NotImplemented
        return self is other or self._content() == other._content()

    def __hash__(self) -> int:
        """The same for what is equal; that of a table takes all its values."""
        return hash((type(self), self._content()))

    def __repr__(self) -> str:
        """What Python makes an equal one from, without arguments left at their defaults."""
        return call(type(self).__name__, self.constructor_arguments())

    def constructor_arguments(self) -> dict[str, Any]:
        """Keyword arguments that make an equal one; those with their default values are left out.

        A class with an ``__init__`` of its own that does not take its fields by name overrides
        this.
        """
        values = ((field, getattr(self, field.name)) for field in fields(self) if field.init)
        return {
            field.name: value
            for field, value in values
            if field.default is MISSING or content(value) != content(field.default)
        }

    def _content(self) -> tuple[Any, ...]:
        return tuple(content(getattr(self, field.name)) for field in fields(self) if field.compare)


def content(value: Any) -> Any:
    """What a value describes, in a form that is equal for equal values, and can be hashed."""
    if isinstance(value, xr.DataArray):
        coords = (
            (name, axis.dims, content(axis.to_numpy())) for name, axis in value.coords.items()
        )
        return value.dims, content(value.to_numpy()), frozenset(coords)
    if isinstance(value, np.ndarray):
        return content(value.tolist())
    if isinstance(value, (list, tuple)):
        return tuple(map(content, value))
    if isinstance(value, Mapping):
        return frozenset((name, content(element)) for name, element in value.items())
    if isinstance(value, (float, np.floating)) and np.isnan(value):
        return NAN
    return value


def call(name: str, arguments: Mapping[str, Any]) -> str:
    """A call with keyword arguments, as it is written in Python."""
    return f"{name}({_listed(f'{key}={written(value)}' for key, value in arguments.items())})"


def written(value: Any) -> str:  # noqa: PLR0911
    """A value as written in Python, with numpy as ``np``, xarray as ``xr`` and names of sympy.

    Arrays that are large, or not in memory, are not written out, and then Python does not take the
    text.
    """
    if isinstance(value, xr.DataArray):
        return _labelled(value)
    if isinstance(value, np.ndarray):
        return _plain(value)
    if isinstance(value, (bool, np.bool_)):
        return str(bool(value))
    if isinstance(value, (float, np.floating)):
        return (
            repr(float(value))
            if np.isfinite(value)
            else f"np.{float(value)}".replace("np.-", "-np.")
        )
    if isinstance(value, np.integer):
        return str(int(value))
    if isinstance(value, list):
        return f"[{_listed(map(written, value))}]"
    if isinstance(value, tuple):
        return f"({_listed(map(written, value))}{',' if len(value) == 1 else ''})"
    if isinstance(value, Mapping):
        return f"{{{_listed(f'{name!r}: {written(element)}' for name, element in value.items())}}}"
    if isinstance(value, type):
        return value.__name__
    return _of_sympy(value) if hasattr(value, "free_symbols") else repr(value)


def _listed(texts: Iterable[str]) -> str:
    return ", ".join(texts)


def _labelled(array: xr.DataArray) -> str:
    """A labelled array; one of cases without coordinates is a list, from which models make it."""
    if array.size > MOST_WRITTEN or not isinstance(array.data, np.ndarray):
        sizes = _listed(f"{name}: {size}" for name, size in array.sizes.items())
        return f"<array over {sizes}>"
    values = _plain(array.to_numpy())
    if array.dims == (CASE,) and not array.coords:
        return values
    coords = {str(name): (axis.dims, axis.to_numpy()) for name, axis in array.coords.items()}
    also = f", coords={written(coords)}" if coords else ""
    return f"xr.DataArray({values}, dims={written(array.dims)}{also})"


def _plain(array: np.ndarray[Any, Any]) -> str:
    if array.size > MOST_WRITTEN:
        return f"<array of {_listed(map(str, array.shape))}>"
    if array.dtype.kind in "mM":  # times, which are no numbers
        return f"np.array({array.astype(str).tolist()}, dtype={array.dtype.str!r})"
    return written(array.tolist())


def _of_sympy(expression: Any) -> str:
    """An expression with the assumptions on its symbols and all digits of its numbers."""
    from sympy.printing.repr import ReprPrinter

    class Printer(ReprPrinter):  # type: ignore[misc]
        def _print_ExprCondPair(self, pair: Any) -> str:  # noqa: N802 - so sympy calls it
            # The name of the class is not among those of sympy.
            return f"({self._print(pair.expr)}, {self._print(pair.cond)})"

    return str(Printer().doprint(expression))
