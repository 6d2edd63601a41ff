"""The Bouc-Wen law ``z' = v - beta |v| |z|^(n-1) z - gamma v |z|^n`` for any ``n >= 1``.

The parameter ``A`` of the literature, the factor of ``v``, is redundant with the others and fixed
at 1, so that ``period`` is the period of small oscillations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import xarray as xr
from scipy.special import beta as beta_function
from scipy.special import betainc, gamma

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import Closure, ClosureValue, gaussian_covariance
from stochlin.models.parameters import Parameter, Range, parameter
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import GAUSSIAN, LAWS, Structure

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    import sympy
    import xarray as xr

SHARP = Range(lower=1.0, include_lower=True)
DISSIPATES = Range(reason="the loops dissipate nothing at 0, and make energy below")


def symbolic() -> sympy.Expr:
    """``G(v, z)`` as a sympy expression in ``v``, ``z``, ``beta``, ``gamma`` and ``exponent``."""
    import sympy

    v, z = sympy.symbols("v z", real=True)
    beta_, gamma_, n = sympy.symbols("beta gamma exponent", real=True)
    return v - beta_ * abs(v) * abs(z) ** (n - 1) * z - gamma_ * v * abs(z) ** n


def gaussian(latent: Array, parameters: Array) -> ClosureValue:
    """Gaussian closure (Wen 1980, J. Appl. Mech. 47).

    ``1 + c_e = beta F1 + gamma F2`` and ``k_e = beta F3 + gamma F4``. Wen's integral
    ``Is = 2 Int_l^(pi/2) sin^n t dt`` with ``l = atan2(sqrt(1 - r^2), r)``, where ``r`` is the
    correlation of ``v`` and ``z``, is computed as an incomplete beta function of ``r^2``.
    """
    sv, sz, r = latent
    beta_, gamma_, n = parameters
    q = np.sqrt((1 - r) * (1 + r))
    with np.errstate(under="ignore"):
        even = 2 ** (n / 2) * gamma((n + 2) / 2) / np.pi * beta_
        odd = 2 ** (n / 2) * gamma((n + 1) / 2) / np.sqrt(np.pi) * gamma_
        integral = np.sign(r) * beta_function(0.5, (n + 1) / 2) * betainc(0.5, (n + 1) / 2, r * r)
        slip = sz**n * (even * integral + odd)
        share = even * (2 / n * q ** (n + 1) + r * integral) + odd * r
        relaxation = n * sv * sz ** (n - 1) * share
    return ClosureValue(np.array([slip, relaxation]), gaussian_covariance(latent))


@LAWS.register("bouc_wen", place=2)
@dataclass(frozen=True)
class BoucWen(Structure):
    """Bouc-Wen oscillator: ``z' = v - beta |v| |z|^(n-1) z - gamma v |z|^n``.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`. The hysteretic displacement is ``uy z``; in loading ``z`` [-] approaches
        ``(beta + gamma)^(-1/n)``, which is 1 for the default parameters.
    beta : float or array
        Width ``beta`` of the hysteresis loops [-], positive.
    gamma : float or array
        Shape ``gamma`` of the hysteresis loops [-], greater than ``-beta``; otherwise ``z`` would
        not be bounded. The loops bulge if ``gamma > beta``.
    exponent : float or array
        Exponent ``n`` [-], at least 1: the sharpness of yielding. As ``n`` grows, the law
        approaches the bilinear one.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`.

    References
    ----------
    Wen, Y. K. (1976), J. Eng. Mech. Div. ASCE 102; linearized as in Wen, Y. K. (1980), J. Appl.
    Mech. 47. Bounds of ``z`` as in Ismail, M., Ikhouane, F. and Rodellar, J. (2009), Arch. Comput.
    Methods Eng. 16, classes I and II.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.BoucWen(period=1.0, damping=0.05, hardening=0.1, yield_displacement=0.02).exponent
    1.0
    """

    beta: Parameter = parameter("1", "Bouc-Wen beta", DISSIPATES, 0.5)
    gamma: Parameter = parameter("1", "Bouc-Wen gamma", Range(lower=-float("inf")), 0.5)
    exponent: Parameter = parameter("1", "Bouc-Wen exponent n", SHARP, 1.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        saturates = self._saturates()
        if not saturates.ndim and not saturates:
            what = f"BoucWen: gamma = {self.gamma:g} is out of range"
            raise ValueError(
                f"{what}; allowed: -beta < value, where z is bounded; beta is {self.beta:g}"
            )

    def doubts(self) -> Iterator[str]:
        """Texts of ``Structure``, and on a bound of z that makes the strength another one."""
        yield from super().doubts()
        largest = self.largest_z()
        text = PLAUSIBLE["largest z"].doubt(float(largest)) if not largest.ndim else ""
        if text:
            both = f"beta = {self.beta} and gamma = {self.gamma}"
            yield f"{both} bound z at {float(largest):.3g}, and so the strength; {text}"

    def valid(self) -> xr.DataArray:
        """True for the cells in which every parameter is in its range."""
        return super().valid() & self._saturates()

    def _saturates(self) -> xr.DataArray:
        """Whether ``z`` is bounded in loading; in unloading it is for any ``beta - gamma``."""
        values = self.arrays()
        return values["gamma"] > -values["beta"]

    closures: ClassVar[Mapping[str, Closure]] = {GAUSSIAN: gaussian}
    symbolic = staticmethod(symbolic)

    def largest_z(self) -> xr.DataArray:
        """``(beta + gamma)^(-1/n)``, which ``z`` approaches in loading."""
        values = self.arrays()
        return (values["beta"] + values["gamma"]) ** (-1 / values["exponent"])

    def has_one_solution(self) -> xr.DataArray:
        """Whether linearization has at most one solution: true for ``gamma <= beta``.

        This is not proved; no second solution was found in many thousand random cells. For
        ``gamma > beta`` the structure also slips in unloading, and there may be three solutions.
        """
        values = self.arrays()
        return values["gamma"] <= values["beta"]

    def step(self) -> Any:
        """The law in time steps, as ``kernels.simulation.laws`` has it; without powers if n = 1."""
        from stochlin.kernels.simulation.laws import BOUC_WEN, LINEAR_BOUC_WEN

        return LINEAR_BOUC_WEN if (self.arrays()["exponent"] == 1).all() else BOUC_WEN
