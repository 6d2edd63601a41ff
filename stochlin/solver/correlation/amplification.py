"""Amplification factor D of the displacement by yielding (Fig. 5b)."""

from __future__ import annotations

from functools import partial
from typing import Any, Literal

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.messages import brief
from stochlin.models.arguments import Duration, Paths, Seed, checked
from stochlin.models.buildings.base import FLOOR
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.structures import GAUSSIAN, AnyStructure, Structure
from stochlin.solver.linearization.equivalent_systems import solve_elastic
from stochlin.solver.linearization.linearization import linearize
from stochlin.solver.simulation.simulation import simulate
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.labels import ELEMENT

Amplified = Literal["std", "peak"]
AMPLIFIED_STD: Amplified = "std"
AMPLIFIED_PEAK: Amplified = "peak"


@checked
def amplification(
    structure: AnyStructure,
    ground: Ground,
    *,
    of: Amplified = AMPLIFIED_STD,
    closure: str = GAUSSIAN,
    duration: Duration | None = None,
    envelope: Envelope | None = None,
    paths: Paths = 256,
    seed: Seed = 0,
) -> xr.Dataset:
    """Amplification factor ``D``: inelastic displacement over elastic displacement.

    In the paper's Fig. 5b it is the ratio of peak displacements. These are defined in a motion of
    finite duration: with ``of="peak"``, the structure and its elastic counterpart are simulated
    under the same motions. With ``of="std"``, it is the ratio of the standard deviations of the
    stationary response, which is equal to the ratio of the peaks if both have the same peak factor.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic; for peaks also ShearBuilding
        The structure; its elastic counterpart has the same parameters and does not yield.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; its parameters and those of the structure broadcast by dimension name.
    of : {"std", "peak"}
        Displacements that are compared: standard deviations or mean peaks.
    closure : str
        Closure of the linearization for standard deviations, as in `linearize`.
    duration : float, optional
        Duration of the motions [s], at least one period. Required for peaks and only allowed there.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions for peaks; without it they are stationary from their start.
    paths, seed : int
        Number and seed of the simulated motions, as in `simulate`.

    Returns
    -------
    xarray.Dataset
        For standard deviations, over the dimensions of the parameters: ``amplification`` [-],
        ``displacement_std`` [m] and ``ductility_std`` [-] of the inelastic structure, ``status``,
        ``bias`` [-], the relative error of these three against the drift closure, and ``caution``,
        a flag that is set where the bias exceeds 10 % or is unknown, both as in `linearize`.

        For peaks: ``amplification`` [-], the mean of ``max |u|`` of the structure over that of its
        elastic counterpart, with its standard error; ``peak_mean`` and ``elastic_peak_mean`` [m]
        with standard errors; ``ductility`` [-], ``peak_mean`` over the yield displacement; and
        ``status``, which is ``elastic_limit`` where the structure yields in none of the motions.
        For a building with storeys these variables are over ``floor``, except ``ductility``, which
        is over ``element``.

    Raises
    ------
    ValueError, ArithmeticError
        As in `linearize` and `simulate`; also if peaks are asked for without a duration, or if a
        duration or an envelope is given for standard deviations.

    Notes
    -----
    By linearization, the relative error of ``D`` is that of the standard deviation: with the
    Gaussian closure, of Fig. 5b, ``D`` of yielding structures is too small, for stiff structures on
    a lake bed by a factor of ten and more (see `linearize`); with the drift closure it is 0.9 % on
    average.

    The plastic drift of a structure that yields seldom grows very slowly. In a stationary response
    it is fully developed, so that the ratio of the standard deviations is then much larger than the
    ratio of the peaks in a motion of usual duration.

    The standard error of the ratio of peaks is that of the mean of ``peak - D elastic_peak``,
    divided by the mean elastic peak. It is small because both peaks of a pair are from the same
    motion.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), Fig. 5b.

    Examples
    --------
    >>> import stochlin as sl
    >>> building = sl.Bilinear(period=0.5, damping=0.05, hardening=0.05, reduction_factor=4)
    >>> lakebed = sl.KanaiTajimi(2.0, 0.05)
    >>> round(float(sl.amplification(building, lakebed).amplification), 2)
    2.18
    >>> round(float(sl.amplification(building, lakebed, closure="drift").amplification))
    16
    >>> peaks = sl.amplification(building, lakebed, of="peak", duration=30.0, paths=64)
    >>> 1 < float(peaks.amplification)
    True
    """
    models: dict[str, Any] = {"structure": structure, "ground": ground}
    if of == AMPLIFIED_PEAK:
        if brief(closure) != brief(GAUSSIAN):
            raise ValueError(f"closure = {brief(closure)} has no use with of='peak'; leave it out")
        motion = {"duration": duration, "envelope": envelope, "paths": paths, "seed": seed}
        return _peak_table(models, motion)
    if not (duration is None and envelope is None):
        what = "duration and envelope belong to finite motions"
        raise ValueError(f"{what}; leave them out, or ask for of='peak'")
    expect(structure, Structure, "structure")
    assert isinstance(structure, Structure)
    inelastic = linearize(structure, ground, closure)
    table = inelastic[["displacement_std", "ductility_std", "status", "bias", "caution"]]
    table.attrs = {"closure": closure}
    if structure.yields:
        table.attrs["comment"] = inelastic.attrs["comment"]
    elastic = solve_elastic(structure, ground).displacement_std
    return labels.with_run_information(
        labels.label(table.assign(amplification=table.displacement_std / elastic)),
        f"Stationary amplification of the displacement by yielding, {ground.name} ground",
        f"amplification(closure={closure!r})",
        models,
    )


