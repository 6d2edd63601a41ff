"""Any odd hysteresis law ``z' = G(v, z)`` that a user writes as a sympy expression."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import sympy

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.fixed_point import ClosureValue, gaussian_covariance
from stochlin.kernels.linearization.gaussian import regress_slip
from stochlin.kernels.linearization.quadrature import SlipRate, slip_expectations

if TYPE_CHECKING:
    from stochlin.kernels.simulation.ensemble import Block

ORDER = 40
ACCURACY = 1e-9
_PROBES = np.random.default_rng(1996).uniform(-2.5, 2.5, (2, 400))


class SymbolicLaw:
    """``G(v, z)`` compiled for batched Gaussian quadrature.

    Parameters
    ----------
    expression : sympy.Expr
        ``G`` in symbols named ``v`` [1/s, ductility rate] and ``z`` [-]; odd:
        ``G(-v, -z) = -G(v, z)``.

    Raises
    ------
    TypeError
        If it is not a sympy expression.
    ValueError
        If it has other symbols, is not odd, not real, or has kinks that quadrature cannot find.
    """

    def __init__(self, expression: sympy.Expr) -> None:
        self.expression = _with_plain_symbols(expression)
        v, z = sympy.symbols("v z", real=True)
        evaluate = sympy.lambdify((v, z), self.expression, "numpy", cse=True)

        def slip(rate: Array, displacement: Array) -> Array:
            return rate - np.broadcast_to(evaluate(rate, displacement), rate.shape)

        self.slip_rate = SlipRate(slip, tuple(_kinks(self.expression)), False)
        self._check_odd()
        self.slip_rate = self.slip_rate._replace(rate_independent=self._is_rate_independent())
        self._check_quadrature()

    def gaussian(self, latent: Array, parameters: Array) -> ClosureValue:
        """Gaussian closure by quadrature, with derivatives."""
        slip, slip_jacobian = slip_expectations(self.slip_rate, latent, ORDER)
        covariance, covariance_jacobian = gaussian_covariance(latent)
        coefficients, jacobian = regress_slip(slip, slip_jacobian, covariance, covariance_jacobian)
        return ClosureValue(coefficients, jacobian, covariance, covariance_jacobian)

    @cached_property
    def block(self) -> Block:
        """Time steps of this law, compiled when first asked for."""
        from stochlin.kernels.simulation.law_stepping import law_block

        v, z = sympy.symbols("v z", real=True)
        return law_block(sympy.lambdify((v, z), self._without_steps(), "math", cse=True))

    def _without_steps(self) -> sympy.Expr:
        """The law with its Heaviside steps as cases, which is what plain Python can print."""
        return self.expression.replace(
            sympy.Heaviside, lambda *x: sympy.Heaviside(*x).rewrite(sympy.Piecewise)
        )

    def _check_odd(self) -> None:
        v, z = _PROBES
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            value, mirrored = self.slip_rate.function(v, z), self.slip_rate.function(-v, -z)
        if np.iscomplexobj(value) or not np.isfinite(value).all():
            raise ValueError(f"law = {self.expression} is not real and finite in |v|, |z| < 2.5")
        if np.abs(value + mirrored).max() > 1e-9 * (1 + np.abs(value).max()):
            raise ValueError(
                f"law = {self.expression} is not odd; allowed: G(-v, -z) = -G(v, z), the same "
                "behaviour in both directions"
            )

    def _is_rate_independent(self) -> bool:
        v, z = np.abs(_PROBES[0]) + 0.01, _PROBES[1]
        whole, double = self.slip_rate.function(v, z), self.slip_rate.function(2 * v, z)
        return bool(np.abs(double - 2 * whole).max() <= 1e-11 * (1 + np.abs(whole).max()))

    def _check_quadrature(self) -> None:
        latent = np.array([[0.1, 1.0, 2.0, 50.0], [2.5, 0.4, 0.9, 1.2], [0.7, 0.0, 0.3, 0.5]])
        coarse, _ = slip_expectations(self.slip_rate, latent, ORDER)
        fine, _ = slip_expectations(self.slip_rate, latent, 3 * ORDER)
        error = np.max(np.abs(coarse - fine) / (np.abs(fine) + latent[0]))
        if not error < ACCURACY:
            raise ValueError(
                f"law = {self.expression} has kinks that could not be located (quadrature error "
                f"{error:.1e}, allowed {ACCURACY:.0e}); found are kinks at v = 0, and those written as "
                "Abs, sign, Heaviside, Max, Min or Piecewise of z alone"
            )


def _with_plain_symbols(expression: sympy.Expr) -> sympy.Expr:
    """Replace the user's symbols, found by name, by real ones."""
    if not isinstance(expression, sympy.Expr):
        raise TypeError(f"law = {expression!r} is not allowed; give a sympy expression")
    names = {symbol.name for symbol in expression.free_symbols}
    if "v" not in names or not names <= {"v", "z"}:
        raise ValueError(
            f"law = {expression} has the symbols {sorted(names)}; allowed: 'v' and 'z' only, with "
            "numbers in place of any parameter"
        )
    return expression.subs({s: sympy.Symbol(s.name, real=True) for s in expression.free_symbols})


def _kinks(expression: sympy.Expr) -> list[float]:
    """Values of ``z`` where the law may jump or bend: zeros of arguments that depend on ``z`` alone."""
    z = sympy.Symbol("z", real=True)
    kinks: set[float] = set()
    for argument in _switch_arguments(expression):
        for factor in sympy.Mul.make_args(sympy.factor(argument)):
            if factor.free_symbols == {z}:
                roots = sympy.solveset(factor, z, sympy.S.Reals)
                if isinstance(roots, sympy.FiniteSet):
                    kinks.update(float(root) for root in roots)
    return sorted(kinks)


def _switch_arguments(expression: sympy.Expr) -> Iterator[sympy.Expr]:
    for node in sympy.preorder_traversal(expression):
        if isinstance(node, (sympy.Heaviside, sympy.sign, sympy.Abs)):
            yield node.args[0]
        elif isinstance(node, (sympy.Max, sympy.Min)):
            yield from (a - b for a in node.args for b in node.args if a is not b)
        elif isinstance(node, sympy.core.relational.Relational):
            yield node.lhs - node.rhs
