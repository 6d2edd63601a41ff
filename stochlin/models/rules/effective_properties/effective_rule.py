"""Rules for effective periods and damping, by name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from math import inf
from typing import Any

import numpy as np

from stochlin.files.package_data import data_of
from stochlin.kernels.basics.arrays import Array
from stochlin.models.arguments import Truth, checked
from stochlin.models.parameters import POSITIVE, Parameter, parameter
from stochlin.models.rules import Published, look_up, publish
from stochlin.models.structures import STATIONARY_HARDENING, LinearPair
from stochlin.registry import Registry

EFFECTIVE_RULES: Registry[EffectiveRule] = Registry(
    "effective rule", "stochlin.models.rules.effective_properties"
)


@dataclass(frozen=True, kw_only=True)
class EffectiveRule(Published):
    """A rule for the effective period ``T*`` and damping ratio ``xi*`` of a linear structure.

    The linear structure replaces a yielding one. The functions take numbers or arrays that
    broadcast: ``period_ratio(ductility, hardening)`` is ``T*/T`` [-], ``damping(ductility,
    hardening, damping)`` is ``xi*`` [-], for the peak ductility, the hardening ratio and the
    viscous damping ratio of the yielding structure. ``largest_ductility`` [-] is that to which a
    rule was fitted, infinite for one that was derived or whose source was not seen; the functions
    go on beyond it, charts do not.
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
    return tuple(name for name in EFFECTIVE_RULES if unverified or not effective_rule(name).reason)


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
        The rule, with the functions ``period_ratio(ductility, hardening)`` and ``damping(ductility,
        hardening, damping)`` [-] and the attributes ``reference``, ``mark`` and ``reason``, why its
        constants are in doubt, if they are.

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


def secant_period(share: float, ductility: Array, hardening: Array) -> Array:
    """``T*/T = sqrt(m/(1 - alpha + alpha m))``, with ``m = max(c mu, 1)``, by secant stiffness [-].

    The bilinear loop is that of ``share``, ``c`` [-], times the peak ductility.
    """
    m = np.maximum(share * ductility, 1)
    return np.sqrt(m / (1 - hardening + hardening * m))


def secant_damping(share: float, ductility: Array, hardening: Array, damping: Array) -> Array:
    """``xi* = xi + (2/pi)(1 - alpha)(m - 1)/(m (1 - alpha + alpha m))`` [-].

    What is added is the energy of the loop over ``4 pi`` times the secant strain energy.
    """
    m = np.maximum(share * ductility, 1)
    loop = (1 - hardening) * (m - 1) / (m * (1 - hardening + hardening * m))
    return damping + (2 / np.pi) * loop


def power_period(factor: float, power: float, ductility: Array, hardening: Array) -> Array:
    """``T*/T = 1 + a (mu - 1)^b``, for any hardening ratio [-]."""
    return 1 + factor * _beyond(ductility, hardening) ** power


def power_damping(
    factor: float, power: float, ductility: Array, hardening: Array, damping: Array
) -> Array:
    """``xi* = xi + c (mu - 1)^d``, for any hardening ratio [-]."""
    return damping + factor * _beyond(ductility, hardening) ** power


def fema_440_period(ductility: Array, hardening: Array) -> Array:
    """``T*/T`` of FEMA 440 for ``mu`` below 4, from 4 to 6.5, and above [-].

    The published formulas do not quite meet: at ``mu = 4`` the period falls by 5.9 % and the
    damping ratio rises by 0.0056; at ``mu = 6.5`` the period rises by 0.04 % and the damping ratio
    falls by 0.0037. The report calls results for ductilities beyond 10 to 12 unreliable.
    """
    x = _beyond(ductility, hardening)
    late = 0.89 * (np.sqrt(x / (1 + 0.05 * np.maximum(x - 1, 0))) - 1) + 1
    return _pieces(x, 1 + 0.20 * x**2 - 0.038 * x**3, 1.28 + 0.13 * x, late)


def fema_440_damping(ductility: Array, hardening: Array, damping: Array) -> Array:
    """``xi*`` of FEMA 440 in the same three pieces [-]."""
    x = _beyond(ductility, hardening)
    slope = 0.64 * np.maximum(x, 5.5)  # used for x > 5.5 only; the bound avoids a division by zero
    late = 0.19 * (slope - 1) / slope**2 * fema_440_period(ductility, hardening) ** 2
    return damping + _pieces(x, (4.9 * x**2 - 1.1 * x**3) / 100, (14 + 0.32 * x) / 100, late)


def _beyond(ductility: Array, hardening: Array) -> Array:
    """``mu - 1``, or zero where the structure is elastic, in the common shape of both arguments."""
    return np.maximum(ductility - 1, 0) + np.zeros_like(hardening * 1.0)


def _pieces(x: Array, early: Array, middle: Array, late: Array) -> Array:
    """The value for ``x = mu - 1`` below 3, up to 5.5, and above."""
    return np.where(x < 3, early, np.where(x <= 5.5, middle, late))


def _read(name: str, row: dict[str, Any]) -> EffectiveRule:
    """A rule from its row: by a share of the ductility, by powers, or by its own formulas."""
    both: tuple[Callable[..., Array], Callable[..., Array]] = fema_440_period, fema_440_damping
    if (share := row.pop("share", None)) is not None:
        both = partial(secant_period, share), partial(secant_damping, share)
    elif "period" in row:
        both = (
            partial(power_period, *row.pop("period")),
            partial(power_damping, *row.pop("damping")),
        )
    return EffectiveRule(name=name, period_ratio=both[0], damping=both[1], **row)


TABLE = data_of(__package__, "effective.toml")
for place, (name, row) in enumerate(TABLE.items()):
    publish(EFFECTIVE_RULES, _read(name, row), place)
