"""What buildings have in common that analyses take: floors, modes, and one law for all elements."""

from __future__ import annotations

import warnings
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
import scipy.constants
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.messages import DoubtfulInput, brief
from stochlin.models.arguments import is_number
from stochlin.models.laws.hysteretic import Hysteretic, law_of
from stochlin.models.parameters import Model, check_units
from stochlin.models.plausible import PLAUSIBLE, doubts_of_size
from stochlin.models.states import in_words
from stochlin.models.structures import HARDENING, AnyStructure, Structure
from stochlin.models.uncertain import WithoutCells, as_array
from stochlin.models.values import CASE

if TYPE_CHECKING:
    import sympy

STOREY = "storey"
MODE = "mode"
FLOOR = "floor"
YIELDING_MODE = "yielding mode"
MOVES = "1", "displacement of the floor over that of the oscillator"
MOST_STOREYS = 200
MOST_BY_DIMENSION = {STOREY: MOST_STOREYS, FLOOR: MOST_STOREYS}
# as a rigid floor has three motions
MOST_BY_DIMENSION |= dict.fromkeys((MODE, YIELDING_MODE), 3 * MOST_STOREYS)
PERIOD_OFF = 0.1  # of the first period, by which a pushover curve may differ
GRAVITY = scipy.constants.g


