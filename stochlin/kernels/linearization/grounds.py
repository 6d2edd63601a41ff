"""Covariances of a structure with ground filters of one or two oscillators, in closed form.

The Sylvester equation ``A C + C F' + R = 0`` of a structure with a filter oscillator ``F`` is solved in
the algebra of polynomials in ``F``: by its characteristic polynomial ``F^2 = -stiffness - e F``, so
that every element ``a + b F`` is a pair of numbers.

All functions take numbers or arrays of cells. A *pair* has the covariances of a state of the structure
with both states of an oscillator, *rows* are those of ``mu``, ``mu'`` and ``y``, and a *signal* has the
covariances of these three with an acceleration. An oscillator is its stiffness and damping.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from stochlin.kernels.linearization.covariance import Forcing

Pair = tuple[Any, Any]
Rows = tuple[Pair, Pair, Pair]
Signal = tuple[Any, Any, Any]
NOTHING = 0.0, 0.0


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


def _sylvester(system: Any, oscillator: Any, r_mu: Any, r_v: Any, r_y: Any) -> Rows:
    """Rows of ``C`` from the rows ``r_mu``, ``r_v``, ``r_y`` of ``R``."""
    w2, d, h, p, k = system
    stiffness, e = oscillator
    a2, a1, a0 = d + k, w2 + d * k - h * p, (w2 - h) * k
    # D(-F) = constant + linear F, with the structure's characteristic polynomial D.
    constant = a0 - (e + a2) * stiffness
    linear = stiffness - e * e - a2 * e - a1
    moved = _apply(oscillator, r_mu)
    drive = r_v[0] + d * r_mu[0] - moved[0], r_v[1] + d * r_mu[1] - moved[1]
    moved = _apply(oscillator, drive)
    right = (
        k * drive[0] - moved[0] + h * (r_y[0] - p * r_mu[0]),
        k * drive[1] - moved[1] + h * (r_y[1] - p * r_mu[1]),
    )
    mu = _divide(oscillator, constant, linear, right)
    moved = _apply(oscillator, mu)
    velocity = -moved[0] - r_mu[0], -moved[1] - r_mu[1]
    flow = k * mu[0] + p * velocity[0] + r_y[0], k * mu[1] + p * velocity[1] + r_y[1]
    return mu, velocity, _divide(oscillator, k, -1.0, flow)


def _signal(oscillator: Any, rows: Any) -> Signal:
    """The signal of ``stiffness x + damping x'`` of an oscillator."""
    (mu, mu_rate), (v, v_rate), (y, y_rate) = rows
    stiffness, damping = oscillator
    return (
        stiffness * mu + damping * mu_rate,
        stiffness * v + damping * v_rate,
        stiffness * y + damping * y_rate,
    )


def kanai_tajimi(system: Any, ground: Any) -> tuple[Signal, Rows]:
    """Signal of a Kanai-Tajimi ground, eqs. (11) and (12), and rows with its oscillator.

    ``ground`` is ``S0``, ``wg^2`` and ``2 xig wg``; the acceleration is ``wg^2 xg + 2 xig wg xg'``.
    """
    intensity, stiffness, damping = ground
    soil = stiffness, damping
    noise = np.pi * intensity / damping, np.pi * intensity
    rows = _sylvester(system, soil, NOTHING, noise, NOTHING)
    return _signal(soil, rows), rows


def clough_penzien(system: Any, ground: Any) -> tuple[Signal, Rows, Rows]:
    """Signal of a Clough-Penzien ground, and rows with the soil and with the high-pass oscillator.

    ``ground`` is that of `kanai_tajimi`, then ``wf^2`` and ``2 xif wf``. The acceleration is ``f =
    xf'' = f_soil - wf^2 xf - 2 xif wf xf'``. The high-pass oscillator ``xf`` is itself a linear
    structure on the soil. The equations are block triangular, and are solved first for the soil.

    As ``E[xf' q]`` is constant, ``E[f q] = -E[xf' q']`` for any state ``q``. The sum above would lose
    all digits where the filter leaves little of the soil's motion.
    """
    intensity, stiffness, damping, layer_stiffness, layer_damping = ground
    soil, layer = (stiffness, damping), (layer_stiffness, layer_damping)
    noise = np.pi * intensity / damping, np.pi * intensity
    alone = layer_stiffness, layer_damping, 0.0, 0.0, np.sqrt(layer_stiffness)
    _, with_rate, _ = _sylvester(alone, soil, NOTHING, noise, NOTHING)
    # Covariance of the ground acceleration with the displacement of the high-pass oscillator.
    still = -(stiffness * with_rate[0] + damping * with_rate[1]) / layer_damping
    moved = _apply(soil, with_rate)
    of_soil = _sylvester(system, soil, NOTHING, (-moved[0], -moved[1]), NOTHING)
    mu, v, y = _signal(soil, of_soil)
    of_layer = _sylvester(system, layer, (0.0, mu), (still, v), (0.0, y))
    (_, mu), (_, v), (_, y) = of_layer
    w2, d, h, p, k = system
    return (-v, w2 * mu + d * v - h * y, k * y - k * mu - p * v), of_soil, of_layer


def forcing_of(system: Any, ground: Any, oscillators: int) -> Forcing:
    """Forcing of a structure by white noise through none, one or two ``oscillators``.

    The ``ground`` is that of `clough_penzien`, filled up with any numbers.
    """
    zero = 0.0 * system.stiffness * ground[0]
    signal: Any = zero, np.pi * ground[0] + zero, zero
    if oscillators == 1:
        signal, _ = kanai_tajimi(system, (ground[0], ground[1], ground[2]))
    elif oscillators == 2:
        signal, _, _ = clough_penzien(system, ground)
    return Forcing(signal[0], signal[1], signal[2])


# Of numbers and of arrays: where each pair depends on the last one, they are compiled.
FORMULAS = (
    _apply,
    _divide,
    _sylvester,
    _signal,
    kanai_tajimi,
    clough_penzien,
    forcing_of,
)
