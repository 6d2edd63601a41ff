"""Response spectra as labelled arrays, pseudo-acceleration over period: from files, with checks."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from typing import Literal, TypeGuard, get_args

import numpy as np
import xarray as xr

from stochlin.applications.records.records import checked_array
from stochlin.applications.sheets.columns import ColumnName
from stochlin.applications.sites.elastic_spectra import (
    BY_CODE,
    USUAL_DAMPING,
    DividedBy,
    as_elastic,
    marked,
)
from stochlin.applications.sites.hazard_formats import Site
from stochlin.applications.sites.spectrum_files import AskedSpectrum, points_in
from stochlin.files.inputs import input_path
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput, brief, listed, plain
from stochlin.models.arguments import DampingRatio, Truth, checked, is_number
from stochlin.solver.tables import labels

SHORTEST_PERIOD = 0.05  # shortest period for which a spectrum is fitted or compared [s]
USUAL_BAND = (0.2, 2.0)  # [s] of usual buildings, in which spectra are compared
BAND_POINTS = 40  # periods
FEWEST_ORDINATES = 4  # smallest number of points
WIDEST_STEP = 2.0  # ratio of two consecutive periods, beyond which it matters what is between them
Between = Literal["logarithmic", "linear"]
INTERPOLATIONS: tuple[Between, ...] = get_args(Between)
POINTS_BETWEEN_ORDINATES = 33  # points from one to the next of a linear spectrum


def labelled(period: Array, values: Array, damping: float, source: str) -> xr.DataArray:
    """A spectrum as a labelled array, with its units, damping ratio and source."""
    return xr.DataArray(
        values,
        coords=[labels.axis("period", "period", period, "s")],
        name="pseudo_acceleration",
        attrs={
            "units": "m/s^2",
            "long_name": f"elastic response spectrum, damping {damping:g}",
            "damping": float(damping),
            "source": source,
        },
    )


def check_band(band: tuple[float, float]) -> None:
    """Raise a ValueError unless ``band`` is a range of periods [s]."""
    if not 0 < band[0] < band[1] < np.inf:
        raise ValueError(f"band = {brief(band)}; allowed: 0 < lower < upper, in seconds")


def is_spectrum(target: object) -> TypeGuard[xr.DataArray]:
    """Whether ``target`` is a spectrum, an array with the dimension ``period``."""
    return isinstance(target, xr.DataArray) and "period" in target.dims


def checked_spectrum(spectrum: xr.DataArray) -> tuple[Array, Array, float]:
    """Periods [s], pseudo-accelerations [m/s^2] and damping ratio of a spectrum, checked.

    A ValueError or TypeError is raised for other dimensions or units, for periods that do not
    increase or have a gap, and for ordinates that are not positive. The ordinate at a period of 0
    is the peak ground acceleration.
    """
    period, values = checked_array(spectrum, "spectrum", "period")
    damping = spectrum.attrs.get("damping", USUAL_DAMPING)
    if not (is_number(damping) and 0 < damping < 1):
        raise ValueError(f"spectrum is of the damping {brief(damping)}; allowed: 0 < damping < 1")
    places = [f"spectrum, number {n}" for n in range(1, period.size + 1)]
    check_ordinates(period, values, places)
    return period, values, float(damping)


def check_goal(goals: Mapping[str, object], period: object) -> None:
    """Raise a ValueError unless exactly one goal is given, and a period with ``sa`` only."""
    stated = [name for name, value in goals.items() if value is not None]
    if len(stated) != 1:
        named = ["sa with a period" if name == "sa" else name for name in goals]
        both = " and ".join(stated) or "nothing"
        raise ValueError(f"{both} is given; allowed: one of {listed(named)}")
    if (goals.get("sa") is None) != (period is None):
        raise ValueError("sa and period go together; allowed: both, or neither")


def interpolated(period: Array, values: Array, at: Array) -> Array:
    """Ordinates at other periods above 0, by linear interpolation of logarithms."""
    above = period > 0
    ordinates: Array = np.exp(np.interp(np.log(at), np.log(period[above]), np.log(values[above])))
    return ordinates


def check_ordinates(period: Array, values: Array, places: list[str]) -> None:
    """Raise a ValueError unless these are a spectrum; ``places`` name the points."""
    if period.size < FEWEST_ORDINATES:
        raise ValueError(f"spectrum has {period.size} points; allowed: {FEWEST_ORDINATES} or more")
    periods_rise = bool((np.diff(period) > 0).all())
    ordinates_rise = bool((np.diff(values) > 0).all())
    exchanged = ordinates_rise and not periods_rise
    cure = ", or are the columns of periods and ordinates exchanged?" if exchanged else ""
    for place, last, t, sa in zip(places, [-1.0, *period[:-1]], period, values, strict=True):
        if not (np.isfinite(t) and t >= 0):
            raise ValueError(f"{place}: the period is {t:g} s; allowed: 0 or more, finite")
        if not (np.isfinite(sa) and sa > 0):
            what = f"{place}: the acceleration at {t:g} s is {sa:g}"
            raise ValueError(f"{what}; allowed: positive{cure}")
        if t <= last:
            what = f"{place}: {t:g} s follows {last:g} s"
            raise ValueError(f"{what}; allowed: increasing periods{cure}")


@checked
def read_spectrum(
    path: str | os.PathLike[str],
    *,
    units: str | None = None,
    damping: DampingRatio = USUAL_DAMPING,
    period_column: ColumnName | None = None,
    column: ColumnName | None = None,
    site: Site | None = None,
    between: Between | None = None,
    elastic: Truth | None = None,
    divided_by: DividedBy | None = None,
) -> xr.DataArray:
    r"""Read a response spectrum, as an elastic one, from columns, rows of sites, or the USGS.

    Parameters
    ----------
    path : str or path
        Path of the file, text in UTF-8 or a workbook, with or without a row of names, below which
        units may follow. Lines that begin with ``#`` or ``%`` are comments. Or the JSON with which
        the design services of the U.S. Geological Survey answer for ASCE 7-22, in g and for the
        damping ratio 0.05.
    units : str, optional
        Units of the accelerations, as in `read_record`. Not needed if the row of names has them, as
        in ``Sa [g]``.
    damping : float
        Damping ratio [-] of the spectrum, between 0 and 1.
    period_column, column : int or str, optional
        Columns of the period and of the acceleration, each by its number from 1 or by its name.
        They are not needed where the names say it, in several languages: ``T (s)``, ``Period``,
        ``Sa [g]``. A frequency [Hz], an angular frequency [rad/s], a pseudo-velocity, a spectral
        displacement, and ``log10`` or ``ln`` of these, are converted.
    site : int or tuple of two floats, optional
        Site in a table of uniform hazard spectra of OpenQuake, as in `read_hazard`. Of several
        probabilities ``column`` names one, as ``"0.1"``.
        Of the USGS the column is ``multiPeriodDesignSpectrum`` by default, or
        ``twoPeriodDesignSpectrum`` where that is missing; ``multiPeriodMCErSpectrum`` and
        ``twoPeriodMCErSpectrum`` are those of the maximum considered earthquake.
    between : {"logarithmic", "linear"}, optional
        What the ordinates and periods between two points are, which the code says: linear in their
        logarithms (default), or linear, as for the few points of the code of Canada.
    elastic : bool, optional
        True for an elastic spectrum. Say this, or ``divided_by``; nothing in the file does.
    divided_by : float or DataArray, optional
        Factor [-] of at least 1 by which the ordinates are divided, such as ``R`` or ``q``, or an
        array of factors over ``period`` [s] for all periods of the file, linear between. The
        ordinates are multiplied by it.

    Returns
    -------
    xarray.DataArray
        Elastic pseudo-acceleration [m/s^2] over ``period`` [s], with the attributes ``damping``,
        ``source`` and ``elastic``, which says how the file was taken; of a linear one also at
        periods between the points. The attribute ``columns`` says what is converted, and which
        columns were asked for by number; of the USGS ``spectrum`` says which is read.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If units or a column are missing or contradict the file, or the title of a column states
        another damping ratio or the period of one ordinate; if the periods do not increase, an
        ordinate is not positive, or there are fewer than 4 points; or if ``divided_by`` does not
        cover the periods, or is given beside ``elastic=True``.

    Warns
    -----
    UserWarning
        If the largest ordinate is below 0.167 g or above 3.75 g, an ordinate jumps from a period to
        the next, or a spectral displacement is above 5 m, so that units are probably wrong, or
        periods are frequencies; or a period is more than twice the last, and ``between`` is not
        given. If neither ``elastic`` nor ``divided_by`` is given, and the spectrum is taken as
        elastic; or if its shape speaks against that: it rises to less than 0.7 of the median of
        elastic spectra (Newmark and Hall 1982; to less than 1.48 times the ordinate at 0 s for 5 %
        damping), unless it begins on its plateau, or it is level from less than 4 s on.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "site.csv"
    >>> rows = ["period,Sa [g]", "0,0.2", "0.1,0.4", "0.2,0.5", "0.4,0.5", "0.8,0.25", "1.6,0.12"]
    >>> _ = path.write_text("\n".join(rows), encoding="utf-8")
    >>> spectrum = sl.read_spectrum(path, elastic=True)
    >>> round(float(spectrum.sel(period=0.4)), 4), spectrum.attrs["damping"]
    (4.9033, 0.05)
    >>> sl.read_spectrum(path, divided_by=4).attrs["elastic"]
    'divided by 4, multiplied back'
    """
    path = input_path("path", path)
    name = plain(path.name)
    divided = divided_by is not None
    request = AskedSpectrum(units, damping, period_column, column, site, divided)
    period, values, places, about, doubts = points_in(path, request)
    check_ordinates(period, values, places)
    for text in doubts:
        warnings.warn(text, DoubtfulInput, stacklevel=3)
    if between is None and (period[1:] > WIDEST_STEP * period[:-1])[period[:-1] > 0].any():
        what = f"{name}: its points are far apart"
        cure = "is it linear in logarithms between them, or between='linear'?"
        warnings.warn(f"{what}; {cure}", DoubtfulInput, stacklevel=3)
    spectrum = labelled(period, values, damping, name).assign_attrs(about)
    if "spectrum" in about:
        spectrum = marked(spectrum, BY_CODE)
    spectrum = as_elastic(spectrum, elastic, divided_by)
    if between == "linear":
        finer = np.unique(np.linspace(period[:-1], period[1:], POINTS_BETWEEN_ORDINATES))
        return spectrum.interp(period=finer)
    return spectrum
