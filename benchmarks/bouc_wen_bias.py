"""Bias of linearized Bouc-Wen structures beside simulation: `python benchmarks/bouc_wen_bias.py`.

Random structures on random grounds. Printed is the error of the `bias` that `linearize` takes from the
nearest bilinear structure, and the true bias where `caution` is 0. Takes half an hour or so.
"""

from __future__ import annotations

import argparse

import numpy as np

import stochlin as sl
from stochlin.kernels.basics.arrays import Array

SEED, GROUNDS, EACH, PATHS = 20261128, 40, 8, 32


def drawn(number: int) -> tuple[list[sl.BoucWen], sl.WhiteNoise | sl.KanaiTajimi]:
    """Structures, and their ground, whose period is 1 s unless it is white noise."""
    random = np.random.default_rng([SEED, number])

    def between(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    ground = sl.KanaiTajimi(1.0, between(0.05, 0.6)) if number % 4 else sl.WhiteNoise()
    structures = []
    for _ in range(EACH):
        beta = random.uniform(0.3, 0.9)
        own = {"beta": beta, "gamma": 1 - beta, "exponent": between(1.0, 5.0)}
        common = between(0.35, 3.0), between(0.02, 0.08), between(0.03, 0.3)
        structures.append(sl.BoucWen(*common, reduction_factor=between(1.2, 7.0), **own))
    return structures, ground


def compared(number: int, paths: int) -> Array:
    """True bias, that of `linearize` and its caution, in a row for each structure."""
    structures, ground = drawn(number)
    true = sl.simulate(structures, ground, paths=paths, seed=number).displacement_std.values
    rows = []
    for structure, std in zip(structures, true, strict=True):
        table = sl.linearize(structure, ground)
        rows.append([float(table.displacement_std) / std - 1, float(table.bias), int(table.caution)])
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--grounds", type=int, default=GROUNDS)
    parser.add_argument("--paths", type=int, default=PATHS)
    options = parser.parse_args()
    rows = np.concatenate([compared(number, options.paths) for number in range(options.grounds)])
    true, bias, caution = rows[np.isfinite(rows).all(axis=1)].T
    off, trusted = np.abs(bias - true), np.abs(true[caution == 0])
    print(f"{true.size} structures, bias {np.abs(true).mean():.3f} in the mean, without regard to sign")
    print(
        f"off by {off.mean():.3f}, in nine of ten {np.quantile(off, 0.9):.3f}, at most {off.max():.3f}"
    )
    print(f"caution 0: {trusted.size}, beyond 0.1 {(trusted > 0.1).sum()}, {trusted.max(initial=0):.3f}")


if __name__ == "__main__":
    main()
