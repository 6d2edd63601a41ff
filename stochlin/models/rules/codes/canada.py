"""The rule of the National Building Code of Canada.

By 4.1.8.13 the peaks are the elastic deflections times Rd Ro/IE. Adjacent structures are separated
by the root of squares of their individual deflections, or connected, as the Ontario code says, too.
"""

from __future__ import annotations

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, CodeRule
from stochlin.models.rules.codes.families import root_of_squares

CANADA = CodeRule(
    name="canada",
    title="Canada",
    reference="National Building Code of Canada",
    mark="S",
    gap_of=root_of_squares,
    family="SRSS",
    assumptions="peaks are anticipated deflections, Rd Ro over IE times elastic",
    multiplies="behaviour",
    over_importance=True,
    countries=("Canada",),
    called={"behaviour": "force modification factors Rd Ro", "importance": "importance factor IE"},
)
publish(CODE_RULES, CANADA, place=3)
