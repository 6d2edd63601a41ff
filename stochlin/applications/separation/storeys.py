"""Correlations of floors of buildings with storeys, and what codes are told about their levels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress
from stochlin.kernels.linearization.systems.response import StationaryResponse
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.rules.codes import Neighbours
from stochlin.models.systems import (
    LEVEL,
    AnyStructure,
    Arrangement,
    arrangement_of,
    slabs_on_columns,
)
from stochlin.solver.linearization.systems.systems import linearized_motion
from stochlin.solver.simulation.simulation import simulate
from stochlin.solver.simulation.structures_in_motion import structures_in_motion
from stochlin.solver.simulation.views import at_height, meeting_heights
from stochlin.solver.tables import labels

PATHS, RELAXATION_TIMES = 64, 5.0  # of the stationary simulation; the error of rho is about 0.01
SLOWEST = 20.0  # largest relaxation time of a drift over the duration for a stationary simulation


def facing_heights(system: Arrangement) -> Array:
    """Heights [m] at which two structures could meet, or those of the floors of one; NaN if unknown."""
    return meeting_heights(*system.stacks) if system.stacks[1:] else system.stacks[0].levels


def weights_at(system: Arrangement, heights: Array) -> list[Array]:
    """Displacement of each structure at the heights, as weights of all floors (heights, floors)."""
    numbers = range(len(system.stacks))
    return [np.array([weights(system, n, height) for height in heights]) for n in numbers]


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
    floors = system.storeys.shapes
    roof_1, roof_2 = (weights(system, number, height)[None] @ floors for number in (0, 1))
    return float(correlation_of(motion, roof_1, roof_2)[0]), float(motion.std(roof_1 - roof_2)[0, 0])


def correlation_of(motion: StationaryResponse, weights_1: Array, weights_2: Array) -> Array:
    """Correlation of two displacements with these weights of the coordinates (k, n), linearized."""
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

    Raises a ValueError if the drift of a storey relaxes far more slowly than the duration [s], or is not
    resolved.
    """
    slowest = float(structures_in_motion(structures, ground, None, stationary=True).drift_times.max())
    if slowest > SLOWEST * duration:
        raise ValueError(
            f"a storey yields so rarely that its drift relaxes in {slowest:.3g} s: a stationary "
            f"simulation does not apply to {duration:g} s"
        )
    times = RELAXATION_TIMES
    motions = simulate(
        structures, ground, paths=PATHS, seed=seed, relaxation_times=times, progress=progress
    )
    return resolved(motions)


def resolved(table: xr.Dataset) -> xr.Dataset:
    """A stationary simulation; raises a ValueError if it is too short for a structure."""
    if (table.status == labels.NOT_RESOLVED).any():
        raise ValueError("a structure yields so rarely that a stationary simulation does not resolve it")
    return table


def correlation_in(table: xr.Dataset, weights_1: Array, weights_2: Array) -> Array:
    """Correlation of two displacements with these weights of the floors, in a stationary simulation."""
    sigma = table.displacement_std.values
    return combined(table.rho.values * np.outer(sigma, sigma), [weights_1, weights_2])[1]


def combined(covariance: Array, weights: Sequence[Array]) -> tuple[Array, Array]:
    """Standard deviations (s, heights) of sums with these weights, and correlation of first and last.

    The weights (heights, n) are those of n quantities with this covariance.
    """
    sizes = np.sqrt([np.einsum("hi,ij,hj->h", w, covariance, w) for w in weights])
    shared = np.einsum("hi,ij,hj->h", weights[0], covariance, weights[-1])
    return sizes, shared / (sizes[0] * sizes[-1])


def of_storeys(
    neighbours: Neighbours, structures: Sequence[AnyStructure], heights: Sequence[float | None]
) -> Neighbours:
    """What two buildings have in common; the same structural system only if their roofs are level.

    Codes that reduce the gap for the same system also ask for the same height, and with storeys they
    are given the height of the level, which is the same for both.
    """
    roofs = [
        float(structure.levels()[-1]) if isinstance(structure, MultistoreyBuilding) else height
        for structure, height in zip(structures, heights, strict=True)
    ]
    level = None not in roofs and len(set(roofs)) == 1
    return replace(neighbours, same_system=neighbours.same_system and level)


def numbers_of_storeys(
    structures: Sequence[AnyStructure], storeys: Sequence[int | None]
) -> dict[str, int | None]:
    """Numbers of storeys by name, of the structures or as given for oscillators.

    Raises a ValueError if a number contradicts the structure.
    """
    numbers = {f"storeys_{n}": number for n, number in enumerate(storeys, start=1)}
    for (name, number), structure in zip(numbers.items(), structures, strict=False):
        if not isinstance(structure, MultistoreyBuilding):
            continue
        if number not in (None, structure.storeys):
            raise ValueError(
                f"{name} = {number}, but that building has {structure.storeys} storeys; leave it out"
            )
        numbers[name] = structure.storeys
    return numbers


def check_levels(
    structures: Sequence[AnyStructure], heights: Sequence[float | None], floors_align: bool
) -> None:
    """Raise a ValueError if heights contradict the storeys, or floors that should align do not."""
    for n, (structure, height) in enumerate(zip(structures, heights, strict=True), start=1):
        if isinstance(structure, MultistoreyBuilding) and height is not None:
            roof = float(structure.levels()[-1])
            if abs(height - roof) > LEVEL:
                raise ValueError(
                    f"height_{n} = {height:g} m, but the storeys of that building add up to {roof:g} m; "
                    "leave it out"
                )
    levels = [
        structure.levels() for structure in structures if isinstance(structure, MultistoreyBuilding)
    ]
    if not floors_align or len(levels) < len(structures):
        return
    off = [levels[side][floor - 1] for side, floor in slabs_on_columns(*levels)]
    if off:
        raise ValueError(
            f"floors_align = True, but at {', '.join(f'{level:g}' for level in off)} m only one of both "
            "has a floor; allowed: False, since a slab then meets a column"
        )
