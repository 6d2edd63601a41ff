"""Closures of the bilinear law as functions of one number, and Newton's method with these.

In stationary motion ``E[z z'] = 0``, that is ``(1 + c_e) E[v z] + k_e E[z^2] = E[v z]``. For a
rate-independent law without parameters this contains only the correlation ``r`` of the latent
moments and their ``sz``. So ``r``, ``1 + c_e``, ``k_e/sv`` and ``Var z`` are functions of ``sz``
alone, the same for all structures on all grounds; they are computed once. What remains unknown are
``log sv`` and ``log sz``.
"""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    OwnCovariance,
    own_covariance,
)
from stochlin.kernels.linearization.gaussian import Closure, clipped, gaussian
from stochlin.kernels.linearization.grounds import Soil, forcing_of
from stochlin.kernels.linearization.iteration import (
    ALONG,
    LARGEST_MISMATCH,
    LARGEST_STEP,
    FixedPoint,
)

UNIVERSAL = (gaussian, clipped)  # closures of one law without parameters
# Range of log sz: below it slip has no effect on the response in double precision, above it the
# shaking is a thousand times too strong for the structure; and points between which the functions
# are cubic.
LEAST_LOG_SZ = float(np.log(0.04))
LARGEST_LOG_SZ = float(np.log(400.0))
POINTS_OF_CUBICS = 4096
SPACING = (LARGEST_LOG_SZ - LEAST_LOG_SZ) / (POINTS_OF_CUBICS - 1)
CORRELATION_STEPS = 12  # Newton's steps for the correlations
# The damping c, with which cells need 4 to 6 steps on average; and that after so many steps, for
# cells whose steps overshoot again and again.
BALANCE_DAMPING = 0.3
LATER_DAMPING = 2.0
STEPS_WITH_FIRST_DAMPING = 6


@cache
def functions_of(closure: Closure) -> Array:
    """Cubics (4, 4, points - 1) in the distance from the point before, highest power first.

    Their values are the logarithms of ``1 + c_e``, ``k_e/sv`` and ``Var z``, and ``atanh r``.
    """
    places = np.linspace(LEAST_LOG_SZ, LARGEST_LOG_SZ, POINTS_OF_CUBICS)
    sz = np.exp(places)
    none = np.empty((0, POINTS_OF_CUBICS))

    def excess(correlated: Array) -> Array:
        latent = np.array([np.ones(POINTS_OF_CUBICS), sz, np.tanh(correlated)])
        (slip, relaxation), (_, z_z, v_z) = closure(latent, none)
        return (1 - slip) * v_z - relaxation * z_z

    correlated = 0.5 * np.log1p(sz * sz)
    for _ in range(CORRELATION_STEPS):
        off = excess(correlated)
        slope = (excess(correlated + ALONG) - off) / ALONG
        correlated = correlated - np.clip(off / slope, -1, 1)
    latent = np.array([np.ones(POINTS_OF_CUBICS), sz, np.tanh(correlated)])
    (slip, relaxation), (_, z_z, _) = closure(latent, none)
    values = np.array([*np.log([slip, relaxation, z_z]), correlated])
    return np.ascontiguousarray(CubicSpline(places, values, axis=1).c.swapaxes(1, 2))


def interpolated(functions: Array, place: Array) -> tuple[Array, Array]:
    """Values and slopes (k, n) of ``functions`` (4, k, m) at ``log sz``."""
    piece = np.clip((place - LEAST_LOG_SZ) / SPACING, 0, POINTS_OF_CUBICS - 2).astype(np.intp)
    return cubic(
        functions.take(piece, axis=2, mode="clip"),
        place - (LEAST_LOG_SZ + SPACING * piece),
    )


def cubic(coefficients: Any, x: Any) -> tuple[Any, Any]:
    """Value and slope of cubic polynomials, whose coefficients begin with the highest power."""
    c3 = coefficients[0]
    c2 = coefficients[1]
    c1 = coefficients[2]
    c0 = coefficients[3]
    return ((c3 * x + c2) * x + c1) * x + c0, (3 * c3 * x + 2 * c2) * x + c1


def interpolated_number(functions: Array, number: int, place: float) -> tuple[Any, Any]:
    """`interpolated` of one of the functions, at a number."""
    piece = int(min(max((place - LEAST_LOG_SZ) / SPACING, 0.0), POINTS_OF_CUBICS - 2.0))
    row = functions[:, number, piece]
    coefficients = float(row[0]), float(row[1]), float(row[2]), float(row[3])
    return cubic(coefficients, place - (LEAST_LOG_SZ + SPACING * piece))


