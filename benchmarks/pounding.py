"""Seconds for a pounding pair of ten storeys in 60 s of motion, beside OpenSeesPy, within one run.

The time of OpenSeesPy depends on its step, and so does its error: both are told, and the ratio of times.
It is left out where it does not load.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import xarray as xr
from opensees_models import add_shear_building, new_model, opensees_or_none, shake

import stochlin as sl
from stochlin.kernels.basics.arrays import Array

STOREYS, MASS, DAMPING, HARDENING = 10, 2e5, 0.05, 0.05
GAP, BUMPER = 0.02, 1e9  # [m], [N/m]: a spring, since OpenSees loses its way with a dashpot in the gap
DT, DURATION = 0.01, 60.0
STEPS = (2e-3, 1e-3, 5e-4)  # of OpenSees [s]
REPEATS = 5


def building(stiffness: float, yields: bool) -> sl.ShearBuilding:
    law = {"hardening": HARDENING, "yield_drifts": 0.008} if yields else {}
    springs = np.linspace(1.5, 0.5, STOREYS) * stiffness
    return sl.ShearBuilding([MASS] * STOREYS, springs, [3.0] * STOREYS, DAMPING, **law)


def motion() -> xr.DataArray:
    """Coloured noise that comes and goes, at most some tenths of gravity."""
    samples = round(DURATION / DT) + 1
    noise = np.random.default_rng(0).standard_normal(samples + 32)
    smooth = np.convolve(noise, np.hanning(33), mode="valid")
    values = 3.5 * smooth / abs(smooth).max() * np.sin(np.pi * np.arange(samples) / (samples - 1))
    return xr.DataArray(values, dims="time", coords={"time": DT * np.arange(samples)})


def seconds(task: Callable[[], object]) -> float:
    """Median time of a task, the first run left out."""
    task()
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def opensees(ops: Any, pair: list[sl.ShearBuilding], record: Array, step: float) -> tuple[float, Array]:
    """Time of the analysis alone, one call for the motion, and the last displacements of the roofs."""
    new_model(ops)
    ops.uniaxialMaterial("ElasticPPGap", 1, BUMPER, -1e15, -GAP, 0.0)
    one, two = (add_shear_building(ops, 100 * b, each) for b, each in enumerate(pair, start=1))
    for i, sides in enumerate(zip(one, two, strict=True)):
        ops.element("zeroLength", 50_000 + i, *sides, "-mat", 1, "-dir", 1)
    shake(ops, record, DT, ("NormDispIncr", 1e-10, 50), "RCM", "BandGeneral")
    roofs = np.zeros(2)
    begin = time.perf_counter()
    if ops.analyze(round(DURATION / step), step) != 0:
        raise RuntimeError("OpenSees did not converge")
    spent = time.perf_counter() - begin
    roofs[:] = [ops.nodeDisp(100 * (b + 1) + STOREYS, 1) for b in range(2)]
    return spent, roofs


def main() -> None:
    """Print one table."""
    ops, record = opensees_or_none(), motion()
    contact = sl.LinearSpring(BUMPER)
    print(f"two buildings of {STOREYS} storeys, {DURATION:g} s at {DT:g} s")
    for yields in (False, True):
        pair = [building(3e8, yields), building(5e8, yields)]
        table = sl.pound(pair, GAP, contact, record)
        spent = seconds(lambda pair=pair: sl.pound(pair, GAP, contact, record))
        print(
            f"{'yielding' if yields else 'elastic':>8}: {spent:.3f} s with and without pounding, "
            f"{table.attrs['steps']} steps, {table.sizes['impact']} impacts, energy balance "
            f"{float(table.energy_balance_error.max()):.1e}",
            flush=True,
        )
        last = table.displacement.isel(time=-1, floor=-1).to_numpy()
        size = float(table.peak.isel(floor=-1).max())
        for step in STEPS if ops else ():
            theirs, roofs = opensees(ops, pair, record.to_numpy(), step)
            error = float(abs(roofs - last).max()) / size
            print(
                f"{'':>8}  OpenSeesPy at {step:g} s: {theirs:.2f} s, {theirs / spent:.0f} times that; "
                f"it ends {error:.1e} of the peak away",
                flush=True,
            )


if __name__ == "__main__":
    main()
