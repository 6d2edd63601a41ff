"""Hazard curves of the U.S. Geological Survey: the response of its hazard service, as JSON.

National Seismic Hazard Model, https://earthquake.usgs.gov/ws/nshmp: annual frequencies of exceedance of
several intensity measures at one site. The curves stand in ``response.hazardCurves``, each with ``imt``
and ``data`` with the ``component`` ``Total`` and its ``values``, ``xs`` and ``ys``. The label ``Ground
Motion (g)`` has the unit.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from stochlin.applications.sites.hazard_formats import (
    AskedHazard,
    Ordinate,
    measure_in_words,
    period_of,
)
from stochlin.messages import plain, refuse, sentence


def read(path: Path, text: str, choice: AskedHazard) -> list[Ordinate]:
    """The total curves of all measures that are accelerations."""
    name, ordinates = plain(path.name), []
    of_one = {"site": choice.site, "investigation_time": choice.years}
    refuse(name, "a response of the USGS, of annual frequencies at one site", of_one)
    try:
        response = json.loads(text)["response"]
        units = "g" if "(g)" in response["metadata"]["xlabel"] else ""
        for curve in response["hazardCurves"]:
            if (period := period_of(curve["imt"]["value"])) is None:
                continue
            values = {part["component"]: part["values"] for part in curve["data"]}["Total"]
            levels, frequencies = np.array([values["xs"], values["ys"]], float)
            where = f"{name}, {measure_in_words(period)}, number"
            places = [f"{where} {n}" for n in range(1, levels.size + 1)]
            ordinates.append(Ordinate(period, levels, frequencies, places, units))
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        what = f"{name} is no response of the hazard service of the USGS ({sentence(error)})"
        raise ValueError(f"{what}; allowed: the whole response, so fetch it again") from error
    return ordinates
