"""Suites of records: reading from a folder or a table, and scaling of each record by a factor."""

from __future__ import annotations

import os
import re
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from itertools import zip_longest
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.records.components import (
    COMMON,
    PLACE_KEYS,
    FileNames,
    events_of,
    is_below,
    is_vertical,
)
from stochlin.applications.records.files import UnknownFormatError, chosen, is_record, read_channels
from stochlin.applications.records.records import checked_record, copies, recorded
from stochlin.applications.records.response import response_spectrum
from stochlin.applications.sheets.columns import ColumnName
from stochlin.applications.sheets.sheets import number_in, text_sheet
from stochlin.applications.sites.elastic_spectra import USUAL_DAMPING, DividedBy, as_elastic
from stochlin.applications.sites.spectra import (
    BAND_POINTS,
    USUAL_BAND,
    check_band,
    check_goal,
    checked_spectrum,
    interpolated,
)
from stochlin.files.inputs import input_path, read_text
from stochlin.messages import LONGEST_MESSAGE, DoubtfulInput, brief, listed, plain, refuse, sentence
from stochlin.models.arguments import (
    Acceleration,
    DampingRatio,
    Seconds,
    Truth,
    TwoNumbers,
    Whole,
    checked,
)
from stochlin.models.plausible import PLAUSIBLE

PATH_COLUMN = "file"  # name of the table column with the paths of the records
WHO_BELONGS = f"the columns {PATH_COLUMN}, event and station of a table say which belong together"
# The table in a download of PEER, below a title, with a column for each component.
PEER_TABLE = "_SearchResults.csv"
_SCALE_COLUMN = re.compile(r"scal|factor|fakt", re.IGNORECASE)
PEER_FILES = r"Horizontal-[12] Acc\. Filename"
PEER_FACTOR = "Scale Factor"
PEER_ABOUT = {"event": ("Earthquake Name", "Year"), "station": ("Station Name",)}
ABOUT = ("event", "station", "component")  # columns that become attributes

Suite = dict[str, xr.DataArray]
Row = Mapping[str, str]


@checked
def read_records(
    path: str | os.PathLike[str],
    *,
    dt: Seconds | None = None,
    units: str | None = None,
    column: ColumnName | None = None,
    time_column: ColumnName | None = None,
    component: ColumnName | None = None,
    wrapped: Truth = False,
    skip: Annotated[int, Whole(0)] = 0,
) -> Suite:
    r"""Read a suite of records: all files of a folder, or those listed in a table.

    Vertical components (``U-D``, ``UP``, ``V1``, ``BHZ00``, ..., by the header, or else the title
    or the name of the file) and those in a borehole are left out with a warning. Two records with
    the same ``event`` and ``station`` count as one earthquake in the intervals of `recorded_gap`;
    where one of these is not known, two of files whose names differ in the component alone.

    Parameters
    ----------
    path : str or path
        Path of a folder or a table. Of a folder and the folders in it, all files that end in .txt,
        .csv, .dat or .acc, or as files of the formats of `read_record` do, such as .at2, .v2, .ns,
        .asc and .191, are read in the order of their names, also compressed (.gz); those in which
        no record can be seen are left out with a warning. Of a download of PEER the table
        ``_SearchResults.csv`` names the files, earthquakes and stations, and its scale factors
        become the attribute ``scale_factor``, without being applied. Another table is
        comma-separated with a row of names. Its column ``file`` has paths relative to the folder of
        the table. The columns ``dt`` [s] and ``units``, which are optional, apply to each file.
        Units such as ``"t s, g"`` mean that the first column of the file is time and the second
        acceleration; text after a semicolon is a remark. The columns ``event``, ``station`` and
        ``component`` become attributes of the records; ``component`` also chooses one of several
        components of a file.
    dt, units, column, time_column, component, wrapped, skip
        As in `read_record`, for all files without such an entry in the table. Without a
        ``component``, both horizontal ones of a file are read; with it, also vertical ones.

    Returns
    -------
    dict of str to xarray.DataArray
        The records [m/s^2] over ``time`` [s], by their paths in the table or relative to the
        folder, for `recorded_gap`, `response_spectrum` and `separation`; of a file with two, also
        by the component. The attribute ``file`` is this path.

    Raises
    ------
    FileNotFoundError
        If there is no such folder or table.
    ValueError
        If a file cannot be read, or its time step or units contradict the table (the message names
        the file and the line of the table), or there is none.

    Warns
    -----
    UserWarning
        As in `read_record`; for each file and for all components that are left out; if a file and
        its name state different directions; and if records state a station and no earthquake, or
        the other way round, and their names do not say which belong together; if three are of one
        earthquake and station, of which one may be vertical; if two are the same motion; and if two
        or three each are equally long, and so may be components of one earthquake.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> for name, motion in zip("ab", sl.simulated_motions(sl.WhiteNoise(0.01), 4.0, paths=2)):
    ...     motion.to_series().to_csv(folder / f"{name}.csv")
    >>> list(sl.read_records(folder, units="m/s^2"))
    ['a.csv', 'b.csv']
    """
    path = input_path("path", path)
    if not path.exists():
        raise FileNotFoundError(f"path = {brief(path.name)} is neither a folder nor a table")
    if (path / PEER_TABLE).is_file():
        path /= PEER_TABLE
    usual: dict[str, Any] = {"dt": dt, "units": units, "component": component}
    usual |= {"column": column, "time_column": time_column, "wrapped": wrapped, "skip": skip}
    listed_files = _of_folder(path) if path.is_dir() else _of_table(path)
    read: dict[str, _Read] = {}
    folder = path if path.is_dir() else path.parent
    for name, where, options, about in listed_files:
        try:
            for label, channel in _components(folder / name, name, **usual | options):
                if label in read:
                    raise ValueError("it is listed twice; allowed: each file once")
                read[label] = channel._replace(record=channel.record.assign_attrs(about, file=name))
        except (OSError, ValueError) as error:
            if not (path.is_dir() and isinstance(error, UnknownFormatError)):
                text = sentence(error, LONGEST_MESSAGE)
                raise ValueError(text if text.startswith(where) else f"{where}: {text}") from error
            what = f"{where} is left out: no record can be seen in it"
            warnings.warn(what, DoubtfulInput, stacklevel=3)
    level = read if component is not None else _horizontal(read, plain(path.name))
    suite = {label: channel.record for label, channel in level.items()}
    for question in (*_without_earthquake(suite), *_alike(suite)):
        warnings.warn(f"{plain(path.name)}: {question}", DoubtfulInput, stacklevel=3)
    if not suite:
        what = (
            "vertical ones alone, which component= reads" if read else "no record that can be read"
        )
        raise ValueError(
            f"{plain(path.name)} holds {what}; allowed: one horizontal record at least"
        )
    return suite


