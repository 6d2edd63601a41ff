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
    """Spectral moments of one structure's displacement.

    Parameters
    ----------
    system, forcing
        Entries of shape (n,).
    ground : Filter
        Of the n cells.
    """
    own = own_covariance(system, forcing)
    column = _Column(own.mu_mu, np.zeros_like(own.mu_mu), own.mu_mu - own.mu_z)
    l1 = np.empty_like(own.mu_mu)
    for cells in _blocks(l1.size):
        part, force = _take(system, cells), _take(forcing, cells)
        drive = ground.at((cells, None)).later(part, force)
        s = _frequencies(own.mu_mu[cells], own.v_v[cells])
        l1[cells] = _integral(s, _decay(part, _take(column, cells), drive(s), s))
    return SpectralMoments(own.mu_mu, l1, own.v_v)


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
    l1 = np.empty_like(l0)
    for cells in _blocks(l1.size):
        below = ground.at((cells, None))
        parts = [_take(system, cells) for system in (first, second)]
        drives = [
            below.later(part, _take(force, cells))
            for part, force in zip(parts, (forcing_1, forcing_2), strict=True)
        ]
        s = _frequencies(l0[cells], l2[cells])
        drive = drives[0](s) - drives[1](s)
        columns = [_take(column, cells) for column in (column_1, column_2)]
        decays = [_decay(*pair, drive, s) for pair in zip(parts, columns, strict=True)]
        l1[cells] = _integral(s, decays[0] - decays[1])
    return SpectralMoments(l0, l1, l2)


def _blocks(size: int) -> list[slice]:
    return [slice(begin, begin + CELLS) for begin in range(0, size, CELLS)]


def _take(rows: Rows, cells: slice) -> Rows:
    """Some cells, with an axis for the nodes."""
    return type(rows)(*(row[cells, None] for row in rows))


@np.errstate(invalid="ignore", divide="ignore")  # no motion, no frequency: NaN
def _frequencies(l0: Array, l2: Array) -> Array:
    return np.sqrt(l2 / l0)[:, None] * _NODES


def _integral(s: Array, decay: Array) -> Array:
    total: Array = (2 / np.pi) * STEP * (s * decay).sum(axis=1)
    return total


def _decay(system: EquivalentSystem, column: _Column, drive: Array, s: Array) -> Array:
    """``-Int_0^inf E[mu'(t + tau) x(t)] e^(-s tau) dtau``, from the equations of motion.

    ``column`` holds the correlations with ``x`` at ``tau = 0``, ``drive`` the transform of those of the
    forcing. Solved for the velocity, so that the limit ``s -> 0`` needs no subtraction.
    """
    w2, d, h, p, k = system
    right = w2 * column.mu - s * (column.velocity + drive)
    right = (s + k) * right - h * (s * column.slip + k * column.mu)
    result: Array = right / ((s + k) * ((s + d) * s + w2) - h * (k + p * s))
    return result
