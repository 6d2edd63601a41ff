"""Any odd hysteresis law that a user writes as a sympy expression."""

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


def law_of(law: str | sympy.Expr, common: Mapping[str, Any], own: Mapping[str, Any]) -> Structure:
    """The structure of a law by its name, or of a sympy expression, with its own parameters.

    Raises
    ------
    ValueError, TypeError
        If the law is not known, or has no such parameters.
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
