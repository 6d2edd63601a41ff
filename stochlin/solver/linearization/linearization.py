"""Statistical linearization of one structure on one ground, eqs. (5) to (12), and its bias.

The bias is that against the drift closure, which is corrected by a map of nonlinear simulations,
and has an expected error of its own. It is known for bilinear structures, on the kinds of ground
and in the ranges that were simulated.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array, where_finite
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.parameters import Model
from stochlin.models.structures import DRIFT, Structure
from stochlin.solver.linearization.equivalent_systems import (
    PUBLIC,
    LawOfCells,
    Solved,
    check_closure,
    solved_together,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import USUAL_TOLERANCE, Tolerance
from stochlin.solver.tables.lazy import in_blocks

DISPLACEMENT_STD = "displacement_std"
DOUBTFUL_BIAS = 0.1  # bias from which the caution of a cell is 1
EXPECTED = 0.05  # expected error above which an error of more than DOUBTFUL_BIAS is not rare
UNCALIBRATED = (
    "No nonlinear simulations calibrate linearization on {} ground: its bias is unknown, and "
    "results of the drift closure are as derived."
)


def judged(
    structures: Sequence[Structure],
    ground: Ground,
    closure: str,
    tolerance: Tolerance = USUAL_TOLERANCE,
) -> Solved:
    """The responses by a closure with ``bias``, its expected error ``bias_error``, and ``caution``.

    The bias of ``displacement_std`` is 0 if a structure is elastic, and NaN if it is unknown.
    """
    solved = by_drift = solved_together(structures, ground, closure, tolerance)
    if closure == DRIFT:
        error = solved.values["displacement_error"]
        more = {
            "bias": where_finite(0.0, error),
            "bias_error": error,
            "caution": caution_of(error, EXPECTED),
        }
    else:
        by_drift = _by_drift(solved, tolerance)
        more = _relative_bias(solved, by_drift)
    return solved._replace(values={**solved.values, **more}, by_drift=by_drift)


def _by_drift(solved: Solved, tolerance: Tolerance) -> Solved:
    """The bilinear structures by the drift closure; others stay elastic."""
    laws = [
        LawOfCells.of(table, DRIFT)
        if structure.yields and isinstance(structure, Bilinear)
        else None
        for structure, table in zip(solved.structures, solved.tables, strict=True)
    ]
    return solved.by_laws(laws, DRIFT, tolerance)


@np.errstate(all="ignore")  # failed cells are NaN
def _relative_bias(solved: Solved, by_drift: Solved) -> dict[str, Array]:
    """Relative error of displacements; unknown where that of the drift closure is, 0 if elastic."""
    std = solved.values[DISPLACEMENT_STD]
    truth = by_drift.values[DISPLACEMENT_STD]
    error = by_drift.values["displacement_error"]
    bias = where_finite(np.where(error == 0, 0.0, std / truth - 1), error, std)
    for structure, part in zip(solved.structures, solved.parts, strict=True):
        if structure.yields and not isinstance(structure, Bilinear):
            bias[part] = np.nan
    return {"bias": bias, "bias_error": where_finite(error, bias), "caution": caution_of(bias)}


def caution_of(off: Array, most: float = DOUBTFUL_BIAS) -> Array:
    """Flag (int8) of a bias or of an expected error: 0 up to ``most``, 1 above, 2 unknown."""
    return np.asarray(np.int8(2) * np.isnan(off) + (np.abs(off) > most), np.int8)


@checked
def linearize(
    structure: Structure,
    ground: Ground,
    closure: str = "gaussian",
    *,
    rtol: float = 1e-10,
    max_iterations: int = 200,
) -> xr.Dataset:
    """Stationary response of a hysteretic structure by statistical linearization.

    The hysteresis law is replaced by ``z' = -c_eq v - k_eq z``, with ``v`` the velocity and ``z``
    the hysteretic displacement. The coefficients follow by the closure from the covariance of the
    response, and the covariance is that of the linear system with these coefficients; a damped
    Newton's method finds both. Where a law may have several solutions (Bouc-Wen with ``gamma >
    beta``, laws in symbols), the intensity is raised step by step from a value at which the
    response is elastic, and the solution is followed. Only stable systems count as solutions.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
        The structure.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; its parameters and those of the structure broadcast by dimension name.
    closure : {"gaussian", "clipped", "drift"}
        Assumed distribution of the response. ``"gaussian"``: ``(v, z)`` jointly Gaussian, eqs. (9)
        and (10); the others are only for bilinear structures. ``"clipped"``: ``z`` is a Gaussian
        variable clipped at -1 and 1. ``"drift"``: the clipped closure plus the slow drift of the
        plastic displacement, see the notes.
    rtol : float
        The iteration of a cell stops when the standard deviations of ``v`` and ``z`` change by at
        most this share, and their correlation by as much.
    max_iterations : int
        Largest number of iterations, and of steps in intensity where the solution is followed.
        Cells that need more are NaN with the status ``not_converged``, or ``shaking_too_strong`` if
        the elastic standard deviation is more than a thousand times the yield displacement.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: the standard deviations ``displacement_std`` [m],
        ``velocity_std`` [m/s], ``ductility_std`` [-] and ``z_std`` [-], the correlation
        ``velocity_z_corr`` [-] of ``v`` and ``z``, the coefficients ``c_eq`` [-] and ``k_eq``
        [1/s], ``yield_displacement`` [m] (infinite if elastic), ``iterations``, ``residual`` [-],
        and ``status`` (CF flags; ``elastic_limit`` if elastic); ``bias`` [-], the relative error of
        ``displacement_std`` against the drift closure; its expected error ``bias_error`` [-]; and
        ``caution``, a flag that is set where the bias exceeds 10 % or is unknown.

        The closure ``"drift"`` adds ``drift_std`` [m], the standard deviation of the displacement
        by the drift alone, and ``drift_time`` [s], its relaxation time (NaN without a drift): a
        motion of duration ``t`` from rest reaches the share ``1 - exp(-2 t/drift_time)`` of its
        variance. The known bias is already corrected, so that ``bias`` is 0; ``displacement_error``
        [-] is the expected relative error that remains, and ``caution`` is set where it exceeds 5 %
        or is unknown.

    Raises
    ------
    ValueError, TypeError
        If the law does not have the closure, an argument is of the wrong kind or out of range,
        dimensions do not fit together, or the table would not fit into memory.
    ArithmeticError
        If a single case fails; in a table the cell is NaN and its status gives the reason.

    Notes
    -----
    Linearization underestimates most displacements. Compared with nonlinear simulation on white
    noise (R 1 to 9.6), ``displacement_std`` is too small by 15 to 51 % for hardening ratios of 0.02
    and 0.05 and by 4 to 26 % for 0.2. On narrow-band ground, for a hardening ratio of 0.05 and R 2
    to 6, it is too small by 1 to 9 % at the period of the ground, and by a factor of up to thirty
    for structures much stiffer than the ground. `correlate` by simulation does not have this error.

    The bias is known for bilinear structures; that of other laws that yield is NaN.

    The drift closure adds the variance of the plastic drift to that of the clipped closure. The
    drift is a random walk in steps, one for each excursion into yielding, on which only the
    hardening acts as a restoring force; ``docs/drift.md`` derives it. ``displacement_std`` and
    ``ductility_std`` are then multiplied by a correction from a map of simulations on Kanai-Tajimi
    ground and white noise; on Clough-Penzien ground it is that of the soil, and outside the map
    that of its boundary. ``displacement_error`` grows with the differences of neighbouring points
    of the map, which are large for stiff structures near the resonance after yield, ``T =
    sqrt(hardening) Tg``. ``velocity_std``, ``z_std``, ``velocity_z_corr``, ``c_eq`` and ``k_eq``
    are those of the clipped closure, without the drift. In 500 random pairs on such grounds
    ``displacement_std`` was off by 0.9 % on average and by more than 3 % in one case of twenty;
    without the map by 6 and 23 %, mostly for T < Tg/2.

    References
    ----------
    Roberts, J. B. and Spanos, P. D. (1990). Random vibration and statistical linearization.
    Karnopp, D. and Scharton, T. D. (1966), J. Acoust. Soc. Am. 39: plastic drift as a random walk.

    Examples
    --------
    >>> import numpy as np, stochlin as sl
    >>> building = sl.Bilinear(
    ...     period=2 * np.pi, damping=0.05, hardening=0.05, yield_displacement=1.0
    ... )
    >>> round(float(sl.linearize(building, sl.WhiteNoise(0.1 / np.pi)).ductility_std), 6)
    0.870745

    By nonlinear simulation it is 1.346. The drift closure gives:

    >>> round(float(sl.linearize(building, sl.WhiteNoise(0.1 / np.pi), "drift").ductility_std), 2)
    1.35
    """
    check_closure(structure, closure)
    tolerance = Tolerance(rtol, max_iterations)
    models: dict[str, Model] = {"structure": structure, "ground": ground}
    table = labels.label(in_blocks(partial(_solved, closure, tolerance), models))
    labels.raise_if_lone_failure(table, "linearize", structure, ground)
    if structure.yields:
        table = table.assign_attrs(comment=caution_in_words(closure, ground))
    return labels.with_run_information(
        table,
        f"Stationary response by linearization, {closure} closure, {ground.name} ground",
        f"linearize(closure={closure!r})",
        models,
    )


@np.errstate(divide="ignore")  # an elastic structure does not drift
def _solved(closure: str, tolerance: Tolerance, structure: Structure, ground: Ground) -> xr.Dataset:
    """The variables that `linearize` returns."""
    solved = judged((structure,), ground, closure, tolerance)
    names = [*PUBLIC, "bias", "bias_error", "caution"]
    values = solved.values
    if closure == DRIFT:
        std = values["drift_std"]
        time = 1 / values["drift_rate"]
        solved = solved._replace(values={**values, "drift_time": np.where(std > 0, time, np.nan)})
        names += ["displacement_error", "drift_std", "drift_time"]
    return xr.Dataset(solved.labelled(0, names))


def caution_in_words(closure: str, ground: Ground, others: str = labels.CAUTION_SIGMA) -> str:
    """Comment on the closure's accuracy for yielding structures; that of ``others`` than drift."""
    unknown = "" if ground.calibration else UNCALIBRATED.format(ground.name)
    if closure == DRIFT:
        return unknown or labels.CAUTION_DRIFT
    return " ".join(filter(None, (others, unknown)))
