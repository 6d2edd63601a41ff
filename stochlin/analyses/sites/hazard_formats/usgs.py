"""Hazard curves of the U.S. Geological Survey: the response of its hazard service, as JSON.

National Seismic Hazard Model, https://earthquake.usgs.gov/ws/nshmp: annual frequencies of exceedance of
several intensity measures at one site. The curves stand in ``response.hazardCurves``, each with ``imt``
and ``data`` with the ``component`` ``Total`` and its ``values``, ``xs`` and ``ys``; in responses before
2020, of nshmp-haz-ws, in ``response``, each with ``metadata.xvalues`` and ``data`` with ``yvalues``. The
label ``Ground Motion (g)`` has the unit.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from typing import Any

import numpy as np

from stochlin.analyses.sites.hazard_formats import (
    HAZARD_FORMATS,
    AskedHazard,
    HazardFormat,
    Ordinate,
    measure_in_words,
    refuse,
)
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, sentence
from stochlin.models.arguments import is_number

TITLE = "a response of the USGS, of annual frequencies at one site"
_START = re.compile(r"\s*\{")
_PERIOD = re.compile(r"SA(\d{1,3})P(\d{1,6})")  # SA0P2 at 0.2 s


def _read(name: str, text: str, asked: AskedHazard) -> list[Ordinate]:
    refuse(name, TITLE, {"site": asked.site, "investigation_time": asked.years})
    try:
        hooks: dict[str, Any] = {"parse_constant": _finite, "parse_float": _finite}
        response = _at(json.loads(text, object_pairs_hook=_each_once, **hooks), "response")
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{name} is no valid JSON: {sentence(error)}; fetch it again") from error
    curves = _at(response, "hazardCurves") or _at(response, "hazards") or response
    label = _at(response, "metadata", "xlabel")
    if not isinstance(curves, list):
        raise _without(name, "response.hazardCurves")
    read = [_ordinate(name, curve, label) for curve in curves]
    return [ordinate for ordinate in read if ordinate is not None]


def _finite(number: str) -> float:
    """The number of a text, which JSON has only for finite ones."""
    if not np.isfinite(value := float(number)):
        raise ValueError(f"{number} is no finite number")
    return value


def _each_once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON, of which a name that stands twice would silently be the last."""
    names = Counter(name for name, _ in pairs)
    if len(names) < len(pairs):
        raise ValueError(f"{brief(names.most_common(1)[0][0])} stands twice in one object")
    return dict(pairs)


def _ordinate(name: str, curve: Any, label: Any) -> Ordinate | None:
    """The total of one curve; None for another measure than PGA and SA."""
    imt = _at(curve, "imt", "value") or _at(curve, "metadata", "imt", "value")
    if not isinstance(imt, str):
        raise _without(name, "imt.value")
    of_sa = _PERIOD.fullmatch(imt)
    if imt != "PGA" and of_sa is None:
        return None
    period = float(f"{of_sa[1]}.{of_sa[2]}") if of_sa else 0.0
    components = _at(curve, "data")
    components = components if isinstance(components, list) else []
    total = next((part for part in components if _at(part, "component") == "Total"), None)
    pair = (_at(total, "values", "xs"), _at(total, "values", "ys"))
    if pair[0] is None:
        pair = (_at(curve, "metadata", "xvalues"), _at(total, "yvalues"))
    what = measure_in_words(period)
    intensities, frequencies = (_numbers(name, what, values) for values in pair)
    if intensities.size != frequencies.size:
        raise ValueError(
            f"{name}, {what}: {intensities.size} accelerations and {frequencies.size} frequencies; "
            "allowed: as many of one as of the other"
        )
    places = [f"{name}, {what}, number {n}" for n in range(1, intensities.size + 1)]
    label = label or _at(curve, "metadata", "xlabel")
    units = "g" if isinstance(label, str) and "(g)" in label else None
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


HAZARD_FORMATS.register("usgs")(HazardFormat(TITLE, _START, _read))
