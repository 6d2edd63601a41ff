"""One or two structures, at least one of them a building with storeys, in simulated motions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.strength import reduction_factor
from stochlin.analyses.linearization.systems.systems import linearized_motion
from stochlin.analyses.separation.rules import PairInMotion, effective_arguments
from stochlin.analyses.simulation.finite_motions import mean_with_error, pair_peaks
from stochlin.analyses.simulation.simulation import simulate
from stochlin.analyses.simulation.structures_in_motion import structures_in_motion
from stochlin.analyses.simulation.views import at_height, meeting_heights
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.buildings import ShearBuilding
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.rules.codes import Neighbours
from stochlin.models.structures import DRIFT, Structure
from stochlin.models.systems import (
    LEVEL,
    AnyStructure,
    Arrangement,
    arrangement_of,
    first_mode,
    slabs_on_columns,
)

PATHS, RELAXATION_TIMES = 64, 5.0  # of the stationary simulation; the error of rho is about 0.01
SLOWEST = 20.0  # largest relaxation time of a drift over the duration for a stationary simulation
NO_DRIFT = "the drift closure is only available for oscillators"
NO_AMPLIFICATION = "the linearized amplification of Fig. 5b is only available for oscillators"


@dataclass(frozen=True)
class StoreysInMotion(PairInMotion):
    """Structures with strengths in metres, at least one of them a building with storeys."""

    @cached_property
    def system(self) -> Arrangement:
        """All structures as one system, without links."""
        return arrangement_of(self.structures)

    @cached_property
    def heights(self) -> Array:
        """See `PairInMotion`."""
        stacks = self.system.stacks
        return stacks[0].levels if self.alone else meeting_heights(*stacks)

    @property
    def code_heights(self) -> tuple[Array, ...]:
        """The levels themselves: rules of codes for the roof are applied at every level below it."""
        return (self.heights,) * len(self.structures)

    @cached_property
    def peaks(self) -> Array:
        """See `PairInMotion`."""
        if self.alone:
            peaks = self.motions.peak.values[:, None]
        else:
            peaks = self.motions.peak_at_height.sel(height=self.heights).values
        quantile: Array = np.quantile(peaks, self.confidence, axis=0)
        return quantile

    @cached_property
    def oscillators(self) -> list[Structure]:
        """The first modes of the structures as oscillators."""
        return [first_mode(structure) for structure in self.structures]

    @cached_property
    def ductilities(self) -> Array:
        """Mean peak ductility of the first modes, from roof displacements; 0 if elastic."""
        first, ductilities = self.system.first, []
        for number, (structure, mode) in enumerate(zip(self.structures, self.oscillators, strict=True)):
            roof = float(self.motions.peak_mean[first[number + 1] - 1])
            if isinstance(structure, ShearBuilding):
                roof /= float(structure.participation()[-1])
            uy = mode.arrays().get("yield_displacement", xr.DataArray(np.inf))
            ductilities.append(roof / float(uy))
        return np.array(ductilities)

    def simulated_rho(self) -> Array:
        """See `PairInMotion`."""
        duration = float(self.motions.attrs["duration_s"])
        motions = stationary_motions(self.structures, self.ground, duration)
        return correlation_in(motions, *self._weights)

    def linearized_rho(self, closure: str) -> Array:
        """See `PairInMotion`."""
        if closure == DRIFT:
            raise ValueError(NO_DRIFT)
        weights_1, weights_2 = self._weights
        return correlation_of(self.linearized, weights_1, weights_2)

    def amplified_peaks(self) -> Array:
        """See `PairInMotion`."""
        raise ValueError(NO_AMPLIFICATION)

    @cached_property
    def linearized(self) -> StationaryResponse:
        """Stationary response of the structures by linearization."""
        return linearized_motion(self.structures, self.ground)

    def effective_arguments(self) -> dict[str, float]:
        """See `PairInMotion`."""
        return effective_arguments(self.oscillators, self.ductilities)

    def relative_moments(self) -> tuple[Array, Array, Array]:
        """See `PairInMotion`."""
        first, *others = self._weights
        l0, l1, l2 = (m[0] for m in self.linearized.spectral_moments(first - sum(others)))
        return l0, l1, l2

    def quantities(self) -> dict[str, Any]:
        """See `PairInMotion`."""
        at_roof, table = pair_peaks(self.motions), dict[str, Any]()
        for n, (structure, mode) in enumerate(zip(self.structures, self.oscillators, strict=True)):
            samples = at_roof[:, n]
            mean, error = mean_with_error(samples)
            table |= {f"peak_mean_{n + 1}": mean, f"peak_mean_standard_error_{n + 1}": error}
            table[f"peak_{n + 1}"] = float(self.peaks[n, -1])
            storeys = self.motions.ductility.values[self.motions.element_structure.values == n + 1]
            table[f"ductility_{n + 1}"] = float(storeys.max()) if structure.yields else np.nan
            uy = mode.arrays().get("yield_displacement", xr.DataArray(np.inf))
            table[f"yield_displacement_{n + 1}"] = float(uy)
            factor = np.nan
            if structure.yields:
                factor = float(reduction_factor(mode, self.ground).reduction_factor)
            table[f"reduction_factor_{n + 1}"] = factor
        for name in ("peak_drift_mean", "peak_drift_mean_standard_error", "ductility"):
            table[name] = self.motions[name]
        return table

    @cached_property
    def _weights(self) -> list[Array]:
        """Displacement of each structure at the heights, as weights of floors (heights, floors)."""
        return [
            np.array([weights(self.system, number, height) for height in self.heights])
            for number in range(len(self.structures))
        ]


def weights(system: Arrangement, number: int, height: float) -> Array:
    """Displacement of structure ``number`` at a height [m], as weights of all floors of the system."""
    weights = np.zeros(int(system.first[-1]))
    for floor, share in at_height(system, number, height).items():
        weights[floor] = share
    return weights


def linearized_at_roof(
    structures: tuple[AnyStructure, AnyStructure], ground: Ground, links: Sequence[Link]
) -> tuple[float, float]:
    """Correlation [-], and standard deviation of ``u_1 - u_2`` [m], at the level of the lower roof."""
    motion = linearized_motion(structures, ground, links)
    system = arrangement_of(structures)
    height = meeting_heights(*system.stacks)[-1]
    roof_1, roof_2 = (weights(system, number, height)[None] for number in (0, 1))
    return float(correlation_of(motion, roof_1, roof_2)[0]), float(motion.std(roof_1 - roof_2)[0, 0])


def correlation_of(motion: StationaryResponse, weights_1: Array, weights_2: Array) -> Array:
    """Correlation of two displacements with these weights of the floors (k, floors), linearized."""
    first, second, apart = (motion.std(row)[0] for row in (weights_1, weights_2, weights_1 - weights_2))
    rho: Array = (first**2 + second**2 - apart**2) / (2 * first * second)
    return rho


def stationary_motions(
    structures: Sequence[AnyStructure],
    ground: Ground,
    duration: float,
    seed: int = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """A stationary simulation that is long enough for a correlation.

    Raises a ValueError if the drift of a storey relaxes far more slowly than the duration [s].
    """
    slowest = float(structures_in_motion(structures, ground, None, stationary=True).drift_times.max())
    if slowest > SLOWEST * duration:
        raise ValueError(
            f"a storey yields so rarely that its drift relaxes in {slowest:.3g} s: a stationary "
            f"simulation does not apply to {duration:g} s"
        )
    return simulate(
        structures,
        ground,
        paths=PATHS,
        seed=seed,
        relaxation_times=RELAXATION_TIMES,
        progress=progress,
    )


def correlation_in(table: xr.Dataset, weights_1: Array, weights_2: Array) -> Array:
    """Correlation of two displacements with these weights of the floors, in a stationary simulation."""
    sigma = table.displacement_std.values
    covariance = table.rho.values * np.outer(sigma, sigma)
    variances = [np.einsum("hi,ij,hj->h", w, covariance, w) for w in (weights_1, weights_2)]
    shared = np.einsum("hi,ij,hj->h", weights_1, covariance, weights_2)
    rho: Array = shared / np.sqrt(variances[0] * variances[1])
    return rho


def of_storeys(
    neighbours: Neighbours, structures: Sequence[AnyStructure], heights: Sequence[float | None]
) -> Neighbours:
    """What two buildings have in common; the same structural system only if their roofs are level.

    Codes that reduce the gap for the same system also ask for the same height, and with storeys they
    are given the height of the level, which is the same for both.
    """
    roofs = [
        float(structure.levels()[-1]) if isinstance(structure, ShearBuilding) else height
        for structure, height in zip(structures, heights, strict=True)
    ]
    level = None not in roofs and len(set(roofs)) == 1
    return replace(neighbours, same_system=neighbours.same_system and level)


def check_levels(
    structures: Sequence[AnyStructure], heights: Sequence[float | None], floors_align: bool
) -> None:
    """Raise a ValueError if heights contradict the storeys, or floors that should align do not."""
    for n, (structure, height) in enumerate(zip(structures, heights, strict=True), start=1):
        if isinstance(structure, ShearBuilding) and height is not None:
            roof = float(structure.levels()[-1])
            if abs(height - roof) > LEVEL:
                raise ValueError(
                    f"height_{n} = {height:g} m, but the storeys of that building add up to {roof:g} m; "
                    "leave it out"
                )
    levels = [structure.levels() for structure in structures if isinstance(structure, ShearBuilding)]
    if not floors_align or len(levels) < len(structures):
        return
    off = [levels[side][floor - 1] for side, floor in slabs_on_columns(*levels)]
    if off:
        raise ValueError(
            f"floors_align = True, but at {', '.join(f'{level:g}' for level in off)} m only one of both "
            "has a floor; allowed: False, since a slab then meets a column"
        )
