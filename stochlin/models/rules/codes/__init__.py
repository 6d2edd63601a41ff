"""Separation rules: the gap between two buildings by building codes and by four families of rules.

The rules of a country are one module, which publishes their numbers beside their functions. The
rules take peak displacements at the level where the buildings could meet, as the code defines them;
``assumptions`` of each rule states the definition. Some rules also give the distance of one
building from its property line.
"""

from stochlin.models.rules.codes.code_rule import (
    ALIGNED,
    AT_LEAST_1,
    BEHAVIOUR,
    BOTH,
    BY_HEIGHT,
    CODE_RULES,
    DEFLECTION,
    FACTORS_OF_CODES,
    IMPORTANCE,
    IMPORTANCE_RANGE,
    SECOND_UNKNOWN,
    STOREYS_ABOVE_GROUND,
    SUM_OF_DISTANCES,
    ZONES,
    CodeNumber,
    CodeRule,
    Site,
    Zone,
    code_rule,
    code_rule_names,
    rules_of,
)

__all__ = [
    "ALIGNED",
    "AT_LEAST_1",
    "BEHAVIOUR",
    "BOTH",
    "BY_HEIGHT",
    "CODE_RULES",
    "DEFLECTION",
    "FACTORS_OF_CODES",
    "IMPORTANCE",
    "IMPORTANCE_RANGE",
    "SECOND_UNKNOWN",
    "STOREYS_ABOVE_GROUND",
    "SUM_OF_DISTANCES",
    "ZONES",
    "CodeNumber",
    "CodeRule",
    "Site",
    "Zone",
    "code_rule",
    "code_rule_names",
    "rules_of",
]
