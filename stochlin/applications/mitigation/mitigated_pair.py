"""A pair of buildings with a measure: by simulation and by linearization, and the least measures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.applications.separation.energy_gap import SIDES
from stochlin.applications.separation.existing_gap import DAMPINGS, Required
from stochlin.applications.separation.storeys import linearized_at_roof
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.contacts import reduced_mass
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.systems import Arrangement, arrangement_of, first_mode
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.simulation.finite_motions import (
    LINK_PEAKS,
    enough_motions,
    keeping_apart,
    pair_separation,
    quantiles_of,
    required_gaps,
)
from stochlin.solver.simulation.simulation import simulate
from stochlin.solver.tables import labels
from stochlin.solver.tables.labels import LINK

AS_BUILT, GIVEN, LEAST = "as built", "given", "least"  # kinds of measures
QUANTILE = 0.95  # of the forces, strokes and energies of devices over motions
CONSTANTS = np.append(0.0, np.geomspace(1e-3, 10, 13))  # damping constants that are tried, over 2 m w


class MeasureLine(NamedTuple):
    """A row of the table of measures; ``measure`` is None if a search finds none."""

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


@dataclass(frozen=True)
class MitigatedPair:
    """Two structures, with strengths in metres, and all conditions that a measure does not change."""

    structures: tuple[Any, Any]
    ground: Ground
    gap: float
    motion: Mapping[str, Any]  # other options of `simulate`
    paths: tuple[int, int]  # fewest and most motions

    def changed(self, measure: Measure) -> list[Any]:
        """The structures with the added damping of the measure."""
        added = measure.added_damping_1, measure.added_damping_2
        return [
            applied(partial(_damped, added=float(more), number=number), structure)
            for number, (structure, more) in enumerate(zip(self.structures, added, strict=True), 1)
        ]

    def known(self, measure: Measure) -> tuple[Any, Any]:
        """The changed structures with uncertain parameters at their medians."""
        first, second = map(median_of, self.changed(measure))
        return first, second

    def system(self, measure: Measure) -> Arrangement:
        """The structures with the links of the measure, which have to fit."""
        return arrangement_of(self.known(measure), measure.links)

    @cached_property
    def built(self) -> xr.Dataset:
        """The simulated motions of the buildings as built."""
        return enough_motions(partial(self.simulated, Measure()), *self.paths)

    def simulated(self, measure: Measure, paths: int | None = None) -> xr.Dataset:
        """The simulated motions, as many as for the buildings as built or another number of them."""
        return simulate(
            self.changed(measure),
            self.ground,
            **self.motion,
            paths=paths or self.built.sizes["path"],
            link=measure.links,
        )

    def row(self, line: MeasureLine) -> xr.Dataset:
        """All results of a measure."""
        measure = line.measure
        described = "" if measure is None else measure.describe()
        texts = {"kind": line.kind, "description": described, "missing": line.missing}
        table = xr.Dataset(texts, {"measure": line.name})
        if measure is None:
            return table
        motions = self.built if measure == Measure() else self.simulated(measure)
        gaps = zip(labels.VALUE_AND_ENDS, required_gaps(motions), strict=True)
        columns = {
            "added_damping_1": measure.added_damping_1,
            "added_damping_2": measure.added_damping_2,
            "link_damping_constant": _of_dashpots(measure.links),
            **{f"required_gap{end}": gap for end, gap in gaps},
            **keeping_apart(pair_separation(motions), self.gap),
            **self._linearized(measure),
        }
        devices = _devices(motions, self.system(measure)) if measure.links else xr.Dataset()
        return table.assign(columns).merge(devices)

    def _linearized(self, measure: Measure) -> dict[str, float]:
        """Correlation and standard deviation of ``u_1 - u_2`` by linearization; NaN if not solved."""
        rho = apart = np.nan
        # There is no solution, or no stationary response: storeys without stiffness.
        with suppress(ArithmeticError, ValueError):
            rho, apart = linearized_at_roof(self.known(measure), median_of(self.ground), measure.links)
        return {"rho": rho, "relative_displacement_std": apart}

    def searches(self) -> list[Search]:
        """Searches for added damping, and for a dashpot if the structures have masses.

        There is none if the gap is enough as built.
        """
        if required_gaps(self.built)[0] <= self.gap:
            return []
        listed, pair = [], self.known(Measure())
        for side, shares in SIDES.items():
            present = max(float(s.damping) for s, share in zip(pair, shares, strict=True) if share)
            tried = DAMPINGS[present + DAMPINGS < 1]
            searched = f"added damping up to {100 * tried[-1]:.3g} % of critical"
            listed.append(Search(f"least damping, {side}", partial(_damping, shares), tried, searched))
        if (scale := self._dashpot_scale()) is not None:
            tried = scale * CONSTANTS
            searched = f"a damping constant up to {1e-6 * tried[-1]:.3g} MN s/m"
            listed.append(Search("least dashpot between", _dashpot, tried, searched))
        return listed

    def least(self, search: Search) -> MeasureLine:
        """The row with the least measure of a search, or the reason why there is none."""

        def gaps(value: float, paths: int) -> tuple[float, float, float]:
            return required_gaps(self.simulated(search.build(value), paths))

        paths, known = self.built.sizes["path"], {0.0: required_gaps(self.built)}
        value = Required(gaps, self.gap, paths, known, interval=False).least(search.values).value
        if np.isfinite(value):
            return MeasureLine(search.name, LEAST, search.build(value))
        missing = f"{search.searched} was searched, and none is enough"
        return MeasureLine(search.name, LEAST, None, missing)

    def _dashpot_scale(self) -> float | None:
        """``2 m w`` [N s/m], with the reduced mass and the mean circular frequency of the first modes.

        None if a structure has no mass or no floors are at the same level.
        """
        try:
            self.system(_dashpot(0.0))
        except ValueError:
            return None
        modes = [first_mode(structure).arrays() for structure in self.known(Measure())]
        mass = float(reduced_mass(*(float(mode["mass"]) for mode in modes)))
        return 2 * mass * float(np.mean([2 * np.pi / float(mode["period"]) for mode in modes]))


def _damped(structure: Any, added: float, number: int) -> Any:
    """The structure, of this number, with more damping."""
    total = structure.damping + added
    if (largest := float(np.max(total))) >= 1:
        raise ValueError(
            f"added_damping_{number} = {added:g} raises the damping to {largest:g}; allowed: less than "
            "1 in total"
        )
    return replace(structure, damping=total)


def _damping(shares: tuple[float, float], added: float) -> Measure:
    return Measure(shares[0] * added, shares[1] * added)


def _dashpot(constant: float) -> Measure:
    return Measure(link=Link(damping_constant=constant))


def _of_dashpots(links: Sequence[Link]) -> float:
    """Damping constant of all links between both structures; NaN if some dashpots are not linear."""
    dashpots = [link for link in links if not link.within_one and link.damping_constant]
    if any(link.exponent != 1 for link in dashpots):
        return np.nan
    return sum(link.number("damping_constant") for link in dashpots)


def _devices(motions: xr.Dataset, system: Arrangement) -> xr.Dataset:
    """Kind and place of each link, and means and 95 % quantiles of its force, stroke and energy."""
    floors = system.floors
    ends = [(floors[t.floor], floors[t.other] if t.other >= 0 else "ground") for t in system.ties]
    columns: dict[str, Any] = {
        "link_kind": ["damper" if tie.link.within_one else "link" for tie in system.ties],
        "link_place": [f"{low} to {high}" for low, high in ends],
    }
    columns |= {
        f"{name}_quantile": quantiles_of(motions[name].values, np.array(QUANTILE)) for name in LINK_PEAKS
    }
    means = motions[[f"{name}_mean" for name in LINK_PEAKS]]
    return means.assign({name: (LINK, each) for name, each in columns.items()})
