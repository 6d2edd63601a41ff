"""What results of finite motions are computed from, and their registry."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.models.buildings.base import FLOOR
from stochlin.registry import LAST, Registry
from stochlin.solver.simulation.structures_in_motion import PATH, StructuresInMotion, pairs_of
from stochlin.solver.tables.labels import ELEMENT
from stochlin.solver.variables import unit_and_long_name

RESULTS: Registry[Result] = Registry("result of a simulation", "stochlin.solver.simulation.results")
Values = Callable[["EndedMotions"], "Array | None"]
Column = tuple[Sequence[str], Array]  # dimensions, and values over them


@dataclass(frozen=True, eq=False)
class EndedMotions:
    """What is known of structures in finite motions from rest, when these have ended.

    Of all that is watched (w,), first come the floors with the storeys below them, then the modes
    that yield. Peaks of structures that have fallen are infinite.
    """

    moving: StructuresInMotion
    # (2, paths, m) [m]: largest values of all `StructuresInMotion.functions`, to both sides
    largest: Mapping[str, Array]
    fallen: Array  # (paths, s), whether each structure has fallen
    links: Mapping[str, Array]  # (paths, l) each: "force" [N], "stroke" [m] and "energy" [J]
    displacement: Array  # (paths, w) [m] of all that is watched, at the end
    plastic: Array  # (paths, w) [m], the plastic part of its drift at the end

    def either(self, name: str) -> Array:
        """The larger of both sides (paths, m) [m], of functions by their name."""
        larger: Array = self.largest[name].max(axis=0)
        return larger

    @property
    def hardening(self) -> Array:
        """Hardening ratio [-] of all that is watched (paths or 1, w), 1 where nothing yields.

        It is NaN for storeys of a building whose modes yield, which have no law of their own.
        """
        systems = self.moving.assemblies
        rows = []
        for system in systems:
            ratios = system.storeys.post / (system.storeys.post + system.storeys.couple)
            rows.append(system.of_elements(ratios, 1.0, np.nan))
        return np.array(rows)

    def unless_fallen(self, values: Array) -> Array:
        """Values (paths, w) of all that is watched, infinite where the structure has fallen."""
        return np.where(self.fallen[:, self.moving.system.owners], np.inf, values)

    @cached_property
    def separations(self) -> Array:
        """Peak relative displacements (paths, s, s, heights) [m]; the last is of oscillators."""
        *both, height = np.reshape(pairs_of(self.moving.system), (-1, 3)).T
        heights = np.unique(height)  # with NaN, of oscillators, at the end
        i, j = np.array(both, int)
        place = np.searchsorted(heights, height)
        count = len(self.moving.system.sticks)
        largest = self.largest["pairs"]
        at_height = np.full((largest.shape[1], count, count, heights.size), np.nan)
        at_height[:, i, j, place], at_height[:, j, i, place] = largest
        return at_height


class Result(NamedTuple):
    """A result for each motion, as `register_result` takes it."""

    values: Values
    over: Sequence[str]
    mean: bool
    described: tuple[str, str] | None  # unit and long name


def register_result(
    name: str,
    over: Sequence[str],
    *,
    units: str = "",
    long_name: str = "",
    mean: bool = False,
    place: int = LAST,
) -> Callable[[Values], Values]:
    """A decorator of a function of `EndedMotions`, whose values `simulate` reports by this name.

    The values have the motions as first dimension, and after it those of ``over``; None stands for
    structures that have no such result. ``floor`` and ``element`` are ``structure`` if all are
    oscillators. With ``mean``, the mean over the motions is reported, too, with its standard error.
    A name that `variables` does not have needs ``units`` and a ``long_name``, else a ValueError is
    raised.
    """
    if not (units and long_name) and unit_and_long_name(name) is None:
        raise ValueError(f"the result {name!r} lacks units and long_name; give both")

    def add(values: Values) -> Values:
        described = (units, long_name) if long_name else None
        RESULTS.register(name, place)(Result(values, over, mean, described))
        return values

    return add


def descriptions() -> Mapping[str, tuple[str, str]]:
    """Units and long names of the results that declare them."""
    return {name: result.described for name, result in RESULTS.items() if result.described}


def columns_of(motions: EndedMotions) -> dict[str, Column]:
    """All results of these motions, by name."""
    dimensions = dict(zip((FLOOR, ELEMENT), motions.moving.dimensions, strict=True))
    columns: dict[str, Column] = {}
    for name, result in RESULTS.items():
        values = result.values(motions)
        if values is not None:
            over = (dimensions.get(dimension, dimension) for dimension in result.over)
            columns[name] = (PATH, *over), values
    return columns
