"""Response of a pair of buildings with a measure: by simulation, by linearization and to records."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.mitigation.devices import Device, bumpers_of, links_of
from stochlin.analyses.pounding.pounding import pound
from stochlin.analyses.pounding.rows import checked_links
from stochlin.analyses.records.cells import RECORD
from stochlin.analyses.separation.storeys import linearized_at_roof
from stochlin.analyses.simulation.finite_motions import (
    keeping_apart,
    mean_with_error,
    pair_peaks,
    pair_separation,
    required_gaps,
)
from stochlin.analyses.simulation.ground_motions import simulated_motions
from stochlin.analyses.simulation.simulation import simulate
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.models.contacts import Contact
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.structures import Structure
from stochlin.models.systems import Arrangement, arrangement_of, retrofitted
from stochlin.models.uncertain import applied, median_of

MOST_BUMPED = 256  # simulated motions with contact, which take much longer than without
RECORDED = (
    *("amplification_1", "amplification_2", "impacts", "largest_force"),
    *("deepest_compression", "largest_link_force"),
)


@dataclass(frozen=True)
class MitigatedPair:
    """Two structures, with strengths in metres, and all conditions that a measure does not change."""

    structures: tuple[Any, Any]
    ground: Ground
    gap: float
    confidence: float
    motion: Mapping[str, Any]  # the other options of `simulate`
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

    def check(self, measure: Measure) -> None:
        """Raise a ValueError or TypeError for a measure that cannot be applied to the pair."""
        self.open_gap(measure)
        self.system(measure)

    def system(self, measure: Measure) -> Arrangement:
        """The structures with the links of the measure."""
        links = checked_links(measure.links, len(self.structures))
        return arrangement_of(self.known(measure), links)

    def contact_of(self, measure: Measure) -> Contact | None:
        """Contact between the structures with the measure."""
        return self.contact if measure.contact is None else measure.contact

    @property
    def weighed(self) -> bool:
        """Whether both structures have masses."""
        both = self.known(Measure())
        return all(not isinstance(each, Structure) or each.mass is not None for each in both)

    def simulated(self, measure: Measure) -> tuple[dict[str, float], list[Device]]:
        """Required gap [m], probability of no pounding [-] and mean peaks [m], and links, by simulation.

        Contact between bumpers counts as pounding.
        """
        motions = self._motions(measure)
        apart = keeping_apart(pair_separation(motions), self.open_gap(measure))
        taken = measure.bumper_thickness
        names = ("required_gap", "required_gap_lower", "required_gap_upper")
        row = {
            **{name: gap + taken for name, gap in zip(names, required_gaps(motions), strict=True)},
            **{name: float(share) for name, share in apart.items()},
        }
        for n, samples in enumerate(pair_peaks(motions).T, start=1):
            mean, error = mean_with_error(samples)
            row |= {f"peak_mean_{n}": float(mean), f"peak_mean_standard_error_{n}": float(error)}
        return row, links_of(motions, self.system(measure))

    def bumped(self, measure: Measure) -> tuple[list[Device], str]:
        """The bumpers of a measure in simulated motions with contact, and why values are missing.

        There are none where the measure has no bumpers.
        """
        contact = self.contact_of(measure)
        if contact is None or not measure.has_bumpers or not self.weighed:
            return [], ""
        gap, motions = self.open_gap(measure), self._shaking
        table = pound(self.known(measure), gap, contact, motions, link=measure.links)
        failed = table.missing.values[table.status.values != labels.CONVERGED]
        note = (
            f"bumpers, {failed.size} of {table.status.size} motions: {failed[0]}" if failed.size else ""
        )
        return bumpers_of(table, self.system(measure)), note

    @cached_property
    def _shaking(self) -> xr.DataArray:
        """The first of the simulated motions, on the median ground."""
        motion = dict(self.motion)
        paths = min(motion.pop("paths"), MOST_BUMPED)
        return simulated_motions(median_of(self.ground), **motion, paths=paths)

    def required_gap(self, measure: Measure) -> float:
        """Gap without pounding with the probability ``confidence`` [m]."""
        required, *_ = required_gaps(self._motions(measure))
        return required

    def linearized(self, measure: Measure) -> dict[str, float]:
        """Correlation and standard deviation of ``u_1 - u_2`` by linearization; NaN if not solved."""
        rho = apart = np.nan
        # There is no solution, or no stationary response: storeys without stiffness.
        with suppress(ArithmeticError, ValueError):
            rho, apart = linearized_at_roof(self.known(measure), median_of(self.ground), measure.links)
        return {"rho": rho, "relative_displacement_std": apart}

    def recorded(self, measure: Measure) -> tuple[dict[str, Array], list[Device]]:
        """Variables of `RECORDED` for the records (records,), and devices, from pounding."""
        contact = self.contact_of(measure)
        table = self._pounded(self.known(measure), self.open_gap(measure), contact, measure.links)
        ratio = table.peak / self._peaks_alone
        columns = {
            **{f"amplification_{n + 1}": ratio.isel(structure=n) for n in (0, 1)},
            "largest_force": table.hardest_force,
            "deepest_compression": table.deepest_compression,
            "largest_link_force": table.get(
                "peak_link_force", xr.full_like(table.hardest_force, np.nan)
            ),
        }
        values = {name: each.max(set(each.dims) - {RECORD}).values for name, each in columns.items()}
        system = self.system(measure)
        bumpers = bumpers_of(table, system) if measure.has_bumpers else []
        row = values | {"impacts": table.impacts.sum("contact").values}
        return row, [*links_of(table, system), *bumpers]

    def worst_amplification(self, measure: Measure) -> float:
        """Largest amplification of both buildings in all records [-]."""
        recorded, _ = self.recorded(measure)
        return float(max(recorded["amplification_1"].max(), recorded["amplification_2"].max()))

    @cached_property
    def _peaks_alone(self) -> xr.DataArray:
        """Peaks of the floors as built and without neighbours [m], for each record."""
        return self._pounded(self.known(Measure()), self.gap, self.contact).peak_alone

    def _pounded(
        self, pair: Sequence[Any], gap: float, contact: Contact | None, links: Sequence[Link] = ()
    ) -> xr.Dataset:
        """Pounding in all records; an ArithmeticError if one of them fails."""
        table = pound(pair, gap, contact, self.records, link=links)
        failed = table.missing.values[table.status.values != labels.CONVERGED]
        if failed.size:
            raise ArithmeticError(failed[0])
        return table

    def _motions(self, measure: Measure) -> xr.Dataset:
        return simulate(
            self.changed(measure),
            self.ground,
            **self.motion,
            quantiles=[self.confidence],
            link=measure.links,
        )
