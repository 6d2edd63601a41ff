"""Speed and accuracy of a table of rho, beside other ways to it, within one run: one table.

`python benchmarks/tables.py [FILE]` prints it and writes it to FILE. The other ways:

- the textbook loop: the full augmented Lyapunov equation by scipy inside a root finder, cell by cell;
- python-control's `lyap` for the pair's equation alone, by scipy and by slycot where it is installed;
- the pair's equation in plain numpy, all cells at once, and by eigenvalues (modal form);
- the library's own full equation, `solver="lyapunov"` of `correlate`, all cells at once.

A rate is the median of several repetitions, all in one process and one after another.
"""

from __future__ import annotations

import functools
import importlib.util
import itertools
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.optimize
import xarray as xr

import stochlin as sl
from stochlin.analyses.linearization.equivalent_systems import INTERNAL, solve_structure
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, pair_covariance
from stochlin.models.laws import bilinear

REPEATS = 5
TEXTBOOK_CELLS, LYAP_CELLS, NUMPY_POINTS = 20, 200, 300
SIZES = (100, 400, 1000, 2000, 4000)
BYTES = 35  # of a cell: rho, the difference and both biases, status, two cautions
GROUND = sl.KanaiTajimi(2.0, 0.05)
METHODS = ("linearization", "white_noise", "effective")
Row = tuple[str, float, float, str]  # what, its rate, its error, a remark


def axis(name: str, points: int) -> xr.DataArray:
    values = np.geomspace(0.2, 4, points)
    return xr.DataArray(values, dims=name, coords={name: values})


def building(period: xr.DataArray | Array | float, factor: xr.DataArray | float = 4.0) -> sl.Bilinear:
    return sl.Bilinear(period, damping=0.05, hardening=0.05, reduction_factor=factor)


def table(points: int) -> xr.Dataset:
    return sl.correlate(building(axis("a", points)), building(axis("b", points)), GROUND)


