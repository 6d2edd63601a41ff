"""Structure-steps per second of a simulation, beside numpy over paths and OpenSeesPy, within one run.

A structure-step moves one structure on one motion by one step. OpenSeesPy is left out where it does
not load.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any
from unittest import mock

import numba as nb
import numpy as np
import scipy.linalg
from opensees_models import add_oscillators, new_model, opensees_or_none, shake

import stochlin as sl
from stochlin.analyses.simulation.connected_structures import connected_of
from stochlin.analyses.simulation.ensembles import SimulationRun, cells_of_all, prepare
from stochlin.analyses.simulation.run_lengths import with_length
from stochlin.kernels.basics.arrays import Array, zeros_on_a_line
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.simulation.ensemble import SAMPLES, Oscillators, stationary_sums
from stochlin.kernels.simulation.normal_numbers import fill_normal, generator_state
from stochlin.kernels.simulation.stepping import (
    LANES,
    FilterSteps,
    add_products,
    bilinear_block,
    ground_block,
)
from stochlin.kernels.simulation.time_step import multiply, steps_of
from stochlin.models.laws import LAWS
from stochlin.models.systems import arrangement_of

REPEATS = 5
SOIL = sl.KanaiTajimi(2.0, 0.05)
NUMPY_PATHS, NUMPY_STEPS = 2048, 400
OPENSEES_STEPS = 40_000
PASSES = 3  # that the slips of a step take, as a rule


def building(period: float) -> sl.Bilinear:
    return sl.Bilinear(period, damping=0.05, hardening=0.05, reduction_factor=4)


def ready(count: int, paths: int = 256) -> SimulationRun:
    """An ensemble of ``count`` structures, from half to twice the period of the ground."""
    structures = [building(period) for period in np.geomspace(1, 4, count)]
    cells = cells_of_all(structures, SOIL)
    return with_length(prepare(cells, SOIL, paths=paths, seed=0, steps_per_period=32), 20.0)


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
    with mock.patch("os.sched_getaffinity", return_value=range(threads), create=True):
        spent = seconds(lambda: stationary_sums(run.crowd, None, None))
    return count * lane_steps(run) / spent


def parts(count: int) -> dict[str, float]:
    """Seconds a structure-step of each part of a block, on one thread."""
    run = ready(count)
    steps = run.plan.every * SAMPLES
    random = generator_state(0, 0, LANES)
    xi, f = zeros_on_a_line(2, steps, LANES)
    q, state = zeros_on_a_line(len(run.crowd.root), LANES), zeros_on_a_line(4, count, LANES)
    out, total = zeros_on_a_line(SAMPLES, count, LANES), zeros_on_a_line(count, count, LANES)
    law, plan = oscillators(run), run.plan

    tasks: dict[str, Callable[[], object]] = {
        "random": lambda: fill_normal(random, xi),
        "ground": lambda: ground_block(run.crowd.ground)(xi, q, f),
        "dynamics": lambda: bilinear_block(f, plan.dt, law, *state, plan.every, out, 0),
        "moments": lambda: add_products(out, total),
    }
    times = {
        name: seconds(lambda task=task: [task() for _ in range(20)]) for name, task in tasks.items()
    }
    return {name: spent / (20 * count * steps * LANES) for name, spent in times.items()}


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
    cells = cells_of_all(structures, SOIL)
    setup = time.perf_counter() - begin
    begin = time.perf_counter()
    table = sl.simulate(structures, SOIL)
    spent = time.perf_counter() - begin
    steps = (table.attrs["recorded_s"] + table.attrs["burn_in_s"]) / table.attrs["step_s"]
    rate = count * table.attrs["paths"] * steps / (spent - setup)
    print(
        f"chart {count} x {count}: {spent:.1f} s, of which {setup:.2f} s before the first step; "
        f"{rate:.3g} structure-steps/s; {cells.valid.size} structures, {table.attrs['paths']} paths, "
        f"largest rho_standard_error {float(table.rho_standard_error.max()):.4f}"
    )


def numpy_storeys(building: sl.ShearBuilding, dt: float, rng: np.random.Generator) -> None:
    """The same building in plain numpy, vectorized over paths; slips by as many passes as they take."""
    elements = connected_of(arrangement_of([building]))[0][0].part.elements
    steps, n = steps_of(elements, dt), building.storeys
    q, v, z = np.zeros((3, n, NUMPY_PATHS))
    post, couple, uy, own = steps.spring.T[:, :, None]
    extensions = elements.system.extensions
    for _ in range(NUMPY_STEPS):
        f = 3 * rng.standard_normal(NUMPY_PATHS)
        known = np.concatenate([v, post * (extensions @ q) + couple * z])
        trial, slip = steps.move @ known + steps.push[:, None] * f, np.zeros((n, NUMPY_PATHS))
        for _ in range(PASSES):
            y = z + extensions @ (trial + steps.ease @ slip) - own * slip
            slip = (y - np.clip(y, -uy, uy)) / (1 - own)
        dq = trial + steps.ease @ slip
        q, z, v = q + dq, z + extensions @ dq - slip, 2 / dt * dq - v


def storeys() -> None:
    """Motions of 20 s of an 8- and a 5-storey building: how long, beside what the processor could do."""
    pair = [
        sl.ShearBuilding.regular(
            period=period,
            storeys=n,
            storey_height=height,
            mass=4e5,
            damping=0.05,
            hardening=0.05,
            base_shear_coefficient=0.15,
        )
        for period, n, height in ((0.8, 8, 3.2), (0.5, 5, 3.5))
    ]
    ground, paths, duration = sl.named_ground("firm", intensity=0.02), 2048, 20.0
    spent = seconds(lambda: sl.simulate(pair, ground, paths=paths, duration=duration), 3)
    dt = sl.simulate(pair, ground, paths=LANES, duration=1.0).attrs["step_s"]
    steps = paths * duration / dt
    rate = 13 * steps / spent
    rng = np.random.Generator(np.random.SFC64(0))
    plain = 8 * NUMPY_PATHS * NUMPY_STEPS / seconds(lambda: numpy_storeys(pair[0], dt, rng), 3)
    products = steps * sum(2 * n * n + (PASSES + 1) * n * n for n in (8, 5))
    print(
        f"storeys 8 + 5: {paths} motions of {duration:g} s in {spent:.2f} s, {rate:.3g} storey-steps/s, "
        f"{rate / plain:.0f} x numpy; {products / spent / 1e9:.2g}e9 products a second, of some "
        f"{products_a_second() / 1e9:.2g}e9 that a core makes in the same loop from its first cache"
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


def laws() -> None:
    """Oscillators and six storeys of all laws in motions of 15 s: storey-steps/s, over the bilinear."""
    given = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}
    worn = {"exponent": 1.5, "strength_decay": 0.02, "stiffness_decay": 0.05, "pinching": 0.9}
    capped = {"cap_ductility": 4.0, "softening": 0.2, "cracking": 0.4, "uncracked_stiffness": 2.5}
    ways: list[tuple[str, dict[str, float]]] = [
        *(("bilinear", {}), ("bouc_wen", {}), ("bouc_wen", {"exponent": 2.5})),
        *(("bouc_wen_baber_noori", worn), ("modified_clough", {}), ("modified_clough", capped)),
        ("flag", {}),
    ]
    regular = {"period": 0.6, "storeys": 6, "storey_height": 3.0, "mass": 1e5, "damping": 0.05}
    strong = {"hardening": 0.1, "base_shear_coefficient": 0.15}
    ground, paths, duration, first = sl.KanaiTajimi(0.4, 0.6, 0.02), 1024, 15.0, []
    print("law: storey-steps/s (over the bilinear law), one oscillator; six storeys")
    for law, own in ways:
        frame = sl.ShearBuilding.regular(**regular, **strong, law=law, law_parameters=own)
        rates = []
        for structure in (LAWS[law](**given, **own), frame):
            short = sl.simulate([structure], ground, paths=LANES, duration=1.0)
            steps = paths * duration / short.attrs["step_s"] * short.sizes.get("element", 1)
            spent = seconds(
                lambda one=structure: sl.simulate([one], ground, paths=paths, duration=duration), 3
            )
            rates.append(steps / spent)
        first = first or rates
        told = "; ".join(f"{r:.3g} ({r / one:.2f})" for r, one in zip(rates, first, strict=True))
        print(f"{law} {own or ''}: {told}", flush=True)


def products_a_second() -> float:
    """Of a matrix with rows of LANES numbers, as the storeys' kernel makes them, on one core."""
    matrix, x, count = np.ones((8, 16)), np.ones((24, LANES)), 20_000
    return matrix.size * LANES * count / seconds(lambda: _multiplied(matrix, x, count), 3)


