"""Corrections of the drift closure, interpolated in a map of nonlinear simulations.

The drift closure follows from a derivation with assumptions, so that its results differ from those
of simulations. The map holds these differences for many structures on many grounds:

- the logarithm of the simulated over the derived standard deviation of the displacement;
- the simulated minus the derived signature of a structure, from which the correlation of a pair
  follows (see `correlation.signatures`);
- the slopes with which the correlation of two nearly equal structures decreases as they become more
  different.

The corrections of a structure are interpolated between the points of the map; outside the map, the
values at its boundary are used. At two boundaries the corrections are exactly 0, because the
structure is linear there: at the hardening ratio 1, and where the yield displacement is about seven
standard deviations of the elastic displacement. The more the surrounding points differ, the larger
is ``displacement_error``, the error that is expected after the correction.
``benchmarks/drift_map.py`` computes the map.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache, lru_cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.tables.interpolation import Grid, linear

MAP_FILE = "drift_map.nc"
# R/p is the standard deviation of the elastic displacement over the yield displacement. Below this
# value no drift grows within a million periods.
ELASTIC_DEMAND = 0.15
DISPLACEMENT_CORRECTION = "displacement_correction"
DISPLACEMENT_CORRECTION_WHITE = "displacement_correction_white_noise"
SIGNATURE = "signature_correction"
DRIFT_REFERENCE = "drift_reference"
# R/p: standard deviation of the elastic displacement over uy
STRENGTH_RATIO = "elastic_ductility_std"
NEARNESS = "nearness"
ENTRY = "nearness_entry"
# Along these dimensions there is no parameter to interpolate in: each entry is a map of its own.
DIMENSIONS_OF_MAPS = (DRIFT_REFERENCE, ENTRY)
# Ranges that were simulated: of R/p, of the hardening ratio and of the damping ratio of the
# structure, of the damping ratio of the ground, and of the period of the structure over that of the
# ground.
GROUND_DAMPING_RANGE = (0.03, 1.0)
PERIOD_RATIO_RANGE = (0.1, 10.0)
SIMULATED_RANGES = (0.0, 4.0), (0.01, 1.0), (0.005, 0.3), GROUND_DAMPING_RANGE, PERIOD_RATIO_RANGE
# Ranges of the map itself: of the hardening ratio and of the damping ratio of the structure.
MAP_HARDENING = (0.02, 1.0)
MAP_DAMPING = (0.01, 0.1)
# Largest period after yield, T/sqrt(alpha), over the period of the high-pass filter. Where it is
# larger, corrected standard deviations are too large by 10 % and more.
LONGEST_PERIOD_RATIO = 2.0
# The expected relative error of a corrected standard deviation combines two parts: one that is
# always there, that of the ground, or at least this one where the hardening or the damping ratio is
# beyond the map, and this share of the scatter of the points around.
LEAST_BEYOND = 0.03
BY_SPREAD = 0.45
ROUNDING_OF_RANGES = 1e-9
DAMPING_AXIS = 3  # of the map: the damping ratio of the ground
OTHER_AXES = [0, 1, 2, 4]  # and the others
SECTIONS = 64  # number of sections of the map at one damping ratio of the ground that are kept


@cache
def drift_map() -> xr.Dataset:
    """The map that the package contains; its attributes say how it was computed."""
    with files("stochlin.solver.linearization").joinpath(MAP_FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


def with_correction(
    ground: Ground, soil: Array, point: Array, derived: Mapping[str, Array]
) -> dict[str, Array]:
    """The results of the drift closure for structures, with displacements corrected by the map.

    ``soil`` has the parameters of their ground, ``point`` their places in the map. They also have
    ``displacement_error``, the relative error that is expected after the correction. It is NaN
    where a structure or the ground is outside the simulated ranges. On a kind of ground without a
    calibration nothing is corrected, and the error is NaN if a structure yields.
    """
    factor: Array | float = 1.0
    error: Array | float = np.nan
    if (calibration := ground.calibration) is not None:
        name = DISPLACEMENT_CORRECTION if calibration.soil else DISPLACEMENT_CORRECTION_WHITE
        logarithm, spread = _held_with_spread(name, ground, point)
        factor = np.exp(logarithm)
        mapped = within(point[1], MAP_HARDENING) & within(point[2], MAP_DAMPING)
        least = np.where(mapped, calibration.error, max(calibration.error, LEAST_BEYOND))
        error = np.sqrt(least**2 + (BY_SPREAD * spread) ** 2)
        error = np.where(simulated(ground, point, soil), error, np.nan)
    elastic = np.isinf(derived["yield_displacement"])
    lost = np.isnan(derived["displacement_std"])
    shown = {name: derived[name] * factor for name in ("displacement_std", "ductility_std")}
    error = np.where(lost, np.nan, np.where(elastic, 0.0, error))
    return {**derived, **shown, "displacement_error": error}


@np.errstate(all="ignore")  # what overflows is outside, and what is out of range
def simulated(ground: Ground, point: Array, soil: Array) -> Array:
    """Whether the places ``point`` of structures in the map are within the simulated ranges."""
    calibration = ground.calibration
    if calibration is None:
        return np.zeros(point.shape[1], bool)
    inside = np.ones(point.shape[1], bool)
    for row, ends in zip(point, SIMULATED_RANGES, strict=False):
        inside &= within(row, ends)
    if calibration.soil is None:
        return inside
    named = dict(zip(ground.cells(), soil, strict=True))
    period = named[calibration.soil[0]]
    for name, ends in calibration.ranges.items():
        inside &= within(named[name] / period if ground.units(name) == "s" else named[name], ends)
    if calibration.high_pass:
        longest = LONGEST_PERIOD_RATIO * (named[calibration.high_pass] / period)
        inside &= point[4] / np.sqrt(point[1]) <= longest
    return inside


def within(value: Array, ends: tuple[float, float]) -> Array:
    """Whether each value lies in a range; rounding errors beyond its ends are allowed."""
    lowest = ends[0] * (1 - ROUNDING_OF_RANGES)
    highest = ends[1] * (1 + ROUNDING_OF_RANGES)
    return (value >= lowest) & (value <= highest)


def calibrated_closure(structure: Structure, ground: Ground) -> str:
    """The drift closure for laws that have it, on calibrated grounds; else the Gaussian one."""
    mapped = DRIFT in structure.closure_names() and ground.calibration is not None
    return DRIFT if mapped else GAUSSIAN


def hold_at_ends(name: str, ground: Ground, point: Array) -> Array:
    """Values (columns, n) of a variable of the map at the places ``point`` of structures.

    Outside the map they are those at its boundary. There is a column for each entry of the
    variable.
    """
    return _held(_grid, name, ground, point)


def _held(grid_of: Callable[[str], Grid], name: str, ground: Ground, point: Array) -> Array:
    """`hold_at_ends` by one of the grids of the variable."""
    places = _inside(grid_of(name), point)
    soil = ground.calibration and ground.calibration.soil
    if soil and places.size and not ground.over_cells()[soil[1]].ndim:
        # All places have one damping ratio of the soil, and a quarter of the neighbours in a
        # section.
        section = _section(grid_of, name, float(places[DAMPING_AXIS, 0]))
        return section.at(places[OTHER_AXES])
    return grid_of(name).at(places)


@lru_cache(maxsize=SECTIONS)
def _section(grid_of: Callable[[str], Grid], name: str, damping: float) -> Grid:
    return grid_of(name).section(DAMPING_AXIS, damping)


@cache
def _grid(name: str) -> Grid:
    """The map of a variable, with a column for each of its entries."""
    whole = drift_map()[name]
    if name != NEARNESS:
        strength, hardening = whole.dims[:2]
        for dim, value, before in ((strength, ELASTIC_DEMAND, True), (hardening, 1.0, False)):
            exact = xr.zeros_like(whole.isel({dim: [0]})).assign_coords({dim: [value]})
            order = (exact, whole) if before else (whole, exact)
            whole = xr.concat(order, dim).transpose(*whole.dims)
    axes = [
        np.log(whole[dim].values.astype(float))
        for dim in whole.dims
        if dim not in DIMENSIONS_OF_MAPS
    ]
    return Grid.of(axes, whole.values)


def _held_with_spread(name: str, ground: Ground, point: Array) -> tuple[Array, Array]:
    """The interpolated values, and the standard deviations of the points around each place.

    The standard deviations have the weights of linear interpolation.
    """
    mean, square = _held(_with_squares, name, ground, point)
    return hold_at_ends(name, ground, point)[0], np.sqrt(np.maximum(square - mean**2, 0))


@cache
def _with_squares(name: str) -> Grid:
    """The map of a variable, and a column for its square, which are linear between the points."""
    smooth = _grid(name)
    values = np.concatenate([smooth.values, smooth.values**2], axis=-1)
    return Grid.of([axis.points for axis in smooth.axes], values, linear)


@np.errstate(all="ignore")  # R/p of elastic structures is 0; failed cells are NaN
def _inside(grid: Grid, point: Array) -> Array:
    """Logarithms of the parameters, moved to the boundary where they are outside the map."""
    return np.clip(np.log(point), *grid.ends)
