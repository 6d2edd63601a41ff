"""Hazard curves from files: columns of intensities and annual frequencies."""

from __future__ import annotations

import os

from stochlin.analyses.records.files import (
    METRES,
    acceleration_units,
    read_series,
    rows_in_words,
    stated_units,
)
from stochlin.analyses.tables.inputs import input_path
from stochlin.messages import plain
from stochlin.models.hazards import Hazard, HazardCurve, check_curve


def read_hazard(
    path: str | os.PathLike[str],
    measure: str = "pga",
    *,
    units: str | None = None,
    period: float | None = None,
) -> HazardCurve:
    r"""Read a hazard curve from a file with columns of text.

    Parameters
    ----------
    path : str or path
        Path of the file, with intensities in the first column and annual frequencies of exceedance
        [1/yr] in the second. Columns are separated as in `read_record`.
    measure : {"pga", "sa", "intensity"}
        As in `HazardCurve`.
    units : {"g", "m/s^2", "cm/s^2", "gal", "mm/s^2"}, optional
        Units of the accelerations. Not needed if the row of names has them, as in ``pga [g]``. Not
        allowed for ``"intensity"``, which is in m^2/s^3.
    period : float, optional
        Period [s] of ``"sa"``.

    Returns
    -------
    HazardCurve
        The hazard curve in SI units.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If units are missing or contradict the file; if there are fewer than two points, a number is not
        positive, the intensities do not increase or the frequencies do not decrease (the message names
        the row); if the measure is unknown; or if a period is missing or not allowed.

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
    path = input_path("path", path)
    of = Hazard(measure=measure, period=period)  # checks measure and period
    units = None if units is None else acceleration_units(units, "units")
    of_s0 = of.measure == "intensity"
    if of_s0 and units is not None:
        raise ValueError(
            f"units = {units!r} with measure = 'intensity'; allowed: none, since that is in m^2/s^3"
        )
    intensities, frequencies = (read_series(path, column, None) for column in (0, 1))
    check_curve(intensities.values, frequencies.values, rows_in_words(path))
    unit = 1.0 if of_s0 else METRES[stated_units(intensities, plain(path.name), units)]
    values = tuple(unit * intensities.values)
    return HazardCurve(values, tuple(frequencies.values), measure=of.measure, period=of.period)
