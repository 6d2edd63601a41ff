"""Hazard curves of the U.S. Geological Survey: the response of its hazard service, as JSON.

National Seismic Hazard Model, https://earthquake.usgs.gov/ws/nshmp: annual frequencies of exceedance of
several intensity measures at one site. The curves stand in ``response.hazardCurves``, each with ``imt``
and ``data`` with the ``component`` ``Total`` and its ``values``, ``xs`` and ``ys``. The label ``Ground
Motion (g)`` has the unit.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from stochlin.applications.sites.hazard_formats import (
    AskedHazard,
    Ordinate,
    measure_in_words,
    period_of,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import plain, refuse, sentence
from stochlin.models.arguments import is_number

TITLE = "a response of the USGS, of annual frequencies at one site"


def read(path: Path, text: str, choice: AskedHazard) -> list[Ordinate]:
    """The total curves of all measures that are accelerations."""
    name = plain(path.name)
    refuse(name, TITLE, {"site": choice.site, "investigation_time": choice.years})
    try:
        response = _at(json.loads(text), "response")
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{name} is no valid JSON: {sentence(error)}; fetch it again") from error
    curves = _at(response, "hazardCurves")
    if not isinstance(curves, list):
        raise _without(name, "response.hazardCurves")
    label = str(_at(response, "metadata", "xlabel"))
    ordinates = [_ordinate(name, curve, "g" if "(g)" in label else "") for curve in curves]
    return [ordinate for ordinate in ordinates if ordinate is not None]


def _ordinate(name: str, curve: Any, units: str) -> Ordinate | None:
    """The total of one curve; None for another measure than PGA and SA."""
    if not isinstance(imt := _at(curve, "imt", "value"), str):
        raise _without(name, "imt.value")
    if (period := period_of(imt)) is None:
        return None
    components = _at(curve, "data")
    components = components if isinstance(components, list) else []
    total = next((part for part in components if _at(part, "component") == "Total"), None)
    what = measure_in_words(period)
    intensities, frequencies = (_numbers(name, what, _at(total, "values", key)) for key in ("xs", "ys"))
    if intensities.size != frequencies.size:
        raise ValueError(f"{name}, {what}: {intensities.size} levels, {frequencies.size} frequencies")
    places = [f"{name}, {what}, number {n}" for n in range(1, intensities.size + 1)]
    return Ordinate(period, intensities, frequencies, places, units)


def _numbers(name: str, what: str, values: Any) -> Array:
    if not isinstance(values, list) or not all(is_number(value) for value in values):
        raise _without(name, f"numbers of {what}")
    return np.array(values, float)


def _at(value: Any, *keys: str) -> Any:
    """The value at the end of a path of keys; None if there is none."""
    for key in keys:
        value = value.get(key) if isinstance(value, dict) else None
    return value


def _without(name: str, what: str) -> ValueError:
    return ValueError(f"{name} has no {what}; allowed: the response of the hazard service of the USGS")
