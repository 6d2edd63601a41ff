"""The closures of the bilinear law for each cell: compiled for many, in plain Python for a few.

They consist of the moments of a bivariate Gaussian over the quadrant ``v > 0, z > 1``, where the law
slips (Rosenbaum 1961, J. R. Stat. Soc. B 23). Its probability is ``Q(h)/2 + T(h, a)`` with Owen's
function, a Gaussian integral over a finite length, ``T(h, a) = exp(-h^2/2)/(2 pi) Int_0^a exp(-h^2
x^2/2)/(1 + x^2) dx``, by Gauss-Legendre quadrature. For ``a > 1`` it follows from ``T(a h, 1/a)``. For
``r >= 0`` all terms are positive, so that the relative error remains small if slip is rare.
"""

import math
from itertools import chain

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import called_often, compiled, entry, worth_compiling
from stochlin.kernels.linearization.cells.elementary import erfcx, exp
from stochlin.kernels.linearization.cells.tiles import LANES, fill, load, read3, store, write3
from stochlin.kernels.linearization.gaussian import clipped_values, gaussian_values, regressed

# First rows in a tile: latent moments, the integral, and what the fields of `ClosureValue` are.
MOMENTS, INTEGRAL, COEFFICIENTS, SLOPES, COVARIANCE, BY_LATENT, CLOSED = 0, 3, 7, 9, 15, 18, 27
NODES = 18
REACH = 7.75  # standard deviations beyond which the integrand is left out; the relative error is 1e-14
_X, _W = np.polynomial.legendre.leggauss(2 * NODES)
SQUARES, WEIGHTS = tuple(map(float, _X[NODES:] ** 2)), tuple(map(float, _W[NODES:]))
DENSITY = 1 / math.sqrt(2 * math.pi)
CORNER = 1 / (2 * math.pi)
ROOT_HALF = math.sqrt(0.5)
# Series of E[x^2; |x| < h]/(h^3 phi(h)) in h^2/2 for h < 1, the highest term first.
NARROW = tuple(math.gamma(2.5) / (1.5 * math.gamma(2.5 + n)) for n in range(14, -1, -1))


@called_often
def _length(sz, r):
    """Length of the integral, its square, and the exponent of the integrand at its end."""
    h, q, size = 1 / sz, math.sqrt((1 - r) * (1 + r)), abs(r)
    steep = size > q
    eta = h * size / q if steep else h
    length = min(q / size if steep else size / q, REACH / eta)
    decay = eta * length
    return length, length * length, 0.5 * decay * decay


@called_often
def _node(square, weight, length_squared, decay):
    """Contribution of a node of the quadrature, over the length."""
    return weight * exp(-decay * square) / (1 + length_squared * square)


@called_often
def _integral(sz, r):
    """Owen's integral by quadrature."""
    length, squared, decay = _length(sz, r)
    total = 0.0
    for square, weight in zip(SQUARES, WEIGHTS):  # noqa: B905  numba has no strict=
        total += _node(square, weight, squared, decay)
    return total * length


@called_often
def _quadrant(sz, r, integral):
    """The fields of `gaussian.SlipQuadrant`, then the tail ``Q(h)`` and the density ``phi(h)``."""
    h, q, size = 1 / sz, math.sqrt((1 - r) * (1 + r)), abs(r)
    across = h * size / q
    thin, thinner = exp(-0.5 * h * h), exp(-0.5 * across * across)
    tail, beside = 0.5 * erfcx(h * ROOT_HALF) * thin, 0.5 * erfcx(across * ROOT_HALF) * thinner
    part = CORNER * integral * (thinner if size > q else thin)
    owen = 0.5 * (tail + beside) - tail * beside - part if size > q else part
    probability = 0.5 * tail + (owen if r > 0 else -owen)
    edge = DENSITY * thin * (1 - beside if r > 0 else beside)
    corner = CORNER * thin * thinner
    first = 0.5 * erfcx(h / q * ROOT_HALF) * thin * thinner * DENSITY + r * edge
    second = probability + r * (r * h * edge + q * corner)
    return (probability, first, second, h, q, edge, corner), tail, DENSITY * thin


@called_often
def _within(h, tail, density):
    """``P(|x| < h)``, ``E[x^2; |x| < h]`` and ``P(|x| > h)`` of a standard Gaussian ``x``."""
    half, series = 0.5 * h * h, 0.0
    for coefficient in NARROW:
        series = series * half + coefficient
    between = 2 * h * density
    square = half * between * series if h < 1 else 1 - 2 * tail - between
    return square + between, square, 2 * tail


@called_often
def _gaussian(moments, integral):
    """Values of the Gaussian closure."""
    quadrant, _, _ = _quadrant(moments[1], moments[2], integral)
    return gaussian_values(moments, quadrant)


@called_often
def _clipped(moments, integral):
    """Values of the clipped closure."""
    quadrant, tail, density = _quadrant(moments[1], moments[2], integral)
    return clipped_values(moments, quadrant, _within(quadrant[3], tail, density))


