"""Hysteresis laws as rates of states, and their integration over one time step of all lanes.

A law has any number of states ``w``. The first of them is ``z``, the hysteretic extension over the yield
extension. In a time step the extension, over the yield extension, grows at a constant rate ``v`` [1/s],
and ``w' = rates(v, w)`` is integrated by the classical Runge-Kutta rule of fourth order. The rule
contains the midpoint rule, and the difference of both shows whether the step is too long for the law. If
so, the lane is integrated again in substeps. No lane depends on another, and steep laws stay stable.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from stochlin.kernels.basics.compiled import by_pointer, called_often, compiled
from stochlin.kernels.basics.powers import exponential, logarithm

# Kinds of elements. Those from OTHER on have laws with rates or of straight branches.
KINDS = LINEAR, BILINEAR, VISCOUS, OTHER = range(4)
ROUGH = 0.001  # difference of both rules in a state, over 1 + its size, that asks for substeps
SIXTH = 1.0 / 6.0
MOST_SUBSTEPS = 1024  # of a step
FEW = 8  # substeps of all lanes
LOST = 1e3  # extension of a lane that has run away in a step, over the yield extension


def named(name: str, function: Any) -> Any:
    """A function that was made at run time, with a name of its own in compiled code.

    Where several processes have compiled functions of one name, and another one loads them from the
    disk, it would take the first of them for all.
    """
    digest = hashlib.sha256(name.encode()).hexdigest()[:16]
    function.__qualname__ = f"{function.__name__.strip('<>')}_{digest}"
    return function


@dataclass(frozen=True)
class RateLaw:
    """A law with states, in time steps."""

    advance: Any  # the result of `advance_of`, or one of `paths`
    states: int  # their number
    name: str  # of which there is one for each law


def advance_of(rates: Any, states: int, name: str) -> Any:
    """The function ``advance(lanes, v, w, own, dt, new)`` that integrates a law over ``dt`` [s].

    Each law has a ``name`` of its own. ``rates(v, w, own, lane)`` gives the rates of the ``states`` of a
    law, a tuple as ``w`` is, with the parameters ``own`` (k, lanes). For ``advance``, ``v`` (lanes,) is
    the rate of the extension over the yield extension [1/s], ``w`` (states, lanes) are the states before
    the step, and the states after it are written to ``new``.
    Each stage has a loop of its own: where rates have powers, processors wait for each stage of a lane,
    and work on several lanes of a short loop meanwhile.
    """
    of_law = partial(named, name)
    rates_of = called_often(of_law(rates))
    read, write, moved, mean, apart = _with_states(states)

    @called_often
    @of_law
    def step(v, w, own, lane, dt):
        """The states after ``dt``, and whether both rules differ too much."""
        first = rates_of(v, w, own, lane)
        second = rates_of(v, moved(w, 0.5 * dt, first), own, lane)
        third = rates_of(v, moved(w, 0.5 * dt, second), own, lane)
        fourth = rates_of(v, moved(w, dt, third), own, lane)
        after = moved(w, dt, mean(first, second, third, fourth))
        return after, apart(after, moved(w, dt, second))

    @compiled
    @of_law
    def advance(lanes, v, w, own, dt, new):
        rough, stages = 0, np.empty((3 * states, lanes))
        for lane in range(lanes):
            write(stages, 0, lane, rates_of(v[lane], read(w, 0, lane), own, lane))
        for lane in range(lanes):
            middle = moved(read(w, 0, lane), 0.5 * dt, read(stages, 0, lane))
            write(stages, states, lane, rates_of(v[lane], middle, own, lane))
        for lane in range(lanes):
            middle = moved(read(w, 0, lane), 0.5 * dt, read(stages, states, lane))
            write(stages, 2 * states, lane, rates_of(v[lane], middle, own, lane))
        for lane in range(lanes):
            before, first = read(w, 0, lane), read(stages, 0, lane)
            second, third = read(stages, states, lane), read(stages, 2 * states, lane)
            fourth = rates_of(v[lane], moved(before, dt, third), own, lane)
            after = moved(before, dt, mean(first, second, third, fourth))
            write(new, 0, lane, after)
            rough += not apart(after, moved(before, dt, second)) <= 0.0
        if rough:
            again(lanes, v, w, own, dt, new)

    @compiled
    @of_law
    def again(lanes, v, w, own, dt, new):
        """Integrate the lanes in which both rules differ, in as many substeps as each needs.

        In few substeps all lanes are integrated, which takes less time than to choose; the others are
        left as they are.
        """
        tried, apart, good = np.empty((states, lanes)), np.empty(lanes), np.empty(lanes)
        for lane in range(lanes):  # a lane that is lost stays as it is
            good[lane] = 0.0 if abs(v[lane]) * dt < LOST else 1.0
            for k in range(states):
                good[lane] = good[lane] if np.isfinite(w[k, lane]) else 1.0
        substeps, rough = 1, 1
        while rough and substeps <= MOST_SUBSTEPS:
            for lane in range(lanes):
                apart[lane] = 0.0
            for k in range(states):
                for lane in range(lanes):
                    tried[k, lane] = w[k, lane]
            for _ in range(substeps):
                for lane in range(lanes):
                    if substeps > FEW and good[lane] > 0.0:
                        continue
                    after, differ = step(v[lane], read(tried, 0, lane), own, lane, dt / substeps)
                    write(tried, 0, lane, after)
                    apart[lane] = apart[lane] if differ <= 0.0 else 1.0
            for k in range(states):
                for lane in range(lanes):
                    new[k, lane] = new[k, lane] if good[lane] > 0.0 else tried[k, lane]
            rough = 0
            for lane in range(lanes):
                good[lane] = 1.0 if good[lane] > 0.0 or not apart[lane] > 0.0 else 0.0
                rough += good[lane] == 0.0
            substeps *= 2

    return advance


@cache
def _with_states(states: int) -> tuple[Any, ...]:
    """Functions of the tuples of so many states, or of their rates; the last state comes last."""
    if states == 0:
        nothing = called_often(named("no states", lambda *_: ()))
        alike = called_often(named("alike", lambda after, other: 0.0))
        return nothing, nothing, nothing, nothing, alike
    k = states - 1
    read, write, moved, mean, apart = _with_states(k)

    def write_all(x, row, lane, w):
        write(x, row, lane, w)
        x[row + k, lane] = w[k]

    return tuple(
        called_often(named(f"{number} of {states}", function))
        for number, function in enumerate(
            (
                lambda x, row, lane: (*read(x, row, lane), x[row + k, lane]),
                write_all,
                lambda w, step, rates: (*moved(w, step, rates), w[k] + step * rates[k]),
                lambda a, b, c, d: (*mean(a, b, c, d), ((a[k] + d[k]) + 2.0 * (b[k] + c[k])) * SIXTH),
                lambda after, other: (
                    apart(after, other)
                    if abs(after[k] - other[k]) - ROUGH * (1.0 + abs(after[k])) <= 0.0
                    else 1.0
                ),
            )
        )
    )


def _bouc_wen_linear(v, w, own, lane):
    """Rate of the Bouc-Wen law with ``n = 1``."""
    shape = own[0, lane] * np.copysign(1.0, v * w[0]) + own[1, lane]
    return (v * (1.0 - abs(w[0]) * shape),)


def _bouc_wen(v, w, own, lane):
    """Rate of the Bouc-Wen law, ``z' = v - |z|^n (beta |v| sign z + gamma v)``; own: beta, gamma, n."""
    shape = own[0, lane] * np.copysign(1.0, v * w[0]) + own[1, lane]
    size = abs(w[0])
    # |z| |z|^(n-1) needs no choice between numbers, which would slow down the loop: it is |z| if n = 1.
    less = exponential((own[2, lane] - 1.0) * logarithm(size))
    return (v * (1.0 - size * (less * shape)),)