def seconds(task: Callable[[], object], repeats: int = REPEATS) -> float:
    """Median time of a task."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        task()
        times.append(time.perf_counter() - begin)
    return statistics.median(times)


def solved(period: xr.DataArray | Array) -> xr.Dataset:
    return solve_structure(building(period), GROUND, "gaussian", USUAL)


def arrangement_of(side: xr.Dataset) -> tuple[EquivalentSystem, Forcing]:
    values = [side[name].values for name in INTERNAL]
    return EquivalentSystem(*values[:5]), Forcing(*values[5:])


def matrices(side: xr.Dataset) -> tuple[Array, Array]:
    """State matrices (n, 3, 3) of ``(mu, mu', y)``, and the forcing correlations (n, 3)."""
    (w, d, h, p, k), forcing = arrangement_of(side)
    zero, one = np.zeros_like(w), np.ones_like(w)
    rows = [[zero, one, zero], [-w, -d, h], [k, p, -k]]
    return np.array(rows).transpose(2, 0, 1), np.stack(forcing, axis=-1)


def textbook_cell(periods: tuple[float, float], strengths: tuple[float, float]) -> float:
    """rho of one pair: a root of the coefficients, the 8 x 8 Lyapunov equation at every trial."""
    matrix, noise = np.zeros((8, 8)), np.zeros((8, 8))
    wg, xig = np.pi, 0.05
    matrix[:2, :2] = [[0, 1], [-(wg**2), -2 * xig * wg]]
    noise[1, 1] = 2 * np.pi

    def covariance(unknowns: Array) -> Array:
        for n, (period, uy) in enumerate(zip(periods, strengths, strict=True)):
            w, at = 2 * np.pi / period, 2 + 3 * n
            slip, relaxation = np.exp(unknowns[2 * n : 2 * n + 2])
            rows = [[0, 1, 0], [-0.05 * w**2, -0.1 * w, -0.95 * w**2], [0, 1 - slip, -relaxation]]
            matrix[at : at + 3, at : at + 3] = rows
            matrix[at + 1, :2] = np.array([wg**2, 2 * xig * wg]) / uy
        return scipy.linalg.solve_continuous_lyapunov(matrix, -noise)

    def mismatch(unknowns: Array) -> Array:
        moments = covariance(unknowns)
        found = [_coefficients(moments[at : at + 3, at : at + 3]) for at in (2, 5)]
        return np.log(np.concatenate(found)) - unknowns

    start = np.log([0.1, 0.5, 0.1, 0.5])
    solution = covariance(scipy.optimize.root(mismatch, start, tol=1e-12).x)
    return float(solution[2, 5] / np.sqrt(solution[2, 2] * solution[5, 5]))


def _coefficients(covariance: Array) -> Array:
    """``1 + c_e`` and ``k_e`` of eqs. (9) and (10)."""
    sv, sz = np.sqrt(covariance[1, 1]), np.sqrt(covariance[2, 2])
    latent = np.array([[sv], [sz], [covariance[1, 2] / (sv * sz)]])
    return bilinear.gaussian(latent, np.empty((0, 1))).coefficients[:, 0]


def textbook() -> Row:
    rng = np.random.default_rng(1996)
    periods = rng.uniform(0.3, 3.5, (TEXTBOOK_CELLS, 2))
    strengths = solved(periods.ravel()).yield_displacement.values.reshape(-1, 2)
    fast = sl.correlate(building(periods[:, 0]), building(periods[:, 1]), GROUND).rho.values
    slow: list[float] = []

    def loop() -> None:
        slow[:] = [textbook_cell(tuple(p), tuple(u)) for p, u in zip(periods, strengths, strict=True)]

    rate = TEXTBOOK_CELLS / seconds(loop, 3)
    return "textbook loop, one core", rate, float(np.abs(fast - slow).max()), "fixed points and pair"


def lyap(method: str) -> Row:
    """The pair's equation only, its structures solved beforehand."""
    what = f"python-control lyap ({method})"
    if importlib.util.find_spec("control") is None:
        return what, np.nan, np.nan, "python-control is not installed"
    if method == "slycot" and importlib.util.find_spec("slycot") is None:
        return what, np.nan, np.nan, "slycot is not installed"
    import control

    rng = np.random.default_rng(1996)
    one, other = (solved(rng.uniform(0.3, 3.5, LYAP_CELLS)) for _ in range(2))
    (a, c), (b, e) = matrices(one), matrices(other)
    found = np.empty(LYAP_CELLS)

    def loop() -> None:
        push = np.array([0.0, 1.0, 0.0])
        for n in range(LYAP_CELLS):
            drive = np.outer(push, e[n]) + np.outer(c[n], push)
            found[n] = control.lyap(a[n], b[n].T, drive, method=method)[0, 0]

    rate = LYAP_CELLS / seconds(loop, 3)
    found /= one.displacement_std.values * other.displacement_std.values
    exact = pair_covariance(*arrangement_of(one), *arrangement_of(other))
    exact /= one.displacement_std.values * other.displacement_std.values
    return what, rate, float(np.abs(found - exact).max()), "pair only, one core"


def plain_numpy() -> list[Row]:
    """All cells at once, on one core: elimination, Kronecker and modal form of the pair's equation."""
    one, other = solved(axis("a", NUMPY_POINTS)), solved(axis("b", NUMPY_POINTS))
    (system, forcing), (system_2, forcing_2) = arrangement_of(one), arrangement_of(other)
    column = EquivalentSystem(*(v[:, None] for v in system)), Forcing(*(v[:, None] for v in forcing))
    scale = one.displacement_std.values[:, None] * other.displacement_std.values
    compiled = table(NUMPY_POINTS).rho.values
    rows: list[Row] = []

    def add(what: str, cells: int, function: Callable[[], Array], remark: str) -> None:
        found = function() / scale.ravel()[:cells].reshape(function().shape)
        error = np.abs(found - compiled.ravel()[:cells].reshape(found.shape)).max()
        rows.append((what, cells / seconds(function, 3), float(error), remark))

    elimination = lambda: pair_covariance(*column, system_2, forcing_2)  # noqa: E731
    add("batched numpy, elimination", NUMPY_POINTS**2, elimination, "pair only, one core")
    (a, c), (b, e) = matrices(one), matrices(other)
    push = np.array([0.0, 1.0, 0.0])

    def kronecker() -> Array:
        eye = np.eye(3)
        whole = np.einsum("ij,kl->ikjl", a[0], eye) + np.einsum("ij,nkl->nikjl", eye, b)
        drive = push[:, None] * e[:, None, :] + c[0][:, None] * push
        return np.linalg.solve(whole.reshape(-1, 9, 9), -drive.reshape(-1, 9, 1))[:, 0, 0]

    add("batched numpy, Kronecker", NUMPY_POINTS, kronecker, "pair only, one core")

    def modes(matrix: Array, correlations: Array) -> tuple[Array, Array, Array]:
        values, vectors = np.linalg.eig(matrix)
        inverse = np.linalg.inv(vectors)
        shape = vectors[:, 0, :]
        return values, shape * inverse[:, :, 1], shape * np.einsum("nij,nj->ni", inverse, correlations)

    first, second = modes(a, c), modes(b, e)

    def modal() -> Array:
        total = np.zeros((NUMPY_POINTS, NUMPY_POINTS), complex)
        for k in range(3):
            for n in range(3):
                top = np.outer(first[1][:, k], second[2][:, n]) + np.outer(
                    first[2][:, k], second[1][:, n]
                )
                total -= top / np.add.outer(first[0][:, k], second[0][:, n])
        return total.real

    remark = f"eigenvectors conditioned to {np.linalg.cond(np.linalg.eig(a)[1]).max():.0f}"
    add("batched numpy, modal", NUMPY_POINTS**2, modal, remark)
    return rows


def ours() -> list[Row]:
    """End to end, against the size of the table."""
    rows = []
    for points in SIZES:
        spent = seconds(lambda points=points: table(points), REPEATS if points < 4000 else 3)
        remark = f"{spent:.3f} s, {BYTES * points**2 / spent / 1e9:.2f} GB/s written"
        rows.append((f"correlate, {points} x {points}", points**2 / spent, np.nan, remark))
    return rows


def solvers() -> list[Row]:
    """Both solvers of `correlate` on one table, and how many times as long the chain takes."""
    factor = xr.DataArray([1.0, 2.0, 4.0, 6.0], dims="factor")
    pair = [building(axis(name, 40), factor) for name in "ab"]
    found, spent = {}, {}
    for solver in ("closed_form", "lyapunov"):
        task = functools.partial(sl.correlate, *pair, GROUND, solver=solver)
        found[solver], spent[solver] = task().rho, seconds(task, 3)
    error = float(np.abs(found["lyapunov"] - found["closed_form"]).max())
    rows: list[Row] = []
    for solver, off in (("closed_form", np.nan), ("lyapunov", error)):
        cells, took = found[solver].size, spent[solver]
        remark = f"{1e6 * took / cells:.3g} us a pair, {took / spent['closed_form']:.3g} x closed form"
        rows.append((f"correlate, 40 x 40 x 4, {solver}", cells / took, off, remark))
    return rows


def fixed_points() -> list[Row]:
    """A second, by closure and ground; the iterations and what they take bound them."""
    periods = axis("a", 100_000)
    grounds = {"white": sl.WhiteNoise(0.01), "Kanai-Tajimi": GROUND}
    grounds["Clough-Penzien"] = sl.CloughPenzien(2.0, 0.3, 20.0, 0.6)
    smooth = sl.BoucWen(periods, damping=0.05, hardening=0.05, reduction_factor=4)
    cases = [(building(periods), name) for name in ("gaussian", "clipped", "drift", "narrow_band")]
    rows: list[Row] = []
    for (structure, closure), ground in itertools.product([*cases, (smooth, "gaussian")], grounds):
        task = functools.partial(solve_structure, structure, grounds[ground], closure, USUAL)
        found = task()
        begin = time.process_time()
        wall = seconds(task, 3)
        spent = (time.process_time() - begin) / 3 / periods.size
        what = f"fixed points, {type(structure).__name__}, {closure}, {ground}"
        remark = f"{spent * 1e6:.1f} us of a core, {float(found.iterations.mean()):.1f} iterations"
        rows.append((what, periods.size / wall, float(found.residual.max()), remark))
    return rows


def drift_over_gaussian() -> list[Row]:
    """Time of the drift closure over that of the Gaussian one, warm."""
    one = building(1.0), building(0.7)
    many = building(axis("a", 300)), building(axis("b", 300))
    tasks: dict[str, Callable[[str], object]] = {
        "linearize, one": lambda closure: sl.linearize(one[0], GROUND, closure),
        "linearize, 1e5": lambda closure: sl.linearize(building(axis("a", 100_000)), GROUND, closure),
        "correlate, one": lambda closure: sl.correlate(*one, GROUND, closure=closure),
        "correlate, 300 x 300": lambda closure: sl.correlate(*many, GROUND, closure=closure),
    }
    rows: list[Row] = []
    for what, task in tasks.items():
        both = [seconds(functools.partial(task, name)) for name in ("gaussian", "drift")]
        rows.append((f"drift over Gaussian, {what}", both[1] / both[0], np.nan, f"{both[1]:.4f} s"))
    return rows


def one_pair() -> list[Row]:
    """Milliseconds of processor time of a call with numbers, warm."""
    pair = building(1.0), building(0.7)
    tasks: dict[str, Callable[[], object]] = {
        **{
            f"correlate, {name}": functools.partial(sl.correlate, *pair, GROUND, name)
            for name in METHODS
        },
        "correlate, drift closure": lambda: sl.correlate(*pair, GROUND, closure="drift"),
        "linearize": lambda: sl.linearize(pair[0], GROUND),
    }
    rows: list[Row] = []
    for what, task in tasks.items():
        times = []
        for _ in range(20):
            begin = time.process_time()
            task()
            times.append(1e3 * (time.process_time() - begin))
        rows.append(
            (f"{what}, one pair (ms)", min(times), np.nan, f"median {statistics.median(times):.2f}")
        )
    return rows


def peak_memory() -> list[Row]:
    """Growth of the resident set by a large table over its own size, in a fresh process each."""
    pair = "*(tables.building(tables.axis(name, n)) for name in 'ab'), tables.GROUND"
    periods = "*(tables.axis(name, n) for name in 'ab')"
    calls = {f"correlate, {name}": f"tables.sl.correlate({pair}, {name!r})" for name in METHODS}
    calls["correlate, drift closure"] = f"tables.sl.correlate({pair}, closure='drift')"
    calls["rho_white_noise"] = f"tables.sl.rho_white_noise({periods}, 0.05, 0.05)"
    calls["rho_effective"] = f"tables.sl.rho_effective({periods}, *[0.05] * 4, 4.0, 4.0)"
    calls["critical_gap"] = f"tables.sl.critical_gap({periods}, 0.5)"
    rows: list[Row] = []
    for what, call in calls.items():
        program = (
            f"import re, tables; made = lambda n: {call}; made(300);"
            "status = lambda: open('/proc/self/status').read();"
            "rss = lambda: 1024 * int(re.search(r'VmHWM:\\s+(\\d+)', status())[1]);"
            "before = rss(); kept = made(3000); print((rss() - before) / kept.nbytes, kept.nbytes)"
        )
        command = [sys.executable, "-c", program]
        here = Path(__file__).parent
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=here)
        share, size = map(float, done.stdout.split())
        rows.append((f"peak memory over the result, {what}", share, np.nan, f"{size / 1e6:.0f} MB"))
    return rows


