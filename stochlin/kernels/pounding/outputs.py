"""States, forces and peaks of a run, taken from its steps when they are asked for; compiled."""

from __future__ import annotations

from typing import NamedTuple

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import inlined
from stochlin.kernels.pounding.events import watch_forces, watch_peaks
from stochlin.kernels.pounding.rates import rates
from stochlin.kernels.pounding.steps import copy, interpolate, state_within


class Asked(NamedTuple):
    """What is asked for: times as in `Motion`, and room for the states and forces at them."""

    interval: Array
    since: Array
    states: Array
    forces: Array
    peaks: Array


@inlined
def watch(row, branch, ground, slope, h, end, x, after, known, space, asked, table):
    """Take peaks and forces of the share ``end`` of a step; tells whether its polynomials are known."""
    needed = watch_peaks(row, end, h, x, after, space, asked.peaks, known)
    if needed and not known:
        interpolate(row, branch, ground, slope, h, x, space)
        watch_peaks(row, end, h, x, after, space, asked.peaks, needed)
        known = needed
    watch_forces(branch, end, space, table)
    return known


@inlined
def report(row, branch, ground, slope, h, tau, last, x, after, known, space, asked, at, done):
    """Write the states asked for between ``tau`` and ``last`` of interval ``at``; how many are done."""
    while done < asked.since.size and asked.interval[done] == at and asked.since[done] <= last:
        state, t = asked.states[done], (asked.since[done] - tau) / h
        if asked.since[done] == last:
            copy(after, state)
        else:
            if not known:
                interpolate(row, branch, ground, slope, h, x, space)
                known = True
            state_within(x, t, space, state)
        rates(row, branch, ground + slope * (t * h), state, space.rate, asked.forces[done])
        done += 1
    return done
