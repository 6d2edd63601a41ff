"""Formulas of the separation rules; `national.toml` has all else, and explains the clauses."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from functools import partial
from importlib.resources import files
from typing import Any

import numpy as np
from scipy.constants import g

from stochlin.models.rules.codes import CODE_RULES, ZONES, CodeRule, Number, Site
from stochlin.models.rules.published import publish

Formula = Callable[[Site], Any]
BY_HEIGHT = {"I": 0.007, "II": 0.009, "III": 0.012}  # share of the height by zone, simplified method


def root_of_squares(site: Site, factor: float = 1.0) -> Any:
    """A factor times the square root of the sum of the squared peaks [m]."""
    return factor * np.hypot(site.peak_1, site.peak_2)


def total(site: Site, factor: float = 1.0) -> Any:
    """A factor times the sum of the peaks [m]."""
    return factor * (site.peak_1 + site.peak_2)


def by_property(site: Site, aligned: float = 1.0) -> Any:
    """Root of squares within one property, times a factor if floors align; between two the sum [m]."""
    if not site.neighbours.same_property:
        return total(site)
    return root_of_squares(site, site.if_aligned(aligned))


def both_lines(site: Site, of_one: Formula) -> Any:
    """Sum of the distances of both buildings from the line between them [m]."""
    return of_one(site) + of_one(site.mirrored())


def by_lots(site: Site, of_one: Formula) -> Any:
    """Both distances from the boundary, half of the sum for buildings that are alike [m]."""
    alike = site.neighbours.floors_align and site.neighbours.same_system
    return (1 - 0.5 * alike * (site.height_1 == site.height_2)) * both_lines(site, of_one)


def share_of_sum(site: Site) -> Any:
    """The number times the sum of the peaks [m]."""
    return total(site, site.number)


def share_of_height(site: Site) -> Any:
    """The number times the height of the lower building [m]."""
    return site.number * site.lower_height + 0 * total(site)


def fixed_distance(site: Site) -> Any:
    """The number itself [m]."""
    return site.number + 0 * total(site)


def mexico(site: Site) -> Any:
    """Of one building its peak and a share of its height by zone, 50 mm at least [m]."""
    return np.maximum(site.peak_1 + ZONES[str(site.zone)] * site.height_1, 0.05)


def mexico_simplified(site: Site) -> Any:
    """Of one building a share of its height by zone, 50 mm at least [m]."""
    return np.maximum(BY_HEIGHT[str(site.zone)] * site.height_1, 0.05) + 0 * site.peak_1


def peru(site: Site, alone: bool) -> Any:
    """Of one building or two the larger of 2/3 of the peaks and the joint by height [m]."""
    share = 0.006 if site.number is None else 0.02 * site.number  # of the height, in the least joint
    if alone:
        return np.maximum(np.maximum(share * site.height_1, 0.03) / 2, site.peak_1 * (2 / 3))
    if not site.neighbours.same_property:
        return both_lines(site, partial(peru, alone=True))
    return np.maximum(np.maximum(share * site.lower_height, 0.03), total(site) * (2 / 3))


def china(site: Site) -> Any:
    """100 mm, and 20 mm for each step of the lower building above 15 m [m]."""
    known = site.height_1 is not None and site.height_2 is not None
    beyond = np.maximum(site.lower_height - 15.0, 0.0) if known else 0.0
    return 0.1 + 0.02 * beyond / site.number + 0 * total(site)


def turkey(site: Site) -> Any:
    """The larger of the reduced root of squares and the joint by height [m]."""
    least = 0.03 + 0.01 * np.maximum(site.lower_height - 6.0, 0.0) / 3.0
    return np.maximum(root_of_squares(site, 0.5 * site.if_aligned(0.5)), least)


def italy(site: Site) -> Any:
    """The larger of the sum of the peaks and the share of the height by acceleration [m]."""
    least = site.lower_height / 100 * np.minimum(site.design_pga / (0.5 * g), 1.0)
    return np.maximum(total(site), least)


def iran(site: Site) -> Any:
    """Of one building 0.005 of its height, or its peak if it is tall or important [m]."""
    displaced = (site.storeys_1 > 8) | (site.importance_1 > 1)
    return np.maximum(0.005 * site.height_1, displaced * site.peak_1)


def colombia(site: Site) -> Any:
    """What the building keeps that keeps more, by height and storeys [m]."""
    return np.maximum(_beside(site), _beside(site.mirrored())) + 0 * total(site)


def _beside(site: Site) -> Any:
    """What building 1 keeps in Colombia beside a neighbour that stands on the boundary [m]."""
    three, more = (0.0, 0.02) if site.neighbours.floors_align else (0.01, 0.03)
    share = three * (site.storeys_1 == 3) + more * (site.storeys_1 > 3)
    return share * site.height_1


def beside_a_plot(site: Site) -> Any:
    """What one building keeps in Colombia beside an empty plot [m]."""
    return 0.01 * (site.storeys_1 > 3) * site.height_1 + 0 * site.peak_1


GAPS: Mapping[str, Formula] = {
    "srss": root_of_squares,
    "share_of_sum": share_of_sum,
    "asce_7": by_property,
    "canada": root_of_squares,
    "eurocode_8": partial(by_property, aligned=0.7),
    "ubc_97": by_property,
    "mexico_city": partial(by_lots, of_one=mexico),
    "is_1893": total,
    "taiwan": partial(total, factor=0.6),
    "peru_e030": partial(peru, alone=False),
    "peru_e030_2026": partial(peru, alone=False),
    "share_of_height": share_of_height,
    "fixed_distance": fixed_distance,
    "asce_41": share_of_height,
    "mexico_city_simplified": partial(by_lots, of_one=mexico_simplified),
    "china_gb_50011": china,
    "tbdy_2018": turkey,
    "ntc_2008": italy,
    "ntc_2018": italy,
    "iran_2800": partial(both_lines, of_one=iran),
    "nsr_10": colombia,
    "nzs_1170_5": total,
}
# Of one building from its property line, if not the gap to one of its height that does not move.
FROM_LINE: Mapping[str, Formula] = {
    "mexico_city": mexico,
    "mexico_city_simplified": mexico_simplified,
    "peru_e030": partial(peru, alone=True),
    "peru_e030_2026": partial(peru, alone=True),
    "iran_2800": iran,
    "nsr_10": beside_a_plot,
}


def _read(name: str, row: dict[str, Any]) -> CodeRule:
    """A rule from its row of the table."""
    row = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
    row["of_pairs"] = tuple(PAIRS[pair] for pair in row.pop("pairs", ()))
    if "number" in row:
        row["number"] = Number(**row["number"])
    return CodeRule(name=name, gap_of=GAPS[name], line_of=FROM_LINE.get(name), **row)


TABLE = tomllib.loads(files(__package__).joinpath("national.toml").read_text(encoding="utf-8"))
PAIRS: Mapping[str, str] = TABLE.pop("pairs")
for place, (name, row) in enumerate(TABLE.items()):
    publish(CODE_RULES, _read(name, row), place)