@nb.njit
def _multiplied(matrix: Array, x: Array, count: int) -> None:
    for _ in range(count):
        for i in range(len(matrix)):
            multiply(matrix, i, x, 8, i, x.shape[1])


def main() -> None:
    """Print one table."""
    ops = opensees_or_none()
    opensees = opensees_rate(ops) if ops else np.nan
    print(f"{cores()} cores; rates in structure-steps/s; OpenSeesPy, a pair: {opensees:.3g}")
    print(
        f"{'structures':>10} {'dynamics':>9} {'1 thread':>9} {'2 threads':>9} {'numpy':>9} "
        f"{'x numpy':>8} {'x OpenSees':>10}   ns a structure-step, 1 thread"
    )
    for count in (2, 10, 60):
        shares = parts(count)
        one, two = ensemble_rate(count, 1), ensemble_rate(count, 2)
        plain = numpy_rate(count)
        told = ", ".join(f"{name} {1e9 * value:.2f}" for name, value in shares.items())
        dynamics = 1 / shares["dynamics"]
        print(
            f"{count:>10} {dynamics:9.3g} {one:9.3g} {two:9.3g} {plain:9.3g} {two / plain:8.0f} "
            f"{two / opensees:10.0f}   {told}",
            flush=True,
        )
    chart()
    storeys()
    modes()
    laws()


if __name__ == "__main__":
    main()
