"""Units, long names, flags, floors and elements, and run information of all datasets."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin._version import __version__
from stochlin.models.buildings.base import FLOOR
from stochlin.models.parameters import Model
from stochlin.models.systems import Assembly
from stochlin.solver.tables.lazy import cellwise
from stochlin.solver.variables import NO_VARIABLES, Variables, unit_and_long_name

PAPER = (
    "Valles-Mattox, R. E. and Reinhorn, A. M. (1996). Evaluation, prevention and mitigation of "
    "pounding effects in building structures. 11th World Conference on Earthquake Engineering."
)

_OF_RHO = (
    "linearized ρ is off by 0.05 to 0.2 for moderate yielding, and by up to 1.3 for structures "
    "much stiffer than a narrow-band ground"
)
_OF_SIGMA = (
    "linearized displacements are 15 to 51 % too small at α ≤ 0.05 on white noise, and up to 30 "
    "times too small for structures much stiffer than a narrow-band ground"
)
_COMPARED = "Caution: compared with nonlinear simulation, {}; see 'stochlin charts'."
CAUTION_RHO = _COMPARED.format(_OF_RHO)
CAUTION_SIGMA = _COMPARED.format(_OF_SIGMA)
CAUTION_PAIR = _COMPARED.format(f"{_OF_RHO}; {_OF_SIGMA}")
CAUTION_CROSSINGS = (
    "Compared with simulation of 200 random elastic pairs, the confidence by formula is off by "
    "-0.24 to +0.06 in 95 % of the cases, at most by -0.49 and +0.09."
)
CAUTION_FINITE_DRIFT = (
    "Compared with simulation of 300 random pairs, the gap for 90 % by the drift closure in time "
    "is off by 13 % or less in 95 % of the cases, and at most 17 % too small; on narrow bands, in "
    "motions of few cycles, and where both structures are stiffer than the ground or have nearly "
    "the same period, up to 41 % too small."
)
CAUTION_DRIFT = (
    "Compared with nonlinear simulation of 500 random pairs, displacements by the drift closure, "
    "which other simulations calibrate, are off by 0.9 % in the mean and ρ by 0.02; where T < Tg/2 "
    "on a narrow-band ground (ξg < 0.1), by 2 % and 0.03."
)

CONVERGED, ELASTIC_LIMIT, NOT_CONVERGED, INVALID_INPUT, NOT_PHYSICAL, TOO_STRONG, NOT_RESOLVED = (
    range(7)
)
STATUS_MEANINGS = (
    "converged",
    "elastic_limit",
    "not_converged",
    "invalid_input",
    "not_a_covariance",
    "shaking_too_strong",
    "not_resolved",
)
ENDS = "lower", "upper"
# endings of the names of a number and its interval
VALUE_AND_ENDS = ("", *(f"_{end}" for end in ENDS))
CAUTION_ENDING = "caution"  # end of the names of the caution flags
CAUTION_MEANINGS = ("within_10_percent", "off_by_more_than_10_percent", "outside_of_the_map")
CURES = {
    NOT_CONVERGED: "raise max_iterations; in a simulation, relaxation_times",
    INVALID_INPUT: "correct the parameters that are out of range",
    TOO_STRONG: "an elastic structure would reach more than a thousand times its yield "
    "displacement, which is beyond this method: check the units of the strength and of the "
    "intensity",
    NOT_PHYSICAL: "rounding errors dominate the covariance: use less extreme parameters, or "
    "another closure",
}


def axis(name: str, long_name: str, values: Any, units: str | None = "1") -> xr.DataArray:
    """Array over the dimension ``name`` with itself as coordinate; ``units`` of texts are None."""
    attrs = {"units": units, "long_name": long_name} if units else {"long_name": long_name}
    return xr.DataArray(values, dims=name, coords={name: (name, values, attrs)}, attrs=attrs)


def label(
    dataset: xr.Dataset, special: Variables = NO_VARIABLES, last: int = TOO_STRONG
) -> xr.Dataset:
    """Add units and long names to the variables, and flags to ``status`` and the cautions.

    They are those of `variables`, but for ``special`` names. ``last`` is the last status that there
    may be.
    """
    every = dataset.variables
    for name in map(str, dataset.data_vars):
        if name == "status":
            every[name].attrs = _flags("status of the cell", STATUS_MEANINGS[: last + 1])
            continue
        if "flag_values" in every[name].attrs:
            continue
        if name.rpartition("_")[2] == CAUTION_ENDING:
            every[name].attrs = _flags("caution flag of the linearization", CAUTION_MEANINGS)
        if described := unit_and_long_name(name, special):
            every[name].attrs.update(zip(("units", "long_name"), described, strict=True))
    return dataset


def _flags(long_name: str, meanings: Sequence[str]) -> dict[str, Any]:
    values = np.arange(len(meanings), dtype=np.int8)
    return {"long_name": long_name, "flag_values": values, "flag_meanings": " ".join(meanings)}


def with_run_information(
    dataset: xr.Dataset, title: str, call: str, models: Mapping[str, Model], references: str = PAPER
) -> xr.Dataset:
    """Add title, references, version and the parameters that made the dataset.

    It has no date and time, so that the same inputs give the same file.
    """
    dataset.attrs = {
        **dataset.attrs,
        "title": title,
        "references": references,
        "stochlin_version": __version__,
        "history": f"stochlin {__version__}: {call}",
        **{role: model.describe() for role, model in models.items()},
        **{f"{role}_source": text for role, model in models.items() if (text := _of_fit(model))},
    }
    return dataset


def _of_fit(model: Model) -> str:
    """To what a ground is fitted, and how, which its parameters do not say; empty for others."""
    return str(getattr(model, "source", "")) if getattr(model, "scatter", 0.0) else ""


def named_models(
    structures: Iterable[Any], ground: Any = None, links: Iterable[Any] = ()
) -> dict[str, Any]:
    """Structures, ground and links by their names in attributes, without those that are None."""
    named = {f"structure_{n}": model for n, model in enumerate(structures, start=1)} | {
        "ground": ground
    }
    named |= {f"link_{n}": model for n, model in enumerate(links, start=1)}
    return {name: model for name, model in named.items() if model is not None}


def of_scatter(scatter: float) -> dict[str, float]:
    """Attribute for motions that are scaled by random factors; none without scatter."""
    return {"scatter": float(scatter)} if scatter else {}


def status_where(good: Any, otherwise: int = INVALID_INPUT) -> Any:
    """Status (int8): converged where ``good`` is true, and ``otherwise`` elsewhere."""
    return cellwise(np.where, good, CONVERGED, otherwise, kinds=(np.int8,))[0]


def raise_if_lone_failure(dataset: xr.Dataset, what: str, *models: Model) -> None:
    """Raise an ArithmeticError if the dataset is a single cell that has failed.

    The message begins with ``what`` was called, and with the ``models`` that it was called with.
    """
    status = dataset.variables["status"]
    if status.ndim == 0 and (code := int(status)) in CURES:
        described = ", ".join(model.describe() for model in models)
        what = f"{what}({described})" if models else what
        raise ArithmeticError(f"{what}: {STATUS_MEANINGS[code].replace('_', ' ')}; {CURES[code]}")


ELEMENT = "element"
LINK = "link"
Coordinates = dict[str, tuple[str, Any, dict[str, str]]]


def floor_coordinates(system: Assembly) -> Coordinates:
    """Coordinates along ``floor``: names, numbers from 1, and levels [m] (NaN for oscillators)."""
    structures, numbers = _places(system)
    return {
        FLOOR: (FLOOR, system.floors, {"long_name": "floor (structure.floor)"}),
        "floor_structure": (
            FLOOR,
            structures,
            {"units": "1", "long_name": "structure of the floor"},
        ),
        "floor_number": (FLOOR, numbers, {"units": "1", "long_name": "number of the floor"}),
        "level": (
            FLOOR,
            np.concatenate([stick.levels for stick in system.sticks]),
            {"units": "m", "long_name": "level of the floor"},
        ),
    }


def element_coordinates(system: Assembly, links: Sequence[str] = ()) -> Coordinates:
    """Coordinates along ``element``: storeys, named as the floors above them, then modes and links.

    The modes are those that yield, of buildings by their modes.
    """
    structures, numbers = _places(system)
    modes = system.yielding_modes
    owners = np.searchsorted(system.first_coordinate, modes, side="right")
    structures = np.concatenate([structures, owners, np.zeros(len(links), int)])
    numbers = np.append(numbers, np.zeros(modes.size + len(links), int))
    long_name = "structure of the element, 0 for links"
    return {
        ELEMENT: (
            ELEMENT,
            [*system.watched, *links],
            {"long_name": "element (storey, mode or link)"},
        ),
        "element_structure": (ELEMENT, structures, {"units": "1", "long_name": long_name}),
        "storey": (
            ELEMENT,
            numbers,
            {"units": "1", "long_name": "number of the storey, 0 for others"},
        ),
    }


def link_coordinates(numbers: Sequence[int]) -> Coordinates:
    """Coordinates along ``link``: the numbers from 1 of the links in the list that was given."""
    return {LINK: (LINK, list(numbers), {"long_name": "link, by its place in the list"})}


def _places(system: Assembly) -> tuple[Any, Any]:
    """Numbers from 1 of the structure and of the storey, for all floors."""
    sizes = [stick.levels.size for stick in system.sticks]
    numbers = np.concatenate([np.arange(1, size + 1) for size in sizes])
    return np.repeat(np.arange(1, len(sizes) + 1), sizes), numbers
