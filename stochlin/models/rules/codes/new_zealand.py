"""The rule of New Zealand, NZS 1170.5.

A building stays on its side of the boundary, and does not touch others of its site. At the ultimate
limit state its displacement does not reach beyond the boundary, so that the gap between two
properties is the sum of the peaks; it is also taken within one property.
"""

from __future__ import annotations

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, SUM_OF_DISTANCES, CodeRule
from stochlin.models.rules.codes.families import total

NZS_1170_5 = CodeRule(
    name="nzs_1170_5",
    title="NZS 1170.5",
    reference="NZS 1170.5:2004, New Zealand, 7.4.1",
    mark="M",
    gap_of=total,
    family="sum",
    assumptions="peaks are those of the ultimate limit state, mu times elastic",
    of_pairs=(SUM_OF_DISTANCES,),
    line="from the boundary a building keeps its own displacement",
    multiplies="deflection",
    countries=("New Zealand",),
    called={"behaviour": "reduction k_mu/Sp", "deflection": "structural ductility factor mu"},
)
publish(CODE_RULES, NZS_1170_5, place=21)
