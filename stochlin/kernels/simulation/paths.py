"""Hysteresis laws of straight branches, followed exactly along the extension of a step; loops of laws.

Each law is ``advance(lanes, x, v, w, own, dt, new)`` as made by `laws.advance_of`. Its second state is
the extension ``mu`` over the yield extension, which moves in one direction within a step.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import compiled, entry
from stochlin.kernels.basics.powers import exponential, logarithm
from stochlin.kernels.simulation.laws import OTHER, RateLaw


@compiled
def _modified_clough(lanes, x, v, w, own, dt, new):
    """Peak-oriented branches; own: exponent ``a`` of the unloading stiffness.

    States: z; mu; the mu at which z was last zero; the largest mu so far beyond 1, up and down. Formulas
    are those of an upward motion; others are mirrored.
    """
    for lane in range(lanes):
        move, a = x[v, lane] * dt, x[own, lane]
        side = 1.0 if move >= 0.0 else -1.0
        up, down = x[w + 3, lane], x[w + 4, lane]
        ahead, behind = (up, down) if move >= 0.0 else (down, up)
        z, mu, zero = side * x[w, lane], side * x[w + 1, lane], side * x[w + 2, lane]
        end = mu + abs(move)
        loading = exponential(-a * logarithm(1.0 + ahead))  # stiffness along the unloading branch
        unloading = exponential(-a * logarithm(1.0 + behind))
        crossing = mu - z / unloading
        crosses = z < 0.0 and end >= crossing
        zero = crossing if crosses else zero
        aim = min((end - zero) / (1.0 + ahead - zero), 1.0)  # on the way to the largest mu so far
        back = z + loading * abs(move)  # up an unloading branch again, until that way is met
        after = aim if crosses else min(back, aim)
        after = z + unloading * abs(move) if z < 0.0 and not crosses else after
        beyond = max(ahead, end - 1.0)
        x[new, lane], x[new + 1, lane], x[new + 2, lane] = side * after, side * end, side * zero
        x[new + 3, lane] = beyond if move >= 0.0 else up
        x[new + 4, lane] = down if move >= 0.0 else beyond


@compiled
def _flag(lanes, x, v, w, own, dt, new):
    """Flag-shaped branches; own: the width of the flag. States: z; mu."""
    for lane in range(lanes):
        move, low = x[v, lane] * dt, 1.0 - x[own, lane]
        mu, z = x[w + 1, lane] + move, x[w, lane] + move
        x[new + 1, lane] = mu
        lowest, highest = min(max(mu, -1.0), low), min(max(mu, -low), 1.0)
        x[new, lane] = min(max(z, lowest), highest)


@compiled
def _bilinear(lanes, x, v, w, own, dt, new):
    """The bilinear law, which time steps have in closed form; its state is z."""
    for lane in range(lanes):
        x[new, lane] = min(max(x[w, lane] + x[v, lane] * dt, -1.0), 1.0)


MODIFIED_CLOUGH, FLAG = RateLaw(_modified_clough, 5), RateLaw(_flag, 2)
BILINEAR_PATH = RateLaw(_bilinear, 1)


@entry
def follow(law, states, extension, own, z):
    """Write ``z`` at each of the extensions over the yield extension, from rest at the first.

    ``law`` is the result of `by_number` for this law alone.
    """
    n, after = own.size, 1 + states + own.size
    x = np.zeros((after + states, 1))
    for k in range(n):
        x[1 + states + k, 0] = own[k]
    z[0] = 0.0
    for point in range(1, extension.size):
        x[0, 0] = extension[point] - extension[point - 1]
        law(OTHER, 1, x, 0, 1, 1 + states, 1.0, after)
        for k in range(states):
            x[1 + k, 0] = x[after + k, 0]
        z[point] = x[1, 0]
