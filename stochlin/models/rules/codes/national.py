"""Separation rules of building codes, one class for each clause."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from stochlin.models.rules.codes import (
    ALIGNED,
    ALIKE,
    BEHAVIOUR,
    BETWEEN,
    CODE_RULES,
    DEFLECTION,
    FIXED,
    HEIGHT,
    IMPORTANCE,
    INELASTIC,
    SRSS,
    SUM,
    ZONES,
    CodeRule,
    Site,
)
from stochlin.models.rules.codes.families import NO_PEAKS, OF_HEIGHT, Numbered, ShareOfHeight, SquareRoot
from stochlin.models.rules.published import published

OWN_LOT = "a share of its height from its own boundary, 50 mm at least"


class ByProperty(SquareRoot):
    """Square root of the sum of squares within one property, the sum of the peaks between two.

    A building keeps its own peak from a property line: between two properties the gap is the sum.
    """

    line = "from a property line not common to a public way a building keeps its own displacement"

    def of_site(self, site: Site) -> Any:
        return site.root_of_squares if site.neighbours.same_property else site.total

    def from_line(self, site: Site) -> Any:
        return site.peak_1

    def governed_by(self, same_property: bool) -> str:
        return SRSS if same_property else SUM


@published(CODE_RULES, "asce_7", "ASCE 7-10 and 7-16, 12.12.3; IBC 2000 to 2003 and 2009", "S", 3)
class Asce7(ByProperty):
    """ASCE 7 and IBC: square root of the sum of the squared peaks within one property.

    "Adjacent buildings on the same property" are separated by the root of squares; a structure is set
    back from a property line that is not common to a public way by its own displacement, so that the gap
    between two properties is the sum of both. So say IBC 2000 and 2003 (1620.4.5), IBC 2009 and, by
    reference from IBC 2012 on, ASCE 7-10 and 7-16 (12.12.3); IBC 2006 and ASCE 7-05 lack the clause.
    """

    assumptions = f"peaks are maximum inelastic displacements, Cd times elastic over Ie; {BETWEEN}"
    multiplies = DEFLECTION
    over_importance = True
    called: ClassVar = {
        BEHAVIOUR: "response modification coefficient R",
        DEFLECTION: "deflection amplification factor Cd",
        IMPORTANCE: "importance factor Ie",
    }
    countries = ("United States", "USA")


@published(CODE_RULES, "canada", "National Building Code of Canada", "S", 4)
class Canada(SquareRoot):
    """National Building Code of Canada: square root of the sum of the squared peaks.

    By 4.1.8.13 they are the elastic deflections times ``Rd Ro/IE``. Adjacent structures are separated by
    the root of squares of their individual deflections, or connected, as the Ontario code says, too.
    """

    assumptions = "peaks are anticipated deflections, Rd Ro over IE times elastic"
    multiplies = BEHAVIOUR
    over_importance = True
    called: ClassVar = {
        BEHAVIOUR: "force modification factors Rd Ro",
        IMPORTANCE: "importance factor IE",
    }
    countries = ("Canada",)


@published(CODE_RULES, "eurocode_8", "EN 1998-1:2004, 4.4.2.7", "M high", 5)
class Eurocode8(ByProperty):
    """Eurocode 8, 4.4.2.7: square root of squares within one property, times 0.7 if floors align.

    By paragraph (2) buildings of one property keep the root of squares of their displacements, and a
    building keeps its own displacement from a property line, so that the gap between two properties is
    the sum of both. Paragraph (3) reduces "the above referred distance" by 0.7 for floors at the same
    elevations. The text of the code was not seen: the reduction is taken within one property only.
    """

    line = "from a property line a building keeps its own displacement"
    assumptions = f"peaks are design displacements, behaviour factor times elastic; {BETWEEN}; {ALIGNED}"
    multiplies = BEHAVIOUR
    called: ClassVar = {BEHAVIOUR: "behaviour factor q", IMPORTANCE: "importance factor, within ag"}
    countries = (
        *("Europe", "Austria", "Bulgaria", "Croatia", "Cyprus", "Czechia", "France", "Germany"),
        *("Greece", "Hungary", "Portugal", "Slovakia", "Slovenia"),
    )

    def of_site(self, site: Site) -> Any:
        factor = site.if_aligned(0.7) if site.neighbours.same_property else 1.0
        return factor * super().of_site(site)


@published(CODE_RULES, "ubc_97", "Uniform Building Code 1997, 1633.2.11", "M high", 6)
class Ubc97(ByProperty):
    """UBC-97: square root of the sum of the squared inelastic displacements within one property.

    A building keeps its own displacement from a property line, so that the gap between two properties is
    the sum of both. The sentences on displacements and on property lines were seen in a quotation, and
    ``0.7 R`` in the code of the Philippines, which follows this one; the root of squares in IBC only.
    """

    assumptions = f"peaks are maximum inelastic displacements, 0.7 R times those of design; {BETWEEN}"
    multiplies = BEHAVIOUR
    share = 0.7
    called: ClassVar = {BEHAVIOUR: "overstrength and ductility factor R"}


class OwnLot(CodeRule):
    """Mexico City: the sum of both distances from the boundary, half of it for buildings that are alike.

    NTC-Sismo, 1.10, allows half of the sum if both bodies have "la misma altura y estructuración" and
    their slabs are at the same height in all storeys: the same height and structural system.
    """

    def of_site(self, site: Site) -> Any:
        return (1 - 0.5 * site.alike) * self.from_both_lines(site)


@published(CODE_RULES, "mexico_city", "NTC-Sismo, Mexico City, 1.10", "S", 7)
class MexicoCity(OwnLot):
    """Mexico City: the larger of ``D + c h`` and 50 mm from the boundary.

    ``D`` is the peak displacement and ``h`` the height of the building; ``c`` is 0.001, 0.003 and 0.006
    in zones I, II and III. The gap between two buildings is the sum of both distances; half of it if
    their heights, their structural systems and the levels of their slabs are the same. The edition of
    2023, which has other zones, was not seen.
    """

    assumptions = f"{INELASTIC}; {ALIKE}"
    multiplies = BEHAVIOUR
    called: ClassVar = {BEHAVIOUR: "seismic behaviour factor Q"}
    countries = ("Mexico",)
    family = SUM
    needs = (*OF_HEIGHT, "zone")
    line = f"a building keeps its displacement and {OWN_LOT}"

    def from_line(self, site: Site) -> Any:
        return np.maximum(site.peak_1 + ZONES[str(site.zone)] * site.height_1, 0.05)


@published(CODE_RULES, "is_1893", "IS 1893 (Part 1): 2016, 7.11.3", "M", 8)
class India(CodeRule):
    """IS 1893 of 2016: the sum of the peaks, also where floors align.

    For floors at the same levels the clause asks for ``R_1 d_1 + R_2 d_2``, the sum of the peaks, for
    others for ``R`` times ``d_1 + d_2``, with the larger ``R`` if they differ. Only the edition of 2002
    halved ``R`` for two similar buildings with level floors.
    """

    assumptions = (
        "peaks are R times the displacements under design forces, where floors are not level with the "
        "larger R of both"
    )
    multiplies = BEHAVIOUR
    larger_factor = True
    called: ClassVar = {BEHAVIOUR: "response reduction factor R"}
    countries = ("India",)
    family = SUM

    def of_site(self, site: Site) -> Any:
        return site.total


@published(CODE_RULES, "taiwan", "Seismic design specifications for buildings, Taiwan", "S", 9)
class Taiwan(CodeRule):
    """Taiwan: 0.6 times the sum of the peaks."""

    assumptions = "peaks are 1.4 alpha_y Ra times the displacements under design forces"
    multiplies = DEFLECTION
    called: ClassVar = {
        BEHAVIOUR: "1.4 alpha_y Fu, by which forces are less",
        DEFLECTION: "1.4 alpha_y Ra",
    }
    countries = ("Taiwan",)
    family = SUM

    def of_site(self, site: Site) -> Any:
        return 0.6 * site.total


@published(CODE_RULES, "peru_e030", "Norma E.030 (2018), Peru, article 33", "S", 10)
class Peru(CodeRule):
    """E.030: within one property the larger of ``s`` and 2/3 of the sum of the peaks.

    ``s`` is the larger of ``0.006 h`` and 30 mm; ``h`` is the height of the level where the distance is
    checked: here the lower building's height (33.2). From a property line a building keeps the larger of
    2/3 of its peak and half of its own ``s`` (33.3), which suffices if the neighbour keeps its part. The
    gap between two properties is the sum of both distances (33.4).
    """

    assumptions = f"{INELASTIC}; {BETWEEN}"
    multiplies = DEFLECTION
    called: ClassVar = {BEHAVIOUR: "reduction R", DEFLECTION: "0.75 R, or 0.85 R if irregular"}
    countries: ClassVar[tuple[str, ...]] = ("Peru",)
    family = SUM
    needs = OF_HEIGHT
    line = "a building keeps 2/3 of its own displacement and half of the joint for its own height"

    def of_site(self, site: Site) -> Any:
        if not site.neighbours.same_property:
            return self.from_both_lines(site)
        return np.maximum(self.least(site.lower_height), site.total * (2 / 3))

    def from_line(self, site: Site) -> Any:
        return np.maximum(self.least(site.height_1) / 2, site.peak_1 * (2 / 3))

    def least(self, height: Any) -> Any:
        """The least joint [m] at this height [m]."""
        return np.maximum(0.006 * height, 0.03)


@published(CODE_RULES, "peru_e030_2026", "Norma E.030 as of 2026, Peru", "M", 11)
@dataclass(frozen=True)
class Peru2026(Peru, Numbered):
    """E.030 as of 2026: that of 2018 with a least joint of ``0.02 Z S h`` in place of ``0.006 h``.

    The number is ``Z S``, zone factor times soil factor. The text was not compared; what it does not
    change is taken from the edition of 2018.
    """

    countries = ()

    zone_and_soil: float

    def least(self, height: Any) -> Any:
        return np.maximum(0.02 * self.zone_and_soil * height, 0.03)


@published(CODE_RULES, "asce_41", "ASCE 41-13, checklist, adjacent buildings; FEMA 310", "M high", 13)
@dataclass(frozen=True)
class Asce41(ShareOfHeight):
    """ASCE 41-13 and FEMA 310: 0.04 times the height of the lower building, as a first check.

    ASCE 41-17 has smaller factors for lower levels of seismicity.
    """

    assumptions = f"0.04 of the height is a first check of existing buildings; {NO_PEAKS}"
    line = ""

    factor: float = 0.04


BY_HEIGHT = {"I": 0.007, "II": 0.009, "III": 0.012}  # share of the height by zone, simplified method


@published(
    CODE_RULES, "mexico_city_simplified", "NTC-Sismo, Mexico City, 1.10, simplified method", "S", 14
)
class MexicoCitySimplified(OwnLot):
    """Mexico City, simplified method: the larger of ``c h`` and 50 mm from the boundary.

    ``h`` is the height of the building; ``c`` is 0.007, 0.009 and 0.012 in zones I, II and III. The gap
    between two buildings is the sum of both distances; half of it if their heights, their structural
    systems and the levels of their slabs are the same.
    """

    assumptions = f"{NO_PEAKS}: the simplified method has none; {ALIKE}"
    family = HEIGHT
    needs = (*OF_HEIGHT, "zone")
    line = f"a building keeps {OWN_LOT}"

    def from_line(self, site: Site) -> Any:
        return np.maximum(BY_HEIGHT[str(site.zone)] * site.height_1, 0.05) + 0 * site.peak_1


@published(CODE_RULES, "china_gb_50011", "GB 50011-2010, 6.1.4", "S", 15)
@dataclass(frozen=True)
class China(Numbered):
    """GB 50011, concrete frames: 100 mm, and 20 mm for every 3 m of the lower building above 15 m.

    ``step`` is 3 m for intensity 8, and 5, 4 and 2 m for intensities 6, 7 and 9. Heights between
    multiples of the step count in proportion. Without heights the lower building is taken to have at
    most 15 m.
    """

    assumptions = f"concrete frames, intensity 8, up to 15 m where no height is given; {NO_PEAKS}"
    countries = ("China",)
    family = FIXED
    units = "m"

    step: float = 3.0

    def of_site(self, site: Site) -> Any:
        known = site.height_1 is not None and site.height_2 is not None
        beyond = np.maximum(site.lower_height - 15.0, 0.0) if known else 0.0
        return 0.1 + 0.02 * beyond / self.step + 0 * site.total


@published(CODE_RULES, "nzs_1170_5", "NZS 1170.5:2004, New Zealand, 7.4.1", "M", 21, "NZS 1170.5")
class NewZealand(CodeRule):
    """NZS 1170.5: a building stays on its side of the boundary, and does not touch others of its site.

    At the ultimate limit state its displacement does not reach beyond the boundary, so that the gap
    between two properties is the sum of the peaks; it is also taken within one property.
    """

    assumptions = f"peaks are those of the ultimate limit state, mu times elastic; {BETWEEN}"
    multiplies = DEFLECTION
    called: ClassVar = {BEHAVIOUR: "reduction k_mu/Sp", DEFLECTION: "structural ductility factor mu"}
    countries = ("New Zealand",)
    family = SUM
    line = "from the boundary a building keeps its own displacement"

    def of_site(self, site: Site) -> Any:
        return site.total
