"""Arguments of functions: what is allowed is declared once, as a type, and checked before the call.

A public function names the types below in its signature and is decorated by `checked`. Words that
are fixed are a ``Literal``, so that type checkers know them; to these ``paths: Paths`` is an
``int``. A call with another value is refused by name, value and what is allowed. Arguments that are
models are checked by their classes, and parameters of models by the models.
"""

from __future__ import annotations

import functools
import inspect
import types
import typing
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal, TypeGuard, TypeVar, overload

import numpy as np
import numpy.typing as npt
import xarray as xr

from stochlin.messages import brief, check_names, hint
from stochlin.models.parameters import POSITIVE, Model, Range, expect
from stochlin.models.plausible import (
    LARGEST_NUMBER,
    PLAUSIBLE,
    implausible,
    unquestioned,
    warn_caller,
)
from stochlin.models.uncertain import UncertainModel, as_array, median_of

LONGEST_LABEL = 200
A_LABEL = f"a text on one line, {LONGEST_LABEL} characters at most, no control characters"
LARGEST_WHOLE = 2**63 - 1  # largest whole number of files and compiled code
MOST_SCATTER = 2.0  # standard deviation of a logarithm: factors from 0.14 to 7 are within one of it

Function = TypeVar("Function", bound=Callable[..., Any])
Check = Callable[[str, Any], None]  # of the name of an argument and its value
InMetres = bool | Callable[[Mapping[str, Any]], bool]


def is_number(value: object) -> TypeGuard[float]:
    """Whether ``value`` is a real number in the range of floats, or NaN; True and False are not."""
    real = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return real and not (isinstance(value, int) and abs(value) > LARGEST_NUMBER)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether ``value`` is a whole number; True and False are not."""
    return isinstance(value, (int, np.integer)) and not isinstance(value, bool)


def is_label(value: object) -> TypeGuard[str]:
    """Whether ``value`` is a line of text that can be shown in a table and a picture."""
    text = value if isinstance(value, str) and value.isprintable() else ""
    return 0 < len(text.strip()) <= len(text) <= LONGEST_LABEL


def as_numbers(name: str, value: object, allowed: str) -> npt.NDArray[Any]:
    """The array of ``value``; raises a TypeError unless it has real numbers only."""
    array = as_array(value)
    if array.dtype.kind not in "iuf":
        raise TypeError(f"{name} = {brief(value)}; allowed: {allowed}")
    return array


@dataclass(frozen=True)
class Number:
    """One number in a range, which ``words`` describe."""

    allowed: Range
    words: str = ""
    is_share: bool = False  # which may have been written in percent

    def __call__(self, name: str, value: object) -> None:
        """Raise a ValueError unless the value is in the range."""
        what = "is no number"
        cure = ""
        if is_number(value):
            what = "is out of range"
            number = float(value)  # whole numbers may be beyond 64 bits
            if self.allowed.contains(number):
                return
            if self.is_share and number >= 2 and self.allowed.contains(number / 100):
                cure = f"; for {value:g} % write {number / 100:g}"
        raise ValueError(
            f"{name} = {brief(value)} {what}; allowed: {self.words or self.allowed}{cure}"
        )


@dataclass(frozen=True)
class Whole:
    """A whole number between two limits, both of them allowed."""

    lowest: int
    highest: int | None = None

    def contains(self, value: object) -> bool:
        """Whether a value is a whole number within the limits."""
        highest = LARGEST_WHOLE if self.highest is None else self.highest
        return is_whole(value) and self.lowest <= value <= highest

    def __str__(self) -> str:
        if self.highest is None:
            return f"a whole number from {self.lowest} on"
        if self.highest == self.lowest + 1:
            return f"{self.lowest} or {self.highest}"
        return f"a whole number from {self.lowest} to {self.highest}"

    def refusal(self, value: object) -> str:
        """What is wrong with a value that is not within the limits, and what is allowed."""
        if not is_whole(value):
            return f"is no whole number; allowed: {self}"
        unsaid = self.highest is None and value > LARGEST_WHOLE  # a limit that seldom matters
        return f"is out of range; allowed: {Whole(self.lowest, LARGEST_WHOLE) if unsaid else self}"

    def __call__(self, name: str, value: object) -> None:
        """Raise a ValueError unless the value is a whole number within the limits."""
        if not self.contains(value):
            raise ValueError(f"{name} = {brief(value)} {self.refusal(value)}")


@dataclass(frozen=True, eq=False)  # a registry has no hash
class OneOf:
    """One of some names; those of a registry are read when they are needed."""

    names: Collection[str]

    def __call__(self, name: str, value: object) -> None:
        """Raise a ValueError with the nearest name, unless the value is one of the names."""
        if not isinstance(value, str) or value not in self.names:
            said = hint(value, self.names) if isinstance(value, str) else ""
            allowed = ", ".join(self.names)
            raise ValueError(f"{name} = {brief(value)} is not known; {said}allowed: {allowed}")


@dataclass(frozen=True)
class OfClass:
    """A model of one of some classes."""

    classes: tuple[type[Model], ...]
    uncertain: bool = False  # whether its parameters may be uncertain

    def __call__(self, name: str, value: object) -> None:
        """Raise a TypeError unless the value is such a model."""
        uncertain = self.uncertain and isinstance(value, UncertainModel)
        expect(median_of(value) if uncertain else value, self.classes, name)


def check_truth(name: str, value: object) -> None:
    """Raise a TypeError unless ``value`` is True or False."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} = {brief(value)}; allowed: True or False")


