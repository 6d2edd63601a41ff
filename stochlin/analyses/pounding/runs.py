"""Responses of a row of buildings to motions, in the row and each alone, and their time steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.analyses.pounding.rows import Building, Standing, shortest_mode, slow_approach
from stochlin.analyses.simulation.connected_structures import modes_of
from stochlin.analyses.tables.work import check_work
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, cores, in_order
from stochlin.kernels.pounding import impacts
from stochlin.kernels.pounding import run as kernel
from stochlin.kernels.records.runs import SampledMotion
from stochlin.kernels.simulation.account import Account
from stochlin.kernels.simulation.time_step import Places
from stochlin.models.buildings import ShearBuilding
from stochlin.models.contacts import Contact, Element

STEPS_PER_CONTACT = 16  # default number of steps in half a period of a contact
# For each of them: steps in the shortest and in the first period, and, for stereomechanical impacts,
# steps near contact in one without.
OF_SHORTEST, OF_FIRST, AT_BLOWS = 2.5, 12.5, 1.0
TYPICAL = 1.0  # [m/s]: rate of penetration for which the half-period of a Hertz contact is taken
ON_GRID = 1e-9  # share of a time step within which an output time counts as a sample of the record
LANES = 64  # motions that are stepped together
FEW = 4  # motions that take hardly more time than one
OPERATIONS = 60.0  # in a step for each floor, besides those with every other floor
NEAR = 0.03  # share of the steps that are taken for divided near contact


class RowResponse(NamedTuple):
    """Response of a row of buildings to one motion."""

    numbers: Array  # (rows,) at its end
    impacts: Array  # (impacts, COLUMNS): the table of `kernels.pounding.impacts`
    time: Array  # (times,) [s]: times of the history, from the beginning of the motion
    history: Array  # (times, rows)
    at: Places
    to: Account

    def of(self, first: int, last: int) -> Array:
        """The numbers at the end, from the row ``first`` to ``last``."""
        return self.numbers[first:last]

    @property
    def peaks(self) -> Array:
        """Largest absolute displacement of each floor [m]."""
        to = self.to
        return np.maximum(self.of(to.highest, to.lowest), -self.of(to.lowest, to.acceleration))


Outcome = RowResponse | ArithmeticError


def paces_of(
    standing: Standing,
    contact: Contact | None,
    grounds: Sequence[SampledMotion],
    steps_per_contact: int = STEPS_PER_CONTACT,
) -> list[kernel.StepCounts]:
    """Time steps in an interval of each motion, an even number, and near contact."""
    first = min(float(modes_of(s.system)[0].max()) for s in standing.arrangement.stacks)
    longest = min(first / OF_FIRST, shortest_mode(standing) / OF_SHORTEST) / steps_per_contact
    half = np.inf
    if isinstance(contact, Element):
        half = min(_half_period(contact, float(mass)) for mass in standing.reduced)

    def pace(dt: float) -> kernel.StepCounts:
        cuts = 2 * max(1, int(np.ceil(0.5 * dt / longest * (1 - ON_GRID))))
        substeps = np.ceil(dt / cuts * steps_per_contact / half)
        if not isinstance(contact, Element):
            substeps = np.ceil(AT_BLOWS * STEPS_PER_CONTACT)
        return kernel.StepCounts(cuts, max(1, int(substeps)))

    return [pace(ground.dt) for ground in grounds]


def _half_period(contact: Element, reduced: float) -> float:
    """Half a period of a contact [s], or the time in which its dashpot stops both sides, if shorter."""
    law = contact.force_law(reduced)
    scale = float(contact.time_scale(reduced, TYPICAL))
    if not law.over_approach and law.damping > 0:
        scale = min(scale, reduced / float(law.damping))
    return np.pi * scale


def check_runs(
    standing: Standing, grounds: Sequence[SampledMotion], paces: Sequence[kernel.StepCounts]
) -> None:
    """Raise a ValueError if the motions would take too much time or memory."""
    n, lanes = int(standing.first[-1]), min(LANES, len(grounds))
    samples = [len(ground.acceleration) for ground in grounds]
    steps = sum(
        p.cuts * (1.0 + NEAR * (p.substeps - 1)) * many for p, many in zip(paces, samples, strict=True)
    )
    operations = 3.0 * n * n + OPERATIONS * n
    many = f"{len(grounds)} motions, " if len(grounds) > 1 else ""
    seconds = sum(ground.dt * (size - 1) for ground, size in zip(grounds, samples, strict=True))
    shortest = min(ground.dt / pace.cuts for ground, pace in zip(grounds, paces, strict=True))
    closed = min(ground.dt / p.cuts / p.substeps for ground, p in zip(grounds, paces, strict=True))
    check_work(
        f"{many}{seconds:g} s of motion, in steps of {shortest:.3g} s, near contact of {closed:.3g} s, "
        "would take",
        "take softer structures, a softer contact, or "
        f"{'fewer motions' if many else 'a shorter record'}",
        {
            "operations in a row": 2 * steps * operations,
            "steps of a row": 2 * steps / lanes,
            "numbers": (standing.row.places[1].rows + 2.0) * max(samples),
        },
        min(cores(), len(grounds)),
    )


def responses(
    structures: Sequence[Building],
    row: kernel.BuildingRow,
    grounds: Sequence[SampledMotion],
    paces: Sequence[kernel.StepCounts],
    shortest: float,
    keep: int = kernel.NOTHING,
    progress: Progress | None = None,
    meets: Sequence[bool] | None = None,
) -> list[Outcome]:
    """Response of the row to each motion, or the error of one that could not be computed.

    ``shortest`` is the shortest of the first periods [s]. In motions where ``meets`` is false no contact
    acts. Histories are kept of the first motion only.
    """
    acts = np.ones(len(grounds), bool) if meets is None else np.array(meets)
    batches = list(_batches(grounds, paces))
    at, to = row.places
    outcomes: dict[int, Outcome] = {}

    def run(number: int) -> kernel.RunResult:
        batch = batches[number]
        motions = _motions(batch, grounds, acts, shortest)
        return kernel.run(row, motions, paces[batch[0]], keep)

    for batch, done in zip(batches, in_order(run, len(batches), progress), strict=True):
        lanes = done.impacts[:, impacts.LANE]
        for lane, number in enumerate(batch):
            lines = done.impacts[lanes == lane]
            response = RowResponse(done.x[:, lane], lines, done.time, done.history, at, to)
            outcomes[number] = _failure(structures, response) or response
    return [outcomes[number] for number in range(len(grounds))]


def with_and_without(
    structures: Sequence[Building],
    standing: Standing,
    grounds: Sequence[SampledMotion],
    paces: Sequence[kernel.StepCounts],
    shortest: float,
    keep: int = kernel.NOTHING,
    progress: Progress | None = None,
) -> list[tuple[Outcome, Outcome]]:
    """Responses of the buildings in the row and of each alone, as in `responses`."""
    count = len(grounds)
    if standing.alone.elements is standing.row.elements:
        twice, steps = [*grounds, *grounds], [*paces, *paces]
        meets = [True] * count + [False] * count
        both = responses(structures, standing.row, twice, steps, shortest, keep, progress, meets)
        return list(zip(both[:count], both[count:], strict=True))
    rows = standing.row, standing.alone  # which differ by the links between buildings

    def of_row(number: int) -> list[Outcome]:
        return responses(structures, rows[number], grounds, paces, shortest, keep)

    return list(zip(*in_order(of_row, len(rows), progress), strict=True))


def _batches(
    grounds: Sequence[SampledMotion], paces: Sequence[kernel.StepCounts]
) -> Iterator[list[int]]:
    """Numbers of motions that are stepped together: of one time step, the shortest first."""
    alike: dict[tuple[float, kernel.StepCounts], list[int]] = {}
    for number in np.argsort([len(ground.acceleration) for ground in grounds], kind="stable"):
        alike.setdefault((grounds[number].dt, paces[number]), []).append(int(number))
    for numbers in alike.values():
        size = min(LANES, max(FEW, -(-len(numbers) // cores())))
        for begin in range(0, len(numbers), size):
            yield numbers[begin : begin + size]


def _motions(
    batch: Sequence[int], grounds: Sequence[SampledMotion], meets: Array, shortest: float
) -> kernel.GroundMotions:
    """The motions of a batch."""
    members = [grounds[number].acceleration for number in batch]
    sizes = np.array([samples.size for samples in members])
    acceleration = np.zeros((sizes.max(), len(batch)))
    for lane, samples in enumerate(members):
        acceleration[: samples.size, lane] = samples
    slow = np.array([slow_approach(shortest, samples) for samples in members])
    return kernel.GroundMotions(
        acceleration, grounds[batch[0]].dt, sizes - 1, slow, meets[batch].astype(float)
    )


def _failure(structures: Sequence[Building], response: RowResponse) -> ArithmeticError | None:
    """The error of a motion that was ended before its end, because a building falls or numbers do."""
    failed = float(response.numbers[response.to.failed])
    if failed == np.inf:
        return None
    first = 0
    for number, structure in enumerate(structures, start=1):
        storeys = structure.storeys if isinstance(structure, ShearBuilding) else 1
        u = response.numbers[response.at.q + first : response.at.q + first + storeys]
        first += storeys
        if not isinstance(structure, ShearBuilding) or not structure.p_delta:
            continue
        heights = structure.arrays()["heights"].to_numpy()
        share = np.nan_to_num(np.abs(np.diff(u, prepend=0.0)) / heights, nan=np.inf)
        if share.max() > 1:
            worst = int(np.argmax(share))
            return ArithmeticError(
                f"pound: structure {number} falls over: by {failed:.4g} s after the beginning its "
                f"storey {worst + 1} has drifted by more than its height of {heights[worst]:g} m, "
                "since after yield the weight above takes more stiffness than it has; give it more "
                "hardening or strength, or a weaker motion"
            )
    return ArithmeticError(
        f"pound: the response is no longer finite {failed:.4g} s after the beginning; the rates of a "
        "law grow without end, or a structure, link or contact is too stiff for the time steps: give a "
        "law in which all states stay bounded, make it softer, or take more steps_per_contact"
    )
