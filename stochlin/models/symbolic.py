"""Closure and time steps derived from the sympy expressions of a hysteresis law, one for each state."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy

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

ORDER = 52
ACCURACY = 1e-9  # of Gaussian expectations
ACCURACY_IN_TIME = 1e-3  # of those with the means of further states, some of which may be small
LARGEST = 1e300  # number in a law
MEANS = (0.0, 0.1, 1.0, 10.0)  # of further states for which the latter are checked
_FUNCTIONS = {  # that both numpy and math have
    *(sympy.Abs, sympy.sign, sympy.Max, sympy.Min, sympy.Heaviside, sympy.Piecewise),
    *(sympy.exp, sympy.log),
    *(sympy.sin, sympy.cos, sympy.tan, sympy.asin, sympy.acos, sympy.atan, sympy.atan2),
    *(sympy.sinh, sympy.cosh, sympy.tanh, sympy.asinh, sympy.acosh, sympy.atanh),
}
_PARTS = (  # of expressions besides these functions
    *(sympy.Add, sympy.Mul, sympy.Pow, sympy.Symbol, sympy.Number, sympy.NumberSymbol),
    *(sympy.functions.elementary.piecewise.ExprCondPair, sympy.core.relational.Relational),
    *(sympy.And, sympy.Or, sympy.Not, sympy.logic.boolalg.BooleanAtom),
)
_POWER = sympy.Function("power")
_VECTOR_FUNCTIONS = {"power": power, "exp": exponential, "log": logarithm}
# Of v, z and further states. These may be sums that only grow, such as energies, and are not negative.
_PROBES = np.concatenate(
    [
        np.random.default_rng(1996).uniform(-2.5, 2.5, (2, 400)),
        np.random.default_rng(1997).uniform(0.0, 2.5, (MOST_STATES - 1, 400)),
    ]
)


class SymbolicLaw:
    """Hysteresis law, compiled for time steps, and for Gaussian quadrature if it has one state.

    ``law`` is ``G`` of ``z' = G(v, z)``, or a mapping of the rates of several states by name. Its
    symbols are ``v`` (ductility rate) [1/s], the states, and the names in ``parameters``. Functions take
    the values of the parameters as rows of an array, in this order. The law is the same in both
    directions: further states named in ``growing`` keep their sign, and all others are reversed.
    """

    def __init__(
        self,
        law: sympy.Expr | Mapping[str, sympy.Expr] | Rates,
        parameters: tuple[str, ...] = (),
        growing: tuple[str, ...] = (),
    ) -> None:
        self.rates, self.parameters = _with_plain_symbols(law, parameters), parameters
        self.growing = growing
        self._rates = self._function(sympy.Tuple(*dict(self.rates).values()), "numpy")
        self._good: set[tuple[str, bytes]] = set()

    def __reduce__(self) -> tuple[Callable[..., SymbolicLaw], tuple[Any, ...]]:
        """Pickle the expressions and the names: compiled functions cannot be pickled."""
        return compiled, (self.rates, self.parameters, self.growing)

    @cached_property
    def slip_rate(self) -> SlipRate:
        """``v - G(v, z)`` of a law with one state."""

        def slip(rate: Array, displacement: Array, values: Array) -> Array:
            return rate - self._values(rate, (displacement,), values)[0]

        return self._integrand(slip)

    def _integrand(self, function: Callable[[Array, Array, Array], Array]) -> SlipRate:
        """A function of ``v``, ``z`` and the parameters that bends where the rate of z does."""
        probes = np.random.default_rng(4).uniform(0.3, 1.7, (len(self.parameters), _PROBES.shape[1]))
        return SlipRate(
            function,
            self._kinks(),
            _is_rate_independent(lambda v: function(v, _PROBES[1], probes)),
        )

    def gaussian(self, latent: Array, parameters: Array) -> ClosureValue:
        """Gaussian closure by quadrature."""
        by_v, by_z = slip_expectations(self.slip_rate, latent, parameters, ORDER)
        covariance = gaussian_covariance(latent)
        return ClosureValue(regress_slip(by_v, by_z, covariance), covariance)

    @cached_property
    def held(self) -> SymbolicLaw:
        """The law with z alone, whose parameters are followed by all further states, held."""
        return compiled(self.rates[0][1], (*self.parameters, *(name for name, _ in self.rates[1:])))

    @cached_property
    def _further_rates(self) -> list[SlipRate]:
        """Rates of the further states, as functions of ``v``, ``z`` and what `held` has."""
        own = len(self.parameters)

        def rate_of(state: int) -> SlipRate:
            def rate(v: Array, z: Array, values: Array) -> Array:
                states = [np.broadcast_to(value, v.shape) for value in values[own:]]
                return self._values(v, (z, *states), values[:own])[state]

            return self.held._integrand(rate)

        return [rate_of(state) for state in range(1, len(self.rates))]

    def mean_rates(self, latent: Array, parameters: Array) -> Array:
        """Mean rates of the further states (states, n) for Gaussian ``(v, z)``, by quadrature.

        ``parameters`` are those of `held`, with the means of these states in place of the states.
        """
        rates = [even_expectation(rate, latent, parameters, ORDER) for rate in self._further_rates]
        return np.array(rates).reshape(-1, latent.shape[1])

    @cached_property
    def step(self) -> Any:
        """The law in time steps, a `kernels.simulation.laws.RateLaw`."""
        from stochlin.kernels.simulation.laws import RateLaw, advance_of

        v, w, own = sympy.Symbol("v", real=True), sympy.IndexedBase("w"), sympy.IndexedBase("own")
        lane = sympy.Symbol("lane", integer=True)
        values = {n: own[i, lane] for i, n in enumerate(self.parameters)}
        values |= {name: w[i] for i, (name, _) in enumerate(self.rates)}
        numbers = {sympy.Symbol(name, real=True): value for name, value in values.items()}
        rates = sympy.Tuple(*(_for_lanes(rate).subs(numbers) for _, rate in self.rates))
        functions = [_VECTOR_FUNCTIONS, "math"]
        of_rates = sympy.lambdify((v, w, own, lane), rates, functions, cse=True)
        name = sympy.srepr(rates)
        return RateLaw(advance_of(of_rates, len(rates), name), len(rates), name)

    def check(self, parameters: Array) -> None:
        """Raise a ValueError if the law differs in both directions, or is not real and finite.

        ``parameters`` (m, n) holds the m parameters of the law, one set in each of its n columns.
        """
        self._check_each(parameters, self._check_directions)

    def check_expectations(self, parameters: Array) -> None:
        """Raise an ArithmeticError if `gaussian` is not accurate; parameters as for `check`."""
        self._check_each(parameters, self._check_quadrature)

    def check_in_time(self, parameters: Array) -> None:
        """Raise an ArithmeticError if `held` is not accurate, or if a further state has no mean.

        ``parameters`` are those for `check`.
        """
        self._check_each(parameters, self._check_held)

    def _check_each(self, parameters: Array, check: Callable[[Array], None]) -> None:
        for column in np.ascontiguousarray(parameters.T):
            key = check.__name__, column.tobytes()
            if key not in self._good:
                check(column)
                self._good.add(key)

    def _function(self, expression: sympy.Basic, module: Any) -> Callable[..., Any]:
        """The expression as a function of ``v``, the states and the parameters, both as rows."""
        rows = {"states": [name for name, _ in self.rates], "parameters": self.parameters}
        v, vectors = sympy.Symbol("v", real=True), [sympy.DeferredVector(name) for name in rows]
        values = {
            sympy.Symbol(name, real=True): vector[i]
            for vector, names in zip(vectors, rows.values(), strict=True)
            for i, name in enumerate(names)
        }
        return sympy.lambdify((v, *vectors), expression.subs(values), module, cse=True)

    def _values(self, v: Array, states: Sequence[Array] | Array, parameters: Array) -> Array:
        """Rates of all states, (states, ...) as ``v``."""
        rates = self._rates(v, states, parameters)
        return np.array([np.broadcast_to(rate, v.shape) for rate in rates])

    def _kinks(self) -> Callable[[Array], Sequence[Array | float]]:
        """A function of the parameters: the ``z`` where the law may jump or bend."""
        kinks = self._function(sympy.Tuple(*_kinks(self.rates[0][1])), "numpy")

        def at(parameters: Array) -> Sequence[Array | float]:
            with np.errstate(all="ignore"):
                positions = kinks(0.0, (0.0,), parameters)
            return [np.where(np.isfinite(kink), kink, 0.0) for kink in positions]

        return at

    def _named(self, column: Array) -> str:
        """The law as messages name it, with the values of the parameters for which it was checked."""
        text = ", ".join(f"{n} = {x:g}" for n, x in zip(self.parameters, column, strict=True))
        return f"law = {in_words(self.rates)}" + (f" with {text}" if text else "")

    @np.errstate(all="ignore")
    def _check_directions(self, column: Array) -> None:
        v, w = _PROBES[0], _PROBES[1 : 1 + len(self.rates)]
        rates, start = self._values(v, w, column), self._values(v, 0 * w, column)
        signs = np.array([[1.0 if name in self.growing else -1.0] for name, _ in self.rates])
        more = ", further states from 0 to 2.5" if len(w) > 1 else ""
        if np.iscomplexobj(rates) or not np.isfinite([rates, start]).all():
            raise ValueError(
                f"{self._named(column)} is not real and finite in |v|, |z| < 2.5{more} and at "
                f"{' = '.join(name for name, _ in self.rates)} = 0, where motions start; take powers of "
                "Abs(z) instead of z, and write a limit as Piecewise"
            )
        allowed = 1e-9 * (1 + np.abs(rates).max(axis=1, keepdims=True))
        if (np.abs(self._values(-v, signs * w, column) - signs * rates) <= allowed).all():
            if (np.abs(start[0]) > 1e-9 * np.abs(v)).any():
                return
            raise ValueError(
                f"{self._named(column)} leaves z at 0, where motions start, so that no force develops; "
                "allowed: G(v, 0) = v, as in v - abs(v)*z"
            )
        raise ValueError(
            f"{self._named(column)} differs with the direction; allowed: if v and z are reversed, so is "
            f"the rate of z, and growing_states = {brief(self.growing)} keep their signs and those of "
            "their rates, as energies do, while other states and their rates are reversed"
        )

    def _check_held(self, column: Array) -> None:
        turning = [name for name, _ in self.rates[1:] if name not in self.growing]
        if turning:
            raise NotLinearizedError(
                f"{self._named(column)} cannot be linearized in time: {listed(turning)} turns with the "
                "motion, so that its mean is 0; use simulate with a duration"
            )
        for mean in MEANS:
            means = np.full(len(self.rates) - 1, mean)
            self.held._check_quadrature(np.concatenate([column, means]), ACCURACY_IN_TIME)

    @np.errstate(all="ignore")
    def _check_quadrature(self, column: Array, allowed: float = ACCURACY) -> None:
        latent = np.array([[0.1, 1.0, 2.0, 50.0], [2.5, 0.4, 0.9, 1.2], [0.7, 0.0, 0.3, 0.5]])
        parameters = np.repeat(column[:, None], latent.shape[1], axis=1)
        coarse, fine = (
            slip_expectations(self.slip_rate, latent, parameters, order) for order in (ORDER, 3 * ORDER)
        )
        error = np.nan_to_num(np.max(np.abs(coarse - fine) / (np.abs(fine) + latent[0])), nan=np.inf)
        if not error < allowed:
            raise NotLinearizedError(
                f"{self._named(column)} cannot be linearized: its Gaussian expectations have the error "
                f"{error:.1e}, allowed {allowed:.0e}, since it bends, jumps or is steep elsewhere than "
                "at v = 0 and its kinks in z, has a power below 1/2 there, or grows too fast. Write "
                "kinks as Abs, sign, Heaviside, Max, Min or Piecewise of z alone and make the law "
                "smoother, or use simulation, which takes it as it is"
            )


_compiled = cache(SymbolicLaw)


def compiled(
    law: sympy.Expr | Mapping[str, sympy.Expr] | Rates,
    parameters: tuple[str, ...],
    growing: tuple[str, ...] = (),
) -> SymbolicLaw:
    """The compiled law of sympy expressions; equal expressions are compiled only once."""
    return _compiled(_with_plain_symbols(law, parameters), parameters, growing)


def _with_plain_symbols(law: Any, parameters: tuple[str, ...]) -> Rates:
    """The rates with real-valued symbols of the same names in place of the user's symbols."""
    rates = rates_by_state(law)
    names = [name for name, _ in rates]
    return tuple((name, _plain(name, rate, names, parameters)) for name, rate in rates)


