"""Hazard curves from files: columns, and results of OpenQuake and of the U.S. Geological Survey."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stochlin.applications.sheets.columns import ColumnName
from stochlin.applications.sites.hazard_formats import (
    S0,
    AskedHazard,
    Ordinate,
    Site,
    measure_in_words,
    points_of,
    tables,
    usgs,
)
from stochlin.files.file_kinds import JSON
from stochlin.files.inputs import input_path, read_input, read_text
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed
from stochlin.models.arguments import Years, checked
from stochlin.models.hazards import Exceeded, Hazard, HazardCurve, check_curve
from stochlin.models.units import stated_size

FilePath = str | os.PathLike[str]


@checked
def read_hazard(
    path: FilePath | Sequence[FilePath],
    measure: Exceeded = "pga",
    *,
    units: str | None = None,
    period: float | None = None,
    site: Site | None = None,
    investigation_time: Years | None = None,
    column: ColumnName | None = None,
    frequency_column: ColumnName | None = None,
) -> HazardCurve:
    r"""Read a hazard curve from a file.

    These are read: columns of text; tables of sites of OpenQuake, one for each intensity measure
    (``hazard_curve-mean-SA(0.5)_17.csv``), and of nshmp-haz (``SA0P5/total.csv``); and responses of
    the hazard service of the U.S. Geological Survey in JSON, with several intensity measures of one
    site.

    Parameters
    ----------
    path : str, path, or list of them
        Path of the file. Columns of intensities and annual frequencies of exceedance [1/yr], or
        return periods [yr], are known by their names, as ``iml`` and ``annual rate``. Several files
        may be given, for several periods.
    measure : {"pga", "sa", "intensity"}
        As in `HazardCurve`.
    units : str, optional
        Units of the accelerations, as in `read_record`. Not needed if the row of names has them, as
        in ``pga [g]``, or for the other formats, which are in g. Not allowed for ``"intensity"``,
        which is in m^2/s^3.
    period : float, optional
        Period [s] of ``"sa"``. Between two periods of the files, the logarithm of the spectral
        acceleration that is exceeded with the same frequency is interpolated linearly in the
        logarithm of the period.
    site : int or tuple of two floats, optional
        Site in a table of sites: its number, from 1, or its longitude and latitude [degrees],
        within 0.01 degrees. Not needed if there is only one.
    investigation_time : float, optional
        Time [yr] in which the probabilities of exceedance of a file hold, if it has these. The
        annual frequencies are those of a Poisson process. OpenQuake states it.
    column, frequency_column : int or str, optional
        Columns of the intensities, and of the frequencies or probabilities, each by its number from
        1 or by its name, where the names of a file of columns do not say it.

    Returns
    -------
    HazardCurve
        The hazard curve in SI units, whose ``source`` is the file, with the columns that were asked
        for by number or converted; without zeros at its end, without probabilities of 1, and of
        equal frequencies with the largest intensity only.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError, TypeError
        If units or a column are missing or contradict the file; if there are fewer than two points,
        a number is not positive, the intensities do not increase or the frequencies do not decrease
        (the message names the row); if the measure is unknown, or not in the file; if a period is
        missing, not allowed, or beyond those of the file; or if a site is missing or not in the
        file.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "hazard.csv"
    >>> _ = path.write_text("pga [g],per year\n0.1,1e-2\n0.2,2e-3\n0.4,2e-4\n", encoding="utf-8")
    >>> hazard = sl.read_hazard(path)
    >>> round(hazard.intensity(return_period=475) / 9.80665, 3)
    0.196
    """
    of = Hazard(measure=measure, period=period)  # checks measure and period
    paths = [
        input_path("path", file) for file in (path if isinstance(path, (list, tuple)) else [path])
    ]
    if not paths:
        raise ValueError(f"path = {brief(path)}; allowed: one file, or several")
    if of.measure == "intensity" and units is not None:
        raise ValueError(f"units = {units!r}; allowed with intensity: none, it is in m^2/s^3")
    choice = AskedHazard(site, investigation_time, column, frequency_column)
    ordinates = [ordinate for file in paths for ordinate in _ordinates(file, of, choice)]
    return _of_ordinates(ordinates, listed(file.name for file in paths), of, units)


def _ordinates(path: Path, of: Hazard, choice: AskedHazard) -> list[Ordinate]:
    """The hazard curves in a file: of the USGS, or in a table."""
    if JSON.fits(read_input(path)):
        return usgs.read(path, read_text(path, JSON), choice)
    return [tables.read(path, of, choice)]


def _of_ordinates(
    ordinates: Sequence[Ordinate], names: str, of: Hazard, units: str | None
) -> HazardCurve:
    """The curve of the measure that is asked for, between two periods if need be."""
    curves: dict[float, Ordinate] = {}
    for ordinate in ordinates:
        if ordinate.period in curves:
            raise ValueError(f"{names}: {measure_in_words(ordinate.period)} is there twice")
        curves[ordinate.period] = points_of(ordinate)
    measures = ", ".join(map(measure_in_words, sorted(curves))) or "no hazard curve"
    of_s0 = any(curve.units == S0 for curve in curves.values())
    if (of.measure == "intensity") != of_s0 or (of.measure == "pga" and 0.0 not in curves):
        raise ValueError(f"measure = {of.measure!r} is not in {names}; allowed: {measures}")
    period = of.period or 0.0
    below = [other for other in curves if 0 < other <= period or other == period]
    above = [other for other in curves if other >= period]
    if not below or not above:
        raise ValueError(f"period = {period:g} is beyond {names}; allowed: within {measures}")
    lower = _in_metres(curves[max(below)], names, units)
    upper = _in_metres(curves[min(above)], names, units)
    intensities, frequencies = _between(lower, upper, period)
    columns = dict.fromkeys(curve.columns for curve in (lower, upper))
    source = "; ".join(filter(None, (names, *columns)))
    points = tuple(intensities), tuple(frequencies)
    return HazardCurve(*points, measure=of.measure, period=of.period, source=source)


def _in_metres(curve: Ordinate, name: str, units: str | None) -> Ordinate:
    check_curve(curve.intensities, curve.frequencies, curve.places or [name])
    unit = 1.0 if curve.units == S0 else stated_size("acceleration", curve.units, units, name)
    return curve._replace(intensities=unit * curve.intensities)


def _between(lower: Ordinate, upper: Ordinate, period: float) -> tuple[Array, Array]:
    """Intensities at a period, and the annual frequencies that both curves have."""
    if lower.period == upper.period:
        return lower.intensities, lower.frequencies
    of_lower = np.log(lower.frequencies)
    of_upper = np.log(upper.frequencies)
    highest = min(of_lower[0], of_upper[0])
    lowest = max(of_lower[-1], of_upper[-1])
    if lowest >= highest:
        raise ValueError(
            f"SA({lower.period:g}) and SA({upper.period:g}) do not overlap in frequency"
        )
    # Rounded, so that frequencies that differ by rounding errors are one.
    rounded = np.round(np.concatenate([of_lower, of_upper]), 9)
    common = np.unique(np.clip(rounded, lowest, highest))[::-1]
    short = np.interp(-common, -of_lower, np.log(lower.intensities))
    long = np.interp(-common, -of_upper, np.log(upper.intensities))
    share = np.log(period / lower.period) / np.log(upper.period / lower.period)
    return np.exp((1 - share) * short + share * long), np.exp(common)
