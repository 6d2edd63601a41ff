"""Hazard curves of the U.S. Geological Survey: the response of its hazard service, as JSON.

National Seismic Hazard Model, https://earthquake.usgs.gov/ws/nshmp: annual frequencies of
exceedance of several intensity measures at one site. The curves stand in ``response.hazardCurves``,
each with ``imt`` and ``data`` with the ``component`` ``Total`` and its ``values``, ``xs`` and
``ys``. The label ``Ground Motion (g)`` has the unit. Before 2022 ``response`` was the list of the
curves: each has its ``imt``, its ``xvalues`` and the label in ``metadata``, and its ``yvalues`` in
``data``.
"""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
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
from stochlin.messages import brief, plain, refuse, sentence

TOTAL = "Total"


def read(path: Path, text: str, choice: AskedHazard) -> list[Ordinate]:
    """The total curves of all measures that are accelerations."""
    name = plain(path.name)
    of_one: dict[str, Any] = {"site": choice.site, "investigation_time": choice.years}
    of_one |= {"column": choice.column, "frequency_column": choice.frequency_column}
    refuse(name, "a response of the USGS, of annual frequencies at one site", of_one)
    curves: list[tuple[float, str, dict[str, Sequence[Any]]]] = []  # period, unit, xs and ys
    try:
        for measure, label, data, axis in _curves(content_of(text)["response"]):
            if (period := period_of(measure)) is not None:
                values = axis | _total(data, measure_in_words(period))
                units = "g" if "(g)" in label else ""
                curves.append((period, units, {key: [*values[key]] for key in ("xs", "ys")}))
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        what = f"{name} is no response of the hazard service of the USGS ({sentence(error)})"
        raise ValueError(f"{what}; allowed: the whole response, so fetch it again") from error
    ordinates = []
    for period, units, series in curves:
        where = f"{name}, {measure_in_words(period)}"
        levels, frequencies, places = paired(where, series, ("intensity", "annual frequency"))
        ordinates.append(Ordinate(period, levels, frequencies, places, units))
    return ordinates


def content_of(text: str) -> Any:
    """Content of a text in JSON; whole numbers are floats, so that those too large are infinite."""
    return json.loads(text, object_pairs_hook=_object, parse_int=float)


def _curves(response: Any) -> Iterator[tuple[str, str, Sequence[dict[str, Any]], dict[str, Any]]]:
    """Measure, label, data and, before 2022, the ``xs`` of each curve."""
    if isinstance(response, list):
        for curve in response:
            about = curve["metadata"]
            data = [{**part, "values": {"ys": part["yvalues"]}} for part in curve["data"]]
            yield about["imt"]["value"], about["xlabel"], data, {"xs": about["xvalues"]}
        return
    for curve in response["hazardCurves"]:
        yield curve["imt"]["value"], response["metadata"]["xlabel"], curve["data"], {}


def _object(pairs: Sequence[tuple[str, Any]]) -> dict[str, Any]:
    """An object of JSON; a ValueError if a key is there twice, of which Python keeps the last."""
    counts = Counter(key for key, _ in pairs)
    if twice := next((key for key, count in counts.items() if count > 1), None):
        raise ValueError(f"an object has the key {brief(twice)} twice")
    return dict(pairs)


def _total(parts: Sequence[dict[str, Any]], measure: str) -> dict[str, Any]:
    """The values of the total of all components."""
    totals = [part["values"] for part in parts if part["component"] == TOTAL]
    if len(totals) != 1:
        raise ValueError(f"{measure} has {len(totals)} components {TOTAL!r} in place of 1")
    values: dict[str, Any] = totals[0]
    return values


def paired(
    where: str, series: Mapping[str, Sequence[Any]], what: tuple[str, str]
) -> tuple[Array, Array, list[str]]:
    """Two series of finite numbers, as many of both, and their places; ``what`` names a number."""
    (name_1, first), (name_2, second) = series.items()
    if len(first) != len(second):
        counts = f"{len(first)} {name_1} beside {len(second)} {name_2}"
        raise ValueError(f"{where}: {counts}; allowed: as many of both")
    places = [f"{where}, number {n}" for n in range(1, len(first) + 1)]
    return _finite(first, places, what[0]), _finite(second, places, what[1]), places


def _finite(values: Sequence[Any], places: Sequence[str], what: str) -> Array:
    """The values as an array; a ValueError that names the place unless all are finite numbers."""
    for value, place in zip(values, places, strict=True):
        if not isinstance(value, float) or not math.isfinite(value):
            raise ValueError(f"{place}: the {what} is {brief(value)}; allowed: a finite number")
    return np.array(values, float)
