"""Effective properties of the elastic structure, and by secant stiffness and loop energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES, EffectiveRule
from stochlin.models.rules.published import published


@published(
    EFFECTIVE_RULES, "elastic", "Filiatrault, A. and Cervantes, M. (1995), Can. J. Civil Eng. 22", "S", 1
)
class Elastic(EffectiveRule):
    """The elastic period and damping ratio at any ductility."""

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        return np.ones_like(ductility * hardening)

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        return damping + np.zeros_like(ductility * hardening)


@published(
    EFFECTIVE_RULES,
    "secant",
    "Rosenblueth, E. and Herrera, I. (1964), J. Eng. Mech. Div. ASCE 90",
    "C",
    2,
)
@dataclass(frozen=True)
class Secant(EffectiveRule):
    """Secant stiffness and energy of one bilinear loop at ``c`` times the peak ductility.

    With ``m = max(c mu, 1)`` and the hardening ratio ``alpha``,
    ``T*/T = sqrt(m/(1 - alpha + alpha m))`` and
    ``xi* = xi + (2/pi)(1 - alpha)(m - 1)/(m (1 - alpha + alpha m))``. ``share`` is ``c`` [-].
    """

    share: float = 1.0

    def __post_init__(self) -> None:
        if not 0 < self.share <= 1:
            raise ValueError(f"Secant: share = {brief(self.share)}; allowed: 0 < share <= 1")

    def period_ratio(self, ductility: Array, hardening: Array) -> Array:
        """Effective over elastic period [-], the square root of elastic over secant stiffness."""
        m = np.maximum(self.share * ductility, 1)
        return np.sqrt(m / (1 - hardening + hardening * m))

    def damping(self, ductility: Array, hardening: Array, damping: Array) -> Array:
        """Viscous damping ratio plus loop energy over ``4 pi`` times secant strain energy [-]."""
        m = np.maximum(self.share * ductility, 1)
        loop = (1 - hardening) * (m - 1) / (m * (1 - hardening + hardening * m))
        return damping + (2 / np.pi) * loop


@published(
    EFFECTIVE_RULES,
    "penzien_1997",
    "Penzien, J. (1997), Earthquake Eng. Struct. Dyn. 26",
    "C, share 0.65 M",
    3,
    "Penzien (1997)",
)
@dataclass(frozen=True)
class Penzien1997(Secant):
    """The secant rule at 0.65 of the peak ductility."""

    share: float = 0.65
