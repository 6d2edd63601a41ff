"""Structures: oscillators of one degree of freedom whose stiffness may yield."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import xarray as xr

from stochlin.kernels.linearization.fixed_point import Closure
from stochlin.models.laws import bilinear, bouc_wen
from stochlin.models.parameters import Model, Parameter, Range, parameter

if TYPE_CHECKING:
    import sympy

    from stochlin.kernels.simulation.ensemble import Block

POSITIVE = Range()
DAMPING = Range(upper=1.0, reason="a ratio, .05 for 5 %")
HARDENING = Range(
    upper=1.0, include_upper=True, reason="without hardening there is no stationary displacement"
)

NARROW_BAND = "narrow_band"
DRIFT = "drift"  # the clipped closure, and the plastic drift that it loses


@dataclass(frozen=True)
class Structure(Model):
    """Base of the structures, eq. (5): ``mu'' + 2 xi w mu' + alpha w^2 mu + (1 - alpha) w^2 z = f/uy``.

    Strength is given by ``yield_displacement`` or by ``reduction_factor``; without either the
    structure stays elastic. A mass is for structures that act on one another, through a `Link`: all
    else does without.
    """

    period: Parameter = parameter("s", "period of small oscillations", POSITIVE)
    damping: Parameter = parameter("1", "damping ratio", DAMPING)
    hardening: Parameter | None = parameter("1", "hardening ratio", HARDENING, None)
    yield_displacement: Parameter | None = parameter("m", "yield displacement", POSITIVE, None)
    reduction_factor: Parameter | None = parameter("1", "reduction factor", POSITIVE, None)
    peak_factor: Parameter = parameter("1", "peak factor", POSITIVE, 3.0)
    _: KW_ONLY
    mass: float | None = parameter("kg", "mass", POSITIVE, None)

    def __post_init__(self) -> None:
        super().__post_init__()
        name = type(self).__name__
        if isinstance(self.mass, xr.DataArray):
            raise ValueError(f"{name}: mass is an array; allowed: a number")
        if self.yield_displacement is not None and self.reduction_factor is not None:
            raise ValueError(
                f"{name}: yield_displacement and reduction_factor are both given; allowed: one of them, "
                "since each defines the strength"
            )
        if self.yields and self.hardening is None:
            raise ValueError(
                f"{name}: hardening is not given; a structure with a strength needs its hardening "
                f"ratio, allowed: {HARDENING}"
            )

    @property
    def yields(self) -> bool:
        """Whether a strength is given."""
        return self.yield_displacement is not None or self.reduction_factor is not None

    def closure(self, name: str) -> Closure:
        """The closure ``name`` of this law: latent moments to equivalent coefficients."""
        return self._closures()[name]

    def closure_names(self) -> tuple[str, ...]:
        """Names that `linearize` accepts for this law."""
        return tuple(self._closures())

    def law_parameters(self) -> list[xr.DataArray]:
        """Parameters of the law beyond those of every structure."""
        return []

    def block(self) -> Block:
        """Time steps of this law."""
        raise NotImplementedError

    def _closures(self) -> Mapping[str, Closure]:
        raise NotImplementedError


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
        Post-yield over elastic stiffness ``alpha`` [-], in (0, 1]; needed with a strength.
    yield_displacement : float or array, optional
        ``uy`` [m], positive.
    reduction_factor : float or array, optional
        ``R = p sigma_el / uy`` [-], positive: elastic over yield strength on the given ground.
    peak_factor : float or array
        ``p`` [-] in the definition of ``R``.
    mass : float, optional
        [kg], positive; only what acts on another structure needs it, as with a `Link`.

    Raises
    ------
    ValueError, TypeError
        If a scalar is out of range, a value is not a number or an array is wrongly shaped, both
        strengths are given, or a strength comes without hardening.

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

    def _closures(self) -> Mapping[str, Closure]:
        return {"gaussian": bilinear.gaussian, "clipped": bilinear.clipped, DRIFT: bilinear.clipped}

    def closure_names(self) -> tuple[str, ...]:
        """Names that `linearize` accepts for this law."""
        return (*super().closure_names(), NARROW_BAND)

    def block(self) -> Block:
        """Time steps of this law."""
        from stochlin.kernels.simulation.stepping import bilinear_block

        return bilinear_block


@dataclass(frozen=True)
class BoucWen(Structure):
    """Bouc-Wen oscillator: ``z' = v - beta |v| |z|^(n-1) z - gamma v |z|^n``.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`; ``uy`` scales ``z``, which saturates at ``(beta + gamma)^(-1/n)``.
    beta : float or array
        Positive [-]: width of the loops.
    gamma : float or array
        [-], above ``-beta``, for ``z`` would not saturate otherwise: shape of the loops.
    exponent : float or array
        ``n >= 1`` [-]: sharpness of yielding; the bilinear law is its limit.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`.

    References
    ----------
    Wen, Y. K. (1976), J. Eng. Mech. Div. ASCE 102; linearized as in Wen, Y. K. (1980), J. Appl. Mech.
    47.

    Examples
    --------
    >>> import stochlin as sl
    >>> sl.BoucWen(period=1.0, damping=0.05, hardening=0.1, yield_displacement=0.02).exponent
    1.0
    """

    beta: Parameter = parameter("1", "Bouc-Wen beta", POSITIVE, 0.5)
    gamma: Parameter = parameter("1", "Bouc-Wen gamma", Range(lower=-float("inf")), 0.5)
    exponent: Parameter = parameter(
        "1", "Bouc-Wen exponent n", Range(lower=1.0, include_lower=True), 1.0
    )

    def _closures(self) -> Mapping[str, Closure]:
        return {"gaussian": bouc_wen.gaussian}

    def law_parameters(self) -> list[xr.DataArray]:
        """Beta, gamma and n."""
        values = self.arrays()
        return [values["beta"], values["gamma"], values["exponent"]]

    def block(self) -> Block:
        """Time steps of this law."""
        from stochlin.kernels.simulation.stepping import bouc_wen_block

        return bouc_wen_block


@dataclass(frozen=True)
class Hysteretic(Structure):
    """Oscillator with any odd hysteresis law ``z' = G(v, z)`` written as a sympy expression.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`.
    law : sympy.Expr
        ``G`` in symbols named ``v`` (ductility rate) and ``z``, odd in both together.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`; or if the law is missing, has other symbols, is not odd, or has kinks
        that cannot be located.

    References
    ----------
    Roberts, J. B. and Spanos, P. D. (1990), Random vibration and statistical linearization.

    Examples
    --------
    >>> import stochlin as sl, sympy
    >>> v, z = sympy.symbols("v z")
    >>> friction = sl.Hysteretic(1.0, 0.05, 0.1, reduction_factor=2, law=v - abs(v) * z)
    >>> friction.closure_names()
    ('gaussian',)
    """

    law: sympy.Expr | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        _ = self._compiled

    @cached_property
    def _compiled(self) -> Any:
        from stochlin.models.laws.symbolic import SymbolicLaw

        return SymbolicLaw(self.law)

    def _closures(self) -> Mapping[str, Closure]:
        return {"gaussian": self._compiled.gaussian}

    def block(self) -> Block:
        """Time steps of this law."""
        block: Block = self._compiled.block
        return block

    def describe(self) -> str:
        """One line with the parameters and the law."""
        return f"{super().describe()[:-1]}, law={self.law})"


@dataclass(frozen=True)
class LinearPair(Model):
    """Two linear oscillators: what eq. (4) asks for. Periods in s, damping ratios."""

    period_1: Parameter = parameter("s", "period, structure 1", POSITIVE)
    period_2: Parameter = parameter("s", "period, structure 2", POSITIVE)
    damping_1: Parameter = parameter("1", "damping ratio, structure 1", DAMPING)
    damping_2: Parameter = parameter("1", "damping ratio, structure 2", DAMPING)


@dataclass(frozen=True)
class Gap(Model):
    """The distance between two structures at rest: ``gap`` [m], positive."""

    gap: Parameter = parameter("m", "gap between the structures", POSITIVE)
