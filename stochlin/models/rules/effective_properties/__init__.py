"""Effective period and damping of a yielding structure, as functions of its peak ductility ``mu``.

The rules were derived from the response to records or from steady vibration. Eq. (4) with their
periods and damping ratios estimates the correlation of two yielding structures. For ``mu <= 1`` the
structure is elastic. The rules are in `effective.toml`.
"""

from stochlin.models.rules.effective_properties.effective_rule import (
    EFFECTIVE_RULES,
    EffectiveRule,
    YieldingPair,
    effective_rule,
    effective_rule_names,
)

__all__ = [
    "EFFECTIVE_RULES",
    "EffectiveRule",
    "YieldingPair",
    "effective_rule",
    "effective_rule_names",
]
