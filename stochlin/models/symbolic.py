"""Closure and time steps derived from sympy expressions of a hysteresis law, one for each state."""

from __future__ import annotations

import contextlib
import operator
from collections.abc import Callable, Mapping, Sequence
from functools import cache, cached_property
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy
from sympy.core.relational import Relational

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.powers import exponential, logarithm, power
from stochlin.kernels.linearization.gaussian import ClosureValue, gaussian_covariance, regress_slip
from stochlin.kernels.linearization.quadrature import (
    SlipRate,
    even_expectation,
    slip_expectations,
)
from stochlin.messages import brief, listed
from stochlin.models.states import (
    GIVE,
    MOST_STATES,
    NotLinearizedError,
    in_words,
    rates_by_state,
)

if TYPE_CHECKING:
    from stochlin.models.states import Rates

QUADRATURE_ORDER = 52
ACCURACY = 1e-9  # of Gaussian expectations
ACCURACY_IN_TIME = 1e-3  # of those with the means of further states, some of which may be small
LARGEST_IN_LAW = 1e300  # number in a law
MEANS = (0.0, 0.1, 1.0, 10.0)  # of further states for which the latter are checked
_FUNCTIONS = (  # that both numpy and math have
    "Abs",
    "sign",
    "Max",
    "Min",
    "Heaviside",
    "Piecewise",
    "exp",
    "log",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
)
_PARTS = (  # of expressions
    *(getattr(sympy, name) for name in _FUNCTIONS),
    sympy.Add,
    sympy.Mul,
    sympy.Pow,
    sympy.Symbol,
    sympy.Number,
    sympy.NumberSymbol,
    sympy.functions.elementary.piecewise.ExprCondPair,
    Relational,
    sympy.And,
    sympy.Or,
    sympy.Not,
    sympy.logic.boolalg.BooleanAtom,
)
_POWER = sympy.Function("power")
_WRITE = sympy.Function("write")
_VECTOR_FUNCTIONS = {
    "power": power,
    "exp": exponential,
    "log": logarithm,
    "write": operator.setitem,
}
# Of v, z and further states. These may be sums that only grow, such as energies, and are not
# negative.
_PROBES = np.concatenate(
    [
        np.random.default_rng(1996).uniform(-2.5, 2.5, (2, 400)),
        np.random.default_rng(1997).uniform(0.0, 2.5, (MOST_STATES - 1, 400)),
    ]
)
# Moments of v and z for which expectations are checked.
_LATENT = np.array([[0.1, 1.0, 2.0, 50.0], [2.5, 0.4, 0.9, 1.2], [0.7, 0.0, 0.3, 0.5]])
_V, _Z = sympy.symbols("v z", real=True)
_FORWARD = sympy.Symbol("v", positive=True)  # half of the plane; a law is odd

Sets = tuple[tuple[float, ...], ...]
"""Values of the parameters of a law, one set after another."""


