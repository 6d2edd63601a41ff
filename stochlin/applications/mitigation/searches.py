"""Searches for the least damping and the least dashpot with which an aim is met."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.applications.mitigation.mitigated_pair import MitigatedPair
from stochlin.applications.separation.energy_gap import SIDES
from stochlin.applications.separation.existing_gap import DAMPINGS, Required
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import reduced_mass
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.systems import arrangement_of, first_mode
from stochlin.solver.simulation.finite_motions import required_gaps

LEAST = "least"
CONSTANTS = np.append(0.0, np.geomspace(1e-3, 10, 13))  # damping constants that are tried, over 2 m w


class MeasureLine(NamedTuple):
    """A row of the table of measures; ``measure`` is None if a search found none."""

    name: str
    kind: str
    measure: Measure | None
    missing: str = ""


class Search(NamedTuple):
    """A search for the least measure with which the existing gap has the wanted confidence."""

    name: str
    build: Callable[[float], Measure]
    values: Array  # that are tried
    searched: str  # what they are, for a reader

    def result(self, pair: MitigatedPair) -> MeasureLine:
        """The row with the least measure, or the reason why none was found."""

        def gaps(value: float, paths: int) -> tuple[float, float, float]:
            return required_gaps(pair.simulated(self.build(value), paths))

        paths, known = pair.built.sizes["path"], {0.0: required_gaps(pair.built)}
        value = Required(gaps, pair.gap, paths, known, interval=False).least(self.values).value
        if np.isfinite(value):
            return MeasureLine(self.name, LEAST, self.build(value))
        return MeasureLine(self.name, LEAST, None, f"{self.searched} was searched, and none is enough")


def searches(pair: MitigatedPair) -> list[Search]:
    """Searches for added damping, and for a dashpot if the structures have masses.

    There is none if the gap is enough as built.
    """
    if required_gaps(pair.built)[0] <= pair.gap:
        return []
    listed = []
    for side, shares in SIDES.items():
        tried = _dampings(pair, shares)
        searched = f"added damping up to {100 * tried[-1]:.3g} % of critical"
        listed.append(Search(f"least damping, {side}", _damping(shares), tried, searched))
    if (scale := _dashpot_scale(pair)) is not None:
        tried = scale * CONSTANTS
        searched = f"a damping constant up to {1e-6 * tried[-1]:.3g} MN s/m"
        listed.append(Search("least dashpot between", _dashpot, tried, searched))
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