@called_often
def closure_of(clipped, moments):
    """Coefficients, slopes of both, covariance and its slopes by a closure, for one cell."""
    integral = _integral(moments[1], moments[2])
    return _clipped(moments, integral) if clipped else _gaussian(moments, integral)


@compiled
def close(tile, clipped):
    """As `closure_of` for the moments of each lane of a tile, of which it fills the rows that follow."""
    for lane in range(LANES):
        _, sz, r = read3(tile, MOMENTS, lane)
        write3(tile, INTEGRAL, lane, _length(sz, r))
        tile[(INTEGRAL + 3) * LANES + lane] = 0.0
    for square, weight in zip(SQUARES, WEIGHTS):  # noqa: B905  numba has no strict=
        for lane in range(LANES):
            _, squared, decay = read3(tile, INTEGRAL, lane)
            tile[(INTEGRAL + 3) * LANES + lane] += _node(square, weight, squared, decay)
    for lane in range(LANES):
        tile[(INTEGRAL + 3) * LANES + lane] *= tile[INTEGRAL * LANES + lane]
    if clipped:
        for lane in range(LANES):
            integral = tile[(INTEGRAL + 3) * LANES + lane]
            _write(tile, lane, _clipped(read3(tile, MOMENTS, lane), integral))
    else:
        for lane in range(LANES):
            integral = tile[(INTEGRAL + 3) * LANES + lane]
            _write(tile, lane, _gaussian(read3(tile, MOMENTS, lane), integral))


@called_often
def _write(tile, lane, value):
    """Write what a closure found for a lane."""
    coefficients, of_slip, of_relaxation, covariance, by_latent = value
    tile[COEFFICIENTS * LANES + lane], tile[(COEFFICIENTS + 1) * LANES + lane] = coefficients
    write3(tile, SLOPES, lane, of_slip)
    write3(tile, SLOPES + 3, lane, of_relaxation)
    write3(tile, COVARIANCE, lane, covariance)
    write3(tile, BY_LATENT, lane, by_latent[0])
    write3(tile, BY_LATENT + 3, lane, by_latent[1])
    write3(tile, BY_LATENT + 6, lane, by_latent[2])


@called_often
def read_values(tile, lane):
    """What a closure found for a lane, as `closure_of` returns it."""
    return (
        (tile[COEFFICIENTS * LANES + lane], tile[(COEFFICIENTS + 1) * LANES + lane]),
        read3(tile, SLOPES, lane),
        read3(tile, SLOPES + 3, lane),
        read3(tile, COVARIANCE, lane),
        (
            read3(tile, BY_LATENT, lane),
            read3(tile, BY_LATENT + 3, lane),
            read3(tile, BY_LATENT + 6, lane),
        ),
    )


def values(latent: Array, clipped: bool) -> Array:
    """What a closure finds for moments (3, n): the fields of `gaussian.ClosureValue` as rows (20, n)."""
    fields = np.empty((CLOSED - COEFFICIENTS, latent.shape[1]))
    if worth_compiling(close_cells, latent.shape[1]):
        close_cells(clipped, np.ascontiguousarray(latent), fields)
        return fields
    for cell, moments in enumerate(latent.T.tolist()):
        try:
            *rows, matrix = closure_of(clipped, moments)
            fields[:, cell] = [*chain(*rows), *chain(*matrix)]
        except (ArithmeticError, ValueError):  # compiled code goes on with infinity or NaN
            close_cells(clipped, latent[:, cell : cell + 1].copy(), fields[:, cell : cell + 1])
    return fields


@entry
def close_cells(clipped, latent, out):
    """`values` of cells, written to ``out`` (20, n)."""
    tile = np.empty(CLOSED * LANES)
    fill(tile, 1.0)
    for start in range(0, out.shape[1], LANES):
        load(latent, start, tile, MOMENTS)
        close(tile, clipped)
        store(tile, COEFFICIENTS, out, start)


def quadrants(sz: Array, r: Array) -> Array:
    """The fields of `gaussian.SlipQuadrant` (7, n)."""
    fields = np.empty((7, sz.size))
    if worth_compiling(find_quadrants, sz.size):
        find_quadrants(np.ascontiguousarray(sz), np.ascontiguousarray(r), fields)
        return fields
    for cell, moments in enumerate(zip(sz.tolist(), r.tolist(), strict=True)):
        try:
            fields[:, cell] = _quadrant(*moments, _integral(*moments))[0]
        except (ArithmeticError, ValueError):
            column = slice(cell, cell + 1)
            find_quadrants(sz[column], r[column], fields[:, column])
    return fields


@entry
def find_quadrants(sz, r, out):
    """`quadrants` of cells, written to ``out`` (7, n)."""
    for cell in range(sz.size):
        here, _, _ = _quadrant(sz[cell], r[cell], _integral(sz[cell], r[cell]))
        for row in range(7):
            out[row, cell] = here[row]


for _ in (gaussian_values, clipped_values, regressed):
    called_often(_)
