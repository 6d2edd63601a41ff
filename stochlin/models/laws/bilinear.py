"""The bilinear hysteresis law of Suzuki and Minai, eq. (7): elastic up to ``z = +-1``, then plastic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import xarray as xr
from scipy.special import erf, erfc, gammainc

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import (
    Closure,
    ClosureValue,
    gaussian_covariance,
    regress_slip,
    slip_quadrant,
)
from stochlin.models.structures import DRIFT, GAUSSIAN, LAWS, NARROW_BAND, Structure

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy

    from stochlin.kernels.simulation.ensemble import Block


def symbolic() -> sympy.Expr:
    """``G(v, z)`` of eq. (7) as a sympy expression in the symbols ``v`` and ``z``."""
    import sympy

    v, z = sympy.symbols("v z", real=True)
    step = sympy.Heaviside
    return v * (1 - step(v) * step(z - 1) - step(-v) * step(-z - 1))


def gaussian(latent: Array, parameters: Array) -> ClosureValue:
    """Gaussian closure: the equivalent coefficients of eqs. (9) and (10) in closed form.

    ``1 + c_e = 2 P(v > 0, z > 1)`` and ``k_e = 2 sv h (r h B + q E)``, where ``sv`` and ``sz`` are the
    latent standard deviations, ``r`` their correlation, ``h = 1/sz``, ``q = sqrt(1 - r^2)``, and ``B``
    and ``E`` the ``edge`` and ``corner`` of `slip_quadrant`.
    """
    sv, sz, r = latent
    s = slip_quadrant(sz, r)
    h, q, edge, corner = s.h, s.q, s.edge, s.corner
    relaxation = 2 * sv * h * (r * h * edge + q * corner)
    jacobian = np.array(
        [
            [0 * sv, 2 * h * h * edge, 2 * corner / q],
            [
                relaxation / sv,
                -2 * sv * h**2 * (r * h * (2 - h * h) * edge + q * (1 - h * h) * corner),
                2 * sv * h * (h * edge - (r / q) * corner),
            ],
        ]
    )
    coefficients = np.array([2 * s.probability, relaxation])
    return ClosureValue(coefficients, jacobian, *gaussian_covariance(latent))


def clipped(latent: Array, parameters: Array) -> ClosureValue:
    """Clipped closure (Asano & Iwan 1984; Hurtado & Barbat 1996): ``z = clip(z~, -1, 1)``.

    ``(v, z~)`` is Gaussian with the latent moments, so that ``|z| <= 1`` always holds. The equivalent
    coefficients are those of the linear regression of the slip rate ``v - G`` on ``(v, z)``.
    """
    sv, sz, r = latent
    s = slip_quadrant(sz, r)
    h, q, edge, corner = s.h, s.q, s.edge, s.corner
    dh = -h * h
    slip = np.array([2 * sv * sv * s.second, 2 * sv * s.first])
    slip_jacobian = np.array(
        [
            [
                4 * sv * s.second,
                -2 * sv * sv * dh * ((q * q + (r * h) ** 2) * edge + r * h * q * corner),
                4 * sv * sv * (r * h * edge + q * corner),
            ],
            [2 * s.first, -2 * sv * dh * (r * h * edge + q * corner), 2 * sv * edge],
        ]
    )
    moments = _clipped_covariance(latent)
    return ClosureValue(*regress_slip(slip, slip_jacobian, *moments), *moments)


def _clipped_covariance(latent: Array) -> tuple[Array, Array]:
    """``(Var v, Var z, Cov(v, z))`` of the clipped density, and its Jacobian by the latent moments."""
    sv, sz, r = latent
    h = 1 / sz
    inside = erf(h / np.sqrt(2))  # P(|z~| < 1)
    inside_square = gammainc(1.5, 0.5 * h * h)  # E[(z~/sz)^2; |z~| < 1]
    zero = 0 * sv
    z_z = sz * sz * inside_square + erfc(h / np.sqrt(2))
    by_moments = [r * sz * inside, r * sv * inside_square, sv * sz * inside]
    jacobian = np.array([[2 * sv, zero, zero], [zero, 2 * sz * inside_square, zero], by_moments])
    return np.array([sv * sv, z_z, r * sv * sz * inside]), jacobian


@LAWS.register("bilinear", place=1)
@dataclass(frozen=True)
class Bilinear(Structure):
    """Bilinear hysteretic oscillator, eqs. (5) to (7) of the paper.

    Parameters
    ----------
    period : float or array
        Period of small oscillations ``2 pi / w`` [s], positive.
    damping : float or array
        Viscous damping ratio ``xi`` [-], in (0, 1).
    hardening : float or array, optional
        Hardening ratio ``alpha``, post-yield over elastic stiffness [-], in (0, 1]. It is required if a
        strength is given.
    yield_displacement : float or array, optional
        Yield displacement ``uy`` [m], positive, as the strength of the structure.
    reduction_factor : float or array, optional
        Reduction factor ``R = p sigma_el / uy`` [-], positive, as the strength of the structure:
        the peak ``p sigma_el`` of the elastic structure on the given ground over ``uy``. If neither
        strength is given, the structure stays elastic.
    peak_factor : float or array
        Peak factor ``p`` [-] in the definition of ``R``.
    mass : float, optional
        Mass [kg], positive. Only structures that act on one another need it, through a `Link` or in
        pounding.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number, an array has a wrong shape, both
        strengths are given, or a strength is given without hardening.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (7), with the law of Suzuki and Minai as in Roberts,
    J. B. and Spanos, P. D. (1990), Random vibration and statistical linearization.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Bilinear(period=1.0, damping=0.05, hardening=0.05, reduction_factor=4).describe()
    'Bilinear(period=1, damping=0.05, hardening=0.05, reduction_factor=4, peak_factor=3)'
    """

    closures: ClassVar[Mapping[str, Closure | None]] = {
        GAUSSIAN: gaussian,
        "clipped": clipped,
        DRIFT: clipped,
        NARROW_BAND: None,
    }
    symbolic = staticmethod(symbolic)

    def has_one_solution(self) -> xr.DataArray:
        """Whether linearization has at most one solution: true for all parameters.

        This is not proved; no second solution was found in many thousand random cells.
        """
        return xr.DataArray(True)

    def block(self) -> Block:
        """Time-stepping function of oscillators with this law."""
        from stochlin.kernels.simulation.stepping import bilinear_block

        return bilinear_block

    def in_storeys(self) -> Any:
        """The kind of element of ``kernels.simulation.storey_stepping`` that has this law."""
        from stochlin.kernels.simulation.storey_stepping import BILINEAR

        return BILINEAR
