"""Bouc-Wen law of Baber and Noori, which loses strength and stiffness with energy, and pinches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from stochlin.models.laws.bouc_wen import DISSIPATES, SHARP
from stochlin.models.parameters import NOT_NEGATIVE, POSITIVE, Parameter, Range, parameter
from stochlin.models.structures import LAWS, Structure

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy

BELOW_1 = Range(upper=1.0, include_lower=True, reason="1 would take all stiffness")
DECAYS = Range(include_lower=True, reason="damage makes nothing stronger or stiffer")


def symbolic() -> Mapping[str, sympy.Expr]:
    """The rates of ``z`` and of the energy ``e``, in ``v``, both states and the parameters."""
    import sympy

    v, z, e, beta, n = sympy.symbols("v z e beta exponent", real=True)
    strength, stiffness = sympy.symbols("strength_decay stiffness_decay", real=True)
    ends = ("", "_rate", "_start", "_width", "_spread", "_coupling")
    pinching = [sympy.Symbol(f"pinching{end}", real=True) for end in ends]
    most, rate, start, width, spread, coupling = pinching
    nu = 1 + strength * e
    eta = 1 + stiffness * e
    slip = nu * abs(z) ** n * (beta * abs(v) * sympy.sign(z) + (1 - beta) * v)
    zeta = most * (1 - sympy.exp(-rate * e))
    distance = z * sympy.sign(v) - start * nu ** (-1 / n)
    distance /= (width + spread * e) * (coupling + zeta)
    return {"z": (1 - zeta * sympy.exp(-(distance**2))) / eta * (v - slip), "e": z * v}


@LAWS.register("bouc_wen_baber_noori", place=4)
@dataclass(frozen=True)
class BoucWenBaberNoori(Structure):
    """Oscillator that degrades and pinches: the Bouc-Wen law as extended by Baber, Wen and Noori.

    With the ductility ``mu = u/uy`` and the dissipated energy ``E``, ``E' = z mu'``, the law is

        ``z' = h/eta [mu' - nu (beta |mu'| |z|^(n-1) z + (1 - beta) mu' |z|^n)]``

    with ``nu = 1 + d_nu E``, ``eta = 1 + d_eta E`` and the pinching

        ``h = 1 - zeta1 exp(-(z sign(mu') - q nu^(-1/n))^2/zeta2^2)``,
        ``zeta1 = zeta_s (1 - exp(-p E))``,  ``zeta2 = (psi + d_psi E) (lambda + zeta1)``.

    It degrades for ever, so that it has no stationary response. It is followed in motions of finite
    length: by `simulate` with a duration, `separation`, `respond`, `recorded_gap` and `pound`, and
    linearized with its mean energy by `transient_response` and `pounding_probability`.

    Parameters
    ----------
    period, damping, hardening, yield_displacement, reduction_factor, peak_factor
        As in `Bilinear`; period and strength are those before any damage. The energy ``E`` [-] is
        over ``(1 - hardening)`` times the elastic stiffness times ``uy^2``.
    beta : float or array
        Width ``beta`` of the hysteresis loops [-], positive. With ``gamma = 1 - beta`` the strength
        is that of ``z = 1`` before any damage.
    exponent : float or array
        Exponent ``n`` [-], at least 1: the sharpness of yielding.
    strength_decay : float or array
        ``d_nu`` [-], not negative: the strength falls with ``(1 + d_nu E)^(-1/n)``.
    stiffness_decay : float or array
        ``d_eta`` [-], not negative: the stiffness falls with ``1/(1 + d_eta E)``.
    pinching : float or array
        ``zeta_s`` [-], at least 0 and below 1: the largest share of the stiffness that pinching
        takes. At 0 the loops are not pinched, and the other parameters of pinching have no effect.
    pinching_rate : float or array
        ``p`` [-], positive: how fast pinching develops with the energy.
    pinching_start : float or array
        ``q`` [-], not negative: the ``z`` of the strongest pinching, over the present strength.
    pinching_width : float or array
        ``psi`` [-], positive: the range of ``z`` that is pinched.
    pinching_spread : float or array
        ``d_psi`` [-], not negative: the growth of this range with the energy.
    pinching_coupling : float or array
        ``lambda`` [-], positive: how little the range depends on the share that pinching takes.
    mass : float, optional
        As in `Bilinear`.

    Raises
    ------
    ValueError, TypeError
        As in `Bilinear`. What needs a stationary response refuses the law: by an ArithmeticError
        what linearizes, by a ValueError what simulates.

    Notes
    -----
    A test to large drifts and back shows which parameters fit a building. Published ones differ
    from specimen to specimen. Between two opposite states the law can give back a little more work
    than it has taken, as the Bouc-Wen law can.

    References
    ----------
    Baber, T. T. and Wen, Y. K. (1981), J. Eng. Mech. Div. ASCE 107, 1069-1087; Baber, T. T. and
    Noori, M. N. (1986), J. Vib. Acoust. Stress Reliab. Des. 108, 411-420; Foliente, G. C. (1995),
    J. Struct. Eng. ASCE 121, 1013-1022, for the pinching.

    Examples
    --------
    >>> import stochlin as sl
    >>> frame = sl.BoucWenBaberNoori(
    ...     period=0.6, damping=0.05, hardening=0.05, yield_displacement=0.02,
    ...     strength_decay=0.02, stiffness_decay=0.05, pinching=0.9,
    ... )
    >>> ground = sl.KanaiTajimi(0.4, 0.6, 0.02)
    >>> sl.simulate([frame], ground, paths=32, duration=10.0).sizes["path"]
    32
    """

    symbolic = staticmethod(symbolic)

    beta: Parameter = parameter("1", "width beta of the loops", DISSIPATES, 0.5)
    exponent: Parameter = parameter("1", "Bouc-Wen exponent n", SHARP, 1.0)
    strength_decay: Parameter = parameter("1", "strength decay d_nu", DECAYS, 0.0)
    stiffness_decay: Parameter = parameter("1", "stiffness decay d_eta", DECAYS, 0.0)
    pinching: Parameter = parameter("1", "share zeta_s of pinching", BELOW_1, 0.0)
    pinching_rate: Parameter = parameter("1", "rate p of pinching", POSITIVE, 1.0)
    pinching_start: Parameter = parameter("1", "place q of pinching", NOT_NEGATIVE, 0.15)
    pinching_width: Parameter = parameter("1", "width psi of pinching", POSITIVE, 0.2)
    pinching_spread: Parameter = parameter("1", "spread d_psi of pinching", NOT_NEGATIVE, 0.01)
    pinching_coupling: Parameter = parameter("1", "coupling lambda of pinching", POSITIVE, 0.4)

    def growing(self) -> tuple[str, ...]:
        """The energy, with which the law degrades."""
        return ("e",)
