"""Speed and accuracy of a table of rho, beside other ways to it, within one run: one table.

`python benchmarks/tables.py [FILE]` prints it and writes it to FILE. The other way
is the textbook loop: the full augmented Lyapunov equation by scipy inside a root finder, cell by cell.

A rate is the median of several repetitions, all in one process and one after another.
"""

from __future__ import annotations

import functools
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import scipy.linalg
import scipy.optimize
import xarray as xr

import stochlin as sl
from stochlin.kernels.basics.arrays import Array
from stochlin.models.laws import bilinear

REPEATS = 5
TEXTBOOK_CELLS = 20
PAIRS = 40_000
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
    strengths = sl.linearize(building(periods.ravel()), GROUND).yield_displacement.values.reshape(-1, 2)
    fast = sl.correlate(building(periods[:, 0]), building(periods[:, 1]), GROUND).rho.values
    slow: list[float] = []

    def loop() -> None:
        slow[:] = [textbook_cell(tuple(p), tuple(u)) for p, u in zip(periods, strengths, strict=True)]

    rate = TEXTBOOK_CELLS / seconds(loop, 3)
    return "textbook loop, one core", rate, float(np.abs(fast - slow).max()), "fixed points and pair"


def ours() -> list[Row]:
    """End to end, against the size of the table."""
    rows = []
    for points in SIZES:
        spent = seconds(lambda points=points: table(points), REPEATS if points < 4000 else 3)
        remark = f"{spent:.3f} s, {BYTES * points**2 / spent / 1e9:.2f} GB/s written"
        rows.append((f"correlate, {points} x {points}", points**2 / spent, np.nan, remark))
    return rows


def closures() -> list[Row]:
    """A table of all combinations, and as many pairs side by side, each with buildings of its own."""
    sides = np.random.default_rng(1).uniform(0.3, 3.5, (2, PAIRS))
    rows: list[Row] = []
    for closure in ("gaussian", "drift"):
        for what, periods in (
            ("table of all combinations", [axis(name, round(PAIRS**0.5)) for name in "ab"]),
            ("pairs side by side", sides),
        ):
            pair = [building(each) for each in periods]
            spent = seconds(functools.partial(sl.correlate, *pair, GROUND, closure=closure), 3)
            rows.append((f"correlate, {what}, {closure}", PAIRS / spent, np.nan, f"{spent:.2f} s"))
    return rows


def peak_memory() -> list[Row]:
    """Growth of the resident set by a large table over its own size, in a fresh process each."""
    pair = "*(tables.building(tables.axis(name, n)) for name in 'ab'), tables.GROUND"
    periods = "*(tables.axis(name, n) for name in 'ab')"
    calls = {f"correlate, {name}": f"tables.sl.correlate({pair}, {name!r})" for name in METHODS}
    calls["correlate, drift closure"] = f"tables.sl.correlate({pair}, closure='drift')"
    calls["rho_white_noise"] = f"tables.sl.rho_white_noise({periods}, 0.05, 0.05)"
    calls["rho_effective"] = f"tables.sl.rules.rho_effective({periods}, *[0.05] * 4, 4.0, 4.0)"
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
        ("stochlin --help (s)", spent("-c", shown), np.nan, "all of it"),
    ]


def main() -> None:
    """Print one table, and write it."""
    table(50)
    book = textbook()
    rows = [book, *ours(), *closures()]
    counted = len(rows)
    rows += [*peak_memory(), *start_up()]
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
