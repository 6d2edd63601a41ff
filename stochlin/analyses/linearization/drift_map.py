"""What simulation adds to the drift closure: a map of corrections, interpolated, held at its ends.

The closure is derived; how far it is off is known where structures were simulated. The map holds the
exact over the derived standard deviation, finer where the ground is slower than the structure, the
simulated less the derived signature, and how fast nearly equal structures part (see
`drifting_signatures`). Beyond its ends the map is held, but for weak motions and for hardening 1: where
the yield displacement is seven standard deviations away nothing yields and nothing is off. Between its
points it is the less sure the more they differ: ``displacement_error``. ``make bias`` computes it anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from importlib.resources import files

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.bias_map import KNOWN_GROUNDS, between_points, point_of
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.interpolation import Grid
from stochlin.models.grounds import CloughPenzien, Ground, WhiteNoise
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

FILE = "drift_map.nc"
# A Clough-Penzien ground is corrected as its soil would be alone.
CORRECTED_GROUNDS = (*KNOWN_GROUNDS, CloughPenzien)
ELASTIC = 0.15  # R/p below which no drift grows within a million periods
DISPLACEMENT, DISPLACEMENT_WHITE = "displacement_correction", "displacement_correction_white_noise"
REFINEMENT = "displacement_refinement"
SIGNATURE, REFERENCE = "signature_correction", "drift_reference"
NEARNESS, ENTRY = "nearness", "nearness_entry"
COLUMNS = (REFERENCE, ENTRY)  # what a variable of the map has many of, each a map of its own
# Where structures were simulated: R/p, hardening, damping, and of the ground; T/Tg.
STRENGTH, HARDENING, DAMPING = (0.0, 4.0), (0.02, 1.0), (0.01, 0.1)
GROUND_DAMPING, PERIOD = (0.03, 1.0), (0.1, 10.0)
# Of a Clough-Penzien ground: period of the high-pass oscillator over that of the soil, and its damping.
HIGH_PASS = ("period", "high_pass_period", "high_pass_damping")
HIGH_PASS_PERIOD, HIGH_PASS_DAMPING = (2.0, 25.0), (0.2, 1.3)
BEYOND = 2.0  # of the high-pass period, from which on T/sqrt(alpha) loses more than the map knows
# Expected relative error of a standard deviation: of any, and by how much the map differs around it.
LEAST, LEAST_CLOUGH_PENZIEN, BY_SPREAD = 0.01, 0.03, 0.45
ROUNDING = 1e-9


@cache
def drift_map() -> xr.Dataset:
    """The map that comes with the package, with its grids and how it was made."""
    with files("stochlin.analyses.linearization").joinpath(FILE).open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy")


def with_correction(structure: Structure, ground: Ground, derived: Solved) -> Solved:
    """What is derived with its displacements corrected, where the map knows the kind of ground.

    ``displacement_error`` is what is expected to be left, NaN where nothing was simulated.
    """
    shown = ("displacement_std", "ductility_std")
    arrays = [derived[name] for name in (*shown, "yield_displacement")]
    name = DISPLACEMENT_WHITE if isinstance(ground, WhiteNoise) else DISPLACEMENT
    least, point = LEAST, list[Cells]()
    inside: Cells = True
    if structure.yields and type(ground) in CORRECTED_GROUNDS:
        least = LEAST_CLOUGH_PENZIEN if isinstance(ground, CloughPenzien) else LEAST
        point = point_of(structure, ground, derived)
        inside = checked(ground, point)
    found = cellwise(_corrected, *arrays, inside, *point, name=name, least=least, kinds=(float,) * 3)
    return {**derived, **dict(zip((*shown, "displacement_error"), found, strict=True))}


def _corrected(
    std: Array, ductility: Array, uy: Array, inside: Array, *point: Array, name: str, least: float
) -> tuple[Array, ...]:
    """The displacements, corrected at this point if the map knows it, and the error that is left."""
    elastic = np.isinf(uy)
    if not point:
        return std, ductility, np.where(elastic, 0.0, np.nan)
    logarithm, spread = _held_with_spread(*point, name=name)
    factor = np.exp(logarithm)
    error = np.where(inside, (least**2 + (BY_SPREAD * spread) ** 2) ** 0.5, np.nan)
    return std * factor, ductility * factor, np.where(elastic, 0.0, error)


def checked(ground: Ground, point: Sequence[Cells]) -> Cells:
    """Whether structures at this point were simulated on such ground."""
    soil = ground.cells()
    high_pass = [soil[name] for name in HIGH_PASS] if isinstance(ground, CloughPenzien) else []
    return cellwise(_checked, *point, *high_pass, kinds=(bool,))[0]


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
    """Whether a value is between these, but for rounding."""
    return (value >= ends[0] * (1 - ROUNDING)) & (value <= ends[1] * (1 + ROUNDING))


def usual_closure(structure: Structure, ground: Ground) -> str:
    """The drift closure where it holds and is corrected, elsewhere the Gaussian one."""
    known = DRIFT in structure.closure_names() and type(ground) in CORRECTED_GROUNDS
    return DRIFT if known and structure.yields else GAUSSIAN


def hold_at_ends(name: str, point: Sequence[Cells]) -> tuple[Cells, ...]:
    """The values of a variable of the map, one a reference, at a point of `point_of`."""
    return cellwise(_held, *point, name=name, kinds=(float,) * len(_grids(name)))


@cache
def _grids(name: str) -> tuple[Grid, ...]:
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
    columns = whole.values if whole.dims[-1] in COLUMNS else whole.values[..., None]
    return tuple(Grid.of(axes, column) for column in np.moveaxis(columns, -1, 0))


def _refined(coarse: xr.DataArray, refinement: xr.DataArray) -> xr.DataArray:
    """The coarse map on the points of both, and what the finer one adds, nothing beyond its ends."""
    inner, outer = (
        [array[dim].values.round(12) for dim in array.dims] for array in (refinement, coarse)
    )
    points = [np.union1d(one, other) for one, other in zip(outer, inner, strict=True)]
    logarithms = [np.log(axis.astype(float)) for axis in outer]
    whole = [array.ravel() for array in np.meshgrid(*map(np.log, points), indexing="ij")]
    values = between_points(Grid.of(logarithms, coarse.values), whole)
    values = values.reshape([axis.size for axis in points])
    values[np.ix_(*map(np.searchsorted, points, inner))] += refinement.values
    return xr.DataArray(values, dims=coarse.dims, coords=dict(zip(coarse.dims, points, strict=True)))


@np.errstate(divide="ignore", invalid="ignore")  # elastic: log 0; invalid cells are NaN and stay so
def _held(*point: Array, name: str) -> Array | tuple[Array, ...]:
    grids = _grids(name)
    inside = _inside(grids[0], point)
    found = tuple(between_points(grid, inside) for grid in grids)
    return found if len(found) > 1 else found[0]


@np.errstate(divide="ignore", invalid="ignore")
def _held_with_spread(*point: Array, name: str) -> tuple[Array, Array]:
    """A value of the map, and the standard deviation of the points around by their weights in it."""
    (grid,) = _grids(name)
    inside = _inside(grid, point)
    value = between_points(grid, inside)
    square = between_points(grid._replace(values=grid.values**2), inside)
    return value, np.sqrt(np.maximum(square - value**2, 0))


def _inside(grid: Grid, point: tuple[Array, ...]) -> Array:
    place = np.log(np.array(in_one_shape(*point)))
    ends = zip(grid.axes, grid.sizes, strict=True)
    for row, (axis, size) in enumerate(ends):
        place[row] = np.clip(place[row], axis[0], axis[size - 1])
    return place
