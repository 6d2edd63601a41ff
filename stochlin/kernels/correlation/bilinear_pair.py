"""Two bilinear structures by numbers alone, for programs in which each pair depends on the last one."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from numba.extending import overload

from stochlin.kernels.basics.arrays import choose, solve_3x3
from stochlin.kernels.basics.compiled import OFTEN, called_often, compiled, entry
from stochlin.kernels.linearization import covariance, grounds
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    motion_of,
    own_covariance,
    pair_covariance,
    stable,
)
from stochlin.kernels.linearization.gaussian import gaussian_of_numbers
from stochlin.kernels.linearization.grounds import clough_penzien, kanai_tajimi
from stochlin.kernels.linearization.single_structures import (
    ALONG,
    DAMPING,
)

ELASTIC = 1e-18  # slip and relaxation over w below which the structure is taken as elastic
CLOSE, MOST = 1e-10, 200  # Newton's step at the end, and the number of steps
# The formulas that take numbers and arrays, compiled for numbers.
for _formula in (solve_3x3, *covariance.FORMULAS, *grounds.FORMULAS):
    called_often(_formula)
compiled(gaussian_of_numbers)


@overload(choose, jit_options=OFTEN)
def _choose(condition, yes, no):
    return lambda condition, yes, no: yes if condition else no


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

    The numbers are those of `stochlin.correlate` with the Gaussian closure, without labels, checks and
    the known bias. A call takes some tens of microseconds; the first one of all compiles for seconds.

    Parameters
    ----------
    first, second : tuple of float
        Period [s], damping ratio [-], hardening ratio [-] and yield displacement [m] of a structure,
        all positive and finite. They are not checked.
    ground : tuple of float
        Intensity ``S0`` [m^2/s^3] of white noise; for Kanai-Tajimi ground then its period [s] and
        damping ratio [-]; for Clough-Penzien ground then those of the high-pass filter.

    Returns
    -------
    PairResponse
        ``rho`` [-], ``displacement_std_1`` [m] and ``displacement_std_2`` [m]; NaN where no solution was
        found in 200 steps.

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
    return PairResponse(*_pair(first, second, soil, len(filters) // 2))


@entry
def _pair(first, second, soil, filters):
    """`linearized_pair`; the ground is that of `grounds.clough_penzien`, filled up."""
    system_1, forcing_1, std_1 = _structure(first, soil, filters)
    system_2, forcing_2, std_2 = _structure(second, soil, filters)
    joint = pair_covariance(motion_of(system_1, forcing_1), motion_of(system_2, forcing_2))
    return joint / (std_1 * std_2), std_1, std_2


@compiled
def _structure(structure, soil, filters):
    """Equivalent system of a structure, its forcing, and its standard deviation."""
    period, damping, hardening, uy = structure
    w = 2 * math.pi / period
    elastic = EquivalentSystem(w * w, 2 * damping * w, 0.0 * w, 0.0 * w, w)
    own = own_covariance(elastic, _forcing(elastic, soil, filters))
    std, rate = math.sqrt(own.mu_mu) / uy, math.sqrt(own.v_v) / uy
    start = math.log(rate), min(0.0, math.log(std)), math.atanh(0.1)
    cell = w * w, 2 * damping * w, (1 - hardening) * w * w
    slip, relaxation = _of_closure(_settled(start, cell, soil, filters, uy))
    still = abs(slip) < ELASTIC and abs(relaxation) < ELASTIC * w
    system = elastic if still else EquivalentSystem(cell[0], cell[1], cell[2], slip, relaxation)
    forcing = _forcing(system, soil, filters)
    return system, forcing, math.sqrt(own_covariance(system, forcing).mu_mu)


@compiled
def _settled(start, cell, soil, filters, uy):
    """The unknowns of `single_structures` at the fixed point, by its method; NaN without one."""
    base, y, valid = start, start, False
    for _ in range(MOST):
        f = _mismatch(y, cell, soil, filters, uy)
        norm = math.sqrt(f[0] ** 2 + f[1] ** 2 + f[2] ** 2)
        if math.isfinite(norm):
            a = _slope((ALONG, 0.0, 0.0), y, f, cell, soil, filters, uy)
            b = _slope((0.0, ALONG, 0.0), y, f, cell, soil, filters, uy)
            c = _slope((0.0, 0.0, ALONG), y, f, cell, soil, filters, uy)
            step = _step(a, b, c, f, DAMPING * norm)
            base, y, valid = y, (y[0] + step[0], y[1] + step[1], y[2] + step[2]), True
            if max(norm, abs(step[0]), abs(step[1]), abs(step[2])) < CLOSE:
                return y
        elif valid:
            y = _nearer(base[0], y[0]), _nearer(base[1], y[1]), _nearer(base[2], y[2])
        else:
            y = y[0], y[1] - 1, 0.5 * y[2]
    return math.nan, math.nan, math.nan


@compiled
def _nearer(base, y):
    """An unknown after a quarter of the step from ``base`` to ``y``."""
    return base + 0.25 * (y - base)


@compiled
def _step(a, b, c, f, damping):
    """``(damping - J)^-1 f``, limited to 1; ``a``, ``b`` and ``c`` are the columns of ``J``."""
    (m, n, o), (p, q, r), (s, t, u) = a, b, c
    x, y, z = solve_3x3(((damping - m, -p, -s), (-n, damping - q, -t), (-o, -r, damping - u)), f)
    most = max(1.0, abs(x), abs(y), abs(z))
    return x / most, y / most, z / most


@compiled
def _slope(by, y, f, cell, soil, filters, uy):
    """A column of the Jacobian, by a difference."""
    there = _mismatch((y[0] + by[0], y[1] + by[1], y[2] + by[2]), cell, soil, filters, uy)
    return (there[0] - f[0]) / ALONG, (there[1] - f[1]) / ALONG, (there[2] - f[2]) / ALONG


@compiled
def _mismatch(y, cell, soil, filters, uy):
    """Unknowns of the stationary response with the coefficients at ``y``, less ``y``."""
    slip, relaxation = _of_closure(y)
    system = EquivalentSystem(cell[0], cell[1], cell[2], slip, relaxation)
    own = own_covariance(system, _forcing(system, soil, filters))
    if not (stable(*system) and own.mu_mu > 0 and own.z_z > 0):
        return math.nan, math.nan, math.nan
    r = own.v_z / math.sqrt(own.v_v * own.z_z)
    velocity, z = math.sqrt(own.v_v) / uy, math.sqrt(own.z_z) / uy
    return math.log(velocity) - y[0], math.log(z) - y[1], math.atanh(r) - y[2]


@compiled
def _of_closure(y):
    """Coefficients of the Gaussian closure for these unknowns."""
    return gaussian_of_numbers(math.exp(y[0]), math.exp(y[1]), math.tanh(y[2]))


@called_often
def _forcing(system, soil, filters):
    """Forcing of a linear system by the ground."""
    signal: Any = 0.0, math.pi * soil[0], 0.0  # of white noise
    if filters == 1:
        signal, _ = kanai_tajimi(system, (soil[0], soil[1], soil[2]))
    elif filters == 2:
        signal, _, _ = clough_penzien(system, soil)
    return Forcing(signal[0], signal[1], signal[2])
