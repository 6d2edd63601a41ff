"""Structures with an odd hysteresis law that the user gives as a sympy expression."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from stochlin.messages import brief, listed
from stochlin.models.structures import LAWS, Structure

if TYPE_CHECKING:
    import sympy


@LAWS.register("hysteretic", place=3)
@dataclass(frozen=True)
class Hysteretic(Structure):
    """Oscillator with any odd hysteresis law ``z' = G(v, z)``, given as a sympy expression.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`.
    law : sympy.Expr
        ``G`` [1/s] in symbols named ``v``, the ductility rate [1/s], and ``z`` [-]. The law is odd:
        ``G(-v, -z) = -G(v, z)``. It may contain sums, products, powers, ``Abs``, ``sign``, ``Max``,
        ``Min``, ``Heaviside``, ``Piecewise``, ``exp``, ``log``, and trigonometric and hyperbolic
        functions and their inverses.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`; also if the law is not given, has other symbols or functions, is not odd, or
        is not finite. What linearizes raises an ArithmeticError if the law has kinks that cannot be
        located, or powers of ``Abs(z)`` below 1/2.

    References
    ----------
    Roberts, J. B. and Spanos, P. D. (1990), Random vibration and statistical linearization.

    Examples
    --------
    >>> import stochlin as sl, sympy
    >>> v, z = sympy.symbols("v z")
    >>> friction = sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=2, law=v - abs(v) * z)
    >>> friction.closure_names()
    ('gaussian',)
    """

    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self._compiled

    def symbolic(self) -> sympy.Expr:
        """The sympy expression that was given as ``law``."""
        return self.law

    def describe(self) -> str:
        """The structure in one line, with its parameters and its law."""
        return f"{super().describe()[:-1]}, law={self.law})"


def law_of(law: str | sympy.Expr, common: Mapping[str, Any], own: Mapping[str, Any]) -> Structure:
    """A structure with a law that is given by its name or as a sympy expression.

    ``common`` are parameters of every structure, ``own`` those that this law adds, both by name.

    Raises
    ------
    ValueError, TypeError
        If the law is not known, or if ``own`` has unknown parameters or lacks required ones.
    """
    kind = LAWS.named(law, "law") if isinstance(law, str) else Hysteretic
    if kind is Hysteretic:
        if isinstance(law, str):
            raise ValueError("law = 'hysteretic' has no expression; give the sympy expression itself")
        common = {**common, "law": law}
    known = kind.own_parameters()
    unknown = [name for name in own if name not in known]
    missing = [name for name in known if name not in own and not hasattr(kind, name)]
    if unknown or missing:
        what = f"has no {listed(unknown)}" if unknown else f"needs {listed(missing)} as well"
        raise ValueError(
            f"law_parameters = {brief(dict(own))}: the law {what}; allowed: {', '.join(known) or 'none'}"
        )
    return kind(**common, **own)
