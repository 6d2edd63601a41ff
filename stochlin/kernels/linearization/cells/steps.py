"""One step of `linearization.iteration` for a single structure, compiled for many of them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from stochlin.kernels.basics.compiled import called_often, entry
from stochlin.kernels.basics.small_systems import solve_3x3
from stochlin.kernels.linearization.cells.elementary import atanh, exp, log
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    characteristic,
    hurwitz,
    own_covariance,
    stable,
)

STATE = 9  # numbers of the state of a cell
LARGEST_STEP = 1.0  # largest step in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05  # smallest pseudo-time step
LARGEST_MISMATCH = 1e-6  # largest norm of the mismatch of a converged cell


class StepControl(NamedTuple):
    """Control of the pseudo-time step: its first value and how it changes, see `next_delta`."""

    first: float  # first pseudo-time step
    restart: float  # upper bound after a rise of the mismatch
    shorter: float  # factor after a rise of the mismatch
    longer: float  # factor after a fall, besides the ratio of the mismatches
    longest: float  # largest factor after a fall


@called_often
def moments_of(state):
    """Latent moments ``sv, sz, r`` at the unknowns of a state."""
    base, _, step, _, _ = state
    return exp(base[0] + step[0]), exp(base[1] + step[1]), math.tanh(base[2] + step[2])


@called_often
def advance(cell, moments, value, forcings, state, pace, rtol, atol):
    """The next state of a cell after one evaluation of closure and forcing at its unknowns.

    ``cell`` has stiffness, damping, coupling and level of shaking, ``value`` is what the closure found.
    If the unknowns have no stationary response, a smaller step from the last valid ones is tried.
    """
    base, before, old, last, _ = state
    y = base[0] + old[0], base[1] + old[1], base[2] + old[2]
    off, columns = _mismatch(cell, moments, value, forcings)
    norm = math.sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2])
    total = norm
    for column in columns:
        total += column[0] + column[1] + column[2]
    valid = math.isfinite(total)
    now = norm if valid else math.inf
    delta = next_delta(last, before, now, pace)
    new = _newton_step(columns, off, 1 / delta)
    # If not stationary: try a quarter of the step; before the first valid iterate, a more elastic start.
    untried = math.isinf(before)
    nearer = old[0], old[1] - 1.0, old[2] - 0.5 * y[2]
    back = (
        nearer[0] if untried else 0.25 * old[0],
        nearer[1] if untried else 0.25 * old[1],
        nearer[2] if untried else 0.25 * old[2],
    )
    # Convergence is judged by the Newton step, since a damped step is also small if delta is small.
    change, r = _newton_step(columns, off, 0.0), moments[2]
    of_r = (1 - r * r) * rtol / (atol + rtol * abs(r))
    still = (abs(change[0]) <= rtol) & (abs(change[1]) <= rtol) & (abs(change[2]) * of_r <= rtol)
    return (
        _either(valid, y, base),
        norm if valid else before,
        _either(valid, new, back),
        delta,
        1.0 if valid & (norm <= LARGEST_MISMATCH) & still else 0.0,
    )


@called_often
def _either(first, x, y):
    """One triple of numbers or the other."""
    return (
        x[0] if first else y[0], x[1] if first else y[1], x[2] if first else y[2]
    )  # fmt: skip


@called_often
def _mismatch(cell, moments, value, forcings):
    """Mismatch of the unknowns, and the three columns of its Jacobian."""
    stiffness, damping, coupling, level = cell
    coefficients, of_slip, of_relaxation, (vv, zz, vz), by_latent = value
    system = stiffness, damping, coupling, coefficients[0], coefficients[1]
    (v_v, z_z, corr), by_slip, by_relaxation = _respond(system, forcings)
    root = math.sqrt(vv * zz)
    r = vz / root
    off = (
        0.5 * log(v_v / vv) + level,
        0.5 * log(z_z / zz) + level,
        atanh((corr - r) / (1 - corr * r)),
    )
    sv, sz, own = moments
    of_vv, of_zz, of_vz = by_latent
    assumed = vv, zz, root, r
    response = by_slip, by_relaxation
    return off, (
        _column((of_slip[0], of_relaxation[0]), (of_vv[0], of_zz[0], of_vz[0]), response, assumed, sv),
        _column((of_slip[1], of_relaxation[1]), (of_vv[1], of_zz[1], of_vz[1]), response, assumed, sz),
        _column(
            (of_slip[2], of_relaxation[2]),
            (of_vv[2], of_zz[2], of_vz[2]),
            response,
            assumed,
            1 - own * own,
        ),
    )


@called_often
def _respond(system, forcings):
    """Variances and correlation of a linear system's response, and the slopes of its unknowns.

    The slopes are those by slip and by relaxation. All is NaN for systems that are not stable. This is
    checked by the criterion of Routh and Hurwitz, since on filtered ground the formulas can also give a
    valid covariance there.
    """
    forcing, by_slip, by_relaxation = forcings
    w2, d, h, p, k = system
    own = own_covariance(EquivalentSystem(w2, d, h, p, k), Forcing(forcing[0], forcing[1], forcing[2]))
    well = stable(w2, d, h, p, k) & (own.mu_mu > 0)
    vv, zz = own.v_v if well else math.nan, own.z_z
    root = math.sqrt(vv * zz)
    corr = own.v_z / root
    of_slip = _slope(system, own, forcing, by_slip, 1.0, 0.0)
    of_relaxation = _slope(system, own, forcing, by_relaxation, 0.0, 1.0)
    return (
        (vv, zz, corr),
        slope_of_unknowns(vv, zz, root, corr, of_slip),
        slope_of_unknowns(vv, zz, root, corr, of_relaxation),
    )


@called_often
def _slope(system, own, forcing, slope, dp, dk):
    """Derivatives of Var v, Var z and Cov(v, z) of `own_covariance` by slip or by relaxation.

    ``slope`` is the derivative of the forcing; ``dp`` is 1 for that by slip, ``dk`` is 1 for relaxation.
    """
    w2, d, h, p, k = system
    f_mu, f_v, f_y = slope
    c = 1 - p
    steeper = dk * (d * (d + 2 * k) + c * h) - dp * h * (d + k)
    mu_z = (c * f_v - dp * forcing[1] + d * (f_mu - f_y) - own.mu_z * steeper) / hurwitz(w2, d, h, p, k)
    v_z = k * mu_z + dk * own.mu_z
    return (f_v - h * v_z) / d, c * mu_z - dp * own.mu_z, v_z


@called_often
def _column(of_coefficients, of_assumed, response, assumed, scale):
    """A column of the Jacobian: by the unknown whose latent moment changes by ``scale``.

    ``of_coefficients`` and ``of_assumed`` are derivatives of the closure's coefficients and covariance.
    """
    (slip, relaxation), (by_slip, by_relaxation) = of_coefficients, response
    less = slope_of_unknowns(assumed[0], assumed[1], assumed[2], assumed[3], of_assumed)
    return (
        (by_slip[0] * slip + by_relaxation[0] * relaxation - less[0]) * scale,
        (by_slip[1] * slip + by_relaxation[1] * relaxation - less[1]) * scale,
        (by_slip[2] * slip + by_relaxation[2] * relaxation - less[2]) * scale,
    )


@called_often
def _newton_step(columns, mismatch, damping):
    """``(damping - J)^-1 F``, limited to `LARGEST_STEP`; Newton's step for ``damping = 0``."""
    (a, d, g), (b, e, h), (c, f, i) = columns
    matrix = (damping - a, -b, -c), (-d, damping - e, -f), (-g, -h, damping - i)
    step_1, step_2, step_3 = solve_3x3(matrix, mismatch)
    shorter = max(1.0, max(abs(step_1), abs(step_2), abs(step_3)) / LARGEST_STEP)
    return step_1 / shorter, step_2 / shorter, step_3 / shorter


