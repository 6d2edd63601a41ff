"""The clauses of building codes, in one line each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from stochlin.models.rules.codes import (
    ALIGNED,
    CODE_RULES,
    FIXED,
    HEIGHT,
    INELASTIC,
    SRSS,
    SUM,
    ZONES,
    CodeRule,
    Site,
)
from stochlin.models.rules.codes.families import NO_PEAKS, OF_HEIGHT, Numbered, ShareOfHeight, SquareRoot
from stochlin.models.rules.published import published

OWN_PEAK = "from a property line not common to a public way a building keeps its own displacement"
OWN_LOT = "a share of its height from its own boundary, 50 mm at least"


@published(CODE_RULES, "asce_7", "ASCE 7, section on structural separation; IBC", "S", 3)
class Asce7(SquareRoot):
    """ASCE 7 and IBC: square root of the sum of squares.

    From a property line the building's own displacement (ASCE 7-16, 12.12.3).
    """

    line = OWN_PEAK
    assumptions = "peaks are maximum inelastic displacements, Cd times elastic over Ie"


@published(CODE_RULES, "canada", "National Building Code of Canada", "S", 4)
class Canada(SquareRoot):
    """National Building Code of Canada: square root of the sum of squares."""


@published(CODE_RULES, "eurocode_8", "EN 1998-1, 4.4.2.7", "M high", 5)
class Eurocode8(CodeRule):
    """Eurocode 8, 4.4.2.7: square root of the sum of squares, times 0.7 if floors align."""

    assumptions = f"peaks are design displacements, behaviour factor times elastic; {ALIGNED}"
    family = SRSS

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.7) * site.root_of_squares


@published(CODE_RULES, "ubc_97", "Uniform Building Code 1997, 1633.2.11", "M high", 6)
class Ubc97(SquareRoot):
    """UBC-97: square root of the sum of squares of maximum inelastic displacements.

    From a property line the building's own.
    """

    line = OWN_PEAK
    assumptions = "peaks are maximum inelastic displacements, 0.7 R times those of design"


@published(CODE_RULES, "mexico_city", "NTC-Sismo, Mexico City", "S", 7)
class MexicoCity(CodeRule):
    """Mexico City: each building keeps 50 mm and ``D + c h`` from its boundary; half if slabs align.

    ``c`` is 0.001, 0.003, 0.006 in zones I, II, III. Between two bodies the two distances add up.
    """

    assumptions = f"{INELASTIC}; {ALIGNED}"
    family = SUM
    needs = (*OF_HEIGHT, "zone")
    line = f"a building keeps its displacement and {OWN_LOT}"

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.5) * (self.from_line(site) + self.from_line(site.mirrored()))

    def from_line(self, site: Site) -> Any:
        return np.maximum(site.peak_1 + ZONES[str(site.zone)] * site.height_1, 0.05)


@published(CODE_RULES, "is_1893", "IS 1893 (Part 1)", "M", 8)
class India(CodeRule):
    """IS 1893: the sum; half of it if floors align."""

    assumptions = f"peaks are R times the displacements under design forces; {ALIGNED}"
    family = SUM

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.5) * site.total


@published(CODE_RULES, "taiwan", "Seismic design specifications for buildings, Taiwan", "S", 9)
class Taiwan(CodeRule):
    """Taiwan: 0.6 of the sum."""

    assumptions = "peaks are 1.4 alpha_y Ra times the displacements under design forces"
    family = SUM

    def of_site(self, site: Site) -> Any:
        return 0.6 * site.total


@published(CODE_RULES, "peru_e030", "Norma E.030, Peru", "M", 10)
class Peru(CodeRule):
    """E.030: the largest of 0.006 h, 30 mm and 2/3 of the sum; ``h`` the lower building's height."""

    family = SUM
    needs = OF_HEIGHT

    def of_site(self, site: Site) -> Any:
        least = np.maximum(0.006 * site.lower_height, 0.03)
        return np.maximum(least, site.total * (2 / 3))


@published(CODE_RULES, "asce_41", "ASCE 41-13, checklist, adjacent buildings; FEMA 310", "M high", 13)
@dataclass(frozen=True)
class Asce41(ShareOfHeight):
    """ASCE 41-13 and FEMA 310: 0.04 of the lower building's height, where nothing else is known.

    ASCE 41-17 has lower shares where seismicity is lower.
    """

    assumptions = f"0.04 of the height is a first check of existing buildings; {NO_PEAKS}"
    line = ""

    factor: float = 0.04


BY_HEIGHT = {"I": 0.007, "II": 0.009, "III": 0.012}  # share of the height, simplified method


@published(CODE_RULES, "mexico_city_simplified", "NTC-Sismo, Mexico City, simplified method", "S", 14)
class MexicoCitySimplified(CodeRule):
    """Mexico City, simplified method: each building keeps 50 mm and ``c h``; half if slabs align.

    ``c`` is 0.007, 0.009, 0.012 in zones I, II, III. Between two bodies the two distances add up.
    """

    assumptions = f"{NO_PEAKS}: the simplified method has none; {ALIGNED}"
    family = HEIGHT
    needs = (*OF_HEIGHT, "zone")
    line = f"a building keeps {OWN_LOT}"

    def of_site(self, site: Site) -> Any:
        return site.if_aligned(0.5) * (self.from_line(site) + self.from_line(site.mirrored()))

    def from_line(self, site: Site) -> Any:
        return np.maximum(BY_HEIGHT[str(site.zone)] * site.height_1, 0.05) + 0 * site.peak_1


@published(CODE_RULES, "china_gb_50011", "GB 50011-2010, 6.1.4", "S", 15)
@dataclass(frozen=True)
class China(Numbered):
    """GB 50011, concrete frames: 100 mm; above 15 m 20 mm more for every 3 m of the lower building.

    The 3 m are those of intensity 8; of intensity 6, 7 and 9 they are 5, 4 and 2 m. Taken in
    proportion. Without heights the buildings are taken to have 15 m at most.
    """

    assumptions = f"concrete frames, intensity 8, up to 15 m where no height is given; {NO_PEAKS}"
    family = FIXED
    units = "m"

    step: float = 3.0

    def of_site(self, site: Site) -> Any:
        beyond = np.maximum(site.lower_height - 15.0, 0.0) if site.heights_known else 0.0
        return 0.1 + 0.02 * beyond / self.step + 0 * site.total
