"""Results as dictionaries of numbers and texts, for programs that do not know xarray."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from stochlin.messages import brief
from stochlin.models.arguments import checked


@checked
def as_dictionary(dataset: xr.Dataset) -> dict[str, Any]:
    """A result as a dictionary that is strict JSON once ``json.dumps`` has written it.

    Parameters
    ----------
    dataset : xarray.Dataset
        A result of any function, of any shape. Lazy arrays are computed.

    Returns
    -------
    dict
        ``attributes``, those of the dataset, and ``variables``, with the coordinates among them, by
        name. Each variable has ``dims``, the names of its dimensions; ``units``, ``"1"`` of ratios
        and of texts; ``long_name``; and ``values``, lists in lists in the order of the dimensions,
        or a single value without them. Values of flags, such as ``verdict`` and ``status``, are
        their words. A value that is not there is None, and one without limit ``"Infinity"`` or
        ``"-Infinity"``.

    Raises
    ------
    TypeError
        If the argument is no dataset.

    Examples
    --------
    >>> import json
    >>> import stochlin as sl
    >>> pair = [sl.Bilinear(T, damping=0.05) for T in (0.7, 1.0)]
    >>> result = sl.as_dictionary(sl.correlate(*pair, sl.WhiteNoise()))
    >>> result["variables"]["status"]["values"]
    'elastic_limit'
    >>> text = json.dumps(result, allow_nan=False)
    """
    if not isinstance(dataset, xr.Dataset):
        raise TypeError(
            f"dataset = {brief(dataset)} is of the wrong kind; allowed: an xarray.Dataset"
        )
    names = {str(name): variable for name, variable in dataset.variables.items()}
    return {
        "attributes": {str(name): _plain(value) for name, value in dataset.attrs.items()},
        "variables": {name: _described(variable) for name, variable in names.items()},
    }


def _described(variable: xr.Variable) -> dict[str, Any]:
    """A variable with its dimensions, unit and meaning."""
    values = _plain(variable.values)
    if meanings := variable.attrs.get("flag_meanings"):
        flags = np.asarray(variable.attrs["flag_values"]).tolist()
        values = _named(values, dict(zip(flags, meanings.split(), strict=True)))
    return {
        "dims": [str(name) for name in variable.dims],
        "units": str(variable.attrs.get("units", "1")),
        "long_name": str(variable.attrs.get("long_name", "")),
        "values": values,
    }


def _plain(value: Any) -> Any:
    """A value or an array in what JSON knows."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [_plain(part) for part in value]
    if isinstance(value, float) and not math.isfinite(value):
        infinite = "Infinity" if value > 0 else "-Infinity"
        return None if math.isnan(value) else infinite
    return value


def _named(values: Any, words: dict[Any, str]) -> Any:
    """The words of flags."""
    if isinstance(values, list):
        return [_named(part, words) for part in values]
    return words[values]
