"""Structures: what all have in common, and oscillators of one degree of freedom that may yield.

The hysteresis law of a structure is its class, in a module of `stochlin.models.laws` or of another
package.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Collection, Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import xarray as xr
from scipy.constants import g

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.messages import listed
from stochlin.models.parameters import PERIODS, POSITIVE, Model, Parameter, Range, parameter
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.states import cannot_be_linearized, in_words
from stochlin.registry import Registry, expect_class

if TYPE_CHECKING:
    import sympy

    from stochlin.models.symbolic import SymbolicLaw

DAMPING_RATIO = Range(upper=1.0, reason="a ratio, 0.05 for 5 %")
HARDENING = Range(
    lower=-1.0,
    upper=1.0,
    include_upper=True,
    reason=(
        "0 is elastic-plastic, less softens as by P-delta; a stationary response needs more than 0"
    ),
)
STATIONARY_HARDENING = Range(
    upper=1.0, include_upper=True, reason="without hardening there is no stationary displacement"
)

GAUSSIAN = "gaussian"  # every law has this closure, by quadrature if not in closed form
DRIFT = "drift"  # the clipped closure, with the plastic drift that the clipped closure omits
CURE = "follow it in motions of finite length, by simulate with a duration, or separation"
CHECKED = 8  # largest number of parameter sets for which a law is checked


def _check_law(law: Any) -> None:
    """Raise a ValueError for what is no law: it has rates in symbols, or steps of other kinds."""
    has_steps = getattr(law, "step", Structure.step) is not Structure.step
    expect_class(law, Structure, *(() if has_steps else ("symbolic",)))


LAWS: Registry[type[Structure]] = Registry("law", "stochlin.models.laws", check=_check_law)
# Functions that return their closure of a law, or None for a law that does not have it.
CLOSURES: Registry[Callable[[type[Structure]], Closure | None]] = Registry(
    "closure", "stochlin.models.closures"
)


class AnyStructure(Model, base=True):
    """Base of all structures: oscillators, and buildings with floors."""

    has_storeys: ClassVar[bool]
    strength_name: ClassVar[str]  # the parameter with the strength [m]
    damping: Any
    hardening: Any

    @property
    @abstractmethod
    def yields(self) -> bool:
        """Whether a strength is given, so that the structure can yield."""

    @property
    @abstractmethod
    def floor_count(self) -> int:
        """Number of floors; an oscillator has one."""

    @property
    @abstractmethod
    def has_mass(self) -> bool:
        """Whether a mass is given, so that the structure can act on others."""

    @property
    @abstractmethod
    def by_reduction_factor(self) -> bool:
        """Whether the strength follows from the ground by a reduction factor."""

    @abstractmethod
    def levels(self) -> Array:
        """Levels of the floors above the ground [m], (floors,); NaN for an oscillator."""

    @abstractmethod
    def first_mode(self) -> Structure:
        """An oscillator itself, or the first mode of a building as an oscillator."""

    @abstractmethod
    def first_period(self) -> xr.DataArray:
        """Period of an oscillator, or of the first mode of a building [s]."""

    @abstractmethod
    def elastic(self) -> Self:
        """The structure without its strength."""


@dataclass(frozen=True)
class Structure(AnyStructure, base=True):
    """Base of oscillators, eq. (5): ``mu'' + 2 xi w mu' + w^2 (alpha mu + (1 - alpha) z) = f/uy``.

    The strength is given by ``yield_displacement`` or by ``reduction_factor``; without either of
    them the structure stays elastic. A mass is needed only by structures that act on one another,
    through a `Link` or in pounding.

    A hysteresis law is a subclass that is registered in `LAWS`. It declares its own parameters and
    gives the expression of the law by ``symbolic``. Closures and time steps are derived from this
    expression unless the subclass has its own.
    """

    has_storeys = False
    strength_name = "yield_displacement"
    closures: ClassVar[Mapping[str, Closure]] = {}  # of this law alone, in closed form, by name

    period: Parameter = parameter("s", "period of small oscillations", PERIODS)
    damping: Parameter = parameter("1", "damping ratio", DAMPING_RATIO)
    hardening: Parameter | None = parameter("1", "hardening ratio", HARDENING, None)
    yield_displacement: Parameter | None = parameter("m", "yield displacement", POSITIVE, None)
    reduction_factor: Parameter | None = parameter("1", "reduction factor", POSITIVE, None)
    peak_factor: Parameter = parameter("1", "peak factor", POSITIVE, 3.0)
    _: KW_ONLY
    mass: float | None = parameter("kg", "mass", POSITIVE, None, scalar=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        name = type(self).__name__
        if self.yield_displacement is not None and self.reduction_factor is not None:
            raise ValueError(
                f"{name}: yield_displacement and reduction_factor; allowed: one of them"
            )
        if self.yields and self.hardening is None:
            raise ValueError(
                f"{name}: hardening is not given beside a strength; allowed: {HARDENING}"
            )

    def doubts(self) -> Iterator[str]:
        """Text on period and yield displacement, if no building has their acceleration at yield."""
        numbers = self.cells()
        period = numbers["period"]
        displacement = numbers.get("yield_displacement")
        if not (isinstance(period, float) and isinstance(displacement, float)):
            return
        values = {"period": period, "yield_displacement": displacement}
        if all(PLAUSIBLE[name].holds(value) for name, value in values.items()):
            acceleration = (2 * np.pi / period) ** 2 * displacement
            if text := doubt_of_strength(acceleration):
                both = f"{displacement:.3g} m with a period of {period:.3g} s"
                yield f"yield_displacement = {both} is {text}"

    def moves_as(self, other: object) -> bool:
        """Whether it is the same oscillator, also with another mass."""
        return isinstance(other, type(self)) and self == replace(other, mass=self.mass)

    @property
    def yields(self) -> bool:
        """Whether a strength is given, so that the structure can yield."""
        return self.yield_displacement is not None or self.reduction_factor is not None

    @property
    def floor_count(self) -> int:
        """1, as for a building of one storey."""
        return 1

    @property
    def has_mass(self) -> bool:
        """Whether a mass is given, so that the structure can act on others."""
        return self.mass is not None

    @property
    def by_reduction_factor(self) -> bool:
        """Whether the strength is given by ``reduction_factor``."""
        return self.reduction_factor is not None

    def levels(self) -> Array:
        """NaN, (1,): an oscillator has no height."""
        return np.full(1, np.nan)

    def first_mode(self) -> Structure:
        """The oscillator itself."""
        return self

    def first_period(self) -> xr.DataArray:
        """The period [s]."""
        return self.arrays()["period"]

    def elastic(self) -> Self:
        """The oscillator without its strength."""
        return replace(self, yield_displacement=None, reduction_factor=None)

    @classmethod
    def kinds(cls) -> Collection[type[Model]]:
        """The registered laws, which messages list as allowed."""
        return LAWS.values() if cls is Structure else super().kinds()

    @classmethod
    @cache
    def own_parameters(cls) -> tuple[str, ...]:
        """Names of the parameters that this law adds to those of every structure."""
        common = Structure.parameter_names()
        return tuple(name for name in cls.parameter_names() if name not in common)

    @classmethod
    def closure_names(cls) -> tuple[str, ...]:
        """Names that `linearize` accepts for this law."""
        registered = (name for name, of_law in CLOSURES.items() if of_law(cls) is not None)
        return tuple(dict.fromkeys((GAUSSIAN, *cls.closures, *registered)))

    @classmethod
    def closed_form(cls, name: str) -> Closure | None:
        """The closure ``name`` of this law in closed form; None if it has none."""
        if name in cls.closures:
            return cls.closures[name]
        return CLOSURES[name](cls) if name in CLOSURES else None

    def symbolic(self) -> sympy.Expr | Mapping[str, sympy.Expr]:
        """``G`` of ``z' = G(v, z)`` as a sympy expression in ``v``, ``z`` and the `own_parameters`.

        A law of several states gives a mapping of their rates by name.
        """
        raise NotImplementedError

    def closure(self, name: str) -> Closure:
        """Closure ``name`` of this law: equivalent coefficients as a function of latent moments.

        It raises an ArithmeticError if the law has none in closed form, and none accurate by
        quadrature.
        """
        closed = self.closed_form(name)
        if closed is None:
            if not self.linearizes:
                raise cannot_be_linearized(self._name, self._states)
            self._compiled.check_expectations(self._examples)
        return closed or self._compiled.gaussian

    def closure_in_time(self) -> tuple[Any, ...]:
        """The Gaussian closure; of a law with further states also their number and mean rates.

        Their means are then parameters after those of the law. It raises an ArithmeticError as
        ``closure`` does, or if a further state has no mean.
        """
        if self.linearizes or not self._states:
            return (self.closure(GAUSSIAN),)
        self._compiled.check_in_time(self._examples)
        return self._compiled.held.gaussian, self._states - 1, self._compiled.mean_rates

    def further_states(self) -> tuple[str, ...]:
        """Names of the states besides z of a law that gives the rates of its states in symbols."""
        return tuple(name for name, _ in self._compiled.rates[1:])

    def has_one_solution(self) -> xr.DataArray:
        """True for the cells in which linearization is known to have only one solution.

        In the other cells the solution is followed from the elastic response as the intensity
        grows, which takes several times as long.
        """
        return xr.DataArray(False)

    def settles(self) -> xr.DataArray:
        """True for the cells that stay elastic or have stiffness after yielding."""
        hardening = self.arrays()["hardening"] if self.yields else xr.DataArray(1.0)
        return hardening.copy(data=STATIONARY_HARDENING.contains(hardening.data))

    def check_settles(self, role: str) -> None:
        """Raise a ValueError if hardening is one number and leaves no stiffness after yielding."""
        scalar = self.yields and not isinstance(self.hardening, xr.DataArray)
        if scalar and not STATIONARY_HARDENING.contains(self.hardening):
            what = f"{role}: hardening = {self.hardening:g} leaves no stiffness after yielding"
            raise ValueError(f"{what}; allowed: {STATIONARY_HARDENING}; or {CURE}")

    def check_stationary(self, role: str) -> None:
        """Raise a ValueError if the displacement, or a state of the law, grows for ever."""
        self.check_settles(role)
        if self.yields and (growing := self.growing()):
            what = (
                f"{role}: {self._name} has no stationary response: "
                "it depends on what grows for ever"
            )
            raise ValueError(f"{what} ({listed(growing)}); {CURE}")

    def growing(self) -> tuple[str, ...]:
        """What the law depends on that grows for ever: states that keep their sign, as energy does.

        A law whose ``symbolic`` has such states besides z names them here.
        """
        return ()

    def largest_z(self) -> xr.DataArray:
        """Largest ``z`` that the law reaches in one direction [-], for each cell."""
        return xr.DataArray(1.0)

    def step(self) -> Any:
        """The law in time steps: a kind of ``kernels.simulation.laws``, or a ``RateLaw`` of it."""
        return self._compiled.step

    def law_parameters(self) -> list[xr.DataArray]:
        """What closures and time steps of this law take: the `own_parameters` in the same order."""
        values = self.arrays()
        return [values[name] for name in self.own_parameters()]

    @property
    def linearizes(self) -> bool:
        """Whether the law has closures of a stationary response."""
        return bool(self.closures) or self._states == 1

    @property
    def _states(self) -> int:
        """Number of states of a law that is given by their rates; 0 of one that is not."""
        return 0 if type(self).symbolic is Structure.symbolic else len(self._compiled.rates)

    @property
    def _name(self) -> str:
        """The law as messages name it."""
        return (
            type(self).__name__ if self.own_parameters() else f"law = {in_words(self.symbolic())}"
        )

    @cached_property
    def _compiled(self) -> SymbolicLaw:
        """The compiled ``symbolic`` expression, checked for the `_examples`."""
        from stochlin.models.symbolic import compiled

        try:
            law = compiled(self.symbolic(), self.own_parameters(), self.growing())
            law.check(self._examples)
        except ValueError as error:
            raise ValueError(f"{type(self).__name__}: {error}") from error
        return law

    @cached_property
    def _examples(self) -> tuple[tuple[float, ...], ...]:
        """Some of the valid parameter sets of the law."""
        arrays = xr.broadcast(self.valid(), *self.law_parameters())
        valid, *columns = (array.values.ravel() for array in arrays)
        sets = np.unique(np.array(columns).reshape(len(columns), valid.size)[:, valid], axis=1)
        return tuple(map(tuple, sets.T[:: 1 + sets.shape[1] // CHECKED].tolist()))


@dataclass(frozen=True)
class LinearPair(Model):
    """Two linear oscillators, the input of eq. (4): periods [s] and damping ratios [-]."""

    of_arguments = True

    period_1: Parameter = parameter("s", "period, structure 1", POSITIVE)
    period_2: Parameter = parameter("s", "period, structure 2", POSITIVE)
    damping_1: Parameter = parameter("1", "damping ratio, structure 1", DAMPING_RATIO)
    damping_2: Parameter = parameter("1", "damping ratio, structure 2", DAMPING_RATIO)


@dataclass(frozen=True)
class Gap(Model):
    """The distance between two structures at rest: ``gap`` [m], positive."""

    of_arguments = True

    gap: Parameter = parameter("m", "gap between the structures", POSITIVE)


def doubt_of_strength(acceleration: float) -> str:
    """Text on a strength over the mass [m/s^2]; empty if it is plausible."""
    text = PLAUSIBLE["acceleration at yield"].doubt(acceleration)
    return text and f"{acceleration / g:.3g} g; {text}"
