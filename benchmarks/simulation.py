"""Structure-steps per second of a simulation, beside numpy over paths and OpenSeesPy, within one run.

A structure-step moves one structure on one motion by one step. OpenSeesPy is left out where it does
not load.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any
from unittest import mock

import numpy as np
import scipy.linalg
from opensees_models import add_oscillators, new_model, opensees_or_none, shake

import stochlin as sl
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.simulation.ensemble import SAMPLES, Oscillators, stationary_sums
from stochlin.kernels.simulation.stepping import (
    LANES,
    FilterSteps,
)
from stochlin.solver.simulation.ensembles import SimulationRun
from stochlin.solver.simulation.stationary_motions import with_length
from stochlin.solver.simulation.structures_in_motion import structures_in_motion

REPEATS = 5
SOIL = sl.KanaiTajimi(2.0, 0.05)
NUMPY_PATHS, NUMPY_STEPS = 2048, 400
OPENSEES_STEPS = 40_000


def building(period: float) -> sl.Bilinear:
    return sl.Bilinear(period, damping=0.05, hardening=0.05, reduction_factor=4)


def ready(count: int, paths: int = 256) -> SimulationRun:
    """An ensemble of ``count`` structures, from half to twice the period of the ground."""
    structures = [building(period) for period in np.geomspace(1, 4, count)]
    moving = structures_in_motion(structures, SOIL, None, stationary=True)
    return with_length(moving.run(SOIL, paths=paths, seed=0, steps_per_period=32), 20.0)


def oscillators(run: SimulationRun) -> Array:
    """Parameters of the structures, which are of one law."""
    (part,) = run.crowd.parts
    assert isinstance(part, Oscillators)
    return part.parameters


def seconds(task: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median time of a task, the first run left out."""
    task()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return float(np.median(times))


def lane_steps(run: SimulationRun) -> int:
    plan = run.plan
    return plan.groups * LANES * plan.every * SAMPLES * (plan.burn_in + plan.recorded)


def ensemble_rate(count: int, threads: int) -> float:
    """All of it: random numbers, ground, structures, moments."""
    run = ready(count)
    rows = run.rows(np.eye(count))
    with mock.patch("os.sched_getaffinity", return_value=range(threads), create=True):
        spent = seconds(lambda: stationary_sums(run.crowd, rows, None))
    return count * lane_steps(run) / spent


def numpy_loop(ground: FilterSteps, dt: float, law: Array, rng: np.random.Generator) -> None:
    """The same steps in plain numpy, vectorized over paths and structures."""
    d, k, h, scale = law.T[:, :, None]
    half = 0.5 * dt
    u, v, z = np.zeros((3, len(law), NUMPY_PATHS))
    q = np.zeros((len(ground.gain), NUMPY_PATHS))
    elastic = 1 / (1 + half * d + half**2 * (k + h))
    plastic = 1 / (1 + half * d + half**2 * k)
    for _ in range(NUMPY_STEPS):
        xi = rng.standard_normal(NUMPY_PATHS)
        f = ground.row @ q + ground.direct * xi
        q = ground.transition @ q + ground.gain[:, None] * xi
        base = v * (1 - half * d - half**2 * k) + dt * scale * f - dt * k * u
        v_new = (base - dt * h * z - half**2 * h * v) * elastic
        z_new = z + half * (v + v_new)
        limit = np.clip(z_new, -1, 1)
        v_new = np.where(limit != z_new, (base - half * h * (z + limit)) * plastic, v_new)
        u += half * (v + v_new)
        v, z = v_new, limit


def numpy_rate(count: int) -> float:
    run = ready(count)
    rng = np.random.Generator(np.random.SFC64(0))
    spent = seconds(lambda: numpy_loop(run.crowd.ground, run.plan.dt, oscillators(run), rng), 3)
    return count * NUMPY_PATHS * NUMPY_STEPS / spent


