"""Hysteresis laws of straight branches, followed exactly along a step's extension; loops of laws.

Each function is a `laws.RateLaw.step` that is never too long. The second state is the extension
``mu`` over the yield extension, which moves in one direction within a step.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.basics.powers import exponential, logarithm
from stochlin.kernels.simulation.laws import OTHER_LAW, RateLaw, advance


@called_often
def _backbone(mu, parameters, lane):
    """``z`` of the first loading at a mu from cracking on, as in `_modified_clough`."""
    crack = parameters[1, lane]
    limit = parameters[2, lane]
    rise = parameters[3, lane]
    cap = parameters[4, lane]
    softening = parameters[5, lane]
    residual = parameters[6, lane]
    falling = max(1.0 - softening * (mu - cap), residual)
    return min(crack + rise * (mu - limit), 1.0, falling)


@called_often
def _unloading(peak, parameters, lane):
    """Stiffness in unloading from a side whose largest mu is ``peak``, over the stiffness to yield.

    Before yielding the way leads to the point of cracking on the other side. Then the stiffness
    falls with the exponent.
    """
    crack = parameters[1, lane]
    limit = parameters[2, lane]
    rise = parameters[3, lane]
    chord = min(crack + rise * (peak - limit), 1.0) + crack
    worn = exponential(-parameters[0, lane] * logarithm(max(peak, 1.0)))
    return chord / (min(peak, 1.0) + limit) * worn


@compiled
def _modified_clough(lanes, v, w, parameters, dt, new, too_long):
    """Peak-oriented branches.

    Parameters: the exponent of the unloading stiffness; z and mu of cracking, and the slope from
    there to yielding (1, 1 and 0 without cracking); mu of the cap (infinite without one), the slope
    beyond it, downwards, and the least z of the backbone. States: z; mu; the mu at which z was last
    zero; the largest mu so far beyond that of cracking, up and down. Once one side has yielded, the
    other is cracked up to yielding, too. Formulas are those of an upward motion; others are
    mirrored.
    """
    for lane in range(lanes):
        move = v[lane] * dt
        limit = parameters[2, lane]
        side = 1.0 if move >= 0.0 else -1.0
        up = w[3, lane]
        down = w[4, lane]
        ahead, behind = (up, down) if move >= 0.0 else (down, up)
        z = side * w[0, lane]
        mu = side * w[1, lane]
        zero = side * w[2, lane]
        end = mu + abs(move)
        least = 1.0 if limit + max(up, down) > 1.0 else 0.0
        peak = max(limit + ahead, least)
        # from the side behind; else it may be on an unloading branch of this side
        unloads = z <= 0.0
        stiffness = _unloading(max(limit + (behind if unloads else ahead), least), parameters, lane)
        crossing = mu - z / stiffness
        along = z + stiffness * abs(move)
        crosses = unloads and end >= crossing
        zero = crossing if crosses else zero
        # the way to the largest mu so far
        way = _backbone(peak, parameters, lane) * ((end - zero) / (peak - zero))
        way = way if end < peak else _backbone(end, parameters, lane)
        after = way if crosses or (not unloads and way < along) else along
        beyond = max(ahead, end - limit)
        new[0, lane] = side * after
        new[1, lane] = side * end
        new[2, lane] = side * zero
        new[3, lane] = beyond if move >= 0.0 else up
        new[4, lane] = down if move >= 0.0 else beyond


@compiled
def _flag(lanes, v, w, parameters, dt, new, too_long):
    """Flag-shaped branches.

    Parameter: the width of the flag, 2 for the bilinear law. States: z; mu.
    """
    for lane in range(lanes):
        move = v[lane] * dt
        low = 1.0 - parameters[0, lane]
        mu = w[1, lane] + move
        z = w[0, lane] + move
        new[1, lane] = mu
        lowest = min(max(mu, -1.0), low)
        highest = min(max(mu, -low), 1.0)
        new[0, lane] = min(max(z, lowest), highest)


MODIFIED_CLOUGH = RateLaw(_modified_clough, 5, "modified Clough")
FLAG = RateLaw(_flag, 2, "flag")


@entry
def follow(law, states, extension, parameters, z):
    """Write ``z`` at each of the extensions over the yield extension, from rest at the first.

    ``law`` is the result of `by_number` for this law alone.
    """
    pace = np.empty(1)
    w = np.zeros((states, 1))
    after = np.empty((states, 1))
    z[0] = 0.0
    for point in range(1, extension.size):
        pace[0] = extension[point] - extension[point - 1]
        advance(law, OTHER_LAW, 1, pace, w, parameters, 1.0, after)
        for k in range(states):
            w[k, 0] = after[k, 0]
        z[point] = w[0, 0]
