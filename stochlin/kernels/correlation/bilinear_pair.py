"""Two bilinear structures by numbers alone, for programs in which each pair depends on the last one.

The formulas are those of tables; they are compiled here for numbers.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from stochlin.kernels.basics.compiled import called_often, compiled, entry
from stochlin.kernels.correlation import on_numbers  # noqa: F401  # which compiles formulas for numbers
from stochlin.kernels.linearization import covariance, grounds
from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing, own_covariance
from stochlin.kernels.linearization.gaussian import clipped_values, gaussian_values
from stochlin.kernels.linearization.grounds import clough_penzien, kanai_tajimi, white_noise
from stochlin.kernels.linearization.single_structures import BOLD, CAREFUL, advance

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
    """`linearized_pair`; the ground is that of `grounds.clough_penzien`, filled up."""
    system_1, forcing_1, std_1 = _structure(first, ground, oscillators, clipped)
    system_2, forcing_2, std_2 = _structure(second, ground, oscillators, clipped)
    if first[0] <= second[0]:  # the stiffer structure first, as in `covariance.pair_covariance`
        joint, _, _ = covariance.pair_row(system_1, forcing_1, system_2, forcing_2)
    else:
        joint, _, _ = covariance.pair_row(system_2, forcing_2, system_1, forcing_1)
    return joint / (std_1 * std_2), std_1, std_2


@compiled
def _structure(structure, ground, oscillators, clipped):
    """Equivalent system of a structure, its forcing, and its standard deviation."""
    period, damping, hardening, uy = structure
    w = 2 * math.pi / period
    nothing = 0.0 * w
    elastic = EquivalentSystem(w * w, 2 * damping * w, nothing, nothing, w)
    _, own = _response(elastic, ground, oscillators)
    std, rate = math.sqrt(own.mu_mu) / uy, math.sqrt(own.v_v) / uy
    start = math.log(rate), min(0.0, math.log(std)), math.atanh(0.1)
    cell = elastic.stiffness, elastic.damping, (1 - hardening) * elastic.stiffness, 0.0
    scaled = ground[0] / (uy * uy), ground[1], ground[2], ground[3], ground[4]
    slip, relaxation, done = _settle(clipped, oscillators, cell, scaled, start, BOLD, AT_FIRST)
    if not done:
        slip, relaxation, done = _settle(clipped, oscillators, cell, scaled, start, CAREFUL, WITH_CARE)
    if not done:
        slip = relaxation = math.nan * w
    still = abs(slip) < ELASTIC and abs(relaxation) < ELASTIC * w
    system = elastic if still else EquivalentSystem(cell[0], cell[1], cell[2], slip, relaxation)
    forcing, own = _response(system, ground, oscillators)
    return system, forcing, math.sqrt(own.mu_mu)


@compiled
def _settle(clipped, oscillators, cell, ground, start, pace, most):
    """Coefficients of the fixed point from the unknowns ``start``, and whether it was reached."""
    state = (start, math.inf, (0.0, 0.0, 0.0), pace.first, 0.0)
    for _ in range(most + 1):
        base, step = state[0], state[2]
        moments = (
            math.exp(base[0] + step[0]), math.exp(base[1] + step[1]), math.tanh(base[2] + step[2])
        )  # fmt: skip
        value = clipped_values(moments) if clipped else gaussian_values(moments)
        if state[4] > 0:
            return value[0][0], value[0][1], True
        system = EquivalentSystem(cell[0], cell[1], cell[2], value[0][0], value[0][1])
        forcings = _forcings(system, ground, oscillators)
        state = advance(cell, moments, value, forcings, state, pace, RTOL, ATOL)
    return math.nan, math.nan, False


@called_often
def _forcings(system, ground, oscillators):
    """Forcing of an equivalent system, with its derivatives by slip and by relaxation."""
    soil = ground[0], ground[1], ground[2]
    if oscillators == 0:
        nothing = 0.0, 0.0, 0.0
        return white_noise(ground[0]), nothing, nothing
    if oscillators == 1:
        signal, rows = kanai_tajimi(system, soil)
        by_slip, by_relaxation = grounds.kanai_tajimi_slopes(system, soil, rows)
        return signal, by_slip, by_relaxation
    signal, rows, of_layer = clough_penzien(system, ground)
    by_slip, by_relaxation = grounds.clough_penzien_slopes(system, ground, rows, of_layer)
    return signal, by_slip, by_relaxation


@called_often
def _response(system, ground, oscillators):
    """Forcing of a linear system and its stationary covariances."""
    signal, _, _ = _forcings(system, ground, oscillators)
    forcing = Forcing(signal[0], signal[1], signal[2])
    return forcing, own_covariance(system, forcing)