def check_two_numbers(name: str, value: object) -> None:
    """Raise a TypeError unless ``value`` is a pair of numbers."""
    if as_numbers(name, value, "two numbers").shape != (2,):
        raise TypeError(f"{name} = {brief(value)}; allowed: two numbers")


def check_label(name: str, value: object) -> None:
    """Raise a ValueError unless ``value`` is a text that can be shown in a table and a picture."""
    if not is_label(value):
        raise ValueError(f"{name} = {brief(value)}; allowed: {A_LABEL}")


def check_quantiles(name: str, value: object) -> None:
    """Raise an error unless ``value`` is a list of numbers between 0 and 1."""
    allowed = "numbers between 0 and 1"
    levels = as_numbers(name, value, allowed)
    if levels.ndim != 1 or not levels.size or not ((levels > 0) & (levels < 1)).all():
        raise ValueError(f"{name} = {brief(value)}; allowed: {allowed}")


GAP_OF_RESULT = PLAUSIBLE["gap of a result"]
SCATTER = Number(
    Range(0, MOST_SCATTER, include_lower=True, include_upper=True),
    f"a number from 0 to {MOST_SCATTER:g}, the standard deviation of ln(strength of a motion)",
    is_share=True,
)
DURATION_IN_SECONDS = Number(
    POSITIVE, "a positive, finite number of seconds, the length of the motion"
)
Truth = Annotated[bool, check_truth]
Label = Annotated[str, check_label]
TwoNumbers = Annotated[tuple[float, float], check_two_numbers]
Quantiles = Annotated[Sequence[float], check_quantiles]
Seed = Annotated[int, Whole(0)]
Paths = Annotated[int, Whole(2)]
Points = Annotated[int, Whole(2)]
StepsPerPeriod = Annotated[int, Whole(8)]
RelaxationTimes = Annotated[
    float, Number(Range(1, include_lower=True), "a finite number of at least 1")
]
Metres = Annotated[float, Number(POSITIVE, "a positive, finite number of metres")]
Duration = Annotated[float, DURATION_IN_SECONDS]
Seconds = Annotated[float, Number(POSITIVE, "a positive, finite number of seconds")]
Years = Annotated[float, Number(POSITIVE, "a positive, finite number of years")]
Acceleration = Annotated[float, Number(POSITIVE, "a positive, finite number in m/s^2")]
Probability = Annotated[float, Number(Range(0, 1), "a probability between 0 and 1", is_share=True)]
DampingOrZero = Annotated[float, Number(Range(0, 1, True), "0 <= damping < 1", is_share=True)]
DampingRatio = Annotated[float, Number(Range(0, 1), "0 < damping < 1", is_share=True)]
Scatter = Annotated[float, SCATTER]


@overload
def checked(function: Function) -> Function: ...
@overload
def checked(
    *, uncertain: bool = ..., in_metres: InMetres = ...
) -> Callable[[Function], Function]: ...
def checked(function: Any = None, *, uncertain: bool = False, in_metres: InMetres = False) -> Any:
    """The function, whose arguments are checked first, by the types in its signature.

    Models among them may have ``uncertain`` parameters. With ``in_metres``, or where it is true of
    the arguments by name, results are in metres: the intensity of ``ground`` must then be that of a
    motion.
    """
    if function is None:
        return partial(checked, uncertain=uncertain, in_metres=in_metres)
    parameters = inspect.signature(function).parameters
    by_place = [n for n, p in parameters.items() if p.kind == p.POSITIONAL_OR_KEYWORD]

    @functools.wraps(function)
    def call(*args: Any, **kwargs: Any) -> Any:
        check_names(function.__name__, kwargs, parameters)
        values = dict(zip(by_place, args, strict=False)) | kwargs
        for name, check in checks_of(function, uncertain):
            if name in values:
                check(name, values[name])
        warn_caller(
            function.__name__, lambda: [*_doubts(values, in_metres), *_of_types(function, values)]
        )
        with unquestioned():
            made = function(*args, **kwargs)
        if isinstance(made, Model):  # of a file, or computed
            warn_caller(function.__name__, made.doubts)
        if (
            isinstance(made, xr.Dataset)
            and "gap" in made.data_vars
            and not {"gap", "gaps"} & {*values}
        ):
            warn_caller(
                function.__name__, lambda: implausible({"gap": made.gap}, {"gap": GAP_OF_RESULT})
            )
        return made

    return call