class SymbolicLaw:
    """Hysteresis law, compiled for time steps, and for Gaussian quadrature if it has one state.

    It is made by `compiled`, with real symbols. Functions take the values of the parameters as rows
    of an array, in the order of ``parameters``.
    """

    def __init__(self, rates: Rates, parameters: tuple[str, ...], growing: tuple[str, ...]) -> None:
        self.rates = rates
        self.parameters = parameters
        self.growing = growing
        self._rates = self._function(*dict(rates).values())

    def __reduce__(self) -> tuple[Callable[..., SymbolicLaw], tuple[Any, ...]]:
        """Pickle the expressions and the names: compiled functions cannot be pickled."""
        return compiled, (self.rates, self.parameters, self.growing)

    @cached_property
    def slip_rate(self) -> SlipRate:
        """``v - G(v, z)`` of a law with one state."""
        return self._integrand(_V - self.rates[0][1])

    def _integrand(self, expression: sympy.Expr) -> SlipRate:
        """An expression in ``v``, ``z`` and the parameters that bends where the rate of z does."""
        of_law = self._function(expression)
        kinks = self._function(*_kinks(self.rates[0][1]))
        probes = np.random.default_rng(4).uniform(
            0.3, 1.7, (len(self.parameters), _PROBES.shape[1])
        )

        def function(v: Array, z: Array, values: Array) -> Array:
            return of_law(v, (z,), values)[0]

        @np.errstate(all="ignore")
        def bends(parameters: Array) -> Sequence[Array | float]:
            positions = kinks(np.zeros(()), (0.0,), parameters)
            return [np.where(np.isfinite(kink), kink, 0.0) for kink in positions]

        alike = _is_rate_independent(lambda v: function(v, _PROBES[1], probes))
        return SlipRate(function, bends, alike)

    def gaussian(self, latent: Array, parameters: Array) -> ClosureValue:
        """Gaussian closure by quadrature."""
        by_v, by_z = slip_expectations(self.slip_rate, latent, parameters, QUADRATURE_ORDER)
        covariance = gaussian_covariance(latent)
        return ClosureValue(regress_slip(by_v, by_z, covariance), covariance)

    @cached_property
    def held(self) -> SymbolicLaw:
        """The law with z alone, whose parameters are followed by all further states, held."""
        return compiled(self.rates[0][1], (*self.parameters, *(name for name, _ in self.rates[1:])))

    @cached_property
    def _further_rates(self) -> list[SlipRate]:
        """Rates of the further states, as functions of ``v``, ``z`` and what `held` has."""
        return [self.held._integrand(rate) for _, rate in self.rates[1:]]

    def mean_rates(self, latent: Array, parameters: Array) -> Array:
        """Mean rates of the further states (states, n) for Gaussian ``(v, z)``, by quadrature.

        ``parameters`` are those of `held`, with the means of these states in place of the states.
        """
        rates = [
            even_expectation(rate, latent, parameters, QUADRATURE_ORDER)
            for rate in self._further_rates
        ]
        return np.array(rates).reshape(-1, latent.shape[1])

    @cached_property
    def step(self) -> Any:
        """The law in time steps, a `kernels.simulation.laws.RateLaw`."""
        from stochlin.kernels.simulation.laws import rate_law

        w = sympy.IndexedBase("w")
        parameters = sympy.IndexedBase("own")
        lane = sympy.Symbol("lane", integer=True)
        to = sympy.Symbol("rates")
        values = {n: parameters[i, lane] for i, n in enumerate(self.parameters)}
        values |= {name: w[i, lane] for i, (name, _) in enumerate(self.rates)}
        numbers = {sympy.Symbol(name, real=True): value for name, value in values.items()}
        rates = [_for_lanes(rate).subs(numbers) for _, rate in self.rates]
        writes = sympy.Tuple(*(_WRITE(to, (i, lane), rate) for i, rate in enumerate(rates)))
        of_rates = sympy.lambdify(
            (lane, _V, w, parameters, to), writes, [_VECTOR_FUNCTIONS, "math"], cse=True
        )
        # sympy counts functions in the names of their files: numba would never find compiled code
        # again.
        of_rates.__code__ = of_rates.__code__.replace(co_filename=__name__)
        return rate_law(of_rates, len(rates), sympy.srepr(writes))

    def _function(self, *expressions: sympy.Expr) -> Callable[[Array, Any, Any], Array]:
        """The expressions (k, ...) as a function of ``v``, the states and parameters as rows."""
        names = [name for name, _ in self.rates], self.parameters
        rows = [tuple(sympy.Symbol(name, real=True) for name in group) for group in names]
        function = sympy.lambdify((_V, *rows), expressions, "numpy", cse=True)

        def broadcast(v: Array, states: Any, parameters: Any) -> Array:
            values = np.broadcast_arrays(v, *function(v, states, parameters))
            return np.array(values[1:])

        return broadcast

    def _named(self, values: tuple[float, ...]) -> str:
        """The law as messages name it, with the parameter values for which it was checked."""
        text = ", ".join(f"{n} = {x:g}" for n, x in zip(self.parameters, values, strict=True))
        return f"law = {in_words(self.rates)}" + (f" with {text}" if text else "")

    @cache  # noqa: B019 - laws are kept anyway
    @np.errstate(all="ignore")
    def check(self, sets: Sets) -> None:
        """Raise a ValueError if the law differs in both directions, or is not real and finite."""
        v = _PROBES[0]
        w = _PROBES[1 : 1 + len(self.rates)]
        signs = np.array([[1.0 if name in self.growing else -1.0] for name, _ in self.rates])
        for values in sets:
            rates = self._rates(v, w, values)
            start = self._rates(v, np.zeros_like(w), values)
            if np.iscomplexobj(rates) or not np.isfinite([rates, start]).all():
                where = (
                    "|v|, |z| < 2.5, with further states from 0 to 2.5, or where all states are 0"
                )
                cure = "take powers of Abs(z) instead of z, and write a limit as Piecewise"
                raise ValueError(f"{self._named(values)} is not real and finite in {where}; {cure}")
            allowed = 1e-9 * (1 + np.abs(rates).max(axis=1, keepdims=True))
            if not (np.abs(self._rates(-v, signs * w, values) - signs * rates) <= allowed).all():
                others = f"growing_states = {brief(self.growing)} and their rates keep their signs"
                allowed = f"with v and z all states and rates are reversed, while {others}"
                raise ValueError(
                    f"{self._named(values)} differs with the direction; allowed: {allowed}"
                )
            if (np.abs(start[0]) <= 1e-9 * np.abs(v)).all():
                what = f"{self._named(values)} leaves z at 0, where motions start"
                raise ValueError(f"{what}; allowed: G(v, 0) = v, as in v - abs(v)*z")

    @cache  # noqa: B019 - laws are kept anyway
    def check_in_time(self, sets: Sets) -> None:
        """Raise an ArithmeticError if `held` is not accurate, or if a further state has no mean."""
        further = [name for name, _ in self.rates[1:]]
        if turning := [name for name in further if name not in self.growing]:
            what = (
                f"{self._named(sets[0])} cannot be linearized in time: "
                f"{listed(turning)} has no mean"
            )
            raise NotLinearizedError(f"{what}; use simulate with a duration")
        held = ((*values, *(mean for _ in further)) for values in sets for mean in MEANS)
        self.held.check_expectations(tuple(held), ACCURACY_IN_TIME)

    @cache  # noqa: B019 - laws are kept anyway
    @np.errstate(all="ignore")
    def check_expectations(self, sets: Sets, allowed: float = ACCURACY) -> None:
        """Raise an ArithmeticError if expectations by quadrature are not accurate."""
        for values in sets:
            parameters = np.repeat(np.array(values)[:, None], _LATENT.shape[1], axis=1)
            coarse = slip_expectations(self.slip_rate, _LATENT, parameters, QUADRATURE_ORDER)
            fine = slip_expectations(self.slip_rate, _LATENT, parameters, 3 * QUADRATURE_ORDER)
            errors = np.abs(coarse - fine) / (np.abs(fine) + _LATENT[0])
            if not (error := np.nan_to_num(errors.max(), nan=np.inf)) < allowed:
                what = (
                    f"{self._named(values)} cannot be linearized: "
                    "its Gaussian expectations have the"
                )
                cure = "write kinks in z as Abs, sign, Max, Min or Piecewise, or use simulation"
                raise NotLinearizedError(f"{what} error {error:.1e}, allowed {allowed:.0e}; {cure}")


