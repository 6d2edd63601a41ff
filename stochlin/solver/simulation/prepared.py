"""Structures that are simulated in several finite motions, prepared and checked once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.simulation.stepping import LANES, whole_groups
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.systems import Assembly
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.checks import check_finite, checked_structures, seconds_of
from stochlin.solver.simulation.simulation import in_finite_motions, labelled_motions
from stochlin.solver.simulation.statistics import required_gaps
from stochlin.solver.tables.checks import check_duration

SHORT_SIMULATION = 0.5  # [s] of a simulation whose number of motions is open
FEWEST_MOTIONS = 256  # motions of such a simulation
MOST_MOTIONS = 2048
PRECISION = 0.1  # half a 95 % interval of a gap over the gap, at which motions are enough
MARGIN = 1.2  # motions that are simulated, over those that the precision needs


class FiniteMotion(NamedTuple):
    """The motions in which structures are simulated."""

    duration: float  # [s]
    envelope: Envelope | None
    scatter: float
    seed: int


@dataclass(frozen=True)
class PreparedStructures:
    """Structures and ground, whose parameters may be uncertain, for simulations in finite motions.

    Strengths are in metres, by the ground at its medians.
    """

    structures: tuple[Any, ...]
    ground: Any
    medians: tuple[Any, ...]  # of the structures
    usual: Ground  # the ground at its medians
    system: Assembly  # of the medians, without links
    motion: FiniteMotion
    fewest: int  # motions
    most: int

    @classmethod
    def of(
        cls,
        by_role: Mapping[str, Any],
        ground: Any,
        motion: FiniteMotion,
        paths: int | None = None,
        times: int = 1,
    ) -> PreparedStructures:
        """Structures by role for ``paths`` motions, or for as many as take a short time.

        Raises if structures do not suit `simulate`, the duration is shorter than a period, or so
        many ``times`` of the simulation would take too long.
        """
        usual = median_of(ground)
        models = list(by_role.values())
        checked_structures(models, usual)
        check_duration(motion.duration, {role: median_of(model) for role, model in by_role.items()})
        metres_of = partial(strength_in_metres, ground=usual)
        in_metres = [applied(metres_of, model) for model in models]
        medians = tuple(map(median_of, in_metres))
        moving = in_finite_motions(medians, usual, paths=paths or LANES)
        functions = sum(map(len, moving.functions.values()))
        check_finite(moving.run, motion.duration, functions, times)
        fewest = paths
        if fewest is None:
            steps = motion.duration / moving.run.plan.dt
            seconds_per_motion = seconds_of(moving.run, steps, 2.0 * functions) / LANES
            affordable = SHORT_SIMULATION / seconds_per_motion
            fewest = whole_groups(int(np.clip(affordable, FEWEST_MOTIONS, MOST_MOTIONS)))
        return cls(
            structures=tuple(in_metres),
            ground=ground,
            medians=medians,
            usual=usual,
            system=moving.system,
            motion=motion,
            fewest=fewest,
            most=paths or MOST_MOTIONS,
        )

    def simulated(
        self,
        paths: int,
        confidence: float | None = None,
        progress: Progress | None = None,
        *,
        structures: Sequence[Any] | None = None,
        ground: Any = None,
        link: Sequence[Link | None] | None = None,
    ) -> xr.Dataset:
        """Simulated motions, with the quantile of a confidence; structures or ground may differ."""
        motion = self.motion
        levels = [] if confidence is None else [confidence]
        moving = in_finite_motions(
            self.structures if structures is None else structures,
            self.ground if ground is None else ground,
            link,
            paths=paths,
            seed=motion.seed,
            scatter=motion.scatter,
        )
        return labelled_motions(moving, motion.duration, motion.envelope, levels, progress)

    def enough(self, confidence: float, progress: Progress | None = None) -> xr.Dataset:
        """As many simulated motions as the gap for a confidence needs."""
        simulated = partial(self.simulated, confidence=confidence, progress=progress)
        return enough_motions(simulated, self.fewest, self.most)


def enough_motions(simulated: Callable[[int], xr.Dataset], paths: int, most: int) -> xr.Dataset:
    """As many simulated motions as the first quantile needs, from ``paths`` to ``most``.

    They are enough if the 95 % interval of the gap is no longer than `PRECISION` times the gap to
    both sides. ``simulated`` simulates a number of motions.
    """
    motions = simulated(paths)
    gap, lower, upper = required_gaps(motions)
    wide = (upper - lower) / (2 * PRECISION * gap) if upper > lower and gap > 0 else 0.0
    if wide <= 1 or paths >= most:
        return motions
    return enough_motions(simulated, whole_groups(int(min(most, MARGIN * paths * wide**2))), most)
