"""What the linearized system would save as a control variate: `python benchmarks/control_variate.py`.

It rides on the motions of the simulation and its exact moments are known, so that the part of the
scatter that both share could be taken off. The gain is the factor by which the variance of an
estimate falls: `1/(1 - r^2)`, with `r` the correlation between paths. The linear system costs about
as much as the structure itself: below 2 more paths do better.
"""

import itertools

import numba as nb
import numpy as np

import stochlin as sl
from stochlin.analyses.simulation.ensembles import cells_of_all, prepare
from stochlin.analyses.simulation.run_lengths import with_length
from stochlin.kernels.simulation.ensemble import MotionGroup
from stochlin.kernels.simulation.stepping import LANES

RATIO = 0.7  # of the periods of the pair


@nb.njit(nogil=True)
def linear_block(f, steps, gains, state, every, out):
    """Linear systems ``x_new = step x + gain f`` of three states; every ``every``-th displacement."""
    for n in range(steps.shape[0]):
        for s in range(f.shape[0]):
            for lane in range(LANES):
                a, b, c = state[n, 0, lane], state[n, 1, lane], state[n, 2, lane]
                for i in range(3):
                    row = steps[n, i]
                    state[n, i, lane] = row[0] * a + row[1] * b + row[2] * c + gains[n, i] * f[s, lane]
            if (s + 1) % every == 0:
                for lane in range(LANES):
                    out[(s + 1) // every - 1, n, lane] = state[n, 0, lane]


def linear_steps(structure, ground, dt):
    """Trapezoidal rule of the linearized structure, in units of its yield displacement."""
    solved = sl.linearize(structure, ground)
    w, alpha = 2 * np.pi / structure.period, structure.hardening
    matrix = np.array(
        [
            [0, 1, 0],
            [-alpha * w**2, -2 * structure.damping * w, -(1 - alpha) * w**2],
            [0, -float(solved.c_eq), -float(solved.k_eq)],
        ]
    )
    left = np.linalg.inv(np.eye(3) - 0.5 * dt * matrix)
    push = np.array([0, dt / float(solved.yield_displacement), 0])
    return left @ (np.eye(3) + 0.5 * dt * matrix), left @ push


def second_moments(structures, ground):
    """Mean products of the displacements of each path: of the structures, and linearized."""
    cells = cells_of_all(structures, ground)
    run = prepare(cells, ground, paths=256, seed=0, steps_per_period=32)
    run = with_length(run, 20.0)
    plan = run.plan
    both = [linear_steps(structure, ground, plan.dt) for structure in structures]
    steps, gains = (np.array(part) for part in zip(*both, strict=True))
    moments = np.zeros((2, plan.groups, LANES, 2, 2))
    for group in range(plan.groups):
        motion, state = (
            MotionGroup(run.crowd._replace(plan=plan), group),
            np.zeros((2, 3, LANES)),
        )
        linear = np.empty((plan.samples, 2, LANES))
        for block in range(plan.burn_in + plan.recorded):
            out = motion.block()
            linear_block(motion.f, steps, gains, state, plan.every, linear)
            if block >= plan.burn_in:
                for total, sample in zip(moments, (out, linear), strict=True):
                    total[group] += np.einsum("snl,sml->lnm", sample, sample)
    return moments.reshape(2, -1, 2, 2)


def influence(moments):
    """What each path adds to the estimate of rho."""
    mean = moments.mean(axis=0)
    scaled = moments / np.sqrt(np.outer(np.diag(mean), np.diag(mean)))
    rho = scaled.mean(axis=0)[0, 1]
    return scaled[:, 0, 1] - 0.5 * rho * (scaled[:, 0, 0] + scaled[:, 1, 1])


def gain(one, other):
    return 1 / (1 - np.corrcoef(one, other)[0, 1] ** 2)


def main():
    grounds = {"white noise": sl.WhiteNoise(), "xig=.6": sl.KanaiTajimi(1, 0.6)}
    grounds["xig=.05"] = sl.KanaiTajimi(1, 0.05)
    print("hardening   R  ground        T/Tg  gain: variance 1, 2, rho")
    for alpha, factor, (name, ground) in itertools.product((0.02, 0.1, 0.5), (2, 4), grounds.items()):
        for period in (0.5, 1.5):
            structures = [
                sl.Bilinear(ratio * period, 0.05, alpha, reduction_factor=factor) for ratio in (RATIO, 1)
            ]
            true, linear = second_moments(structures, ground)
            gains = [gain(true[:, n, n], linear[:, n, n]) for n in (0, 1)]
            gains.append(gain(influence(true), influence(linear)))
            print(
                f"{alpha:9g} {factor:3d}  {name:12s} {period:5g}  " + "".join(f"{g:8.2f}" for g in gains)
            )


if __name__ == "__main__":
    main()