def _doubts(values: dict[str, Any], in_metres: InMetres) -> Iterator[str]:
    """Texts on arguments that are implausible or have no effect."""
    of_ground = getattr(median_of(values.get("ground")), "intensity", 0)
    of_motion = in_metres(values) if callable(in_metres) else in_metres
    yield from implausible(values | {"intensity": of_ground if of_motion else 0})
    for value in values.values():
        if isinstance(value, Mapping):  # facts for codes
            yield from implausible(value)
    first = values.get("first")
    second = values.get("second")
    if of_motion and isinstance(first, Model) and first.moves_as(second):
        yield "first and second are the same building, which need no gap; usual are two that differ"
    several = values.get("structures")
    for value in (*values.values(), *(several if isinstance(several, (list, tuple)) else ())):
        structure = median_of(value)
        idle = "ductility" not in values and not getattr(structure, "yields", True)
        if idle and np.any(structure.cells().get("hardening", 1.0) != 1):
            strength = structure.strength_name
            strength += "" if structure.has_storeys else " or reduction_factor"
            yield f"hardening = {brief(structure.hardening)} has no effect without {strength}"
    envelope = values.get("envelope")
    end = values.get("duration")
    described = median_of(values.get("ground"))
    if is_number(end) and hasattr(described, "doubts_of_use"):
        yield from described.doubts_of_use(end, envelope, _longest_period(values))
    if envelope is not None and end is not None and (warning := envelope.doubt(end)):
        yield f"duration = {end:g}: {warning}"


def _longest_period(values: dict[str, Any]) -> float:
    """The longest first period [s] of the structures among arguments; 0 without any."""
    several = values.get("structures")
    row = several if isinstance(several, (list, tuple)) else ()
    models = [median_of(argument) for argument in (values.get("first"), values.get("second"), *row)]
    structures = [model for model in models if hasattr(model, "first_period")]
    return max((float(model.first_period().max()) for model in structures), default=0.0)


def _of_types(function: Callable[..., Any], values: dict[str, Any]) -> Iterator[str]:
    """Texts on arguments whose type says what is asked about them."""
    for name, of in with_doubts(function):
        if name in values:
            yield from of.doubts(name, values[name])


def check_fields(described: Any, prefix: str = "") -> None:
    """Check fields of a dataclass as `checked` checks arguments; messages begin with ``prefix``."""
    for name, check in checks_of(described.__class__):
        check(f"{prefix}{name}", getattr(described, name))


@functools.cache
def checks_of(called: Callable[..., Any], uncertain: bool = False) -> tuple[tuple[str, Check], ...]:
    """Name and check of the arguments of a function or dataclass that have a check.

    Models may have ``uncertain`` parameters.
    """
    declared = typing.get_type_hints(called, include_extras=True)
    names = inspect.signature(called).parameters
    return tuple(
        (name, check) for name in names for check in _checks(declared.get(name), uncertain)
    )


@functools.cache
def with_doubts(called: Callable[..., Any]) -> list[tuple[str, Any]]:
    """Name and annotation of the arguments of a function whose type has a method ``doubts``."""
    declared = typing.get_type_hints(called, include_extras=True)
    return [
        (name, annotation)
        for name in inspect.signature(called).parameters
        for kind in (declared.get(name), *typing.get_args(declared.get(name)))
        for annotation in getattr(kind, "__metadata__", ())
        if hasattr(annotation, "doubts")
    ]


def _checks(declared: Any, uncertain: bool) -> list[Check]:
    """The checks of a type: those that it is annotated with, or of its classes if these are models.

    With None in the type, None passes.
    """
    union = typing.get_origin(declared) in (typing.Union, types.UnionType)
    options = list(typing.get_args(declared)) if union else [declared]
    kinds = [option for option in options if option is not types.NoneType]
    declared_with = [
        annotation for kind in kinds for annotation in getattr(kind, "__metadata__", ())
    ]
    checks: list[Check] = [annotation for annotation in declared_with if callable(annotation)]
    checks += [OneOf(typing.get_args(kind)) for kind in kinds if typing.get_origin(kind) is Literal]
    if all(isinstance(kind, type) and issubclass(kind, Model) for kind in kinds):
        checks = [OfClass(tuple(kinds), uncertain)]
    return (
        [partial(_unless_none, check) for check in checks] if len(kinds) < len(options) else checks
    )


def _unless_none(check: Check, name: str, value: Any) -> None:
    if value is not None:
        check(name, value)
