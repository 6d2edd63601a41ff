"""Burn-in and duration of a stationary simulation, from the memory of its structures.

The plastic drift ``u - z`` of a yielding structure has the longest memory, because only the hardening
acts on it as a restoring force. Its autocorrelation is exponential. The time constant by linearization
is ``1/(alpha k_eq)``, which is too long by a factor of 1.2 to 10; it is therefore measured in a short
simulation.
"""

from __future__ import annotations

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.simulation.ensemble import plastic_displacements
from stochlin.solver.simulation.ensembles import SimulationRun, seconds_of
from stochlin.solver.tables.work import check_work

BURN_IN = 5.0  # burn-in over memory
# Measurement of the time constant: groups of motions, burn-in and duration in time constants by
# linearization, and instants at which the plastic displacements are sampled.
GROUPS, INSTANTS = 4, 256
SETTLING, LENGTH = 1.0, 2.0
FALLEN = 0.6  # autocorrelation below which the time constant is evaluated
ERRORS = 2.0  # standard errors that are added to the autocorrelation, on the safe side


def with_length(run: SimulationRun, relaxation_times: float) -> SimulationRun:
    """The run with burn-in and duration, which are multiples of its memory.

    If the memory is that of a plastic drift, the memories of all drifts are measured. Before that, a
    ValueError is raised if the run, with the memory by linearization, would take too long.
    """
    expected = run.drift_time
    slowest, period = float(expected.max()), float(run.period[np.argmax(expected)])
    lasts = (BURN_IN + relaxation_times) * max(run.memory, slowest)
    check_work(
        "the run would take",
        f"the structure of period {period:.3g} s yields so rarely that its drift relaxes in "
        f"{slowest:.3g} s: leave it out, or lower paths or relaxation_times"
        if slowest > run.memory
        else f"it lasts {lasts:.3g} s in steps of {run.plan.dt:.3g} s: lower paths or "
        "relaxation_times, or leave out the shortest or the longest period",
        seconds=expected_seconds(run, relaxation_times),
        cores=cores(),
    )
    if slowest > run.memory:
        expected = np.minimum(_measure(run, slowest)[run.order], expected)
    memory = max(run.memory, float(expected.max()))
    return run._replace(memory=memory, drift_time=expected).with_plan(
        burn_in=int(np.ceil(BURN_IN * memory / run.plan.block)),
        recorded=max(2, int(np.ceil(relaxation_times * memory / run.plan.block))),
    )


def expected_seconds(run: SimulationRun, relaxation_times: float) -> float:
    """Seconds of one core to measure the slowest drift, and for the run itself.

    The memory that is expected is the one by linearization, which is too long.
    """
    slowest, dt = float(run.drift_time.max()), run.plan.dt
    measured = (SETTLING + LENGTH) * slowest / dt if slowest > run.memory else 0.0
    steps = (BURN_IN + relaxation_times) * max(run.memory, slowest) / dt
    pilot = seconds_of(run.with_plan(groups=GROUPS), measured)
    return pilot + seconds_of(run, steps, run.crowd.size**2 / (2 * run.plan.every))


def _measure(run: SimulationRun, expected: float) -> Array:
    """Time constants [s] of the plastic drifts, on the safe side by two standard errors.

    They are in the order of the crowd, and infinite if a structure does not yield or its drift does not
    decay within the measurement. The motions are independent of those of the run.
    """
    block = run.plan.block
    stride = max(1, int(LENGTH * expected / block / INSTANTS))
    pilot = run.with_plan(
        burn_in=int(np.ceil(SETTLING * expected / block)),
        recorded=stride * max(2, int(np.ceil(LENGTH * expected / block / stride))),
        first_group=run.plan.groups,
        groups=GROUPS,
    )
    plastic = plastic_displacements(pilot.crowd, stride)
    steps = [_time_constant(plastic[:, n]) for n in range(run.crowd.size)]
    return stride * block * np.array(steps)


def _time_constant(history: Array) -> float:
    """Time constant of histories (instants, motions), as a number of intervals between instants."""
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
