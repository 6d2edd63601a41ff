"""Hysteresis laws as rates of states, and their integration over one time step of all lanes.

A law has any number of states ``w``. The first of them is ``z``, the hysteretic extension over the
yield extension. In a time step the extension, over the yield extension, grows at a constant rate
``v`` [1/s], and ``w' = rates(v, w)`` is integrated by the classical Runge-Kutta rule of fourth
order. The rule contains the midpoint rule, and the difference of both shows whether the step is too
long for the law. If so, the lane is integrated again in substeps. No lane depends on another, and
steep laws stay stable.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np

from stochlin.kernels.basics.compiled import by_pointer, called_often, compiled
from stochlin.kernels.basics.powers import exponential, logarithm

# Kinds of elements. Those from OTHER_LAW on have laws with rates or of straight branches.
KINDS_OF_ELEMENTS = LINEAR, BILINEAR, VISCOUS, OTHER_LAW = range(4)
ROUGH = 0.001  # difference of both rules in a state, over 1 + its size, that asks for substeps
SIXTH = 1.0 / 6.0
MOST_SUBSTEPS = 1024  # of a step
LOST = 1e3  # extension of a lane that has run away in a step, over the yield extension


@dataclass(frozen=True)
class RateLaw:
    """A law with states, in time steps.

    ``step(lanes, v, w, parameters, dt, new, too_long)`` writes the states after ``dt`` [s] to
    ``new``, which may be ``w``, and 1 to ``too_long`` (lanes,) where the step is too long. ``v``
    (lanes,) is the rate of the extension over the yield extension [1/s], ``w`` (states, lanes) are
    the states before the step, and ``parameters`` (k, lanes) those of the law.
    """

    step: Any
    states: int  # their number
    name: str  # of which there is one for each law


@called_often
def advance(law, kind, lanes, v, w, parameters, dt, new):
    """Write the states after ``dt`` to ``new``; ``law`` is the result of `by_number`.

    Lanes in which a step is too long are integrated again in substeps, as many as each needs.
    """
    too_long = np.zeros(lanes)
    count = 0
    law(kind, lanes, v, w, parameters, dt, new, too_long)
    for lane in range(lanes):
        count += too_long[lane] > 0.0
    if count:
        _again(law, kind, lanes, v, w, parameters, dt, new, too_long)


@compiled
def _again(law, kind, lanes, v, w, parameters, dt, new, too_long):
    """Integrate the lanes whose step is too long, in twice as many substeps each time."""
    for lane in range(lanes):  # a lane that is lost stays as it is
        for k in range(w.shape[0]):
            too_long[lane] = too_long[lane] if np.isfinite(w[k, lane]) else 0.0
        too_long[lane] = too_long[lane] if abs(v[lane]) * dt < LOST else 0.0
    rows = np.empty((2, lanes))
    states = np.empty(w.shape)
    constants = np.empty(parameters.shape)
    pace = rows[0]
    rough = rows[1]
    count = 1
    substeps = 1
    while count and substeps < MOST_SUBSTEPS:
        count = 0
        substeps = 2 * substeps
        for lane in range(lanes):
            if too_long[lane] > 0.0:
                pace[count] = v[lane]
                rough[count] = 0.0
                for k in range(w.shape[0]):
                    states[k, count] = w[k, lane]
                for k in range(parameters.shape[0]):
                    constants[k, count] = parameters[k, lane]
                count += 1
        for _ in range(substeps if count else 0):
            law(kind, count, pace, states, constants, dt / substeps, states, rough)
        count = 0
        for lane in range(lanes):
            if too_long[lane] > 0.0:
                too_long[lane] = rough[count]
                for k in range(w.shape[0]):
                    new[k, lane] = states[k, count]
                count += 1


def named(name: str, function: Any) -> Any:
    """A function that was made at run time, with a name of its own in compiled code.

    Where several processes have compiled functions of one name, and another one loads them from the
    disk, it would take the first of them for all.
    """
    digest = hashlib.sha256(name.encode()).hexdigest()[:16]
    function.__qualname__ = f"{function.__name__.strip('<>')}_{digest}"
    return function


def rate_law(write: Any, states: int, name: str) -> RateLaw:
    """Law whose rates of states in a lane ``write(lane, v, w, parameters, rates)`` writes.

    Each law has a ``name`` of its own. Each stage has loops of its own: where rates have powers,
    processors wait for each stage of a lane, and work on several lanes of a short loop meanwhile.
    """
    write = called_often(named(name, write))

    @called_often
    @partial(named, name)
    def step(lanes, v, w, parameters, dt, new, too_long):
        inner = np.empty((states, lanes))
        rates = np.empty((4, states, lanes))
        for k in range(states):
            for lane in range(lanes):
                inner[k, lane] = w[k, lane]
        for stage in range(4):
            for lane in range(lanes):
                write(lane, v[lane], inner, parameters, rates[stage])
            ahead = dt if stage == 2 else 0.5 * dt
            for k in range(states):
                for lane in range(lanes):
                    inner[k, lane] = w[k, lane] + ahead * rates[stage, k, lane]
        for k in range(states):
            for lane in range(lanes):
                before = w[k, lane]
                second = rates[1, k, lane]
                mean = (rates[0, k, lane] + rates[3, k, lane]) + 2.0 * (second + rates[2, k, lane])
                after = before + dt * (mean * SIXTH)
                near = abs(after - (before + dt * second)) - ROUGH * (1.0 + abs(after)) <= 0.0
                too_long[lane] = too_long[lane] if near else 1.0
                new[k, lane] = after

    return RateLaw(step, states, name)


@called_often
def _bouc_wen_rate(v, z, parameters, lane, power):
    """``z' = v - |z|^n (beta |v| sign z + gamma v)``, with ``power = |z|^(n-1)``.

    Parameters: beta, gamma, n.
    """
    shape = parameters[0, lane] * np.copysign(1.0, v * z) + parameters[1, lane]
    return v * (1.0 - abs(z) * (power * shape))


def _linear_rate(lane, v, w, parameters, rates):
    rates[0, lane] = _bouc_wen_rate(v, w[0, lane], parameters, lane, 1.0)


def _power_rate(lane, v, w, parameters, rates):
    power = exponential((parameters[2, lane] - 1.0) * logarithm(abs(w[0, lane])))
    rates[0, lane] = _bouc_wen_rate(v, w[0, lane], parameters, lane, power)


LINEAR_BOUC_WEN = rate_law(_linear_rate, 1, "Bouc-Wen, n = 1")
BOUC_WEN = rate_law(_power_rate, 1, "Bouc-Wen")


@cache
def by_number(laws: tuple[RateLaw, ...]) -> Any:
    """One function for laws with rates or branches.

    It is ``law(kind, lanes, v, w, parameters, dt, new, too_long)``. The ``laws`` have the kinds
    OTHER_LAW, OTHER_LAW + 1 and so on. The function is a C function, so that a new law compiles no
    time step.
    """
    chosen = _no_law
    names = repr([(law.name, law.states) for law in laws])
    for number, law in enumerate(laws):
        chosen = _either(number, law.step, chosen, f"{number} of {names}")
    lane = np.empty(1)
    rows = np.empty((1, 1))
    return by_pointer(chosen, 1, 1, lane, rows, rows, 0.1, rows, lane)


@compiled
def _no_law(kind, lanes, v, w, parameters, dt, new, too_long):
    """An unknown kind: the state z after the step is NaN."""
    for lane in range(lanes):
        new[0, lane] = np.nan


def _either(number: int, law: Any, others: Any, name: str) -> Any:
    """Function that takes ``law`` for OTHER_LAW + ``number``, ``others`` for other kinds."""
    kind_of_law = OTHER_LAW + number

    @compiled
    @partial(named, name)
    def chosen(kind, lanes, v, w, parameters, dt, new, too_long):
        if kind == kind_of_law:
            law(lanes, v, w, parameters, dt, new, too_long)
        else:
            others(kind, lanes, v, w, parameters, dt, new, too_long)

    return chosen