def _peak_table(models: dict[str, Any], motion: dict[str, Any]) -> xr.Dataset:
    """The dataset that `amplification` returns for peaks."""
    duration = check_duration(motion["duration"], {"structure": models["structure"]})
    long_enough = models["structure"].first_period() <= duration
    table = labels.label(over_cells(partial(_peaks_of_cell, motion), models, long_enough))
    labels.raise_if_lone_failure(table, "amplification", *models.values())
    return labels.with_run_information(
        table,
        f"Amplification of the largest displacement by yielding, {models['ground'].name} ground",
        f"amplification(of={AMPLIFIED_PEAK!r}, duration={duration:g}, paths={motion['paths']}, "
        f"seed={motion['seed']})",
        models,
    )


def _peaks_of_cell(motion: dict[str, Any], structure: AnyStructure, ground: Ground) -> xr.Dataset:
    """Amplification of the peaks of one structure, which moves beside its elastic counterpart."""
    motions = simulate([structure, structure.elastic()], ground, scatter=0.0, **motion)
    n = motions.peak.shape[1] // 2
    peaks = motions.peak.values
    ratios = _ratios(peaks[:, :n], peaks[:, n:])
    attrs = {key: value for key, value in motions.attrs.items() if not key.startswith("structure")}
    if structure.has_storeys:
        inelastic = motions.isel({FLOOR: slice(None, n), ELEMENT: slice(None, n)})
        response = inelastic[["peak_mean", "ductility"]]
        columns = {name: (FLOOR, values) for name, values in ratios.items()}
        table = xr.Dataset(columns, response.coords).assign(ductility=response.ductility)
        # The yield drift is the mean peak drift over the ductility; compared without a division.
        scaled_drift = motions.peak_drift.max("path") * motions.ductility
        elastic = not bool((scaled_drift > motions.peak_drift_mean).any())
    else:
        strength = float(solve_elastic(structure.first_mode(), ground).yield_displacement)
        table = xr.Dataset({name: float(values[0]) for name, values in ratios.items()})
        table["ductility"] = table.peak_mean / strength
        elastic = bool((peaks[:, 0] <= strength).all())
    status = np.int8(labels.ELASTIC_LIMIT if elastic else labels.CONVERGED)
    return table.assign(status=status).assign_attrs(attrs)


@np.errstate(invalid="ignore")  # infinite if the structure falls in a motion
def _ratios(inelastic: Array, elastic: Array) -> dict[str, Array]:
    """Means of peaks (motions, n), their ratio, standard errors; that of the ratio from pairs."""
    scale = np.sqrt(len(inelastic))
    mean = inelastic.mean(axis=0)
    elastic_mean = elastic.mean(axis=0)
    ratio = mean / elastic_mean
    residual = (inelastic - ratio * elastic).std(axis=0, ddof=1)
    return {
        "amplification": ratio,
        "amplification_standard_error": residual / scale / elastic_mean,
        "peak_mean": mean,
        "peak_mean_standard_error": inelastic.std(axis=0, ddof=1) / scale,
        "elastic_peak_mean": elastic_mean,
        "elastic_peak_mean_standard_error": elastic.std(axis=0, ddof=1) / scale,
    }