class MultistoreyBuilding(WithoutCells, AnyStructure, base=True):
    """Base of the buildings with floors: `ShearBuilding` and `ModalBuilding`.

    The elements of a building have one hysteresis law: they are its storeys, or its modes. Its
    arrays are over these.
    """

    instead = "use linearize_system, simulate or pound, or give the building's oscillator()"
    number_of = " for the whole building"
    has_storeys = True
    by_reduction_factor = False
    has_mass = True
    element: ClassVar[str]  # the dimension of the elements, which are storeys or modes
    dimensions: ClassVar[Mapping[str, str]]  # of the parameters that are lists
    one_for_all: ClassVar[Sequence[str]]  # parameters of which one number may stand for a list
    law: str | sympy.Expr | Mapping[str, sympy.Expr]
    law_parameters: Mapping[str, Any] | None

    def __post_init__(self) -> None:
        name = f"{type(self).__name__}: "
        sizes = self._sizes()
        for field, dimension in self.dimensions.items():
            value = getattr(self, field)
            optional = value is None and self.__dataclass_fields__[field].default is None
            if optional or (field in self.one_for_all and np.isscalar(value)):
                continue
            if isinstance(value, xr.DataArray):
                check_units(f"{name}{field}", value.attrs.get("units"), self.units(field))
            array = along(f"{name}{field}", value, dimension)
            size, other = sizes.setdefault(dimension, (array.size, field))
            if array.size != size:
                what = f"{name}{field} has {array.size} values, and {other} has {size}"
                raise ValueError(f"{what}; allowed: one for each {dimension} in both")
            object.__setattr__(self, field, array)
        for dimension, (size, field) in sizes.items():
            if size > (most := MOST_BY_DIMENSION[dimension]):
                what = f"{name}{field} has {size} values"
                raise ValueError(f"{what}; allowed: at most {most} {dimension}s")
        super().__post_init__()
        check_ranges(self, name)
        if self.yields and self.hardening is None:
            raise ValueError(
                f"{name}hardening is not given; what yields needs it, allowed: {HARDENING}"
            )
        self._check(name)
        _ = self.element_law

    def _sizes(self) -> dict[str, tuple[int, str]]:
        """Sizes of dimensions that are known beforehand, and the parameters that say them."""
        return {}

    @abstractmethod
    def _check(self, name: str) -> None:
        """Raise a ValueError for values that do not fit together; ``name`` begins messages."""

    @property
    def yields(self) -> bool:
        """Whether a strength is given, so that elements can yield."""
        return getattr(self, self.strength_name) is not None

    @property
    def storeys(self) -> int:
        """Number of storeys, which is also that of the floors."""
        return int(self.cells()["heights"].size)

    @property
    def floor_count(self) -> int:
        """Number of floors, one above each storey."""
        return self.storeys

    def first_mode(self) -> Structure:
        """The first mode as an oscillator."""
        return self.oscillator()

    def first_period(self) -> xr.DataArray:
        """Period of the first mode [s]."""
        return self.mode_periods()[0].reset_coords(drop=True)

    def elastic(self) -> Self:
        """The building without its strength."""
        return replace(self, **{self.strength_name: None})

    @property
    @abstractmethod
    def element_law(self) -> Structure:
        """Oscillators that have the hysteresis law of the elements, over the storeys or modes."""

    @abstractmethod
    def system(self) -> System:
        """The building as coordinates, elements and floors."""

    @abstractmethod
    def shear_shares(self) -> Array:
        """Share of each element's force in the shear of each storey (storeys, elements) [-].

        It is NaN in storeys whose shear is not known.
        """

    @abstractmethod
    def mode_periods(self) -> xr.DataArray:
        """Periods of the elastic building [s] over ``mode``, counted from 1, longest first."""

    @abstractmethod
    def first_mode_moves(self) -> xr.DataArray:
        """Displacement of each floor in mode 1 over that of `oscillator` [-], over ``floor``."""

    @abstractmethod
    def oscillator(self) -> Structure:
        """The first mode as an oscillator, with its effective modal mass [kg]."""

    def _as_oscillator(self, element: int, **changed: Any) -> Structure:
        """An element as an oscillator, with some of its parameters changed."""
        law = self.element_law.isel({self.element: element})
        values: dict[str, Any] = {name: float(array) for name, array in law.arrays().items()}
        if isinstance(law, Hysteretic):
            values["law"] = law.law
        return type(law)(**values | changed)

    def with_pushover(self, idealized: Mapping[str, Any]) -> Self:
        """The building with the strength, hardening and elastic stiffness of a pushover curve.

        The first mode becomes an oscillator with the displacement ``u_roof/(G s_roof)`` and the
        force ``V/(G L)`` per unit of mass (Chopra and Goel), for the participation factor ``G`` and
        the effective mass ``G L``. Its period is that of the first line of the idealization. In a
        chain all storeys yield at once, with storey shears in the proportions of the first mode, so
        that forces of this mode push it along the idealized curve; the stiffness of all storeys is
        multiplied by one factor. Of a `ModalBuilding` mode 1 changes alone.

        Parameters
        ----------
        idealized : xarray.Dataset
            The result of `bilinear_of`, of which ``yield_force`` [N], ``yield_displacement`` [m],
            ``hardening`` [-] and ``initial_stiffness`` [N/m] are used.

        Returns
        -------
        ShearBuilding or ModalBuilding
            The building that yields.

        Raises
        ------
        ValueError
            If a value is missing or not positive, or the weight of the building is to be considered
            (``p_delta``), which a pushover curve contains.

        Warns
        -----
        DoubtfulInput
            If the curve begins with the stiffness of a first period that is off by more than 10 %
            from that of the building: masses or units are then doubtful, or the forces were not
            those of the first mode.

        References
        ----------
        Chopra, A. K. and Goel, R. K. (2002), Earthquake Eng. Struct. Dyn. 31, 561-582.
        """
        if not isinstance(idealized, Mapping):
            raise TypeError(f"idealized = {brief(idealized)}; allowed: the result of bilinear_of")
        needed = ("yield_force", "yield_displacement", "hardening", "initial_stiffness")
        values = {name: float(idealized.get(name, np.nan)) for name in needed}
        for name, value in values.items():
            if not value > 0:
                raise ValueError(
                    f"idealized has {name} = {value:g}; allowed: the result of bilinear_of"
                )
        first = self.oscillator()
        roof = float(self.first_mode_moves()[-1])
        mass = first.arrays()["mass"].item()
        period = first.arrays()["period"].item()
        displacement = values["yield_displacement"] / roof
        begins = 2 * np.pi * np.sqrt(mass / (roof * values["initial_stiffness"]))
        if abs(begins / period - 1) > PERIOD_OFF:
            what = f"the pushover curve begins with the stiffness of a period of {begins:.3g} s"
            cure = (
                f"the first mode has {period:.3g} s; "
                "are units, masses and the pushing forces right?"
            )
            warnings.warn(f"{what}, {cure}", DoubtfulInput, stacklevel=2)
        period = 2 * np.pi * np.sqrt(mass * displacement / values["yield_force"])
        return self._of_first_mode(float(period), displacement, values["hardening"])

    @abstractmethod
    def _of_first_mode(self, period: float, yield_displacement: float, hardening: float) -> Self:
        """The building whose first mode is such an oscillator."""

    def doubts(self) -> Iterator[str]:
        """Texts on what follows from the parameters and is implausible, as of all buildings."""
        height = float(self.levels()[-1])
        yield from doubts_of_size(float(self.mode_periods()[0]), height, self.storeys)
        masses = self._numbers("masses")
        yield from doubt_of_order("mass", masses, masses[0])
        heights = self._numbers("heights")
        yield from doubt_of_order("height", heights, heights[0])

    def levels(self) -> Array:
        """Levels of the floors above the ground [m], (storeys,)."""
        return np.cumsum(self._numbers("heights"))

    def _numbers(self, name: str) -> Array:
        """A parameter as an array without labels."""
        numbers: Array = self.arrays()[name].to_numpy()
        return numbers

    def _law(self, **common: Any) -> Structure:
        """Oscillators with the law and these parameters; raises a ValueError if they do not fit."""
        values = self.law_parameters if self.law_parameters is not None else {}
        if not isinstance(values, Mapping) or not all(map(is_number, values.values())):
            raise TypeError(
                f"law_parameters = {brief(values)}; allowed: a mapping of numbers by name"
            )
        law = law_of(self.law, common, values)
        if not law.valid().all():
            raise ValueError(
                f"law_parameters = {brief(dict(values))}; allowed: what fits the hardening"
            )
        return law

    def further(self) -> list[str]:
        """The law and its parameters, if it is not the bilinear one."""
        parts = [] if self.law == "bilinear" else [f"law {in_words(self.law)}"]
        return parts + [
            f"{name} {brief(value)}" for name, value in (self.law_parameters or {}).items()
        ]


