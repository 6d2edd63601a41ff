"""Covariances of a structure with ground filters of one or two oscillators, in closed form.

The Sylvester equation ``A C + C F' + R = 0`` of a structure with a filter oscillator ``F`` is
solved in the algebra of polynomials in ``F``: by its characteristic polynomial ``F^2 = -stiffness -
e F``, so that every element ``a + b F`` is a pair of numbers.

All functions take numbers or arrays of cells. A *pair* has the covariances of a state of the
structure with both states of an oscillator, *rows* are those of ``mu``, ``mu'`` and ``y``, and a
*signal* has the covariances of these three with an acceleration. An oscillator is its stiffness and
damping.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.linearization.covariance import Forcing

Pair = tuple[Any, Any]
Rows = tuple[Pair, Pair, Pair]
Signal = tuple[Any, Any, Any]


def _apply(oscillator: Any, u: Any) -> Pair:
    """``F u`` with the companion matrix ``F = [[0, 1], [-stiffness, -damping]]``."""
    return u[1], -oscillator[0] * u[0] - oscillator[1] * u[1]


def _divide(oscillator: Any, a: Any, b: Any, u: Any) -> Pair:
    """``(a + b F)^-1 u``, by the conjugate ``a - b e - b F``, with the damping ``e``."""
    stiffness, damping = oscillator
    norm = a * a - a * b * damping + b * b * stiffness
    fu = _apply(oscillator, u)
    conjugate = a - b * damping
    return (conjugate * u[0] - b * fu[0]) / norm, (conjugate * u[1] - b * fu[1]) / norm


def _resolved(system: Any, oscillator: Any, u: Any) -> Pair:
    """``D(-F)^-1 u`` with the structure's characteristic polynomial ``D``."""
    w2, d, h, p, k = system
    stiffness, e = oscillator
    a2 = d + k
    constant = (w2 - h) * k - (e + a2) * stiffness  # D(-F) = constant + linear F
    linear = stiffness - e * (e + a2) - (w2 + d * k - h * p)
    return _divide(oscillator, constant, linear, u)


def _driven(system: Any, soil: Any, drive: Pair) -> tuple[Signal, tuple[Pair, Pair]]:
    """Signal of an oscillator whose states have covariances ``drive`` with the forcing of ``mu'``.

    Also returned are ``g = D(-F)^-1 drive`` and ``F g``. With these ``mu = (k - F) g``, ``mu' = -F
    mu`` and ``y = k g - p F g``.
    """
    _, _, _, p, k = system
    stiffness, e = soil
    g = _resolved(system, soil, drive)
    moved = _apply(soil, g)
    of_g = stiffness * g[0] + e * g[1]
    of_moved = stiffness * moved[0] + e * moved[1]
    part = k * of_g
    return (part - of_moved, -stiffness * of_g - (e + k) * of_moved, part - p * of_moved), (
        g,
        moved,
    )


def driven_rows(system: Any, soil: Any, ends: tuple[Pair, Pair]) -> Rows:
    """Rows with an oscillator from ``g`` and ``F g`` of `_driven`."""
    _, _, _, p, k = system
    g, moved = ends
    mu = k * g[0] - moved[0], k * g[1] - moved[1]
    back = _apply(soil, mu)
    return mu, (-back[0], -back[1]), (k * g[0] - p * moved[0], k * g[1] - p * moved[1])


def followed(system: Any, oscillators: Any, states: Any) -> list[tuple[Any, Any, Any, Any]]:
    """Parts of the free motion of ``z`` that follow one oscillator of the ground each.

    ``states`` are those of the oscillators. A part has the stiffness and the damping of its
    oscillator, its value and its rate. They follow from ``D(s) z = (1 - p) s f`` with the
    structure's characteristic polynomial ``D``. The high-pass filter is divided into what follows
    the soil, and its own motion.
    """
    if not oscillators:
        return []
    soil, *layers = zip(oscillators[::2], oscillators[1::2], strict=True)
    moving = [(soil, states[:2])]
    if layers:
        layer = layers[0]
        place = _divide(soil, layer[0] - soil[0], layer[1] - soil[1], states[:2])
        rate = _apply(soil, place)
        change = _apply(soil, rate)
        moving = [(soil, change), (layer, (-rate[1] - states[2], -change[1] - states[3]))]
    parts = []
    for oscillator, (place, rate) in moving:
        stiffness, damping = oscillator
        # Backwards in time, where the matrix of the oscillator is -F.
        back = _resolved(system, (stiffness, -damping), (place, -rate))
        moved = _apply(oscillator, (back[0], -back[1]))
        again = _apply(oscillator, moved)
        value = (system.slip - 1) * again[1]
        parts.append((stiffness, damping, value, (system.slip - 1) * _apply(oscillator, again)[1]))
    return parts


