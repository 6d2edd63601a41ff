"""Responses of a row of buildings to motions, in the row and each alone, and their time steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.applications.pounding.rows import PreparedRow
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores, in_order
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.pounding.run import RowResponse
from stochlin.kernels.records.runs import SampledMotion
from stochlin.models.contacts.elements import Contact, Element
from stochlin.models.start import Start
from stochlin.solver.simulation.checks import names_of_laws
from stochlin.solver.simulation.connected_structures import shortest_mode
from stochlin.solver.simulation.start_values import (
    AnyStart,
    checked_end_state,
    first_block,
    start_values,
)
from stochlin.solver.tables.checks import check_work

STEPS_PER_CONTACT = 16  # default number of steps in half a period of a contact
STEPS_AT_BLOWS = 16  # near a stereomechanical contact, in place of one step
# steps in the shortest period, and in the first period, for each step of a contact
STEPS_PER_SHORTEST_PERIOD = 5.0
STEPS_PER_FIRST_PERIOD = 12.5
# [m/s]: rate of penetration at which the half-period of a Hertz contact is that of its time steps
TYPICAL_RATE = 1.0
ROUNDING_OF_STEPS = 1e-9  # share of a number of time steps that may be rounding
MOTIONS_TOGETHER = 64  # motions that are stepped together
FEW_MOTIONS = 4  # motions that together take hardly more time than one
# operations in a step for each floor, beside those with other floors; also numbers of its state
OPERATIONS_PER_FLOOR = 60.0
SLOW_APPROACH = 1e-3  # approach velocity that counts as zero over max |a| T/(2 pi)
ROUNDING_OF_OVERLAP = 1e-12  # [m]: of floors at the start
SHARE_NEAR_CONTACT = 0.03  # share of the steps that are taken for divided near contact


def paces_of(
    prepared: PreparedRow,
    contact: Contact | None,
    grounds: Sequence[SampledMotion],
    steps_per_contact: int = STEPS_PER_CONTACT,
) -> list[kernel.StepCounts]:
    """Time steps in an interval of each motion, an even number, and near contact.

    Raises a ValueError if the motions would take too much time or memory.
    """
    systems = [stick.system for stick in prepared.assembly.sticks]
    shortest = min(map(shortest_mode, [prepared.system, *systems]))
    longest = min(prepared.shortest / STEPS_PER_FIRST_PERIOD, shortest / STEPS_PER_SHORTEST_PERIOD)
    longest /= steps_per_contact
    masses = prepared.reduced.tolist()
    half = [_half_period(contact, mass) for mass in masses if isinstance(contact, Element)]

    def pace(dt: float) -> kernel.StepCounts:
        cuts = 2 * max(1, int(np.ceil(0.5 * dt / longest * (1 - ROUNDING_OF_STEPS))))
        substeps = np.ceil(dt / cuts * steps_per_contact / min(half)) if half else STEPS_AT_BLOWS
        return kernel.StepCounts(cuts, max(1, int(substeps)))

    paces = [pace(ground.dt) for ground in grounds]
    _check_runs(prepared, grounds, paces)
    return paces


def _half_period(contact: Element, reduced: float) -> float:
    """Half a period of a contact [s], or the time until its dashpot stops both sides if shorter."""
    law = contact.force_law(reduced)
    n = float(law.exponent)
    scale = float((reduced * TYPICAL_RATE ** (1 - n) / law.stiffness) ** (1 / (n + 1)))
    if not law.over_approach and law.damping > 0:
        scale = min(scale, reduced / float(law.damping))
    return np.pi * scale


def _check_runs(
    prepared: PreparedRow, grounds: Sequence[SampledMotion], paces: Sequence[kernel.StepCounts]
) -> None:
    """Raise a ValueError if the motions would take too much time or memory."""
    n = prepared.row.parts.mass.size
    lanes = min(MOTIONS_TOGETHER, len(grounds))
    samples = [len(ground.acceleration) for ground in grounds]
    near = [p.cuts * (1.0 + SHARE_NEAR_CONTACT * (p.substeps - 1)) for p in paces]
    finest = min(ground.dt / p.cuts / p.substeps for ground, p in zip(grounds, paces, strict=True))
    seconds = sum(ground.dt * (size - 1) for ground, size in zip(grounds, samples, strict=True))
    operations = 3.0 * n * n + OPERATIONS_PER_FLOOR * n
    check_work(
        f"{len(grounds)} motions, {seconds:g} s of motion, in steps near contact of "
        f"{finest:.3g} s, would take",
        "take softer structures, a softer contact, or fewer and shorter motions",
        numbers=OPERATIONS_PER_FLOOR * n * max(samples),
        seconds=2 * float(np.dot(near, samples)) * (1e-9 * operations + 3e-6 / lanes),
        cores=min(cores(), len(grounds)),
    )


class RowRun(NamedTuple):
    """A response that is to be computed."""

    row: kernel.BuildingRow
    ground: SampledMotion
    pace: kernel.StepCounts
    start: Array | None = None  # block (rows,) at its beginning, if it does not begin from rest
    meets: bool = True  # whether contacts act


def runs_of(
    prepared: PreparedRow,
    ground: SampledMotion,
    pace: kernel.StepCounts,
    starts: Sequence[Array | None],
) -> list[RowRun]:
    """The row in a motion, each building alone, and the row in steps twice as long."""
    coarser = pace._replace(cuts=pace.cuts // 2)
    return [
        RowRun(prepared.row, ground, pace, starts[0]),
        RowRun(prepared.alone, ground, pace, starts[1], meets=False),
        RowRun(prepared.row, ground, coarser, starts[2]),
    ]


def starts_of(prepared: PreparedRow, start: AnyStart | None) -> list[Array | None]:
    """Blocks (rows,) with which the runs of `runs_of` begin; None from rest."""
    rows = [prepared.row, prepared.alone, prepared.row]
    if start is None:
        return [None] * len(rows)
    if isinstance(start, Start):
        values = start_values(prepared.assembly, start)
        _check_contacts(prepared, values)
        return [first_block(row, values, start.ground_velocity) for row in rows]
    sizes = [len(row.at_rest(1).block) for row in rows]
    return [*np.split(checked_end_state(start, sum(sizes)), np.cumsum(sizes)[:-1])]


def _check_contacts(prepared: PreparedRow, values: Array) -> None:
    """Raise a ValueError if floors overlap at the start."""
    contacts = prepared.row.contacts
    weights = contacts.weights[:, : values.shape[1]]  # walls start at their places
    depth = weights @ values[0] - contacts.gap
    worst = int(depth.argmax()) if depth.size else 0
    if depth.size and depth[worst] > ROUNDING_OF_OVERLAP:
        rate = weights[worst] @ values[1]
        way = "closes" if rate > 0 else "opens"
        what = f"start: the gap of contact {worst + 1} is {-depth[worst]:g} m and {way} at"
        raise ValueError(f"{what} {abs(rate):g} m/s; allowed: gaps of 0 or more at the start")


def responses(
    runs: Sequence[RowRun], prepared: PreparedRow, keep: bool, progress: Progress | None
) -> list[RowResponse]:
    """Responses, the first one with its history if it is to be kept."""
    batches = list(_batches(runs))
    responses: dict[int, RowResponse] = {}

    def batch_responses(batch: list[int]) -> list[RowResponse]:
        first = runs[batch[0]]
        motions = _motions([runs[n] for n in batch], prepared.shortest)
        blocks = [block for n in batch if (block := runs[n].start) is not None]
        start = np.stack(blocks, axis=1) if blocks else None
        return kernel.run(first.row, motions, first.pace, keep and 0 in batch, start)

    results = in_order(lambda number: batch_responses(batches[number]), len(batches), progress)
    for batch, responses_of_batch in zip(batches, results, strict=True):
        responses |= zip(batch, responses_of_batch, strict=True)
    return [responses[number] for number in range(len(runs))]


def _batches(runs: Sequence[RowRun]) -> Iterator[list[int]]:
    """Numbers of runs that are stepped together: of one row and time step, the shortest first."""
    alike: dict[tuple[int, float, kernel.StepCounts], list[int]] = {}
    for number in np.argsort([len(run.ground.acceleration) for run in runs], kind="stable"):
        run = runs[number]
        alike.setdefault((id(run.row), run.ground.dt, run.pace), []).append(int(number))
    for numbers in alike.values():
        size = min(MOTIONS_TOGETHER, max(FEW_MOTIONS, -(-len(numbers) // cores())))
        for begin in range(0, len(numbers), size):
            yield numbers[begin : begin + size]


def _motions(runs: Sequence[RowRun], shortest: float) -> kernel.GroundMotions:
    """The motions of runs stepped together; ``shortest`` is that of the first periods [s]."""
    members = [run.ground.acceleration for run in runs]
    sizes = np.array([samples.size for samples in members])
    acceleration = np.zeros((sizes.max(), len(runs)))
    for lane, samples in enumerate(members):
        acceleration[: samples.size, lane] = samples
    meets = np.array([float(run.meets) for run in runs])
    slow = SLOW_APPROACH * np.abs(acceleration).max(axis=0) * shortest / (2 * np.pi)
    return kernel.GroundMotions(acceleration, runs[0].ground.dt, sizes - 1, slow, meets)


def failure(prepared: PreparedRow, response: RowResponse) -> str:
    """Why a motion was ended early: a building falls, or numbers do; empty if it was not."""
    failed = float(response.end.motions.failed)
    if failed == np.inf:
        return ""
    system = prepared.assembly
    moved = response.end.coordinates.q[: prepared.row.parts.mass.size]  # without walls
    drifts = system.drifts @ system.displacements @ moved
    fallen = np.flatnonzero(system.fallen(drifts, system.limits))
    if fallen.size:
        return (
            f"pound: structure {fallen[0] + 1} falls over {failed:.4g} s after the beginning: it "
            "has drifted so far that no force is left to hold it, since its stiffness after "
            "yielding is negative; give it more hardening or strength, or a weaker motion"
        )
    return (
        f"pound: the response is no longer finite {failed:.4g} s after the beginning; the rates of "
        f"the law {names_of_laws(system.sticks)} grow without end, or a structure, link or contact "
        "is too stiff for the time steps: give a law in which all states stay bounded, make it "
        "softer, or take more steps_per_contact"
    )
