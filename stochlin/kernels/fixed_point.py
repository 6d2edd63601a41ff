"""The fixed point of statistical linearization, by Newton's method over all cells at once.

The unknowns are the moments ``(sigma_v, sigma_z, corr(v, z))`` of the Gaussian density
that a closure assumes, as ``(log, log, atanh)``: every iterate is then a valid density,
whatever the hysteresis law. A step compares what the closure assumes of ``(v, z)`` with
what the linear system that it implies really does.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from stochlin.kernels.arrays import Array
from stochlin.kernels.covariance import EquivalentSystem, Forcing, own_covariance
from stochlin.kernels.small_systems import solve_3x3

CHUNK = 2048  # cells: temporaries of one Newton step then stay in the cache
COMPLEX_STEP = 1e-30
LARGEST_STEP = 1.0  # in log(sigma) and atanh(corr)


class ClosureValue(NamedTuple):
    """A closure at latent moments ``(sv, sz, r)``, and its derivatives by them.

    ``coefficients`` are ``(1 + c_e, k_e)``, ``covariance`` is ``(Var v, Var z, Cov(v, z))``
    under the density assumed. Shapes (2, n), (2, 3, n), (3, n), (3, 3, n).
    """

    coefficients: Array
    coefficients_jacobian: Array
    covariance: Array
    covariance_jacobian: Array


class FixedPoint(NamedTuple):
    """Where Newton's method stopped, per cell."""

    coefficients: Array  # (2, n): 1 + c_e, k_e
    latent: Array  # (3, n): sv, sz, r
    iterations: Array
    residual: Array  # largest mismatch of log sigma_v, log sigma_z, atanh corr(v, z)
    converged: Array


Closure = Callable[[Array, Array], ClosureValue]  # latent moments, law parameters
ForcingOf = Callable[[EquivalentSystem, Array], Forcing]  # system, ground parameters


def gaussian_covariance(latent: Array) -> tuple[Array, Array]:
    """Covariance and its Jacobian of the Gaussian density with moments ``(sv, sz, r)``."""
    sv, sz, r = latent
    zero = np.zeros_like(sv)
    covariance = np.stack([sv * sv, sz * sz, r * sv * sz])
    jacobian = np.stack(
        [
            np.stack([2 * sv, zero, zero]),
            np.stack([zero, 2 * sz, zero]),
            np.stack([r * sz, r * sv, sv * sz]),
        ]
    )
    return covariance, jacobian


def solve_fixed_point(
    structure: Array,
    law: Array,
    ground: Array,
    start: Array,
    closure: Closure,
    forcing_of: ForcingOf,
    rtol: float,
    atol: float,
    max_iterations: int,
) -> FixedPoint:
    """Solve every cell, in chunks.

    Parameters
    ----------
    structure : (3, n)
        Stiffness, damping and coupling of the equivalent system.
    law, ground : (m, n)
        Parameters handed through to ``closure`` and ``forcing_of``.
    start : (3, n)
        First guess of the latent moments.
    rtol, atol
        A cell is done when ``|dy| <= atol + rtol |y|`` for each latent moment ``y``; ``atol``
        counts for the correlation only, since the other two are positive scales.
    """
    parts = []
    for begin in range(0, start.shape[1], CHUNK):
        cells = slice(begin, begin + CHUNK)
        problem = _Problem(structure[:, cells], law[:, cells], ground[:, cells], closure, forcing_of)
        parts.append(_newton(problem, start[:, cells], rtol, atol, max_iterations))
    if not parts:
        none = np.empty(0)
        return FixedPoint(start[:2], start, none.astype(np.int32), none, none == 0)
    return FixedPoint(*(np.concatenate(field, axis=-1) for field in zip(*parts, strict=True)))


class _Problem(NamedTuple):
    structure: Array
    law: Array
    ground: Array
    closure: Closure
    forcing_of: ForcingOf

    def of(self, cells: Array) -> _Problem:
        return self._replace(
            structure=self.structure[:, cells], law=self.law[:, cells], ground=self.ground[:, cells]
        )


