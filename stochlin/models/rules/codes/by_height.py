"""Separation rules of building codes with a least gap, or a whole one, by heights and storeys alone."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from scipy.constants import g

from stochlin.models.rules.codes import (
    ALIGNED,
    BEHAVIOUR,
    BESIDE,
    BETWEEN,
    CODE_RULES,
    DEFLECTION,
    HEIGHT,
    IMPORTANCE,
    SUM,
    CodeRule,
    Site,
)
from stochlin.models.rules.codes.families import NO_PEAKS, OF_HEIGHT, SquareRoot
from stochlin.models.rules.published import published

OF_STOREYS = (*OF_HEIGHT, "storeys_1", "storeys_2")


@published(CODE_RULES, "tbdy_2018", "TBDY 2018, Turkey, 4.9.3", "S", 16)
class Turkey(SquareRoot):
    """TBDY 2018: the larger of ``alpha`` times the root of squares and a least joint by height.

    By 4.9.3.1 ``alpha`` is ``0.25 R/I`` if the floors of all storeys are level and ``0.5 R/I`` if not,
    and the displacements are reduced ones; here each is multiplied by ``R/I`` of its own building. By
    4.9.3.2 the joint is at least 30 mm up to a height of 6 m, and 10 mm more for every 3 m above;
    heights between count in proportion.
    """

    assumptions = f"peaks are reduced displacements times R/I; {ALIGNED}"
    multiplies = BEHAVIOUR
    over_importance = True
    called: ClassVar = {BEHAVIOUR: "behaviour factor R", IMPORTANCE: "importance factor I"}
    countries = ("Turkey", "Türkiye")
    needs = OF_HEIGHT

    def of_site(self, site: Site) -> Any:
        least = 0.03 + 0.01 * np.maximum(site.lower_height - 6.0, 0.0) / 3.0
        return np.maximum(0.5 * site.if_aligned(0.5) * site.root_of_squares, least)


@published(CODE_RULES, "ntc_2008", "NTC 2008, Italy, 7.2.2", "S", 17)
class Italy(CodeRule):
    """NTC 2008: the larger of the sum of the peaks and ``h/100 ag S/(0.5 g)``.

    ``h`` is the height of the points that face each other, here that of the lower building, and the
    factor ``ag S/(0.5 g)`` is 1 at most. The peaks are those of the life-safety limit state (SLV). The
    estimate of a displacement without calculation is not included.
    """

    assumptions = "peaks are displacements of the limit state SLV, mu_d times elastic (7.3.3.3)"
    multiplies = DEFLECTION
    called: ClassVar = {
        BEHAVIOUR: "behaviour factor q",
        DEFLECTION: "mu_d: q, or 1 + (q - 1) TC/T1 for T1 < TC",
    }
    family = SUM
    needs = (*OF_HEIGHT, "design_pga")

    def of_site(self, site: Site) -> Any:
        least = site.lower_height / 100 * np.minimum(site.design_pga / (0.5 * g), 1.0)
        return np.maximum(site.total, least)


@published(CODE_RULES, "ntc_2018", "NTC 2018, Italy, 7.2.1", "S", 18)
class Italy2018(Italy):
    """NTC 2018: the larger of the sum of the peaks and ``h/100 (2 ag S/g)``, as in 2008."""

    countries = ("Italy",)


@published(
    CODE_RULES, "iran_2800", "Standard 2800, Iran, fourth edition", "M high", 19, "Standard 2800 of Iran"
)
class Iran(CodeRule):
    """Standard 2800: from the boundary 0.005 of the height, or the displacement if that is larger.

    0.005 of the height suffices up to 8 storeys of normal importance. Above, and for an importance
    factor above 1, a building keeps its nonlinear displacement of the design, with P-delta; 0.005 of the
    height is taken as the least distance here, too. A page on the standard was seen, which does not say
    how the displacements of two buildings are combined: they are added.
    """

    assumptions = f"peaks are nonlinear displacements with P-delta, Cd times elastic; {BETWEEN}"
    multiplies = DEFLECTION
    called: ClassVar = {
        BEHAVIOUR: "behaviour factor Ru",
        DEFLECTION: "displacement factor Cd",
        IMPORTANCE: "importance factor I",
    }
    countries = ("Iran",)
    family = SUM
    needs = OF_STOREYS
    line = "0.005 of the height; above 8 storeys, or if important, its displacement if that is larger"

    def of_site(self, site: Site) -> Any:
        return self.from_both_lines(site)

    def from_line(self, site: Site) -> Any:
        displaced = (site.storeys_1 > 8) | (site.importance_1 > 1)
        return np.maximum(0.005 * site.height_1, displaced * site.peak_1)


@published(CODE_RULES, "nsr_10", "NSR-10, Colombia, A.6.5.2", "S", 20, "NSR-10")
class Colombia(CodeRule):
    """NSR-10: a new building keeps a share of its height from its boundary, by table A.6.5-1.

    Beside a neighbour that has left no joint it is 0.02 above three storeys if the floors are level; if
    not, 0.01 for three storeys and 0.03 above. Beside an empty plot, or a neighbour with its joint, it
    is 0.01 above three storeys. Of two buildings the one that keeps more is taken as the new one. Zones
    of low hazard need no joint, and parts of one building keep the sum of their displacements (A.6.5.1).
    """

    assumptions = f"{NO_PEAKS}; {BESIDE}"
    countries = ("Colombia",)
    family = HEIGHT
    needs = OF_STOREYS
    line = "beside an empty plot a building of more than three storeys keeps 0.01 of its height"

    def of_site(self, site: Site) -> Any:
        return np.maximum(self._beside(site), self._beside(site.mirrored())) + 0 * site.total

    def _beside(self, site: Site) -> Any:
        """What building 1 keeps beside a neighbour that stands on the boundary [m]."""
        three, more = (0.0, 0.02) if site.neighbours.floors_align else (0.01, 0.03)
        share = three * (site.storeys_1 == 3) + more * (site.storeys_1 > 3)
        return share * site.height_1

    def from_line(self, site: Site) -> Any:
        return 0.01 * (site.storeys_1 > 3) * site.height_1 + 0 * site.peak_1
