"""Motions of the ground that several test files share: recorded ones, and made-up ones."""

from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.integrate import solve_ivp

import stochlin as sl

FOLDER = Path(__file__).parents[1].parent / "shared" / "records"
needs_records = pytest.mark.skipif(
    not FOLDER.is_dir(), reason="the folder of strong-motion records is absent"
)
RECORDS: dict[str, tuple[str, dict[str, Any]]] = {
    "SCT": ("sct190985.txt", {"units": "g", "column": 3, "time_column": 1}),
    "Taft": ("RSN15_KERN_TAF111.txt", {"units": "g", "dt": 0.01}),
    "El Centro": ("elc180.AT2", {}),
    "Kobe": ("NIS090.AT2", {"units": "g", "dt": 0.01}),
}


def recorded(name: str, **options: Any) -> xr.DataArray:
    """The record of this name; the options go before its own."""
    file, own = RECORDS[name]
    return sl.read_record(FOLDER / file, **own | options)


def suite(name: str) -> dict[str, xr.DataArray]:
    """Those records of the suites whose names start so."""
    records = sl.read_records(FOLDER / "suites.csv")
    return {label: record for label, record in records.items() if label.startswith(name)}


def motion(values: Any, dt: float = 0.02, start: float = 0.0, **attrs: Any) -> xr.DataArray:
    """Accelerations in equal steps of time."""
    values = np.asarray(values, float)
    time = start + dt * np.arange(values.size)
    return xr.DataArray(
        values, dims="time", coords={"time": time}, attrs={"units": "m/s^2"} | attrs
    )


def finer(record: xr.DataArray, parts: int) -> xr.DataArray:
    """The same motion with so many steps in each of the record's, which has a history as fine."""
    between = np.arange(parts * (record.size - 1) + 1) / parts
    dt = float(record.time[1] - record.time[0]) / parts
    return motion(np.interp(between, np.arange(record.size), record), dt)


def write_at2(record: xr.DataArray, path: Path) -> None:
    """The record as a file of the format PEER AT2."""
    dt = float(record.time[1] - record.time[0])
    head = ["a motion", "made", "IN UNITS OF G", f"NPTS= {record.size}, DT= {dt:.9g} SEC"]
    path.write_text("\n".join([*head, *(f"{each / 9.80665:.9E}" for each in record.values)]))


def smooth_noise(samples: int, seed: int = 0, width: int = 11, dt: float = 0.02) -> xr.DataArray:
    """Means of so many normal numbers, with the weights of a Hann window: noise of long periods."""
    noise = np.random.default_rng(seed).standard_normal(samples + width - 1)
    return motion(np.convolve(noise, np.hanning(width), mode="valid"), dt)


def shaking(
    samples: int = 400, seed: int = 0, size: float = 3.0, dt: float = 0.02, width: int = 15
) -> xr.DataArray:
    """Such noise under half a sine wave."""
    return (
        size * smooth_noise(samples, seed, width, dt) * np.sin(np.pi * np.arange(samples) / samples)
    )


def from_sample_to_sample(
    rates: Callable[..., Any],
    record: xr.DataArray,
    size: int,
    mend: Callable[[Any], Any] = lambda state: state,
    **options: Any,
) -> Any:
    """States (samples, size) from rest by scipy, which begins anew at each sample.

    ``rates(t, state, ground, slope)`` has the time since the sample, the acceleration of the ground
    there and its slope; a state is mended at the end of each interval.
    """
    dt, states = float(record.time[1] - record.time[0]), [np.zeros(size)]
    for begin, end in pairwise(record.to_numpy()):
        interval = {"args": (begin, (end - begin) / dt), **options}
        states.append(mend(solve_ivp(rates, (0, dt), states[-1], **interval).y[:, -1]))
    return np.array(states)
