"""Uncertain parameters, and models that have such parameters."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import wraps
from types import MethodType
from typing import Any, Literal, Self, TypeVar, get_args

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy.special import ndtri

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import Named, brief, check_call, check_names, hyphenated
from stochlin.models.descriptions import span, stated
from stochlin.models.plausible import implausible, unquestioned, warn_caller
from stochlin.models.values import ByValue, call

One = TypeVar("One")
Distribution = Literal["lognormal", "uniform"]
DISTRIBUTIONS: tuple[Distribution, ...] = get_args(Distribution)
# probability below and above the two extreme values at which a model is tried
TAIL_PROBABILITY = 1e-4


def as_array(value: object) -> npt.NDArray[Any]:
    """The array of ``value``, with NaN for masked numbers; without dimensions if it is no array."""
    try:
        array = np.ma.asarray(value) if isinstance(value, (list, tuple)) else np.asanyarray(value)
    except (ValueError, TypeError):  # ragged lists; a dataset
        return np.empty((), object)
    masked = np.ma.getmaskarray(array)
    return np.where(masked, np.nan, array) if masked.any() else np.asarray(array)


@dataclass(frozen=True)
class Uncertain(ByValue, metaclass=Named):
    """An uncertain parameter, with its median, its spread and the kind of its distribution.

    It can be given in place of a parameter of a structure or a ground. Every simulated motion then
    has its own sample of the parameter. All values of an array, for instance the stiffnesses of the
    storeys of one building, are multiplied by the same factor.

    Parameters
    ----------
    median : float or array
        Median in the unit of the parameter, for instance ``[s]`` for a period.
    spread : float
        Spread [-], from 0 to 1: for ``"lognormal"`` the standard deviation of the natural
        logarithm, for ``"uniform"`` the largest deviation from the median over the median.
    kind : {"lognormal", "uniform"}
        Distribution: ``median exp(spread n)`` with a standard normal ``n``, or uniform from
        ``median (1 - spread)`` to ``median (1 + spread)``.

    Raises
    ------
    ValueError, TypeError
        If the median is not a finite number, the spread is out of range, or the kind is unknown.

    References
    ----------
    Joint Committee on Structural Safety (2001), Probabilistic Model Code, for lognormal strengths.

    Examples
    --------
    >>> import stochlin as sl
    >>> period = sl.Uncertain(1.0, 0.2)
    >>> [round(float(period.at(share)), 3) for share in (0.16, 0.5, 0.84)]
    [0.82, 1.0, 1.22]
    >>> sl.Uncertain.between(0.8, 1.2).at(0.25).round(9)
    np.float64(0.9)
    >>> sl.Bilinear(period=period, damping=0.05).describe()
    'Bilinear (period 1 s ± 20 %, damping 0.05)'
    """

    median: float | npt.ArrayLike
    spread: float
    kind: Distribution = "lognormal"

    def __post_init__(self) -> None:
        median = as_array(self.median)
        if median.dtype.kind not in "iuf":
            raise TypeError(
                f"Uncertain: median = {brief(self.median)}; allowed: a number, or an array"
            )
        if not np.isfinite(median).all():
            raise ValueError(f"Uncertain: median = {brief(self.median)}; allowed: finite numbers")
        spread = self.spread
        a_number = isinstance(spread, (int, float, np.number)) and not isinstance(spread, bool)
        if not a_number or not 0 <= spread <= 1:
            cure = (
                f"; for {spread:g} % write {spread / 100:g}"
                if a_number and 1 < spread <= 100
                else ""
            )
            raise ValueError(
                f"Uncertain: spread = {brief(spread)}; allowed: 0 to 1, 0.2 for 20 %{cure}"
            )
        if not isinstance(self.kind, str) or self.kind not in DISTRIBUTIONS:
            raise ValueError(
                f"Uncertain: kind = {brief(self.kind)}; allowed: {', '.join(DISTRIBUTIONS)}"
            )

    @classmethod
    def between(cls, low: float, high: float) -> Self:
        """A parameter with a uniform distribution from ``low`` to ``high``, both positive."""
        if not 0 < low <= high < np.inf:
            raise ValueError(f"Uncertain: from {low:g} to {high:g}; allowed: 0 < lower <= higher")
        return cls(0.5 * (low + high), (high - low) / (high + low), "uniform")

    def factor(self, share: float | Array) -> Any:
        """Quantile over the median [-], at the probability ``share``."""
        if self.kind == "uniform":
            return 1 + self.spread * (2 * np.asarray(share) - 1)
        return np.exp(self.spread * ndtri(share))

    def at(self, share: float) -> Any:
        """Quantile in the unit of the parameter, at the probability ``share``."""
        return np.asarray(self.median) * self.factor(share)

    def describe(self, units: str = "1") -> str:
        """Median and spread, or both ends, of a parameter in these units."""
        median = np.asarray(self.median, float)
        if self.kind == "uniform":
            return span(np.array([median * (1 - self.spread), median * (1 + self.spread)]), units)
        return f"{span(median, units)} ± {100 * self.spread:.4g} %"


class WithoutCells:
    """What is one model, although it may have arrays, so that it adds no dimensions to a result."""

    def over_cells(self) -> dict[str, Any]:
        """Empty: no parameter has dimensions of a result."""
        return {}

    def valid(self) -> xr.DataArray:
        """True: a model with an invalid value cannot be made."""
        return xr.DataArray(True)

    def isel(self, indexers: Mapping[Any, int | slice]) -> Self:
        """The model itself."""
        return self


@dataclass(frozen=True)
class UncertainModel(ByValue, WithoutCells):
    """A structure or a ground with uncertain parameters.

    It results when an `Uncertain` is given to a model in place of a number. ``build`` makes a
    sample of the model from ``arguments``, in which samples replace the uncertain ones.
    """

    build: Callable[..., Any]
    arguments: Mapping[str, Any]

    @classmethod
    def of(cls, build: Callable[..., Any], args: Sequence[Any], kwargs: Mapping[str, Any]) -> Self:
        """The uncertain model, after a check at the medians and at both tails of every parameter.

        ``build`` is called with keyword arguments only.
        """
        signature = inspect.signature(build)
        check_call(build.__qualname__, signature, args, kwargs)
        bound = signature.bind(*args, **kwargs)
        arguments = dict(bound.arguments)
        for name, parameter in signature.parameters.items():
            if parameter.kind is parameter.VAR_KEYWORD:
                arguments |= arguments.pop(name, {})
        model = cls(build, arguments)
        model.median()
        for name, uncertain in model.uncertain.items():
            for share in (TAIL_PROBABILITY, 1 - TAIL_PROBABILITY):
                try:
                    model.at({name: float(uncertain.factor(share))})
                except ValueError as error:
                    what = f"{error}: {name} is uncertain, {uncertain.describe()}, and may be so"
                    raise ValueError(f"{what}; give it less spread, or another kind") from error
        return model

    def __repr__(self) -> str:
        """The call that makes an equal one; what was changed since is described."""
        if inspect.isclass(self.build):
            return call(self.build.__name__, self.arguments)
        # the class whose method builds it, as ``regular`` does
        owner = getattr(self.build, "__self__", None)
        if inspect.isclass(owner):
            return call(f"{owner.__name__}.{self.build.__name__}", self.arguments)
        return f"<{self.describe()}, changed>"

    @property
    def uncertain(self) -> dict[str, Uncertain]:
        """The uncertain parameters, by name."""
        return {n: value for n, value in self.arguments.items() if isinstance(value, Uncertain)}

    def median(self) -> Any:
        """The model with all parameters at their medians."""
        return self.at({})

    def at(self, factors: Mapping[str, Any]) -> Any:
        """The model with these factors times the medians of parameters; factors default to 1."""
        values = {
            name: factors.get(name, 1.0) * np.asarray(value.median)
            for name, value in self.uncertain.items()
        }
        with unquestioned():
            return self.build(**{**self.arguments, **values})

    def changed(self, change: Callable[[Any], Any]) -> Self:
        """The uncertain model whose samples are those of this model, each after the change."""

        @wraps(self.build)
        def build(*args: Any, **kwargs: Any) -> Any:
            return change(self.build(*args, **kwargs))

        return replace(self, build=build)

    def describe(self) -> str:
        """The model with its parameters in one line."""
        kind = inspect.unwrap(self.build)
        fields = getattr(kind, "__dataclass_fields__", {}).items()
        units = {name: field.metadata.get("units") for name, field in fields}
        parts = [stated(name, value, units.get(name)) for name, value in self.arguments.items()]
        return f"{hyphenated(kind.__qualname__)} ({', '.join(parts)})"


def median_of(model: Any) -> Any:
    """A model with its uncertain parameters at their medians; for a parameter, its median."""
    if isinstance(model, Uncertain):
        return model.median
    return model.median() if isinstance(model, UncertainModel) else model


def applied(change: Callable[[Any], Any], model: Any) -> Any:
    """A model after a change; for an uncertain model, the uncertain model with changed samples."""
    return model.changed(change) if isinstance(model, UncertainModel) else change(model)


def takes_uncertain(build: Callable[..., One]) -> Callable[..., One]:
    """Decorate what becomes a classmethod; of `Uncertain` arguments it makes an UncertainModel."""
    parameters = {
        n: p for n, p in inspect.signature(build).parameters.items() if n not in ("cls", "others")
    }

    @wraps(build)
    def either(*args: Any, **kwargs: Any) -> Any:
        check_names(
            build.__qualname__, kwargs, parameters | dict(inspect.signature(args[0]).parameters)
        )
        kind, *values = args
        with unquestioned():
            if any(isinstance(value, Uncertain) for value in (*values, *kwargs.values())):
                made: Any = UncertainModel.of(MethodType(either, kind), values, kwargs)
            else:
                made = build(*args, **kwargs)

        def doubts() -> Iterable[str]:
            return [*implausible(kwargs, of_one=True)] or median_of(made).doubts()

        warn_caller(build.__qualname__, doubts)
        return made

    return either