def slope_of_unknowns(vv: Any, zz: Any, root: Any, r: Any, slope: Any) -> Any:
    """Derivative of ``(log sv, log sz, atanh r)`` if ``(vv, zz, vz)`` changes by ``slope``.

    ``root`` is the square root of ``vv zz``.
    """
    of_v, of_z = 0.5 * slope[0] / vv, 0.5 * slope[1] / zz
    return of_v, of_z, (slope[2] / root - r * (of_v + of_z)) / (1 - r * r)


def next_delta(delta: Any, before: Any, now: Any, pace: StepControl) -> Any:
    """Next pseudo-time step, by switched evolution relaxation: longer if the mismatch has fallen."""
    ratio = 1.0 if math.isinf(before) or now == 0 else before / now
    shorter = max(pace.shorter * min(delta, pace.restart), LEAST_DELTA)
    return shorter if ratio < 1 else delta * min(pace.longer * ratio, pace.longest)


for _ in (characteristic, hurwitz, stable, own_covariance, solve_3x3, slope_of_unknowns, next_delta):
    called_often(_)


@entry
def advance_cells(cells, latent, values, forcings, state, pace, rtol, atol):
    """Update the ``state`` (STATE, n) of cells whose closure or ground is not compiled.

    ``cells`` (4, n) and ``latent`` (3, n) are as in `advance`, ``values`` (20, n) are those of
    `ClosureValue`, and ``forcings`` (9, n) the forcing with its derivatives. The rows of a state are the
    last valid iterate (3), the norm of its mismatch, the step from it (3), the pseudo-time step, and 1
    once it has converged.
    """
    for n in range(state.shape[1]):
        before = _triple(state, 0, n), state[3, n], _triple(state, 4, n), state[7, n], state[8, n]
        value = (
            (values[0, n], values[1, n]), _triple(values, 2, n), _triple(values, 5, n),
            _triple(values, 8, n),
            (_triple(values, 11, n), _triple(values, 14, n), _triple(values, 17, n)),
        )  # fmt: skip
        forcing = _triple(forcings, 0, n), _triple(forcings, 3, n), _triple(forcings, 6, n)
        cell, moments = (*_triple(cells, 0, n), cells[3, n]), _triple(latent, 0, n)
        base, norm, step, delta, done = advance(cell, moments, value, forcing, before, pace, rtol, atol)
        numbers = *base, norm, *step, delta, done
        for row in range(STATE):
            state[row, n] = numbers[row]


@called_often
def _triple(rows, first, n):
    """The numbers of a cell in three rows."""
    return rows[first, n], rows[first + 1, n], rows[first + 2, n]
