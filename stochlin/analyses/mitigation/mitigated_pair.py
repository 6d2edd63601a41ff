"""A pair of buildings with one measure against pounding at a time: simulated, linearized, on records."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.pounding import pound
from stochlin.analyses.separation.storeys import linearized_at_roof
from stochlin.analyses.simulation.finite_motions import (
    keeping_apart,
    pair_peaks,
    pair_separation,
    required_gaps,
)
from stochlin.analyses.simulation.simulation import simulate
from stochlin.kernels.basics.arrays import Array
from stochlin.models.contacts import Contact
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.measures import Measure

RECORDED = ("amplification_1", "amplification_2", "impacts", "largest_force")


@dataclass(frozen=True)
class MitigatedPair:
    """Two structures, by their yield displacements, and all that a measure leaves as it is."""

    structures: tuple[Any, Any]
    ground: Ground
    gap: float
    duration: float
    envelope: Envelope | None
    confidence: float
    scatter: float
    paths: int
    seed: int
    contact: Contact | None
    records: Mapping[str, xr.DataArray]

    def changed(self, measure: Measure) -> tuple[Any, Any]:
        """The structures with added damping."""
        added: tuple[Any, Any] = (measure.added_damping_1, measure.added_damping_2)
        pair = []
        for n, (structure, more) in enumerate(zip(self.structures, added, strict=True), start=1):
            total = float(structure.damping) + float(more)
            if total >= 1:
                raise ValueError(
                    f"added_damping_{n} = {float(more):g} makes the damping {total:g}; allowed: less "
                    "than 1 in all"
                )
            pair.append(replace(structure, damping=total))
        return pair[0], pair[1]

    def simulated(self, measure: Measure) -> dict[str, float]:
        """What random motions say: the required gap, how probable no pounding is, mean peaks."""
        motions = self._motions(measure)
        apart = keeping_apart(pair_separation(motions), self.gap)
        names = ("required_gap", "required_gap_lower", "required_gap_upper")
        row = {
            **dict(zip(names, required_gaps(motions), strict=True)),
            **{name: float(share) for name, share in apart.items()},
        }
        for n, samples in enumerate(pair_peaks(motions).T, start=1):
            row[f"peak_mean_{n}"] = float(samples.mean())
            row[f"peak_mean_standard_error_{n}"] = float(samples.std(ddof=1) / np.sqrt(samples.size))
        return row

    def required_gap(self, measure: Measure) -> float:
        """The gap that keeps the confidence [m]."""
        required, *_ = required_gaps(self._motions(measure))
        return required

    def linearized(self, measure: Measure) -> dict[str, float]:
        """Correlation and standard deviation of ``u_1 - u_2`` by linearization; NaN if not solved."""
        links = [] if measure.link is None else [measure.link]
        rho = apart = np.nan
        # Not solved; or nothing stationary: a link with slack, storeys without stiffness beyond yield.
        with suppress(ArithmeticError, ValueError):
            rho, apart = linearized_at_roof(self.changed(measure), self.ground, links)
        return {"rho": rho, "relative_displacement_std": apart}

    def recorded(self, measure: Measure) -> dict[str, Array]:
        """What the records say (records,): amplification of the peaks as built and alone, impacts."""
        found: dict[str, list[float]] = {name: [] for name in RECORDED}
        contact = self.contact if measure.contact is None else measure.contact
        for motion, peaks in zip(self.records.values(), self.peaks_alone, strict=True):
            table = pound(self.changed(measure), self.gap, contact, motion, link=measure.link)
            for n in (0, 1):
                found[f"amplification_{n + 1}"].append(float(np.nanmax(table.peak[n] / peaks[n])))
            found["impacts"].append(float(table.sizes["impact"]))
            forces = table.largest_force.dropna("impact").values
            found["largest_force"].append(float(forces.max()) if forces.size else np.nan)
        return {name: np.array(values) for name, values in found.items()}

    def worst_amplification(self, measure: Measure) -> float:
        """The largest of both buildings on all records [-]."""
        found = self.recorded(measure)
        return float(max(found["amplification_1"].max(), found["amplification_2"].max()))

    @cached_property
    def peaks_alone(self) -> list[Array]:
        """Peaks of the floors as built and standing alone, record by record [m]."""
        return [
            pound(self.structures, self.gap, self.contact, motion).peak_alone.values
            for motion in self.records.values()
        ]

    def _motions(self, measure: Measure) -> xr.Dataset:
        return simulate(
            self.changed(measure),
            self.ground,
            paths=self.paths,
            seed=self.seed,
            duration=self.duration,
            envelope=self.envelope,
            scatter=self.scatter,
            quantiles=[self.confidence],
            link=measure.link,
        )
