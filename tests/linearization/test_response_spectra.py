"""An independent road: response spectra integrated over frequency, without a Lyapunov equation.

``E[u1 u2] = 2 Re Int_0^inf S(w) H1(w) conj(H2(w)) dw``, with ``S`` the two-sided spectrum of the
ground.
"""

from itertools import pairwise

import cases
import numpy as np
import pytest
from scipy.special import ndtr

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

NODES, WEIGHTS = np.polynomial.legendre.leggauss(40)


class Spectrum:
    """Nodes and weights on a logarithmic grid, fine around resonances, and the spectrum there."""

    def __init__(self, ground, resonances):
        # Around each resonance, borders at a geometric distance down to a fiftieth of its width.
        around = [
            w * np.exp(sign * np.geomspace(0.02 * xi, 3, 30))
            for w, xi in resonances
            for sign in (-1, 1)
        ]
        borders = np.unique(np.concatenate([[0], *around, np.geomspace(1e-7, 1e6, 60)]))
        half = np.diff(borders)[:, None] / 2
        middle = np.array([(a + b) / 2 for a, b in pairwise(borders)])[:, None]
        self.w = (middle + half * NODES).ravel()
        self.density = ground.psd(self.w).values * (half * WEIGHTS).ravel()

    def moment(self, first, second):
        return 2 * np.real(np.sum(self.density * first(self.w) * np.conj(second(self.w))))


def hysteretic_transfer(period, damping, hardening, c_eq, k_eq):
    """Transfer functions of u and of z, with ``z = -c_eq s/(s + k_eq) u``."""
    w0 = 2 * np.pi / period

    def z_over_u(w):
        return -c_eq * 1j * w / (1j * w + k_eq)

    def u(w):
        stiffness = w0**2 * (hardening + (1 - hardening) * z_over_u(w))
        return 1 / (stiffness - w**2 + 2j * damping * w0 * w)

    return u, lambda w: z_over_u(w) * u(w)


def rate(transfer):
    """Transfer function of the derivative."""
    return lambda w: 1j * w * transfer(w)


def draw_ground(rng, kind):
    soil = cases.draw_ground(rng, cases.PRACTICE)
    resonances = [(2 * np.pi / soil["period"], soil["damping"])]
    if kind is sl.KanaiTajimi:
        return sl.KanaiTajimi(**soil), resonances
    high_pass = {"high_pass_period": cases.log_uniform(rng, (2, 20)), "high_pass_damping": 0.6}
    resonances.append((2 * np.pi / high_pass["high_pass_period"], 0.6))
    return sl.CloughPenzien(**soil, **high_pass), resonances


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", [sl.KanaiTajimi, sl.CloughPenzien])
def test_linearized_response_and_its_self_consistency(kind, seed):
    """Moments of u, v and z from the spectra, and the Gaussian coefficients from these moments."""
    rng = np.random.default_rng([61, seed])
    ground, resonances = draw_ground(rng, kind)
    pair = [cases.draw_structure(rng, cases.PRACTICE) for _ in range(2)]
    structures = [sl.Bilinear(**one) for one in pair]
    tables = [sl.linearize(one, ground) for one in structures]
    for one, table in zip(pair, tables, strict=True):  # both stiffnesses, and the relaxation
        w0 = 2 * np.pi / one["period"]
        soft = w0 * np.sqrt(one["hardening"])
        resonances += [(w0, one["damping"]), (soft, one["damping"]), (float(table.k_eq), 0.5)]
    spectrum = Spectrum(ground, resonances)
    displacement = []
    for one, table in zip(pair, tables, strict=True):
        u, z = hysteretic_transfer(
            *(one[k] for k in ("period", "damping", "hardening")),
            float(table.c_eq),
            float(table.k_eq),
        )
        displacement.append(u)
        uy = float(table.yield_displacement)
        sv, sz = (np.sqrt(spectrum.moment(h, h)) / uy for h in (rate(u), z))
        r = spectrum.moment(rate(u), z) / uy**2 / (sv * sz)
        std = np.sqrt(spectrum.moment(u, u))
        assert float(table.displacement_std) == pytest.approx(std, rel=1e-10)
        assert float(table.velocity_std) == pytest.approx(sv * uy, rel=1e-9)
        assert float(table.z_std) == pytest.approx(sz, rel=1e-10)
        assert float(table.velocity_z_corr) == pytest.approx(r, abs=1e-9)
        assert 1 + float(table.c_eq) == pytest.approx(2 * probability_of_slip(sz, r), rel=1e-8)
    std = [np.sqrt(spectrum.moment(u, u)) for u in displacement]
    rho = spectrum.moment(*displacement) / np.prod(std)
    assert float(sl.correlate(*structures, ground).rho) == pytest.approx(rho, abs=1e-10)


def probability_of_slip(sz, r):
    """``P(v > 0, z > 1)`` as a tail integral."""
    t = 1 / sz + 6 * (1 + NODES)
    tail = np.exp(-0.5 * t * t) * ndtr(r * t / np.sqrt(1 - r * r))
    return 6 * WEIGHTS @ tail / np.sqrt(2 * np.pi)


def test_spectrum_has_the_variance_of_the_ground_filter():
    """``pi S0 wg (1 + 4 xig^2)/(2 xig)``; stiff oscillators feel the ground acceleration itself."""
    wg, xig, s0 = 2 * np.pi / 0.8, 0.3, 0.02
    ground = sl.KanaiTajimi(period=0.8, damping=xig, intensity=s0)
    expected = np.pi * s0 * wg * (1 + 4 * xig**2) / (2 * xig)
    spectrum = Spectrum(ground, [(wg, xig)])
    # Beyond the grid, at 1e6 rad/s, the tail 8 S0 xig^2 wg^2/w is left out.
    assert spectrum.moment(np.ones_like, np.ones_like) == pytest.approx(expected, rel=1e-5)
    stiff = sl.linearize(sl.Bilinear(period=1e-4, damping=0.9), ground)
    w0 = 2 * np.pi / 1e-4
    assert float(stiff.displacement_std) * w0**2 == pytest.approx(np.sqrt(expected), rel=1e-3)
