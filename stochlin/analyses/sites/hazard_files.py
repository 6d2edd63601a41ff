"""Hazard curves from files: columns, and the results of OpenQuake and of the U.S. Geological Survey."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from stochlin.analyses.records.files import (
    METRES,
    acceleration_units,
    read_series,
    rows_in_words,
    stated_units,
)
from stochlin.analyses.records.formats import Series
from stochlin.analyses.sites.hazard_formats import (
    HAZARD_FORMATS,
    AskedHazard,
    HazardFormat,
    Ordinate,
    Site,
    annual_frequencies,
    measure_in_words,
    points_of,
    refuse,
)
from stochlin.analyses.tables.inputs import input_path, read_text
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, plain
from stochlin.models.arguments import Years, checked
from stochlin.models.hazards import Hazard, HazardCurve, check_curve

FilePath = str | os.PathLike[str]


@checked
def read_hazard(
    path: FilePath | Sequence[FilePath],
    measure: str = "pga",
    *,
    units: str | None = None,
    period: float | None = None,
    site: Site | None = None,
    investigation_time: Years | None = None,
) -> HazardCurve:
    r"""Read a hazard curve from a file.

    Three formats are read: columns of text; files of OpenQuake, one for each intensity measure, with a
    row for each site (``hazard_curve-mean-SA(0.5)_17.csv``); and responses of the hazard service of the
    U.S. Geological Survey in JSON, with several intensity measures of one site.

    Parameters
    ----------
    path : str, path, or list of them
        Path of the file. Columns have intensities in the first one and annual frequencies of exceedance
        [1/yr] in the second, separated as in `read_record`. Of OpenQuake several files may be given, for
        several periods.
    measure : {"pga", "sa", "intensity"}
        As in `HazardCurve`.
    units : {"g", "m/s^2", "cm/s^2", "gal", "mm/s^2"}, optional
        Units of the accelerations. Not needed if the row of names has them, as in ``pga [g]``, or for
        the other formats, which are in g. Not allowed for ``"intensity"``, which is in m^2/s^3.
    period : float, optional
        Period [s] of ``"sa"``. Between two periods of the files, the logarithm of the spectral
        acceleration that is exceeded with the same frequency is interpolated linearly in the logarithm
        of the period.
    site : int or tuple of two floats, optional
        Site in a file of OpenQuake: its number, from 1, or its longitude and latitude [degrees], within
        0.01 degrees. Not needed if there is only one.
    investigation_time : float, optional
        Time [yr] in which the probabilities of a file hold, if its second column has probabilities of
        exceedance. The annual frequencies are those of a Poisson process. OpenQuake states it.

    Returns
    -------
    HazardCurve
        The hazard curve in SI units. Of OpenQuake and the USGS it has no points with a frequency of zero
        or a probability of 1, and of equal frequencies the largest intensity only.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError, TypeError
        If units are missing or contradict the file; if there are fewer than two points, a number is not
        positive, the intensities do not increase or the frequencies do not decrease (the message names
        the row); if the measure is unknown, or not in the file; if a period is missing, not allowed, or
        beyond those of the file; or if a site is missing or not in the file.

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
    paths = [input_path("path", file) for file in (path if isinstance(path, (list, tuple)) else [path])]
    units = None if units is None else acceleration_units(units, "units")
    asked = AskedHazard(site, investigation_time)
    read = [_ordinates(file, asked) for file in paths]
    if len(read) == 1 and read[0] is None:
        return _of_columns(paths[0], of, units, asked)
    if not read or None in read:
        raise ValueError(
            f"path = {brief([str(file) for file in paths])}; allowed: one file, or several of OpenQuake"
        )
    names = ", ".join(plain(file.name) for file in paths)
    ordinates = [ordinate for some in read for ordinate in some or ()]
    return _of_ordinates(ordinates, names, of, units)


def _ordinates(path: Path, asked: AskedHazard) -> list[Ordinate] | None:
    """The hazard curves of a file of a registered format; None for columns of text."""
    text = read_text(path).replace("\r\n", "\n")
    known = (of for of in HAZARD_FORMATS.values() if of.start.match(text))
    of: HazardFormat | None = next(known, None)
    return None if of is None else of.read(plain(path.name), text, asked)


