"""Equivalent coefficients of all elements of systems, in all cells of a table."""

from __future__ import annotations

from collections.abc import Iterator
from functools import reduce
from operator import and_
from typing import NamedTuple

import numpy as np

from stochlin.analyses.linearization.equivalent_systems import ELASTIC, STRONG
from stochlin.analyses.linearization.systems.state_space import Equations
from stochlin.analyses.linearization.tolerance import Tolerance
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.linearization.gaussian import gaussian
from stochlin.kernels.linearization.systems.springs import Law, Springs, solve_springs
from stochlin.models.structures import GAUSSIAN


class SystemSolution(NamedTuple):
    """Result of the iteration in c cells; NaN in cells that failed."""

    c_eq: Array  # (c, e), of the elements; -1 if elastic
    k_eq: Array  # (c, e) [1/s]; 0 if elastic
    dashpots: Array  # (c, l) constants of the links, NaN for those with an exponent that do not move
    changes: Array  # (iterations, 2, c) of the covariance and of the coefficients
    iterations: Array  # (c,)
    status: Array  # (c,)

    def at(self, cell: int) -> SystemSolution:
        """The solution of one cell."""
        cells = slice(cell, cell + 1)
        c_eq, k_eq, dashpots, changes, iterations, status = self
        return SystemSolution(
            c_eq[cells],
            k_eq[cells],
            dashpots[cells],
            changes[..., cells],
            iterations[cells],
            status[cells],
        )


def solve_equations(
    equations: Equations, tolerance: Tolerance, relaxation: float | None = None
) -> SystemSolution:
    """The equivalent coefficients of all elements, by mixing, or by plain substitution if relaxed."""
    own, stacks = equations.yields, equations.arrangement.stacks
    problem = springs_of(equations, tolerance.rtol)
    power = problem.power
    weak = (s.law for s in stacks if not np.isposinf(s.system.strength).all())
    unique = (law.has_one_solution().to_numpy() for law in weak)
    one_solution = np.broadcast_to(reduce(and_, unique, np.array(True)), equations.cells)
    solved = solve_springs(problem, one_solution, tolerance.max_iterations, relaxation)
    slip, k, linear = solved.linear
    still = (np.abs(slip) < ELASTIC) & (np.abs(k) < ELASTIC * problem.mechanics.frequency)
    c_eq, k_eq = np.full((equations.cells, own.size), -1.0), np.zeros((equations.cells, own.size))
    c_eq[:, own], k_eq[:, own] = np.where(still, -1.0, slip - 1), np.where(still, 0.0, k)
    linear[:, power] = np.where(solved.idle, np.nan, linear[:, power])
    failed = np.where(solved.demand > STRONG, labels.TOO_STRONG, labels.NOT_CONVERGED)
    failed = np.where(np.isnan(solved.demand), labels.NOT_PHYSICAL, failed)
    calm = np.where(still.all(axis=1), labels.ELASTIC_LIMIT, labels.CONVERGED)
    status = np.where(solved.converged, calm, failed).astype(np.int8)
    return SystemSolution(c_eq, k_eq, linear, solved.changes, solved.rounds, status)


def springs_of(equations: Equations, rtol: float) -> Springs:
    """What the iteration takes: springs that yield with their laws, and dashpots that it linearizes."""
    laws = list(_laws(equations))
    links = equations.dashpots, equations.exponents
    return Springs.of(equations.mechanics(equations.yields), laws, *links, rtol)


def _laws(equations: Equations) -> Iterator[Law]:
    """Closures of the laws, each with the numbers of its yielding elements and their parameters."""
    begin, cells = 0, equations.cells
    for stack in equations.arrangement.stacks:
        yields = ~np.isposinf(np.atleast_2d(stack.system.strength)).all(axis=0)
        mine = begin + np.arange(yields.sum())
        if mine.size:
            values = stack.law_parameters[..., yields, :]
            wide = np.broadcast_to(values, (cells, mine.size, values.shape[-1]))
            yield Law(mine, stack.law.closure(GAUSSIAN), np.moveaxis(wide, -1, 0))
        begin += mine.size
    links = np.arange(begin, equations.yields.sum())
    if links.size:
        yield Law(links, gaussian, np.empty((0, cells, links.size)))
