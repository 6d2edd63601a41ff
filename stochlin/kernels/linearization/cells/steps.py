"""One step towards the fixed point, for each cell of a chunk; `fixed_point` tells what is sought."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from stochlin.kernels.basics.compiled import called_often, entry, shared
from stochlin.kernels.basics.small_systems import solve_3x3
from stochlin.kernels.linearization.cells.grounds import FORCINGS, SYSTEM
from stochlin.kernels.linearization.cells.tiles import LANES, fill, load, read3, store, write3
from stochlin.kernels.linearization.covariance import (
    EquivalentSystem,
    Forcing,
    characteristic,
    hurwitz,
    own_covariance,
    stable,
)

RESPONSE = 10  # rows: Var v, Var z, Cov(v, z) and corr(v, z), and of the first three the slopes
STATE = (
    9  # rows: last valid iterate, its mismatch, the step from there, the pseudo-time step, whether done
)
BASE, NORM, STEP, DELTA, DONE = 0, 3, 4, 7, 8
RESPONDED = 27  # rows before the response, and all rows that are given
GIVEN = RESPONDED + RESPONSE
LARGEST_STEP = 1.0  # in log(sigma) and atanh(corr)
LEAST_DELTA = 0.05
LARGEST_MISMATCH = 1e-6  # of a converged cell, whatever its last step


class Pace(NamedTuple):
    """The steps of the relaxation: the pseudo-time step ``delta`` and how it changes."""

    first: float
    restart: float  # where to begin again after a rise of the mismatch
    shorter: float  # factors from one step to the next: after a rise,
    longer: float  # after a fall, times the ratio of the mismatches,
    longest: float  # and at most


@entry
def respond(system, forcings, found):
    """``found`` (RESPONSE, n) of linear systems (SYSTEM, n) with `FORCINGS`; NaN where not stationary.

    The moments do not tell: on coloured ground they may look like a covariance then.
    """
    given, made = np.empty((SYSTEM + FORCINGS) * LANES), np.empty(RESPONSE * LANES)
    fill(given, 1.0)
    for start in range(0, system.shape[1], LANES):
        load(system, start, given, 0)
        load(forcings, start, given, SYSTEM)
        for lane in range(LANES):
            w2, d, h = read3(given, 0, lane)
            p, k = given[3 * LANES + lane], given[4 * LANES + lane]
            f_mu, f_v, f_y = read3(given, SYSTEM, lane)
            own = own_covariance(EquivalentSystem(w2, d, h, p, k), Forcing(f_mu, f_v, f_y))
            well = stable(w2, d, h, p, k) & (own.mu_mu > 0)
            vv = own.v_v if well else np.nan
            corr = own.v_z / np.sqrt(vv * own.z_z)
            by_slip, by_relaxation = read3(given, SYSTEM + 3, lane), read3(given, SYSTEM + 6, lane)
            write3(made, 0, lane, (vv, own.z_z, own.v_z))
            made[3 * LANES + lane] = corr
            one = _slope((w2, d, h, p, k), own, (f_mu, f_v, f_y), by_slip, 1.0, 0.0)
            write3(made, 4, lane, one)
            one = _slope((w2, d, h, p, k), own, (f_mu, f_v, f_y), by_relaxation, 0.0, 1.0)
            write3(made, 7, lane, one)
        store(made, 0, found, start)


@called_often
def _slope(system, own, forcing, slope, dp, dk):
    """Of Var v, Var z and Cov(v, z), as `own_covariance` has them, by slip or by relaxation."""
    w2, d, h, p, k = system
    f_mu, f_v, f_y = slope
    c = 1 - p
    steeper = dk * (d * (d + 2 * k) + c * h) - dp * h * (d + k)
    mu_z = (c * f_v - dp * forcing[1] + d * (f_mu - f_y) - own.mu_z * steeper) / hurwitz(w2, d, h, p, k)
    v_z = k * mu_z + dk * own.mu_z
    return (f_v - h * v_z) / d, c * mu_z - dp * own.mu_z, v_z


@entry
def advance(
    unknowns, latent, mismatch, response, slopes, covariance, by_latent, state, pace, rtol, atol
):
    """``state`` (STATE, n) after one evaluation: a new step, or a part of the old one.

    Unknowns, latent moments and mismatch are (3, n), ``response`` of `respond`. Of the closure are the
    ``slopes`` of the coefficients (6, n), the covariance (3, n) and its derivatives (9, n).
    """
    given, here = np.empty(GIVEN * LANES), np.empty(STATE * LANES)
    for tile in (given, here):
        fill(tile, 1.0)
    for start in range(0, state.shape[1], LANES):
        row = 0
        for part in (unknowns, latent, mismatch, covariance, slopes, by_latent, response):
            load(part, start, given, row)
            row += part.shape[0]
        load(state, start, here, 0)
        for lane in range(LANES):
            _advance(given, here, lane, pace, rtol, atol)
        store(here, 0, state, start)


@called_often
def _advance(given, state, lane, pace, rtol, atol):
    y, (sv, sz, r), off = read3(given, 0, lane), read3(given, 3, lane), read3(given, 6, lane)
    columns = _jacobian(given, lane, (sv, sz, 1 - r * r))
    norm = np.sqrt(off[0] * off[0] + off[1] * off[1] + off[2] * off[2])
    total = norm
    for column in columns:
        total += column[0] + column[1] + column[2]
    valid = np.isfinite(total)
    before = state[NORM * LANES + lane]
    now = norm if valid else np.inf
    delta = next_delta(state[DELTA * LANES + lane], before, now, pace)
    new = _newton_step(columns, off, 1 / delta)
    # Not stationary: take back most of the step, or if there was none yet, start nearer to elastic.
    old, untried = read3(state, STEP, lane), np.isinf(before)
    nearer = old[0], old[1] - 1.0, old[2] - 0.5 * y[2]
    base = read3(state, BASE, lane)
    for n in range(3):
        back = nearer[n] if untried else 0.25 * old[n]
        state[(STEP + n) * LANES + lane] = new[n] if valid else back
        state[(BASE + n) * LANES + lane] = y[n] if valid else base[n]
    state[NORM * LANES + lane] = norm if valid else before
    state[DELTA * LANES + lane] = delta
    # Judged by the undamped step: a damped one is also small where delta is.
    change = _newton_step(columns, off, 0.0)
    of_r = (1 - r * r) * rtol / (atol + rtol * abs(r))
    still = (abs(change[0]) <= rtol) & (abs(change[1]) <= rtol) & (abs(change[2]) * of_r <= rtol)
    done = valid & (norm <= LARGEST_MISMATCH) & still
    state[DONE * LANES + lane] = 1.0 if done else 0.0


@called_often
def _jacobian(given, lane, scale):
    """Columns of the derivatives of the mismatch by the unknowns."""
    moments, (vv, zz, vz) = read3(given, RESPONDED, lane), read3(given, 9, lane)
    corr = given[(RESPONDED + 3) * LANES + lane]
    by_slip = slope_of_unknowns(moments[0], moments[1], corr, read3(given, RESPONDED + 4, lane))
    by_relaxation = slope_of_unknowns(moments[0], moments[1], corr, read3(given, RESPONDED + 7, lane))
    r = vz / np.sqrt(vv * zz)
    return (
        _column(given, 0, lane, by_slip, by_relaxation, (vv, zz, r), scale[0]),
        _column(given, 1, lane, by_slip, by_relaxation, (vv, zz, r), scale[1]),
        _column(given, 2, lane, by_slip, by_relaxation, (vv, zz, r), scale[2]),
    )


@called_often
def _column(given, n, lane, by_slip, by_relaxation, assumed, scale):
    slip, relaxation = given[(12 + n) * LANES + lane], given[(15 + n) * LANES + lane]
    own = (
        given[(18 + n) * LANES + lane], given[(21 + n) * LANES + lane], given[(24 + n) * LANES + lane]
    )  # fmt: skip
    less = slope_of_unknowns(assumed[0], assumed[1], assumed[2], own)
    return (
        (by_slip[0] * slip + by_relaxation[0] * relaxation - less[0]) * scale,
        (by_slip[1] * slip + by_relaxation[1] * relaxation - less[1]) * scale,
        (by_slip[2] * slip + by_relaxation[2] * relaxation - less[2]) * scale,
    )


@called_often
def _newton_step(columns, mismatch, damping):
    """``(damping - J)^-1 F``, limited in length: a relaxation for much damping, Newton's without."""
    (a, d, g), (b, e, h), (c, f, i) = columns
    matrix = (damping - a, -b, -c), (-d, damping - e, -f), (-g, -h, damping - i)
    one, two, three = solve_3x3(matrix, mismatch)
    shorter = max(1.0, max(abs(one), abs(two), abs(three)) / LARGEST_STEP)
    return one / shorter, two / shorter, three / shorter


def slope_of_unknowns(vv: Any, zz: Any, r: Any, slope: Any) -> Any:
    """Of ``(log sv, log sz, atanh r)`` at a covariance, as that moves by ``slope``."""
    of_v, of_z = 0.5 * slope[0] / vv, 0.5 * slope[1] / zz
    return of_v, of_z, (slope[2] / np.sqrt(vv * zz) - r * (of_v + of_z)) / (1 - r * r)


def next_delta(delta: Any, before: Any, now: Any, pace: Pace) -> Any:
    """Switched evolution relaxation: longer as the mismatch falls, short again when it rises."""
    ratio = 1.0 if np.isinf(before) else before / now
    shorter = max(pace.shorter * min(delta, pace.restart), LEAST_DELTA)
    return shorter if ratio < 1 else delta * min(pace.longer * ratio, pace.longest)


for _ in (characteristic, hurwitz, stable, own_covariance, solve_3x3, slope_of_unknowns, next_delta):
    shared(_)
