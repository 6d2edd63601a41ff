"""The Bouc-Wen law of Baber and Noori, which loses strength and stiffness with energy, and pinches."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from stochlin.models.laws.bouc_wen import DISSIPATES
from stochlin.models.parameters import (
    NOT_NEGATIVE,
    POSITIVE,
    Model,
    Parameter,
    Range,
    numbers_or_arrays,
    parameter,
)
from stochlin.models.structures import LAWS, Structure
from stochlin.models.uncertain import takes_uncertain

if TYPE_CHECKING:
    from collections.abc import Mapping

    import sympy
    import xarray as xr

BELOW_1 = Range(upper=1.0, include_lower=True, reason="1 would take all stiffness")
DECAYS = Range(include_lower=True, reason="damage makes nothing stronger or stiffer")
CAP_OVER_YIELD = 1.1  # moment of steel beams at the cap over that at yielding
EXPONENT = Range(lower=1.0, include_lower=True)


def within(lower: float, upper: float, reason: str = "as in the tests") -> Range:
    """The range of a property in the tests of steel beams."""
    return Range(lower, upper, include_lower=True, include_upper=True, reason=reason)


@dataclass(frozen=True)
class SteelBeams(Model):
    """What the moments of steel beams depend on, checked."""

    of_arguments = True

    yield_rotation: Parameter = parameter("rad", "chord rotation at yielding", Range(upper=0.1))
    web_slenderness: Parameter = parameter("1", "depth over thickness of the web", within(20, 55))
    flange_slenderness: Parameter = parameter(
        "1", "half the width of the flange over its thickness", within(4, 8)
    )
    shear_span_ratio: Parameter = parameter("1", "shear span over depth", within(2.5, 7))
    depth: Parameter = parameter("m", "depth of the beam", within(0.1, 0.92))
    yield_strength: Parameter = parameter(
        "Pa", "yield strength of steel", within(240e6, 450e6, "in Pa, 355e6 for 355 MPa")
    )
    unbraced_slenderness: Parameter | None = parameter(
        "1", "unbraced length over radius of gyration", within(20, 80), None
    )
    exponent: Parameter = parameter("1", "Bouc-Wen exponent n", EXPONENT, 2.0)

    def law(self) -> dict[str, xr.DataArray]:
        """Hardening and decay; see `BoucWenBaberNoori.of_steel_beams`."""
        values, (plastic, energy) = self.arrays(), self.rotations()
        hardening = (CAP_OVER_YIELD - 1) * values["yield_rotation"] / plastic
        decay = (1 - hardening) * values["yield_rotation"] / energy
        return {
            "hardening": hardening,
            "stiffness_decay": decay,
            "strength_decay": values["exponent"] * decay,
        }

    def rotations(self) -> tuple[xr.DataArray, xr.DataArray]:
        """Plastic rotation up to the cap, and energy capacity over the yield moment [rad]."""
        values = self.arrays()
        web, flange = values["web_slenderness"], values["flange_slenderness"]
        span, deep = values["shear_span_ratio"], values["depth"] / 0.533
        strong, free = values["yield_strength"] / 355e6, values.get("unbraced_slenderness")
        if free is None:
            plastic = 0.0865 * web**-0.365 * flange**-0.14 * span**0.34 * deep**-0.721 * strong**-0.23
            return plastic, 495.0 * web**-1.34 * flange**-0.595 * strong**-0.36
        plastic = 0.19 * web**-0.314 * flange**-0.1 * span**0.113 * deep**-0.76 * strong**-0.07
        energy = 585.0 * web**-1.14 * flange**-0.632 * strong**-0.391
        return plastic * free**-0.185, energy * free**-0.205


def symbolic() -> Mapping[str, sympy.Expr]:
    """The rates of ``z`` and of the energy ``e``, in ``v``, both states and the parameters."""
    import sympy

    v, z, e, beta, n = sympy.symbols("v z e beta exponent", real=True)
    strength, stiffness = sympy.symbols("strength_decay stiffness_decay", real=True)
    most, rate, start = sympy.symbols("pinching pinching_rate pinching_start", real=True)
    width, spread, coupling = sympy.symbols(
        "pinching_width pinching_spread pinching_coupling", real=True
    )
    nu, eta = 1 + strength * e, 1 + stiffness * e
    slip = nu * abs(z) ** n * (beta * abs(v) * sympy.sign(z) + (1 - beta) * v)
    zeta = most * (1 - sympy.exp(-rate * e))
    apart = (z * sympy.sign(v) - start * nu ** (-1 / n)) / ((width + spread * e) * (coupling + zeta))
    return {"z": (1 - zeta * sympy.exp(-(apart**2))) / eta * (v - slip), "e": z * v}


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
        As in `Bilinear`; period and strength are those before any damage. The energy ``E`` [-] is over
        ``(1 - hardening)`` times the elastic stiffness times ``uy^2``.
    beta : float or array
        Width ``beta`` of the hysteresis loops [-], positive. With ``gamma = 1 - beta`` the strength is
        that of ``z = 1`` before any damage.
    exponent : float or array
        Exponent ``n`` [-], at least 1: the sharpness of yielding.
    strength_decay : float or array
        ``d_nu`` [-], not negative: the strength falls with ``(1 + d_nu E)^(-1/n)``.
    stiffness_decay : float or array
        ``d_eta`` [-], not negative: the stiffness falls with ``1/(1 + d_eta E)``.
    pinching : float or array
        ``zeta_s`` [-], at least 0 and below 1: the largest share of the stiffness that pinching takes.
        At 0 the loops are not pinched, and the other parameters of pinching have no effect.
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
        As in `Bilinear`. What needs a stationary response refuses the law: by an ArithmeticError what
        linearizes, by a ValueError what simulates.

    Notes
    -----
    A test to large drifts and back shows which parameters fit a building. Published ones differ from
    specimen to specimen; those of `of_steel_beams` were fitted to many. Between two opposite states the
    law can give back a little more work than it has taken, as the Bouc-Wen law can.

    References
    ----------
    Baber, T. T. and Wen, Y. K. (1981), J. Eng. Mech. Div. ASCE 107, 1069-1087; Baber, T. T. and Noori,
    M. N. (1986), J. Vib. Acoust. Stress Reliab. Des. 108, 411-420; Foliente, G. C. (1995), J. Struct.
    Eng. ASCE 121, 1013-1022, for the pinching.

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
    exponent: Parameter = parameter("1", "Bouc-Wen exponent n", EXPONENT, 1.0)
    strength_decay: Parameter = parameter("1", "strength decay d_nu", DECAYS, 0.0)
    stiffness_decay: Parameter = parameter("1", "stiffness decay d_eta", DECAYS, 0.0)
    pinching: Parameter = parameter("1", "share zeta_s of pinching", BELOW_1, 0.0)
    pinching_rate: Parameter = parameter("1", "rate p of pinching", POSITIVE, 1.0)
    pinching_start: Parameter = parameter("1", "place q of pinching", NOT_NEGATIVE, 0.15)
    pinching_width: Parameter = parameter("1", "width psi of pinching", POSITIVE, 0.2)
    pinching_spread: Parameter = parameter("1", "spread d_psi of pinching", NOT_NEGATIVE, 0.01)
    pinching_coupling: Parameter = parameter("1", "coupling lambda of pinching", POSITIVE, 0.4)

    @classmethod
    @takes_uncertain
    def of_steel_beams(
        cls,
        *,
        yield_rotation: Parameter,
        web_slenderness: Parameter,
        flange_slenderness: Parameter,
        shear_span_ratio: Parameter,
        depth: Parameter,
        yield_strength: Parameter,
        unbraced_slenderness: Parameter | None = None,
        exponent: Parameter = 2.0,
        **others: Any,
    ) -> Self:
        """A steel frame that yields in beams of I-sections, with hardening and decay of 300 tests.

        Parameters
        ----------
        yield_rotation : float or array
            Rotation of the chord of the beams at yielding [rad].
        web_slenderness : float or array
            Depth of the web over its thickness [-], 20 to 55.
        flange_slenderness : float or array
            Half the width of the flange over its thickness [-], 4 to 8.
        shear_span_ratio : float or array
            Distance from the plastic hinge to the point without moment, over the depth [-], 2.5 to 7.
        depth : float or array
            Depth of the beam [m], 0.1 to 0.92.
        yield_strength : float or array
            Yield strength of the steel [Pa], 240 to 450 MPa.
        unbraced_slenderness : float or array, optional
            Of beams with reduced sections: the unbraced length over the radius of gyration about the
            weak axis [-], 20 to 80. Without it the equations for other beams are taken.
        exponent : float or array
            Sharpness of yielding, of which the equations say nothing.
        **others
            ``period``, ``damping``, the yield displacement or reduction factor, and others as in
            `BoucWenBaberNoori`.

        Returns
        -------
        BoucWenBaberNoori
            With the equations' plastic rotation ``t_p`` up to the cap, at 1.1 times the yield moment,
            and their energy capacity ``L`` over the yield moment [rad], and the yield rotation ``t_y``:
            the hardening is ``0.1 t_y/t_p``. By the equations strength and stiffness in unloading fall
            as ``1 - E/E_t`` with the dissipated energy ``E``, to nothing at ``E_t = L/((1 - hardening)
            t_y)``. Here they begin to fall in the same way, with ``strength_decay = exponent/E_t`` and
            ``stiffness_decay = 1/E_t``, and more slowly later: where a half of the strength is left by
            the equations, 0.71 is left here.

        Raises
        ------
        ValueError, TypeError
            As in `BoucWenBaberNoori`, or if a property is out of range.

        Notes
        -----
        The law has no cap. Beyond a ductility of ``1 + t_p/t_y``, which is ``1 + 0.1/hardening``, the
        beams of the tests lose strength by buckling, and displacements by this law are too small.

        References
        ----------
        Lignos, D. G. and Krawinkler, H. (2011), J. Struct. Eng. ASCE 137, 1291-1302, the equations as
        open programs have them.

        Examples
        --------
        >>> import stochlin as sl
        >>> frame = sl.BoucWenBaberNoori.of_steel_beams(
        ...     yield_rotation=0.01, web_slenderness=45.0, flange_slenderness=6.5, shear_span_ratio=5.0,
        ...     depth=0.6, yield_strength=355e6, period=1.2, damping=0.02, yield_displacement=0.09,
        ... )
        >>> round(frame.hardening, 4), round(frame.strength_decay, 4), round(frame.stiffness_decay, 4)
        (0.038, 0.0194, 0.0097)
        """
        beams = SteelBeams(
            yield_rotation,
            web_slenderness,
            flange_slenderness,
            shear_span_ratio,
            depth,
            yield_strength,
            unbraced_slenderness,
            exponent,
        )
        return cls(exponent=exponent, **numbers_or_arrays(beams.law()) | others)
