"""Response of a pair of buildings with a measure: by simulation, by linearization and to records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.pounding.pounding import pound
from stochlin.applications.pounding.rows import checked_links
from stochlin.applications.records.cells import RECORD
from stochlin.applications.separation.storeys import linearized_at_roof
from stochlin.models.contacts import Contact
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.systems import Arrangement, arrangement_of, retrofitted
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
from stochlin.solver.tables.floors import LINK

SHOWN = "added_damping_1", "added_damping_2", "bumper_thickness"  # parameters of a measure
QUANTILE = 0.95  # of the forces, strokes and energies of devices over motions


@dataclass(frozen=True)
class MitigatedPair:
    """Two structures, with strengths in metres, and all conditions that a measure does not change."""

    structures: tuple[Any, Any]
    ground: Ground
    gap: float
    motion: Mapping[str, Any]  # other options of `simulate`
    paths: tuple[int, int]  # fewest and most motions
    contact: Contact | None
    records: Mapping[str, xr.DataArray]

    def changed(self, measure: Measure) -> tuple[Any, Any]:
        """The structures with added damping, stiffening and strengthening of the measure."""
        pair = [
            applied(partial(self._changed, measure=measure, number=n), structure)
            for n, structure in enumerate(self.structures, 1)
        ]
        return pair[0], pair[1]

    def known(self, measure: Measure) -> tuple[Any, Any]:
        """The changed structures with uncertain parameters at their medians."""
        first, second = self.changed(measure)
        return median_of(first), median_of(second)

    def _changed(self, structure: Any, measure: Measure, number: int) -> Any:
        names = ("added_damping", "stiffening", "strengthening")
        more, stiffening, strengthening = (float(getattr(measure, f"{n}_{number}")) for n in names)
        total = structure.damping + more
        if (largest := float(np.max(total))) >= 1:
            raise ValueError(
                f"added_damping_{number} = {more:g} raises the damping to {largest:g}; allowed: less "
                "than 1 in total"
            )
        if strengthening != 1 and not structure.yields:
            raise ValueError(
                f"strengthening_{number} = {strengthening:g}, and structure {number} never yields; "
                f"allowed: 1; give it a strength, or stiffening_{number}, which changes what is elastic"
            )
        return replace(retrofitted(structure, stiffening, strengthening), damping=total)

    def open_gap(self, measure: Measure) -> float:
        """Gap between the bumpers [m]."""
        left = self.gap - measure.bumper_thickness
        if left <= 0:
            raise ValueError(
                f"bumper_thickness = {measure.bumper_thickness:g} m fills the gap of {self.gap:g} m; "
                "allowed: less than the gap; take thinner bumpers"
            )
        return left

    def system(self, measure: Measure) -> Arrangement:
        """The structures with the links of the measure, which have to fit."""
        return arrangement_of(self.known(measure), checked_links(measure.links, len(self.structures)))

    def row(self, measure: Measure) -> xr.Dataset:
        """All results of a measure; contact between bumpers counts as pounding."""
        motions = self.built if measure == Measure() else self.simulated(measure)
        gaps = zip(labels.VALUE_AND_ENDS, required_gaps(motions), strict=True)
        columns = {
            **{name: getattr(measure, name) for name in SHOWN},
            "link_damping_constant": _of_dashpots(measure.links),
            **{f"required_gap{end}": gap + measure.bumper_thickness for end, gap in gaps},
            **keeping_apart(pair_separation(motions), self.open_gap(measure)),
            **self._linearized(measure),
        }
        devices = _devices(motions, self.system(measure)) if measure.links else xr.Dataset()
        recorded = self._recorded(measure) if self.records else xr.Dataset()
        return xr.Dataset(columns).merge(devices).merge(recorded)

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

    def _linearized(self, measure: Measure) -> dict[str, float]:
        """Correlation and standard deviation of ``u_1 - u_2`` by linearization; NaN if not solved."""
        rho = apart = np.nan
        # There is no solution, or no stationary response: storeys without stiffness.
        with suppress(ArithmeticError, ValueError):
            rho, apart = linearized_at_roof(self.known(measure), median_of(self.ground), measure.links)
        return {"rho": rho, "relative_displacement_std": apart}

    def _recorded(self, measure: Measure) -> xr.Dataset:
        """Amplifications, impacts and forces over ``record``, from pounding."""
        table = self._pounded(measure)
        ratio = table.peak / self._peaks_alone
        columns = {
            **{f"amplification_{n + 1}": ratio.isel(structure=n, drop=True) for n in (0, 1)},
            "largest_force": table.hardest_force,
            "deepest_compression": table.deepest_compression,
            "impacts": table.impacts.sum("contact"),
        }
        if measure.links:
            columns["largest_link_force"] = table.peak_link_force
        whole = {name: each.max(set(each.dims) - {RECORD}) for name, each in columns.items()}
        return xr.Dataset(whole).reset_coords(drop=True).drop_attrs()

    @cached_property
    def _peaks_alone(self) -> xr.DataArray:
        """Peaks of the floors as built and without neighbours [m], for each record."""
        return self._pounded(Measure()).peak_alone

    def _pounded(self, measure: Measure) -> xr.Dataset:
        """Pounding in all records; an ArithmeticError if one of them fails."""
        contact = measure.contact or self.contact
        gap, links = self.open_gap(measure), measure.links
        table = pound(self.known(measure), gap, contact, self.records, link=links)
        failed = table.missing.values[table.status.values != labels.CONVERGED]
        if failed.size:
            raise ArithmeticError(failed[0])
        return table


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
