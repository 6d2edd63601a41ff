"""Transient linearization of buildings that degrade: `python benchmarks/evolutionary.py --work FOLDER`.

Random pairs of `BoucWenBaberNoori` oscillators from rest, in motions of a random ground, length and
envelope. The standard deviation of the displacement, the dissipated energy, the peak of each oscillator
in one direction and the separation by linearization are compared with the method of Runge and Kutta in
simulated motions. A run that was stopped goes on with what is in FOLDER.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numba import njit, prange

import stochlin as sl
from stochlin.analyses.linearization.transient_systems import (
    StructureCells,
    grounds_of,
    oscillators_of,
)
from stochlin.analyses.probability.cells import PairTable
from stochlin.analyses.probability.crossings import RelativeMotion
from stochlin.analyses.tables.storage import whole_file
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.kernels.linearization.spectral_moments import displacement_moments
from stochlin.kernels.linearization.transient import Difference, Own
from stochlin.models.laws.baber_noori import BoucWenBaberNoori
from stochlin.models.structures import Gap

SEED, PAIRS, PATHS, POINTS = 20261127, 100, 2000, 41
STEP, PER_PERIOD = 0.01, 40  # s; steps in the shorter period
SMALL = 0.5  # most by which z changes in a step, over the yield displacement and the exponent
LEVELS = {"median": 0.5, "90 %": 0.9}
OWN = BoucWenBaberNoori.own_parameters()


class Motion(NamedTuple):
    """What shakes a pair."""

    ground: sl.KanaiTajimi
    duration: float
    envelope: sl.AminAng


def drawn(number: int, seed: int = SEED) -> tuple[list[dict[str, float]], Motion]:
    """Parameters of both structures, and their motion."""
    random = np.random.default_rng([seed, number])

    def between(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    pinched = random.random() < 0.5
    pair = [
        {
            "period": between(0.25, 2.5),
            "damping": between(0.02, 0.07),
            "hardening": between(0.02, 0.2),
            "reduction_factor": between(1.2, 6.0),
            "beta": random.uniform(0.3, 0.9),
            "exponent": between(1.0, 4.0),
            "strength_decay": between(0.002, 0.1),
            "stiffness_decay": between(0.002, 0.2),
            "pinching": random.uniform(0.3, 0.95) if pinched else 0.0,
        }
        for _ in range(2)
    ]
    duration, soft = between(8.0, 40.0), random.random() < 0.3
    ground = sl.KanaiTajimi(between(0.2, 2.0), between(0.06, 0.2) if soft else between(0.3, 0.9), 1.0)
    rise, fall = duration * random.uniform(0.1, 0.25), duration * random.uniform(0.4, 0.7)
    return pair, Motion(ground, duration, sl.AminAng(rise, fall, 3.0 / (duration - fall)))


class Linearized(NamedTuple):
    """Both structures by linearization."""

    uy: Array  # (2,) [m]
    strong: Array  # (instants,) whether the shaking is strong
    std: Array  # (2, instants) of the displacements [m]
    energy: Array  # (2,) at the end, in units of the law
    gaps: Array  # (level, 3) peaks of u_1 and u_2, and of u_1 - u_2 [m]


def models(side: dict[str, float]) -> BoucWenBaberNoori:
    return BoucWenBaberNoori(**side)


@njit(cache=True)
def rates(y: Array, ground: float, own: Array, out: Array) -> None:
    """Of displacement and velocity in yield displacements, ``z`` and the energy."""
    w, xi, alpha, beta, n, d_nu, d_eta, most, rate, start, width, spread, coupling = own
    u, v, z, e = y
    nu, eta = 1 + d_nu * e, 1 + d_eta * e
    h = 1.0
    if most > 0:
        zeta = most * (1 - np.exp(-rate * e))
        apart = z * np.sign(v) - start * nu ** (-1 / n)
        h -= zeta * np.exp(-((apart / ((width + spread * e) * (coupling + zeta))) ** 2))
    out[0], out[1] = v, -2 * xi * w * v - w * w * (alpha * u + (1 - alpha) * z) - ground
    out[2] = h / eta * (v - nu * abs(z) ** n * (beta * abs(v) * np.sign(z) + (1 - beta) * v))
    out[3] = z * v


@njit(parallel=True, cache=True)
def responses(motions: Array, step: float, inner: int, own: Array, uy: Array, shown: Array) -> Any:
    """Squares of displacements and energies (2, paths, 2, shown), and peaks of u_1, u_2, u_1 - u_2."""
    paths, dt = len(motions), step / inner
    history, peaks = np.zeros((2, paths, 2, shown.size)), np.zeros((paths, 3))
    for path in prange(paths):
        y, k, middle = np.zeros((2, 4)), np.zeros((4, 4)), np.zeros(4)
        at = 0
        for i in range(motions.shape[1]):
            if at < shown.size and shown[at] == i:
                history[0, path, :, at] = (uy * y[:, 0]) ** 2
                history[1, path, :, at] = y[:, 3]
                at += 1
            if i == motions.shape[1] - 1:
                break
            for part in range(inner):
                for s in range(2):
                    pieces = 1 + int(abs(y[s, 1]) * dt * own[s, 4] / SMALL)
                    short = dt / pieces
                    for piece in range(pieces):
                        x = y[s]
                        for stage in range(4):
                            ahead = (0.0, 0.5, 0.5, 1.0)[stage]
                            share = (part + (piece + ahead) / pieces) / inner
                            ground = (1 - share) * motions[path, i] + share * motions[path, i + 1]
                            for m in range(4):
                                middle[m] = x[m] + (ahead * short * k[stage - 1, m] if stage else 0.0)
                            rates(middle, ground / uy[s], own[s], k[stage])
                        for m in range(4):
                            x[m] += short / 6 * (k[0, m] + 2 * k[1, m] + 2 * k[2, m] + k[3, m])
                u_1, u_2 = uy[0] * y[0, 0], uy[1] * y[1, 0]
                peaks[path, 0] = max(peaks[path, 0], u_1)
                peaks[path, 1] = max(peaks[path, 1], u_2)
                peaks[path, 2] = max(peaks[path, 2], u_1 - u_2)
    return history, peaks


def linearized(pair: list[dict[str, float]], motion: Motion) -> Linearized:
    """The pair by transient linearization; the gaps are those for a confidence of `LEVELS`."""
    ground, duration, envelope = motion
    table = PairTable.of(*map(models, pair), ground, Gap(1.0), duration, envelope, POINTS)
    (own, both, _, course), bandwidth = table.solve(ground)
    turning = 0.5 * np.gradient(own.displacement, course.times, axis=0)
    alone = Difference(own.displacement, turning, own.velocity, own.displacement)
    gaps = [
        RelativeMotion(moments, width, np.zeros_like(width), course).gap_for(level)
        for level in LEVELS.values()
        for moments, width in ((alone, bandwidth_alone(table.sides, own, ground)), (both, bandwidth))
    ]
    uy = np.concatenate([side.stack.system.strength.ravel() for side in table.sides])
    return Linearized(
        uy,
        course.times[course.shown] <= course.strong_end,
        np.sqrt(np.maximum(own.displacement[course.shown], 0)).T,
        own.means[-1, 1],
        np.concatenate(gaps).reshape(len(LEVELS), 3),
    )


def bandwidth_alone(sides: Sequence[StructureCells], own: Own, ground: sl.KanaiTajimi) -> Array:
    """Bandwidth of both displacements (times, 2), that of the equivalent systems at the largest one."""
    period, damping, hardening, _ = oscillators_of(sides)
    w, at = 2 * np.pi / period, own.displacement.argmax(axis=0)
    slip, relaxation = (row[at, range(at.size)] for row in (own.slip, own.relaxation))
    system = EquivalentSystem(w**2, 2 * damping * w, (1 - hardening) * w**2, slip, relaxation)
    below = ground.filter(grounds_of(sides))
    l0, l1, l2 = displacement_moments(system, below.forcing(system), below)
    return np.broadcast_to(np.sqrt(1 - l1**2 / (l0 * l2)), own.displacement.shape)


def simulated(pair: list[dict[str, float]], motion: Motion, uy: Array, paths: int) -> list[Array]:
    """Standard deviations and mean energies (structure, instant), and the gaps of `Linearized`."""
    values = [models(side).arrays() for side in pair]
    names = "period", "damping", "hardening", *OWN
    own = np.array([[float(side[name]) for name in names] for side in values])
    own[:, 0] = 2 * np.pi / own[:, 0]
    step = motion.duration / (POINTS - 1) / np.ceil(motion.duration / (POINTS - 1) / STEP)
    inner = int(np.ceil(step * PER_PERIOD / min(side["period"] for side in pair)))
    ground, duration, envelope = motion
    motions = sl.simulated_motions(ground, duration, envelope, paths=paths, step=step).values
    shown = np.linspace(0, motions.shape[1] - 1, POINTS).round().astype(int)
    history, peaks = responses(motions, step, inner, own, uy, shown)
    squares, energy = history.mean(axis=1)
    return [np.sqrt(squares), energy, np.quantile(peaks, [*LEVELS.values()], axis=0)]


def compared(number: int, seed: int, paths: int) -> Array:
    """Relative errors: largest std, its mean over strong shaking, energy, and gaps; by structure."""
    pair, motion = drawn(number, seed)
    found = linearized(pair, motion)
    std, energy, exact = simulated(pair, motion, found.uy, paths)
    strong, gaps = found.strong & (np.arange(POINTS) > 0), (found.gaps / exact - 1).T
    over_time = (found.std[:, strong] / std[:, strong] - 1).mean(axis=1)
    largest = found.std[:, strong].max(axis=1) / std[:, strong].max(axis=1) - 1
    apart = np.tile(gaps[2], (2, 1))
    return np.column_stack([largest, over_time, found.energy / energy[:, -1] - 1, gaps[:2], apart])


def kept(folder: Path, numbers: range, seed: int, paths: int) -> Array:
    """Errors (pair, structure, quantity), each pair compared once."""
    path = folder / f"evolutionary_{seed}_{paths}.npz"
    parts = dict(np.load(path)) if path.exists() else {}
    for number in numbers:
        if str(number) not in parts:
            parts[str(number)] = compared(number, seed, paths)
            with whole_file(path) as temporary:
                np.savez(temporary, **parts)
    return np.stack([parts[str(number)] for number in numbers])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--work", type=Path, required=True, help="folder of what was compared")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--pairs", type=int, default=PAIRS)
    parser.add_argument("--paths", type=int, default=PATHS)
    options = parser.parse_args()
    options.work.mkdir(parents=True, exist_ok=True)
    errors = kept(options.work, range(options.pairs), options.seed, options.paths)
    names = ["largest std", "std, strong part", "energy", *(f"peak, {n}" for n in LEVELS)]
    columns = dict(zip(names, errors.reshape(-1, errors.shape[-1]).T, strict=False))
    columns |= {f"separation, {n}": errors[:, 0, i] for i, n in zip((-2, -1), LEVELS, strict=True)}
    print("relative error: mean, 5 and 95 %, lowest and largest, 90 % of the sizes")
    for name, column in columns.items():
        shown = column.mean(), *np.quantile(column, [0.05, 0.95]), column.min(), column.max()
        print(f"{name:20s}", *(f"{x:+6.1%}" for x in shown), f"{np.quantile(abs(column), 0.9):5.1%}")


if __name__ == "__main__":
    main()
