"""Seconds of one unit of each kind of work, beside those by which work that takes too long is refused.

There is a calculation for each kind, in which it takes much of the time. The seconds of one core are
those with which the units that all calculations announce before they start explain their times. Run it
with OPENBLAS_NUM_THREADS=1, since the products of matrices are not spread over cores.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from unittest import mock

import numpy as np
import xarray as xr
from scipy.optimize import nnls

import stochlin as sl
from stochlin.analyses.tables import work
from stochlin.kernels.basics.parallel import cores

REPEATS = 3
GROUND = sl.named_ground("firm", intensity=0.01)
CONTACT = sl.Kelvin(1e9, restitution=0.65)


def bilinear(period: float | np.ndarray) -> sl.Bilinear:
    return sl.Bilinear(period, 0.05, 0.05, yield_displacement=0.02, mass=1e6)


def storeys(count: int) -> sl.ShearBuilding:
    return sl.ShearBuilding.regular(
        period=0.1 * count, storeys=count, storey_height=3.0, mass=1e5 * count, damping=0.05,
        hardening=0.05, base_shear_coefficient=0.1,
    )  # fmt: skip


def motions(duration: float, paths: int) -> xr.DataArray:
    return sl.simulated_motions(GROUND, duration, paths=paths)


PAIR = bilinear(0.6), bilinear(1.0)
ROW, RECORD = motions(20.0, 64), motions(60.0, 2)[0]
LINKED = sl.Link(0, 2e6, damping_exponent=0.3)
SMOOTH = sl.BoucWen(1.0, 0.05, 0.05, yield_displacement=0.02, exponent=1.0)
WORK: dict[str, Callable[[], object]] = {
    "steps of a ground": lambda: sl.simulate([PAIR[1]], GROUND, duration=50, paths=50_000),
    "steps of a bilinear structure": lambda: sl.simulate(
        [sl.Bilinear(T, 0.05) for T in np.linspace(0.5, 1, 60)], GROUND, paths=2000, steps_per_period=256
    ),
    "steps of another law": lambda: sl.simulate([SMOOTH], GROUND, duration=50, paths=4000),
    "steps of a dashpot": lambda: sl.simulate(list(PAIR), GROUND, link=LINKED, duration=50, paths=500),
    "steps of a pair of storeys": lambda: sl.simulate([storeys(40)], GROUND, duration=20, paths=64),
    "steps of a recorded distance": lambda: sl.simulate([PAIR[1]] * 40, GROUND, duration=20, paths=500),
    "steps of a distance to gaps": lambda: sl.pounding_probability(
        *PAIR, GROUND, 0.05, duration=50, paths=20_000
    ),
    "sub-steps on a record": lambda: sl.response_spectrum(
        RECORD, np.geomspace(0.05, 4, 5000), 0.05, hardening=0.05, yield_displacement=0.02
    ),
    "steps of a floor on a record": lambda: sl.respond(storeys(10), RECORD),
    "steps of a row": lambda: sl.pound(PAIR, 0.02, CONTACT, RECORD),
    "operations in a row": lambda: sl.pound([storeys(20), storeys(10)], 0.02, CONTACT, ROW),
    "systems": lambda: sl.linearize_system([bilinear(np.linspace(0.3, 2, 300)), PAIR[1]], GROUND),
    "cubes of states": lambda: sl.linearize_system([storeys(40), storeys(20)], GROUND),
    "instants of a motion": lambda: sl.transient_response(PAIR[0], GROUND, 200.0),
    "cubes of states in motion": lambda: sl.pounding_probability(
        storeys(20), storeys(16), GROUND, 0.1, duration=20, paths=64
    ),
}


def announced(task: Callable[[], object]) -> dict[str, float]:
    """The units of each kind, for one core, that a calculation announces."""
    units: dict[str, float] = {}
    cost_of = work.cost_of

    def noted(kinds: Mapping[str, float], count: int = 1) -> dict[str, float]:
        for kind, number in kinds.items():
            units[kind] = units.get(kind, 0.0) + number / count
        return cost_of(kinds, count)

    with mock.patch.object(work, "cost_of", noted):
        task()
    return units


def seconds(task: Callable[[], object]) -> float:
    """Shortest time of several runs."""
    times = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> None:
    kinds, units, times = list(WORK), [], []
    for task in WORK.values():
        counts = announced(task)  # which also compiles
        units.append([counts.get(kind, 0.0) for kind in kinds])
        times.append(seconds(task))
    measured, _ = nnls(np.array(units) / np.array(times)[:, None], np.ones(len(times)))
    print(f"{cores()} cores\n{'kind':32} {'table':>10} {'measured':>10} {'ratio':>7} {'seconds':>8}")
    for kind, cost, took in zip(kinds, measured, times, strict=True):
        listed = work.COSTS[kind][0]
        print(f"{kind:32} {listed:10.2g} {cost:10.2g} {cost / listed:7.2f} {took:8.2f}")


if __name__ == "__main__":
    main()
