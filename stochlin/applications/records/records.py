"""Strong-motion records: reading a record as a labelled array, and its strong part."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator, Sequence
from typing import Annotated

import numpy as np
import numpy.typing as npt
import xarray as xr
from scipy import constants

from stochlin.applications.records.columns import TIME_TOLERANCE
from stochlin.applications.records.components import VAGUE, FileNames, identifies, is_vertical
from stochlin.applications.records.files import chosen, read_channels
from stochlin.applications.records.formats import Series
from stochlin.applications.sheets.columns import ColumnName
from stochlin.kernels.basics.arrays import Array
from stochlin.messages import DoubtfulInput, brief
from stochlin.models.arguments import Seconds, Truth, Whole, checked, is_number
from stochlin.models.parameters import Range
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.units import size_of, stated_size
from stochlin.solver.tables import labels

MINIMUM_SAMPLES = 16

# Relative difference of two time steps that may come from rounding: 1/128 s is printed 0.0078.
_STEP_TOLERANCE = 2e-3
_CURE = "correct it, or leave it out"
_IN_BUILDING = re.compile(
    r"\b(?:roof|floor|stor(?:e?y|ies)|azotea|techo|piso|dach|toit|tetto)\b", re.IGNORECASE
)
ENDING_OF_RECORD = 1.0  # s, the last part of a record
LENGTH_IN_ENDINGS = 4.5  # times as long is a record that is judged by it
SAME_SHAPE = 1e-3  # difference over the peak, of digits that are left out in files
SHORTEST_STEP = 1e-6  # s, of a file
# Of any record, with room for all numbers of a response: of structures with periods from 1e-9 to
# 1e9 s displacements are below 1e60 m, and the squares of their squares below the largest number,
# 1e308.
LARGEST_ACCELERATION = 1e9  # m/s^2
TIME_STEPS = Range(1e-9, 1e9, include_lower=True, include_upper=True)  # s


@checked
def read_record(
    path: str | os.PathLike[str],
    *,
    dt: Seconds | None = None,
    units: str | None = None,
    column: ColumnName | None = None,
    time_column: ColumnName | None = None,
    component: ColumnName | None = None,
    wrapped: Truth = False,
    skip: Annotated[int, Whole(0)] = 0,
) -> xr.DataArray:
    r"""Read a strong-motion record.

    Formats are recognized by their header, which states time step and units: PEER AT2
    (``NPTS=  5372, DT=   .0100 SEC`` or ``4096    0.0100    NPTS, DT``), CSMIP Volume 2 (``.V2``),
    COSMOS 1.20 (``.V2c``), K-NET and KiK-net, the Engineering Strong Motion database (ESM), and the
    standard file of UNAM and other Mexican networks. A file with columns of text, separated by
    comma, semicolon or white space, may begin with two lines of titles, a row of names and a row of
    units. It states the time step only in a first row of the number of samples and it, such as
    ``1559 0.02``, and the units only in a name such as ``acc [g]``. Between semicolons or tabs
    numbers may have decimal commas. A line that begins with ``#`` or ``%``, and what follows them
    beside numbers, is a comment. Missing information is never guessed.

    Parameters
    ----------
    path : str or path
        Path of the file, text in UTF-8, also compressed by gzip: a regular file of at most 64 MiB
        and two million lines.
    dt : float, optional
        Time step [s], positive. Not needed if the header states it or a column has the time.
    units : str, optional
        Units of the numbers in the file, such as ``"g"``, ``"m/s^2"``, ``"gal"`` or ``"in/s^2"``.
        Not needed if the file states them.
    column, time_column : int or str, optional
        Columns of the acceleration and of the time, in seconds if its name has no other unit, each
        by its number from 1 or by its name, also without its unit. They are not needed where one
        name says so, or one column alone remains; of columns without names, that which rises by
        equal steps is the time. Dates such as ``2020-01-31T23:59:59.98`` are read as seconds from
        the first.
    component : int or str, optional
        Component of a file that holds several, by its name there, such as ``"N00E"``, or by its
        number from 1. A file of one component that states another name is refused; of one that
        states none it becomes the attribute of this name.
    wrapped : bool
        Whether all numbers of a file without a known header are one series, written in rows.
    skip : int
        Number of lines at the beginning of such a file that are left out.

    Returns
    -------
    xarray.DataArray
        Ground acceleration [m/s^2] with the dimension ``time`` [s], named ``acceleration``. The
        attributes ``source`` and ``dt`` hold the file name and the time step; ``event``,
        ``station`` and ``component`` are those that the header states, and ``columns`` has those
        that were asked for by number; the name of a region, without a date or a number, is no
        event. The mean is subtracted from records that are not corrected for their baseline: those
        of K-NET and KiK-net, and of ESM where the header says so. The attribute ``comment`` then
        states it.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If the time step, the units, a column or a component are missing, unknown or contradict the
        file; if a column is another quantity, such as a velocity; if a header or its number of
        samples is not that of its format; if the file has text, NaN or infinity among its numbers
        (the message names the line), lines of unequal length, a time that does not increase or has
        a gap, fewer than 16 samples or only zeros.

    Warns
    -----
    UserWarning
        If the record is implausible: a peak below 0.02 g or above 1.5 g, a time step of more than
        0.05 s, a duration of more than 600 s, a velocity that no acceleration without an offset
        gives, one of several columns without names that may be rows of one series, or a vertical
        component.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> import stochlin as sl
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "record.csv"
    >>> lines = [f"{0.02 * i:.2f},{100 * (-1) ** i}" for i in range(100)]
    >>> _ = path.write_text("time,north\n" + "\n".join(lines), encoding="utf-8")
    >>> record = sl.read_record(path, units="gal")
    >>> record.sizes["time"], record.attrs["dt"], float(record.max())
    (100, 0.02, 1.0)
    """
    name, channels = read_channels(path, column, time_column, wrapped, skip)
    return recorded(chosen(channels, component, name), name, dt, units, alone=True)


def recorded(
    series: Series, name: str, dt: float | None, units: str | None, alone: bool
) -> xr.DataArray:
    """The record of a component of this source, with a warning where it is implausible.

    One that is read ``alone`` is also doubted if it is vertical.
    """
    record = _labelled(series, name, dt, units)
    for warning in (
        *_doubts(record, series),
        *(_doubt_of_direction(series, name) if alone else ()),
    ):
        warnings.warn(f"{name}: {warning}", DoubtfulInput, stacklevel=4)
    return record


def doubts_of_motion(acceleration: Array, step: float) -> Iterator[str]:
    """Texts on a record that is implausible, of these samples [m/s^2] and time step [s]."""
    peak = float(np.abs(acceleration).max())
    duration = step * acceleration.size
    velocity = float(np.abs(step * np.cumsum(acceleration)).max())
    alone = _peak_over_others(np.abs(acceleration))
    # Of what follows from one mistake the first is said.
    for of, value, shown in (
        (
            "peak over other samples",
            alone,
            f"its peak, {peak:.4g} m/s^2, is {alone:.3g} times the next",
        ),
        ("peak of a record", peak, f"its peak is {peak / constants.g:.4g} g"),
        ("time step of a record", step, f"its time step is {step:.6g} s"),
        ("duration", duration, f"its duration is {duration:.6g} s"),
        ("velocity of a record", velocity, f"its velocity reaches {velocity:.3g} m/s"),
        (
            "velocity over acceleration of a record",
            velocity / peak,
            f"its largest velocity is {velocity / peak:.3g} s times its peak",
        ),
    ):
        if text := PLAUSIBLE[of].doubt(value):
            yield f"{shown}; {text}"
            return


def _peak_over_others(magnitude: Array) -> float:
    """The largest sample over those neither equal nor next to it; 1 unless it stands alone."""
    largest = magnitude == magnitude.max()
    near = np.convolve(largest, [1, 1, 1], "same") > 0
    others = magnitude[~near].max(initial=0.0)
    side_by_side = bool((largest[1:] & largest[:-1]).any())
    return 1.0 if side_by_side or others == 0 else float(magnitude.max() / others)


def copies(motions: Sequence[Array]) -> Iterator[tuple[int, int]]:
    """Numbers of two motions that differ by a factor alone, the first and each later one."""
    for later, motion in enumerate(motions):
        alike = (n for n, other in enumerate(motions[:later]) if _same_shape(motion, other))
        if (first := next(alike, None)) is not None:
            yield first, later


def _same_shape(motion: Array, other: Array) -> bool:
    """Whether a motion is another one times a factor, by least squares."""
    if motion.size != other.size:
        return False
    factor = (motion @ other) / (other @ other)
    return bool(np.abs(motion - factor * other).max() < SAME_SHAPE * np.abs(motion).max())


def _doubts(record: xr.DataArray, series: Series) -> Iterator[str]:
    """Texts of warnings on an implausible record, each as a question."""
    yield from doubts_of_motion(record.to_numpy(), record.attrs["dt"])
    samples = np.abs(record.to_numpy())
    last = max(1, round(ENDING_OF_RECORD / record.attrs["dt"]))
    ratio = (
        float(samples[-last:].max() / samples.max())
        if samples.size >= LENGTH_IN_ENDINGS * last
        else 0.0
    )
    if text := PLAUSIBLE["last second over the peak"].doubt(ratio):
        yield f"its last second reaches {ratio:.2g} of its peak; {text}"
    if series.rows:
        yield f"its {series.rows} columns may be rows of one series; is it one, with wrapped=True?"


def _doubt_of_direction(series: Series, name: str) -> Iterator[str]:
    """Texts on a record that is vertical, or not of the ground."""
    component = series.about.get("component", "")
    in_name = FileNames([name]).component(name)
    clear_name = in_name if in_name and in_name.weight > VAGUE else None
    if is_vertical(component, series.title, clear_name):
        which = brief(component or series.title or name)
        yield (
            f"{which} is vertical, and gaps follow from horizontal components; is it the right one?"
        )
    if _IN_BUILDING.search(series.title):
        yield f"{brief(series.title)} may be the motion of a building; is it that of the ground?"


def strong_samples(motions: Array, start: float = 0.05, end: float = 0.95) -> tuple[Array, Array]:
    """Numbers of the first and last samples of the `strong_part` of motions (..., times)."""
    energy = np.cumsum(motions**2, axis=-1)
    first = (energy < start * energy[..., -1:]).sum(axis=-1)
    last = (energy < end * energy[..., -1:]).sum(axis=-1)
    return first, last


def strong_part(record: xr.DataArray, start: float = 0.05, end: float = 0.95) -> xr.DataArray:
    """Part of a record between two fractions of its Arias intensity, 0 <= start < end <= 1.

    Samples [m/s^2] over their ``time`` in the record; the attribute ``energy_part`` names the
    fractions (Trifunac and Brady, 1975, Bull. Seismol. Soc. Am. 65). Raises a ValueError if they
    are out of range.
    """
    values, _ = checked_record(record)
    if not (is_number(start) and is_number(end) and 0 <= start < end <= 1):
        raise ValueError(
            f"start, end = {brief(start)}, {brief(end)}; allowed: 0 <= start < end <= 1"
        )
    first, last = strong_samples(values, start, end)
    part = record.isel(time=slice(int(first), int(last) + 1))
    part.attrs = dict(record.attrs) | {"energy_part": f"{100 * start:g}-{100 * end:g} %"}
    return part


def checked_array(array: xr.DataArray, role: str, dim: str) -> tuple[Array, Array]:
    """Coordinate and accelerations [m/s^2] of an array of one dimension, checked; raises errors."""
    if not isinstance(array, xr.DataArray):
        raise TypeError(f"{role} is a {type(array).__name__}; allowed: an xarray.DataArray")
    if array.dims != (dim,) or dim not in array.coords:
        raise ValueError(
            f"{role} has the dimensions {array.dims}; allowed: {dim} with its coordinate"
        )
    if "units" not in array.attrs:
        cure = '.assign_attrs(units="m/s^2"), if it is so'
        raise ValueError(f"{role} has no attribute units; allowed: m/s^2, stated by {cure}")
    units = array.attrs["units"]
    if size_of(str(units), "m/s^2") != 1:
        cure = "so convert its values, and state it there"
        raise ValueError(f"{role} has the attribute units {brief(units)}; allowed: m/s^2, {cure}")
    if not {array.dtype.kind, array[dim].dtype.kind} <= set("iuf"):
        dated = array[dim].dtype.kind in "mM"
        cure = f"; write ({dim} - {dim}[0]) / np.timedelta64(1, 's')" if dated else ""
        raise TypeError(f"{role} is {array.dtype} over {array[dim].dtype}; allowed: numbers{cure}")
    return array[dim].to_numpy().astype(float), array.to_numpy().astype(float)


def checked_record(
    record: xr.DataArray, may_be_still: bool = False
) -> tuple[npt.NDArray[np.float64], float]:
    """Values [m/s^2] and time step [s] of a record, checked.

    A record is a DataArray over an evenly spaced ``time`` [s], with the attribute ``units`` m/s^2,
    and with at least 16 finite samples that are not all zero, of at most 1e9 m/s^2, and a time step
    from 1e-9 to 1e9 s. Otherwise a TypeError or ValueError is raised. A ground that
    ``may_be_still`` has zeros alone.
    """
    time, values = checked_array(record, "record", "time")
    if values.size < MINIMUM_SAMPLES:
        raise ValueError(f"record has {values.size} samples; allowed: at least {MINIMUM_SAMPLES}")
    if not np.isfinite(values).all():
        i = int(np.argmin(np.isfinite(values)))
        raise ValueError(f"record is {values[i]} at {time[i]:g} s; allowed: finite values")
    if not (may_be_still or values.any()):
        raise ValueError(
            "record holds only zeros; allowed: some motion, so check which column it is"
        )
    i = int(np.argmax(np.abs(values)))
    if np.abs(values[i]) > LARGEST_ACCELERATION:
        what = f"record is {values[i]:.3g} m/s^2 at {time[i]:g} s"
        raise ValueError(f"{what}; allowed: at most {LARGEST_ACCELERATION:.0e} m/s^2 in magnitude")
    step = _time_step(time)
    if not TIME_STEPS.contains(step):
        raise ValueError(f"the time step of record is {step:g} s; allowed: {TIME_STEPS}")
    return values, step


def _labelled(series: Series, name: str, dt: float | None, units: str | None) -> xr.DataArray:
    size = stated_size("acceleration", series.units or "", units, name)
    if dt and series.dt and not np.isclose(dt, series.dt, rtol=_STEP_TOLERANCE, atol=0):
        raise ValueError(f"dt = {dt:g} contradicts {name}, which states {series.dt:g}; {_CURE}")
    step = dt or series.dt
    start = 0.0
    if series.time is not None and (series.timed or step is None):
        step = _time_step(series.time, step, f"{name}: time")
        start = float(series.time[0])
    elif series.time is not None and step is not None:
        _check_step(step, float(np.mean(np.diff(series.time))))
    if step is None:
        raise ValueError(f"dt is missing and {name} does not state it; give dt= or time_column=")
    if not step >= SHORTEST_STEP:
        raise ValueError(
            f"the time step of {name} is {step:g} s; allowed: {SHORTEST_STEP:g} s or more"
        )
    time = start + step * np.arange(series.values.size)
    about = {key: " ".join(text.split()) for key, text in series.about.items() if text}
    if not identifies(about.get("event", "")):  # a region, which has many earthquakes
        about.pop("event", None)
    record = xr.DataArray(
        series.values * size,
        coords=[labels.axis("time", "time", time, "s")],
        name="acceleration",
        attrs={"units": "m/s^2", "long_name": "ground acceleration", "source": name, "dt": step}
        | about,
    )
    checked_record(record)
    return record


def _time_step(time: npt.NDArray[np.float64], dt: float | None = None, of: str = "time") -> float:
    """Step of an evenly spaced time [s] of this name, ``dt`` if this is given and agrees."""
    steps = np.diff(time)
    if not steps.size or not np.isfinite(time).all():
        raise ValueError(f"{of} is not a series of finite numbers; allowed: increasing, in seconds")
    if steps.min() <= 0:
        i = int(np.argmax(steps <= 0))
        between = f"{time[i]:.9g} s is followed by {time[i + 1]:.9g} s"
        raise ValueError(f"{of} does not increase: {between}; take out what repeats or sums up")
    # Rounded to twelve digits, the mean step of printed times is 0.02, not 0.019999999999999997.
    step = float(f"{(time[-1] - time[0]) / steps.size:.12g}")
    if dt is not None:
        _check_step(dt, step)
    if (np.abs(time - time[0] - step * np.arange(time.size)) > TIME_TOLERANCE * step).any():
        i = int(np.argmax(np.abs(steps - np.median(steps))))
        between = f"{time[i]:.9g} s is followed by {time[i + 1]:.9g} s"
        raise ValueError(f"{of} is uneven: {between}; fill a gap, or resample the record evenly")
    return dt or step


def _check_step(dt: float, of_time: float) -> None:
    if not np.isclose(dt, of_time, rtol=_STEP_TOLERANCE, atol=0):
        raise ValueError(
            f"dt = {dt:g} contradicts the time, whose step is {of_time:.6g} s; {_CURE}"
        )
