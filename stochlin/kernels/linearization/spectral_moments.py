"""Spectral moments ``l0, l1, l2`` of displacements of linear and linearized structures on a ground.

``l_m = 2 Int_0^inf w^m S(w) dw`` with the two-sided PSD ``S``: ``l0`` and ``l2`` are the variances of
displacement and velocity, while ``l1`` is not a covariance of states. With the correlation function
``R(tau)``, ``l1 = -(2/pi) Int_0^inf R'(tau)/tau dtau``, and since ``1/tau`` is the Laplace transform of
1,

    l1 = (2/pi) Int_0^inf I(s) ds,    I(s) = -Int_0^inf R'(tau) e^(-s tau) dtau.

``I`` is rational with all its poles in the left half-plane. However light the damping, the path of
integration meets no resonance, and since no pole is computed, equal poles cause no error. The
substitution ``s = sqrt(l2/l0) e^x`` makes the integrand decay as ``e^-|x|`` in both directions. It is
analytic for ``|Im x| < pi/2``, so that the trapezoidal rule with step ``h`` has an error of order
``e^(-pi^2/h)``.
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

STEP, REACH = 0.33, 29.0  # step and range of x, with errors e^(-pi^2/h) and 2 e^-reach, about 5e-13
NODES = np.exp(STEP * np.arange(-int(REACH / STEP), int(REACH / STEP) + 1))
ROUNDING = 1e-11  # l0 of the difference over l0 of both, below which it is a rounding error
CELLS = 128  # cells computed together, so that their values at all nodes stay in the cache


class SpectralMoments(NamedTuple):
    """``l0`` [m^2], ``l1`` [m^2/s], ``l2`` [m^2/s^2] of a displacement."""

    l0: Array
    l1: Array
    l2: Array


class _Column(NamedTuple):
    """Covariances of a structure's ``mu``, ``mu'``, ``y`` with the displacement, or the difference."""

    mu: Array
    velocity: Array
    slip: Array


Rows = TypeVar("Rows", EquivalentSystem, Forcing, _Column)


def displacement_moments(system: EquivalentSystem, forcing: Forcing, ground: Filter) -> SpectralMoments:
    """Spectral moments of one structure's displacement, for cells (n,)."""
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

    Both displacements are in the same unit of length. If the structures move almost alike, the relative
    rounding error of the moments grows as ``1/(1 - rho)``. Where ``l0`` is as small as that error, it is
    0, and ``l1`` is NaN.
    """
    own_1, own_2 = own_covariance(first, forcing_1), own_covariance(second, forcing_2)
    both = pair_covariance(first, forcing_1, second, forcing_2)
    _, _, slip_2 = pair_row(first, forcing_1, second, forcing_2)
    _, velocity_1, slip_1 = pair_row(second, forcing_2, first, forcing_1)
    column_1 = _Column(own_1.mu_mu - both, -velocity_1, own_1.mu_mu - own_1.mu_z - slip_1)
    column_2 = _Column(both - own_2.mu_mu, -velocity_1, slip_2 - own_2.mu_mu + own_2.mu_z)
    # d/dt E[mu_2 mu_1'] = 0 gives E[mu_1' mu_2'], with mu_1'' from the equation of motion.
    velocities = (
        first.stiffness * both + first.damping * velocity_1 - first.coupling * slip_1 - forcing_2.mu
    )
    l0, l2 = column_1.mu - column_2.mu, own_1.v_v + own_2.v_v - 2 * velocities
    l0 = np.where(l0 < ROUNDING * (own_1.mu_mu + own_2.mu_mu), 0.0, l0)
    return _with_l1(l0, l2, ground, (first, forcing_1, column_1), (second, forcing_2, column_2))


@np.errstate(all="ignore")  # invalid moments are NaN
def _with_l1(
    l0: Array, l2: Array, ground: Filter, *structures: tuple[EquivalentSystem, Forcing, _Column]
) -> SpectralMoments:
    """All three moments of a displacement, or of the difference of those of two structures."""
    l1 = np.empty_like(l0)
    for begin in range(0, l1.size, CELLS):
        cells = slice(begin, begin + CELLS)
        s = np.sqrt(l2[cells] / l0[cells])[:, None] * NODES  # NaN if there is no motion
        below = ground.at((cells, None))
        parts = [(_take(a, cells), _take(b, cells), _take(c, cells)) for a, b, c in structures]
        drive = reduce(subtract, [below.later(system, force)(s) for system, force, _ in parts])
        decay = reduce(subtract, [_decay(system, column, drive, s) for system, _, column in parts])
        l1[cells] = (2 / np.pi) * STEP * (s * decay).sum(axis=1)
    return SpectralMoments(l0, l1, l2)


def _take(rows: Rows, cells: slice) -> Rows:
    """A range of the cells, with an axis for the nodes added."""
    return type(rows)(*(row[cells, None] for row in rows))


def _decay(system: EquivalentSystem, column: _Column, drive: Array, s: Array) -> Array:
    """``-Int_0^inf E[mu'(t + tau) x(t)] e^(-s tau) dtau``, from the equations of motion.

    ``column`` has the covariances with ``x`` at ``tau = 0``, and ``drive`` is the Laplace transform of
    the covariance of the later forcing with ``x``. The equations are solved for the velocity, which
    avoids cancellation as ``s -> 0``.
    """
    w2, d, h, p, k = system
    right = w2 * column.mu - s * (column.velocity + drive)
    right = (s + k) * right - h * (s * column.slip + k * column.mu)
    return right / ((s + k) * ((s + d) * s + w2) - h * (k + p * s))
