"""Parameters of models: each is declared once with its unit and range, and checked when given."""

from __future__ import annotations

import copy
import dataclasses
import functools
import operator
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from typing import Any, ClassVar, Self

import numpy as np
import numpy.typing as npt
import pandas as pd
import xarray as xr

from stochlin.messages import Named, brief, hyphenated, sentence
from stochlin.models.descriptions import stated
from stochlin.models.plausible import Plausible, implausible, limits_of, unquestioned, warn_caller
from stochlin.models.uncertain import (
    Uncertain,
    UncertainModel,
    WithoutCells,
    as_array,
    median_of,
)
from stochlin.models.units import parsed, size_of
from stochlin.models.values import CASE, ByValue

_Number = float | np.floating | np.integer
Parameter = (
    _Number | xr.DataArray | Sequence[_Number] | npt.NDArray[np.floating | np.integer] | Uncertain
)
"""A number, a DataArray (broadcast by dimension name) or a 1-D array (dimension ``case``)."""

FOR_ONE_BUILDING = (
    "one building alone is first, with None as second, "
    "in separation, recorded_gap and pounding_risk"
)
TAKERS = (
    "separation, existing_gap, sensitivity, pounding_probability, pounding_risk, required_gap, "
    "mitigate, and simulate with a duration, take them"
)


@dataclasses.dataclass(frozen=True)
class Range:
    """Interval of allowed values, open at an end unless ``include_lower`` or ``include_upper``."""

    lower: float = 0.0
    upper: float = np.inf
    include_lower: bool = False
    include_upper: bool = False
    reason: str = ""

    def __str__(self) -> str:
        at_least = "<=" if self.include_lower else "<"
        at_most = "<=" if self.include_upper else "<"
        low = f"{self.lower:g} {at_least} " if self.lower > -np.inf else ""
        high = f" {at_most} {self.upper:g}" if self.upper < np.inf else ""
        return f"{low}value{high}, finite" + (f" ({self.reason})" if self.reason else "")

    def contains(self, value: Any) -> Any:
        """Elementwise test whether values are allowed; NaN and infinity never are."""
        above = value >= self.lower if self.include_lower else value > self.lower
        below = value <= self.upper if self.include_upper else value < self.upper
        return above & below & np.isfinite(value)


NO_UNIT = ("", "1", "-", "dimensionless")
POSITIVE = Range()
NOT_NEGATIVE = Range(include_lower=True)
ANY_NUMBER = Range(-np.inf)
# Of structures and grounds in seconds, where their frequencies and those of others are of use
# together.
PERIODS = Range(1e-9, 1e9, include_lower=True, include_upper=True)


def parameter(
    units: str,
    long_name: str,
    allowed: Range,
    default: Any = dataclasses.MISSING,
    *,
    scalar: bool = False,
) -> Any:
    """Declare a physical parameter of a model as a dataclass field; a ``scalar`` takes no array."""
    metadata = {"units": units, "long_name": long_name, "allowed": allowed, "scalar": scalar}
    return dataclasses.field(default=default, metadata=metadata)


