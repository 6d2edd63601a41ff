"""Hysteresis laws as rates of states, and their integration over one time step of all lanes.

A law has the states ``w``. The first of them is ``z``, the hysteretic extension over the yield
extension. In a time step the extension, over the yield extension, grows at a constant rate ``v`` [1/s],
and ``w' = rates(v, w)`` is integrated by the classical Runge-Kutta rule of fourth order. The rule
contains the midpoint rule, and the difference of both shows whether the step is too long for the law. If
so, the lane is integrated again in substeps. No lane depends on another, and steep laws stay stable.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import numba as nb
import numpy as np

from stochlin.kernels.basics.compiled import UNCOMPILED, called_often, compiled
from stochlin.kernels.basics.powers import power
from stochlin.kernels.simulation.stepping import LANES

# Kinds of elements. Those from BOUC_WEN on have laws with rates; from OTHER on they are laws of users.
KINDS = LINEAR, BILINEAR, SLACK, VISCOUS, BOUC_WEN, OTHER = range(6)
ROUGH = 0.001  # difference of both rules in a state, over 1 + its size, that asks for substeps
SIXTH = 1.0 / 6.0
MOST_SUBSTEPS = 1024  # of a step
_LANES, _ROWS = nb.types.Array(nb.float64, 1, "C"), nb.types.Array(nb.float64, 2, "C")
ADVANCE = nb.void(nb.int64, _LANES, _ROWS, _ROWS, nb.float64, _ROWS)


def advance_of(rates: Any, states: int) -> Any:
    """The function ``advance(v, w, own, dt, new)`` that integrates a law over a time step ``dt`` [s].

    ``rates(v, w, own, lane)`` gives the rates of the ``states`` of a law, a tuple as ``w`` is. For
    ``advance`` ``v`` (LANES,) [1/s] are the rates of the extension over the yield extension, ``w``
    (states, LANES) the states before, ``own`` (parameters, LANES) the parameters, and ``new`` (states,
    LANES) takes the states after the step.
    """
    rates_of = called_often(rates)
    read, write, moved, mean, apart = _with_states(states)

    @called_often
    def step(v, w, own, lane, dt):
        """The states after ``dt``, and whether both rules differ too much."""
        first = rates_of(v, w, own, lane)
        second = rates_of(v, moved(w, 0.5 * dt, first), own, lane)
        third = rates_of(v, moved(w, 0.5 * dt, second), own, lane)
        fourth = rates_of(v, moved(w, dt, third), own, lane)
        after = moved(w, dt, mean(first, second, third, fourth))
        return after, apart(after, moved(w, dt, second))

    @compiled
    def advance(v, w, own, dt, new):
        rough = 0
        for lane in range(LANES):
            after, differ = step(v[lane], read(w, lane), own, lane, dt)
            write(new, lane, after)
            rough += differ > 0.0
        if rough:
            for lane in range(LANES):
                again(v, w, own, lane, dt, new)

    @compiled
    def again(v, w, own, lane, dt, new):
        """Integrate a lane in as many substeps as it needs."""
        after, differ = step(v[lane], read(w, lane), own, lane, dt)
        substeps = 1
        while differ > 0.0 and substeps < MOST_SUBSTEPS:
            substeps *= 2
            after, differ = read(w, lane), 0.0
            for _ in range(substeps):
                after, differs = step(v[lane], after, own, lane, dt / substeps)
                differ = max(differ, differs)
        write(new, lane, after)

    return advance


@cache
def _with_states(states: int) -> tuple[Any, ...]:
    """Functions of the tuples of so many states, or of their rates; the last state comes last."""
    k = states - 1
    if k == 0:
        return tuple(
            called_often(function)
            for function in (
                lambda rows, lane: (rows[0, lane],),
                _write_first,
                lambda w, step, rates: (w[0] + step * rates[0],),
                lambda a, b, c, d: (((a[0] + d[0]) + 2.0 * (b[0] + c[0])) * SIXTH,),
                lambda after, other: abs(after[0] - other[0]) - ROUGH * (1.0 + abs(after[0])),
            )
        )
    read, write, moved, mean, apart = _with_states(k)

    def write_all(rows, lane, w):
        write(rows, lane, w)
        rows[k, lane] = w[k]

    return tuple(
        called_often(function)
        for function in (
            lambda rows, lane: (*read(rows, lane), rows[k, lane]),
            write_all,
            lambda w, step, rates: (*moved(w, step, rates), w[k] + step * rates[k]),
            lambda a, b, c, d: (*mean(a, b, c, d), ((a[k] + d[k]) + 2.0 * (b[k] + c[k])) * SIXTH),
            lambda after, other: max(
                apart(after, other), abs(after[k] - other[k]) - ROUGH * (1.0 + abs(after[k]))
            ),
        )
    )


def _write_first(rows, lane, w):
    rows[0, lane] = w[0]


def _bouc_wen_linear(v, w, own, lane):
    """Rate of the Bouc-Wen law with ``n = 1``."""
    shape = own[0, lane] * np.copysign(1.0, v * w[0]) + own[1, lane]
    return (v * (1.0 - abs(w[0]) * shape),)


def _bouc_wen(v, w, own, lane):
    """Rate of the Bouc-Wen law, ``z' = v - |z|^n (beta |v| sign z + gamma v)``; own: beta, gamma, n."""
    shape = own[0, lane] * np.copysign(1.0, v * w[0]) + own[1, lane]
    size = abs(w[0])
    raised = size if own[2, lane] == 1.0 else power(size, own[2, lane])
    return (v * (1.0 - raised * shape),)


_without_powers, _with_powers = advance_of(_bouc_wen_linear, 1), advance_of(_bouc_wen, 1)


@compiled
def bouc_wen(v, w, own, dt, new):
    """`advance_of` the Bouc-Wen law, which needs no power if ``n = 1`` in all lanes."""
    others = 0
    for lane in range(LANES):
        others += own[2, lane] != 1.0
    if others:
        _with_powers(v, w, own, dt, new)
    else:
        _without_powers(v, w, own, dt, new)


@compiled
def advance(law, kind, v, w, own, dt, new):
    """Integrate the law of a kind of elements; ``law`` is the result of `by_number`."""
    if kind == BOUC_WEN:
        bouc_wen(v, w, own, dt, new)
    else:
        law(kind, v, w, own, dt, new)


@cache
def by_number(laws: tuple[Any, ...]) -> Any:
    """One function ``law(kind, v, w, own, dt, new)`` for the laws of the kinds from OTHER on.

    ``laws`` are results of `advance_of`, of the kinds OTHER, OTHER + 1 and so on. The function is a C
    function, so that a new law compiles no time step.
    """
    chosen = _no_law
    for number, law in enumerate(laws):
        chosen = _either(OTHER + number, law, chosen)

    def of_kind(kind, v, w, own, dt, new):
        chosen(kind, v, w, own, dt, new)

    return of_kind if UNCOMPILED else nb.cfunc(ADVANCE, error_model="numpy")(of_kind)


@compiled
def _no_law(kind, v, w, own, dt, new):
    """The states after a step of an unknown kind: NaN."""
    for k in range(new.shape[0]):
        for lane in range(LANES):
            new[k, lane] = np.nan


def _either(number: int, law: Any, others: Any) -> Any:
    """The function that takes ``law`` for the kind ``number``, and ``others`` for other kinds."""

    @compiled
    def chosen(kind, v, w, own, dt, new):
        if kind == number:
            law(v, w, own, dt, new)
        else:
            others(kind, v, w, own, dt, new)

    return chosen
