"""Two bilinear structures by numbers alone, for programs in which each pair depends on the last."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.linearization import balance, covariance, grounds
from stochlin.kernels.linearization.balance import functions_of, interpolated_number, settled
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    motion_of,
    own_covariance,
    pair_covariance,
)
from stochlin.kernels.linearization.gaussian import gaussian
from stochlin.kernels.linearization.grounds import Soil, forcing_of

ELASTIC_SLIP = 1e-18  # slip and relaxation over w below which the structure is taken as elastic
LAST_STEP = 1e-10  # size of Newton's step at the end
NEWTON_STEPS = 200  # at most
# The formulas are compiled here, so that tables of them, which are in numpy, start without numba.
for _formula in (*covariance.FORMULAS, *grounds.FORMULAS, *balance.FORMULAS):
    called_often(_formula)


class PairResponse(NamedTuple):
    """Stationary response of two structures; NaN where the iteration did not converge."""

    rho: float  # correlation coefficient of the displacements [-]
    displacement_std_1: float  # [m]
    displacement_std_2: float  # [m]


def linearized_pair(
    first: tuple[float, float, float, float],
    second: tuple[float, float, float, float],
    ground: tuple[float, ...],
) -> PairResponse:
    """Correlation and standard deviations of two bilinear structures by statistical linearization.

    The numbers are those of `stochlin.correlate` with the Gaussian closure, without labels, checks
    and the known bias. A call takes some microseconds; the first one of all compiles for seconds.

    Parameters
    ----------
    first, second : tuple of float
        Period [s], damping ratio [-], hardening ratio [-] and yield displacement [m] of a
        structure, all positive and finite. They are not checked.
    ground : tuple of float
        Intensity ``S0`` [m^2/s^3] of white noise; for Kanai-Tajimi ground then its period [s] and
        damping ratio [-]; for Clough-Penzien ground then those of the high-pass filter.

    Returns
    -------
    PairResponse
        ``rho`` [-], ``displacement_std_1`` [m] and ``displacement_std_2`` [m]; NaN where no
        solution was converged in 200 steps.

    Examples
    --------
    >>> from stochlin.kernels.correlation.bilinear_pair import linearized_pair
    >>> first, second = (1.0, 0.05, 0.05, 0.02), (0.7, 0.05, 0.05, 0.01)
    >>> response = linearized_pair(first, second, (0.01, 2.0, 0.3))
    >>> round(response.rho, 6)
    0.886732
    """
    intensity, *filters = ground
    rows = [intensity]
    for period, damping in zip(filters[::2], filters[1::2], strict=True):
        w = 2 * math.pi / period
        rows += [w * w, 2 * damping * w]
    soil = (*rows, *(1.0,) * (5 - len(rows)))
    return PairResponse(*_pair(first, second, soil, len(filters) // 2, functions_of(gaussian)))


@entry
def _pair(first, second, ground, oscillators, functions):
    """`linearized_pair`; the ground is that of `grounds.Soil`."""
    motion_1, std_1 = _structure(first, ground, oscillators, functions)
    motion_2, std_2 = _structure(second, ground, oscillators, functions)
    variances = pair_covariance(motion_1, motion_1) * pair_covariance(motion_2, motion_2)
    return pair_covariance(motion_1, motion_2) / math.sqrt(variances), std_1, std_2


@compiled
def _structure(structure, ground, oscillators, functions):
    """Motion of a structure by its equivalent system, and its standard deviation."""
    period, damping, hardening, uy = structure
    w = 2 * math.pi / period
    soil = Soil(ground, oscillators)
    elastic = EquivalentSystem(w * w, 2 * damping * w, 0.0 * w, 0.0 * w, w)
    response = own_covariance(elastic, forcing_of(elastic, soil))
    v = math.log(math.sqrt(response.v_v) / uy)
    z = min(0.0, math.log(math.sqrt(response.mu_mu) / uy))
    over_uy = Soil((ground[0] / (uy * uy), ground[1], ground[2], ground[3], ground[4]), oscillators)
    yielding = w * w, 2 * damping * w, (1 - hardening) * w * w
    v, z, _, _, converged = settled(v, z, yielding, over_uy, functions, LAST_STEP, NEWTON_STEPS)
    p: Any = math.nan
    k: Any = math.nan
    if converged:
        log_slip, _ = interpolated_number(functions, 0, z)
        log_relaxation, _ = interpolated_number(functions, 1, z)
        p = math.exp(log_slip)
        k = math.exp(log_relaxation + v)
    system = EquivalentSystem(yielding[0], yielding[1], yielding[2], p, k)
    if p < ELASTIC_SLIP and k < ELASTIC_SLIP * w:
        system = elastic
    forcing = forcing_of(system, soil)
    return motion_of(system, forcing), math.sqrt(own_covariance(system, forcing).mu_mu)
