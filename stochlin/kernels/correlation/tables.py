"""Tables of pairs of structures: correlation, status, bias and caution of all cells, on all cores."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, entry, worth_compiling
from stochlin.kernels.basics.interpolation import Grid
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.correlation.tiles import (
    LANES,
    PARAMETERS,
    STIFFNESS,
    bias_of_tile,
    cells_of_tile,
    correlation,
    new_memory,
    rho_of_tile,
)
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    characteristic,
    coordinates,
)

PART = 1 << 18  # cells of a task
ROUNDING = 1e-9  # by which |rho| may exceed 1 by rounding; beyond it the covariance is invalid
OFF = 0.1  # bias from which the caution of a cell is 1
KINDS = (float, np.int8, float, np.int8)  # data types of the arrays of a `RhoTable`
NOWHERE = (np.full((6, 2), np.inf), np.full(6, 2), np.zeros(64))  # an empty map of the bias


class PairSide(NamedTuple):
    """The first or the second structures of all pairs, ``n`` of them, and their place in the table."""

    parameters: Array  # (PARAMETERS, n): results of `pair_parameters`
    gaussian: Array  # the same by the Gaussian closure, for which the map of the bias holds
    place: Array  # (n, SHARED + 2): logarithms of the shared axes of the map, period, ground period
    flags: Array  # (n, 3) int8: status, caution, and 1 for an elastic structure
    strides: Array  # (d,): increments of the structure's number along the dimensions of the table


class Codes(NamedTuple):
    """Values of ``status`` that the compiled code compares or assigns."""

    not_converged: int  # cells with this or a larger status have no result
    not_physical: int  # the covariance is invalid


class RhoTable(NamedTuple):
    """Results of all cells, flat in C order."""

    rho: Array
    status: Array
    bias: Array
    caution: Array


def pair_parameters(system: EquivalentSystem, forcing: Forcing, displacement_std: Array) -> Array:
    """Quantities (PARAMETERS, n) of each structure from which `tiles.rho_of_tile` computes rho.

    The arrays have one shape.

    They are the coefficients of the state matrix ``A`` in the coordinates of `covariance.coordinates`,
    the forcing, the characteristic polynomial, the lower two rows of ``A^2``, and some further terms.
    """
    (_, (soft, _, h), (back, p, _)), third, _ = coordinates(system, forcing)
    columns = parameters_of(system, forcing, (-soft, h, back, p, third), displacement_std)
    return np.array(columns).reshape(PARAMETERS, -1)


def parameters_of(system: Any, forcing: Any, chosen: Any, displacement_std: Any) -> Any:
    """As `pair_parameters`, for numbers or arrays; ``chosen`` is what depends on the coordinates."""
    w, h, back, p, third = chosen
    d, k = system.damping, system.relaxation
    square = (  # second and third row of A^2
        d * w + h * back,
        d * d + h * p - w,
        -h * (d + k),
        -(p * w + k * back),
        back - p * (d + k),
        p * h + k * k,
    )
    kick = system.coupling * (forcing.slip - system.slip * forcing.mu)
    polynomial = characteristic(system.stiffness, d, system.coupling, system.slip, system.relaxation)
    as_second = (w, d, h, p, k, forcing.mu, forcing.velocity, third, *polynomial, *square)
    return (*as_second, back, system.stiffness, kick, displacement_std)


def pair_table(
    first: PairSide,
    second: PairSide,
    shape: tuple[int, ...],
    grid: Grid | None,
    codes: Codes,
) -> RhoTable:
    """Results of all cells of a table of this ``shape``, on all cores.

    ``grid`` is the map of the bias of ``rho``, None for none. Its axes are logarithms: the first
    `SHARED` are of properties that both structures share, the next of the longer period over the
    ground's, and the last of the ratio of the shorter to the longer period. No cell depends on another.
    """
    count = math.prod(shape)
    if count == 1 and not worth_compiling(_fill, 1):
        return _lone_pair(first, second, grid, codes)
    result = RhoTable(*(np.empty(count, kind) for kind in KINDS))
    other_closure = first.gaussian is not first.parameters or second.gaussian is not second.parameters
    fixed: tuple[Any, ...] = (np.array(shape, int), *(grid or NOWHERE), other_closure, *codes)

    def part(cells: slice) -> None:
        _fill(*first, *second, *fixed, cells.start, cells.stop, *result)

    in_ranges(part, count, PART)
    return result


def _lone_pair(first: PairSide, second: PairSide, grid: Grid | None, codes: Codes) -> RhoTable:
    """A table of one cell, as `_fill` finds it, in plain Python: to compile that takes seconds."""

    def rho(left: Array, right: Array) -> Any:
        a, b = left[:, 0], right[:, 0]
        stiff, soft = (a, b) if a[STIFFNESS] >= b[STIFFNESS] else (b, a)
        return correlation(stiff, soft, 0, 1)

    _, sizes, _ = map_ = grid or NOWHERE
    cell, known = np.zeros(1, int), np.empty(1)
    bias_of_tile(first.place, cell, second.place, cell, 1, *map_, new_memory(sizes), known)
    value, base = rho(first.parameters, second.parameters), rho(first.gaussian, second.gaussian)
    fields = _judged(value, base, known[0], first.flags[0], second.flags[0], *codes)
    return RhoTable(*(np.array([entry], kind) for entry, kind in zip(fields, KINDS, strict=True)))


@called_often
def _judged(value, base, known, flags_1, flags_2, not_converged, not_physical):
    """``rho``, status, bias and caution of a pair; ``base`` is ``rho`` by the closure of ``known``."""
    status = max(flags_1[0], flags_2[0])
    if status < not_converged and not abs(value) <= 1.0 + ROUNDING:
        status = not_physical
    off = 0.0 if flags_1[2] and flags_2[2] else known  # elastic: exact
    off += value - base  # NaN where rho is
    large = 2 if np.isnan(off) else int(abs(off) > OFF)
    rho = min(max(value, -1.0), 1.0) if status < not_converged else np.nan
    return rho, status, off, max(large, flags_1[1], flags_2[1])


@entry
def _fill(
    parameters_1, gaussian_1, place_1, flags_1, strides_1,
    parameters_2, gaussian_2, place_2, flags_2, strides_2,
    shape, axes, sizes, values, other_closure, not_converged, not_physical,
    begin, end, rho, status, bias, caution,
):  # fmt: skip
    """Compute the cells from ``begin`` to ``end``, tile by tile."""
    cells_1, cells_2 = np.empty(LANES, np.int64), np.empty(LANES, np.int64)
    a, b = np.empty(PARAMETERS * LANES), np.empty(PARAMETERS * LANES)
    c, d = np.empty(PARAMETERS * LANES), np.empty(PARAMETERS * LANES)
    loaded, loaded_too = np.empty((2, LANES), np.int64), np.empty((2, LANES), np.int64)
    for lane in range(LANES):
        loaded[0, lane] = loaded[1, lane] = loaded_too[0, lane] = loaded_too[1, lane] = -1
    raw, base, known = np.empty(LANES), np.empty(LANES), np.empty(LANES)
    memory = new_memory(sizes)
    for start in range(begin, end, LANES):
        count = min(LANES, end - start)
        cells_of_tile(start, count, shape, strides_1, cells_1)
        cells_of_tile(start, count, shape, strides_2, cells_2)
        rho_of_tile(parameters_1, parameters_2, cells_1, cells_2, a, b, loaded, raw)
        if other_closure:
            rho_of_tile(gaussian_1, gaussian_2, cells_1, cells_2, c, d, loaded_too, base)
        bias_of_tile(place_1, cells_1, place_2, cells_2, count, axes, sizes, values, memory, known)
        for lane in range(count):
            i, j, n, value = cells_1[lane], cells_2[lane], start + lane, raw[lane]
            rho[n], status[n], bias[n], caution[n] = _judged(
                value, base[lane] if other_closure else value, known[lane],
                (flags_1[i, 0], flags_1[i, 1], flags_1[i, 2]),
                (flags_2[j, 0], flags_2[j, 1], flags_2[j, 2]),
                not_converged, not_physical,
            )  # fmt: skip
