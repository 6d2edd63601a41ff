"""Searches for the least damping and the least dashpot with which an aim is met."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.mitigation.mitigated_pair import MitigatedPair
from stochlin.analyses.separation.added_damping import SIDES
from stochlin.analyses.separation.existing_gap import DAMPINGS
from stochlin.analyses.separation.searches import Required, by_motions, least
from stochlin.analyses.simulation.finite_motions import required_gaps
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import reduced_mass
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.systems import arrangement_of, first_mode

CONSTANTS = np.append(0.0, np.geomspace(1e-3, 10, 13))  # damping constants that are tried, over 2 m w


Build = Callable[[float], Measure]


class MeasureLine(NamedTuple):
    """A row of the table of measures; ``measure`` is None if a search found none."""

    name: str
    kind: str
    measure: Measure | None
    aim: str = ""
    missing: str = ""


class Search(NamedTuple):
    """A search for the least measure, with the values that are tried."""

    name: str
    aim: str
    build: Build
    required: Callable[[Build], Required]  # for the aim, as a function of the value
    values: Array
    searched: str  # what they are, for a reader, with a place for the largest
    scale: float = 1.0  # of the largest, in the unit of that text

    def result(self) -> MeasureLine:
        """The row with the least measure, or the reason why none was found."""
        value = least(self.required(self.build), self.values).value
        if np.isfinite(value):
            return MeasureLine(self.name, "least", self.build(value), self.aim)
        largest = f"{self.scale * self.values[-1]:.3g}"
        tried = f"{self.searched.format(largest)} was searched, and none is enough"
        return MeasureLine(self.name, "least", None, self.aim, tried)


def searches(pair: MitigatedPair, limit: float | None) -> list[Search]:
    """Searches for added damping, and for a dashpot if the structures have masses, for each aim.

    There is no search for an aim that is met as built.
    """
    listed = []
    if required_gaps(pair.built)[0] > pair.gap:

        def in_motions(build: Build) -> Required:
            def simulated(value: float, paths: int) -> xr.Dataset:
                return pair.simulated(build(value), paths)

            return by_motions(simulated, pair.gap, 0.0, pair.built, interval=False)

        listed += _searches(pair, "confidence", "", in_motions)
    if limit is not None and (worst := pair.worst_amplification(Measure())) > limit:

        def in_records(build: Build) -> Required:
            return Required(lambda x: pair.worst_amplification(build(x)), limit, known={0.0: worst})

        listed += _searches(pair, "amplification", " (limit)", in_records)
    return listed


def _searches(
    pair: MitigatedPair,
    aim: str,
    suffix: str,
    required: Callable[[Callable[[float], Measure]], Required],
) -> list[Search]:
    """The searches for one aim."""
    percent, newtons = "added damping up to {} % of critical", "a damping constant up to {} MN s/m"
    listed = []
    for side, shares in SIDES.items():
        name, tried = f"least damping, {side}{suffix}", _dampings(pair, shares)
        listed.append(Search(name, aim, _damping(shares), required, tried, percent, 100))
    if (scale := _dashpot_scale(pair)) is not None:
        name, tried = f"least dashpot between{suffix}", scale * CONSTANTS
        listed.append(Search(name, aim, _dashpot, required, tried, newtons, 1e-6))
    return listed


def _damping(shares: tuple[float, float]) -> Callable[[float], Measure]:
    return lambda added: Measure(shares[0] * added, shares[1] * added)


def _dashpot(constant: float) -> Measure:
    return Measure(link=Link(damping_constant=constant))


def _dampings(pair: MitigatedPair, shares: tuple[float, float]) -> Array:
    """Added damping ratios that are tried, with which the total damping ratio is below 1."""
    built = pair.known(Measure())
    own = max(float(s.damping) for s, share in zip(built, shares, strict=True) if share)
    values: Array = DAMPINGS[own + DAMPINGS < 1]
    return values


def _dashpot_scale(pair: MitigatedPair) -> float | None:
    """``2 m w`` [N s/m], with the reduced mass and the mean circular frequency of the first modes.

    None if a structure has no mass or no floors are at the same level.
    """
    try:
        arrangement_of(pair.known(Measure()), _dashpot(0.0).links)
    except ValueError:
        return None
    modes = [first_mode(structure) for structure in pair.known(Measure())]
    mass = float(reduced_mass(*(float(mode.arrays()["mass"]) for mode in modes)))
    return 2 * mass * float(np.mean([2 * np.pi / float(mode.arrays()["period"]) for mode in modes]))
