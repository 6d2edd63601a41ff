"""Spectral moments ``l0, l1, l2`` of displacements of linear and linearized structures on a ground.

``l_m = 2 Int_0^inf w^m S(w) dw`` with the two-sided PSD ``S``: ``l0`` and ``l2`` are the variances
of displacement and velocity, while ``l1`` is not a covariance of states. With the correlation
function ``R(tau)``, ``l1 = -(2/pi) Int_0^inf R'(tau)/tau dtau``, and since ``1/tau`` is the Laplace
transform of 1,

    l1 = (2/pi) Int_0^inf I(s) ds,    I(s) = -Int_0^inf R'(tau) e^(-s tau) dtau.

``I`` is rational with all its poles in the left half-plane. However light the damping, the path of
integration meets no resonance, and since no pole is computed, equal poles cause no error. The
substitution ``s = sqrt(l2/l0) e^x`` makes the integrand decay as ``e^-|x|`` in both directions. It
is analytic for ``|Im x| < pi/2``, so that the trapezoidal rule with step ``h`` has an error of
order ``e^(-pi^2/h)``.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    own_covariance,
)
from stochlin.kernels.linearization.filters import Filter

MOMENT_STEP = 0.33  # h of x, with an error of e^(-pi^2/h), about 5e-13
MOMENT_REACH = 29.0  # range of x, with an error of 2 e^-reach, likewise
MOMENT_NODES = np.exp(
    MOMENT_STEP * np.arange(-int(MOMENT_REACH / MOMENT_STEP), int(MOMENT_REACH / MOMENT_STEP) + 1)
)
# cells computed together, so that their values at all nodes stay in the cache
CELLS_OF_MOMENTS = 128


class SpectralMoments(NamedTuple):
    """``l0`` [m^2], ``l1`` [m^2/s], ``l2`` [m^2/s^2] of a displacement."""

    l0: Array
    l1: Array
    l2: Array


def bandwidth_of(l0: Array, l1: Array, l2: Array) -> Array:
    """Bandwidth ``sqrt(1 - l1^2/(l0 l2))`` [-]; NaN without motion."""
    bandwidth: Array = np.sqrt(np.clip(1 - l1**2 / (l0 * l2), 0, 1))
    return bandwidth


@np.errstate(all="ignore")  # NaN without motion
def displacement_moments(
    system: EquivalentSystem, forcing: Forcing, ground: Filter
) -> SpectralMoments:
    """Spectral moments of one structure's displacement, for cells (n,)."""
    covariance = own_covariance(system, forcing)
    l1 = np.empty_like(covariance.mu_mu)
    for begin in range(0, l1.size, CELLS_OF_MOMENTS):
        cells = slice(begin, begin + CELLS_OF_MOMENTS)
        part = EquivalentSystem(*(row[cells, None] for row in system))
        mu = covariance.mu_mu[cells, None]
        mu_z = covariance.mu_z[cells, None]
        v_v = covariance.v_v[cells, None]
        s = np.sqrt(v_v / mu) * MOMENT_NODES
        drive = ground.at((cells, None)).later(part, s)
        l1[cells] = (
            (2 / np.pi) * MOMENT_STEP * (s * _decay(part, mu, mu - mu_z, drive, s)).sum(axis=1)
        )
    return SpectralMoments(covariance.mu_mu, l1, covariance.v_v)


def _decay(system: EquivalentSystem, mu: Array, slip: Array, drive: Array, s: Array) -> Array:
    """``-Int_0^inf E[mu'(t + tau) mu(t)] e^(-s tau) dtau``, from the equations of motion.

    ``mu`` and ``slip`` are the covariances of ``mu`` and ``y`` with ``mu`` at ``tau = 0``, and
    ``drive`` is the Laplace transform of that of the later forcing. The equations are solved for
    the velocity, which avoids cancellation as ``s -> 0``.
    """
    w2, d, h, p, k = system
    right = (s + k) * (w2 * mu - s * drive) - h * (s * slip + k * mu)
    return right / ((s + k) * ((s + d) * s + w2) - h * (k + p * s))
