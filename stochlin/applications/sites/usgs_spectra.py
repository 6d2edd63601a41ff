"""Design spectra of the U.S. Geological Survey: the response of its design web services, as JSON.

Seismic Design Web Services, https://earthquake.usgs.gov/ws/designmaps: ``response.data`` has the
elastic spectra of ASCE 7-22 for the damping ratio 0.05, each with its ``periods`` [s] and
``ordinates`` [g].
"""

from __future__ import annotations

from typing import NamedTuple

from stochlin.applications.sites.hazard_formats.usgs import content_of, paired
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, sentence

ASCE_DAMPING = 0.05
# the first that is there is taken
DESIGN_SPECTRA = "multiPeriodDesignSpectrum", "twoPeriodDesignSpectrum"
# Those 1.5 times as strong, which are asked for by name.
MAXIMUM_SPECTRA = "multiPeriodMCErSpectrum", "twoPeriodMCErSpectrum"


class UsgsSpectrum(NamedTuple):
    """A spectrum of a response: name, periods [s], ordinates [g], and the place of each point."""

    name: str
    periods: Array
    ordinates: Array
    places: list[str]


def read(name: str, text: str, column: int | str | None) -> UsgsSpectrum:
    """The spectrum of this name, or that for design; a ValueError lists those that are there."""
    try:
        data = content_of(text)["response"]["data"]
        there = [title for title in (*DESIGN_SPECTRA, *MAXIMUM_SPECTRA) if title in data]
    except (ValueError, LookupError, TypeError, RecursionError) as error:
        what = (
            f"{name} is JSON and no response of the design services of the USGS ({sentence(error)})"
        )
        raise ValueError(f"{what}; allowed: the whole response, or columns of text") from error
    chosen = (
        next((title for title in there if title in DESIGN_SPECTRA), None)
        if column is None
        else column
    )
    if chosen not in there:
        what = (
            f"column = {brief(column)} is not in {name}"
            if column
            else f"{name} has no design spectrum"
        )
        allowed = (
            f"allowed as column: {listed(there)}"
            if there
            else "allowed: the response for ASCE 7-22"
        )
        raise ValueError(f"{what}; {allowed}")
    where = f"{name}, {chosen}"
    values = data[chosen]
    try:
        series = {key: [*values[key]] for key in ("periods", "ordinates")}
    except (LookupError, TypeError) as error:
        raise ValueError(f"{where}: {sentence(error)}; allowed: periods and ordinates") from error
    return UsgsSpectrum(str(chosen), *paired(where, series, ("period", "acceleration")))
