"""Hazard curves as files state them, and what the formats share."""

from stochlin.applications.sites.hazard_formats.ordinate import (
    S0,
    AskedHazard,
    Ordinate,
    Site,
    annual_frequencies,
    measure_in_words,
    period_of,
    points_of,
)

__all__ = [
    "S0",
    "AskedHazard",
    "Ordinate",
    "Site",
    "annual_frequencies",
    "measure_in_words",
    "period_of",
    "points_of",
]