def _sylvester(system: Any, oscillator: Any, r_mu: Any, r_v: Any, r_y: Any) -> Rows:
    """Rows of ``C`` from the rows ``r_mu``, ``r_v``, ``r_y`` of ``R``."""
    _, d, h, p, k = system
    moved = _apply(oscillator, r_mu)
    drive = r_v[0] + d * r_mu[0] - moved[0], r_v[1] + d * r_mu[1] - moved[1]
    moved = _apply(oscillator, drive)
    right = (
        k * drive[0] - moved[0] + h * (r_y[0] - p * r_mu[0]),
        k * drive[1] - moved[1] + h * (r_y[1] - p * r_mu[1]),
    )
    mu = _resolved(system, oscillator, right)
    moved = _apply(oscillator, mu)
    velocity = -moved[0] - r_mu[0], -moved[1] - r_mu[1]
    flow = k * mu[0] + p * velocity[0] + r_y[0], k * mu[1] + p * velocity[1] + r_y[1]
    return mu, velocity, _divide(oscillator, k, -1.0, flow)


def kanai_tajimi(system: Any, ground: Any) -> tuple[Signal, tuple[Pair, Pair]]:
    """Signal of a Kanai-Tajimi ground, eqs. (11) and (12), and what makes `driven_rows`.

    ``ground`` is ``S0``, ``wg^2`` and ``2 xig wg``; the acceleration is ``wg^2 xg + 2 xig wg xg'``.
    """
    intensity, stiffness, damping = ground
    return _driven(system, (stiffness, damping), (np.pi * intensity / damping, np.pi * intensity))


def clough_penzien(system: Any, ground: Any) -> tuple[Signal, tuple[Pair, Pair], Rows]:
    """Signal of Clough-Penzien ground, what makes `driven_rows`, and rows with a high-pass filter.

    ``ground`` is that of `kanai_tajimi`, then ``wf^2`` and ``2 xif wf``. The acceleration is ``f =
    xf'' = f_soil - wf^2 xf - 2 xif wf xf'``. The high-pass oscillator ``xf`` is itself a linear
    structure on the soil. The equations are block triangular, and are solved first for the soil.

    As ``E[xf' q]`` is constant, ``E[f q] = -E[xf' q']`` for any state ``q``. The sum above would
    lose all digits where the filter leaves little of the soil's motion.
    """
    intensity, stiffness, damping, layer_stiffness, layer_damping = ground
    soil = (stiffness, damping)
    layer = (layer_stiffness, layer_damping)
    noise = np.pi * intensity / damping, np.pi * intensity
    alone = layer_stiffness, layer_damping, 0.0, 0.0, np.sqrt(layer_stiffness)
    _, ends = _driven(alone, soil, noise)
    _, with_rate, _ = driven_rows(alone, soil, ends)
    # Covariance of the ground acceleration with the displacement of the high-pass oscillator.
    of_ground = -(stiffness * with_rate[0] + damping * with_rate[1]) / layer_damping
    moved = _apply(soil, with_rate)
    (mu, v, y), ends = _driven(system, soil, (-moved[0], -moved[1]))
    of_layer = _sylvester(system, layer, (0.0, mu), (of_ground, v), (0.0, y))
    w2, d, h, p, k = system
    (_, mu_rate), (v_place, v_rate), _ = of_layer
    drive = (1 - p) * v_place, (1 - p) * v_rate + (mu - y)
    # Not as a difference, which is small if the slip is large.
    _, z_rate = _divide(layer, k, -1.0, drive)
    signal = -v_rate, (w2 - h) * mu_rate + d * v_rate + h * z_rate, -k * z_rate - p * v_rate
    return signal, ends, of_layer


class Soil(NamedTuple):
    """A ground of oscillators; numbers, or arrays of cells."""

    parameters: Any  # those of `clough_penzien`, filled up with any numbers
    oscillators: int  # 0 of white noise, 1 or 2


def forcing_of(system: Any, soil: Soil) -> Forcing:
    """Forcing of a structure by white noise through the oscillators."""
    ground = soil.parameters
    zero = 0.0 * system.stiffness * ground[0]
    signal: Any = zero, np.pi * ground[0] + zero, zero
    if soil.oscillators == 1:
        signal, _ = kanai_tajimi(system, (ground[0], ground[1], ground[2]))
    elif soil.oscillators == 2:
        signal, _, _ = clough_penzien(system, ground)
    return Forcing(signal[0], signal[1], signal[2])


# The formulas that are also compiled for numbers.
FORMULAS = (
    _apply,
    _divide,
    _resolved,
    _driven,
    driven_rows,
    _sylvester,
    kanai_tajimi,
    clough_penzien,
    forcing_of,
)
