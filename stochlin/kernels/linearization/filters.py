"""What a ground filter does to one oscillator: correlations of the forcing with its state.

A ground of two-sided intensity ``S0`` is white noise of intensity ``2 pi S0`` through
one oscillator (Kanai-Tajimi) or two (Clough-Penzien). The Sylvester equation
``A C + C F' + R = 0`` of a structure with a filter oscillator ``F`` is solved in the
quotient ring ``R[s]/(s^2 + e s + w^2)``, whose elements ``a + b F`` are pairs of numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, linear_system

Pair = tuple[Array, Array]


class FilterOscillator(NamedTuple):
    """Companion matrix ``F = [[0, 1], [-stiffness, -damping]]`` of ``q = (x, x')``."""

    stiffness: Array
    damping: Array

    def apply(self, u: Pair) -> Pair:
        """``F u``."""
        return u[1], -self.stiffness * u[0] - self.damping * u[1]

    def solve(self, a: Array, b: Array, u: Pair) -> Pair:
        """``(a + b F)^-1 u``, by the conjugate ``a - b e - b F``."""
        norm = a * a - a * b * self.damping + b * b * self.stiffness
        fu = self.apply(u)
        conjugate = a - b * self.damping
        return (conjugate * u[0] - b * fu[0]) / norm, (conjugate * u[1] - b * fu[1]) / norm


def _sylvester(
    system: EquivalentSystem,
    oscillator: FilterOscillator,
    r_mu: Pair,
    r_v: Pair,
    r_y: Pair,
) -> tuple[Pair, Pair, Pair]:
    """Rows of ``C`` in ``A C + C F' + R = 0`` for a structure and one filter oscillator."""
    _, d, h, p, k = system
    a2, a1, a0 = system.characteristic
    w2, e = oscillator
    # D(-F) reduced by F^2 = -w2 - e F
    constant = a0 - (e + a2) * w2
    linear = w2 - e * e - a2 * e - a1
    f_r_mu = oscillator.apply(r_mu)
    drive = (r_v[0] + d * r_mu[0] - f_r_mu[0], r_v[1] + d * r_mu[1] - f_r_mu[1])
    f_drive = oscillator.apply(drive)
    right = (
        k * drive[0] - f_drive[0] + h * (r_y[0] - p * r_mu[0]),
        k * drive[1] - f_drive[1] + h * (r_y[1] - p * r_mu[1]),
    )
    mu = oscillator.solve(constant, linear, right)
    f_mu = oscillator.apply(mu)
    velocity = (-f_mu[0] - r_mu[0], -f_mu[1] - r_mu[1])
    flow = (
        k * mu[0] + p * velocity[0] + r_y[0],
        k * mu[1] + p * velocity[1] + r_y[1],
    )
    return mu, velocity, oscillator.solve(k, -np.ones_like(k), flow)


_NOTHING = (np.zeros(()), np.zeros(()))


def white_noise_forcing(system: EquivalentSystem, intensity: Array) -> Forcing:
    """Forcing correlations under white noise of two-sided PSD ``intensity``."""
    zero = np.zeros_like(system.stiffness * intensity)
    return Forcing(zero, np.pi * intensity + zero, zero)


def kanai_tajimi_forcing(
    system: EquivalentSystem, intensity: Array, frequency: Array, damping_ratio: Array
) -> Forcing:
    """Forcing correlations under ``f = wg^2 xg + 2 xig wg xg'``, eqs. (11) and (12)."""
    soil = FilterOscillator(frequency**2, 2 * damping_ratio * frequency)
    with_forcing = (np.pi * intensity / soil.damping, np.pi * intensity)
    rows = _sylvester(system, soil, _NOTHING, with_forcing, _NOTHING)
    return Forcing(*(soil.stiffness * row[0] + soil.damping * row[1] for row in rows))


class GroundRows(NamedTuple):
    """Correlations of a structure's ``(mu, mu', y)`` with what drives it, on Clough-Penzien ground."""

    signal: tuple[Array, Array, Array]  # with the soil's signal, which drives the high-pass oscillator
    layer: tuple[Pair, Pair, Pair]  # with the high-pass oscillator's displacement and velocity


def clough_penzien_forcing(
    system: EquivalentSystem,
    intensity: Array,
    frequency: Array,
    damping_ratio: Array,
    high_pass_frequency: Array,
    high_pass_damping: Array,
) -> Forcing:
    """Forcing correlations under ``f = xf''``, with ``xf`` driven by the Kanai-Tajimi signal."""
    rows = clough_penzien_rows(
        system, intensity, frequency, damping_ratio, high_pass_frequency, high_pass_damping
    )
    stiffness, damping = high_pass_frequency**2, 2 * high_pass_damping * high_pass_frequency
    return Forcing(
        *(
            signal - stiffness * row[0] - damping * row[1]
            for signal, row in zip(rows.signal, rows.layer, strict=True)
        )
    )


def clough_penzien_rows(
    system: EquivalentSystem,
    intensity: Array,
    frequency: Array,
    damping_ratio: Array,
    high_pass_frequency: Array,
    high_pass_damping: Array,
) -> GroundRows:
    """What `clough_penzien_forcing` is made of.

    The high-pass oscillator is itself a linear structure on Kanai-Tajimi ground, and the
    filter cascade is block triangular: two solves of the same kind, one after the other.
    """
    soil = FilterOscillator(frequency**2, 2 * damping_ratio * frequency)
    layer = FilterOscillator(high_pass_frequency**2, 2 * high_pass_damping * high_pass_frequency)
    layer_system = linear_system(high_pass_frequency, high_pass_damping)
    noise = (np.pi * intensity / soil.damping, np.pi * intensity)
    x_row, v_row, _ = _sylvester(layer_system, soil, _NOTHING, noise, _NOTHING)
    layer_v_v = (soil.stiffness * v_row[0] + soil.damping * v_row[1]) / layer.damping

    # E[q f] with f = f_soil - stiffness xf - damping xf', for both filter stages.
    soil_f = (
        noise[0] - layer.stiffness * x_row[0] - layer.damping * v_row[0],
        noise[1] - layer.stiffness * x_row[1] - layer.damping * v_row[1],
    )
    layer_f = (-layer_v_v, np.zeros_like(layer_v_v))

    soil_rows = _sylvester(system, soil, _NOTHING, soil_f, _NOTHING)
    mu, velocity, slip = (soil.stiffness * row[0] + soil.damping * row[1] for row in soil_rows)
    zero = np.zeros_like(mu)
    layer_rows = _sylvester(system, layer, (zero, mu), (layer_f[0], layer_f[1] + velocity), (zero, slip))
    return GroundRows((mu, velocity, slip), layer_rows)
