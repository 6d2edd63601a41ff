"""Hysteresis laws along prescribed extensions, from turn to turn: by their steps, and by DOP853."""

import numpy as np
from scipy.integrate import solve_ivp

from stochlin.kernels.basics.compiled import entry
from stochlin.kernels.simulation.laws import OTHER_LAW, advance, by_number


@entry
def _run(law, states, x, own, turns, pieces, reached, work, least):
    lanes, pace, after = turns.shape[1], np.empty(turns.shape[1]), np.empty(x.shape)
    for n in range(1, len(turns)):
        for lane in range(lanes):
            pace[lane] = (turns[n, lane] - turns[n - 1, lane]) / pieces
        for _ in range(pieces):
            advance(law, OTHER_LAW, lanes, pace, x, own, 1.0, after)
            for lane in range(lanes):
                work[lane] += 0.5 * (x[0, lane] + after[0, lane]) * pace[lane]
                least[lane] = min(least[lane], work[lane])
            for k in range(states):
                for lane in range(lanes):
                    x[k, lane] = after[k, lane]
        for k in range(states):
            for lane in range(lanes):
                reached[n, k, lane] = x[k, lane]


def by_steps(law, turns, pieces, own=()):
    """States (turns, states, lanes) at the extensions ``turns`` (turns, lanes), which begin at 0.

    The way from one turn to the next is divided into equal ``pieces``; ``own`` are parameters. Also
    the least work of z so far, by the trapezoidal rule (lanes,).
    """
    states, lanes = law.states, turns.shape[1]
    x, values = np.zeros((states, lanes)), np.zeros((len(own), lanes))
    for row, value in enumerate(own):
        values[row] = value
    reached, work, least = np.zeros((len(turns), states, lanes)), np.zeros(lanes), np.zeros(lanes)
    _run(by_number((law,)), states, x, values, turns, pieces, reached, work, least)
    return reached, least


def random_turns(seed, lanes, turns, size=3.0):
    """Random histories (1 + turns, lanes) from 0, in yield extensions."""
    drawn = np.random.default_rng(seed).normal(0, size, (turns, lanes))
    return np.concatenate([np.zeros((1, lanes)), drawn])


def by_dop853(slope, turns, states):
    """The same for one lane (turns,); ``slope(direction, w)`` are rates over the extension's.

    Where z changes its sign the integrator starts anew.
    """

    def sign_changes(_, w):
        return w[0]

    sign_changes.terminal = True
    reached = np.zeros((len(turns), states))
    for n in range(1, len(turns)):
        at, w, way = 0.0, reached[n - 1], abs(turns[n] - turns[n - 1])
        direction = np.sign(turns[n] - turns[n - 1])
        while at < way:
            events = [sign_changes] if w[0] * direction < 0 else None
            part = solve_ivp(
                lambda _, w, s=direction: s * np.array(slope(s, w)),
                (at, way),
                w,
                "DOP853",
                events=events,
                rtol=1e-12,
                atol=1e-13,
            )
            at, w = part.t[-1], part.y[:, -1]
            if at < way:
                w[0] = 0.0
        reached[n] = w
    return reached
