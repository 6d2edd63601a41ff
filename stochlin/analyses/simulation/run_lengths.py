"""How long a stationary simulation must be: burn-in and length from what its structures remember.

A yielding structure drifts: its plastic displacement ``u - z`` moves in kicks and is drawn back by the
hardening alone. Its autocorrelation falls as one exponential. Linearization gives ``1/(alpha k_eq)`` for
its time constant, too long by a factor of 1.2 to 10; a short run measures it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.analyses.simulation.ensembles import Run, seconds_of
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.ensemble import plastic_displacements

BURN_IN = 5.0  # times the memory
GROUPS = 4  # of motions, in the measuring run
SETTLING, LENGTH = 1.0, 2.0  # of the measuring run, in linearized relaxation times
INSTANTS = 256  # at which it looks at the plastic displacements
FALLEN = 0.6  # the time constant is taken where the autocorrelation first falls below
ERRORS = 2.0  # standard errors on the safe side


class _Drift(NamedTuple):
    """The slowest drift of a run, as far as it is known."""

    time: float  # [s]
    period: float  # [s], of the structure


def with_length(run: Run, relaxation_times: float, measured_alone: bool = False) -> Run:
    """The run with burn-in and length, in multiples of its memory, measured where drift decides.

    Raises a ValueError before any work if by linearization it would take too long, or the measuring
    run, where nothing but that is done here.
    """
    expected = run.drift_time
    slowest = _slowest(expected, run)
    longest = max(run.memory, slowest.time)
    steps = (BURN_IN + relaxation_times) * longest / run.plan.dt
    seconds = seconds_of(run, steps, run.crowd.size**2 / (2 * run.plan.every))
    if measured_alone:
        measuring = run._replace(plan=run.plan._replace(groups=GROUPS))
        seconds = seconds_of(measuring, (SETTLING + LENGTH) * slowest.time / run.plan.dt, 0.0)
    check_work(
        "the run would take",
        f"the structure of period {slowest.period:.3g} s yields so rarely that its drift relaxes in "
        f"{slowest.time:.3g} s: leave it out, or lower paths or relaxation_times"
        if slowest.time > run.memory
        else f"it lasts {steps * run.plan.dt:.3g} s in steps of {run.plan.dt:.3g} s: lower paths or "
        "relaxation_times, or leave out the shortest or the longest period",
        seconds=seconds,
    )
    if slowest.time > run.memory:
        measured = _measure(run, slowest.time)[run.order]
        slowest = _slowest(np.minimum(measured, expected), run)
    memory = max(run.memory, slowest.time)
    plan = run.plan._replace(
        burn_in=int(np.ceil(BURN_IN * memory / run.plan.block)),
        recorded=max(2, int(np.ceil(relaxation_times * memory / run.plan.block))),
    )
    return run._replace(plan=plan, memory=memory)


def _slowest(times: Array, run: Run) -> _Drift:
    worst = int(np.argmax(times))
    return _Drift(float(times[worst]), float(run.period[worst]))


def _measure(run: Run, expected: float) -> Array:
    """Time constant [s] of each plastic displacement, two standard errors above; in the crowd's order.

    Infinite where a structure does not yield, or does not forget, within the measuring run. Its
    motions are those that follow the plan's.
    """
    block = run.plan.block
    stride = max(1, int(LENGTH * expected / block / INSTANTS))
    pilot = run.plan._replace(
        burn_in=int(np.ceil(SETTLING * expected / block)),
        recorded=stride * max(2, int(np.ceil(LENGTH * expected / block / stride))),
        first_group=run.plan.groups,
        groups=GROUPS,
    )
    plastic = plastic_displacements(run.crowd, run.ground, run.root, pilot, stride)
    steps = [_time_constant(plastic[:, n]) for n in range(run.crowd.size)]
    return stride * block * np.array(steps)


def _time_constant(history: Array) -> float:
    """Of histories (instants, motions), in steps from one instant to the next."""
    count, motions = history.shape
    variance = np.mean(history**2)
    if not variance > 0:
        return np.inf
    for lag in range(1, count):
        kept = max(float(np.mean(history[lag:] * history[:-lag]) / variance), 0.0)
        independent = motions * max(1.0, count / (2 * lag))
        kept += ERRORS * np.sqrt((1 - min(kept, 1.0) ** 2) / independent)
        if kept < FALLEN:
            return float(-lag / np.log(kept))
    return np.inf
