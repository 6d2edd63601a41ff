"""Buildings by their modes, as programs of structural analysis print them."""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.messages import DoubtfulInput, brief, listed
from stochlin.models.arguments import Number
from stochlin.models.buildings.base import (
    FLOOR,
    GRAVITY,
    MODE,
    MOVES,
    STOREY,
    YIELDING_MODE,
    MultistoreyBuilding,
    numbered,
)
from stochlin.models.buildings.shear import SHEAR
from stochlin.models.parameters import ANY_NUMBER, PERIODS, POSITIVE, Parameter, parameter
from stochlin.models.plausible import PLAUSIBLE, implausible
from stochlin.models.structures import DAMPING_RATIO, HARDENING, Structure
from stochlin.models.uncertain import as_array, takes_uncertain

if TYPE_CHECKING:
    import sympy

ORTHOGONAL = 0.02  # largest modal mass that two modes share, over the root of those of both
LEAST_MASS = 1e-6  # share of the mass below which a mode does not move along the gap
ENOUGH_MASS = 0.9  # share of the mass that codes ask of the modes together
IN_ANOTHER_DIRECTION = 0.03  # share of the mass below which a mode may be one across the gap
# difference of two shares that are equal, but at the edge of a plan that turns
TOLERANCE_OF_SHARES = 0.25
SMALL_MOVE = 0.1  # part of the largest displacement of a mode below which its sign does not count
DIMENSIONS = {
    **dict.fromkeys(("periods", "damping", "participation", "modal_masses"), MODE),
    **dict.fromkeys(("hardening", "yield_displacements"), YIELDING_MODE),
    "masses": FLOOR,
    "heights": STOREY,
}
OF_WEIGHT = Number(SHEAR, f"a number; {SHEAR}")
STRENGTH_PARAMETERS = ("hardening", "yield_displacement")
TABLE_COLUMNS = {"period", "shape", "mass", "height"}


