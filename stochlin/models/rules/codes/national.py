"""The clauses of building codes, in one line each."""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.models.rules.codes import CODE_RULES, INELASTIC, ZONES, CodeRule, Site
from stochlin.models.rules.codes.families import SquareRoot
from stochlin.models.rules.published import published

ALIGNED = "the factor for floors that align accepts contact at slab level"


@published(CODE_RULES, "asce_7", "ASCE 7, section on structural separation; IBC", "S", 3)
class Asce7(SquareRoot):
    """ASCE 7 and IBC: square root of the sum of squares."""

    assumptions = "peaks are maximum inelastic displacements, Cd times elastic over Ie"


@published(CODE_RULES, "canada", "National Building Code of Canada", "S", 4)
class Canada(SquareRoot):
    """National Building Code of Canada: square root of the sum of squares."""


@published(CODE_RULES, "eurocode_8", "EN 1998-1, 4.4.2.7", "M high", 5)
class Eurocode8(CodeRule):
    """Eurocode 8, 4.4.2.7: square root of the sum of squares, times .7 if floors align."""

    assumptions = f"peaks are design displacements, behaviour factor times elastic; {ALIGNED}"

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.7) * site.root_of_squares


@published(CODE_RULES, "ubc_97", "Uniform Building Code 1997, 1633.2.11", "M high", 6)
class Ubc97(SquareRoot):
    """UBC-97: square root of the sum of squares of maximum inelastic displacements."""

    assumptions = "peaks are maximum inelastic displacements, .7 R times those of design"


@published(CODE_RULES, "mexico_city", "NTC-Sismo, Mexico City", "S", 7)
class MexicoCity(CodeRule):
    """Mexico City: each building keeps 50 mm and ``D + c h`` from its boundary; half if slabs align.

    ``c`` is .001, .003, .006 in zones I, II, III. Between two bodies the two distances add up.
    """

    assumptions = f"{INELASTIC}; {ALIGNED}"
    needs = ("height_1", "height_2", "zone")

    def of_site(self, site: Site) -> Any:
        share = ZONES[str(site.zone)]
        one, two = (
            np.maximum(peak + share * height, 0.05)
            for peak, height in ((site.peak_1, site.height_1), (site.peak_2, site.height_2))
        )
        return site.if_aligned(0.5) * (one + two)


@published(CODE_RULES, "is_1893", "IS 1893 (Part 1)", "M", 8)
class India(CodeRule):
    """IS 1893: the sum; half of it if floors align."""

    assumptions = f"peaks are R times the displacements under design forces; {ALIGNED}"

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.5) * site.total


@published(CODE_RULES, "taiwan", "Seismic design specifications for buildings, Taiwan", "S", 9)
class Taiwan(CodeRule):
    """Taiwan: .6 of the sum."""

    assumptions = "peaks are 1.4 alpha_y Ra times the displacements under design forces"

    def of_site(self, site: Site) -> Any:
        return 0.6 * site.total


@published(CODE_RULES, "peru_e030", "Norma E.030, Peru", "M", 10)
class Peru(CodeRule):
    """E.030: the largest of .006 h, 30 mm and 2/3 of the sum; ``h`` the lower building's height."""

    needs = ("height_1", "height_2")

    def of_site(self, site: Site) -> Any:
        least = np.maximum(0.006 * site.lower_height, 0.03)
        return np.maximum(least, site.total * (2 / 3))
