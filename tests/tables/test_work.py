"""What asks for too much memory or time is refused before the work, with the number and cure."""

from collections.abc import Callable

import numpy as np
import pytest
import xarray as xr
from commands import refused

import stochlin as sl
from stochlin.solver.tables import checks
from stochlin.solver.tables.checks import check_work

pytestmark = pytest.mark.invariant

ONE, TWO = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3, mass=1e6) for T in (0.6, 1.0))
TINIEST = np.float64(1e-7)  # as of a scan
TINY = sl.Bilinear(np.float64(1e-6), 0.05, 0.05, reduction_factor=3, mass=1e6)
GROUND = sl.named_ground("firm", intensity=0.01)
STIFF = [
    sl.BoucWen(T, 0.05, 0.05, yield_displacement=0.01 * T**2, mass=1e6, exponent=1.0)
    for T in (1.0, TINIEST)
]
TIME = 0.01 * np.arange(2000)
RECORD = xr.DataArray(np.sin(TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"})


def axis(name: str, count: int) -> xr.DataArray:
    return xr.DataArray(np.linspace(0.2, 4, count), dims=name)


def table(method: str) -> xr.Dataset:
    first, second = (sl.Bilinear(axis(name, 40_000), 0.05) for name in ("one", "two"))
    return sl.correlate(first, second, GROUND, method)


ASKED: dict[str, Callable[[], xr.Dataset]] = {
    "pairs": lambda: table("linearization"),
    "pairs_white_noise": lambda: table("white_noise"),
    "rho_white_noise": lambda: sl.rho_white_noise(
        axis("one", 40_000), axis("two", 40_000), 0.05, 0.05
    ),
    "cells": lambda: sl.linearize(
        sl.Bilinear(axis("one", 40_000), axis("two", 40_000) / 5), GROUND
    ),
    "structures": lambda: sl.simulate([ONE] * 30_000, GROUND),
    "stationary_paths": lambda: sl.simulate([ONE], GROUND, paths=10**9),
    "finite_paths": lambda: sl.simulate([ONE], GROUND, paths=10**9, duration=20),
    "finite_duration": lambda: sl.simulate([ONE], GROUND, duration=1e12),
    "period": lambda: sl.separation(TINY, TWO, GROUND, 20.0),
    "duration": lambda: sl.existing_gap(ONE, TWO, GROUND, 0.05, duration=1e7),
    "paths": lambda: sl.existing_gap(ONE, TWO, GROUND, 0.05, duration=20.0, paths=10**9),
    "mitigated": lambda: sl.mitigate(ONE, TWO, GROUND, 0.05, {}, duration=1e7),
    "probability_paths": lambda: sl.pounding_probability(
        ONE, TWO, GROUND, 0.05, duration=20, paths=10**9
    ),
    "probability_duration": lambda: sl.pounding_probability(ONE, TWO, GROUND, 0.05, duration=1e6),
    "probability_period": lambda: sl.pounding_probability(TINY, TWO, GROUND, 0.05, duration=20),
    "transient": lambda: sl.transient_response(ONE, GROUND, 1e7),
    "records": lambda: sl.response_spectrum(RECORD, np.full(300_000, 1e-3), 0.05),
    "recorded_gap": lambda: sl.recorded_gap(
        sl.Bilinear(np.full(200_000, 1e-3), 0.05), sl.Bilinear(1.0, 0.05), RECORD
    ),
    "pound": lambda: sl.pound(STIFF, 0.05, sl.Kelvin(2e9, restitution=0.65), RECORD),
}


@pytest.mark.extreme
@pytest.mark.parametrize("asked", ASKED)
def test_too_much_is_refused_before_the_work(asked: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(checks, "_installed", lambda: 16e9)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1}, raising=False)
    with pytest.raises(
        ValueError, match=r"(GB; allowed: 8 GB|; allowed: 15 minutes on this machine); "
    ):
        ASKED[asked]()


def test_the_limit_is_half_of_the_machines_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "os.sysconf", lambda name: {"SC_PAGE_SIZE": 4096, "SC_PHYS_PAGES": 10**6}[name]
    )
    check_work("this takes", "take less", numbers=2.04e9 / 8, seconds=899)
    with pytest.raises(ValueError, match=r"^this takes 2\.1 GB; allowed: 2 GB; take less$"):
        check_work("this takes", "take less", numbers=2.06e9 / 8)

    def unknown(name: str) -> int:
        raise ValueError(name)

    monkeypatch.setattr("os.sysconf", unknown)  # as on Windows, where it is not there at all
    check_work("this takes", "take less", numbers=3.9e9 / 8)
    with pytest.raises(ValueError, match="allowed: 4 GB"):
        check_work("this takes", "take less", numbers=np.inf)


def test_time_is_in_hours() -> None:
    with pytest.raises(ValueError, match=r"this takes about 0\.27 hours; allowed: 15 minutes"):
        check_work("this takes", "take less", seconds=2 * 960, cores=2)
    with pytest.raises(ValueError, match="allowed: 15 minutes"):
        check_work("this takes", "take less", seconds=np.nan)


def test_tables_in_chunks_are_not_refused() -> None:
    dask = pytest.importorskip("dask")
    assert dask
    first, second = (sl.Bilinear(axis(n, 40_000).chunk(1000), 0.05) for n in ("one", "two"))
    assert sl.correlate(first, second, GROUND).rho.size == 40_000**2


def test_memory_that_is_not_there_is_said_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise MemoryError("Unable to allocate 74 GiB")

    monkeypatch.setattr("stochlin.solver.correlation.correlation.correlate", full)
    assert "this machine has too little memory (Unable to allocate 74 GiB); take" in refused(
        "rho", "--period-1", "1s", "--period-2", "2s"
    )
