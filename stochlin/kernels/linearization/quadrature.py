"""Gaussian expectations ``E[w v]`` and ``E[w z]`` of a slip rate ``w(v, z)``, by quadrature.

The slip rate is an odd function, so that half of the plane is enough: ``E[w v] = 2 E[w v; v > 0]``.
The outer integral, over ``t = z/sz``, is by Gauss-Legendre quadrature on panels between the kinks
of the law. The inner one, over ``x = v/sv > 0`` for given ``t``, has a closed form for a
rate-independent law, ``w(v, z) = v w(1, z)``, and is by Gauss-Legendre quadrature otherwise. The
law itself is not differentiated, and may have kinks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from stochlin.kernels.basics.arrays import SQRT_2PI, Array

# standard deviations that are integrated over; the density beyond is below 1e-31
DENSITY_REACH = 12.0
# cells computed together, so that their values at all nodes stay in the cache
CELLS_OF_EXPECTATIONS = 64
# Kept, because a fixed point asks for the same nodes in every iteration.
gauss_legendre = cache(np.polynomial.legendre.leggauss)
# edges of panels that grow by a factor of 4
GRADED = np.concatenate([[0.0], 4.0 ** np.arange(-6, 1)])


class SlipRate(NamedTuple):
    """Slip rate ``w(v, z) = v - G(v, z)`` of a hysteresis law ``z' = G(v, z)``.

    Both functions take the parameters of the law (m, ...) as last argument, which broadcast against
    ``v`` and ``z``.
    """

    function: Callable[[Array, Array, Array], Array]  # w(v, z, parameters)
    kinks: Callable[[Array], Sequence[Array | float]]  # values of z at which w has kinks
    rate_independent: bool  # w is proportional to v for v > 0
    parameters: Array = np.empty((0, 1))  # (m, n): one column for each cell

    def __call__(self, v: Array, z: Array) -> Array:
        """The slip rate for ``v`` and ``z`` whose first dimension is that of the cells."""
        return self.function(
            v, z, self.parameters.reshape(*self.parameters.shape, *(1,) * (z.ndim - 1))
        )


def slip_expectations(law: SlipRate, latent: Array, parameters: Array, order: int) -> Array:
    """``(E[w v], E[w z])`` (2, n) for the moments ``latent`` (3, n).

    The moments are ``sv``, ``sz``, ``r`` of the Gaussian ``(v, z)``; ``parameters`` (m, n) are
    those of the law, and ``order`` is the number of Gauss-Legendre nodes of each panel.
    """
    moments = _moments(law, latent, parameters, order, 2)
    return latent[:2] * [moments[1, 0], moments[0, 1]]


def even_expectation(function: SlipRate, latent: Array, parameters: Array, order: int) -> Array:
    """``E[f]`` (n,) of an even function ``f(v, z)``, with arguments as for `slip_expectations`."""
    expectation: Array = _moments(function, latent, parameters, order, 1)[0, 0]
    return expectation


def _moments(law: SlipRate, latent: Array, parameters: Array, order: int, powers: int) -> Array:
    """``M[a, b] = 2 E[w x^a t^b; x > 0]`` for ``x = v/sv``, ``t = z/sz``, (powers, powers, n)."""
    moments = np.empty((powers, powers, latent.shape[1]))
    block = CELLS_OF_EXPECTATIONS if law.rate_independent else 1 + CELLS_OF_EXPECTATIONS // order
    for begin in range(0, latent.shape[1], block):
        cells = slice(begin, begin + block)
        of_block = law._replace(parameters=parameters[:, cells])
        moments[..., cells] = _of_block(of_block, latent[:, cells], order, powers)
    return moments


def _of_block(law: SlipRate, latent: Array, order: int, powers: int) -> Array:
    """`_moments` of cells that are computed together."""
    sv, sz, r = (row[:, None] for row in latent)
    q = np.sqrt((1 - r) * (1 + r))
    t, weight = _panels(law.kinks(law.parameters[:, :, None]), sz, r, q, order)
    weight = 2 * weight * np.exp(-0.5 * t * t) / SQRT_2PI
    inner = _inner_closed if law.rate_independent else _inner_quadrature
    outer = np.stack([weight * t**power for power in range(powers)])
    return np.einsum("anj,bnj->abn", inner(law, sv, sz * t, r * t, q, order, powers), outer)


def _panels(
    kinks: Sequence[Array | float], sz: Array, r: Array, q: Array, order: int
) -> tuple[Array, Array]:
    """Nodes and weights in ``t``, on panels between kinks and around ``t = 0``.

    At 0 the conditional mean of ``v`` changes sign, and the inner integral changes within
    ``q/|r|``, the more rapidly the nearer the correlation is to 1. The nodes are those of Gauss and
    Legendre in ``x`` with ``(3 x - x^3)/2`` as place in a panel. This makes a power of the distance
    to its end, such as that of ``|z|^1.5``, as smooth as twice the power.
    """
    turn = np.minimum(6 * q / np.maximum(np.abs(r), 1e-3), DENSITY_REACH)
    edges = [
        np.full_like(sz, -DENSITY_REACH),
        -turn,
        np.zeros_like(sz),
        turn,
        np.full_like(sz, DENSITY_REACH),
    ]
    edges += [np.clip(kink / sz, -DENSITY_REACH, DENSITY_REACH) for kink in kinks]
    border = np.sort(np.concatenate(edges, axis=1), axis=1)
    x, weights = gauss_legendre(order)
    nodes = 0.5 * x * (3 - x * x)
    weights = 1.5 * (1 - x * x) * weights
    half = 0.5 * np.diff(border, axis=1)[:, :, None]
    middle = 0.5 * (border[:, 1:] + border[:, :-1])[:, :, None]
    shape = (sz.shape[0], -1)
    return (middle + half * nodes).reshape(shape), (half * weights).reshape(shape)


def _inner_closed(
    law: SlipRate, sv: Array, z: Array, mean: Array, q: Array, order: int, powers: int
) -> Array:
    """``E[w x^a; x > 0 | t]`` for ``w = sv x w(1, z)``: truncated Gaussian moments by recursion."""
    density = np.exp(-0.5 * (mean / q) ** 2) / SQRT_2PI
    below = [ndtr(mean / q)]
    below.append(mean * below[0] + q * density)
    for power in range(2, powers + 1):
        below.append(mean * below[-1] + (power - 1) * q * q * below[-2])
    return sv * law(np.ones_like(z), z) * np.stack(below[1:])


def _inner_quadrature(
    law: SlipRate, sv: Array, z: Array, mean: Array, q: Array, order: int, powers: int
) -> Array:
    """``E[w x^a; x > 0 | t]`` by Gauss-Legendre quadrature, where the density is not negligible.

    The panels become smaller towards ``v = 0``, near which a rate-dependent law may change within a
    small part of ``sv``.
    """
    nodes, weights = on_panels(GRADED, 2 * order // 5)
    low, high = np.maximum(mean - DENSITY_REACH * q, 0), np.maximum(mean, 0) + DENSITY_REACH * q
    width = (high - low)[..., None]
    x = low[..., None] + width * nodes
    weight = width * weights * np.exp(-0.5 * ((x - mean[..., None]) / q[..., None]) ** 2)
    weight *= law(sv[..., None] * x, np.broadcast_to(z[..., None], x.shape))
    weight /= SQRT_2PI * q[..., None]
    return np.stack([(weight * x**power).sum(axis=-1) for power in range(powers)])


def on_panels(edges: Array, order: int) -> tuple[Array, Array]:
    """Nodes and weights of Gauss-Legendre quadrature of this order on each panel between edges."""
    nodes, weights = gauss_legendre(order)
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1 + nodes)).ravel(), (half * weights).ravel()