def opensees_rate(ops: Any) -> float:
    """A pair of Steel01 springs with dashpots, one call for the whole motion."""
    dt = 1 / 32
    motion = 3 * np.random.default_rng(0).standard_normal(OPENSEES_STEPS + 1)

    def build() -> None:
        new_model(ops)
        add_oscillators(ops, (1.0, 2.0), (1.0, 1.0), (0.02, 0.02), 0.05, 0.05)
        shake(ops, motion, dt, ("NormUnbalance", 1e-9, 20))

    times = []
    for _ in range(REPEATS):
        build()
        begin = time.perf_counter()
        if ops.analyze(OPENSEES_STEPS, dt) != 0:
            raise RuntimeError("OpenSees did not converge")
        times.append(time.perf_counter() - begin)
    ops.wipe()
    return 2 * OPENSEES_STEPS / float(np.median(times))


def chart(count: int = 60) -> None:
    """A square chart of rho: one run gives every pair."""
    structures = [building(period) for period in np.geomspace(0.5, 8, count)]
    begin = time.perf_counter()
    table = sl.simulate(structures, SOIL)
    spent = time.perf_counter() - begin
    print(
        f"chart {count} x {count}: {spent:.1f} s; {table.attrs['paths']} paths, "
        f"largest rho_standard_error {float(table.rho_standard_error.max()):.4f}"
    )


def modes(storeys: int = 10) -> None:
    """A building by its modes, in the time of a chain of as many storeys, both yielding, in one run."""
    chain = sl.ShearBuilding.regular(
        period=1.0, storeys=storeys, storey_height=3.2, mass=4e5, damping=0.05, hardening=0.05,
        base_shear_coefficient=0.15,
    )  # fmt: skip
    springs, system = chain.oscillator(), chain.system()
    squares, vectors = scipy.linalg.eigh(system.stiffness, np.diag(system.mass))
    ground = sl.named_ground("firm", intensity=0.02)
    motions = sl.simulated_motions(ground, 20.0, paths=100)
    low = sl.ShearBuilding([4e5] * 5, [8e8] * 5, [3.2] * 5, 0.05)
    contact = sl.Kelvin(1e9, restitution=0.65)

    def times(building: sl.ShearBuilding | sl.ModalBuilding) -> Array:
        simulated = seconds(lambda: sl.simulate([building], ground, paths=1024, duration=20.0), 3)
        pounded = seconds(lambda: sl.pound([building, low], 0.05, contact, motions), 3)
        return np.array([simulated, pounded])

    of_chain = times(chain)
    for count in (3, storeys):
        by_modes = sl.ModalBuilding(
            2 * np.pi / np.sqrt(squares[:count]),
            vectors.T[:count],
            chain.masses,
            chain.heights,
            0.05,
            springs.hardening,
            springs.yield_displacement,
        )
        ratios = times(by_modes) / of_chain
        print(
            f"{count} modes of {storeys} storeys in the time of the chain: simulate, 1024 motions, "
            f"{ratios[0]:.2f}; pound with five storeys, 100 motions, {ratios[1]:.2f} "
            f"(chain {of_chain[0]:.2f} and {of_chain[1]:.2f} s)"
        )


def main() -> None:
    """Print one table."""
    ops = opensees_or_none()
    opensees = opensees_rate(ops) if ops else np.nan
    print(f"{cores()} cores; rates in structure-steps/s; OpenSeesPy, a pair: {opensees:.3g}")
    print(
        f"{'structures':>10} {'1 thread':>9} {'2 threads':>9} {'numpy':>9} {'x numpy':>8} "
        f"{'x OpenSees':>10}"
    )
    for count in (2, 10, 60):
        one, two = ensemble_rate(count, 1), ensemble_rate(count, 2)
        plain = numpy_rate(count)
        print(
            f"{count:>10} {one:9.3g} {two:9.3g} {plain:9.3g} {two / plain:8.0f} {two / opensees:10.0f}",
            flush=True,
        )
    chart()
    modes()


if __name__ == "__main__":
    main()
