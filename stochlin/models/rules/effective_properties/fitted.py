"""Effective periods and damping ratios fitted to the response to recorded motions."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES, EffectiveRule
from stochlin.models.rules.published import published

DOUBT = "constants in doubt, not compared with their source: compare before use"


class _PowerRule(EffectiveRule):
    """``T*/T = 1 + a (mu - 1)^b`` and ``xi* = xi + c (mu - 1)^d``, for any hardening ratio."""

    period_law: ClassVar[tuple[float, float]]  # a, b
    damping_law: ClassVar[tuple[float, float]]  # c, d

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        factor, power = self.period_law
        return 1 + factor * _beyond(ductility, hardening) ** power

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        factor, power = self.damping_law
        return damping + factor * _beyond(ductility, hardening) ** power


@published(
    EFFECTIVE_RULES,
    "iwan_1980",
    "Iwan, W. D. (1980), Earthquake Eng. Struct. Dyn. 8, 375-388",
    "M high",
    4,
    "Iwan (1980)",
)
class Iwan1980(_PowerRule):
    """``T*/T = 1 + 0.121 (mu - 1)^0.939``, ``xi* = xi + 0.0587 (mu - 1)^0.371``, a fit to spectra.

    The spectra are those of ductilities from 2 to 8.
    """

    largest_ductility = 8.0
    period_law = (0.121, 0.939)
    damping_law = (0.0587, 0.371)


@published(EFFECTIVE_RULES, "fema_440", "FEMA 440 (2005), section 6.2", "M high", 5, "FEMA-440")
class Fema440(EffectiveRule):
    """Formulas of FEMA 440 for ``mu`` below 4, from 4 to 6.5, and above.

    The published formulas do not quite meet: at ``mu = 4`` the period falls by 5.9 % and the damping
    ratio rises by 0.0056; at ``mu = 6.5`` the period rises by 0.04 % and the damping ratio falls by
    0.0037. The report calls results for ductilities beyond 10 to 12 unreliable.
    """

    largest_ductility = 10.0

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        x = _beyond(ductility, hardening)
        late = 0.89 * (np.sqrt(x / (1 + 0.05 * np.maximum(x - 1, 0))) - 1) + 1
        return _pieces(x, 1 + 0.20 * x**2 - 0.038 * x**3, 1.28 + 0.13 * x, late)

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        x = _beyond(ductility, hardening)
        slope = 0.64 * np.maximum(x, 5.5)  # used for x > 5.5 only; the bound avoids a division by zero
        late = 0.19 * (slope - 1) / slope**2 * self.period_ratio(ductility, hardening) ** 2
        return damping + _pieces(x, (4.9 * x**2 - 1.1 * x**3) / 100, (14 + 0.32 * x) / 100, late)


@published(
    EFFECTIVE_RULES,
    "jeng_kasai_maison_1992_unverified",
    "Jeng, Kasai and Maison (1992), Earthquake Spectra 8, 201-223",
    "M low",
    6,
    "Jeng, Kasai and Maison (1992)",
)
class JengKasaiMaison1992(_PowerRule):
    """``T*/T = 1 + 0.09 (mu - 1)``, ``xi* = xi + 0.084 (mu - 1)^1.3``; the constants are unverified."""

    reason = DOUBT

    period_law = (0.09, 1.0)
    damping_law = (0.084, 1.3)


@published(
    EFFECTIVE_RULES,
    "kasai_jagiasi_jeng_1996_unverified",
    "Kasai, Jagiasi and Jeng (1996), J. Struct. Eng. ASCE 122",
    "M low",
    7,
    "Kasai, Jagiasi and Jeng (1996)",
)
class KasaiJagiasiJeng1996(_PowerRule):
    """``T*/T = 1 + 0.18 (mu - 1)``, ``xi* = xi + 0.16 (mu - 1)^0.9``; the constants are unverified."""

    reason = DOUBT

    period_law = (0.18, 1.0)
    damping_law = (0.16, 0.9)


def _beyond(ductility: Array, hardening: Array) -> Array:
    """``mu - 1``, or zero where the structure is elastic, in the common shape of both arguments."""
    return np.maximum(ductility - 1, 0) + np.zeros_like(hardening * 1.0)


def _pieces(x: Array, early: Array, middle: Array, late: Array) -> Array:
    """The value for ``x = mu - 1`` below 3, up to 5.5, and above."""
    return np.where(x < 3, early, np.where(x <= 5.5, middle, late))
