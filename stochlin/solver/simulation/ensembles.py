"""Structures and their ground, prepared for a simulation of many motions (an ensemble).

The time step is chosen, and the computing time is estimated.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import scipy.linalg

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.simulation.ensemble import (
    Ensemble,
    Plan,
    UncertainGround,
)
from stochlin.kernels.simulation.row_products import rows_of
from stochlin.kernels.simulation.stepping import LANES, FilterSteps, filter_steps
from stochlin.models.grounds import Ground
from stochlin.models.structures import GAUSSIAN, Structure
from stochlin.solver.linearization.equivalent_systems import solved_together
from stochlin.solver.simulation.connected_structures import SteppedGroup
from stochlin.solver.tables.checks import Tolerance

# The response is sampled so often in the shortest period. More samples would hardly make the
# estimated variance more accurate.
SAMPLES_PER_PERIOD = 2


class SimulationRun(NamedTuple):
    """A simulation that is ready to run, of displacements that are watched (w,).

    An oscillator has one, a building with storeys has one for each floor, and one for each mode
    that yields.
    """

    # all structures, grouped by the kind of their time steps, with ground and plan
    ensemble: Ensemble
    order: Array  # (w,) the row of each displacement in the ensemble
    scale: Array  # (w,) [m], the unit in which it is computed
    period: Array  # (w,) [s], the longest period of its structure
    drift_time: Array  # (w,) [s], in which its plastic drift decays
    memory: float  # [s], the longest time in which a vibration decays

    @property
    def plan(self) -> Plan:
        """Time step, duration, number and seed of the motions."""
        return self.ensemble.plan

    def with_plan(self, **changes: Any) -> SimulationRun:
        """The run with other entries of the plan."""
        return self._replace(ensemble=self.ensemble._replace(plan=self.plan._replace(**changes)))

    def rows(self, functions: Array) -> Array:
        """Linear functions (m, k) of the first displacements [m], of those of the ensemble."""
        count = functions.shape[1]
        matrix = np.zeros((len(functions), self.order.size))
        matrix[:, self.order[:count]] = functions * self.scale[:count]
        return rows_of(matrix)

    def watched(self, values: Array) -> Array:
        """Values (motions, w) [m] of all that is watched, from those of the ensemble."""
        in_metres: Array = values[:, self.order] * self.scale
        return in_metres


def drift_time_of(structure: Structure, ground: Ground) -> float:
    """Time [s] in which the plastic drift of an oscillator decays, by linearization; 0 if elastic.

    A law may have no linearization; a run that is too short shows it by its change of variance.
    """
    try:
        solved = solved_together((structure,), ground, GAUSSIAN, Tolerance(1e-6, 200))
    except ArithmeticError:
        return 0.0
    rate = float((solved.oscillators.hardening * solved.values["k_eq"])[0])
    return 1 / rate if rate > 0 else 0.0


def prepare(
    groups: Sequence[SteppedGroup],
    ground: Ground,
    *,
    paths: int,
    seed: int,
    steps_per_period: int,
    drift_times: Array | float = 0.0,
    scatter: float = 0.0,
    grounds: Sequence[Ground] = (),
    step: float | None = None,
) -> SimulationRun:
    """Structures and their ground, ready for a simulation whose duration is still open.

    Parameters
    ----------
    groups : sequence of SteppedGroup
        All structures.
    ground : Ground
        The ground that acts on all structures.
    paths, seed, steps_per_period, scatter
        As in `simulate`.
    drift_times : Array
        For each displacement the time in which its plastic drift decays [s].
    grounds : sequence of Ground
        Samples of an uncertain ground, one for each motion.
    step : float, optional
        Time step [s], by default that of the shortest period.

    Returns
    -------
    SimulationRun
        The simulation, without its duration.
    """
    watched = np.concatenate([group.watched for group in groups])
    order = np.argsort(watched)
    scale, period = np.empty((2, watched.size))
    for group in groups:
        scale[group.watched] = group.scale
        period[group.watched] = group.period
    soil = ground.lone_filter()
    rates = -np.linalg.eigvals(soil.arrays.matrix).real if soil.states else np.array([np.inf])
    soils = [sampled.lone_filter() for sampled in grounds] or [soil]
    fastest = [np.float64(sampled.fastest) for sampled in soils if sampled.states]
    periods = [float(2 * np.pi / frequency) for frequency in fastest]
    periods += [group.shortest for group in groups]
    memory = max(float((1 / rates).max()), *(group.slowest for group in groups))
    dt = step or min(periods) / steps_per_period
    every = max(1, steps_per_period // SAMPLES_PER_PERIOD)
    steps, roots = zip(*(ground_steps(sampled, dt) for sampled in soils), strict=True)
    plan = Plan(dt, every, 0, 0, groups=int(np.ceil(paths / LANES)), seed=seed, scatter=scatter)
    soil_steps = UncertainGround(steps, roots) if grounds else steps[0]
    ensemble = Ensemble([group.part for group in groups], soil_steps, roots[0], plan)
    times = np.broadcast_to(drift_times, watched.size)
    return SimulationRun(ensemble, order, scale, period, times, memory)


def ground_steps(soil: Filter, dt: float) -> tuple[FilterSteps, Array]:
    """The time steps of the filter of a ground, and the square root of its stationary covariance.

    With the square root, the initial states of the filter are drawn.
    """
    matrix, noise, output = soil.arrays
    intensity = 2 * np.pi * soil.intensity
    return filter_steps(matrix, noise, output, intensity, dt), _root(matrix, noise, intensity)


def _root(matrix: Array, noise: Array, intensity: float) -> Array:
    """Symmetric square root of the stationary covariance of a filter.

    Normal numbers times this matrix are initial states with which the ground motion is stationary
    from its start. The symmetric root is unique. A root of eigenvectors is not, since their signs
    may change with rounding errors.
    """
    if not len(noise):
        return np.zeros((0, 0))
    covariance = scipy.linalg.solve_continuous_lyapunov(matrix, -intensity * np.outer(noise, noise))
    values, vectors = np.linalg.eigh(0.5 * (covariance + covariance.T))
    root: Array = vectors * np.sqrt(np.maximum(values, 0)) @ vectors.T
    return root