def doubt_of_order(what: str, values: Array, lowest: float) -> Iterator[str]:
    """Text on values that grow upwards, as if listed from the roof down, or fall as sums do."""
    growth = values[-1] / lowest
    text = PLAUSIBLE[f"{what} upwards"].doubt(growth)
    if text and (np.sign(growth - 1) * np.diff(values) >= 0).all():
        grows = "grows" if growth > 1 else "falls"
        yield f"the {what} of storeys {grows} upwards, {growth:.3g} times up to the roof; {text}"


def check_ranges(model: Model, prefix: str) -> None:
    """Raise a ValueError if a number of an array is out of range; the message names its place."""
    for key, value in model.cells().items():
        if not isinstance(value, xr.DataArray):  # numbers were checked when the model was made
            continue
        allowed = model.allowed(key)
        bad = np.argwhere(~allowed.contains(value.to_numpy()))
        if len(bad):
            number = float(value.to_numpy()[tuple(bad[0])])
            dims = (STOREY if dim == CASE else dim for dim in value.dims)
            where = ", ".join(f"{dim} {n + 1}" for dim, n in zip(dims, bad[0], strict=True))
            what = f"{prefix}{key} = {number:g} in {where} is out of range"
            raise ValueError(f"{what}; allowed: {allowed}")


def numbered(values: Array, dimension: str, units: str, long_name: str) -> xr.DataArray:
    """Numbers of modes or floors, which are counted from 1."""
    coords = {dimension: np.arange(1, values.size + 1)}
    return xr.DataArray(values, coords, dimension, attrs={"units": units, "long_name": long_name})


def along(label: str, value: Any, dimension: str) -> xr.DataArray:
    """A list or 1-D array as an array over a dimension; raises a ValueError for anything else."""
    array = as_array(value)
    if array.ndim != 1 or not array.size:
        raise ValueError(
            f"{label} = {brief(value)}; allowed: a list, one number for each {dimension}"
        )
    return xr.DataArray(array, dims=dimension)