@dataclass(frozen=True)
class ModalBuilding(MultistoreyBuilding):
    """Building by its modes: each is an oscillator on the ground, and floors move by their shapes.

    The displacement ``D_n`` of mode ``n`` is that of an oscillator with its period and damping
    ratio. The floors move by the sum of ``G_n s_n D_n`` over the modes, with the participation
    factors ``G_n`` and the shapes ``s_n``. A contact or a link at a floor acts on each mode by the
    shape there. Only the motion along the gap is described; that across the gap is neglected. The
    building has the mass of the given modes only, so that modes that are left out make a floor
    harder to move by a contact.

    The first few modes may yield. They are oscillators with a hysteresis law, in the sense of modal
    pushover analysis: the yielding of one mode does not affect the others. The sum over the modes
    follows in time, so that no rule of combination is needed. This suits frames that yield over
    their whole height; a building with a soft storey needs a `ShearBuilding`.

    Parameters
    ----------
    periods : array
        Periods of the modes [s], longest first.
    shapes : array
        Displacement of each floor along the gap, for each mode (modes, floors), in any unit: floors
        from the ground up. For walls and irregular plans that of the edge that faces the neighbour.
    masses : array
        Masses of the floors [kg], one for each floor, positive.
    heights : array
        Height of each storey [m], positive. The level of a floor is the sum of the heights below
        it.
    damping : float or array
        Viscous damping ratio [-], in (0, 1): one number, or one for each mode.
    hardening : float or array, optional
        Hardening ratio of the modes that yield, post-yield over elastic stiffness [-], in (0, 1].
        It is required with ``yield_displacements``.
    yield_displacements : float or array, optional
        Displacement at yield ``D_y`` [m] of the oscillators of the first modes, positive: one
        number for mode 1, or one for each of the first few modes. From a pushover curve of mode
        ``n`` it is the roof displacement at yield over ``G_n s_n`` of the roof. The other modes
        stay elastic.
    participation : array, optional
        Participation factor of each mode for ground motion along the gap [-], in the unit of the
        shapes. By default it is computed from shapes and masses, ``G = s' m/(s' M s)``. This holds
        for floors that do not turn. For the corner of a building that turns, give the factors that
        the program prints, with ``modal_masses``.
    modal_masses : array, optional
        Effective modal masses along the gap [kg], given with ``participation``: the ratios of
        participating mass that the program prints, times the mass of the building.
    law : str, sympy.Expr or mapping
        Hysteresis law of the modes that yield, as in `ShearBuilding`.
    law_parameters : mapping, optional
        Parameters that the law adds, the same for all modes that yield.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number or out of range, arrays differ in length, periods do not fall
        from mode to mode, two shapes are not orthogonal with the masses (so that floors or masses
        are missing or the building turns), a mode does not move along the gap, the modes have more
        than the whole mass, participation is given without modal masses, or the law is not known.

    Warns
    -----
    DoubtfulInput
        If the modes have less than 90 % of the mass together; if the leading mode moves more at the
        lowest floor than at the roof; or for a value that no building has, as of a `ShearBuilding`.

    References
    ----------
    Chopra, A. K. (2012), Dynamics of Structures, 4th ed., sections 13.1 and 13.2; Chopra, A. K. and
    Goel, R. K. (2002), Earthquake Eng. Struct. Dyn. 31, for modes that yield.

    Examples
    --------
    >>> import stochlin as sl
    >>> tower = sl.ModalBuilding(
    ...     periods=[0.5, 0.18],
    ...     shapes=[[0.62, 1.0], [-1.61, 1.0]],
    ...     masses=[2e5, 2e5],
    ...     heights=[3.5, 3.5],
    ...     damping=0.05,
    ... )
    >>> tower.effective_masses().round(-2).tolist()
    [379100.0, 20700.0]
    >>> tower.first_mode_moves().round(3).values
    array([0.726, 1.17 ])
    """

    name: ClassVar[str] = "building by its modes"
    element: ClassVar[str] = MODE
    strength_name: ClassVar[str] = "yield_displacements"
    dimensions: ClassVar[Mapping[str, str]] = DIMENSIONS
    one_for_all: ClassVar[tuple[str, ...]] = ("damping", "hardening", "yield_displacements")

    periods: Parameter = parameter("s", "period of the mode", PERIODS)
    shapes: Parameter = parameter("1", "shape of the mode at the floor", ANY_NUMBER)
    masses: Parameter = parameter("kg", "mass of the floor", POSITIVE)
    heights: Parameter = parameter("m", "height of the storey", POSITIVE)
    damping: Parameter = parameter("1", "damping ratio of the mode", DAMPING_RATIO)
    hardening: Parameter | None = parameter("1", "hardening ratio of the mode", HARDENING, None)
    yield_displacements: Parameter | None = parameter("m", "yield displacement", POSITIVE, None)
    _: KW_ONLY
    participation: Parameter | None = parameter("1", "participation factor", ANY_NUMBER, None)
    modal_masses: Parameter | None = parameter("kg", "effective modal mass", POSITIVE, None)
    law: str | sympy.Expr | Mapping[str, sympy.Expr] = "bilinear"
    law_parameters: Mapping[str, Any] | None = None

    @classmethod
    def check_uncertain(cls, names: Collection[str]) -> None:
        """Raise a ValueError if the shapes or what follows from them are uncertain."""
        for name in {"shapes", "participation"}.intersection(names):
            raise ValueError(f"{cls.__name__}: {name} is uncertain; allowed: numbers")

    @classmethod
    @takes_uncertain
    def from_table(
        cls,
        table: xr.Dataset,
        *,
        damping: float,
        base_shear_coefficient: float | None = None,
        **others: Any,
    ) -> Self:
        """The building of a table of modes, as `read_modes` reads it.

        Participation factors and modal masses of the table are used if the shapes and the floor
        masses do not give them, as for the corner of a building that turns.

        Parameters
        ----------
        table : xarray.Dataset
            ``period`` [s], ``shape``, ``mass`` [kg] and storey ``height`` [m] over ``mode`` and
            ``floor``, and maybe ``participation`` and ``modal_mass`` [kg].
        damping : float or array
            As in `ModalBuilding`.
        base_shear_coefficient : float, optional
            Base shear at yield over the weight of all floors [-], positive, at most 100, in place
            of ``yield_displacements``. Mode 1 alone bears it: with its effective mass ``M_1`` and
            circular frequency ``w_1`` it yields at ``C g sum(m)/(M_1 w_1^2)``. The other modes stay
            elastic.
        **others
            ``hardening``, ``yield_displacements``, ``law`` and ``law_parameters``, as in
            `ModalBuilding`.

        Returns
        -------
        ModalBuilding
            The building.

        Raises
        ------
        ValueError, TypeError
            As in `ModalBuilding`, or if the table lacks a variable, or a base shear coefficient is
            given beside yield displacements, or where mode 1 has not the largest effective mass.

        Examples
        --------
        >>> import xarray as xr
        >>> import stochlin as sl
        >>> modes = xr.Dataset(
        ...     {"period": ("mode", [0.5]), "shape": (("mode", "floor"), [[0.6, 1.0]])}
        ... ).assign(mass=("floor", [2e5, 1e5]), height=("floor", [3.5, 3.5]))
        >>> sl.ModalBuilding.from_table(modes, damping=0.05).modes
        1
        """
        if not isinstance(table, xr.Dataset) or not {*table.data_vars} >= TABLE_COLUMNS:
            needed = listed(sorted(TABLE_COLUMNS))
            raise ValueError(f"table = {brief(table)}; allowed: a dataset with {needed}")
        shapes = _table("table: shape", table["shape"].transpose(MODE, FLOOR)).to_numpy()
        masses = table["mass"].to_numpy()
        if "modal_mass" in table and not _give(shapes, masses, table["modal_mass"].to_numpy()):
            others = {
                "participation": table["participation"].to_numpy(),
                "modal_masses": table["modal_mass"].to_numpy(),
            } | others
        periods = table["period"].to_numpy()
        heights = table["height"].to_numpy()
        values = periods, shapes, masses, heights, damping
        if base_shear_coefficient is None:
            return cls(*values, **others)
        OF_WEIGHT("base_shear_coefficient", base_shear_coefficient)
        if others.get("yield_displacements") is not None:
            what = f"base_shear_coefficient = {base_shear_coefficient:g} beside yield_displacements"
            raise ValueError(f"{what}; allowed: one of them")
        elastic = cls(*values, **others)
        stiffness = elastic.effective_masses()[0] * (2 * np.pi / periods[0]) ** 2
        return elastic.yielding_at(base_shear_coefficient * GRAVITY * masses.sum() / stiffness)

    def __post_init__(self) -> None:
        name = f"{type(self).__name__}: "
        object.__setattr__(self, "shapes", _table(f"{name}shapes", self.shapes))
        super().__post_init__()

    def _sizes(self) -> dict[str, tuple[int, str]]:
        assert isinstance(self.shapes, xr.DataArray)
        modes, floors = self.shapes.shape
        sizes = {
            MODE: (modes, "shapes"),
            FLOOR: (floors, "shapes"),
            STOREY: (floors, "shapes"),
        }
        if not self.yields:
            return sizes
        if (count := as_array(self.yield_displacements).size) > modes:
            what = f"{type(self).__name__}: yield_displacements has {count} values"
            raise ValueError(f"{what}; allowed: one for each of at most {modes} modes")
        return sizes | {YIELDING_MODE: (count, "yield_displacements")}

    def _check(self, name: str) -> None:
        periods = self._numbers("periods")
        longer = np.diff(periods) > 0
        if longer.any():
            n = int(np.argmax(longer))
            what = f"{name}periods of modes {n + 1} and {n + 2} are {periods[n]:g} and"
            raise ValueError(f"{what} {periods[n + 1]:g} s; allowed: the longest first, in seconds")
        if (self.participation is None) != (self.modal_masses is None):
            raise ValueError(
                f"{name}participation or modal_masses alone; allowed: both, or neither"
            )
        if self.participation is None:
            self._check_orthogonal(name)
        self._check_masses(name)

    @property
    def modes(self) -> int:
        """Number of modes."""
        return int(self.arrays()["periods"].size)

    @cached_property
    def element_law(self) -> Structure:
        """Oscillators that have the hysteresis law of the modes, over the dimension ``mode``.

        Modes that stay elastic have the strength of the last one that yields, which has no use.
        """
        values = self.arrays()
        strength: dict[str, Any] = {}
        if self.yields:
            left = self.modes - self._strengths.shape[1]
            whole = np.pad(self._strengths, ((0, 0), (0, left)), mode="edge")
            rows = (xr.DataArray(row, dims=MODE) for row in whole)
            strength = dict(zip(STRENGTH_PARAMETERS, rows, strict=True))
        return self._law(period=values["periods"], damping=self.damping, **strength)

    def system(self) -> System:
        """The building as coordinates, elements, floors: each mode is a coordinate and element."""
        mass = self.effective_masses()
        w = 2 * np.pi / self._numbers("periods")
        k = mass * w**2
        hardening = np.ones(w.size)
        strength = np.full(w.size, np.inf)
        weak = slice(self._strengths.shape[1])
        hardening[weak], strength[weak] = self._strengths
        return System(
            mass=mass,
            damping=np.diag(2 * self._numbers("damping") * w * mass),
            extensions=np.eye(self.modes),
            shapes=self.moves(),
            post=hardening * k,
            couple=(1 - hardening) * k,
            strength=strength,
        )

    def shear_shares(self) -> Array:
        """Share of each mode's force in each storey shear, by its static forces (storeys, modes).

        Where the participation factors are given, only the shear of the lowest storey is known,
        which is the sum of the forces of the modes; the shears above are NaN.
        """
        if self.modal_masses is not None:
            shares = np.full((self.storeys, self.modes), np.nan)
            shares[0] = 1.0
            return shares
        forces = self._numbers("masses")[:, None] * self.moves()
        above: Array = forces[::-1].cumsum(axis=0)[::-1]
        return above / self.effective_masses()

    @property
    def leading(self) -> int:
        """Number of the mode with the largest effective mass, from 0."""
        return int(np.argmax(self.effective_masses()))

    def effective_masses(self) -> Array:
        """Effective modal mass of each mode along the gap [kg], (modes,)."""
        if self.modal_masses is not None:
            return self._numbers("modal_masses")
        return effective_masses_of(self._numbers("shapes"), self._numbers("masses"))

    def factors(self) -> Array:
        """Participation factor of each mode for ground motion along the gap [-], (modes,)."""
        if self.participation is not None:
            return self._numbers("participation")
        shapes = self._numbers("shapes")
        masses = self._numbers("masses")
        computed: Array = (shapes @ masses) / (shapes**2 @ masses)
        return computed

    def moves(self) -> Array:
        """Displacement of each floor over that of each mode's oscillator [-] (floors, modes)."""
        return (self._numbers("shapes") * self.factors()[:, None]).T

    def mode_periods(self) -> xr.DataArray:
        """Periods of the elastic building [s] over ``mode``, which is counted from 1."""
        return numbered(self._numbers("periods"), MODE, "s", "period of the mode")

    def first_mode_moves(self) -> xr.DataArray:
        """Displacement of each floor over that of `oscillator` [-], over ``floor``."""
        return numbered(self.moves()[:, self.leading], FLOOR, *MOVES)

    def doubts(self) -> Iterator[str]:
        """Texts on what follows from the parameters and is implausible, also of those of a file."""
        of_table = {name: self._numbers(name) for name in ("masses", "heights")}
        yield from implausible(of_table, self.limits(), of_one=True)
        yield from super().doubts()
        shapes = self._numbers("shapes")
        yield from doubt_of_shape(shapes[self.leading])
        shares = self.effective_masses() / self._numbers("masses").sum()
        yield from doubt_of_modes(self._numbers("periods"), shapes, shares)
        yield from self.oscillator().doubts()
        masses = self._numbers("masses")
        moved = float(masses @ self.moves().sum(axis=1) / masses.sum())
        if abs(moved - shares.sum()) > TOLERANCE_OF_SHARES:
            what = f"all modes together move its floors by {moved:.3g} of the ground, in the mean"
            share = f"their effective masses are {shares.sum():.3g} of the mass"
            yield f"{what}, and {share}; do participation factors and shapes belong together?"

    def oscillator(self) -> Structure:
        """The mode with the largest effective mass [kg] as an oscillator.

        The displacement of a floor is `first_mode_moves` times that of the oscillator. All other
        modes are neglected.

        Examples
        --------
        >>> import stochlin as sl
        >>> tower = sl.ModalBuilding([0.5], [[0.6, 1.0]], [2e5, 1e5], [3.5, 3.5], 0.05)
        >>> tower.oscillator().period
        0.5
        """
        n = self.leading
        stays_elastic = self.yields and n >= self._strengths.shape[1]
        elastic = dict.fromkeys(STRENGTH_PARAMETERS) if stays_elastic else {}
        return self._as_oscillator(n, mass=float(self.effective_masses()[n]), **elastic)

    def yielding_at(self, displacement: float) -> Self:
        """The building whose mode 1 alone yields, at this displacement [m] of its oscillator.

        Raises a ValueError if another mode has a larger effective mass.
        """
        self._check_leading(
            "a strength of the whole building", "; yield_displacements give that of each mode"
        )
        return replace(self, yield_displacements=[float(displacement)])

    def _check_leading(self, strength: str, cure: str = "") -> None:
        if self.leading:
            what = (
                f"{type(self).__name__}: mode {self.leading + 1} "
                "has more effective mass than mode 1"
            )
            raise ValueError(f"{what}; allowed with {strength}: the most in mode 1{cure}")

    def _of_first_mode(self, period: float, yield_displacement: float, hardening: float) -> Self:
        self._check_leading("a pushover curve")
        periods = [period, *self._numbers("periods")[1:]]
        of_modes, strengths_of_modes = self._strengths
        hardenings = [hardening, *of_modes[1:]]
        strengths = [yield_displacement, *strengths_of_modes[1:]]
        return replace(self, periods=periods, hardening=hardenings, yield_displacements=strengths)

    @property
    def _strengths(self) -> Array:
        """Hardening [-] and yield displacement [m] of modes that yield, the first ones (2, n)."""
        both = (np.asarray(v, float) for v in (self.hardening, self.yield_displacements))
        wide = np.array(np.broadcast_arrays(*both, np.empty(1)))[:2]
        return wide if self.yields else np.empty((2, 0))

    def _check_orthogonal(self, name: str) -> None:
        shapes = self._numbers("shapes")
        without_motion = np.flatnonzero(~shapes.any(axis=1))
        if without_motion.size:
            what = f"{name}shapes of mode {without_motion[0] + 1} are all 0"
            raise ValueError(f"{what}; allowed: a mode that moves")
        shared = _shared(shapes, self._numbers("masses"))
        if shared.max() > ORTHOGONAL:
            i, j = np.sort(np.unravel_index(np.argmax(shared), shared.shape)) + 1
            what = (
                f"{name}shapes of modes {i} and {j} are not orthogonal: "
                f"{shared.max():.2g} is shared"
            )
            order = (
                "are masses right, and floors in order, from the ground up, in a row for each mode"
            )
            cure = f"{order}, or are participation and modal_masses missing?"
            raise ValueError(f"{what}; allowed: up to {ORTHOGONAL:g}; {cure}")

    def _check_masses(self, name: str) -> None:
        shares = self.effective_masses() / self._numbers("masses").sum()
        unmoved = (shares < LEAST_MASS) | (self.factors() == 0)
        total = shares.sum()
        if unmoved.any():
            what = f"{name}mode {listed(np.flatnonzero(unmoved) + 1)} does not move along the gap"
            raise ValueError(f"{what}; allowed: modes with {LEAST_MASS:g} of the mass or more")
        if total > 1 + ORTHOGONAL:
            what = f"{name}modal_masses are {total:.3g} of the masses"
            raise ValueError(f"{what}; allowed: at most 1, in kg and along the gap")
        if total < ENOUGH_MASS:
            what = f"{name}the modes have {total:.1%} of the mass; {1 - total:.1%} is left out"
            limit = f"more than the {1 - ENOUGH_MASS:.0%} that codes allow"
            warnings.warn(f"{what}, {limit}: give more modes", DoubtfulInput, stacklevel=4)


