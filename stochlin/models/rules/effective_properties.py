"""Effective period and damping of a yielding structure, as functions of its peak ductility ``mu``.

The rules come from single records or steady vibration; with their periods and dampings eq. (4)
estimates the correlation of two yielding structures. Below ``mu = 1`` the structure is elastic.
Marks: S, the formula was seen in a copy of its source; C, derived and checked by us; M, from memory,
not compared with the source (high or low: how sure that memory is).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.parameters import Parameter, parameter
from stochlin.models.structures import HARDENING, POSITIVE, LinearPair


@dataclass(frozen=True)
class EffectiveRule:
    """Base of the rules: ``T*/T`` and ``xi*`` of the linear structure that stands for a yielding one.

    The methods take numbers or arrays that broadcast: ``ductility`` is the peak ductility [-],
    ``hardening`` the hardening ratio [-], ``damping`` the viscous damping ratio [-].
    """

    name: ClassVar[str]
    reference: ClassVar[str]
    mark: ClassVar[str]
    verified: ClassVar[bool] = True  # False: too uncertain to be offered among the others
    reason: ClassVar[str] = ""  # why it is not

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """Effective over elastic period."""
        raise NotImplementedError

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """Effective damping ratio."""
        raise NotImplementedError

    def describe(self) -> str:
        """Name, reference and mark in one line, for metadata."""
        doubt = "" if self.verified else f"; {self.reason}"
        return f"{self.name}: {self.reference} [{self.mark}{doubt}]"


@dataclass(frozen=True)
class Elastic(EffectiveRule):
    """The elastic period and damping, whatever the ductility."""

    name: ClassVar[str] = "elastic"
    reference: ClassVar[str] = "Filiatrault, A. and Cervantes, M. (1995), Can. J. Civil Eng. 22"
    mark: ClassVar[str] = "S"

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """One."""
        return np.ones_like(ductility * hardening)

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """The viscous damping ratio."""
        return damping + np.zeros_like(ductility * hardening)


@dataclass(frozen=True)
class Secant(EffectiveRule):
    """Secant stiffness and energy of one bilinear loop, at the share ``c`` of the peak ductility.

    With ``m = max(c mu, 1)``: ``T*/T = sqrt(m/(1 - alpha + alpha m))`` and
    ``xi* = xi + (2/pi)(1 - alpha)(m - 1)/(m (1 - alpha + alpha m))``.
    """

    share: float = 1.0

    name: ClassVar[str] = "secant"
    reference: ClassVar[str] = "Rosenblueth, E. and Herrera, I. (1964), J. Eng. Mech. Div. ASCE 90"
    mark: ClassVar[str] = "C"

    def __post_init__(self) -> None:
        if not 0 < self.share <= 1:
            raise ValueError(f"Secant: share = {self.share!r}; allowed: 0 < share <= 1")

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """Square root of elastic over secant stiffness."""
        m = np.maximum(self.share * ductility, 1)
        return np.sqrt(m / (1 - hardening + hardening * m))

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """Viscous damping plus the energy of a loop over ``4 pi`` times that of the secant spring."""
        m = np.maximum(self.share * ductility, 1)
        loop = (1 - hardening) * (m - 1) / (m * (1 - hardening + hardening * m))
        return damping + (2 / np.pi) * loop


@dataclass(frozen=True)
class Penzien1997(Secant):
    """The secant rule at .65 of the peak ductility."""

    share: float = 0.65

    name: ClassVar[str] = "penzien_1997"
    reference: ClassVar[str] = "Penzien, J. (1997), Earthquake Eng. Struct. Dyn. 26"
    mark: ClassVar[str] = "C, its share .65 M"


@dataclass(frozen=True)
class _PowerRule(EffectiveRule):
    """``T*/T = 1 + a (mu - 1)^b``, ``xi* = xi + c (mu - 1)^d``, whatever the hardening."""

    period_law: ClassVar[tuple[float, float]]
    damping_law: ClassVar[tuple[float, float]]

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """Effective over elastic period."""
        factor, power = self.period_law
        return 1 + factor * _beyond(ductility, hardening) ** power

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """Effective damping ratio."""
        factor, power = self.damping_law
        return damping + factor * _beyond(ductility, hardening) ** power


@dataclass(frozen=True)
class Iwan1980(_PowerRule):
    """Fit to inelastic response spectra: ``1 + .121 (mu-1)^.939``, ``xi + .0587 (mu-1)^.371``."""

    name: ClassVar[str] = "iwan_1980"
    reference: ClassVar[str] = "Iwan, W. D. (1980), Earthquake Eng. Struct. Dyn. 8, 375-388"
    mark: ClassVar[str] = "M high"
    period_law: ClassVar[tuple[float, float]] = (0.121, 0.939)
    damping_law: ClassVar[tuple[float, float]] = (0.0587, 0.371)


@dataclass(frozen=True)
class Fema440(EffectiveRule):
    """Three pieces in ``mu``, below 4, to 6.5, and above, which do not quite meet.

    The published pieces jump: at ``mu = 4`` the period falls by 5.9 % and the damping rises by
    .0056; at 6.5 the period rises by .04 % and the damping falls by .0037.
    """

    name: ClassVar[str] = "fema_440"
    reference: ClassVar[str] = "FEMA 440 (2005), section 6.2"
    mark: ClassVar[str] = "M high"

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """Effective over elastic period."""
        x = _beyond(ductility, hardening)
        late = 0.89 * (np.sqrt(x / (1 + 0.05 * np.maximum(x - 1, 0))) - 1) + 1
        return _pieces(x, 1 + 0.20 * x**2 - 0.038 * x**3, 1.28 + 0.13 * x, late)

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """Effective damping ratio."""
        x = _beyond(ductility, hardening)
        slope = 0.64 * np.maximum(x, 5.5)  # the last piece only: no division by zero
        late = 0.19 * (slope - 1) / slope**2 * self.period_ratio(ductility, hardening) ** 2
        return damping + _pieces(x, (4.9 * x**2 - 1.1 * x**3) / 100, (14 + 0.32 * x) / 100, late)


_DOUBT = "constants from memory, low confidence: compare with the source before use"


@dataclass(frozen=True)
class JengKasaiMaison1992(_PowerRule):
    """``1 + .09 (mu-1)``, ``xi + .084 (mu-1)^1.3``: unverified."""

    name: ClassVar[str] = "jeng_kasai_maison_1992_unverified"
    reference: ClassVar[str] = "Jeng, Kasai and Maison (1992), Earthquake Spectra 8, 201-223"
    mark: ClassVar[str] = "M low"
    verified: ClassVar[bool] = False
    reason: ClassVar[str] = _DOUBT
    period_law: ClassVar[tuple[float, float]] = (0.09, 1.0)
    damping_law: ClassVar[tuple[float, float]] = (0.084, 1.3)


@dataclass(frozen=True)
class KasaiJagiasiJeng1996(_PowerRule):
    """``1 + .18 (mu-1)``, ``xi + .16 (mu-1)^.9``: unverified."""

    name: ClassVar[str] = "kasai_jagiasi_jeng_1996_unverified"
    reference: ClassVar[str] = "Kasai, Jagiasi and Jeng (1996), J. Struct. Eng. ASCE 122"
    mark: ClassVar[str] = "M low"
    verified: ClassVar[bool] = False
    reason: ClassVar[str] = _DOUBT
    period_law: ClassVar[tuple[float, float]] = (0.18, 1.0)
    damping_law: ClassVar[tuple[float, float]] = (0.16, 0.9)


_RULES: dict[str, EffectiveRule] = {
    rule.name: rule
    for rule in (
        Elastic(),
        Secant(),
        Penzien1997(),
        Iwan1980(),
        Fema440(),
        JengKasaiMaison1992(),
        KasaiJagiasiJeng1996(),
    )
}


def effective_rule_names(unverified: bool = False) -> tuple[str, ...]:
    """Names of the rules for effective period and damping.

    Parameters
    ----------
    unverified : bool
        Whether to list those, too, whose constants are too uncertain to be trusted.

    Returns
    -------
    tuple of str
        As `effective_rule` and `correlate` take them.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.effective_rule_names()
    ('elastic', 'secant', 'penzien_1997', 'iwan_1980', 'fema_440')
    """
    return tuple(name for name, rule in _RULES.items() if rule.verified or unverified)


def effective_rule(name: str | EffectiveRule) -> EffectiveRule:
    """Rule for effective period and damping, by name.

    Parameters
    ----------
    name : str
        One of `effective_rule_names`, in any case; a rule itself is passed through.

    Returns
    -------
    EffectiveRule
        With ``period_ratio(ductility, hardening)``, ``damping(ductility, hardening, damping)``,
        ``reference``, ``mark`` and ``verified``.

    Raises
    ------
    ValueError
        If the name is unknown; the message lists those that are.

    Examples
    --------
    >>> import stochlin as sl
    >>> rule = sl.effective_rule("secant")
    >>> round(float(rule.period_ratio(4.0, 0.0)), 3), round(float(rule.damping(4.0, 0.0, 0.05)), 3)
    (2.0, 0.527)
    """
    if isinstance(name, EffectiveRule):
        return name
    rule = _RULES.get(str(name).strip().lower())
    if rule is None:
        raise ValueError(f"rule = {name!r} is not known; allowed: {', '.join(_RULES)}")
    return rule


@dataclass(frozen=True)
class YieldingPair(LinearPair):
    """Two structures with known peak ductilities: what the rules ask for."""

    hardening_1: Parameter = parameter("1", "hardening ratio, structure 1", HARDENING)
    hardening_2: Parameter = parameter("1", "hardening ratio, structure 2", HARDENING)
    ductility_1: Parameter = parameter("1", "peak ductility, structure 1", POSITIVE)
    ductility_2: Parameter = parameter("1", "peak ductility, structure 2", POSITIVE)


def _beyond(ductility: Array, hardening: Array) -> Array:
    """``mu - 1``, zero where elastic, in the shape of both arguments."""
    return np.maximum(ductility - 1, 0) + np.zeros_like(hardening * 1.0)


def _pieces(x: Array, early: Array, middle: Array, late: Array) -> Array:
    return np.where(x < 3, early, np.where(x <= 5.5, middle, late))
