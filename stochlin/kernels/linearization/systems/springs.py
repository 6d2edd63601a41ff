"""Systems of springs that yield, with their hysteresis laws: what the iteration linearizes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.systems import System
from stochlin.kernels.linearization.filters import Filter
from stochlin.kernels.linearization.gaussian import Closure

Function = Callable[[Array, Array], Array]  # of moments (3, n) and parameters (p, n)


class SpringLaw(NamedTuple):
    """Hysteresis law of some of the springs that yield."""

    springs: Array  # (i,) their numbers among the springs that yield
    parameters: Array  # (p, c, i)
    closure: Closure
    states: int = 0  # number of further states, whose means are parameters after those of the law
    mean_rates: Function | None = None  # the rates of these means

    def at_means(self, means: Array) -> SpringLaw:
        """The law in which its further states have these means (states or more, c, m)."""
        of_springs = means[: self.states, :, self.springs]
        return self._replace(parameters=np.concatenate([self.parameters, of_springs]))

    def evaluated(self, function: Function, moments: Array) -> Array:
        """Results (r, c, i) of a function of moments and parameters, for moments (3, c, m)."""
        of_springs = moments[..., self.springs]
        flat = function(
            of_springs.reshape(3, -1),
            self.parameters.reshape(len(self.parameters), of_springs[0].size),
        )
        return flat.reshape(-1, *of_springs.shape[1:])


def coefficients_of(laws: Sequence[SpringLaw], moments: Array) -> Array:
    """``1 + c_eq`` and ``k_eq`` (2, c, m) by the closures, eqs. (9) and (10).

    ``moments`` (3, c, m) are ``sigma_v``, ``sigma_z`` and their correlation.
    """
    coefficients = np.empty((2, *moments.shape[1:]))
    for law in laws:
        of_law = law.evaluated(lambda *cells: law.closure(*cells).coefficients, moments)  # noqa: B023
        coefficients[..., law.springs] = of_law
    return coefficients


class Springs(NamedTuple):
    """Structures, links and ground of c cells, with s springs of which m yield, and l links."""

    system: System  # the links are the last springs; without their dashpots
    soil: Filter  # the ground's
    yielding: Array  # (m,) numbers of the springs with a state z
    laws: Sequence[SpringLaw]
    dashpots: Array  # (c, l) constants of the dashpots of the links, N s/m for the exponent 1
    exponents: Array  # (c, l)
    power: Array  # (k,) numbers of the links that are linearized: exponents other than 1
    level: Array  # (c,) logarithm of the ratio of the shaking to the full one

    @property
    def strength(self) -> Array:
        """Extensions at yield (c, m) [m]."""
        return self.system.strength[:, self.yielding]

    @property
    def frequency(self) -> Array:
        """Frequencies (c, m) [rad/s] of the springs that yield, with the masses at their ends."""
        extensions = self.system.extensions[self.yielding]
        inverse_mass = (1 / self.system.mass) @ (extensions**2).T
        square: Array = self.system.elastic[:, self.yielding] * inverse_mass
        return np.sqrt(square)

    @property
    def links(self) -> slice:
        """Where the links stand among the springs."""
        springs = len(self.system.extensions)
        return slice(springs - self.dashpots.shape[1], springs)

    @property
    def linearized(self) -> Array:
        """Rows (k, n) that give the extensions of linearized dashpots."""
        return np.asarray(self.system.extensions[self.links][self.power])

    def at(self, cells: Array) -> Springs:
        """The cells with these numbers."""
        laws = [law._replace(parameters=law.parameters[:, cells]) for law in self.laws]
        dashpots = self.dashpots[cells]
        exponents = self.exponents[cells]
        level = self.level[cells]
        both = self.system.at(cells), self.soil.at(cells)
        return Springs(*both, self.yielding, laws, dashpots, exponents, self.power, level)
