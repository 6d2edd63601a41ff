"""Corrections of the drift closure, interpolated in a map of nonlinear simulations.

The drift closure follows from a derivation with assumptions, so that its results differ from those of
simulations. The map holds these differences for many structures on many grounds:

- the logarithm of the simulated over the derived standard deviation of the displacement. Where the
  period of the ground exceeds that of the structure, the map has additional points between its points;
- the simulated minus the derived signature of a structure, from which the correlation of a pair follows
  (see `drift.signatures`);
- the slopes with which the correlation of two nearly equal structures decreases as they become more
  different.

The corrections of a structure are interpolated between the points of the map; outside the map, the
values at its boundary are used. At two boundaries the corrections are exactly 0, because the structure
is linear there: at the hardening ratio 1, and where the yield displacement is about seven standard
deviations of the elastic displacement. The more the surrounding points differ, the larger is
``displacement_error``, the error that is expected after the correction. ``make drift_map`` computes the
map.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.interpolation import Around, Grid, interpolate, linearly, smoothly
from stochlin.models.grounds import CloughPenzien, Ground, KanaiTajimi, WhiteNoise
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

FILE = "drift_map.nc"
# Clough-Penzien ground is a Kanai-Tajimi ground with a high-pass filter. Structures on it are corrected
# as on the Kanai-Tajimi ground alone.
CORRECTED_GROUNDS = (KanaiTajimi, WhiteNoise, CloughPenzien)
RATIO = "elastic_ductility_std"  # R/p: standard deviation of the elastic displacement over uy
# R/p is the standard deviation of the elastic displacement over the yield displacement. Below this value
# no drift grows within a million periods.
ELASTIC = 0.15
DISPLACEMENT, DISPLACEMENT_WHITE = "displacement_correction", "displacement_correction_white_noise"
REFINEMENT = "displacement_refinement"
SIGNATURE, REFERENCE = "signature_correction", "drift_reference"
NEARNESS, ENTRY = "nearness", "nearness_entry"
# Along these dimensions there is no parameter to interpolate in: each entry is a map of its own.
COLUMNS = (REFERENCE, ENTRY)
# Ranges that were simulated: of R/p, of the hardening ratio and of the damping ratio of the structure,
# of the damping ratio of the ground, and of the period of the structure over that of the ground.
STRENGTH, HARDENING, DAMPING = (0.0, 4.0), (0.01, 1.0), (0.005, 0.3)
# Ranges of the map itself: of the hardening ratio and of the damping ratio of the structure.
MAP_HARDENING, MAP_DAMPING = (0.02, 1.0), (0.01, 0.1)
GROUND_DAMPING, PERIOD = (0.03, 1.0), (0.1, 10.0)
# Ranges on Clough-Penzien ground: of the period of the high-pass filter over that of the soil, and of
# the damping ratio of the high-pass filter.
HIGH_PASS = ("period", "high_pass_period", "high_pass_damping")
HIGH_PASS_PERIOD, HIGH_PASS_DAMPING = (2.0, 25.0), (0.2, 1.3)
# Largest period after yield, T/sqrt(alpha), over the period of the high-pass filter. Where it is larger,
# corrected standard deviations are too large by 10 % and more.
BEYOND = 2.0
# The expected relative error of a corrected standard deviation combines two parts: one that is always
# there, which is larger where the correction is that of another case (Clough-Penzien ground, or a
# hardening or damping ratio beyond the map), and this share of the scatter of the points around.
LEAST, LEAST_BEYOND, BY_SPREAD = 0.01, 0.03, 0.45
ROUNDING = 1e-9


@cache
def drift_map() -> xr.Dataset:
    """The map that the package contains; its attributes say how it was computed."""
    with files("stochlin.analyses.linearization").joinpath(FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


def point_of(structure: Structure, ground: Ground, solved: Solved) -> list[Cells]:
    """Place of a solved structure in the map; that on white noise has two axes less."""
    own, soil = structure.cells(), ground.cells()
    point = [solved[RATIO], own.get("hardening", 1.0), own["damping"]]
    if isinstance(ground, WhiteNoise):
        return point
    return [*point, soil["damping"], own["period"] / soil["period"]]


def with_correction(structure: Structure, ground: Ground, derived: Solved) -> Solved:
    """The results of the drift closure for a structure, with displacements corrected by the map.

    They also have ``displacement_error``, the relative error that is expected after the correction. It
    is NaN where the structure or the ground is outside the simulated ranges. On a kind of ground for
    which there are no simulations, nothing is corrected, and the error is NaN if the structure yields.
    """
    shown = ("displacement_std", "ductility_std")
    arrays = [derived[name] for name in (*shown, "yield_displacement")]
    name = DISPLACEMENT_WHITE if isinstance(ground, WhiteNoise) else DISPLACEMENT
    least, point = LEAST, list[Cells]()
    inside: Cells = True
    if structure.yields and type(ground) in CORRECTED_GROUNDS:
        least = LEAST_BEYOND if isinstance(ground, CloughPenzien) else LEAST
        point = point_of(structure, ground, derived)
        inside = checked(ground, point)
    corrected = cellwise(_corrected, *arrays, inside, *point, name=name, least=least, kinds=(float,) * 3)
    return {**derived, **dict(zip((*shown, "displacement_error"), corrected, strict=True))}


def _corrected(
    std: Array,
    ductility: Array,
    uy: Array,
    inside: Array,
    *point: Array,
    name: str,
    least: Array | float,
) -> tuple[Array, ...]:
    """Corrected standard deviation [m], corrected ductility, and the relative error that is expected.

    ``point`` is the place of the structure in the map; without one, nothing is corrected.
    """
    elastic = np.isinf(uy)
    if not point:
        return std, ductility, np.where(elastic, 0.0, np.nan)
    logarithm, spread = _held_with_spread(*point, name=name)
    factor = np.exp(logarithm)
    _, hardening, damping, *_ = point
    mapped = within(hardening, MAP_HARDENING) & within(damping, MAP_DAMPING)
    least = np.where(mapped, least, LEAST_BEYOND)
    error = np.where(inside, (least**2 + (BY_SPREAD * spread) ** 2) ** 0.5, np.nan)
    return std * factor, ductility * factor, np.where(elastic, 0.0, error)


def checked(ground: Ground, point: Sequence[Cells]) -> Cells:
    """Whether the places ``point`` of structures in the map are within the simulated ranges."""
    soil = ground.cells()
    high_pass = [soil[name] for name in HIGH_PASS] if isinstance(ground, CloughPenzien) else []
    return cellwise(_checked, *point, *high_pass, kinds=(bool,))[0]


@np.errstate(all="ignore")  # what overflows is outside, and what is out of range
def _checked(strength: Array, hardening: Array, damping: Array, *others: Array) -> Array:
    inside = within(strength, STRENGTH) & within(hardening, HARDENING) & within(damping, DAMPING)
    if not others:
        return inside
    ground_damping, period, *high_pass = others
    inside = inside & within(ground_damping, GROUND_DAMPING) & within(period, PERIOD)
    if not high_pass:
        return inside
    ground_period, high_pass_period, high_pass_damping = high_pass
    ratio = high_pass_period / ground_period
    inside = inside & within(ratio, HIGH_PASS_PERIOD) & within(high_pass_damping, HIGH_PASS_DAMPING)
    return np.asarray(inside & (period / np.sqrt(hardening) <= BEYOND * ratio))


def within(value: Array, ends: tuple[float, float]) -> Array:
    """Whether each value lies between both ends of a range; rounding errors beyond them are allowed."""
    return (value >= ends[0] * (1 - ROUNDING)) & (value <= ends[1] * (1 + ROUNDING))


def calibrated_closure(structure: Structure, ground: Ground) -> str:
    """The drift closure for laws that have it, on the grounds of the map; otherwise the Gaussian one."""
    known = DRIFT in structure.closure_names() and type(ground) in CORRECTED_GROUNDS
    return DRIFT if known else GAUSSIAN


def hold_at_ends(name: str, point: Sequence[Cells]) -> tuple[Cells, ...]:
    """Values of a variable of the map at the places ``point`` of structures.

    Outside the map they are those at its boundary. There is one array for each entry of the variable.
    """
    return cellwise(_held, *point, name=name, kinds=(float,) * _grid(name).values.shape[-1])


@cache
def _grid(name: str) -> Grid:
    """The map of a variable, with a column for each of its entries."""
    whole = drift_map()[name]
    if name == DISPLACEMENT:
        whole = _refined(whole, drift_map()[REFINEMENT])
    if name != NEARNESS:
        strength, hardening = whole.dims[:2]
        for dim, value, before in ((strength, ELASTIC, True), (hardening, 1.0, False)):
            exact = xr.zeros_like(whole.isel({dim: [0]})).assign_coords({dim: [value]})
            order = (exact, whole) if before else (whole, exact)
            whole = xr.concat(order, dim).transpose(*whole.dims)
    axes = [np.log(whole[dim].values.astype(float)) for dim in whole.dims if dim not in COLUMNS]
    return Grid.of(axes, whole.values)


def _refined(coarse: xr.DataArray, refinement: xr.DataArray) -> xr.DataArray:
    """One map over the points of the coarse map and of the refinement.

    Both are interpolated to all points and added. The refinement is 0 outside its own points.
    """
    parts = [[array[dim].values.round(12) for dim in array.dims] for array in (coarse, refinement)]
    points = [np.union1d(*axes) for axes in zip(*parts, strict=True)]
    place = np.array(np.meshgrid(*map(np.log, points), indexing="ij"))
    values = np.zeros(place.shape[1:])
    for array, axes in zip((coarse, refinement), parts, strict=True):
        grid = Grid.of([np.log(axis) for axis in axes], array.values)
        values += np.nan_to_num(between(grid, place)[0])
    return xr.DataArray(values, dims=coarse.dims, coords=dict(zip(coarse.dims, points, strict=True)))


@np.errstate(divide="ignore", invalid="ignore")  # R/p of elastic structures is 0; failed cells are NaN
def _held(*point: Array, name: str) -> Array | tuple[Array, ...]:
    grid = _grid(name)
    values = between(grid, _inside(grid, point))
    return tuple(values) if len(values) > 1 else values[0]


@np.errstate(divide="ignore", invalid="ignore")
def _held_with_spread(*point: Array, name: str) -> tuple[Array, Array]:
    """The interpolated values, and the standard deviations of the points around each place.

    The standard deviations have the weights of linear interpolation.
    """
    grid = _grid(name)
    inside = _inside(grid, point)
    mean, square = between(_with_squares(name), inside, linearly)
    return between(grid, inside)[0], np.sqrt(np.maximum(square - mean**2, 0))


@cache
def _with_squares(name: str) -> Grid:
    axes, values = _grid(name)
    return Grid(axes, np.concatenate([values, values**2], axis=-1))


def between(grid: Grid, place: Array, around: Around = smoothly) -> Array:
    """Interpolated values of each column of a map, at ``place`` with a row for each axis."""
    values = interpolate(grid, place.reshape(len(place), -1), around)
    return values.reshape(-1, *place.shape[1:])


def _inside(grid: Grid, point: tuple[Array, ...]) -> Array:
    """Logarithms of the parameters, moved to the boundary where they are outside the map."""
    place = np.log(np.array(in_one_shape(*point)))
    return np.array([np.clip(x, axis[0], axis[-1]) for x, axis in zip(place, grid.axes, strict=True)])
