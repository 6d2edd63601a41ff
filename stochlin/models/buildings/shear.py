"""Shear buildings: rigid floors with masses, and storeys that may yield."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import scipy.linalg
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.messages import brief
from stochlin.models.arguments import Whole, check_truth
from stochlin.models.buildings.base import (
    FLOOR,
    GRAVITY,
    MODE,
    MOST_STOREYS,
    MOVES,
    STOREY,
    MultistoreyBuilding,
    check_ranges,
    doubt_of_order,
    numbered,
)
from stochlin.models.parameters import (
    NOT_NEGATIVE,
    PERIODS,
    POSITIVE,
    Model,
    Parameter,
    Range,
    parameter,
)
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.structures import DAMPING_RATIO, HARDENING, Structure, doubt_of_strength
from stochlin.models.uncertain import takes_uncertain

if TYPE_CHECKING:
    import sympy

STOREY_PARAMETERS = ("masses", "stiffnesses", "heights", "yield_drifts", "dampers")
NUMBER_OF_STOREYS = Whole(1, MOST_STOREYS)
SHEAR = Range(upper=100.0, include_upper=True, reason="of the weight; a stronger one is elastic")


@dataclass(frozen=True)
class RegularBuilding(Model):
    """The numerical arguments of `ShearBuilding.regular`, checked."""

    of_arguments = True

    period: float = parameter("s", "period of the first mode", PERIODS, scalar=True)
    storey_height: Parameter = parameter("m", "height of each storey", POSITIVE)
    mass: float = parameter("kg", "mass of each floor", POSITIVE, scalar=True)
    base_shear_coefficient: float | None = parameter(
        "1", "base shear at yield relative to the weight", SHEAR, None, scalar=True
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        check_ranges(self, "")


@dataclass(frozen=True)
class ShearBuilding(MultistoreyBuilding):
    """Shear building: a mass on each floor, a hysteretic spring in each storey and viscous damping.

    Storeys are counted from the ground up; each storey has the number of the floor above it. Every
    mode of the elastic building has the same damping ratio ``xi``: ``C = sum_m 2 xi w_m M phi_m
    phi_m' M``, with modes ``phi_m`` of unit modal mass. With ``damping_modes`` two modes ``i`` and
    ``j`` have it, by Rayleigh damping: ``C = a0 M + a1 K`` with ``a0 = 2 xi w_i w_j/(w_i + w_j)``,
    ``a1 = 2 xi/(w_i + w_j)`` and the elastic stiffness ``K``. Neither damping matrix changes when
    storeys yield.

    Parameters
    ----------
    masses : array
        Masses of the floors [kg], one for each storey, positive.
    stiffnesses : array
        Elastic stiffness of each storey [N/m], positive.
    heights : array
        Height of each storey [m], positive. The level of a floor is the sum of the heights below
        it.
    damping : float
        Viscous damping ratio [-], in (0, 1), of every mode, or of two with Rayleigh damping.
    hardening : float, optional
        Hardening ratio of every storey, post-yield over elastic stiffness [-], in (0, 1]. It is
        required with ``yield_drifts``.
    yield_drifts : float or array, optional
        Drift at which a storey yields [m], positive: one number for all storeys, or one for each.
        Without it the building stays elastic.
    dampers : float or array, optional
        Damping constant of the dampers in a storey [N s/m], not negative: one number for all
        storeys, or one for each.
    law : str, sympy.Expr or mapping
        Hysteresis law of the storeys: ``"bilinear"``, ``"bouc_wen"`` or another registered law, or
        a sympy expression or a mapping of rates by state, as in `Hysteretic`. Its ``v`` is the rate
        of the drift over the yield drift.
    law_parameters : mapping, optional
        Parameters that the law adds, for instance ``{"beta": 0.5, "gamma": 0.5}``.
    p_delta : bool
        Whether the stiffness of each storey is reduced by the weight above it over its height. The
        modes and their damping then include this reduction.
    damping_modes : tuple of int, optional
        The two modes with the damping ratio ``damping``, by Rayleigh damping, for instance ``(1,
        3)``. Modes between them have a lower ratio, all others a higher one; see `damping_ratios`.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range (the message names the storey), arrays differ in
        length or have more than 200 storeys, yield drifts are given without hardening, the law is
        not known or not odd, the weight above a storey takes all its elastic stiffness, or the
        modes of Rayleigh damping are not two different ones of the building, or leave mode 1 no
        vibration.

    Warns
    -----
    ImplausibleInput
        If no building has a value; if the first period does not fit the height; or if storeys grow
        stiffer or floors heavier from each one to the next, as if listed from the roof down.

    References
    ----------
    Chopra, A. K. (2012), Dynamics of Structures, 4th ed., sections 9.1 and 11.4; Wilson, E. L. and
    Habibullah, A. (1987), Earthquake Spectra 3, for the geometric stiffness of the weight.

    Examples
    --------
    >>> import stochlin as sl
    >>> tower = sl.ShearBuilding([2e5] * 3, [4e8] * 3, [3.5] * 3, damping=0.05)
    >>> tower.periods().round(3).values
    array([0.316, 0.113, 0.078])
    >>> tower.levels().tolist()
    [3.5, 7.0, 10.5]
    """

    name: ClassVar[str] = "shear building"
    element: ClassVar[str] = STOREY
    strength_name: ClassVar[str] = "yield_drifts"
    dimensions: ClassVar[Mapping[str, str]] = dict.fromkeys(STOREY_PARAMETERS, STOREY)
    one_for_all: ClassVar[tuple[str, ...]] = ("yield_drifts", "dampers")

    masses: Parameter = parameter("kg", "mass of the floor", POSITIVE)
    stiffnesses: Parameter = parameter("N/m", "stiffness of the storey", POSITIVE)
    heights: Parameter = parameter("m", "height of the storey", POSITIVE)
    damping: float = parameter("1", "damping ratio", DAMPING_RATIO, scalar=True)
    hardening: float | None = parameter("1", "hardening ratio", HARDENING, None, scalar=True)
    yield_drifts: Parameter | None = parameter("m", "drift at yield", POSITIVE, None)
    _: KW_ONLY
    dampers: Parameter | None = parameter(
        "N s/m", "damping constant of the storey", NOT_NEGATIVE, None
    )
    law: str | sympy.Expr | Mapping[str, sympy.Expr] = "bilinear"
    law_parameters: Mapping[str, Any] | None = None
    p_delta: bool = False
    damping_modes: tuple[int, int] | None = None

    def _check(self, name: str) -> None:
        check_truth(f"{name}p_delta", self.p_delta)
        self._check_weight()
        if self.damping_modes is not None:
            self._check_damping_modes()

    @classmethod
    @takes_uncertain
    def regular(
        cls,
        *,
        period: float,
        storeys: int,
        storey_height: Any,
        mass: float,
        damping: float,
        hardening: float | None = None,
        base_shear_coefficient: float | None = None,
        **others: Any,
    ) -> Self:
        """A building with equal floor masses, from its period, height and base shear coefficient.

        The stiffnesses are chosen such that the first mode is a straight line from the ground to
        the roof. The strengths are chosen such that all storeys yield at once under lateral forces
        that grow in proportion to the height; the yield drift is then the same share of the height
        in every storey.

        Parameters
        ----------
        period : float
            Period of the first mode [s], without the P-delta effect.
        storeys : int
            Number of storeys, 1 to 200.
        storey_height : float or array
            Height of every storey [m], or a list with the height of each, from the ground up.
        mass : float
            Mass of each floor [kg].
        damping, hardening
            As in `ShearBuilding`.
        base_shear_coefficient : float, optional
            Base shear at yield over the weight [-], positive, at most 100. Without it the building
            stays elastic. A value above 1 gives a warning.
        **others
            ``dampers``, ``law``, ``law_parameters``, ``p_delta`` and ``damping_modes``, as in
            `ShearBuilding`.

        Returns
        -------
        ShearBuilding
            For ``n`` floors of mass ``m`` at the levels ``H_i``, storey heights ``h_i``, ``w = 2
            pi/period`` and the base shear coefficient ``C``: stiffnesses ``m w^2 sum(H_j, j =
            i..n)/h_i`` and yield drifts ``C g n h_i/(w^2 sum(H))``, which for equal storeys is ``2
            C g/(w^2 (n + 1))``.

        Raises
        ------
        ValueError, TypeError
            As in `ShearBuilding`, or if the number of storeys is not a whole number from 1 to 200.

        Examples
        --------
        >>> import stochlin as sl
        >>> office = sl.ShearBuilding.regular(
        ...     period=0.8, storeys=8, storey_height=3.2, mass=4e5, damping=0.05, hardening=0.05,
        ...     base_shear_coefficient=0.15,
        ... )
        >>> round(float(office.periods()[0]), 12)
        0.8
        """
        regular = RegularBuilding(period, storey_height, mass, base_shear_coefficient)
        NUMBER_OF_STOREYS("storeys", storeys)
        values = {name: np.asarray(value) for name, value in regular.cells().items()}
        heights = values["storey_height"]
        if heights.ndim and heights.shape != (storeys,):
            raise ValueError(f"storey_height has {heights.size} values; allowed: one, or {storeys}")
        relative = heights / heights.flat[0]
        levels = np.cumsum(np.broadcast_to(relative, storeys))
        above = levels[::-1].cumsum()[::-1]
        with np.errstate(all="ignore"):  # an overflow is found by the checks of the building
            square = (2 * np.pi / values["period"]) ** 2
            stiffnesses = values["mass"] * square * above / relative
            at_weight = relative * GRAVITY * storeys / (square * levels.sum())
        drifts = None
        if base_shear_coefficient is not None:
            drifts = values["base_shear_coefficient"] * at_weight
        return cls(
            np.full(storeys, values["mass"]),
            stiffnesses,
            np.broadcast_to(heights, storeys),
            damping,
            hardening,
            drifts,
            **others,
        )

    @cached_property
    def element_law(self) -> Structure:
        """Oscillators that have the hysteresis law of the storeys, over the dimension ``storey``.

        They provide the closures, the time steps and the parameters of the law. Their periods are
        those of each floor alone on its own storey.
        """
        periods = 2 * np.pi * np.sqrt(self._numbers("masses") / self._numbers("stiffnesses"))
        periods = np.clip(periods, PERIODS.lower, PERIODS.upper)  # beyond, the modes are refused
        strength: dict[str, Any] = {}
        if self.yields:
            drifts = xr.DataArray(self._numbers("yield_drifts"), dims=STOREY)
            strength = {"hardening": self.hardening, "yield_displacement": drifts}
        return self._law(
            period=xr.DataArray(periods, dims=STOREY), damping=self.damping, **strength
        )

    def system(self) -> System:
        """The building as a chain: coordinates are the displacements of the floors."""
        n = self.storeys
        k = self._numbers("stiffnesses")
        hardening = float(self.cells()["hardening"]) if self.yields else 1.0
        return System(
            mass=self._numbers("masses"),
            damping=self.damping_matrix(),
            extensions=np.eye(n) - np.eye(n, k=-1),
            shapes=np.eye(n),
            post=hardening * k - self.geometric_stiffness(),
            couple=(1 - hardening) * k,
            strength=self._numbers("yield_drifts", np.inf),
        )

    def shear_shares(self) -> Array:
        """The identity: the force of a storey is its shear (storeys, storeys)."""
        return np.eye(self.storeys)

    def _of_first_mode(self, period: float, yield_displacement: float, hardening: float) -> Self:
        if self.p_delta:
            what = f"{type(self).__name__}: p_delta = True"
            raise ValueError(
                f"{what}; allowed: False with a pushover curve, which contains its effect"
            )
        drifts = yield_displacement * np.diff(self.participation(), prepend=0.0)
        stiffer = self._numbers("stiffnesses") * (float(self.periods()[0]) / period) ** 2
        return replace(self, stiffnesses=stiffer, hardening=hardening, yield_drifts=drifts)

    def periods(self) -> xr.DataArray:
        """Periods of the elastic building [s] over ``mode``, counted from 1, longest first."""
        return numbered(2 * np.pi / self._modes()[0], MODE, "s", "period of the mode")

    def participation(self) -> xr.DataArray:
        """Displacement of each floor in mode 1 over that of `oscillator` [-], over ``floor``.

        It is the participation factor ``phi' M 1/(phi' M phi)`` times the mode shape ``phi``.
        """
        mass = self._numbers("masses")
        shape = self._modes()[1][:, 0]
        return numbered((mass @ shape) * shape, FLOOR, *MOVES)

    mode_periods = periods  # names that all buildings have
    first_mode_moves = participation

    def oscillator(self) -> Structure:
        """The first mode as an oscillator, with its effective modal mass [kg].

        The oscillator has the damping ratio of this mode, and the hysteresis law of the storeys.
        Its yield displacement is that at which the first storey yields in this mode. The
        displacement of a floor is `participation` times that of the oscillator. Higher modes and
        the concentration of yielding in one storey are neglected.

        References
        ----------
        Chopra, A. K. (2012), Dynamics of Structures, 4th ed., section 13.2.

        Examples
        --------
        >>> import stochlin as sl
        >>> tower = sl.ShearBuilding([2e5] * 3, [4e8] * 3, [3.5] * 3, 0.05, 0.1, yield_drifts=0.01)
        >>> first = tower.oscillator()
        >>> round(first.period, 3), round(first.yield_displacement, 4), round(first.mass / 6e5, 3)
        (0.316, 0.0184, 0.914)
        """
        mass = self._numbers("masses")
        shape = self._modes()[1][:, 0]
        moves = self.participation().to_numpy()
        weakest = 0
        strength = dict[str, float]()
        if self.yields:
            at_yield = self._numbers("yield_drifts") / np.abs(np.diff(moves, prepend=0.0))
            weakest = int(np.argmin(at_yield))
            strength["yield_displacement"] = float(at_yield[weakest])
        return self._as_oscillator(
            weakest,
            period=float(self.periods()[0]),
            damping=float(self.damping_ratios()[0]),
            mass=float((mass @ shape) ** 2),
            **strength,
        )

    def doubts(self) -> Iterator[str]:
        """Texts on what follows from the parameters and is implausible."""
        yield from super().doubts()
        yield from self._doubts_of_stiffness()
        yield from self._doubts_of_strength()
        added = self._numbers("dampers", 0.0) / self._critical_damping()
        if text := PLAUSIBLE["damper over critical"].doubt(added.max()):
            strongest = f"the damper of storey {int(np.argmax(added)) + 1}"
            yield f"{strongest} is {added.max():.3g} times 2 sqrt(k m) of the storey; {text}"

    def _doubts_of_stiffness(self) -> Iterator[str]:
        """Texts on storeys whose stiffness does not fit that of the others."""
        stiffnesses = self._numbers("stiffnesses")
        if self.storeys > 2:  # the first storey may be a soft one
            yield from doubt_of_order("stiffness", stiffnesses, stiffnesses[1])
        inner = stiffnesses[1:-1] / np.minimum(stiffnesses[:-2], stiffnesses[2:])
        if text := PLAUSIBLE["stiffness over its neighbours"].doubt(inner.min(initial=1.0)):
            softest = f"storey {int(np.argmin(inner)) + 2} has {inner.min():.2g} of the stiffness"
            yield f"{softest} of those above and below; {text}"

    def _doubts_of_strength(self) -> Iterator[str]:
        """Texts on yield drifts, and on the strength that follows from them."""
        heights = self._numbers("heights")
        drifts = self._numbers("yield_drifts", 0.0)
        ratios = drifts / heights
        worst = int(np.argmax(ratios))
        drift = drifts[worst]
        height = heights[worst]
        text = PLAUSIBLE["yield drift"].doubt(ratios[worst])
        if text and PLAUSIBLE["heights"].holds(height):
            share = f"{drift:.3g} m, {ratios[worst]:.2g} of its height"
            yield f"storey {worst + 1}, {height:g} m high, yields at {share}; {text}"
        elif self.yields and (text := doubt_of_strength(self._least_strength())):
            yield f"the weakest storey yields under {text}"
        growth = ratios[1:] / ratios[:-1] if self.yields else np.zeros(0)
        if text := PLAUSIBLE["yield drift upwards"].doubt(growth.max(initial=0.0)):
            above = int(np.argmax(growth)) + 2
            yield f"storey {above} yields at {growth.max():.3g} times the drift ratio below; {text}"

    def _critical_damping(self) -> Array:
        """Critical damping of each storey with its own mass [N s/m], (storeys,)."""
        critical: Array = 2 * np.sqrt(self._numbers("stiffnesses") * self._numbers("masses"))
        return critical

    def _least_strength(self) -> float:
        """The least force at yield of a storey over the mass above it [m/s^2]."""
        above = self._numbers("masses")[::-1].cumsum()[::-1]
        return float(
            (self._numbers("stiffnesses") * self._numbers("yield_drifts", 0.0) / above).min()
        )

    def geometric_stiffness(self) -> Array:
        """Reduction of the stiffness of each storey by the P-delta effect [N/m], (storeys,).

        It is the weight above the storey over its height, and zero without ``p_delta``.
        """
        if not self.p_delta:
            return np.zeros(self.storeys)
        above = self._numbers("masses")[::-1].cumsum()[::-1]
        return GRAVITY * above / self._numbers("heights")

    def damping_ratios(self) -> xr.DataArray:
        """Damping ratio of every mode of the elastic building [-] over ``mode``, without dampers.

        Of Rayleigh damping it is ``a0/(2 w) + a1 w/2`` in the mode of the circular frequency ``w``.

        Examples
        --------
        >>> import stochlin as sl
        >>> tower = sl.ShearBuilding(
        ...     [2e5] * 3, [4e8] * 3, [3.5] * 3, 0.05, damping_modes=(1, 2)
        ... )
        >>> tower.damping_ratios().round(4).values
        array([0.05  , 0.05  , 0.0623])
        """
        ratios = self._ratios(self._modes()[0])
        return numbered(ratios, MODE, "1", "damping ratio of the mode")

    def _ratios(self, frequencies: Array) -> Array:
        """Damping ratios (n,) of all modes, which have these circular frequencies [rad/s]."""
        ratio = float(self.cells()["damping"])
        if self.damping_modes is None:
            return np.full(frequencies.size, ratio)
        first = frequencies[self.damping_modes[0] - 1]
        second = frequencies[self.damping_modes[1] - 1]
        shares: Array = (first * second / frequencies + frequencies) / (first + second)
        return ratio * shares

    def damping_matrix(self) -> Array:
        """Damping matrix of the floors [N s/m], (storeys, storeys)."""
        w, shapes = self._modes()
        modal = self._numbers("masses")[:, None] * shapes
        drifts = np.eye(w.size) - np.eye(w.size, k=-1)
        by_modes = (modal * (2 * self._ratios(w) * w)) @ modal.T
        return by_modes + (drifts.T * self._numbers("dampers", 0.0)) @ drifts

    def further(self) -> list[str]:
        """The law, and what changes the stiffness and the damping."""
        parts = [*super().further(), "P-delta" if self.p_delta else ""]
        modes = self.damping_modes
        parts += [f"damping of modes {modes[0]} and {modes[1]}" if modes else ""]
        return [part for part in parts if part]

    def _numbers(self, name: str, otherwise: float = np.nan) -> Array:
        """A parameter of the storeys as an array (storeys,); another number if it is not set."""
        return np.full(self.storeys, self.cells().get(name, otherwise), float)

    def _check_weight(self) -> None:
        stiffness = self._numbers("stiffnesses")
        taken = self.geometric_stiffness()
        if self.p_delta and (stiffness <= taken).any():
            worst = int(np.argmin(stiffness - taken))
            what = (
                f"ShearBuilding: the weight above takes {taken[worst]:g} N/m "
                f"from storey {worst + 1}"
            )
            raise ValueError(
                f"{what}; allowed: less than {stiffness[worst]:g} N/m, or p_delta=False"
            )

    def _check_damping_modes(self) -> None:
        modes = self.damping_modes
        allowed = Whole(1, self.storeys)
        pair = tuple(modes) if isinstance(modes, (tuple, list)) else ()
        if len(pair) != 2 or not all(map(allowed.contains, pair)) or pair[0] == pair[1]:
            what = f"{type(self).__name__}: damping_modes = {brief(modes)}"
            raise ValueError(f"{what}; allowed: two different modes, each {allowed}")
        object.__setattr__(self, "damping_modes", pair)
        if (first := float(self.damping_ratios()[0])) >= 1:
            what = (
                f"ShearBuilding: damping_modes = {pair} give mode 1 the damping ratio {first:.3g}"
            )
            raise ValueError(f"{what}; allowed: below 1")

    def _modes(self) -> tuple[Array, Array]:
        """Circular frequencies [rad/s] of modes, and mode shapes of unit modal mass as columns."""
        root = np.sqrt(self._numbers("masses"))
        k = self._numbers("stiffnesses") - self.geometric_stiffness()
        with np.errstate(all="ignore"):
            diagonal = (k + np.append(k[1:], 0.0)) / root**2
            beside = -k[1:] / (root[:-1] * root[1:])
        if not (np.isfinite(diagonal).all() and np.isfinite(beside).all()):
            raise ValueError(
                "ShearBuilding: stiffnesses over masses are infinite; allowed: N/m and kg"
            )
        squares, vectors = scipy.linalg.eigh_tridiagonal(diagonal, beside)
        return np.sqrt(squares), vectors / root[:, None]
