"""Equivalent linear system of each structure on its ground, and its stationary response.

`linearize` returns the response; `correlate` combines the equivalent systems of two structures.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array, choose
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.kernels.correlation.pairs import ROUNDING_OF_CORRELATION
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    linear_system,
    own_covariance,
)
from stochlin.kernels.linearization.drift import Drift, drift_of, no_drift
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.iteration import FixedPoint
from stochlin.kernels.linearization.single_structures import (
    SingleStructures,
    moments_of,
    solve_structures,
)
from stochlin.messages import brief, hint
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.linearization.drift_map import STRENGTH_RATIO, with_correction
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import Flat, flat
from stochlin.solver.tables.checks import USUAL_TOLERANCE, Tolerance, check_table
from stochlin.solver.tables.lazy import Cells, in_blocks

# Slip 1 + c_eq and relaxation k_eq/w below which z has no effect on the response in double
# precision.
NEGLIGIBLE_SLIP = 1e-18
# R/p above which a cell that does not converge has the status of too strong shaking
TOO_STRONG_DEMAND = 1e3
SYSTEM_VARIABLES = (
    "displacement_std",
    "velocity_std",
    "ductility_std",
    "z_std",
    "velocity_z_corr",
    "c_eq",
    "k_eq",
    "yield_displacement",
)
# those that tables of pairs and of strengths show of each structure
STRUCTURE_VARIABLES = ("displacement_std", "ductility_std", "yield_displacement")
PUBLIC = (*SYSTEM_VARIABLES, "iterations", "residual", "status")
DRIFT_VARIABLES = ("drift_std", "drift_rate")
JUDGED = ("bias", "bias_error", "caution")
# Values of invalid cells; the others are NaN.
VALUES_IF_INVALID = {
    "iterations": 0,
    "status": labels.INVALID_INPUT,
    "caution": len(labels.CAUTION_MEANINGS) - 1,
}


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
        structure = table.models["structure"]
        parameters = table.models["structure"].cells()
        rows = (
            parameters["period"],
            parameters["damping"],
            parameters.get("hardening", 1.0),
            parameters.get("yield_displacement", parameters.get("reduction_factor", np.inf)),
            structure.reduction_factor is not None,
            parameters["peak_factor"],
            *table.models["ground"].cells().values(),
        )
        columns = in_columns(rows, table.where.size)
        return cls._make([*columns[:6], columns[6:]])

    def at(self, cells: Any) -> Oscillators:
        """Some of the cells."""
        return Oscillators(*(part[..., cells] for part in self))

    def stronger(self, ground: Ground, factor: float) -> Oscillators:
        """The same structures with this factor on the intensity of the ground."""
        soil = self.soil.copy()
        soil[list(ground.cells()).index("intensity")] *= factor
        return self._replace(soil=soil)

    def point(self, ground: Ground, ratio: Array) -> Array:
        """Places (axes, n) in the map of the drift closure, for R/p; without soil two axes less."""
        place = [ratio, self.hardening, self.damping]
        if ground.calibration is None or ground.calibration.soil is None:
            return np.array(place)
        period, damping = ground.calibration.soil
        named = dict(zip(ground.cells(), self.soil, strict=True))
        return np.array([*place, named[damping], self.period / named[period]])


class LawOfCells(NamedTuple):
    """The law by which cells yield, and its closure."""

    closure: Closure
    parameters: Array  # (m, n)
    one_solution: Array  # (n,) whether linearization is known to have at most one solution
    drifts: bool  # whether the closure is that with a drift

    @classmethod
    def of(cls, table: Flat, closure: str) -> LawOfCells:
        """That of the ``structure`` of a table."""
        structure = table.models["structure"]
        count = table.where.size
        values = structure.cells()
        parameters = in_columns(
            [values[n] for n in structure.own_parameters() if n in values], count
        )
        one_solution = np.broadcast_to(structure.has_one_solution().to_numpy(), count)
        return cls(structure.closure(closure), parameters, one_solution, closure == DRIFT)

    @classmethod
    def bilinear(cls, count: int, closure: str) -> LawOfCells:
        """The bilinear law of so many cells."""
        none = np.empty((0, count))
        yes = np.ones(count, bool)
        in_closed_form = Bilinear.closed_form(closure)
        assert in_closed_form is not None
        return cls(in_closed_form, none, yes, closure == DRIFT)

    def at(self, cells: Any) -> LawOfCells:
        """Some of the cells."""
        parameters = self.parameters[:, cells]
        one_solution = self.one_solution[cells]
        return self._replace(parameters=parameters, one_solution=one_solution)


class Solved(NamedTuple):
    """Structures on one ground, solved together: the valid cells of one after those of another."""

    structures: Sequence[Structure]
    ground: Ground
    tables: Sequence[Flat]
    parts: Sequence[slice]  # the cells of each structure
    oscillators: Oscillators
    values: Mapping[str, Array]  # (n,) by name; also ``system``, ``forcing`` and ``drift_shares``
    by_drift: Any = None  # for the bias: `Solved` of bilinear structures by the drift closure

    @property
    def point(self) -> Array:
        """Places in the map of the drift closure."""
        return self.oscillators.point(self.ground, self.values[STRENGTH_RATIO])

    def labelled(self, number: int, names: Sequence[str]) -> dict[str, Cells]:
        """Variables of a structure over its dimensions."""
        table = self.tables[number]
        part = self.parts[number]
        return {
            name: table.array(self.values[name][part], VALUES_IF_INVALID.get(name, np.nan))
            for name in names
        }

    def dataset(self) -> xr.Dataset:
        """Dataset of a single structure: the variables `PUBLIC`, and those of drift and bias."""
        more = (STRENGTH_RATIO, *DRIFT_VARIABLES, "displacement_error", *JUDGED)
        return xr.Dataset(
            self.labelled(0, [*PUBLIC, *(name for name in more if name in self.values)])
        )

    def by_laws(
        self, laws: Sequence[LawOfCells | None], closure: str | None, tolerance: Tolerance
    ) -> Solved:
        """Cells of each structure by its law with this closure; without a law they stay elastic."""
        single = all(table.where.size == 1 for table in self.tables)
        groups = dict[Any, list[int]]()
        for number, law in enumerate(laws):  # single cells of one closure are solved together
            groups.setdefault(law and law.closure if single else number, []).append(number)
        values = dict[str, Array]()
        count = self.oscillators.period.size
        if len(groups) == 1:
            values = solve_oscillators(self.oscillators, joined(laws), self.ground, tolerance)
            groups.clear()
        for numbers in groups.values():
            at = np.concatenate([np.arange(count)[self.parts[number]] for number in numbers])
            law = joined([laws[number] for number in numbers])
            of_law = solve_oscillators(self.oscillators.at(at), law, self.ground, tolerance)
            for name, rows in of_law.items():
                blank = np.empty((*rows.shape[:-1], count), rows.dtype)
                values.setdefault(name, blank)[..., at] = rows
        if closure == DRIFT:
            point = self.oscillators.point(self.ground, values[STRENGTH_RATIO])
            values = with_correction(self.ground, self.oscillators.soil, point, values)
        return self._replace(values=values)


def in_columns(rows: Sequence[Any], count: int) -> Array:
    """Numbers, or arrays (count,), in the rows of one array."""
    columns = np.empty((len(rows), count))
    for column, row in zip(columns, rows, strict=True):
        column[:] = row
    return columns


def check_closure(structure: Structure, closure: str) -> None:
    """Raise a ValueError if the law lacks this closure, an ArithmeticError if it has none."""
    if not isinstance(closure, str) or closure not in structure.closure_names():
        structure.closure(GAUSSIAN)  # raises if the law cannot be linearized at all
        names = structure.closure_names()
        what = f"closure = {brief(closure)} is not available for {type(structure).__name__}"
        raise ValueError(f"{what}; {hint(str(closure), names)}allowed: {', '.join(names)}")


def solve_elastic(structure: Structure, ground: Ground) -> xr.Dataset:
    """Dataset of the structure as elastic; ``yield_displacement`` is that of its strength."""
    models = {"structure": structure, "ground": ground}
    return in_blocks(
        lambda structure, ground: solved_together((structure,), ground).dataset(), models
    )


def solved_together(
    structures: Sequence[Structure],
    ground: Ground,
    closure: str | None = None,
    tolerance: Tolerance = USUAL_TOLERANCE,
) -> Solved:
    """Responses of structures on one ground, which stay elastic without a ``closure``.

    Those by the drift closure are corrected by the map of simulations.
    """
    tables = list[Flat]()
    laws = list[LawOfCells | None]()
    for structure in structures:
        yields = closure is not None and structure.yields
        if closure is not None:
            check_closure(structure, closure)
            check_table(1250 if closure == DRIFT else 90, structure, ground)
        if yields:
            structure.check_settles(type(structure).__name__)
        tables.append(flat({"structure": structure, "ground": ground}, settled=yields))
        laws.append(LawOfCells.of(tables[-1], str(closure)) if yields else None)
    ends = np.cumsum([table.where.size for table in tables])
    parts = [slice(end - table.where.size, end) for end, table in zip(ends, tables, strict=True)]
    cells = joined([Oscillators.of(table) for table in tables])
    return Solved(structures, ground, tables, parts, cells, {}).by_laws(laws, closure, tolerance)


def joined(parts: Sequence[Any]) -> Any:
    """Named tuples of arrays, one after another along the last axis; the rest is equal in all."""
    first = parts[0]
    if len(parts) == 1 or not isinstance(first, tuple):
        return np.concatenate(parts, axis=-1) if isinstance(first, np.ndarray) else first
    return type(first)(*map(joined, zip(*parts, strict=True)))


def solve_oscillators(
    cells: Oscillators, law: LawOfCells | None, ground: Ground, tolerance: Tolerance
) -> dict[str, Array]:
    """The values of `Solved` for cells of one law, without corrections by simulation."""

    def part(at: slice) -> dict[str, Array]:
        return _solved(cells.at(at), law and law.at(at), ground, tolerance)

    parts = in_ranges(part, cells.period.size)
    if len(parts) == 1:
        return parts[0]
    return {name: np.concatenate([part[name] for part in parts], axis=-1) for name in parts[0]}


@np.errstate(all="ignore")  # cells with extreme parameters get a status
def _solved(
    cells: Oscillators, law: LawOfCells | None, ground: Ground, tolerance: Tolerance
) -> dict[str, Array]:
    """`solve_oscillators` of cells that are computed together."""
    w = 2 * np.pi / cells.period
    n = cells.period.size
    elastic = linear_system(w, cells.damping)
    soil = ground.filter_of(cells.soil)
    covariance = own_covariance(elastic, soil.forcing(elastic))
    std = np.sqrt(covariance.mu_mu)
    by_factor = cells.by_factor > 0
    uy = np.where(by_factor, cells.peak_factor * std / cells.strength, cells.strength)
    # A reduction factor is used as it is, so that equal structures have exactly equal ratios.
    ratio = np.where(by_factor, cells.strength / cells.peak_factor, std / uy)
    system = elastic
    elastic_cells = np.ones(n, bool)
    drift = no_drift(n)
    ended = FixedPoint(np.empty((3, n)), np.zeros(n, np.int32), np.zeros(n), elastic_cells)
    if law is not None:
        problem = _problem(cells, law, ground, tolerance, uy)
        start = np.array([np.sqrt(covariance.v_v), std, 0.1 * uy]) / uy
        ended = solve_structures(problem, start, law.one_solution, tolerance.max_iterations)
        latent = moments_of(ended.unknowns)
        yielding = EquivalentSystem(
            *problem.structure, *law.closure(latent, law.parameters).coefficients
        )
        elastic_cells = np.abs(yielding.slip) < NEGLIGIBLE_SLIP
        elastic_cells &= np.abs(yielding.relaxation) < NEGLIGIBLE_SLIP * w
        system = choose(elastic_cells, elastic, yielding)
        if law.drifts:
            drift = choose(elastic_cells, drift, drift_of(yielding, latent, soil))
    values, physical = _response(system, elastic_cells, drift, soil, uy)
    status = np.where(elastic_cells, labels.ELASTIC_LIMIT, labels.CONVERGED)
    status = np.where(physical, status, labels.NOT_PHYSICAL)
    lost = np.where(ratio > TOO_STRONG_DEMAND, labels.TOO_STRONG, labels.NOT_CONVERGED)
    status = np.where(ended.converged, status, lost).astype(np.int8)
    if (failed := status >= labels.NOT_CONVERGED).any():
        for row in values.values():
            row[..., failed] = np.nan
    counts = {"iterations": ended.iterations, "residual": ended.residual, "status": status}
    return values | counts | {STRENGTH_RATIO: ratio}


def _problem(
    cells: Oscillators, law: LawOfCells, ground: Ground, tolerance: Tolerance, uy: Array
) -> SingleStructures:
    """The equations of cells for the displacement over ``uy``."""
    soil = cells.soil.copy()
    w = 2 * np.pi / cells.period
    soil[list(ground.cells()).index("intensity")] /= uy**2
    structure = np.array([w**2, 2 * cells.damping * w, (1 - cells.hardening) * w**2])
    level = np.zeros_like(uy)
    of_law = law.closure, law.parameters
    return SingleStructures(structure, *of_law, ground.filter_of(soil), level, tolerance.rtol)


def _response(
    system: EquivalentSystem, elastic: Array, drift: Drift, soil: Filter, uy: Array
) -> tuple[dict[str, Array], Array]:
    """The response of equivalent systems, and whether it is physical."""
    forcing = soil.forcing(system)
    covariance = own_covariance(system, forcing)
    displacement = np.sqrt(covariance.mu_mu)
    velocity = np.sqrt(covariance.v_v)
    z = np.sqrt(covariance.z_z)
    of_drift = np.where(drift.variance > 0, uy * np.sqrt(drift.variance), drift.variance)
    total = np.hypot(displacement, of_drift)
    share = covariance.mu_z / (displacement * z)
    values = {
        "displacement_std": total,
        "velocity_std": velocity,
        "ductility_std": total / uy,
        "z_std": np.where(elastic, displacement, z) / uy,
        "velocity_z_corr": np.where(elastic, 0.0, covariance.v_z / (velocity * z)),
        "c_eq": np.where(elastic, -1.0, system.slip - 1),
        "k_eq": np.where(elastic, 0.0, system.relaxation),
        "yield_displacement": uy.copy(),
        "system": np.array(system),
        "forcing": np.array(forcing),
        **dict(zip(DRIFT_VARIABLES, (of_drift, drift.rate.copy()), strict=True)),
        "drift_shares": drift.shares.copy(),
    }
    physical = (covariance.mu_mu > 0) & (covariance.v_v > 0)
    for name in SYSTEM_VARIABLES[:3]:
        physical &= np.isfinite(values[name])
    correlated = np.maximum(np.abs(values["velocity_z_corr"]), np.abs(share))
    return values, physical & (elastic | ((z > 0) & (correlated <= 1 + ROUNDING_OF_CORRELATION)))
