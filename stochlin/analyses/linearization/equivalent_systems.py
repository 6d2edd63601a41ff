"""Equivalent linear system of each structure on its ground, and its stationary response.

`linearize` returns the response; `correlate` combines the equivalent systems of two structures.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.drift_map import with_correction
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cellwise import Cells, Solved, cellwise, is_labelled, lone, valid_cells
from stochlin.analyses.tables.lazy import in_blocks
from stochlin.analyses.tables.work import check_table
from stochlin.kernels.basics.arrays import Array, in_one_shape
from stochlin.kernels.basics.slabs import in_slabs
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    linear_system,
    own_covariance,
)
from stochlin.kernels.linearization.drift import ORDERS, drift_of, half_cycles
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure
from stochlin.kernels.linearization.single_structures import (
    SingleStructures,
    moments_of,
    solve_structures,
)
from stochlin.messages import brief, hint
from stochlin.models.grounds import Ground
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure

AT_ONCE = 1 << 15  # cells that are solved together, which limits the memory for intermediate results
ROUNDING = 1e-9  # by which a correlation may exceed 1
# Slip 1 + c_eq and relaxation k_eq/w below which z has no effect on the response in double precision.
ELASTIC = 1e-18
INTERNAL = (
    *(f"system_{n}" for n in EquivalentSystem._fields),
    *(f"forcing_{n}" for n in Forcing._fields),
)
# Variables of the drift closure, from which the correlation of two drifts follows.
SHARES = tuple(f"drift_share_{j}" for j in range(1, ORDERS + 2))
OF_DRIFT = ("drift_std", "drift_rate", *SHARES)
STRENGTH_RATIO = "elastic_ductility_std"  # R/p: standard deviation of the elastic displacement over uy
STRONG = 1e3  # R/p above which a cell that does not converge has the status of too strong shaking
PUBLIC = (
    "displacement_std",
    "velocity_std",
    "ductility_std",
    "z_std",
    "velocity_z_corr",
    "c_eq",
    "k_eq",
    "yield_displacement",
    "iterations",
    "residual",
    "status",
)
KINDS = {"iterations": np.int32, "status": np.int8}  # types of variables; the others are float
BLANK = {"iterations": 0, "status": labels.INVALID_INPUT}  # values of invalid cells; the others are NaN


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
    return xr.Dataset(solved_together((structure,), ground, closure, tolerance)[0])


def solved_together(
    structures: Sequence[Structure], ground: Ground, closure: str, tolerance: Tolerance
) -> list[Solved]:
    """Variables of `solve_structure` of each structure; those of a single cell are numbers.

    Single cells with the same law are solved in one call, which takes hardly longer than for one.
    """
    for structure in structures:
        check_closure(structure, closure)
        check_table("structures with drift" if closure == DRIFT else "structures", structure, ground)
    solved = derived_together(structures, ground, closure, tolerance)
    if closure != DRIFT:
        return solved
    pairs = zip(structures, solved, strict=True)
    return [with_correction(structure, ground, results) for structure, results in pairs]


def solve_elastic(structure: Structure, ground: Ground) -> xr.Dataset:
    """Dataset of the structure as elastic; ``yield_displacement`` is that of its strength."""
    return in_blocks(_elastic, {"structure": structure, "ground": ground})


def _elastic(structure: Structure, ground: Ground) -> xr.Dataset:
    return xr.Dataset(derived_together((structure,), ground)[0])


def solve_derived(
    structure: Structure, ground: Ground, closure: str, tolerance: Tolerance
) -> xr.Dataset:
    """As `solve_structure`, but without the corrections of the drift closure by simulation."""
    return xr.Dataset(derived_together((structure,), ground, closure, tolerance)[0])


def derived_together(
    structures: Sequence[Structure],
    ground: Ground,
    closure: str | None = None,
    tolerance: Tolerance | None = None,
) -> list[Solved]:
    """As `solved_together`, but without the corrections of the drift closure by simulation.

    The structures stay elastic if ``closure`` is None.
    """
    problems = [_problem_of(structure, ground, closure, tolerance) for structure in structures]
    solver = problems[0][0]
    alike = len(problems) > 1 and all(other == solver for other, _ in problems)
    if not alike or any(is_labelled(*inputs) for _, inputs in problems):
        return [_solved_cells(*problem) for problem in problems]
    rows = solver.solve(*map(np.array, zip(*(inputs for _, inputs in problems), strict=True)))
    return [
        {name: row[n, ...] for name, row in zip(solver.names, rows, strict=True)}
        for n in range(len(problems))
    ]


def _problem_of(
    structure: Structure, ground: Ground, closure: str | None, tolerance: Tolerance | None
) -> tuple[_Solver, list[Cells]]:
    """Solver of a structure on its ground, and the arrays that it takes."""
    values, soil = structure.cells(), ground.cells()
    law = [values[name] for name in structure.own_parameters() if name in values]
    elastic = closure is None or not structure.yields
    good = valid_cells(structure)
    if not elastic:
        structure.check_settles(type(structure).__name__)
        good = good & structure.settles() if is_labelled(values["hardening"]) else good
    solver = _Solver(
        len(law),
        structure.reduction_factor is not None,
        ground.filter_of,
        list(soil).index("intensity"),
        None if elastic else structure.closure(str(closure)),
        tolerance,
        closure == DRIFT,
    )
    inputs = [
        good,
        valid_cells(ground),
        values["period"],
        values["damping"],
        values.get("hardening", 1.0),
        values.get("yield_displacement", values.get("reduction_factor", np.inf)),
        values["peak_factor"],
        lone(structure.has_one_solution()),
        *law,
        *soil.values(),
    ]
    return solver, inputs


def _solved_cells(solver: _Solver, inputs: Sequence[Cells]) -> Solved:
    names = solver.names
    kinds = [KINDS.get(name, float) for name in names]
    outputs = cellwise(solver.solve, *inputs, kinds=kinds)
    return dict(zip(names, outputs, strict=True))


class _Solver(NamedTuple):
    """Solution of all cells from arrays: they are flattened, and invalid cells are NaN."""

    laws: int  # number of parameters of the law
    by_factor: bool  # whether the strength is given as a reduction factor
    filter_of: Callable[[Iterable[Array]], Filter]
    intensity: int  # row of the intensity among the parameters of the ground
    law: Closure | None  # None: elastic
    tolerance: Tolerance | None
    drifts: bool  # whether there are variables of the drift; those of elastic structures are 0

    @property
    def names(self) -> tuple[str, ...]:
        return (*PUBLIC, *INTERNAL, STRENGTH_RATIO, *(OF_DRIFT if self.drifts else ()))

    @np.errstate(all="ignore")  # cells with extreme parameters get a status
    def solve(self, *inputs: Array) -> tuple[Array, ...]:
        kinds = [KINDS.get(name, float) for name in self.names]
        return in_slabs(self._solve_some, *inputs, kinds=kinds, cells=AT_ONCE)

    def _solve_some(
        self, structure_valid: Array, ground_valid: Array, *parameters: Array
    ) -> tuple[Array, ...]:
        arrays = in_one_shape(structure_valid & ground_valid, *parameters)
        shape = arrays[0].shape
        where = np.flatnonzero(arrays[0])
        columns = np.array([array.reshape(-1)[where] for array in arrays[1:]])
        solution = self._solve_valid(columns)
        outputs = []
        for name in self.names:
            value = solution[name]
            if where.size < arrays[0].size:
                value = np.full(arrays[0].size, BLANK.get(name, np.nan), KINDS.get(name, float))
                value[where] = solution[name]
            outputs.append(value.reshape(shape))
        return tuple(outputs)

    def _solve_valid(self, columns: Array) -> dict[str, Array]:
        period, damping, hardening, strength, peak_factor, one_solution = columns[:6]
        law, ground = columns[6 : 6 + self.laws], columns[6 + self.laws :]
        w = 2 * np.pi / period
        elastic, soil = linear_system(w, damping), self.filter_of(ground)
        own = own_covariance(elastic, soil.forcing(elastic))
        uy = peak_factor * np.sqrt(own.mu_mu) / strength if self.by_factor else strength
        # A given reduction factor is used as it is, so that equal structures have exactly equal ratios.
        ratio = strength / peak_factor if self.by_factor else np.sqrt(own.mu_mu) / uy
        if self.law is None or self.tolerance is None:
            return self._report(_Solution.elastic(elastic), soil, uy, ratio)
        scaled = ground.copy()
        scaled[self.intensity] /= uy**2  # the equation of motion is that of the ductility u/uy
        start = np.sqrt(np.array([own.mu_mu, own.v_v])) / uy
        batch = _Batch(elastic, w, hardening, law, one_solution > 0, self.filter_of(scaled), start)
        return self._report(self._fixed_point(batch, self.tolerance), soil, uy, ratio)

    def _fixed_point(self, batch: _Batch, tolerance: Tolerance) -> _Solution:
        elastic, w, hardening, law, one_solution, soil, start = batch
        oscillator = np.array([w**2, elastic.damping, (1 - hardening) * w**2])
        latent = np.array([start[1], start[0], np.full_like(w, 0.1)])
        assert self.law is not None
        limits = tolerance.rtol, tolerance.atol
        problem = SingleStructures(oscillator, law, soil, np.zeros_like(w), self.law, *limits)
        solved = solve_structures(problem, latent, one_solution, tolerance.max_iterations)
        slip, relaxation = solved.coefficients
        still = (np.abs(slip) < ELASTIC) & (np.abs(relaxation) < ELASTIC * w)
        pairs = zip(elastic, (*oscillator, slip, relaxation), strict=True)
        system = EquivalentSystem(*(np.where(still, e, s) for e, s in pairs))
        counts = solved.iterations, solved.residual, solved.converged
        return _Solution(system, *counts, still, moments_of(solved.unknowns))

    def _drift(self, solution: _Solution, soil: Filter, uy: Array) -> dict[str, Array]:
        """Variables `OF_DRIFT`, in m and 1/s; an elastic structure has no drift."""
        nothing = dict.fromkeys(OF_DRIFT, np.zeros_like(uy)) | {"drift_rate": np.ones_like(uy)}
        if solution.latent is None:
            return nothing
        cycles = half_cycles(solution.system, soil)
        drift = drift_of(solution.system, solution.latent, cycles)
        values = uy * np.sqrt(drift.variance), drift.rate, *drift.shares
        return {
            name: np.where(solution.still, nothing[name], value)
            for name, value in zip(OF_DRIFT, values, strict=True)
        }

    def _report(self, solution: _Solution, soil: Filter, uy: Array, ratio: Array) -> dict[str, Array]:
        system, elastic = solution.system, solution.still
        forcing = soil.forcing(system)
        own = own_covariance(system, forcing)
        displacement, velocity, z = np.sqrt(own.mu_mu), np.sqrt(own.v_v), np.sqrt(own.z_z)
        corr = own.v_z / (velocity * z)
        share = own.mu_z / (displacement * z)
        drift = self._drift(solution, soil, uy) if self.drifts else {}
        total = np.hypot(displacement, drift.get("drift_std", 0.0))
        physical = (own.mu_mu > 0) & (own.v_v > 0)
        for extent in (total, velocity, total / uy):
            physical &= np.isfinite(extent)
        z, corr = np.where(elastic, displacement, z), np.where(elastic, 0, corr)
        c_eq, k_eq = np.where(elastic, -1, system.slip - 1), np.where(elastic, 0, system.relaxation)
        correlated = np.maximum(np.abs(corr), np.abs(share))
        physical &= elastic | ((z > 0) & (correlated <= 1 + ROUNDING))
        status = np.where(elastic, labels.ELASTIC_LIMIT, labels.CONVERGED)
        status = np.where(physical, status, labels.NOT_PHYSICAL)
        lost = np.where(ratio > STRONG, labels.TOO_STRONG, labels.NOT_CONVERGED)
        status = np.where(solution.converged, status, lost)
        values = {
            "displacement_std": total,
            "velocity_std": velocity,
            "ductility_std": total / uy,
            "z_std": z / uy,
            "velocity_z_corr": corr,
            "c_eq": c_eq,
            "k_eq": k_eq,
            "yield_displacement": uy,
            **dict(zip(INTERNAL, (*system, *forcing), strict=True)),
            **drift,
        }
        usable = status < labels.NOT_CONVERGED
        shown = np.where(usable, np.array(list(values.values())), np.nan)
        return {
            **dict(zip(values, shown, strict=True)),
            STRENGTH_RATIO: ratio,
            "iterations": solution.iterations,
            "residual": solution.residual,
            "status": status.astype(np.int8),
        }


class _Batch(NamedTuple):
    """Yielding structures, with displacements in units of the yield displacement."""

    elastic: EquivalentSystem
    w: Array  # (n,) [rad/s]
    hardening: Array
    law: Array  # (m, n)
    one_solution: Array
    soil: Filter
    start: Array  # (2, n) standard deviations of u/uy and its rate, of the elastic structure


class _Solution(NamedTuple):
    """Equivalent systems of yielding structures, and how their iteration ended."""

    system: EquivalentSystem
    iterations: Array
    residual: Array
    converged: Array
    still: Array  # whether there is no slip, so that the elastic system is used
    latent: Array | None  # (3, n) std and correlation of the Gaussian variables (v, z~) of the closure

    @classmethod
    def elastic(cls, system: EquivalentSystem) -> _Solution:
        none = np.zeros(system.stiffness.size)
        return cls(system, none.astype(np.int32), none, none == 0, none == 0, None)
