"""The rule of India, IS 1893.

For floors at the same levels the clause asks for R1 d1 + R2 d2, the sum of the peaks, for others
for R (d1 + d2), with the larger R if they differ. Only the edition of 2002 halved R for two similar
buildings with level floors.
"""

from __future__ import annotations

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeRule
from stochlin.models.rules.codes.families import total

IS_1893 = CodeRule(
    name="is_1893",
    title="IS 1893",
    reference="IS 1893 (Part 1): 2016, 7.11.3",
    mark="M",
    gap_of=total,
    family="sum",
    assumptions=(
        "peaks are R times the displacements under design forces, where floors are not "
        "level with the larger R of both"
    ),
    multiplies="behaviour",
    larger_factor=True,
    countries=("India",),
    called={"behaviour": "response reduction factor R"},
)
publish(CODE_RULES, IS_1893, place=7)
