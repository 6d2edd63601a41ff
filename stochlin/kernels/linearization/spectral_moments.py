"""Spectral moments ``l0, l1, l2`` of the displacement of linear(ized) structures on filtered ground.

``l_m = 2 Int_0^inf w^m S(w) dw`` with ``S`` two-sided: ``l0`` and ``l2`` are the variances of
displacement and velocity. ``l1`` is no covariance of states. With ``R(tau)`` the correlation function,
``l1 = -(2/pi) Int_0^inf R'(tau)/tau dtau``, and since ``1/tau`` is the Laplace transform of 1,

    l1 = (2/pi) Int_0^inf I(s) ds,    I(s) = -Int_0^inf R'(tau) e^(-s tau) dtau.

``I`` is rational with all its poles in the left half-plane: however light the damping, no
resonance lies on the way of integration, and since no pole is ever computed none can be
defective. ``s = l0``-to-``l2`` frequency times ``e^x`` makes the integrand decay as ``e^-|x|`` both
ways and analytic for ``|Im x| < pi/2``, where the trapezoidal rule converges like ``e^(-pi^2/h)``.
"""

from __future__ import annotations

from functools import reduce
from operator import sub as subtract
from typing import NamedTuple, TypeVar

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    own_covariance,
    pair_covariance,
    pair_row,
)
from stochlin.kernels.linearization.filters import Filter

STEP, REACH = 0.33, 29.0  # errors e^(-pi^2/h) and 2 e^-reach, both about 5e-13
_NODES = np.exp(STEP * np.arange(-int(REACH / STEP), int(REACH / STEP) + 1))
CELLS = 128  # at a time: nodes times cells stay in the cache


class SpectralMoments(NamedTuple):
    """``l0`` [m^2], ``l1`` [m^2/s], ``l2`` [m^2/s^2] of a displacement."""

    l0: Array
    l1: Array
    l2: Array


class _Column(NamedTuple):
    """Correlations of a structure's ``mu``, ``mu'``, ``y`` with the quantity that is described."""

    mu: Array
    velocity: Array
    slip: Array


Rows = TypeVar("Rows", EquivalentSystem, Forcing, _Column)


def displacement_moments(system: EquivalentSystem, forcing: Forcing, ground: Filter) -> SpectralMoments:
    """Spectral moments of one structure's displacement, of cells (n,)."""
    own = own_covariance(system, forcing)
    column = _Column(own.mu_mu, np.zeros_like(own.mu_mu), own.mu_mu - own.mu_z)
    return _with_l1(own.mu_mu, own.v_v, ground, (system, forcing, column))


def difference_moments(
    first: EquivalentSystem,
    forcing_1: Forcing,
    second: EquivalentSystem,
    forcing_2: Forcing,
    ground: Filter,
) -> SpectralMoments:
    """Spectral moments of ``mu_1 - mu_2`` on one ground; shapes as in `displacement_moments`.

    Both displacements in one unit of length. Where the structures move almost as one the
    difference keeps ``1 - rho`` of their digits; at ``rho = 1`` ``l1`` is NaN.
    """
    own_1, own_2 = own_covariance(first, forcing_1), own_covariance(second, forcing_2)
    both = pair_covariance(first, forcing_1, second, forcing_2)
    _, _, slip_2 = pair_row(first, forcing_1, second, forcing_2)
    _, velocity_1, slip_1 = pair_row(second, forcing_2, first, forcing_1)
    column_1 = _Column(own_1.mu_mu - both, -velocity_1, own_1.mu_mu - own_1.mu_z - slip_1)
    column_2 = _Column(both - own_2.mu_mu, -velocity_1, slip_2 - own_2.mu_mu + own_2.mu_z)
    # E[mu_2 mu_1'] is stationary, and the acceleration is in its equation of motion.
    velocities = (
        first.stiffness * both + first.damping * velocity_1 - first.coupling * slip_1 - forcing_2.mu
    )
    l0, l2 = column_1.mu - column_2.mu, own_1.v_v + own_2.v_v - 2 * velocities
    return _with_l1(l0, l2, ground, (first, forcing_1, column_1), (second, forcing_2, column_2))


@np.errstate(all="ignore")  # a moment that is no number says so itself
def _with_l1(
    l0: Array, l2: Array, ground: Filter, *structures: tuple[EquivalentSystem, Forcing, _Column]
) -> SpectralMoments:
    """The moments of a displacement, or of the first structure's less the second's."""
    l1 = np.empty_like(l0)
    for begin in range(0, l1.size, CELLS):
        cells = slice(begin, begin + CELLS)
        s = np.sqrt(l2[cells] / l0[cells])[:, None] * _NODES  # without motion NaN
        below = ground.at((cells, None))
        parts = [(_take(a, cells), _take(b, cells), _take(c, cells)) for a, b, c in structures]
        drive = reduce(subtract, [below.later(system, force)(s) for system, force, _ in parts])
        decay = reduce(subtract, [_decay(system, column, drive, s) for system, _, column in parts])
        l1[cells] = (2 / np.pi) * STEP * (s * decay).sum(axis=1)
    return SpectralMoments(l0, l1, l2)


def _take(rows: Rows, cells: slice) -> Rows:
    """Some cells, with an axis for the nodes."""
    return type(rows)(*(row[cells, None] for row in rows))


def _decay(system: EquivalentSystem, column: _Column, drive: Array, s: Array) -> Array:
    """``-Int_0^inf E[mu'(t + tau) x(t)] e^(-s tau) dtau``, from the equations of motion.

    ``column`` holds the correlations with ``x`` at ``tau = 0``, ``drive`` the transform of those of the
    forcing. Solved for the velocity, so that the limit ``s -> 0`` needs no subtraction.
    """
    w2, d, h, p, k = system
    right = w2 * column.mu - s * (column.velocity + drive)
    right = (s + k) * right - h * (s * column.slip + k * column.mu)
    return right / ((s + k) * ((s + d) * s + w2) - h * (k + p * s))
