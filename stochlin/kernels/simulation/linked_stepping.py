"""Time steps of two bilinear structures that a spring and a dashpot link; compiled."""

import numpy as np

from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.simulation.stepping import LANES

PASSES = 3  # each may find one more structure that yields


@entry
def linked_block(f, dt, parameters, u, v, z, every, out):
    """The pair over the steps of ``f``, as `bilinear_block`; trapezoidal rule, exact return map.

    ``parameters`` (2, 7): as for the bilinear law, then stiffness and damping constant of the link
    over the structure's mass, and the unit of the other's displacement over the own.
    """
    half = 0.5 * dt
    main, cross, keep = np.empty(2), np.empty(2), np.empty(2)
    pull, push = np.empty(2), np.empty(2)
    for n in range(2):
        d, k, _, scale, link_k, link_c, ratio = parameters[n]
        d, k = d + link_c, k + link_k
        main[n] = 1.0 + half * d + half * half * k
        keep[n] = 1.0 - half * d - half * half * k
        pull[n], push[n] = dt * k, dt * scale
        cross[n] = ratio * (half * link_c + half * half * link_k)
    base, new, trial, side = np.empty(2), np.empty(2), np.empty(2), np.empty(2)
    for s in range(f.shape[0]):
        for lane in range(LANES):
            for n in range(2):
                other = 1 - n
                link = parameters[n, 6] * parameters[n, 4] * dt * u[other, lane]
                base[n] = v[n, lane] * keep[n] + push[n] * f[s, lane] - pull[n] * u[n, lane]
                base[n] += link + cross[n] * v[other, lane]
                side[n] = 0.0
            _velocities(half, parameters, main, cross, base, v[:, lane], z[:, lane], side, new, trial)
            for n in range(2):
                z[n, lane] = trial[n] if side[n] == 0.0 else side[n]
                u[n, lane] += half * (v[n, lane] + new[n])
                v[n, lane] = new[n]
        if (s + 1) % every == 0:
            out[:, 0, (s + 1) // every - 1] = u[0]
            out[:, 1, (s + 1) // every - 1] = u[1]


@entry
def _velocities(half, parameters, main, cross, base, v, z, side, new, trial):
    """New velocities and elastic trials of ``z``; ``side`` is 1 or -1 where a structure yields."""
    left, right = np.empty(2), np.empty(2)
    for _ in range(PASSES):
        for n in range(2):
            h = parameters[n, 2]
            if side[n] == 0.0:
                left[n] = main[n] + half * half * h
                right[n] = base[n] - half * h * (2.0 * z[n] + half * v[n])
            else:
                left[n] = main[n]
                right[n] = base[n] - half * h * (z[n] + side[n])
        det = left[0] * left[1] - cross[0] * cross[1]
        new[0] = (right[0] * left[1] + cross[0] * right[1]) / det
        new[1] = (right[1] * left[0] + cross[1] * right[0]) / det
        changed = False
        for n in range(2):
            trial[n] = z[n] + half * (v[n] + new[n])
            if side[n] == 0.0 and abs(trial[n]) > 1.0 and parameters[n, 2] > 0.0:
                side[n] = np.copysign(1.0, trial[n])
                changed = True
        if not changed:
            return
