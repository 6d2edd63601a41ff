"""Rules of the United States: ASCE 7 (once UBC 97) for new buildings, ASCE 41 for existing ones."""

from __future__ import annotations

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, SUM_OF_DISTANCES, CodeNumber, CodeRule
from stochlin.models.rules.codes.families import root_of_squares, share_of_height

# "Adjacent buildings on the same property" are separated by the root of squares; a structure is set
# back from a property line that is not common to a public way by its own displacement, so that the
# gap between two properties is the sum of both. So say IBC 2000 and 2003 (1620.4.5), IBC 2009 and,
# by reference from IBC 2012 on, ASCE 7-10 and 7-16 (12.12.3); IBC 2006 and ASCE 7-05 lack the
# clause.
ASCE_7 = CodeRule(
    name="asce_7",
    title="ASCE 7",
    reference="ASCE 7-10 and 7-16, 12.12.3; IBC 2000 to 2003 and 2009",
    mark="S",
    gap_of=root_of_squares,
    family="SRSS",
    between="sum",
    assumptions="peaks are maximum inelastic displacements, Cd times elastic over Ie",
    of_pairs=(SUM_OF_DISTANCES,),
    line="from a property line not common to a public way a building keeps its own displacement",
    multiplies="deflection",
    over_importance=True,
    countries=("United States", "USA"),
    called={
        "behaviour": "response modification coefficient R",
        "deflection": "deflection amplification factor Cd",
        "importance": "importance factor Ie",
    },
)
publish(CODE_RULES, ASCE_7, place=2)

# A building keeps its own displacement from a property line. The sentences on displacements and on
# property lines were seen in a quotation, and 0.7 R in the code of the Philippines, which follows
# this one; the root of squares in IBC only.
UBC_97 = CodeRule(
    name="ubc_97",
    title="UBC 97",
    reference="Uniform Building Code 1997, 1633.2.11",
    mark="M high",
    gap_of=root_of_squares,
    family="SRSS",
    between="sum",
    assumptions="peaks are maximum inelastic displacements, 0.7 R times those of design",
    of_pairs=(SUM_OF_DISTANCES,),
    line="from a property line not common to a public way a building keeps its own displacement",
    multiplies="behaviour",
    share=0.7,
    called={"behaviour": "overstrength and ductility factor R"},
)
publish(CODE_RULES, UBC_97, place=5)

# As a first check. ASCE 41-17 has smaller factors for lower levels of seismicity.
ASCE_41 = CodeRule(
    name="asce_41",
    title="ASCE 41",
    reference="ASCE 41-13, checklist, adjacent buildings; FEMA 310",
    mark="M high",
    gap_of=share_of_height,
    family="height",
    assumptions="0.04 of the height is a first check of existing buildings; the peaks are not used",
    needs=("height_1", "height_2"),
    number=CodeNumber("factor", usual=0.04),
)
publish(CODE_RULES, ASCE_41, place=13)