def newton_step(
    v: Any, z: Any, number: int, closed: Any, structure: Any, soil: Soil
) -> tuple[Any, Any, Any, Any]:
    """Steps in ``v = log sv`` and ``z = log sz``, the larger one, and the norm of the mismatch.

    It is the step of this ``number``, from ``(c |F| - dF/dy) step = F``. ``closed`` are ``1 +
    c_e``, ``k_e`` and ``log Var z`` by the closure, and the slopes of the functions.
    """
    slip, relaxation, log_z_z, slip_by_z, relaxation_by_z, z_z_by_z = closed
    response = response_of(structure, soil, slip, relaxation)
    after_v = response_of(structure, soil, slip, relaxation * (1 + ALONG))
    more = slip * (1 + ALONG * slip_by_z)
    after_z = response_of(structure, soil, more, relaxation * (1 + ALONG * relaxation_by_z))
    off_v = 0.5 * np.log(response.v_v) - v
    off_z = 0.5 * (np.log(response.z_z) - log_z_z)
    v_by_v = 0.5 / ALONG * (after_v.v_v / response.v_v - 1)
    z_by_v = 0.5 / ALONG * (after_v.z_z / response.z_z - 1)
    v_by_z = 0.5 / ALONG * (after_z.v_v / response.v_v - 1)
    z_by_z = 0.5 / ALONG * (after_z.z_z / response.z_z - 1)
    norm = np.sqrt(off_v * off_v + off_z * off_z)
    push = (BALANCE_DAMPING if number <= STEPS_WITH_FIRST_DAMPING else LATER_DAMPING) * norm
    a = 1 + push - v_by_v
    d = 0.5 * z_z_by_z + push - z_by_z
    determinant = a * d - v_by_z * z_by_v
    step_v = (d * off_v + v_by_z * off_z) / determinant
    step_z = (a * off_z + z_by_v * off_v) / determinant
    change = np.maximum(np.abs(step_v), np.abs(step_z))
    shorter = np.maximum(change / LARGEST_STEP, 1.0)
    return step_v / shorter, step_z / shorter, change, norm


def response_of(structure: Any, soil: Soil, slip: Any, relaxation: Any) -> OwnCovariance:
    """Moments of a structure (stiffness, damping and coupling) with these coefficients."""
    system = EquivalentSystem(structure[0], structure[1], structure[2], slip, relaxation)
    return own_covariance(system, forcing_of(system, soil))


def settled(
    v: float, z: float, structure: Any, soil: Soil, functions: Array, rtol: float, most: int
) -> tuple[float, float, int, float, bool]:
    """Fixed point of one structure by numbers.

    Returned are the unknowns, the number of steps, the norm of the mismatch, and whether it
    converged.
    """
    norm = np.inf
    for number in range(1, most + 1):
        if not (math.isfinite(v + z) and z < LARGEST_LOG_SZ):
            return v, z, number, norm, False
        slip, slip_by_z = interpolated_number(functions, 0, z)
        relaxation, relaxation_by_z = interpolated_number(functions, 1, z)
        z_z, z_z_by_z = interpolated_number(functions, 2, z)
        slopes = slip_by_z, relaxation_by_z, z_z_by_z
        # Numbers of Python, as those of numpy take twice the time, by numpy's exponential, as in
        # arrays.
        closed = float(np.exp(slip)), float(np.exp(relaxation + v)), z_z, *slopes
        step_v, step_z, change, norm = newton_step(v, z, number, closed, structure, soil)
        v = float(v + step_v)
        z = float(z + step_z)
        if change <= rtol and norm <= LARGEST_MISMATCH:
            return v, z, number, norm, True
    return v, z, most, norm, False


# The formulas that are also compiled for numbers.
FORMULAS = cubic, interpolated_number, newton_step, response_of, settled


class BalancedStructures(NamedTuple):
    """Structures of a bilinear law on their grounds, in n cells."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    ground: Array  # (5, n) its parameters, see `grounds.Soil`
    oscillators: int
    functions: Array  # `functions_of` the closure
    rtol: float

    def at(self, cells: Any) -> BalancedStructures:
        """The cells with these numbers."""
        return self._replace(structure=self.structure[:, cells], ground=self.ground[:, cells])

    def step(self, unknowns: Array, number: int) -> tuple[Array, Array, Array]:
        """Step (2, n) from unknowns, norm of their mismatch, and whether they are a solution."""
        v, z = unknowns
        (slip, relaxation, z_z), slopes = interpolated(self.functions[:, :3], z)
        closed = np.exp(slip), np.exp(relaxation + v), z_z, *slopes
        soil = Soil(tuple(self.ground), self.oscillators)
        step_v, step_z, change, norm = newton_step(v, z, number, closed, self.structure, soil)
        done = (change <= self.rtol) & (norm <= LARGEST_MISMATCH)
        return np.array([step_v, step_z]), np.where(z < LARGEST_LOG_SZ, norm, np.nan), done

    def one_by_one(self, start: Array, most: int) -> FixedPoint:
        """Fixed points of a few cells by numbers, which take a tenth of the time of short arrays.

        A cell is left without one where numbers of Python raise an error.
        """
        solution = FixedPoint(start.copy(), *np.zeros((3, start.shape[1])))
        for n in range(start.shape[1]):
            structure = self.structure[:, n].tolist()
            v, z = start[:, n].tolist()
            soil = Soil(tuple(self.ground[:, n].tolist()), self.oscillators)
            with suppress(ArithmeticError, ValueError):
                v, z, *ended = settled(v, z, structure, soil, self.functions, self.rtol, most)
                for field, value in zip(solution, ((v, z), *ended), strict=True):
                    field[..., n] = value
        return solution._replace(converged=solution.converged > 0)
