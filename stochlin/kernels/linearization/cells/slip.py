"""The closures of the bilinear law for each cell: compiled for many, in plain Python for a few.

They consist of the moments of a bivariate Gaussian over the quadrant ``v > 0, z > 1``, where the law
slips (Rosenbaum 1961, J. R. Stat. Soc. B 23). Its probability is ``Q(h)/2 + T(h, a)`` with Owen's
function, a Gaussian integral over a finite length, ``T(h, a) = exp(-h^2/2)/(2 pi) Int_0^a exp(-h^2
x^2/2)/(1 + x^2) dx``, by Gauss-Legendre quadrature. For ``a > 1`` it follows from ``T(a h, 1/a)``. For
``r >= 0`` all terms are positive, so that the relative error remains small if slip is rare.
"""

import math

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import call_for, called_often, entry
from stochlin.kernels.linearization.cells.elementary import exp
from stochlin.kernels.linearization.gaussian import clipped_values, gaussian_values, regressed

NUMBERS = 20  # of what a closure finds for a cell
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
def _integral(sz, r):
    """Owen's integral by quadrature."""
    h, q, size = 1 / sz, math.sqrt((1 - r) * (1 + r)), abs(r)
    steep = size > q
    eta = h * size / q if steep else h
    length = min(q / size if steep else size / q, REACH / eta)
    squared, decay = length * length, 0.5 * (eta * length) * (eta * length)
    total = 0.0
    for square, weight in zip(SQUARES, WEIGHTS):  # noqa: B905  numba has no strict=
        total += weight * exp(-decay * square) / (1 + squared * square)
    return total * length


@called_often
def _quadrant(sz, r):
    """The fields of `gaussian.SlipQuadrant`, then the tail ``Q(h)`` and the density ``phi(h)``."""
    h, q, size = 1 / sz, math.sqrt((1 - r) * (1 + r)), abs(r)
    across = h * size / q
    thin, thinner = exp(-0.5 * h * h), exp(-0.5 * across * across)
    tail, beside = 0.5 * math.erfc(h * ROOT_HALF), 0.5 * math.erfc(across * ROOT_HALF)
    part = CORNER * _integral(sz, r) * (thinner if size > q else thin)
    owen = 0.5 * (tail + beside) - tail * beside - part if size > q else part
    probability = 0.5 * tail + (owen if r > 0 else -owen)
    edge = DENSITY * thin * (1 - beside if r > 0 else beside)
    corner = CORNER * thin * thinner
    first = 0.5 * math.erfc(h / q * ROOT_HALF) * DENSITY + r * edge
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
def closure_of(clipped, moments):
    """Coefficients, slopes of both, covariance and its slopes by a closure, for one cell."""
    quadrant, tail, density = _quadrant(moments[1], moments[2])
    if clipped:
        return clipped_values(moments, quadrant, _within(quadrant[3], tail, density))
    return gaussian_values(moments, quadrant)


def values(latent: Array, clipped: bool) -> Array:
    """What a closure finds for moments (3, n): the fields of `gaussian.ClosureValue` as rows (20, n)."""
    fields = np.empty((NUMBERS, latent.shape[1]))
    call_for(close_cells, latent.shape[1], (np.ascontiguousarray(latent),), clipped, fields)
    return fields


@entry
def close_cells(latent, clipped, out):
    """`values` of cells, written to ``out`` (20, n)."""
    for n in range(out.shape[1]):
        value = closure_of(clipped, (latent[0][n], latent[1][n], latent[2][n]))
        coefficients, of_slip, of_relaxation, covariance, by_latent = value
        numbers = (
            *coefficients, *of_slip, *of_relaxation, *covariance,
            *by_latent[0], *by_latent[1], *by_latent[2],
        )  # fmt: skip
        for row in range(NUMBERS):
            out[row, n] = numbers[row]


def quadrants(sz: Array, r: Array) -> Array:
    """The fields of `gaussian.SlipQuadrant` (7, n)."""
    fields = np.empty((7, sz.size))
    call_for(find_quadrants, sz.size, (np.ascontiguousarray(sz), np.ascontiguousarray(r)), fields)
    return fields


@entry
def find_quadrants(sz, r, out):
    """`quadrants` of cells, written to ``out`` (7, n)."""
    for n in range(out.shape[1]):
        quadrant, _, _ = _quadrant(sz[n], r[n])
        for row in range(7):
            out[row, n] = quadrant[row]


for _ in (gaussian_values, clipped_values, regressed):
    called_often(_)