class _Read(NamedTuple):
    """A record that is read, the title of its file or column, and whether the file has no other."""

    record: xr.DataArray
    title: str
    alone: bool


def _components(
    path: Path,
    name: str,
    dt: float | None,
    units: str | None,
    component: ColumnName | None,
    **reading: Any,
) -> Iterator[tuple[str, _Read]]:
    """The components of a file with their names: the one asked for, or all of up to three."""
    source, channels = read_channels(path, **reading)
    if component is None and 1 < len(channels) <= 3:
        for channel in channels:
            label = f"{name}, {channel.about.get('component', '')}"
            yield (
                label,
                _Read(recorded(channel, source, dt, units, alone=False), channel.title, False),
            )
    else:
        channel = chosen(channels, component, source)
        record = recorded(channel, source, dt, units, alone=component is not None)
        yield name, _Read(record, channel.title, len(channels) == 1)


def _horizontal(read: dict[str, _Read], folder: str) -> dict[str, _Read]:
    """The records that are horizontal and at the surface, with warnings on the others."""
    names = FileNames({channel.record.attrs["file"] for channel in read.values() if channel.alone})
    level: dict[str, _Read] = {}
    contradicted = []
    for label, channel in read.items():
        component = channel.record.attrs.get("component", "")
        in_name = names.component(channel.record.attrs["file"]) if channel.alone else None
        vertical = is_vertical(component, channel.title, in_name)
        if in_name is not None and in_name.weight >= COMMON and in_name.vertical != vertical:
            contradicted.append(label)
        if not vertical and not is_below(component):
            level[label] = channel
    if upward := [label for label in read if label not in level]:
        which = f"{listed(upward)} {'is' if len(upward) == 1 else 'are'} left out"
        why = "vertical or in a borehole; read_record reads such components"
        warnings.warn(f"{folder}: {which}: {why}", DoubtfulInput, stacklevel=4)
    if contradicted:
        what = "another direction in the name of the file than in the file, which is believed"
        warnings.warn(f"{folder}: {listed(contradicted)}: {what}", DoubtfulInput, stacklevel=4)
    return level