_compiled = cache(SymbolicLaw)


def compiled(
    law: sympy.Expr | Mapping[str, sympy.Expr] | Rates,
    parameters: tuple[str, ...] = (),
    growing: tuple[str, ...] = (),
) -> SymbolicLaw:
    """The compiled law of sympy expressions; equal expressions are compiled only once.

    ``law`` is ``G`` of ``z' = G(v, z)``, or a mapping of the rates of several states by name. Its
    symbols are ``v`` (ductility rate) [1/s], the states, and the names in ``parameters``; real ones
    replace them. The law is the same in both directions: further states named in ``growing`` keep
    their sign, and all others are reversed.
    """
    rates = rates_by_state(law)
    states = [name for name, _ in rates]
    plain = tuple((name, _plain(name, rate, states, parameters)) for name, rate in rates)
    return _compiled(plain, parameters, growing)


def _plain(
    state: str, expression: sympy.Expr, states: Sequence[str], parameters: tuple[str, ...]
) -> sympy.Expr:
    if not isinstance(expression, sympy.Expr):
        raise TypeError(f"law = {brief(expression)} is not allowed; {GIVE}")
    names = {symbol.name for symbol in expression.free_symbols}
    symbols = ["v", *states]
    if (state == "z" and "v" not in names) or not names <= {*symbols, *parameters}:
        quoted = ", ".join(f"'{name}'" for name in symbols)
        others = (
            f"its parameters {', '.join(parameters)}" if parameters else "numbers as parameters"
        )
        of_state = f" of {state}" if len(states) > 1 else ""
        what = f"law{of_state} = {expression} has the symbols {sorted(names)}"
        raise ValueError(f"{what}; allowed: {quoted} and {others}; 'v' is required for z")
    _check_parts(expression)
    return expression.subs({s: sympy.Symbol(s.name, real=True) for s in expression.free_symbols})


