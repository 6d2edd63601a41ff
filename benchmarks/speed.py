"""CPU seconds of tables, single pairs and closures: `python benchmarks/speed.py [CHECKOUT ...]`.

Without a CHECKOUT the jobs run by this installation and beside other ways to the same numbers. With
folders of other versions of the repository, each version has a process of its own, and the last
column is the ratio of the first to the last. Every repetition takes all jobs in turn, so that a
machine that becomes slower or faster meanwhile favours none; the table shows the least time of
each. Takes a minute for each version.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import xarray as xr
from scipy.linalg import solve_continuous_lyapunov

import stochlin as sl
from stochlin.kernels.correlation.bilinear_pair import linearized_pair
from stochlin.kernels.linearization.gaussian import gaussian

try:
    from control import lyap
except ImportError:
    lyap = None

REPETITIONS = 5
SIDE, MANY, BESIDE = 2000, 100_000, 20_000
NUMBERS = (1.0, 0.05, 0.05, 0.02), (0.7, 0.05, 0.05, 0.01), (0.01, 2.0, 0.3)
GROUND = sl.KanaiTajimi(2.0, 0.3, 0.01)
PAIR = tuple(sl.Bilinear(*numbers) for numbers in NUMBERS[:2])
QUAKE = {"duration": 30.0, "envelope": sl.AminAng(4.0, 15.0, 0.35)}
FIRST_TABLE = (
    "import numpy as np, stochlin as sl\n"
    "common = {'damping': 0.05, 'hardening': 0.05, 'reduction_factor': 4}\n"
    "first, second = (sl.Bilinear(np.linspace(0.2, 4, 50), **common) for _ in range(2))\n"
    "sl.correlate(first, second, sl.KanaiTajimi(2.0, 0.3)).rho.values\n"
)


def structures(count, dim, seed):
    """Random yielding structures."""
    draw = np.random.default_rng(seed).uniform
    low, high = np.log([[0.1, 0.01, 0.02, 0.5], [5.0, 0.2, 0.5, 10.0]])
    period, damping, hardening, factor = np.exp(draw(low[:, None], high[:, None], (4, count)))
    rows = (xr.DataArray(row, dims=dim) for row in (period, damping, hardening))
    return sl.Bilinear(*rows, reduction_factor=xr.DataArray(factor, dims=dim))


def first_table():
    """From an empty cache, with the import."""
    with tempfile.TemporaryDirectory() as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        environment = os.environ | {"NUMBA_CACHE_DIR": folder}
        subprocess.run([sys.executable, "-c", FIRST_TABLE], check=True, env=environment)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def table_jobs():
    """Jobs by name: how often they are repeated within a measurement, and what they do."""
    sides = structures(SIDE, "one", 1), structures(SIDE, "two", 2)
    many, beside = structures(MANY, "case", 3), structures(BESIDE, "case", 4)
    others = structures(BESIDE, "case", 5)
    row = structures(20, "case", 6)
    few = [
        row.isel({"case": xr.DataArray(places, dims="pair")})
        for places in np.mod(np.triu_indices(25, 1), 20)
    ]
    other = [structures(3000, "case", seed) for seed in (7, 8)]
    return {
        "2000 x 2000 with bias": (1, lambda: sl.correlate(*sides, GROUND)),
        "2000 x 2000 without bias": (1, lambda: sl.correlate(*sides, GROUND, bias=False)),
        "one correlate with bias": (20, lambda: sl.correlate(*PAIR, GROUND)),
        "one correlate without bias": (20, lambda: sl.correlate(*PAIR, GROUND, bias=False)),
        "one linearize": (20, lambda: sl.linearize(PAIR[0], GROUND)),
        "one linearized_pair": (1000, lambda: linearized_pair(*NUMBERS)),
        "100 000 by drift": (1, lambda: sl.linearize(many, GROUND, "drift")),
        "100 000 Gaussian with bias": (1, lambda: sl.linearize(many, GROUND)),
        "20 000 pairs by drift": (1, lambda: sl.correlate(beside, others, GROUND, closure="drift")),
        "one passage_gap": (20, lambda: sl.passage_gap(*PAIR, GROUND, **QUAKE)),
        "300 passage_gap of 20 structures": (1, lambda: sl.passage_gap(*few, GROUND, **QUAKE)),
        "3000 passage_gap": (1, lambda: sl.passage_gap(*other, GROUND, **QUAKE)),
    }


def equations(period, damping, hardening, slip, relaxation):
    """State matrix of a structure ``(mu, mu', z)`` and of the ground that drives it."""
    w, wg = 2 * np.pi / period, 2 * np.pi / float(GROUND.period)
    stiffness, fade = wg**2, 2 * float(GROUND.damping) * wg
    return np.array(
        [
            [0, 1, 0, 0, 0],
            [-hardening * w**2, -2 * damping * w, -(1 - hardening) * w**2, stiffness, fade],
            [0, 1 - slip, -relaxation, 0, 0],
            [0, 0, 0, 0, 1],
            [0, 0, 0, -stiffness, -fade],
        ]
    )


def loop(solve, numbers):
    """The textbook's loop: a Lyapunov equation and then its coefficients, until these stay."""
    period, damping, hardening, uy = numbers
    noise = np.zeros((5, 5))
    noise[4, 4] = 2 * np.pi * float(GROUND.intensity) / uy**2
    coefficients = np.array([0.5, 0.5])
    for _ in range(500):
        covariance = solve(equations(period, damping, hardening, *coefficients), noise)
        std = np.sqrt(np.diag(covariance))
        latent = np.array([[std[1]], [std[2]], [covariance[1, 2] / (std[1] * std[2])]])
        following = gaussian(latent, np.empty((0, 1))).coefficients[:, 0]
        if np.abs(following - coefficients).max() < 1e-10:
            break
        coefficients = (coefficients + following) / 2
    return uy * std[0]


def modal_table(sides):
    """Covariances of a table of linearized structures, by the eigenvectors of each of these."""
    parts = []
    for side in sides:
        values, vectors = np.linalg.eig(side)
        push = np.linalg.solve(vectors, np.broadcast_to(np.eye(5)[4][:, None], (len(side), 5, 1)))
        parts.append((vectors[:, 0] * push[..., 0], values))
    (left, of_left), (right, of_right) = parts
    total = np.zeros((len(left), len(right)), complex)
    for k in range(5):
        for n in range(5):
            total -= np.outer(left[:, k], right[:, n]) / np.add.outer(of_left[:, k], of_right[:, n])
    return 2 * np.pi * float(GROUND.intensity) * total.real


def peer_jobs():
    """Other ways to the same numbers."""
    sides = []
    for seed, dim in ((1, "one"), (2, "two")):
        side = structures(SIDE, dim, seed)
        parameters = [side.period, side.damping, side.hardening]
        table = sl.linearize(side, GROUND)
        rows = np.array([*parameters, 1 + table.c_eq, table.k_eq]).T
        sides.append(np.array([equations(*row) for row in rows]))

    def by_scipy(matrix, noise):
        return solve_continuous_lyapunov(matrix, -noise)

    return {
        "2000 x 2000 covariances by modes, plain numpy": (1, lambda: modal_table(sides)),
        "one structure, the loop with scipy": (5, lambda: loop(by_scipy, NUMBERS[0])),
        "one structure, the loop with python-control": (
            5,
            lyap and (lambda: loop(lyap, NUMBERS[0])),
        ),
    }


def timed(times, job):
    """CPU seconds of a job."""
    begin = time.process_time()
    for _ in range(times):
        job()
    return (time.process_time() - begin) / times


def serve(jobs):
    """Do the jobs whose names come in, and write how long each took."""
    for line in sys.stdin:
        name = line.strip()
        print(first_table() if name == FIRST else timed(*jobs[name]), flush=True)


def measured(checkouts, names):
    """Least seconds (checkout, job), interleaved."""
    workers = []
    for checkout in checkouts:
        environment = os.environ | {"PYTHONPATH": str(checkout)}
        arguments = [sys.executable, __file__, "--serve"]
        worker = subprocess.Popen(
            arguments, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        workers.append(worker)
    least = np.full((len(workers), len(names)), np.inf)
    for _ in range(1 + REPETITIONS):  # the first compiles and fills caches
        for job, name in enumerate(names):
            for number, worker in enumerate(workers):
                worker.stdin.write(f"{name}\n")
                worker.stdin.flush()
                least[number, job] = min(least[number, job], float(worker.stdout.readline()))
    for worker in workers:
        worker.stdin.close()
        worker.wait()
    return least


FIRST = "the first table, with import, from an empty cache"


def main():
    repository = Path(__file__).parents[1]
    checkouts = [*map(Path, sys.argv[1:]), repository]
    names, peers = [*table_jobs(), FIRST], []
    if len(checkouts) == 1:
        jobs = peer_jobs()
        peers = [name for name, (_, job) in jobs.items() if job]
        absent = [name for name in jobs if name not in peers]
        print("\n".join(f"{name}: not installed" for name in absent))
    least = measured(checkouts, names + peers)
    print(
        "milliseconds of CPU" + "".join(f" | {checkout.resolve().name}" for checkout in checkouts)
    )
    for name, row in zip(names + peers, least.T, strict=True):
        ratio = f" | {row[0] / row[-1]:.2f}" if len(row) > 1 else ""
        print(f"{name:50s}" + "".join(f" | {1e3 * seconds:10.3f}" for seconds in row) + ratio)


if __name__ == "__main__":
    if "--serve" in sys.argv:
        serve(table_jobs() | peer_jobs())
    else:
        main()
