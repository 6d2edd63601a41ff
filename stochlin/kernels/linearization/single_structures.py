"""Steps of the iteration for single structures, whose stationary covariances have closed forms.

On grounds of at most two oscillators, with the closures of the bilinear law, all steps of a cell are
made in compiled code. For other closures and grounds, the closure and the forcing are those of arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.compiled import call_for
from stochlin.kernels.basics.parallel import in_ranges
from stochlin.kernels.linearization.cells.fixed_points import FOUND, OF_GROUND, settle_cells
from stochlin.kernels.linearization.cells.steps import StepControl, advance_cells
from stochlin.kernels.linearization.covariance import EquivalentSystem
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure, clipped, gaussian
from stochlin.kernels.linearization.iteration import FixedPoint, State, iterate, solve

CLIPPED: dict[Closure, bool] = {gaussian: False, clipped: True}  # closures that `cells.fixed_points` has
CHUNK = 2048  # cells solved together: the temporary arrays of a step then stay in the cache


class SingleStructures(NamedTuple):
    """Single structures on their grounds: a `Problem` of the iteration."""

    structure: Array  # (3, n) stiffness, damping and coupling of the equivalent system
    law: Array  # (m, n) parameters of the law, for the closure
    ground: Filter
    level: Array  # (n,): logarithm of the ratio of the shaking to the full one, as standard deviations
    closure: Closure
    rtol: float
    atol: float

    @property
    def springs(self) -> int:
        """One."""
        return 1

    @property
    def size(self) -> int:
        """Two, for ``1 + c_e`` and ``k_e``."""
        return 2

    def at(self, cells: Array | slice) -> SingleStructures:
        """The cells with these numbers."""
        if self.level[cells].size == self.level.size:  # the selection is all cells
            return self
        structure, law = (
            rows[:, cells] if isinstance(cells, slice) else rows.take(cells, axis=1) for rows in self[:2]
        )
        return self._replace(
            structure=structure, law=law, ground=self.ground.at(cells), level=self.level[cells]
        )

    def shaken(self, level: Array) -> SingleStructures:
        """The cells under other shaking."""
        return self._replace(level=level)

    def settle(self, unknowns: Array, most: int, pace: StepControl) -> FixedPoint:
        """All iterations of a cell in compiled code, if there is any; a few cells in plain Python."""
        if self.closure not in CLIPPED or self.ground.oscillators is None:
            return iterate(self, unknowns, most, pace)
        n, soil = unknowns.shape[1], (self.ground.intensity, *self.ground.oscillators)
        cells, ground = np.array([*self.structure, self.level]), np.ones((OF_GROUND, n))
        for row, entry in enumerate(soil):
            ground[row] = entry
        results, iterations = np.empty((FOUND, n)), np.zeros(n, np.int32)
        kind = CLIPPED[self.closure], len(soil) // 2
        rule = pace, float(self.rtol), float(self.atol), most
        call_for(settle_cells, n, (cells, ground, unknowns), *kind, *rule, results, iterations)
        return FixedPoint(results[2:5], results[:2], iterations, results[5], results[6] > 0)

    def advance(self, state: State, pace: StepControl) -> State:
        """One step with a closure or a ground that is not compiled."""
        latent = moments_of(state.unknowns)
        value = self.closure(latent, self.law)
        system = EquivalentSystem(*self.structure, *value.coefficients)
        forcings = self.ground.forcing_and_slopes(system)
        values = np.concatenate([field.reshape(-1, latent.shape[1]) for field in value])
        cells = np.array([*self.structure, self.level])
        rows = np.vstack(state)
        advance_cells(cells, latent, values, forcings, rows, pace, self.rtol, self.atol)
        return State(rows[:3], rows[3], rows[4:7], rows[7], rows[8])

    def coefficients(self, unknowns: Array) -> Array:
        """``1 + c_e`` and ``k_e`` (2, n)."""
        return self.closure(moments_of(unknowns), self.law).coefficients


def solve_on_all_cores(
    problem: SingleStructures, start: Array, one_solution: Array, max_iterations: int
) -> FixedPoint:
    """`solve` in chunks, on all cores.

    ``start`` (3, n) are the moments ``sv, sz, r`` of the elastic response. A cell has converged when
    ``|dy| <= atol + rtol |y|`` for each of its moments ``y``; ``atol`` applies to the correlation only,
    since the other two are positive scales.
    """
    elastic = np.empty_like(start)
    np.log(start[:2], out=elastic[:2])
    np.arctanh(start[2], out=elastic[2])

    @np.errstate(all="ignore")  # an iterate may belong to an unstable system, without moments
    def part(cells: slice) -> FixedPoint:
        return solve(problem.at(cells), elastic[:, cells], one_solution[cells], max_iterations)

    parts = in_ranges(part, start.shape[1], CHUNK)
    return FixedPoint(*map(np.hstack, zip(*parts, strict=True)))


def moments_of(unknowns: Array) -> Array:
    """The moments ``sv, sz, r`` (3, n) of the unknowns."""
    moments = np.exp(unknowns)
    np.tanh(unknowns[2], out=moments[2])
    return moments