def _of_columns(path: Path, of: Hazard, units: str | None, asked: AskedHazard) -> HazardCurve:
    of_s0, name = of.measure == "intensity", plain(path.name)
    refuse(name, "a file of one site", {"site": asked.site})
    if of_s0 and units is not None:
        raise ValueError(
            f"units = {units!r} with measure = 'intensity'; allowed: none, since that is in m^2/s^3"
        )
    intensities, second = (read_series(path, column, None) for column in (0, 1))
    places = rows_in_words(path)
    frequencies = _frequencies(second, name, asked.years, places)
    check_curve(intensities.values, frequencies, places)
    unit = 1.0 if of_s0 else METRES[stated_units(intensities, name, units)]
    values = tuple(unit * intensities.values)
    return HazardCurve(values, tuple(frequencies), measure=of.measure, period=of.period)


def _frequencies(second: Series, name: str, years: float | None, places: Sequence[str]) -> Array:
    if years is not None:
        return annual_frequencies(second.values, years, places)
    if any(word in second.column.lower() for word in ("prob", "poe")):
        raise ValueError(
            f"column {brief(second.column)} of {name} seems to have probabilities; give "
            "investigation_time, the years for which they hold, or name it annual frequency"
        )
    return second.values


def _of_ordinates(
    ordinates: Sequence[Ordinate], names: str, of: Hazard, units: str | None
) -> HazardCurve:
    """The curve of the measure that is asked for, between two periods if need be."""
    curves: dict[float, Ordinate] = {}
    for ordinate in ordinates:
        if ordinate.period in curves:
            raise ValueError(
                f"{names}: {measure_in_words(ordinate.period)} is there twice; leave one out"
            )
        curves[ordinate.period] = points_of(ordinate)
    known = ", ".join(map(measure_in_words, sorted(curves))) or "no hazard curve"
    if of.measure == "intensity" or (of.measure == "pga" and 0.0 not in curves):
        raise ValueError(
            f"measure = {of.measure!r} is not in {names}, which has {known}; allowed: one of these, SA "
            "by measure = 'sa' with its period"
        )
    period = of.period or 0.0
    below = [other for other in curves if 0 < other <= period or other == period]
    above = [other for other in curves if other >= period]
    if not below or not above:
        raise ValueError(
            f"period = {period:g} is beyond {names}, which has {known}; allowed: a period between "
            "two of SA, since nothing is extrapolated"
        )
    lower, upper = (_in_metres(curves[end], names, units) for end in (max(below), min(above)))
    intensities, frequencies = _between(lower, upper, period)
    return HazardCurve(tuple(intensities), tuple(frequencies), measure=of.measure, period=of.period)


def _in_metres(curve: Ordinate, name: str, units: str | None) -> Ordinate:
    check_curve(curve.intensities, curve.frequencies, curve.places or [name])
    unit = METRES[stated_units(Series(curve.intensities, None, None, curve.units), name, units)]
    return curve._replace(intensities=unit * curve.intensities)


def _between(lower: Ordinate, upper: Ordinate, period: float) -> tuple[Array, Array]:
    """Intensities at a period, and the annual frequencies that both curves have."""
    if lower.period == upper.period:
        return lower.intensities, lower.frequencies
    logarithms = [np.log(curve.frequencies) for curve in (lower, upper)]
    highest, lowest = min(of[0] for of in logarithms), max(of[-1] for of in logarithms)
    if lowest >= highest:
        raise ValueError(
            f"{measure_in_words(lower.period)} and {measure_in_words(upper.period)} have no range of "
            "annual frequencies in common; allowed: curves that overlap"
        )
    # Rounded, so that frequencies that differ by rounding errors are one.
    common = np.unique(np.clip(np.round(np.concatenate(logarithms), 9), lowest, highest))[::-1]
    short, long = (
        np.interp(-common, -of, np.log(curve.intensities))
        for of, curve in zip(logarithms, (lower, upper), strict=True)
    )
    share = np.log(period / lower.period) / np.log(upper.period / lower.period)
    return np.exp((1 - share) * short + share * long), np.exp(common)