def _without_earthquake(suite: Suite) -> Iterator[str]:
    """Sentences on records of a station, or of an earthquake, that may belong together or not."""
    events = events_of(suite, [*suite.values()])
    single = [event for event, count in Counter(events).items() if count == 1]
    for stated, missing in (PLACE_KEYS, PLACE_KEYS[::-1]):
        alike: dict[str, list[str]] = {}
        for event, (label, record) in zip(events, suite.items(), strict=True):
            if event in single and record.attrs.get(stated) and not record.attrs.get(missing):
                alike.setdefault(record.attrs[stated], []).append(label)
        for text, labels in alike.items():
            if len(labels) > 1:
                what = f"{listed(labels)} state the {stated} {brief(text)} and no {missing}"
                yield f"{what}: each counts as an earthquake; {WHO_BELONGS}"


def _alike(suite: Suite) -> Iterator[str]:
    """Sentences on records that may be a vertical component, a copy, or a component of another."""
    of_events: dict[object, list[str]] = {}
    lengths: dict[object, list[str]] = {}
    names = [*suite]
    events = events_of(suite, [*suite.values()])
    for event, label in zip(events, names, strict=True):
        of_events.setdefault(event, []).append(label)
    for labels in of_events.values():
        if len(labels) == 1 and not any(suite[labels[0]].attrs.get(key) for key in PLACE_KEYS):
            time = suite[labels[0]].time.to_numpy()
            lengths.setdefault((time.size, *np.round(time[:2], 6)), []).append(labels[0])
    if crowded := next((labels for labels in of_events.values() if len(labels) > 2), []):
        yield f"{listed(crowded)} are of one earthquake and station; is one of them vertical?"
    for first, later in copies([record.to_numpy() for record in suite.values()]):
        if events[first] != events[later]:
            both = f"{names[first]} and {names[later]}"
            yield f"{both} are the same motion; is it to count as several earthquakes?"
            break
    if len(lengths) > 1 and all(1 < len(labels) <= 3 for labels in lengths.values()):
        what = (
            f"{listed(next(iter(lengths.values())))} are equally long; are they of one earthquake?"
        )
        yield f"{what} {WHO_BELONGS}"


# A file of a suite: its name, its name for messages, options of reading, and attributes.
_Listed = tuple[str, str, dict[str, Any], dict[str, Any]]


def _of_folder(path: Path) -> Iterator[_Listed]:
    """Each file in a folder."""
    for file in sorted(path.rglob("*")):
        if is_record(file.name) and file.is_file():
            name = file.relative_to(path).as_posix()
            yield name, plain(name), {}, {}


def _of_table(path: Path) -> Iterator[_Listed]:
    """Each file in a table, with a warning on factors that are not applied."""
    rows = [*table_rows(read_text(path), path.name)]
    keys = rows[0][2] if rows else ()
    factors = [key for key in keys if _SCALE_COLUMN.search(key) and key != PEER_FACTOR]
    if factors:
        what = f"{plain(path.name)}: its column {brief(factors[0])} is not applied"
        warnings.warn(f"{what}; scale_records scales records", DoubtfulInput, stacklevel=4)
    for line, name, row in rows:
        where = f"{plain(path.name)}, line {line}, {plain(name)}"
        about: dict[str, Any] = {key: row[key] for key in ABOUT if row.get(key)}
        if factor := number_in(row.get(PEER_FACTOR, "")):
            about["scale_factor"] = factor
        yield name, where, _options(row, where), about


def table_rows(text: str, name: str) -> Iterator[tuple[int, str, Row]]:
    """Line, file and columns of each row of a table of records; a ValueError if it is none.

    A row of PEER's ``_SearchResults.csv`` has both horizontal components.
    """
    sheet = text_sheet(text.splitlines(), plain(name), ",")
    rows = {line: sheet.row(line) for line in sheet.cells.index}
    is_file = re.compile(f"{PATH_COLUMN}|{PEER_FILES}").fullmatch
    start = next((line for line, row in rows.items() if any(map(is_file, row))), None)
    if start is None:
        columns = listed(next(iter(rows.values()), ()))
        raise ValueError(f"{sheet.name} has the columns {columns}; allowed: with {PATH_COLUMN!r}")
    names = rows[start]
    for line, row in rows.items():
        if line > start and PATH_COLUMN not in names and len(row) < len(names):
            return  # below the table of PEER
        cells = dict(zip_longest(names, row, fillvalue=""))
        for key, parts in PEER_ABOUT.items() if PATH_COLUMN not in names else ():
            cells[key] = ", ".join(cells.get(part, "") for part in parts)
        for column in filter(is_file, names if line > start else ()):
            if cells[column].strip("-"):
                yield line, cells[column], cells


