"""Formulas of effective properties: by secant stiffness, and fits; `effective.toml` has all else."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from functools import partial
from importlib.resources import files
from typing import Any

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.rules.effective_properties import EFFECTIVE_RULES, EffectiveRule
from stochlin.models.rules.published import publish


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

    The published formulas do not quite meet: at ``mu = 4`` the period falls by 5.9 % and the damping
    ratio rises by 0.0056; at ``mu = 6.5`` the period rises by 0.04 % and the damping ratio falls by
    0.0037. The report calls results for ductilities beyond 10 to 12 unreliable.
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
        both = partial(power_period, *row.pop("period")), partial(power_damping, *row.pop("damping"))
    return EffectiveRule(name=name, period_ratio=both[0], damping=both[1], **row)


TABLE = tomllib.loads(files(__package__).joinpath("effective.toml").read_text(encoding="utf-8"))
for place, (name, row) in enumerate(TABLE.items()):
    publish(EFFECTIVE_RULES, _read(name, row), place)
