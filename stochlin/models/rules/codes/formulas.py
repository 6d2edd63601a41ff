"""Formulas of the separation rules [m], which the rows of `national.toml` name and explain."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Any

import numpy as np
from scipy.constants import g

from stochlin.models.rules import publish
from stochlin.models.rules.codes import CODE_RULES, ZONES, CodeRule, Number, Site

SIMPLIFIED = {"I": 0.007, "II": 0.009, "III": 0.012}  # share of the height by zone, Mexico City


def root_of_squares(site: Site) -> Any:
    """Square root of the sum of the squared peaks."""
    return np.hypot(site.peak_1, site.peak_2)


def total(site: Site) -> Any:
    """Sum of the peaks."""
    return site.peak_1 + site.peak_2


def eurocode_8(site: Site) -> Any:
    """Root of squares, reduced for floors that align."""
    return site.if_aligned(0.7) * root_of_squares(site)


def taiwan(site: Site) -> Any:
    """0.6 times the sum of the peaks."""
    return 0.6 * total(site)


def share_of_sum(site: Site) -> Any:
    """The number times the sum of the peaks."""
    return site.number * total(site)


def share_of_height(site: Site) -> Any:
    """The number times the height of the lower building."""
    return site.number * site.lower_height + 0 * total(site)


def fixed_distance(site: Site) -> Any:
    """The number itself."""
    return site.number + 0 * total(site)


def mexico_city_line(site: Site) -> Any:
    """Of one building its peak and a share of its height by zone, 50 mm at least."""
    assert site.zone is not None  # which the rule needs
    return np.maximum(site.peak_1 + ZONES[site.zone] * site.height_1, 0.05)


def mexico_city_simplified_line(site: Site) -> Any:
    """Of one building a share of its height by zone, 50 mm at least."""
    return np.maximum(SIMPLIFIED[str(site.zone)] * site.height_1, 0.05) + 0 * site.peak_1


def peru_line(site: Site) -> Any:
    """Of one building the larger of 2/3 of its peak and half of the joint by its height."""
    return np.maximum(_joint(site, site.height_1) / 2, site.peak_1 * (2 / 3))


def peru(site: Site) -> Any:
    """Within one property the larger of 2/3 of the peaks and the joint by the lower height."""
    return np.maximum(_joint(site, site.lower_height), total(site) * (2 / 3))


def _joint(site: Site, height: Any) -> Any:
    """The least joint of Peru for a height: 0.006 of it, or as of 2026 0.02 Z S, and 30 mm."""
    return np.maximum((0.006 if site.number is None else 0.02 * site.number) * height, 0.03)


def china(site: Site) -> Any:
    """100 mm, and 20 mm for each step of the lower building above 15 m."""
    known = site.height_1 is not None and site.height_2 is not None
    beyond = np.maximum(site.lower_height - 15.0, 0.0) if known else 0.0
    return 0.1 + 0.02 * beyond / site.number + 0 * total(site)


def turkey(site: Site) -> Any:
    """The larger of the reduced root of squares and the joint by height."""
    least = 0.03 + 0.01 * np.maximum(site.lower_height - 6.0, 0.0) / 3.0
    return np.maximum(0.5 * site.if_aligned(0.5) * root_of_squares(site), least)


def italy(site: Site) -> Any:
    """The larger of the sum of the peaks and the share of the height by acceleration."""
    least = site.lower_height / 100 * np.minimum(site.design_pga / (0.5 * g), 1.0)
    return np.maximum(total(site), least)


def iran_line(site: Site) -> Any:
    """Of one building 0.005 of its height, or its peak if it is tall or important."""
    displaced = (site.storeys_1 > 8) | (site.importance > 1)
    return np.maximum(0.005 * site.height_1, displaced * site.peak_1)


def colombia(site: Site) -> Any:
    """What the building keeps that keeps more, by height and storeys."""
    return np.maximum(_beside(site), _beside(site.mirrored())) + 0 * total(site)


def _beside(site: Site) -> Any:
    """What building 1 keeps in Colombia beside a neighbour that stands on the boundary."""
    three, more = (0.0, 0.02) if site.floors_align else (0.01, 0.03)
    share = three * (site.storeys_1 == 3) + more * (site.storeys_1 > 3)
    return share * site.height_1


def colombia_line(site: Site) -> Any:
    """What one building keeps in Colombia beside an empty plot."""
    return 0.01 * (site.storeys_1 > 3) * site.height_1 + 0 * site.peak_1


# By the names that the rows of the table have for them.
FORMULAS: Mapping[str, Callable[[Site], Any]] = {
    "root_of_squares": root_of_squares,
    "total": total,
    "eurocode_8": eurocode_8,
    "taiwan": taiwan,
    "share_of_sum": share_of_sum,
    "share_of_height": share_of_height,
    "fixed_distance": fixed_distance,
    "mexico_city_line": mexico_city_line,
    "mexico_city_simplified_line": mexico_city_simplified_line,
    "peru_line": peru_line,
    "peru": peru,
    "china": china,
    "turkey": turkey,
    "italy": italy,
    "iran_line": iran_line,
    "colombia": colombia,
    "colombia_line": colombia_line,
}


def _read(name: str, row: dict[str, Any]) -> CodeRule:
    """A rule from its row of the table."""
    row = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
    row["of_pairs"] = tuple(PAIRS[pair] for pair in row.pop("pairs", ()))
    if "number" in row:
        row["number"] = Number(**row["number"])
    for key in {"gap_of", "line_of"} & row.keys():
        row[key] = FORMULAS[row[key]]
    return CodeRule(name=name, **row)


TABLE = tomllib.loads(files(__package__).joinpath("national.toml").read_text(encoding="utf-8"))
PAIRS: Mapping[str, str] = TABLE.pop("pairs")
for place, (name, row) in enumerate(TABLE.items()):
    publish(CODE_RULES, _read(name, row), place)
