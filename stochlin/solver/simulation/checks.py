"""Checks of a simulation: its arguments, its memory and time, and whether responses are finite."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import cores
from stochlin.kernels.simulation.ensemble import SteppedOscillators, SteppedStructures
from stochlin.kernels.simulation.laws import BILINEAR, OTHER_LAW, VISCOUS
from stochlin.kernels.simulation.stepping import LANES
from stochlin.messages import brief
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.start import Start
from stochlin.models.structures import AnyStructure
from stochlin.models.systems import Assembly, StickModel
from stochlin.models.uncertain import median_of
from stochlin.solver.simulation.ensembles import SimulationRun
from stochlin.solver.tables.checks import check_duration, check_scalars, check_work

SCALARS_ONLY = "scalars, one structure an entry; correlate(method='simulation') takes arrays"
# numbers that are in memory at once for each step, and for each peak
NUMBERS_PER_STEP = 6
NUMBERS_PER_PEAK = 6


def check_simulation(
    structures: Sequence[AnyStructure],
    ground: Ground,
    paths: int,
    duration: float | None,
    envelope: Envelope | None,
    scatter: float,
    start: Start | None,
) -> None:
    """Raise if arguments of `simulate` do not suit one another, or would not fit into memory."""
    roles = checked_structures(structures, ground)
    _check_motion(duration, envelope, scatter, start, roles)
    _check_memory(sum(structure.floor_count for structure in roles.values()), paths)


def checked_structures(
    structures: Sequence[AnyStructure], ground: Ground
) -> dict[str, AnyStructure]:
    """Medians of structures by role; raises if these or the ground do not suit `simulate`."""
    if not isinstance(structures, Sequence):
        raise TypeError(f"structures = {brief(structures)}; allowed: a list of structures")
    if not structures:
        raise ValueError("structures is empty; allowed: at least one")
    roles = {f"structures[{number}]": median_of(model) for number, model in enumerate(structures)}
    for role, structure in roles.items():
        expect(structure, AnyStructure, role)
        check_scalars(structure, role, SCALARS_ONLY)
    check_scalars(median_of(ground), "ground", SCALARS_ONLY)
    return roles


def _check_motion(
    duration: float | None,
    envelope: Envelope | None,
    scatter: float,
    start: Start | None,
    structures: Mapping[str, AnyStructure],
) -> None:
    """Raise if the duration does not fit other arguments, or a structure has a longer period."""
    if duration is None:
        if envelope is not None:
            raise ValueError("envelope is given without a duration; allowed: both, or neither")
        if start is not None:
            raise ValueError("start is given without a duration; allowed: both, or neither")
        if scatter:
            raise ValueError(f"scatter = {scatter:g} is given without a duration; give one")
        return
    check_duration(duration, structures)


def _check_memory(structures: int, paths: int) -> None:
    """Raise a ValueError if the moments of all pairs of structures would not fit into memory."""
    at_once = min(cores(), -(-paths // LANES))
    check_work(
        f"{structures} structures on one ground need",
        "simulate fewer structures at a time",
        numbers=structures**2 * (4.0 * LANES * at_once + 12),
    )


def check_finite(run: SimulationRun, duration: float, functions: int, times: int = 1) -> None:
    """Raise a ValueError if simulations of finite motions would take too much memory or time.

    ``functions`` is the number of quantities with a peak, ``times`` the number of simulations.
    """
    steps = duration / run.plan.dt
    paths = run.plan.groups * LANES
    check_work(
        f"duration = {duration:g} s, in steps of {run.plan.dt:.2g} s "
        f"and on {paths} paths, would take",
        "shorten it, lower paths, or leave out the shortest period",
        numbers=NUMBERS_PER_STEP * steps + NUMBERS_PER_PEAK * 2.0 * paths * functions,
        seconds=seconds_of(run, times * steps, 2.0 * functions),
        cores=cores(),
    )


def seconds_of(run: SimulationRun, steps: float, distances: float = 0.0) -> float:
    """Seconds that one core takes for this many time ``steps``, approximately.

    At each step, ``distances`` relative displacements are recorded.
    """
    parts = run.ensemble.parts
    kinds = [part.elements.kind for part in parts if isinstance(part, SteppedStructures)]
    together = sum(part.size for part in parts if isinstance(part, SteppedOscillators))
    all_kinds = np.concatenate([np.full(together, BILINEAR), *kinds])
    step = (
        8e-9  # of the ground
        + 1.2e-9 * float((all_kinds < VISCOUS).sum())
        + 2.4e-7 * float((all_kinds == VISCOUS).sum())  # whose force is a power of the velocity
        + 6e-8 * float((all_kinds >= OTHER_LAW).sum())
        + 2e-9 * sum(kind.size**2 for kind in kinds)  # pairs of storeys of one building
        + 1e-9 * distances
    )
    return step * steps * run.plan.groups * LANES


def check_response(system: Assembly, finite: Array) -> None:
    """Raise an ArithmeticError if the response of a floor (motions, floors) is not ``finite``."""
    lost = ~np.logical_and.reduceat(finite, system.first[:-1], axis=1)
    if lost.any():
        worst = int(np.argmax(lost.sum(axis=0)))
        what = f"structures, number {worst + 1}: its response is no longer finite"
        raise ArithmeticError(f"{what}; {runs_away([system.sticks[worst]])}")


def runs_away(sticks: Sequence[StickModel]) -> str:
    """What is wrong with laws of structures whose response is no longer finite, and the cure."""
    return (
        f"the rates of the law {names_of_laws(sticks)} grow without end: give a law in which z "
        "and all other states stay bounded, such as v - abs(v)*z, or weaker motions"
    )


def names_of_laws(sticks: Sequence[StickModel]) -> str:
    """The hysteresis laws of structures, each with the module that defines it."""
    laws = {type(stick.law) for stick in sticks}
    return " or ".join(sorted(f"{law.__qualname__} ({law.__module__})" for law in laws))