def start_up() -> list[Row]:
    """Seconds in fresh processes, less those of the libraries where that is said."""

    def spent(*arguments: str) -> float:
        return seconds(
            lambda: subprocess.run([sys.executable, *arguments], capture_output=True, check=True)
        )

    shown = "from stochlin.views.command import main; main(['--help'])"
    libraries = "import numpy, scipy.special, scipy.linalg, xarray, numba;"
    bare, loaded = spent("-c", "pass"), spent("-c", libraries)
    one = "sl.correlate(sl.Bilinear(1.,.05,.1,reduction_factor=2), sl.Bilinear(2.,.05), sl.WhiteNoise())"
    first = spent("-c", f"{libraries} import stochlin as sl; {one}") - loaded
    return [
        ("import stochlin (s)", spent("-c", "import stochlin") - bare, np.nan, "libraries when used"),
        ("first correlate (s)", first, np.nan, "beyond the import of the libraries"),
        (
            "stochlin --help (s)",
            spent("-c", shown),
            np.nan,
            "all of it",
        ),
    ]


def atlases() -> list[Row]:
    """The same atlas by threads and by two dask workers."""
    if importlib.util.find_spec("distributed") is None:
        return [("atlas", np.nan, np.nan, "the extra 'scale' is not installed")]
    from distributed import LocalCluster

    sweep = {"start": 0.1, "stop": 10, "count": 1000, "spacing": "log"}
    parameters = {"period_1": sweep, "period_2": sweep, "ground_damping": [0.05, 0.2, 0.6]}
    held = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 4}
    spec = {"parameters": parameters | held}
    rows: list[Row] = []
    with (
        tempfile.TemporaryDirectory() as folder,
        LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster,
    ):
        made = []
        for what, scheduler in (("threads", None), ("two dask workers", cluster.scheduler_address)):
            times = []
            for n in range(3):
                begin = time.perf_counter()
                made.append(sl.write_atlas(spec, f"{folder}/{what}{n}.zarr", scheduler=scheduler))
                times.append(time.perf_counter() - begin)
            rate = made[-1].rho.size / statistics.median(times)
            rows.append((f"atlas on disk, {what}", rate, np.nan, f"{statistics.median(times):.2f} s"))
        same = all(np.array_equal(made[0][n], made[-1][n], equal_nan=True) for n in ("rho", "bias"))
        rows.append(("the same bits", float(same), np.nan, "threads and workers"))
    return rows


def main() -> None:
    """Print one table, and write it."""
    table(50)
    book = textbook()
    rows = [book, lyap("scipy"), lyap("slycot"), *plain_numpy(), *ours(), *solvers()]
    counted = len(rows)
    rows += [*fixed_points(), *drift_over_gaussian(), *one_pair()]
    rows += [*peak_memory(), *start_up(), *atlases()]
    load = f"{os.cpu_count()} cores, load average before and during {os.getloadavg()[0]:.1f}"
    lines = [f"{load}; cells a second unless said otherwise", ""]
    lines += ["| what | rate | x textbook | error of rho | remark |", "|---|---|---|---|---|"]
    for n, (what, rate, error, remark) in enumerate(rows):
        ratio = f"{rate / book[1]:.3g}" if n < counted and np.isfinite(rate) else ""
        shown = f"{error:.1e}" if np.isfinite(error) else ""
        lines.append(f"| {what} | {rate:.3g} | {ratio} | {shown} | {remark} |")
    text = "\n".join(lines)
    print(text)
    if len(sys.argv) > 1:
        Path(sys.argv[1]).parent.mkdir(parents=True, exist_ok=True)
        Path(sys.argv[1]).write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
