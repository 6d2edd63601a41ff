"""Response spectra from files: columns of periods and accelerations."""

from __future__ import annotations

import os
import warnings

import numpy as np
import xarray as xr

from stochlin.analyses.records.files import (
    METRES,
    Column,
    acceleration_units,
    read_series,
    rows_in_words,
    stated_units,
)
from stochlin.analyses.sites.spectra import USUAL_DAMPING, check_ordinates, labelled
from stochlin.analyses.tables.inputs import input_path
from stochlin.messages import DoubtfulInput, plain
from stochlin.models.arguments import DampingRatio, checked

LEAST, MOST = 0.0025, 7.5  # plausible ordinates [g], 2.5 times ground accelerations of 0.001 and 3 g


@checked
def read_spectrum(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    damping: DampingRatio = USUAL_DAMPING,
    column: Column | None = None,
    period_column: Column = 0,
) -> xr.DataArray:
    r"""Read an elastic response spectrum from a file with columns of text.

    Parameters
    ----------
    path : str or path
        Path of the file, text in UTF-8, with or without a row of names. Text after ``#`` or ``%`` is a
        comment. Columns are separated as in `read_record`.
    units : {"g", "m/s^2", "cm/s^2", "gal", "mm/s^2"}, optional
        Units of the accelerations. Not needed if the row of names has them, as in ``Sa [g]``.
    damping : float
        Damping ratio [-] of the spectrum, between 0 and 1.
    column, period_column : int or str
        Columns of the acceleration and of the period [s], each by its index from 0 or by its name.
        ``column`` is not needed if only one column remains.

    Returns
    -------
    xarray.DataArray
        Pseudo-acceleration [m/s^2] over ``period`` [s], with the attributes ``damping`` and ``source``.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If units are missing or contradict the file; if the periods do not increase or have a gap, an
        ordinate is not positive, or there are fewer than 4 points; or if the spectrum seems to be
        divided by a behaviour factor, since it hardly rises above its value at a period of zero, or is
        constant at long periods.

    Warns
    -----
    UserWarning
        If the largest ordinate is below 0.0025 g or above 7.5 g, so that the units are probably wrong.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "site.csv"
    >>> rows = ["period,Sa [g]", "0,0.2", "0.1,0.4", "0.2,0.5", "0.4,0.5", "0.8,0.25", "1.6,0.12"]
    >>> _ = path.write_text("\n".join(rows), encoding="utf-8")
    >>> spectrum = sl.read_spectrum(path)
    >>> round(float(spectrum.sel(period=0.4)), 4), spectrum.attrs["damping"]
    (4.9033, 0.05)
    """
    path = input_path("path", path)
    units = None if units is None else acceleration_units(units, "units")
    name = plain(path.name)
    series = read_series(path, column, period_column)
    stated = stated_units(series, name, units)
    assert series.time is not None  # period_column is always given
    period, values = np.asarray(series.time), series.values * METRES[stated]
    check_ordinates(period, values, damping, rows_in_words(path))
    largest = values.max() / METRES["g"]
    if not LEAST < largest < MOST:
        warnings.warn(
            f"{name}: its largest ordinate is {largest:.3g} g; is it in {stated}?",
            DoubtfulInput,
            stacklevel=3,
        )
    return labelled(period, values, damping, name)
