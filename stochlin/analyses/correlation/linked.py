"""Two linked structures: they act on one another, so that the full augmented system is solved."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.optimize
import xarray as xr

from stochlin.analyses.correlation.variables import VARIABLES
from stochlin.analyses.linearization.equivalent_systems import check_closure, solve_structure
from stochlin.analyses.linearization.state_space import covariance_by_slip, statespace
from stochlin.analyses.linearization.tolerance import USUAL
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.cells import over_cells
from stochlin.kernels.basics.arrays import Array
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.links import Link, check_linked
from stochlin.models.parameters import expect
from stochlin.models.structures import DRIFT, NARROW_BAND

MISMATCH = 1e-8  # of logarithms of standard deviations and of the correlation
# Closures of a structure alone, and why they are no closures of the augmented system.
LACKING = {NARROW_BAND: "has no z", DRIFT: "adds the drift of a structure that stands alone"}


def correlate_linked(
    first: Bilinear,
    second: Bilinear,
    ground: Ground,
    link: Link,
    *,
    closure: str = "gaussian",
) -> xr.Dataset:
    """Response and correlation of two linked structures by statistical linearization.

    The coefficients of both structures and the covariance of the augmented system, whose matrix
    has the link in it, are found together.

    Parameters
    ----------
    first, second : Bilinear
        With a mass. Strength by ``reduction_factor`` refers to the structure standing alone.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
    link : Link
        All parameters but the masses broadcast by dimension name.
    closure : str
        ``"gaussian"`` or ``"clipped"``, as in `linearize`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``rho`` [-], ``displacement_std_1`` and ``_2`` [m],
        ``relative_displacement_std`` [m]: of ``u_1 - u_2``, ``velocity_std_1`` and ``_2`` [m/s],
        ``ductility_std_1`` and ``_2`` [-], ``link_force_std`` [N], ``c_eq_1``, ``c_eq_2`` [-],
        ``k_eq_1``, ``k_eq_2`` [1/s], ``status``.

    Raises
    ------
    ValueError, TypeError
        If a mass is missing, a structure is not bilinear, or the closure is unknown.
    ArithmeticError
        If a single case is not solved; in a table its cell is NaN.

    Notes
    -----
    Linearization is as far off here as elsewhere where structures yield: `simulate` with ``link``
    gives the truth.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), links between buildings; Westermo, B. D. (1989), Earthquake
    Eng. Struct. Dyn. 18.

    Examples
    --------
    >>> import stochlin as sl
    >>> pair = [sl.Bilinear(T, 0.05, mass=1e6) for T in (0.6, 1.0)]
    >>> ground = sl.WhiteNoise(0.01)
    >>> tied = sl.correlate_linked(*pair, ground, sl.Link(stiffness=1e10))
    >>> round(float(tied.rho), 4), float(tied.status)
    (1.0, 1.0)
    """
    expect(ground, Ground, "ground")
    expect(link, Link, "link")
    check_linked(first, second)
    for structure in (first, second):
        check_closure(structure, closure)
    if closure in LACKING:
        raise ValueError(
            f"closure = {closure!r} {LACKING[closure]}; allowed for linked structures: gaussian, clipped"
        )

    def of_cell(first: Bilinear, second: Bilinear, ground: Ground, link: Link) -> xr.Dataset:
        alone = [solve_structure(s, ground, closure, USUAL) for s in (first, second)]
        return _Linked((first, second), ground, link, closure, alone).solve()

    models = {"first": first, "second": second, "ground": ground, "link": link}
    table = labels.label(over_cells(of_cell, models), VARIABLES)
    labels.raise_if_lone_failure(table, f"correlate_linked({first.describe()}, {second.describe()})")
    if first.yields or second.yields:
        table = table.assign_attrs(comment=labels.CAUTION_SIGMA)
    return labels.with_run_information(
        table,
        f"Correlation of two linked structures by linearization, {ground.name} ground",
        f"correlate_linked(closure={closure!r})",
        models,
    )


class _Linked(NamedTuple):
    """One linked pair."""

    structures: tuple[Bilinear, Bilinear]
    ground: Ground
    link: Link
    closure: str
    alone: list[xr.Dataset]  # solved standing alone

    def solve(self) -> xr.Dataset:
        """Find the moments that a closure assumes and that it leads to: log, log and atanh."""
        lost = max(int(side.status) for side in self.alone)
        if lost >= labels.NOT_CONVERGED:
            return self._table(None, [], lost)
        yields = [n for n, structure in enumerate(self.structures) if structure.yields]
        if not yields:
            return self._table(np.empty(0), yields)
        start = np.concatenate([self._latent(n) for n in yields])
        found = scipy.optimize.root(self._mismatch, start, args=(yields,), tol=1e-12)
        if not np.abs(found.fun).max() < MISMATCH:
            return self._table(None, yields, labels.NOT_CONVERGED)
        return self._table(found.x, yields)

    def _latent(self, n: int) -> Array:
        """Where to begin: as the structure moves alone, or linked if it hardly yields alone."""
        side = self.alone[n]
        if int(side.status) == labels.CONVERGED:
            v = side.velocity_std / side.yield_displacement
            return np.array([np.log(v), np.log(side.z_std), np.arctanh(side.velocity_z_corr)])
        x = self._moments([-1.0, -1.0], [0.0, 0.0])
        uy = float(side.yield_displacement)
        v, u = (float(np.sqrt(x.loc[name, name])) / uy for name in (f"v_{n + 1}", f"u_{n + 1}"))
        return np.array([np.log(v), np.log(min(u, 1.0)), 0.0])

    def _coefficients(
        self, unknown: Array, yields: list[int]
    ) -> tuple[list[float], list[float], list[Array]]:
        """``c_eq`` and ``k_eq`` of both, and of those that yield the covariances of v and z assumed."""
        c_eq, k_eq, covariances = [-1.0, -1.0], [0.0, 0.0], []
        for n, (log_v, log_z, atanh_r) in zip(yields, unknown.reshape(-1, 3), strict=True):
            latent = np.array([[np.exp(log_v)], [np.exp(log_z)], [np.tanh(atanh_r)]])
            value = self.structures[n].closure(self.closure)(latent, np.empty((0, 1)))
            slip, k_eq[n] = (float(coefficient) for (coefficient,) in value.coefficients)
            c_eq[n] = slip - 1
            covariances.append(value.covariance[:, 0])
        return c_eq, k_eq, covariances

    def _moments(self, c_eq: list[float], k_eq: list[float]) -> xr.DataArray:
        space = statespace(self.structures, self.ground, c_eq, k_eq, links=[self.link])
        return covariance_by_slip(space)

    def _mismatch(self, unknown: Array, yields: list[int]) -> Array:
        c_eq, k_eq, assumed = self._coefficients(unknown, yields)
        try:
            x = self._moments(c_eq, k_eq)
        except ArithmeticError:
            return np.full(unknown.size, 1e3)
        off = []
        for n, (av, az, avz) in zip(yields, assumed, strict=True):
            uy, v, z = float(self.alone[n].yield_displacement), f"v_{n + 1}", f"z_{n + 1}"
            z = z if z in x.state else f"u_{n + 1}"  # no slip at all
            vv, zz, vz = (float(x.loc[a, b]) / uy**2 for a, b in ((v, v), (z, z), (v, z)))
            off += [0.5 * np.log(vv / av), 0.5 * np.log(zz / az)]
            off.append(vz / np.sqrt(vv * zz) - avz / np.sqrt(av * az))
        return np.array(off)

    def _table(
        self, unknown: Array | None, yields: list[int], status: int = labels.CONVERGED
    ) -> xr.Dataset:
        """What is shown, NaN without a solution."""
        c_eq, k_eq = [-1.0, -1.0], [0.0, 0.0]
        if unknown is not None:
            c_eq, k_eq, _ = self._coefficients(unknown, yields)
            still = c_eq == [-1.0, -1.0] and k_eq == [0.0, 0.0]
            status = labels.ELASTIC_LIMIT if still else labels.CONVERGED
        x = self._moments(c_eq, k_eq)

        def std(weights: dict[str, float]) -> float:
            values = np.array(list(weights.values()))
            part = x.loc[list(weights), list(weights)].values
            return float(np.sqrt(max(values @ part @ values, 0.0)))

        k, c = (float(self.link.arrays()[name]) for name in ("stiffness", "damping_constant"))
        one, two = std({"u_1": 1}), std({"u_2": 1})
        table = {
            "rho": float(np.clip(float(x.loc["u_1", "u_2"]) / (one * two), -1, 1)),
            "relative_displacement_std": std({"u_1": 1, "u_2": -1}),
            "link_force_std": std({"u_1": k, "u_2": -k, "v_1": c, "v_2": -c}),
        }
        for n, sigma in enumerate((one, two)):
            uy = float(self.alone[n].yield_displacement)
            table |= {
                f"displacement_std_{n + 1}": sigma,
                f"velocity_std_{n + 1}": std({f"v_{n + 1}": 1}),
                f"ductility_std_{n + 1}": sigma / uy,
                f"c_eq_{n + 1}": c_eq[n],
                f"k_eq_{n + 1}": k_eq[n],
            }
        if unknown is None:
            table = dict.fromkeys(table, np.nan)
        return xr.Dataset({**table, "status": np.int8(status)})
