"""Any odd hysteresis law that a user writes as a sympy expression."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from stochlin.models.structures import LAWS, Structure

if TYPE_CHECKING:
    import sympy


@LAWS.register("hysteretic", place=3)
@dataclass(frozen=True)
class Hysteretic(Structure):
    """Oscillator with any odd hysteresis law ``z' = G(v, z)`` written as a sympy expression.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`.
    law : sympy.Expr
        ``G`` in symbols named ``v`` (ductility rate) and ``z``, odd in both together.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`; or if the law is missing, has other symbols, is not odd, or has kinks
        that cannot be located.

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
        """The law as it was given."""
        return self.law

    def describe(self) -> str:
        """One line with the parameters and the law."""
        return f"{super().describe()[:-1]}, law={self.law})"