def _options(row: Row, where: str) -> dict[str, Any]:
    options: dict[str, Any] = {key: row[key] for key in ("component",) if row.get(key)}
    units = row.get("units", "")
    step = row.get("dt", "")
    of_columns = [part.strip() for part in units.partition(";")[0].split(",")]
    if of_columns[-1]:
        options["units"] = of_columns[-1]
    if len(of_columns) == 2 and of_columns[0].split() == ["t", "s"]:
        options |= {"time_column": 1, "column": 2, "dt": None}
    elif len(of_columns) > 1:
        raise ValueError(
            f"{where}: units = {brief(units)}; allowed: one unit, or 't s, ' before it"
        )
    if step:
        options["dt"] = number_in(step)
        if options["dt"] is None:
            raise ValueError(f"{where}: dt = {brief(step)} is no number; allowed: seconds")
    return options


@checked
def scale_records(
    records: Mapping[str, xr.DataArray],
    *,
    pga: Acceleration | None = None,
    sa: Acceleration | None = None,
    period: Seconds | None = None,
    spectrum: xr.DataArray | None = None,
    band: TwoNumbers = USUAL_BAND,
    damping: DampingRatio = USUAL_DAMPING,
    elastic: Truth | None = None,
    divided_by: DividedBy | None = None,
) -> Suite:
    """Scale each record of a suite by its factor to a peak or spectral acceleration or a spectrum.

    Parameters
    ----------
    records : mapping of str to xarray.DataArray
        A suite, as from `read_records`.
    pga : float, optional
        Wanted peak ground acceleration of each record [m/s^2]. One of ``pga``, ``sa`` and
        ``spectrum`` is given.
    sa, period : float, optional
        Wanted pseudo-acceleration of each record [m/s^2] at this period [s].
    spectrum : xarray.DataArray, optional
        Wanted spectrum, as from `eurocode_8`. The spectrum of each record has the same mean
        logarithm over the ``band``.
    band : tuple of two floats
        Periods [s] between which spectra are compared, evenly spaced in the logarithm.
    damping : float
        Damping ratio [-] for ``sa``; a spectrum has its own.
    elastic, divided_by : optional
        What a spectrum is that does not say so itself, as in `read_spectrum`.

    Returns
    -------
    dict of str to xarray.DataArray
        The scaled suite; the attribute ``scale`` of each record is its factor.

    Raises
    ------
    ValueError, TypeError
        If not exactly one of ``pga``, ``sa`` and ``spectrum`` is given, a number is out of range,
        or a record is not valid.

    Warns
    -----
    UserWarning
        If a factor is above 10 or below 0.1, so that the record hardly represents the wanted
        earthquake.

    Examples
    --------
    >>> import stochlin as sl
    >>> motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 10.0, paths=2)
    >>> suite = sl.scale_records({"a": motions[0], "b": motions[1]}, pga=3.0)
    >>> [round(float(abs(record).max()), 6) for record in suite.values()]
    [3.0, 3.0]
    """
    if not isinstance(records, Mapping) or not records:
        raise TypeError(f"records = {brief(records)}; allowed: a suite, as read_records gives it")
    check_goal({"pga": pga, "sa": sa, "spectrum": spectrum}, period)
    check_band(band)
    periods = np.geomspace(*band, BAND_POINTS) if sa is None else np.array([float(period or 0.0)])
    target = np.array([pga if sa is None else sa], float)
    if spectrum is None:
        refuse("the goal", "no spectrum", {"elastic": elastic, "divided_by": divided_by})
    else:
        checked_spectrum(spectrum)
        spectrum = as_elastic(spectrum, elastic, divided_by)
        periods_of_spectrum, values, damping = checked_spectrum(spectrum)
        shortest = periods_of_spectrum[periods_of_spectrum > 0][0]
        longest = periods_of_spectrum[-1]
        if not shortest <= band[0] < band[1] <= longest:
            raise ValueError(
                f"band = {brief(band)} is not within the spectrum; allowed: its periods"
            )
        target = interpolated(periods_of_spectrum, values, periods)
    suite = {}
    for name, record in records.items():
        acceleration, _ = checked_record(record)
        unscaled = np.abs(acceleration).max()
        if pga is None:
            unscaled = response_spectrum(record, periods, damping).pseudo_acceleration.to_numpy()
        factor = float(np.exp(np.mean(np.log(target / unscaled))))
        if warning := PLAUSIBLE["scale of a record"].doubt(factor):
            what = f"{plain(name)} is scaled by {factor:.3g}; {warning}"
            warnings.warn(what, DoubtfulInput, stacklevel=3)
        suite[name] = scaled_record(record, factor)
    return suite


def scaled_record(record: xr.DataArray, factor: float) -> xr.DataArray:
    """The record times a factor, which becomes its attribute ``scale``."""
    return (factor * record).assign_attrs(record.attrs, scale=factor)
