"""Stationary simulation: burn-in and duration, second moments and their standard errors.

The plastic drift ``u - z`` of a yielding structure has the longest memory, because only the
hardening acts on it as a restoring force. Its autocorrelation is exponential. The time constant by
linearization is ``1/(alpha k_eq)``, which is too long by a factor of 1.2 to 10; it is therefore
measured in a short simulation.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores
from stochlin.kernels.simulation.ensemble import (
    SteppedStructures,
    Sums,
    plastic_displacements,
    stationary_sums,
)
from stochlin.kernels.simulation.stepping import LANES
from stochlin.solver.simulation.checks import check_response, seconds_of
from stochlin.solver.simulation.ensembles import SimulationRun
from stochlin.solver.simulation.structures_in_motion import StructuresInMotion
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_work
from stochlin.solver.tables.labels import ELEMENT

# relative size of a sum, over its terms, below which it is a rounding error
ROUNDING_OF_SUMS = 1e-13
# change of a variance, in standard errors, above which a run is not stationary
NOT_STATIONARY = 5.0
# The run is long enough for a drift if each motion then has at most this number of time steps. With
# 256 motions of one structure this takes some ten seconds.
MOST_STEPS_FOR_DRIFT = 1e7
BURN_IN = 5.0  # burn-in over memory
# Measurement of the time constant: groups of motions, instants at which the plastic displacements
# are sampled, and burn-in and duration in time constants by linearization.
MEASURED_GROUPS = 4
MEASURED_INSTANTS = 256
MEASURED_BURN_IN = 1.0
MEASURED_DURATION = 2.0
LARGEST_AUTOCORRELATION = 0.6  # autocorrelation below which the time constant is evaluated
# standard errors that are added to the autocorrelation, on the safe side
ADDED_STANDARD_ERRORS = 2.0


class MomentEstimates(NamedTuple):
    """Second moments of n displacements or drifts, with standard errors."""

    displacement_std: Array  # (n,) [m]
    displacement_error: Array  # (n,) [m]
    rho: Array  # (n, n)
    rho_error: Array  # (n, n)
    drift: Array  # (n,) change of the variance during the run, in standard errors
    status: Array  # (n,) status codes of `labels`


def stationary_moments(
    moving: StructuresInMotion, relaxation_times: float, progress: Progress | None
) -> xr.Dataset:
    """Stationary second moments of all floors, and of the drifts of storeys."""
    too_slow = MOST_STEPS_FOR_DRIFT * moving.run.plan.dt / (BURN_IN + relaxation_times)
    expected = moving.run.drift_time
    rare = expected > too_slow
    without_rare = moving.run._replace(drift_time=np.where(rare, 0.0, expected))
    run = with_length(without_rare, relaxation_times)
    memory = np.where(rare, expected, run.drift_time)
    moments = simulate_moments(run, np.concatenate([moving.floors, moving.drifts]), progress)
    n = len(moving.floors)
    over, over_drifts = moving.dimensions
    check_response(moving.system, np.isfinite(moments.displacement_std[None, :n]))
    for group in moving.groups:  # all floors of a structure move with the storey that yields rarely
        if isinstance(group.part, SteppedStructures):
            memory[group.watched] = memory[group.watched].max()
    status = np.where(memory[:n] > too_slow, labels.NOT_RESOLVED, moments.status[:n])
    pairs = over, f"{over}_2"
    drifts = moments.displacement_std[n if moving.system.has_storeys else 0 :]
    columns = {
        "displacement_std": (over, moments.displacement_std[:n]),
        "displacement_std_standard_error": (over, moments.displacement_error[:n]),
        "drift": (over, moments.drift[:n]),
        "drift_memory": (over, memory[:n]),
        "status": (over, status),
        "rho": (pairs, moments.rho[:n, :n]),
        "rho_standard_error": (pairs, moments.rho_error[:n, :n]),
        "ductility_std": (over_drifts, drifts / moving.system.watched_strength),
    }
    if moving.system.has_storeys:
        columns["drift_std"] = ELEMENT, drifts
        columns["drift_std_standard_error"] = ELEMENT, moments.displacement_error[n:]
    coords = moving.coords | {f"{over}_2": moving.system.floors}
    return xr.Dataset(columns, coords, run_attributes(run))


def with_length(run: SimulationRun, relaxation_times: float) -> SimulationRun:
    """The run with burn-in and duration, which are multiples of its memory.

    If the memory is that of a plastic drift, the memories of all drifts are measured. Before that,
    a ValueError is raised if the run, with the memory by linearization, would take too long.
    """
    expected = run.drift_time
    slowest = float(expected.max())
    period = float(run.period[np.argmax(expected)])
    duration = (BURN_IN + relaxation_times) * max(run.memory, slowest)
    check_work(
        "the run would take",
        f"the structure of period {period:.3g} s yields so rarely that its drift relaxes in "
        f"{slowest:.3g} s: leave it out, or lower paths or relaxation_times"
        if slowest > run.memory
        else f"it lasts {duration:.3g} s in steps of {run.plan.dt:.3g} s: lower paths or "
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
    slowest = float(run.drift_time.max())
    dt = run.plan.dt
    constants = MEASURED_BURN_IN + MEASURED_DURATION
    measured = constants * slowest / dt if slowest > run.memory else 0.0
    steps = (BURN_IN + relaxation_times) * max(run.memory, slowest) / dt
    pilot = seconds_of(run.with_plan(groups=MEASURED_GROUPS), measured)
    return pilot + seconds_of(run, steps, run.ensemble.size**2 / (2 * run.plan.every))


def _measure(run: SimulationRun, expected: float) -> Array:
    """Time constants [s] of the plastic drifts, on the safe side by two standard errors.

    They are in the order of the ensemble, and infinite if a structure does not yield or its drift
    does not decay within the measurement. The motions are independent of those of the run.
    """
    block = run.plan.block
    stride = max(1, int(MEASURED_DURATION * expected / block / MEASURED_INSTANTS))
    pilot = run.with_plan(
        burn_in=int(np.ceil(MEASURED_BURN_IN * expected / block)),
        recorded=stride * max(2, int(np.ceil(MEASURED_DURATION * expected / block / stride))),
        first_group=run.plan.groups,
        groups=MEASURED_GROUPS,
    )
    plastic = plastic_displacements(pilot.ensemble, stride)
    intervals = [_time_constant(plastic[:, n]) for n in range(run.ensemble.size)]
    return stride * block * np.array(intervals)


def _time_constant(history: Array) -> float:
    """Time constant of histories (instants, motions), as a number of intervals between instants."""
    count, motions = history.shape
    variance = np.mean(history**2)
    if not variance > 0:
        return np.inf
    for lag in range(1, count):
        correlation = max(float(np.mean(history[lag:] * history[:-lag]) / variance), 0.0)
        independent = motions * max(1.0, count / (2 * lag))
        error = np.sqrt((1 - min(correlation, 1.0) ** 2) / independent)
        correlation += ADDED_STANDARD_ERRORS * error
        if correlation < LARGEST_AUTOCORRELATION:
            return float(-lag / np.log(correlation))
    return np.inf


def simulate_moments(
    run: SimulationRun, functions: Array, progress: Progress | None
) -> MomentEstimates:
    """Second moments with standard errors of linear functions (m, w) of all that is watched."""
    sums = stationary_sums(run.ensemble, run.rows(functions), progress)
    return _estimates(sums, run.plan.groups * LANES)


@np.errstate(all="ignore")  # cells that overflow get a status
def _estimates(sums: Sums, paths: int) -> MomentEstimates:
    """Second moments with standard errors, from sums over all motions.

    The errors follow from the scatter between paths. That of ``rho`` is the standard error of the
    mean of its influence function, ``g_12/(s_1 s_2) - rho/2 (g_11/s_1^2 + g_22/s_2^2)``, with the
    mean products ``g_ij`` of the displacements in a path.
    """
    mean = sums.moments / paths
    variance = np.diag(mean)
    unit = np.sqrt(np.outer(variance, variance))
    rho = mean / unit
    share_1 = sums.with_diagonal / (unit * variance[:, None])
    share_2 = sums.with_diagonal.T / (unit * variance)
    diagonal = np.diag(sums.diagonal) / variance**2
    spread = (
        sums.squares / unit**2
        - rho * (share_1 + share_2)
        + 0.25 * rho**2 * (diagonal[:, None] + diagonal + 2 * sums.diagonal / unit**2)
    )
    spread = np.where(spread > ROUNDING_OF_SUMS * sums.squares / unit**2, spread, 0.0)
    rho_error = np.sqrt(spread / (paths * (paths - 1)))
    variance_error = np.sqrt((np.diag(sums.diagonal) - paths * variance**2) / (paths * (paths - 1)))
    change = sums.change / paths
    change_error = np.sqrt((sums.change_squares / paths - change**2) / (paths - 1))
    std = np.sqrt(variance)
    drift = change / change_error
    status = labels.status_where(np.abs(drift) <= NOT_STATIONARY, labels.NOT_CONVERGED)
    return MomentEstimates(std, variance_error / (2 * std), rho, rho_error, drift, status)


def run_attributes(run: SimulationRun) -> dict[str, float | int]:
    """Attributes of a dataset that describe its stationary simulation."""
    plan = run.plan
    return {
        "paths": plan.groups * LANES,
        "seed": plan.seed,
        "step_s": plan.dt,
        "memory_s": run.memory,
        "burn_in_s": plan.burn_in * plan.block,
        "recorded_s": plan.recorded * plan.block,
    }