def _check_parts(expression: sympy.Expr) -> None:
    """Raise a ValueError for what has no numeric form: it would be printed to code as it stands."""
    for node in sympy.preorder_traversal(expression):
        beyond = isinstance(node, sympy.Number) and not abs(node) < LARGEST_IN_LAW
        if beyond or not isinstance(node, _PARTS):
            what = (
                f"law = {brief(str(expression))} has {brief(str(node))}, which has no numeric form"
            )
            functions = ", ".join(sorted(_FUNCTIONS))
            allowed = f"numbers below {LARGEST_IN_LAW:.0e}, + - * / ** and {functions}"
            raise ValueError(f"{what}; allowed: {allowed}")


def _for_lanes(law: sympy.Expr) -> sympy.Expr:
    """The law with powers as `_POWER`, and steps as Piecewise, which plain Python code has."""
    law = law.replace(sympy.Heaviside, lambda *x: sympy.Heaviside(*x).rewrite(sympy.Piecewise))
    return law.replace(
        lambda node: node.is_Pow and not (2 * node.exp).is_integer, lambda node: _POWER(*node.args)
    )


@np.errstate(all="ignore")
def _is_rate_independent(rates: Callable[[Array], Array]) -> bool:
    """Whether rates are in proportion to ``v``, of which they are a function at `_PROBES`."""
    v = np.abs(_PROBES[0]) + 0.01
    whole = rates(v)
    double = rates(2 * v)
    return bool(np.abs(double - 2 * whole).max() <= 1e-11 * (1 + np.abs(whole).max()))


def _kinks(expression: sympy.Expr) -> set[sympy.Expr]:
    """Values of ``z`` where the law may jump or bend for ``v > 0``, which do not depend on ``v``.

    The quadrature takes no others: where ``v`` is positive, the kinks of ``1 - z*sign(v)`` are at
    1.
    """
    expression = expression.subs(_V, _FORWARD)
    arguments = [node.args[0] for node in expression.atoms(sympy.Heaviside, sympy.sign, sympy.Abs)]
    compared = [node.args for node in expression.atoms(sympy.Max, sympy.Min, Relational)]
    arguments += [a - b for quantities in compared for a, b in combinations(quantities, 2)]
    kinks: set[sympy.Expr] = set()
    factored = [sympy.factor(argument) for argument in arguments]
    for factor in {f for product in factored for f in sympy.Mul.make_args(product)}:
        if _Z in factor.free_symbols and _FORWARD not in factor.free_symbols:
            with contextlib.suppress(NotImplementedError):  # no formula for the zeros
                kinks.update(sympy.solve(factor, _Z))
    return kinks