def _newton(
    problem: _Problem, start: Array, rtol: float, atol: float, max_iterations: int
) -> FixedPoint:
    n = start.shape[1]
    y = np.stack([np.log(start[0]), np.log(start[1]), np.arctanh(start[2])])
    last_step = np.zeros_like(y)
    iterations = np.zeros(n, np.int32)
    residual = np.full(n, np.inf)
    converged = np.zeros(n, bool)
    for _ in range(max_iterations):
        active = np.flatnonzero(~converged)
        if not active.size:
            break
        mismatch, step, valid = _newton_step(problem.of(active), y[:, active])
        # An iterate whose linear system has no stationary state: go back half the way.
        step = np.where(valid, step, -0.5 * last_step[:, active])
        y[:, active] += step
        last_step[:, active] = np.where(valid, step, -step)
        iterations[active] += 1
        residual[active] = np.where(valid, np.abs(mismatch).max(axis=0), np.inf)
        r = np.tanh(y[2, active])
        change = np.abs(step)
        change[2] *= (1 - r * r) * rtol / (atol + rtol * np.abs(r))
        converged[active] = valid & (change.max(axis=0) <= rtol)
    latent = np.stack([np.exp(y[0]), np.exp(y[1]), np.tanh(y[2])])
    coefficients = problem.closure(latent, problem.law).coefficients
    return FixedPoint(coefficients, latent, iterations, residual, converged)


def _newton_step(problem: _Problem, y: Array) -> tuple[Array, Array, Array]:
    """Mismatch, Newton step in ``y`` and whether the implied linear system is stationary."""
    sv, sz, r = np.exp(y[0]), np.exp(y[1]), np.tanh(y[2])
    value = problem.closure(np.stack([sv, sz, r]), problem.law)
    response, by_coefficients = _response(problem, value.coefficients)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        reached, d_reached = _to_unknowns(response)
        assumed, d_assumed = _to_unknowns(value.covariance)
        scale = np.stack([sv, sz, 1 - r * r])
        jacobian = np.einsum("ijn,jkn,kln->iln", d_reached, by_coefficients, value.coefficients_jacobian)
        jacobian -= np.einsum("ijn,jkn->ikn", d_assumed, value.covariance_jacobian)
        mismatch = reached - assumed
        step = np.stack(solve_3x3(list(jacobian * scale), list(-mismatch)))
    valid = np.isfinite(step).all(axis=0)
    largest = np.abs(np.where(valid, step, 0)).max(axis=0)
    return mismatch, step * (LARGEST_STEP / np.maximum(LARGEST_STEP, largest)), valid


def _response(problem: _Problem, coefficients: Array) -> tuple[Array, Array]:
    """``(Var v, Var z, Cov(v, z))`` of the linear system, and its derivatives by (slip, relaxation)."""
    derivatives = []
    for which in range(2):
        shifted = coefficients.astype(complex)
        shifted[which] += COMPLEX_STEP * 1j
        system = EquivalentSystem(*problem.structure, *shifted)
        own = own_covariance(system, problem.forcing_of(system, problem.ground))
        response = np.stack([own.v_v, own.z_z, own.v_z])
        derivatives.append(response.imag / COMPLEX_STEP)
    return response.real, np.stack(derivatives, axis=1)


def _to_unknowns(covariance: Array) -> tuple[Array, Array]:
    """``(log sv, log sz, atanh r)`` of a covariance and the Jacobian; NaN where it is none."""
    vv, zz, vz = covariance
    sv, sz = np.sqrt(vv), np.sqrt(zz)
    r = vz / (sv * sz)
    zero = np.zeros_like(r)
    spread = 1 / (1 - r * r)
    unknowns = np.stack([np.log(sv), np.log(sz), np.arctanh(r)])
    jacobian = np.stack(
        [
            np.stack([0.5 / vv, zero, zero]),
            np.stack([zero, 0.5 / zz, zero]),
            np.stack([-0.5 * r * spread / vv, -0.5 * r * spread / zz, spread / (sv * sz)]),
        ]
    )
    return unknowns, jacobian
