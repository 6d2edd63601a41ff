"""Points of response spectra in files: in columns, or in a row per site as OpenQuake writes them.

GEM, OpenQuake Engine manual, Uniform hazard spectra, ``hazard_uhs-mean_20.csv``: the columns
``lon,lat,0.1~PGA,0.1~SA(0.2),...``, whose names have a probability of exceedance and the period
[s], and a row for each site with accelerations in g.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from stochlin.applications.records.components import titled_as_vertical
from stochlin.applications.records.files import format_stated
from stochlin.applications.sheets.columns import (
    Choice,
    Column,
    ColumnName,
    Need,
    check_one_kind,
    chosen,
    columns_of,
    noted,
)
from stochlin.applications.sheets.quantities import (
    ACCELERATION_COLUMN,
    ANGULAR_COLUMN,
    DAMPING_COLUMN,
    FREQUENCY_COLUMN,
    NAME_COLUMN,
    PERIOD_COLUMN,
    PSEUDO_VELOCITY_COLUMN,
    SPECTRAL_COLUMN,
    SPECTRAL_DISPLACEMENT_COLUMN,
)
from stochlin.applications.sheets.sheets import Table, sheets_of, table_in
from stochlin.applications.sheets.titles import damping_in_remark, divided_by_remark
from stochlin.applications.sites import usgs_spectra
from stochlin.applications.sites.hazard_formats import Site, period_of
from stochlin.applications.sites.hazard_formats.tables import line_of_site, table_of_sites
from stochlin.files.file_kinds import JSON, WORKBOOK
from stochlin.files.inputs import read_input, read_text
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief, listed, plain, refuse
from stochlin.models.units import stated_size

ABSCISSAE = (PERIOD_COLUMN, FREQUENCY_COLUMN, ANGULAR_COLUMN)
ORDINATES = (
    SPECTRAL_COLUMN,
    ACCELERATION_COLUMN,
    PSEUDO_VELOCITY_COLUMN,
    SPECTRAL_DISPLACEMENT_COLUMN,
)
# of the frequency, in the acceleration
_POWERS = {PSEUDO_VELOCITY_COLUMN: 1, SPECTRAL_DISPLACEMENT_COLUMN: 2}
_TURNS = {FREQUENCY_COLUMN: 1.0, ANGULAR_COLUMN: 2 * np.pi}
LARGEST_FACTOR = 12.0  # by which a code divides forces; NCh 433: R0 of up to 11
_OF_PROBABILITY = "~"


class AskedSpectrum(NamedTuple):
    """What the caller says of a file."""

    units: str | None
    damping: float
    period_column: ColumnName | None
    column: ColumnName | None
    site: Site | None
    divided: bool


class Points(NamedTuple):
    """Periods [s] and accelerations [m/s^2] of a spectrum, the place of each, and attributes.

    ``doubts`` are texts on what the file says beside them, and the caller does not.
    """

    period: Array
    values: Array
    places: list[str]
    about: dict[str, str]
    doubts: Sequence[str] = ()


def points_in(path: Path, request: AskedSpectrum) -> Points:
    """The points in a file; a ValueError says what is missing or wrong."""
    if JSON.fits(read_input(path)):
        return _of_usgs(path, request)
    sheets = sheets_of(path)
    if of_record := "" if WORKBOOK.fits(read_input(path)) else format_stated(path):
        what = f"{plain(path.name)} is a record, {of_record}"
        raise ValueError(f"{what}; allowed: a spectrum, such as response_spectrum of a record")
    of_sites = table_of_sites(sheets)
    if of_sites is not None and any(map(_measure, of_sites.title_cells)):
        return _at_site(of_sites, request)
    table = table_in(sheets, "periods and accelerations")
    refuse(table.sheet.name, "a file of one spectrum", {"site": request.site})
    columns = columns_of(table)
    _check_one_spectrum(table, columns)
    needs = [
        Need("period_column", request.period_column, ABSCISSAE, logarithms=True),
        Need(
            "column",
            request.column,
            ORDINATES,
            True,
            units=request.units,
            logarithms=True,
            damping=request.damping,
        ),
        Need("", None, (DAMPING_COLUMN,), optional=True),
    ]
    aside = any(column.said.aside for column in columns)
    cure = ", and divided_by=4 if its ordinates are divided by R or q = 4" if aside else ""
    abscissa, ordinate, damping = chosen(table, needs, lambda: cure)
    assert abscissa is not None
    assert ordinate is not None  # only that of the damping is optional
    if request.column is None and titled_as_vertical(ordinate.column.title):
        what = f"has {brief(ordinate.column.title)}, of vertical motion"
        raise table.error(f"{what}; allowed: a horizontal one, or column= by number if it is that")
    if damping is not None:
        _check_damping(damping, request.damping)
    points = _converted(table, abscissa, ordinate, request.units)
    return points._replace(doubts=[*_doubts_of_remarks(table, request)])


def _doubts_of_remarks(table: Table, request: AskedSpectrum) -> Iterator[str]:
    """Texts on remarks of another damping ratio, or of a factor by which ordinates are divided."""
    for place, text in table.remarks():
        damping = damping_in_remark(text)
        factor = divided_by_remark(text)
        if damping is not None and not np.isclose(damping, request.damping):
            yield f"{place}: {brief(text)}; is damping={damping:g}, and not {request.damping:g}?"
        if 1 < factor <= LARGEST_FACTOR and not request.divided:
            yield f"{place}: {brief(text)}; are its ordinates divided by it, divided_by={factor:g}?"


def _of_usgs(path: Path, request: AskedSpectrum) -> Points:
    """A spectrum of a response of the design services of the USGS."""
    name = plain(path.name)
    refuse(name, "JSON", {"period_column": request.period_column, "site": request.site})
    points = usgs_spectra.read(name, read_text(path, JSON), request.column)
    if request.damping != usgs_spectra.ASCE_DAMPING:
        what = f"damping = {request.damping:g} contradicts {name}, whose spectra have"
        raise ValueError(f"{what} {usgs_spectra.ASCE_DAMPING:g}; leave it out")
    size = stated_size("acceleration", "g", request.units, name)
    return Points(points.periods, size * points.ordinates, points.places, {"spectrum": points.name})


def _converted(table: Table, abscissa: Choice, ordinate: Choice, units: str | None) -> Points:
    """Periods and accelerations from what the file has."""
    period = abscissa.in_si()
    places = table.places()
    values = ordinate.in_si(units, "units")
    if abscissa.quantity is not PERIOD_COLUMN:
        positive = period > 0
        if not positive.all():
            n = int(np.argmin(positive))
            what = f"{abscissa.quantity.name} is {period[n]:g} {abscissa.quantity.unit}"
            raise ValueError(f"{places[n]}: {what}; allowed: positive")
        period = _TURNS[abscissa.quantity] / period
    if power := _POWERS.get(ordinate.quantity, 0):
        positive = period > 0
        if not positive.all():
            n = int(np.argmin(positive))
            what = f"no acceleration follows from {ordinate.quantity.name} at {period[n]:g} s"
            raise ValueError(f"{places[n]}: {what}; allowed: positive periods")
        values = values * (2 * np.pi / period) ** power
    if abscissa.quantity is not PERIOD_COLUMN and (np.diff(period) < 0).all():
        period = period[::-1]
        values = values[::-1]
        places = places[::-1]
    about = noted([abscissa, ordinate], {**_TURNS, **_POWERS})
    return Points(period, values, places, about)


def _check_one_spectrum(table: Table, columns: Sequence[Column]) -> None:
    """Raise a ValueError if a column of names, as ETABS exports it, names several spectra."""
    for column in columns:
        names = table.rows[column.number - 1]
        if NAME_COLUMN in column.said.quantities and names.nunique() < len(names):
            check_one_kind(table, column.number - 1, "spectrum")


def _check_damping(choice: Choice, damping: float) -> None:
    """Raise a ValueError unless a column of damping ratios has that which is asked for."""
    stated = choice.table.rows[choice.column.number - 1] != ""
    rows = choice.table.rows[stated]
    if rows.empty:
        return
    values = choice._replace(table=choice.table._replace(rows=rows)).in_si()
    same = np.isclose(values, damping, rtol=1e-6, atol=0)
    if not same.all():
        n = int(np.argmin(same))
        where = choice.table.sheet.where(rows.index[n])
        what = f"the damping ratio is {values[n]:g}, which damping = {damping:g} contradicts"
        raise ValueError(f"{where}: {what}; give damping={values[n]:g}")


def _measure(title: str) -> tuple[str, float] | None:
    """The probability in a title such as ``0.1~SA(0.2)``, and the period; None of another title."""
    probability, _, measure = title.rpartition(_OF_PROBABILITY)
    period = period_of(measure.strip())
    return None if period is None else (probability.strip(), period)


def _at_site(table: Table, request: AskedSpectrum) -> Points:
    """The spectrum of a site and a probability of exceedance."""
    refuse(table.sheet.name, "a table of sites", {"period_column": request.period_column})
    table.sheet.check_width(table.rows.index, len(table.title_cells))
    measures = {n: of for n, title in enumerate(table.title_cells) if (of := _measure(title))}
    probabilities = [*dict.fromkeys(probability for probability, _ in measures.values())]
    wanted = request.column
    if wanted is None and len(probabilities) == 1:
        wanted = probabilities[0]
    if wanted not in probabilities:
        shown = "column is missing" if wanted is None else f"column = {brief(wanted)}"
        what = f"has the probabilities {listed(probabilities)}, and {shown}"
        raise table.error(f"{what}; give one, such as column={brief(probabilities[0])}")
    periods = {n: period for n, (probability, period) in measures.items() if probability == wanted}
    columns = sorted(periods, key=lambda n: periods[n])
    line = line_of_site(table, request.site)
    place = table.sheet.where(line)
    values = table.sheet.numbers(table.rows.loc[[line], columns], "acceleration")[0]
    size = stated_size("acceleration", "g", request.units, place)
    places = [table.sheet.where(line, column) for column in columns]
    about = (
        {"comment": f"uniform hazard spectrum of {place}, probability {wanted}"} if wanted else {}
    )
    return Points(np.array([periods[n] for n in columns]), size * values, places, about)
