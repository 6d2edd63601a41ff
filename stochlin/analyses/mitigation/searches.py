"""Searches for the least damping and the least dashpot with which an aim is met."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from stochlin.analyses.mitigation.mitigated_pair import MitigatedPair
from stochlin.analyses.separation.added_damping import SIDES
from stochlin.analyses.separation.existing_gap import DAMPINGS
from stochlin.analyses.separation.searches import Required, least
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import reduced_mass
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.systems import arrangement_of, first_mode

CONSTANTS = np.append(0.0, np.geomspace(1e-3, 10, 13))  # damping constants that are tried, over 2 m w


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
    build: Callable[[float], Measure]
    outcome: Callable[[Measure], float]
    most: float  # largest outcome that meets the aim
    values: Array
    searched: str  # what they are, for a reader, with a place for the largest
    scale: float = 1.0  # of the largest, in the unit of that text

    def result(self) -> MeasureLine:
        """The row with the least measure, or the reason why none was found."""
        value = least(Required(lambda x: self.outcome(self.build(x)), self.most), self.values).value
        if np.isfinite(value):
            return MeasureLine(self.name, "least", self.build(value), self.aim)
        largest = f"{self.scale * self.values[-1]:.3g}"
        tried = f"{self.searched.format(largest)} was searched, and none is enough"
        return MeasureLine(self.name, "least", None, self.aim, tried)


def searches(site: MitigatedPair, limit: float | None) -> list[Search]:
    """Searches for added damping, and for a dashpot if the structures have masses, for each aim.

    There is no search for an aim that is met as built.
    """
    aims: list[tuple[str, str, Callable[[Measure], float], float]] = [
        ("confidence", "", site.required_gap, site.gap)
    ]
    if limit is not None:
        aims.append(("amplification", " (limit)", site.worst_amplification, limit))
    listed = []
    for aim, suffix, found_by, most in aims:
        outcome = cache(found_by)  # every search starts with the buildings as built
        if outcome(Measure()) <= most:
            continue
        for side, shares in SIDES.items():
            name = f"least damping, {side}{suffix}"
            arguments = aim, _damping(shares), outcome, most, _dampings(site, shares)
            listed.append(Search(name, *arguments, "added damping up to {} % of critical", 100))
        scale = _dashpot_scale(site)
        if scale is not None:
            name = f"least dashpot between{suffix}"
            arguments = aim, _dashpot, outcome, most, scale * CONSTANTS
            listed.append(Search(name, *arguments, "a damping constant up to {} MN s/m", 1e-6))
    return listed


def _damping(shares: tuple[float, float]) -> Callable[[float], Measure]:
    return lambda added: Measure(shares[0] * added, shares[1] * added)


def _dashpot(constant: float) -> Measure:
    return Measure(link=Link(damping_constant=constant))


def _dampings(site: MitigatedPair, shares: tuple[float, float]) -> Array:
    """Added damping ratios that are tried, with which the total damping ratio is below 1."""
    built = site.known(Measure())
    own = max(float(s.damping) for s, share in zip(built, shares, strict=True) if share)
    values: Array = DAMPINGS[own + DAMPINGS < 1]
    return values


def _dashpot_scale(site: MitigatedPair) -> float | None:
    """``2 m w`` [N s/m], with the reduced mass and the mean circular frequency of the first modes.

    None if a structure has no mass or no floors are at the same level.
    """
    try:
        arrangement_of(site.known(Measure()), _dashpot(0.0).links)
    except ValueError:
        return None
    modes = [first_mode(structure) for structure in site.known(Measure())]
    mass = float(reduced_mass(*(float(mode.arrays()["mass"]) for mode in modes)))
    return 2 * mass * float(np.mean([2 * np.pi / float(mode.arrays()["period"]) for mode in modes]))
