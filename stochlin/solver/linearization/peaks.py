"""Mean and standard deviation of the peak displacement in a stationary motion of finite length."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.kernels.linearization.covariance import EquivalentSystem, Forcing
from stochlin.kernels.linearization.spectral_moments import displacement_moments
from stochlin.models.arguments import checked
from stochlin.models.grounds import Ground
from stochlin.models.parameters import Parameter
from stochlin.models.rules.peak_factors import PeakFactor, StationaryMotion, peak_factor_model
from stochlin.models.structures import DRIFT, GAUSSIAN, Structure
from stochlin.solver.linearization.equivalent_systems import JUDGED, Solved, check_closure
from stochlin.solver.linearization.linearization import caution_in_words, judged
from stochlin.solver.tables import labels
from stochlin.solver.tables.lazy import cellwise

STIFF_PERIOD_RATIO = 0.5  # T/Tg below which peaks of yielding structures are too small
PACE = 1.0  # rate at which the variance of the drift grows in the peaks, over 1/drift_time


@checked
def peak_response(
    structure: Structure,
    ground: Ground,
    duration: Parameter,
    *,
    model: str = "vanmarcke",
    closure: str = GAUSSIAN,
) -> xr.Dataset:
    """Peak displacement of a structure in a stationary motion of a given duration.

    The structure is linearized. Its response is taken as Gaussian and as stationary from the start
    of the motion, except for the plastic drift, which starts from rest.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic
        The structure.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground.
    duration : float or array
        Duration of the motion [s], positive; all parameters broadcast by dimension name.
    model : str
        Model of the peak factor: ``"davenport"``, ``"der_kiureghian"`` or ``"vanmarcke"``, see
        `stochlin.rules.peak_factor_model`.
    closure : str
        Closure of the linearization, as in `linearize`.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``peak_mean`` and ``peak_std`` [m], the mean and the
        standard deviation of the peak; ``peak_factor`` [-], ``peak_mean`` over ``displacement_std``
        [m]; ``crossings`` [-], the mean number of zero crossings, upwards and downwards, in the
        duration; ``bandwidth`` [-], ``sqrt(1 - l1^2/(l0 l2))`` with the spectral moments ``l0``,
        ``l1``, ``l2``; ``status``; ``bias`` [-], the relative error of the stationary
        ``displacement_std``, as in `linearize`; and the flag ``caution``, which is that of the
        bias, and at least 1 for yielding structures with T < Tg/2, whose peaks are less accurate
        (see the notes).

    Raises
    ------
    ValueError, TypeError
        If a model or closure is unknown, a scalar is out of range, or the motion of a
        single case is too short for the peak factor; in a table the cell is NaN.
    ArithmeticError
        As in `linearize`.

    Notes
    -----
    For elastic oscillators with 20 to 100 cycles, the error of the mean peak, compared with
    simulation, is -1 to +4 % (Vanmarcke), -1 to +5 % (Der Kiureghian) and +4 to +20 % (Davenport).

    With the drift closure, the slow plastic drift adds to the variance of the displacement, but not
    to that of the velocity. For the peaks its variance is taken to grow from rest as ``1 -
    exp(-t/drift_time)``, half as fast as it does by `linearize`, and its mean over the motion is
    used. This factor was fitted to simulations.

    With the Gaussian closure mean peaks of yielding structures are mostly too small, most of all
    for structures much stiffer than the ground. Those with the drift closure are nearer to
    simulations from rest, and can still be too small where ``caution`` is not 0. ``peak_std`` is
    too small.

    References
    ----------
    Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Der Kiureghian, A. (1980), J. Eng. Mech. Div. ASCE
    106; Davenport, A. G. (1964), Proc. Inst. Civil Eng. 28.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=1.0, damping=0.05)
    >>> table = sl.peak_response(building, sl.WhiteNoise(0.01), duration=20.0)
    >>> round(float(table.crossings), 6), round(float(table.peak_factor), 3)
    (40.0, 2.629)
    """
    chosen = peak_factor_model(model)
    domain = chosen.domain(2)
    check_closure(structure, closure)
    motion = StationaryMotion(duration)
    response = judged((structure,), ground, closure)
    solved = response.dataset()
    labels.raise_if_lone_failure(solved, "peak_response", structure, ground)
    time = motion.arrays()["duration"]
    length = time.where(motion.valid())
    l0, l1, l2 = response_moments(response)
    if closure == DRIFT:
        l0, l1, l2 = _with_drift(l0, l1, l2, solved, length)
    table = peak_table(l0, l1, l2, length, chosen, 2)
    if closure == DRIFT:
        table = table.assign(peak_factor=table.peak_mean / solved.displacement_std)
    outside = np.isnan(table.peak_mean) & (solved.status < labels.NOT_CONVERGED)
    if outside.ndim == 0 and bool(outside):
        what = f"duration = {float(time):g} holds {float(table.crossings):.3g} zero crossings"
        raise ValueError(f"{what}; allowed for {chosen.name}: {domain}; or simulate")
    status = solved.status.where(~outside, labels.INVALID_INPUT)
    table = table.assign(status=status.astype(np.int8))
    table = table.assign(solved[[*JUDGED, "displacement_std"]])
    table["caution"] = _caution(structure, ground, solved, table.caution)
    table = labels.label(table)
    comment = f"{chosen.name} is defined for {domain}; NaN elsewhere."
    if structure.yields:
        comment = f"{caution_in_words(closure, ground)} {comment}"
    table = table.assign_attrs(comment=comment, closure=closure, peak_factor_model=chosen.name)
    return labels.with_run_information(
        table,
        f"Peak displacement in a stationary motion, {chosen.name}, {ground.name} ground",
        f"peak_response(model={chosen.name!r}, closure={closure!r})",
        {"structure": structure, "ground": ground, "motion": motion},
        f"{labels.PAPER} {chosen.reference}.",
    )


def _with_drift(
    l0: xr.DataArray,
    l1: xr.DataArray,
    l2: xr.DataArray,
    solved: xr.Dataset,
    duration: xr.DataArray,
) -> tuple[xr.DataArray, ...]:
    """Spectral moments with the mean variance of the drift over a motion from rest added."""
    whole = solved.displacement_std**2
    passed = PACE * solved.drift_rate * duration
    grown = 1 + np.expm1(-passed) / passed
    fast = (whole / l0).clip(max=1.0)  # below 1 if the map corrects the variance to less than l0
    return fast * l0 + grown * (whole - l0).clip(0), fast * l1, fast * l2


def _caution(
    structure: Structure, ground: Ground, solved: xr.Dataset, judged: xr.DataArray
) -> xr.DataArray:
    """Caution of the peak: that of the standard deviation, at least 1 if yielding with T < Tg/2."""
    if ground.calibration is None or ground.calibration.soil is None:
        return judged
    period, _ = ground.calibration.soil
    stiff = structure.arrays()["period"] < STIFF_PERIOD_RATIO * ground.arrays()[period]
    stiff = stiff & np.isfinite(solved.yield_displacement)
    caution = np.maximum(judged, stiff.astype(np.int8))
    return caution.assign_attrs(judged.attrs)


def peak_table(
    l0: xr.DataArray,
    l1: xr.DataArray,
    l2: xr.DataArray,
    duration: xr.DataArray,
    model: PeakFactor,
    sides: int,
) -> xr.Dataset:
    """Peak of a Gaussian displacement with these spectral moments [m^2, m^2/s, m^2/s^2]."""
    moving = (l0 > 0) & (l2 > 0)  # u_1 - u_2 of equal structures does not move
    crossings = duration * np.sqrt(l2.where(moving) / l0) / np.pi
    bandwidth = xr.apply_ufunc(np.sqrt, (1 - l1**2 / (l0 * l2).where(moving)).clip(0))
    factors = [
        cellwise(function, crossings, bandwidth, sides=sides)[0]
        for function in (model.mean, model.std)
    ]
    sigma = np.sqrt(l0.where(moving))
    return xr.Dataset(
        {
            "peak_mean": (factors[0] * sigma).where(l0 != 0, 0.0),
            "peak_std": (factors[1] * sigma).where(l0 != 0, 0.0),
            "peak_factor": factors[0],
            "crossings": crossings,
            "bandwidth": bandwidth,
        }
    )


def response_moments(solved: Solved) -> list[xr.DataArray]:
    """Spectral moments [m^2, m^2/s, m^2/s^2] of a structure's displacement; NaN in failed cells."""
    system = EquivalentSystem(*solved.values["system"])
    forcing = Forcing(*solved.values["forcing"])
    ground = solved.ground.filter_of(solved.oscillators.soil)
    moments = displacement_moments(system, forcing, ground)
    return [xr.DataArray(solved.tables[0].array(moment)) for moment in moments]