_without_powers = advance_of(_bouc_wen_linear, 1, "Bouc-Wen, n = 1")
_with_powers = advance_of(_bouc_wen, 1, "Bouc-Wen")


@compiled
def _bouc_wen_of_any_power(lanes, v, w, own, dt, new):
    """`advance_of` the Bouc-Wen law, which needs no power if ``n = 1`` in all lanes."""
    others = 0
    for lane in range(lanes):
        others += own[2, lane] != 1.0
    if others:
        _with_powers(lanes, v, w, own, dt, new)
    else:
        _without_powers(lanes, v, w, own, dt, new)


BOUC_WEN = RateLaw(_bouc_wen_of_any_power, 1, "Bouc-Wen")


@cache
def by_number(laws: tuple[RateLaw, ...]) -> Any:
    """One function ``law(kind, lanes, v, w, own, dt, new)`` for the laws of the kinds from OTHER on.

    The ``laws`` have the kinds OTHER, OTHER + 1 and so on. The function is a C function, so that a new
    law compiles no time step.
    """
    chosen, names = _no_law, repr([(law.name, law.states) for law in laws])
    for number, law in enumerate(laws):
        chosen = _either(number, law.advance, chosen, f"{number} of {names}")

    def of_kind(kind, lanes, v, w, own, dt, new):
        chosen(kind, lanes, v, w, own, dt, new)

    lane, rows = np.empty(1), np.empty((1, 1))
    return by_pointer(named(names, of_kind), 1, 1, lane, rows, rows, 0.1, rows)


@compiled
def _no_law(kind, lanes, v, w, own, dt, new):
    """An unknown kind: the state z after the step is NaN."""
    for lane in range(lanes):
        new[0, lane] = np.nan


def _either(number: int, law: Any, others: Any, name: str) -> Any:
    """The function that takes ``law`` for the kind OTHER + ``number``, ``others`` for other kinds."""
    kind_of_law = OTHER + number

    @compiled
    @partial(named, name)
    def chosen(kind, lanes, v, w, own, dt, new):
        if kind == kind_of_law:
            law(lanes, v, w, own, dt, new)
        else:
            others(kind, lanes, v, w, own, dt, new)

    return chosen
