"""The states of a hysteresis law that a user gives in sympy: their names and rates."""

from __future__ import annotations

import keyword
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from stochlin.messages import brief, listed

if TYPE_CHECKING:
    import sympy

    Rates = tuple[tuple[str, sympy.Expr], ...]
    """Names and rates of all states of a law, of which the first is z."""

MOST_STATES = 8
GIVE = "give a sympy expression, or a mapping of sympy expressions by state"


def rates_by_state(law: Any) -> Rates:
    """The rates of a law, which is an expression for z or a mapping of expressions by state.

    Raises
    ------
    ValueError, TypeError
        If names of states are not allowed, or the rate of z is missing.
    """
    rates = {"z": law}
    if isinstance(law, (Mapping, tuple)):
        try:
            rates = dict(law)
        except (TypeError, ValueError) as error:
            raise TypeError(f"law = {brief(law)} is not allowed; {GIVE}") from error
    names = ["z", *(name for name in rates if name != "z")]
    words = [
        n for n in names if isinstance(n, str) and n.isidentifier() and not keyword.iskeyword(n)
    ]
    if not (words == names and "z" in rates and "v" not in names and len(names) <= MOST_STATES):
        what = f"law = {brief(in_words(law))} has rates of {listed(rates)}"
        allowed = (
            f"z and at most {MOST_STATES - 1} further states, names of letters and digits, not 'v'"
        )
        raise ValueError(f"{what}; allowed: {allowed}")
    return tuple((name, rates[name]) for name in names)


class NotLinearizedError(ArithmeticError):
    """A law has no equivalent coefficients; simulated motions follow it nevertheless."""


def cannot_be_linearized(law: str, states: int) -> NotLinearizedError:
    """The error where a law with so many states would be linearized; 0 if not given by rates."""
    why = "it has more than one state" if states else "its rates are not given in symbols"
    by = "transient_response, or " if states else ""
    what = f"{law} cannot be linearized: {why}; follow it in time"
    return NotLinearizedError(f"{what}, by {by}simulate with a duration")


def in_words(law: Any) -> str:
    """A law in messages and descriptions: the name or expression, or the expressions by state."""
    rates = dict(law) if isinstance(law, (Mapping, tuple)) else {"z": law}
    if list(rates) == ["z"]:
        return str(rates["z"])
    return f"{{{', '.join(f'{name}: {rate}' for name, rate in rates.items())}}}"