class _ModelType(Named):
    """The type of models: a model is made here, with a warning of implausible values."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        """A new model, or an `UncertainModel` if an argument is `Uncertain`."""
        values = dict(zip(self.__match_args__, args, strict=False)) | kwargs
        uncertain = [name for name, value in values.items() if isinstance(value, Uncertain)]
        if uncertain:
            self.check_uncertain(uncertain)
        with unquestioned():
            made = (
                UncertainModel.of(self, args, kwargs)
                if uncertain
                else super().__call__(*args, **kwargs)
            )
        values["intensity"] = None  # only functions that give metres ask about it
        limits = self.limits()
        of_one = issubclass(self, WithoutCells)

        def doubts() -> Iterable[str]:
            return [*implausible(values, limits, of_one=of_one)] or median_of(made).doubts()

        warn_caller(self.__name__, doubts)
        return made


@dataclasses.dataclass(frozen=True)
class Model(ByValue, metaclass=_ModelType):
    """Base of all models that a user describes; it checks and labels the declared parameters.

    A scalar out of range raises an error at once. An array may have cells out of range: the
    analyses mark these cells in ``status`` and compute the others.
    """

    # declared by ``base=True`` of a class: others are to derive from it
    is_base: ClassVar[bool] = True
    # arguments of a function; messages then omit the class name
    of_arguments: ClassVar[bool] = False
    # limits of parameters that mean something else here
    other_limits: ClassVar[Mapping[str, Plausible]] = {}
    number_of: ClassVar[str] = ""  # what a parameter that is no array is a number of, for messages
    instead: ClassVar[str] = ""  # advice in the message of a function that does not take this model

    def __init_subclass__(cls, base: bool = False, **options: Any) -> None:
        super().__init_subclass__(**options)
        cls.is_base = base

    def moves_as(self, other: object) -> bool:
        """Whether the displacements of another model are always those of this one."""
        return self == other

    @classmethod
    def check_uncertain(cls, names: Collection[str]) -> None:
        """Raise a ValueError if a parameter with one of these names cannot be uncertain."""
        if cls.of_arguments:
            raise ValueError(f"{', '.join(names)} is uncertain; allowed: numbers")

    def __post_init__(self) -> None:
        prefix = "" if self.of_arguments else f"{type(self).__name__}: "
        several = []
        for field in self._declared():
            value = getattr(self, field.name)
            if value is not None or field.default is not None:
                checked = check(prefix, field.name, value, field.metadata)
                object.__setattr__(self, field.name, checked)
                several += [checked] if isinstance(checked, xr.DataArray) else []
                if isinstance(checked, xr.DataArray) and field.metadata["scalar"]:
                    what = f"{prefix}{field.name} is an array"
                    raise ValueError(f"{what}; allowed: a number{self.number_of}")
        check_alignment(f"{prefix}parameters", *several)

    @classmethod
    @functools.cache
    def _declared(cls) -> tuple[dataclasses.Field[Any], ...]:
        return tuple(field for field in dataclasses.fields(cls) if "allowed" in field.metadata)

    @classmethod
    def kinds(cls) -> Collection[type[Model]]:
        """What messages list as allowed: this class, or of a base the classes derived from it."""
        return (
            {kind for subclass in cls.__subclasses__() for kind in subclass.kinds()}
            if cls.is_base
            else {cls}
        )

    @classmethod
    def parameter_names(cls) -> tuple[str, ...]:
        """Names of the physical parameters."""
        return tuple(field.name for field in cls._declared())

    @classmethod
    def allowed(cls, name: str) -> Range:
        """The allowed values of a parameter."""
        return cls.__dataclass_fields__[name].metadata["allowed"]

    @classmethod
    @functools.cache
    def limits(cls) -> Mapping[str, Plausible]:
        """The plausible values of what describes the model, by name."""
        fields = dataclasses.fields(cls)
        return {f.name: cls.other_limits.get(f.name) or limits_of(f.name) for f in fields}

    @classmethod
    def units(cls, name: str) -> str:
        """The unit of a parameter."""
        return str(cls.__dataclass_fields__[name].metadata["units"])

    @functools.cached_property
    def _cells(self) -> dict[str, Any]:
        return {
            f.name: value for f in self._declared() if (value := getattr(self, f.name)) is not None
        }

    def cells(self) -> dict[str, Any]:
        """The parameters that are set, by name: numbers, or labelled arrays."""
        return dict(self._cells)

    @functools.cached_property
    def _arrays(self) -> dict[str, xr.DataArray]:
        return {name: xr.DataArray(value) for name, value in self._cells.items()}

    def arrays(self) -> dict[str, xr.DataArray]:
        """The parameters that are set, by name, as labelled arrays (0-d for scalars)."""
        return dict(self._arrays)

    def over_cells(self) -> dict[str, xr.DataArray]:
        """The parameters whose dimensions become dimensions of a result, as labelled arrays."""
        return self.arrays()

    def isel(self, indexers: Mapping[Any, int | slice]) -> Self:
        """The model at these indices, with a number where an array has no dimension left.

        Dimensions that the model does not have are ignored.
        """
        arrays = {name: array for name, array in self.arrays().items() if array.ndim}
        chosen = ((n, array.isel(indexers, missing_dims="ignore")) for n, array in arrays.items())
        return self.with_arrays({n: array if array.ndim else float(array) for n, array in chosen})

    def with_arrays(self, arrays: Mapping[str, Parameter]) -> Self:
        """A copy of the model with these arrays as parameters, without checking them again."""
        changed = copy.copy(self)
        for made in ("_cells", "_arrays"):
            changed.__dict__.pop(made, None)
        for name, array in arrays.items():
            object.__setattr__(changed, name, array)
        return changed

    def valid(self) -> xr.DataArray:
        """True for the cells in which every parameter is in its range."""
        # Numbers are left out: they were checked when the model was made.
        arrays = {n: value for n, value in self.cells().items() if isinstance(value, xr.DataArray)}
        inside = (
            array.copy(data=self.allowed(n).contains(array.data)) for n, array in arrays.items()
        )
        return functools.reduce(operator.and_, inside, xr.DataArray(True))

    def doubts(self) -> Iterator[str]:
        """Texts on what follows from the parameters and is implausible."""
        return iter(())

    def describe(self) -> str:
        """The model with its parameters in one line, for metadata and charts; arrays by range."""
        shown = ", ".join([*self.stated(), *self.further()])
        name = getattr(self, "name", hyphenated(type(self).__name__))
        return shown if self.of_arguments else f"{name} ({shown})"

    def stated(self) -> list[str]:
        """The parameters that are set, with their units, without zeros that are their defaults."""
        return [
            stated(name, value, self.units(name))
            for name, value in self.cells().items()
            if np.ndim(value) or value or self.__dataclass_fields__[name].default != 0
        ]

    def further(self) -> list[str]:
        """What describes the model besides its parameters."""
        return []


def expect(value: object, kind: type[Model] | tuple[type[Model], ...], role: str) -> None:
    """Raise a TypeError unless ``value``, the argument ``role``, is of a class in ``kind``."""
    if not isinstance(value, kind):
        kinds = kind if isinstance(kind, tuple) else (kind,)
        names = ", ".join(sorted(c.__name__ for model in kinds for c in model.kinds()))
        instead = f"; {value.instead}" if isinstance(value, Model) and value.instead else ""
        if isinstance(value, UncertainModel):
            instead = f", without uncertain parameters, so give its median(); {TAKERS}"
        if value is None and role in ("first", "second"):
            instead = f"; {FOR_ONE_BUILDING}"
        raise TypeError(f"{role} = {brief(value)} is of the wrong kind; allowed: {names}{instead}")


def check_alignment(what: str, *arrays: xr.DataArray) -> None:
    """Raise a ValueError if dimensions of the same name differ in coordinates or length.

    Arithmetic would keep the coordinates that arrays have in common, and leave out the others.
    ``what`` the arrays are begins the message, in the plural.
    """
    if len(arrays) < 2:
        return
    try:
        xr.align(*arrays, join="exact", copy=False)
    except (xr.AlignmentError, ValueError) as error:
        what = f"{what} share a dimension whose coordinates or lengths differ"
        cure = "give them different dimension names for a table, or equal coordinates"
        raise ValueError(f"{what}: {sentence(error)}; {cure}") from error


def check_units(label: str, stated: object, units: str) -> None:
    """Raise a ValueError if an array states an unknown unit, or one in which values are not taken.

    Another quantity is no reason, but for the inverse: arithmetic with arrays keeps the attributes
    of the first of them.
    """
    unit = "" if stated is None else str(stated)
    other = parsed(unit) is None and unit not in NO_UNIT
    inverse = units != "1" and size_of(unit, f"1/{units}")
    if other or inverse or size_of(unit, units) not in (None, 1.0):
        what = f"{label} is in {brief(stated)}, by its attribute units"
        raise ValueError(f"{what}; allowed: {units}, so convert its values, and state it there")


def check(prefix: str, name: str, value: Any, declared: Mapping[str, Any]) -> float | xr.DataArray:
    """The value of a parameter, checked against its declared range and labelled with its unit.

    ``declared`` is the metadata of `parameter`; ``prefix`` precedes the name in messages.
    """
    label = f"{prefix}{name}"
    allowed = declared["allowed"]
    # The index has labels, which must agree.
    if isinstance(value, pd.Series) and type(value.index) is pd.Index:
        value = xr.DataArray(value.to_numpy(), {CASE: value.index.to_numpy()}, CASE)
    array = value if isinstance(value, xr.DataArray) else as_array(value)
    if array.dtype.kind not in "iuf":
        shown = (
            brief(value) if array.ndim == 0 else f"{brief(np.ravel(array)[:2].tolist())}, an array,"
        )
        raise TypeError(f"{label} = {shown} is not a real number; allowed: {allowed}")
    if isinstance(value, xr.DataArray):
        check_units(label, value.attrs.get("units"), declared["units"])
    if array.ndim == 0:
        number = float(array)
        if not allowed.contains(number):
            raise ValueError(f"{label} = {number:g} is out of range; allowed: {allowed}")
        return number
    if isinstance(array, np.ndarray):
        if array.ndim > 1:
            what = f"{label} is a plain array of {array.ndim} dimensions"
            raise ValueError(f"{what}; allowed: a number, a 1-D array, or an xarray.DataArray")
        array = xr.DataArray(array, dims=CASE)
    if not array.size:
        raise ValueError(f"{label} is empty; allowed: at least one value")
    described = {key: declared[key] for key in ("units", "long_name")}
    array = array.copy(data=array.data.astype(float))
    array.attrs = described | array.attrs
    if name in array.coords:
        axis = array.coords[name]
        array = array.assign_coords({name: axis.assign_attrs(described | axis.attrs)})
    return array