def _table(label: str, value: Any) -> xr.DataArray:
    """Mode shapes over modes and floors; a ValueError for anything but a table of numbers."""
    array = as_array(value)
    if array.ndim != 2 or not array.size or array.dtype.kind not in "iuf":
        raise ValueError(f"{label} = {brief(value)}; allowed: a number for each mode and floor")
    return xr.DataArray(array, dims=(MODE, FLOOR))


def effective_masses_of(shapes: Array, masses: Array) -> Array:
    """Effective modal masses [kg] of shapes (modes, floors) that describe the whole motion."""
    effective: Array = (shapes @ masses) ** 2 / (shapes**2 @ masses)
    return effective


def doubt_of_shape(leading: Array) -> Iterator[str]:
    """Text on the shape of the leading mode, if it moves most below, as with floors upside down."""
    lowest = abs(leading[0])
    roof = abs(leading[-1])
    ratio = lowest / roof if roof > 0 else np.inf
    if text := PLAUSIBLE["mode downwards"].doubt(ratio):
        yield (
            f"the leading mode moves {lowest:g} at the lowest floor "
            f"and {roof:g} at the roof; {text}"
        )


def doubt_of_modes(periods: Array, shapes: Array, shares: Array) -> Iterator[str]:
    """Doubt about a mode with a node that is slower than the mode with most effective mass.

    Modes in other directions, which have little of the mass along the gap, are left out.
    """
    longest = periods[np.argmax(shares)]
    for n in np.flatnonzero((periods > longest) & (shares > IN_ANOTHER_DIRECTION)):
        large = shapes[n][np.abs(shapes[n]) > SMALL_MOVE * np.abs(shapes[n]).max()]
        if large.min() < 0 < large.max():
            what = f"mode {n + 1} has a node and a longer period than mode {np.argmax(shares) + 1}"
            yield f"{what}, which has more effective mass; are their shapes exchanged?"


def _give(shapes: Array, masses: Array, modal_masses: Array) -> bool:
    """Whether shapes are orthogonal with the masses, and have these effective modal masses [kg]."""
    if (_shared(shapes, masses) > ORTHOGONAL).any():
        return False
    effective = effective_masses_of(shapes, masses)
    return bool((np.abs(effective - modal_masses) <= ORTHOGONAL * masses.sum()).all())


def _shared(shapes: Array, masses: Array) -> Array:
    """Modal mass that two modes share, over the root of those of both [-] (modes, modes)."""
    modal = (shapes * masses) @ shapes.T
    root = np.sqrt(np.diag(modal))
    shared: Array = np.abs(modal / np.outer(root, root)) - np.eye(root.size)
    return shared
