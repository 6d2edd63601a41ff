"""One curve of a hazard file, and what the reader of a format asks."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from stochlin.applications.sheets.columns import ColumnName
from stochlin.kernels.basics.arrays import Array

S0 = "m^2/s^3"
Site = int | Sequence[float]
"""Number of a site in its file, from 1, or its longitude and latitude [degrees]."""


class Ordinate(NamedTuple):
    """Hazard curve of one intensity measure, as a file states it."""

    period: float  # s; 0 for the peak ground acceleration
    intensities: Array
    frequencies: Array  # 1/yr
    places: Sequence[str]  # of each point, for messages
    units: str  # of the intensities; empty if the file does not state them
    columns: str = ""  # those that are asked for by number, or converted


class AskedHazard(NamedTuple):
    """What is asked for besides the path; a format refuses what does not apply to it."""

    site: Site | None
    years: float | None  # for which a file gives probabilities
    column: ColumnName | None = None  # of the intensities
    frequency_column: ColumnName | None = None


def annual_frequencies(probabilities: Array, years: float) -> Array:
    """Annual frequencies [1/yr] with these exceedance probabilities in some years, for rare events.

    They are those of a Poisson process, and infinite for a probability of 1.
    """
    with np.errstate(divide="ignore"):
        frequencies: Array = -np.log1p(-probabilities) / years
    return frequencies


def points_of(ordinate: Ordinate) -> Ordinate:
    """The points of a curve that state a frequency of their own.

    Left out are intensities at the end that are never exceeded, those that are always exceeded,
    whose frequency is infinite, and of intensities with the same frequency all but the largest.
    """
    frequencies = ordinate.frequencies
    informative = (np.cumsum(frequencies[::-1] != 0)[::-1] > 0) & (frequencies != np.inf)
    informative[:-1] &= frequencies[:-1] != frequencies[1:]
    return ordinate._replace(
        intensities=ordinate.intensities[informative],
        frequencies=frequencies[informative],
        places=[place for place, keep in zip(ordinate.places, informative, strict=True) if keep],
    )


_PERIOD = re.compile(r"SA\((\d+\.?\d*)(?:,[^)]*)?\)|SA(\d{1,3})P(\d{1,6})", re.IGNORECASE)


def period_of(measure: str) -> float | None:
    """Period [s] of ``SA(0.5)`` or ``SA0P5``, 0 of ``PGA``; None of another measure."""
    if measure.upper() == "PGA":
        return 0.0
    match = _PERIOD.fullmatch(measure)
    return (float(match[1] or f"{match[2]}.{match[3]}") or None) if match else None


def measure_in_words(period: float) -> str:
    """``PGA`` or ``SA(0.5)``."""
    return f"SA({period:g})" if period else "PGA"
