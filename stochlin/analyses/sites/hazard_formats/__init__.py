"""Formats of hazard files, each recognized by its beginning: one file for each format."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, plain
from stochlin.registry import Registry

Site = int | Sequence[float]
"""Number of a site in its file, from 1, or its longitude and latitude [degrees]."""


class Ordinate(NamedTuple):
    """Hazard curve of one intensity measure, as a file states it."""

    period: float  # s; 0 for the peak ground acceleration
    intensities: Array
    frequencies: Array  # 1/yr
    places: Sequence[str]  # of each point, for messages
    units: str | None  # of the intensities


class AskedHazard(NamedTuple):
    """What is asked for besides the path; a format refuses what does not apply to it."""

    site: Site | None
    years: float | None  # for which a file gives probabilities


class HazardFormat(NamedTuple):
    """A format of hazard files, whose text begins with ``start``, and its reader of name and text."""

    title: str
    start: re.Pattern[str]
    read: Callable[[str, str, AskedHazard], list[Ordinate]]


HAZARD_FORMATS: Registry[HazardFormat] = Registry(
    "format of hazards", "stochlin.analyses.sites.hazard_formats"
)


def annual_frequencies(probabilities: Array, years: float, places: Sequence[str]) -> Array:
    """Annual frequencies [1/yr] with these probabilities of exceedance in some years, for rare events.

    They are those of a Poisson process, and infinite for a probability of 1.
    """
    for place, probability in zip(places, probabilities, strict=True):
        if not 0 <= probability <= 1:
            raise ValueError(
                f"{place}: the probability is {probability:g}; allowed: from 0 to 1; correct it"
            )
    with np.errstate(divide="ignore"):
        frequencies: Array = -np.log1p(-probabilities) / years
    return frequencies


def points_of(ordinate: Ordinate) -> Ordinate:
    """The points of a curve that state a frequency of their own.

    Left out are intensities that are never exceeded, those that are always exceeded, whose frequency is
    infinite, and of intensities with the same frequency all but the largest.
    """
    frequencies = ordinate.frequencies
    kept = (frequencies != 0) & (frequencies != np.inf)
    kept[:-1] &= frequencies[:-1] != frequencies[1:]
    return ordinate._replace(
        intensities=ordinate.intensities[kept],
        frequencies=frequencies[kept],
        places=[place for place, keep in zip(ordinate.places, kept, strict=True) if keep],
    )


def measure_in_words(period: float) -> str:
    """``PGA`` or ``SA(0.5)``."""
    return f"SA({period:g})" if period else "PGA"


def refuse(name: str, format_of: str, given: Mapping[str, object]) -> None:
    """Raise a ValueError for an argument that does not apply to a format."""
    for parameter, value in given.items():
        if value is not None:
            raise ValueError(
                f"{parameter} = {brief(value)} does not apply: {plain(name)} is {format_of}; leave it "
                "out"
            )