def _plain(
    state: str, expression: sympy.Expr, states: Sequence[str], parameters: tuple[str, ...]
) -> sympy.Expr:
    if not isinstance(expression, sympy.Expr):
        raise TypeError(f"law = {brief(expression)} is not allowed; {GIVE}")
    names = {symbol.name for symbol in expression.free_symbols}
    known = ["v", *states]
    if (state == "z" and "v" not in names) or not names <= {*known, *parameters}:
        quoted = ", ".join(f"'{name}'" for name in known)
        own = f"its parameters {', '.join(parameters)}" if parameters else "numbers as parameters"
        of_state = f" of {state}" if len(states) > 1 else ""
        raise ValueError(
            f"law{of_state} = {expression} has the symbols {sorted(names)}; allowed: {quoted} and "
            f"{own}; 'v' is required for z"
        )
    _check_parts(expression)
    return expression.subs({s: sympy.Symbol(s.name, real=True) for s in expression.free_symbols})


def _check_parts(expression: sympy.Expr) -> None:
    """Raise a ValueError for what has no numeric form: it would be printed to code as it stands."""
    for node in sympy.preorder_traversal(expression):
        if node.func not in _FUNCTIONS and not isinstance(node, _PARTS):
            names = ", ".join(sorted(function.__name__ for function in _FUNCTIONS))
            raise ValueError(
                f"law = {brief(str(expression))} has {brief(str(node))}, which has no "
                f"numeric form; allowed: + - * / ** and {names}"
            )
        if isinstance(node, sympy.Number) and not abs(node) < LARGEST:
            raise ValueError(
                f"law = {brief(str(expression))} has the number {brief(str(node))}; allowed: numbers "
                f"below {LARGEST:.0e}"
            )


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
    whole, double = (rates(n * v) for n in (1, 2))
    return bool(np.abs(double - 2 * whole).max() <= 1e-11 * (1 + np.abs(whole).max()))


def _kinks(expression: sympy.Expr) -> set[sympy.Expr]:
    """Values of ``z`` where the law may jump or bend: zeros of arguments that do not depend on ``v``."""
    v, z = sympy.symbols("v z", real=True)
    kinks: set[sympy.Expr] = set()
    for argument in _switch_arguments(expression):
        for factor in sympy.Mul.make_args(sympy.factor(argument)):
            if z in factor.free_symbols and v not in factor.free_symbols:
                with contextlib.suppress(NotImplementedError):  # no formula for the zeros
                    kinks.update(sympy.solve(factor, z))
    return kinks


def _switch_arguments(expression: sympy.Expr) -> Iterator[sympy.Expr]:
    for node in sympy.preorder_traversal(expression):
        if isinstance(node, (sympy.Heaviside, sympy.sign, sympy.Abs)):
            yield node.args[0]
        elif isinstance(node, (sympy.Max, sympy.Min)):
            yield from (a - b for a in node.args for b in node.args if a is not b)
        elif isinstance(node, sympy.core.relational.Relational):
            yield node.lhs - node.rhs
