"""Cells per second of a table of rho, beside the textbook loop, as a ratio within one run.

The textbook loop solves the full augmented Lyapunov equation with scipy inside a root finder
on the coefficients of eqs. (9) and (10), cell by cell.
"""

from __future__ import annotations

import time

import numpy as np
import scipy.linalg
import scipy.optimize
import xarray as xr

import stochlin as sl
from stochlin.kernels.arrays import Array
from stochlin.models.laws import bilinear

REPEATS = 5
TEXTBOOK_CELLS = 40


def axis(name: str, points: int) -> xr.DataArray:
    values = np.geomspace(0.2, 4, points)
    return xr.DataArray(values, dims=name, coords={name: values})


def building(period: xr.DataArray | float) -> sl.Bilinear:
    return sl.Bilinear(period, damping=0.05, hardening=0.05, reduction_factor=4)


def table(points: int) -> float:
    """Median seconds of a square table."""
    ground = sl.KanaiTajimi(2.0, 0.05)
    seconds = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        sl.correlate(building(axis("period_1", points)), building(axis("period_2", points)), ground)
        seconds.append(time.perf_counter() - begin)
    return float(np.median(seconds))


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


def textbook() -> tuple[float, float]:
    """Seconds a cell, and the largest difference of rho from the table's."""
    rng = np.random.default_rng(1996)
    periods = rng.uniform(0.3, 3.5, (TEXTBOOK_CELLS, 2))
    ground = sl.KanaiTajimi(2.0, 0.05)
    strengths = [
        [float(sl.linearize(building(period), ground).yield_displacement) for period in pair]
        for pair in periods
    ]
    fast = sl.correlate(building(periods[:, 0]), building(periods[:, 1]), ground).rho.values
    begin = time.perf_counter()
    slow = [textbook_cell(tuple(p), tuple(u)) for p, u in zip(periods, strengths, strict=True)]
    seconds = (time.perf_counter() - begin) / TEXTBOOK_CELLS
    return seconds, float(np.abs(fast - slow).max())


def main() -> None:
    """Print one table."""
    table(50)
    seconds_a_cell, difference = textbook()
    print(f"textbook loop: {1 / seconds_a_cell:.1f} cells/s; rho differs by at most {difference:.1e}")
    print(f"{'table':>12} {'seconds':>9} {'cells/s':>10} {'x textbook':>11}")
    for points in (100, 200, 400, 1000):
        seconds = table(points)
        rate = points**2 / seconds
        print(f"{points:>5} x {points:<4} {seconds:9.3f} {rate:10.3g} {rate * seconds_a_cell:11.0f}")


if __name__ == "__main__":
    main()
