"""Two bilinear structures by numbers alone, for programs in which each pair depends on the last one."""

from __future__ import annotations

import math
from typing import NamedTuple

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.correlation.tables import parameters_of
from stochlin.kernels.correlation.tiles import correlation
from stochlin.kernels.linearization.cells.elementary import atanh, log
from stochlin.kernels.linearization.cells.fixed_points import settle
from stochlin.kernels.linearization.cells.grounds import forcing_of
from stochlin.kernels.linearization.covariance import FAST, EquivalentSystem, Forcing, own_covariance
from stochlin.kernels.linearization.iteration import BOLD, CAREFUL

ELASTIC = 1e-18  # slip and relaxation over w below which the structure is taken as elastic
RTOL, ATOL, AT_FIRST, WITH_CARE = 1e-10, 1e-12, 30, 170  # stop rule of `linearize`, largest iterations


class PairResponse(NamedTuple):
    """Stationary response of two structures; NaN where the iteration did not converge."""

    rho: float  # correlation coefficient of the displacements [-]
    displacement_std_1: float  # [m]
    displacement_std_2: float  # [m]


def linearized_pair(
    first: tuple[float, float, float, float],
    second: tuple[float, float, float, float],
    ground: tuple[float, ...],
    *,
    clipped: bool = False,
) -> PairResponse:
    """Correlation and standard deviations of two bilinear structures by statistical linearization.

    The numbers are those of `stochlin.correlate`, without labels, checks and the known bias. A call
    takes some ten microseconds; the first one of a process takes longer, and the first one of all
    compiles for several seconds.

    Parameters
    ----------
    first, second : tuple of float
        Period [s], damping ratio [-], hardening ratio [-] and yield displacement [m] of a structure,
        all positive and finite. They are not checked.
    ground : tuple of float
        Intensity ``S0`` [m^2/s^3] of white noise; for Kanai-Tajimi ground then its period [s] and
        damping ratio [-]; for Clough-Penzien ground then those of the high-pass filter.
    clipped : bool
        Whether to take the clipped closure in place of the Gaussian one.

    Returns
    -------
    PairResponse
        ``rho`` [-], ``displacement_std_1`` [m] and ``displacement_std_2`` [m]; NaN where no solution was
        found in 200 iterations.

    Examples
    --------
    >>> from stochlin.kernels.correlation.bilinear_pair import linearized_pair
    >>> first, second = (1.0, 0.05, 0.05, 0.02), (0.7, 0.05, 0.05, 0.01)
    >>> found = linearized_pair(first, second, (0.01, 2.0, 0.3))
    >>> round(found.rho, 6)
    0.886732
    """
    intensity, *filters = ground
    rows = [intensity]
    for period, damping in zip(filters[::2], filters[1::2], strict=True):
        w = 2 * math.pi / period
        rows += [w * w, 2 * damping * w]
    soil = (*rows, *(1.0,) * (5 - len(rows)))
    return PairResponse(*_pair(first, second, soil, len(filters) // 2, clipped))


@entry
def _pair(first, second, ground, oscillators, clipped):
    """`linearized_pair` on a ground as in `cells.grounds.forcing_of`."""
    parameters_1, parameters_2 = (
        _structure(first, ground, oscillators, clipped),
        _structure(second, ground, oscillators, clipped),
    )
    stiff, soft = (parameters_1, parameters_2) if first[0] <= second[0] else (parameters_2, parameters_1)
    return correlation(stiff, soft, 0, 1), parameters_1[-1], parameters_2[-1]


@compiled
def _structure(structure, ground, oscillators, clipped):
    """`tables.parameters_of` of a structure, the last of which is its standard deviation."""
    period, damping, hardening, uy = structure
    w = 2 * math.pi / period
    nothing = 0.0 * w
    elastic = EquivalentSystem(w * w, 2 * damping * w, nothing, nothing, w)
    _, own = _response(elastic, ground, oscillators)
    std, rate = math.sqrt(own.mu_mu) / uy, math.sqrt(own.v_v) / uy
    start = log(rate), min(0.0, log(std)), atanh(0.1)
    cell = elastic.stiffness, elastic.damping, (1 - hardening) * elastic.stiffness, 0.0
    scaled = ground[0] / (uy * uy), ground[1], ground[2], ground[3], ground[4]
    problem = clipped, oscillators, cell, scaled, start
    solution, _ = settle(*problem, BOLD, RTOL, ATOL, AT_FIRST)
    if solution[6] == 0:
        solution, _ = settle(*problem, CAREFUL, RTOL, ATOL, WITH_CARE)
    slip, relaxation = solution[0], solution[1]
    if solution[6] == 0:
        slip = relaxation = math.nan * w
    still = abs(slip) < ELASTIC and abs(relaxation) < ELASTIC * w
    system = elastic if still else EquivalentSystem(cell[0], cell[1], cell[2], slip, relaxation)
    forcing, own = _response(system, ground, oscillators)
    fast = system.relaxation > FAST * w
    chosen = (
        (cell[0] - system.coupling, -system.coupling, 0.0, 1 - system.slip, forcing.mu - forcing.slip)
        if fast
        else (cell[0], system.coupling, system.relaxation, system.slip, forcing.slip)
    )
    return parameters_of(system, forcing, chosen, math.sqrt(own.mu_mu))


@called_often
def _response(system, ground, oscillators):
    """Forcing of a linear system and its stationary covariances."""
    terms, _, _ = forcing_of(oscillators, system, ground)
    forcing = Forcing(terms[0], terms[1], terms[2])
    return forcing, own_covariance(system, forcing)


called_often(parameters_of)
