"""Bilinear hysteresis law of Suzuki and Minai, eq. (7): elastic up to ``z = +-1``, then plastic."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import xarray as xr

from stochlin.kernels.linearization.gaussian import Closure, gaussian
from stochlin.models.structures import GAUSSIAN, LAWS, Structure

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy


ALWAYS = xr.DataArray(True)


def symbolic() -> sympy.Expr:
    """``G(v, z)`` of eq. (7) as a sympy expression in the symbols ``v`` and ``z``."""
    import sympy

    v, z = sympy.symbols("v z", real=True)
    step = sympy.Heaviside
    return v * (1 - step(v) * step(z - 1) - step(-v) * step(-z - 1))


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
        Hardening ratio ``alpha``, post-yield over elastic stiffness [-], in (-1, 1]. It is required
        if a strength is given. At 0 the structure is elastic-plastic. Below 0 it softens and may
        fall, as under its weight: with ``theta = W/(k h)`` of the weight ``W`` at the height ``h``
        above a spring ``k``, hardening is ``(alpha - theta)/(1 - theta)``, the square of the
        frequency and the damping ratio are ``1 - theta`` and ``1/sqrt(1 - theta)`` times those
        without weight. Stationary responses need a positive ratio; motions of finite length do not.
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

    Warns
    -----
    ImplausibleInput
        If a number is one that no building has, such as a period of 500 s, a damping ratio of 0.3
        or a mass of 400 kg; and, by functions that take the structure, if it has a hardening ratio
        and no strength. Arrays are not asked about.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (5) to (7), with the law of Suzuki and Minai as in
    Roberts, J. B. and Spanos, P. D. (1990), Random vibration and statistical linearization.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.Bilinear(period=1.0, damping=0.05, hardening=0.05, reduction_factor=4).describe()
    'Bilinear (period 1 s, damping 0.05, hardening 0.05, reduction factor 4, peak factor 3)'
    """

    closures: ClassVar[Mapping[str, Closure]] = {GAUSSIAN: gaussian}
    symbolic = staticmethod(symbolic)

    def has_one_solution(self) -> xr.DataArray:
        """Whether linearization has at most one solution: true for all parameters.

        This is not proved; no second solution was found in many thousand random cells.
        """
        return ALWAYS

    def step(self) -> Any:
        """The kind of element of ``kernels.simulation.laws`` that has this law."""
        from stochlin.kernels.simulation.laws import BILINEAR

        return BILINEAR
