"""Equivalent linear system of each structure on its ground, and its stationary response.

`linearize` returns the response; `correlate` combines the equivalent systems of two structures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    linear_system,
    own_covariance,
)
from stochlin.kernels.linearization.drift import ORDERS, drift_of
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.iteration import FixedPoint
from stochlin.kernels.linearization.single_structures import (
    Law,
    SingleStructures,
    moments_of,
    solve_structures,
)
from stochlin.messages import brief, hint
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.linearization.drift_map import point_of, with_correction
from stochlin.solver.linearization.tolerance import USUAL, Tolerance
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, flat
from stochlin.solver.tables.cellwise import Cells
from stochlin.solver.tables.lazy import in_blocks
from stochlin.solver.tables.work import check_table

AT_ONCE = 1 << 15  # cells that are solved together, which limits the memory for intermediate results
ROUNDING = 1e-9  # by which a correlation may exceed 1
# Slip 1 + c_eq and relaxation k_eq/w below which z has no effect on the response in double precision.
ELASTIC = 1e-18
INTERNAL = (
    *(f"system_{n}" for n in EquivalentSystem._fields),
    *(f"forcing_{n}" for n in Forcing._fields),
)
STRENGTH_RATIO = "elastic_ductility_std"  # R/p: standard deviation of the elastic displacement over uy
STRONG = 1e3  # R/p above which a cell that does not converge has the status of too strong shaking
SHOWN = (
    "displacement_std",
    "velocity_std",
    "ductility_std",
    "z_std",
    "velocity_z_corr",
    "c_eq",
    "k_eq",
    "yield_displacement",
)
PUBLIC = (*SHOWN, "iterations", "residual", "status")
OF_DRIFT = ("drift_std", "drift_rate")
JUDGED = ("bias", "bias_error", "caution")
# Values of invalid cells; the others are NaN.
BLANK = {"iterations": 0, "status": labels.INVALID_INPUT, "caution": len(labels.CAUTION_MEANINGS) - 1}


class Oscillators(NamedTuple):
    """Structures on their ground, a column for each cell; all parameters are in range."""

    period: Array
    damping: Array
    hardening: Array
    strength: Array  # yield displacement [m], or reduction factor; infinite if elastic
    by_factor: Array  # whether the strength is a reduction factor
    peak_factor: Array
    soil: Array  # (g, n) parameters of the ground

    @classmethod
    def of(cls, table: Flat) -> Oscillators:
        """The valid cells of a ``structure`` on a ``ground``."""
        structure, own = table.models["structure"], table.models["structure"].cells()
        rows = (
            own["period"],
            own["damping"],
            own.get("hardening", 1.0),
            own.get("yield_displacement", own.get("reduction_factor", np.inf)),
            structure.reduction_factor is not None,
            own["peak_factor"],
            *table.models["ground"].cells().values(),
        )
        columns = in_columns(rows, table.where.size)
        return cls._make([*columns[:6], columns[6:]])

    def at(self, cells: Array | slice) -> Oscillators:
        """Some of the cells."""
        return Oscillators(*(part[..., cells] for part in self))

    def point(self, ground: Ground, ratio: Array) -> Array:
        """Their places in the map of the drift closure, for their R/p on this ground."""
        return point_of(ground, [ratio, self.hardening, self.damping], self.period, self.soil)


class Yielding(NamedTuple):
    """The cells that yield by one law."""

    cells: Array  # (k,) their numbers, which increase
    law: Law
    drifts: bool  # whether the closure is that with a drift

    @classmethod
    def of(cls, table: Flat, closure: str, first: int = 0) -> Yielding:
        """Those of the ``structure`` of a table, whose cells have numbers from ``first`` on."""
        structure, count = table.models["structure"], table.where.size
        own = structure.cells()
        parameters = in_columns([own[n] for n in structure.own_parameters() if n in own], count)
        one_solution = np.broadcast_to(structure.has_one_solution().to_numpy(), count)
        law = Law(structure.closure(closure), parameters, one_solution)
        return cls(np.arange(first, first + count), law, closure == DRIFT)

    @classmethod
    def bilinear(cls, cells: Array, closure: str) -> Yielding:
        """These cells by the bilinear law."""
        none, yes = np.empty((0, cells.size)), np.ones(cells.size, bool)
        return cls(cells, Law(Bilinear.closures[closure], none, yes), closure == DRIFT)

    def at(self, cells: Array) -> Yielding:
        """Those among the cells with these numbers, which increase; they are counted anew."""
        own = np.isin(self.cells, cells)
        return Yielding(np.flatnonzero(np.isin(cells, self.cells)), self.law.at(own), self.drifts)


class Solved(NamedTuple):
    """Structures on one ground, solved together: the valid cells of one after those of another."""

    structures: Sequence[Structure]
    ground: Ground
    tables: Sequence[Flat]
    parts: Sequence[slice]  # the cells of each structure
    oscillators: Oscillators
    values: Mapping[str, Array]  # (n,) by name; also ``system``, ``forcing`` and ``drift_shares``
    like: Mapping[str, Solved] = {}  # bilinear structures of the same strength, by closures

    @property
    def point(self) -> Array:
        """Places in the map of the drift closure."""
        return self.oscillators.point(self.ground, self.values[STRENGTH_RATIO])

    def labelled(self, number: int, names: Sequence[str]) -> dict[str, Cells]:
        """Variables of a structure over its dimensions."""
        table, part = self.tables[number], self.parts[number]
        return {name: table.array(self.values[name][part], BLANK.get(name, np.nan)) for name in names}

    def dataset(self) -> xr.Dataset:
        """Dataset of a single structure: the variables `PUBLIC`, and those that a pair needs."""
        rows = [*self.values["system"], *self.values["forcing"]]
        values = {**self.values, **dict(zip(INTERNAL, rows, strict=True))}
        more = [n for n in (*OF_DRIFT, "displacement_error", *JUDGED) if n in values]
        named = [*PUBLIC, *INTERNAL, STRENGTH_RATIO, *more]
        return xr.Dataset(self._replace(values=values).labelled(0, named))


def in_columns(rows: Sequence[Any], count: int) -> Array:
    """Numbers, or arrays (count,), in the rows of one array."""
    columns = np.empty((len(rows), count))
    for column, row in zip(columns, rows, strict=True):
        column[:] = row
    return columns


def system_and_forcing(arrays: Sequence[Array]) -> tuple[EquivalentSystem, Forcing]:
    """Equivalent system and forcing, from arrays in the order of `INTERNAL`."""
    count = len(EquivalentSystem._fields)
    return EquivalentSystem(*arrays[:count]), Forcing(*arrays[count:])


def check_closure(structure: Structure, closure: str) -> None:
    """Raise a ValueError if the law does not have this closure, an ArithmeticError if it has none."""
    if not isinstance(closure, str) or closure not in structure.closure_names():
        structure.closure(GAUSSIAN)  # raises if the law cannot be linearized at all
        names = structure.closure_names()
        raise ValueError(
            f"closure = {brief(closure)} is not available for {type(structure).__name__}; "
            f"{hint(str(closure), names)}allowed: {', '.join(names)}"
        )


def solve_structure(
    structure: Structure, ground: Ground, closure: str, tolerance: Tolerance
) -> xr.Dataset:
    """Dataset of a linearized structure: the variables `PUBLIC`, and those that a pair needs."""
    return solved_together((structure,), ground, closure, tolerance).dataset()


def solve_elastic(structure: Structure, ground: Ground) -> xr.Dataset:
    """Dataset of the structure as elastic; ``yield_displacement`` is that of its strength."""
    return in_blocks(_elastic, {"structure": structure, "ground": ground})


def _elastic(structure: Structure, ground: Ground) -> xr.Dataset:
    return solved_together((structure,), ground).dataset()


def solved_together(
    structures: Sequence[Structure],
    ground: Ground,
    closure: str | None = None,
    tolerance: Tolerance = USUAL,
    *,
    like: Sequence[str] = (),
    corrected: bool = True,
) -> Solved:
    """Responses of structures on one ground, which stay elastic without a ``closure``.

    Those by the drift closure are corrected by the map of simulations if they are to be ``corrected``.
    By the closures in ``like``, bilinear structures are solved beside them: the same ones, and those
    with the period, damping, hardening and strength of Bouc-Wen structures. Other laws then stay
    elastic.
    """
    tables, parts, first = list[Flat](), list[slice](), 0
    laws = dict[Closure, list[Yielding]]()
    bilinear = [np.empty(0, int)]
    for structure in structures:
        yields = closure is not None and structure.yields
        if closure is not None:
            check_closure(structure, closure)
            check_table(1250 if closure == DRIFT else 90, structure, ground)
        if yields:
            structure.check_settles(type(structure).__name__)
        table = flat({"structure": structure, "ground": ground}, settled=yields)
        if yields:
            part = Yielding.of(table, str(closure), first)
            laws.setdefault(part.law.closure, []).append(part)
            bilinear += [part.cells] if isinstance(structure, Bilinear | BoucWen) else []
        tables.append(table)
        parts.append(slice(first, first + table.where.size))
        first = parts[-1].stop
    cells, at = _joined([Oscillators.of(table) for table in tables]), np.concatenate(bilinear)
    sets = [_joined(parts) for parts in laws.values()]
    sets += [Yielding.bilinear(at + n * first, name) for n, name in enumerate(like, start=1) if at.size]
    solved, copies = Solved(structures, ground, tables, parts, cells, {}), 1 + len(like)
    ranges = [slice(a.start + n, a.stop + n) for n in first * np.arange(copies) for a in parts]
    every = solve_oscillators(_joined([cells] * copies), sets, ground, tolerance, ranges)

    def of_set(number: int, name: str | None) -> Solved:
        part = slice(number * first, (number + 1) * first)
        cell = solved._replace(values={key: values[..., part] for key, values in every.items()})
        if name == DRIFT and corrected:
            return cell._replace(values=with_correction(ground, cell.point, cells.soil, cell.values))
        return cell

    beside = {name: of_set(n, name) for n, name in enumerate(like, start=1)}
    return of_set(0, closure)._replace(like=beside)


def _joined(parts: Sequence[Any]) -> Any:
    """Named tuples of arrays, one after another along the last axis; the rest is equal in all."""
    first = parts[0]
    if len(parts) == 1 or not isinstance(first, tuple):
        return np.concatenate(parts, axis=-1) if isinstance(first, np.ndarray) else first
    return type(first)(*map(_joined, zip(*parts, strict=True)))


def solve_oscillators(
    cells: Oscillators,
    laws: Sequence[Yielding],
    ground: Ground,
    tolerance: Tolerance,
    parts: Sequence[slice] = (),
) -> dict[str, Array]:
    """The values of `Solved`, without corrections by simulation; cells without a law stay elastic.

    ``parts`` are the cells of each structure.
    """
    if len(ranges := _ranges(cells.period.size, parts)) > 1:
        solved = [
            solve_oscillators(cells.at(part), [law.at(part) for law in laws], ground, tolerance)
            for part in ranges
        ]
        return {name: np.concatenate([each[name] for each in solved], axis=-1) for name in solved[0]}
    with np.errstate(all="ignore"):  # cells with extreme parameters get a status
        w = 2 * np.pi / cells.period
        elastic, soil = linear_system(w, cells.damping), ground.filter_of(cells.soil)
        own = own_covariance(elastic, soil.forcing(elastic))
        std, by_factor = np.sqrt(own.mu_mu), cells.by_factor > 0
        uy = np.where(by_factor, cells.peak_factor * std / cells.strength, cells.strength)
        # A reduction factor is used as it is, so that equal structures have exactly equal ratios.
        ratio = np.where(by_factor, cells.strength / cells.peak_factor, std / uy)
        response = Response.elastic(elastic)
        at = np.concatenate([np.empty(0, int), *(law.cells for law in laws)])
        if at.size:
            start = (np.array([np.sqrt(own.v_v), std, 0.1 * uy]) / uy)[:, at]
            problem = _problem(cells.at(at), laws, ground, tolerance, uy[at])
            response.put(at, problem, solve_structures(problem, start, tolerance.max_iterations))
        for at in (law.cells for law in laws if law.drifts and law.cells.size):
            response.add_drift(at, soil.at(at), uy[at])
        return _report(response, soil, uy, ratio)


def _ranges(count: int, parts: Sequence[slice]) -> list[Array]:
    """Cells that are solved together: single ones of all structures, otherwise those of a structure.

    The rounding errors of a number depend on its place among others. Tables of equal structures have
    equal places, so that they are solved to the same bits.
    """
    whole = [slice(0, count)] if count <= len(parts) or not parts else parts
    starts = ((part, n) for part in whole for n in range(part.start, part.stop, AT_ONCE))
    return [np.arange(n, min(n + AT_ONCE, part.stop)) for part, n in starts]


def _problem(
    cells: Oscillators, laws: Sequence[Yielding], ground: Ground, tolerance: Tolerance, uy: Array
) -> SingleStructures:
    """The equations of the cells of these laws, in their order, for the displacement over ``uy``."""
    soil = cells.soil.copy()
    soil[list(ground.cells()).index("intensity")] /= uy**2
    w = 2 * np.pi / cells.period
    structure = np.array([w**2, 2 * cells.damping * w, (1 - cells.hardening) * w**2])
    own = [part.law for part in laws if part.cells.size]
    level, limits = np.zeros_like(uy), (tolerance.rtol, tolerance.atol)
    return SingleStructures(structure, own, ground.filter_of(soil), level, *limits)


class Response(NamedTuple):
    """Equivalent systems of structures, and how their iteration ended."""

    system: Array  # (5, n) the rows of an `EquivalentSystem`
    still: Array  # whether there is no slip, so that the elastic system is used
    iterations: Array
    residual: Array
    converged: Array
    latent: Array  # (3, n) std and correlation of the Gaussian variables (v, z~) of the closure
    drift: Array  # (2 + orders, n) its standard deviation and rate, then its shares

    @classmethod
    def elastic(cls, system: EquivalentSystem) -> Response:
        """Structures that do not yield."""
        n = system.stiffness.size
        drift, nothing, yes = np.zeros((ORDERS + 3, n)), np.zeros(n), np.ones(n, bool)
        drift[1] = 1.0
        counts = nothing.astype(np.int32), nothing, yes.copy()
        return cls(np.array(system), yes, *counts, np.empty((3, n)), drift)

    def put(self, cells: Array, problem: SingleStructures, solved: FixedPoint) -> None:
        """Take the solution of these cells."""
        latent = moments_of(solved.unknowns)
        slips = problem.closure(latent).coefficients
        still = np.abs(slips[0]) < ELASTIC
        still &= np.abs(slips[1]) < ELASTIC * self.system[4, cells]
        yields = cells[~still]
        self.system[2:, yields] = np.array([problem.structure[2], *slips])[:, ~still]
        self.still[yields] = False
        self.latent[:, cells] = latent
        counts = solved.iterations, solved.residual, solved.converged
        self.iterations[cells], self.residual[cells], self.converged[cells] = counts

    def add_drift(self, cells: Array, soil: Filter, uy: Array) -> None:
        """Add that of these cells, in m and 1/s."""
        yields = ~self.still[cells]
        drift = drift_of(EquivalentSystem(*self.system[:, cells]), self.latent[:, cells], soil)
        rows = np.array([uy * np.sqrt(drift.variance), drift.rate, *drift.shares])
        self.drift[:, cells[yields]] = rows[:, yields]


def _report(response: Response, soil: Filter, uy: Array, ratio: Array) -> dict[str, Array]:
    system, elastic = EquivalentSystem(*response.system), response.still
    forcing = soil.forcing(system)
    own = own_covariance(system, forcing)
    displacement, velocity, z = np.sqrt(own.mu_mu), np.sqrt(own.v_v), np.sqrt(own.z_z)
    total, share = np.hypot(displacement, response.drift[0]), own.mu_z / (displacement * z)
    values = {
        "displacement_std": total,
        "velocity_std": velocity,
        "ductility_std": total / uy,
        "z_std": np.where(elastic, displacement, z) / uy,
        "velocity_z_corr": np.where(elastic, 0.0, own.v_z / (velocity * z)),
        "c_eq": np.where(elastic, -1.0, system.slip - 1),
        "k_eq": np.where(elastic, 0.0, system.relaxation),
        "yield_displacement": uy.copy(),
        "system": response.system,
        "forcing": np.array(forcing),
        **dict(zip(OF_DRIFT, response.drift, strict=False)),
        "drift_shares": response.drift[len(OF_DRIFT) :],
    }
    physical = (own.mu_mu > 0) & (own.v_v > 0)
    for name in SHOWN[:3]:
        physical &= np.isfinite(values[name])
    correlated = np.maximum(np.abs(values["velocity_z_corr"]), np.abs(share))
    physical &= elastic | ((z > 0) & (correlated <= 1 + ROUNDING))
    status = np.where(elastic, labels.ELASTIC_LIMIT, labels.CONVERGED)
    status = np.where(physical, status, labels.NOT_PHYSICAL)
    lost = np.where(ratio > STRONG, labels.TOO_STRONG, labels.NOT_CONVERGED)
    status = np.where(response.converged, status, lost).astype(np.int8)
    for row in values.values():
        row[..., status >= labels.NOT_CONVERGED] = np.nan
    ended = {"iterations": response.iterations, "residual": response.residual, "status": status}
    return values | ended | {STRENGTH_RATIO: ratio}
