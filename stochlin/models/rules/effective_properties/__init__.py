"""Effective period and damping of a yielding structure, as functions of its peak ductility ``mu``.

The rules were derived from the response to records or from steady vibration. Eq. (4) with their periods
and damping ratios estimates the correlation of two yielding structures. For ``mu <= 1`` the structure is
elastic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf

from stochlin.kernels.basics.arrays import Array
from stochlin.models.arguments import Truth, checked
from stochlin.models.parameters import POSITIVE, Parameter, parameter
from stochlin.models.rules.published import Published, look_up
from stochlin.models.structures import STATIONARY_HARDENING, LinearPair
from stochlin.registry import Registry

EFFECTIVE_RULES: Registry[EffectiveRule] = Registry(
    "effective rule", "stochlin.models.rules.effective_properties"
)


@dataclass(frozen=True, kw_only=True)
class EffectiveRule(Published):
    """A rule for the effective period ``T*`` and damping ratio ``xi*`` of a linear structure.

    The linear structure replaces a yielding one. The functions take numbers or arrays that broadcast:
    ``period_ratio(ductility, hardening)`` is ``T*/T`` [-], ``damping(ductility, hardening, damping)`` is
    ``xi*`` [-], for the peak ductility, the hardening ratio and the viscous damping ratio of the
    yielding structure. ``largest_ductility`` [-] is that to which a rule was fitted, infinite for one
    that was derived or whose source was not seen; the functions go on beyond it, charts do not.
    """

    period_ratio: Callable[[Array, Array], Array] = field(compare=False)
    damping: Callable[[Array, Array, Array], Array] = field(compare=False)
    largest_ductility: float = inf


@checked
def effective_rule_names(unverified: Truth = False) -> tuple[str, ...]:
    """Names of the rules for effective period and damping.

    Parameters
    ----------
    unverified : bool
        Whether to list also the rules whose constants are unverified.

    Returns
    -------
    tuple of str
        Names for `effective_rule` and `stochlin.correlate`.

    Raises
    ------
    TypeError
        If ``unverified`` is not True or False.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.rules.effective_rule_names()
    ('elastic', 'secant', 'penzien_1997', 'iwan_1980', 'fema_440')
    """
    return tuple(name for name in EFFECTIVE_RULES if unverified or effective_rule(name).verified)


@checked
def effective_rule(name: str | EffectiveRule) -> EffectiveRule:
    """Rule for effective period and damping, by name.

    Parameters
    ----------
    name : str
        One of ``effective_rule_names(unverified=True)``, in upper or lower case. A rule is returned
        unchanged.

    Returns
    -------
    EffectiveRule
        The rule, with the functions ``period_ratio(ductility, hardening)`` and
        ``damping(ductility, hardening, damping)`` [-] and the attributes ``reference``, ``mark`` and
        ``verified``.

    Raises
    ------
    ValueError
        If the name is unknown; the message lists the known names.

    Examples
    --------
    >>> import stochlin as sl
    >>> rule = sl.rules.effective_rule("secant")
    >>> round(float(rule.period_ratio(4.0, 0.0)), 3), round(float(rule.damping(4.0, 0.0, 0.05)), 3)
    (2.0, 0.527)
    """
    if isinstance(name, EffectiveRule):
        return name
    return look_up(EFFECTIVE_RULES, name, "rule")


@dataclass(frozen=True)
class YieldingPair(LinearPair):
    """Two structures with known peak ductilities, the input of the rules."""

    hardening_1: Parameter = parameter("1", "hardening ratio, structure 1", STATIONARY_HARDENING)
    hardening_2: Parameter = parameter("1", "hardening ratio, structure 2", STATIONARY_HARDENING)
    ductility_1: Parameter = parameter("1", "peak ductility, structure 1", POSITIVE)
    ductility_2: Parameter = parameter("1", "peak ductility, structure 2", POSITIVE)
