"""Amplification factor D of the displacement by yielding (Fig. 5b)."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Annotated, Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.arguments import Duration, OneOf, Paths, Seed, checked, fitting
from stochlin.models.buildings import MultistoreyBuilding
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.structures import GAUSSIAN, Structure
from stochlin.models.systems import AnyStructure, falls_at
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.correlation.simulated import over_grounds
from stochlin.solver.linearization.equivalent_systems import solve_elastic
from stochlin.solver.linearization.linearization import linearize
from stochlin.solver.simulation.ensembles import cells_of, join_cells, prepare
from stochlin.solver.simulation.finite_motions import (
    finite_attributes,
    largest_displacements,
)
from stochlin.solver.simulation.simulation import STEPS_PER_PERIOD, simulate
from stochlin.solver.tables import labels
from stochlin.solver.tables.cellwise import row_of
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.floors import ELEMENT, FLOOR
from stochlin.solver.tables.lazy import computed

LINEARIZATION, SIMULATION = "linearization", "simulation"
STD, PEAK = "std", "peak"
STD_ERROR = "displacement_std_standard_error"


def _check_fitting(of: object, duration: object, envelope: object) -> None:
    """Raise a ValueError for what describes a motion where no motion is simulated."""
    if isinstance(of, str) and of == STD and not (duration is None and envelope is None):
        raise ValueError(
            "duration and envelope belong to finite motions, and standard deviations are those of the "
            "stationary response; leave them out, or ask for of='peak'"
        )


@fitting(_check_fitting)
@checked
def amplification(
    structure: AnyStructure,
    ground: Ground,
    *,
    of: Annotated[str, OneOf((STD, PEAK))] = STD,
    method: Annotated[str, OneOf((LINEARIZATION, SIMULATION))] | None = None,
    closure: str = GAUSSIAN,
    duration: Duration | None = None,
    envelope: Envelope | None = None,
    paths: Paths = 256,
    seed: Seed = 0,
) -> xr.Dataset:
    """Amplification factor ``D``: inelastic displacement over elastic displacement.

    In the paper's Fig. 5b it is the ratio of peak displacements. These are defined in a motion of finite
    duration: with ``of="peak"``, the structure and its elastic counterpart are simulated under the same
    motions. With ``of="std"``, it is the ratio of the standard deviations of the stationary response,
    which is equal to the ratio of the peaks if both have the same peak factor.

    Parameters
    ----------
    structure : Bilinear, BoucWen or Hysteretic; for peaks also ShearBuilding
        The structure; its elastic counterpart has the same parameters and does not yield.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground; its parameters and those of the structure broadcast by dimension name.
    of : {"std", "peak"}
        Displacements that are compared: standard deviations or mean peaks.
    method : {"linearization", "simulation"}, optional
        Method for the inelastic response. The default is linearization for standard deviations and
        simulation for peaks, for which linearization is not available.
    closure : str
        Closure of the linearization, as in `linearize`.
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
        ``displacement_std`` [m] and ``ductility_std`` [-] of the inelastic structure, and ``status``.
        Linearization adds ``bias`` [-], the relative error of these three against the drift closure, and
        ``caution``, a flag that is set where the bias exceeds 10 % or is unknown, both as in
        `linearize`. Simulation adds ``amplification_standard_error`` [-] and ``drift_memory`` [s].

        For peaks: ``amplification`` [-], the mean of ``max |u|`` of the structure over that of its
        elastic counterpart, with its standard error; ``peak_mean`` and ``elastic_peak_mean`` [m] with
        standard errors; ``ductility`` [-], ``peak_mean`` over the yield displacement; and ``status``,
        which is ``elastic_limit`` where the structure yields in none of the motions. For a building with
        storeys these variables are over ``floor``, except ``ductility``, which is over ``element``, and
        ``drift_amplification`` [-], the ratio of the mean peak storey drifts over ``element``, is added
        with its standard error.

    Raises
    ------
    ValueError, ArithmeticError
        As in `linearize` and `simulate`; also if peaks are asked for without a duration or by
        linearization, or if a duration or an envelope is given for standard deviations.

    Notes
    -----
    By linearization, the relative error of ``D`` is that of the standard deviation: with the Gaussian
    closure, of Fig. 5b, ``D`` of yielding structures is too small, for stiff structures on a lake bed by
    a factor of ten and more (see `linearize`); with the drift closure it is 0.9 % on average.

    The plastic drift of a structure that yields seldom grows very slowly. In a stationary response it is
    fully developed, so that the ratio of the standard deviations is then much larger than the ratio of
    the peaks in a motion of usual duration.

    The standard error of the ratio of peaks is that of the mean of ``peak - D elastic_peak``, divided by
    the mean elastic peak. It is small because both peaks of a pair are from the same motion.

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
    if of == PEAK:
        motion = {"duration": duration, "envelope": envelope, "paths": paths, "seed": seed}
        return _of_peaks(structure, ground, method, motion)
    expect(structure, Structure, "structure")
    assert isinstance(structure, Structure)
    elastic = solve_elastic(structure, ground).displacement_std
    method = method or LINEARIZATION
    if method == LINEARIZATION:
        inelastic, how = linearize(structure, ground, closure), f"closure={closure!r}"
        table = inelastic[["displacement_std", "ductility_std", "status", "bias", "caution"]]
        table.attrs = {"closure": closure}
        if structure.yields:
            table.attrs["comment"] = inelastic.attrs["comment"]
    else:
        pairs = correlate(structure, structure, ground, method, paths=paths, seed=seed)
        shown = ("displacement_std", "ductility_std", "drift_memory", STD_ERROR)
        names = {f"{name}_1": name for name in shown}
        table, how = pairs[[*names, "status"]].rename(names), f"paths={paths}, seed={seed}"
        table["amplification_standard_error"] = table[STD_ERROR] / elastic
        table = table.drop_vars(STD_ERROR)
    table = table.assign(amplification=table.displacement_std / elastic)
    return labels.with_run_information(
        labels.label(table),
        f"Stationary amplification of the displacement by yielding, {method}, {ground.name} ground",
        f"amplification(method={method!r}, {how})",
        {"structure": structure, "ground": ground},
    )


def _of_peaks(
    structure: AnyStructure, ground: Ground, method: str | None, motion: dict[str, Any]
) -> xr.Dataset:
    """The dataset that `amplification` returns for peaks."""
    if method == LINEARIZATION:
        raise ValueError(
            f"method = {method!r} is not available for of='peak'; allowed: {SIMULATION}; peak_response "
            "gives the peaks of the linearized structure"
        )
    motion["duration"] = check_duration(motion["duration"], {"structure": structure})
    if isinstance(structure, MultistoreyBuilding):
        table = _of_storeys(structure, ground, **motion)
    else:
        grounds = int(np.prod([array.size for array in ground.arrays().values()]))
        run = partial(_on_one_ground, motion, grounds)
        table = over_grounds(run, [computed(structure)], computed(ground))
    table = labels.label(table)
    labels.raise_if_lone_failure(table, "amplification", structure, ground)
    return labels.with_run_information(
        table,
        f"Amplification of the largest displacement by yielding, {ground.name} ground",
        f"amplification(of={PEAK!r}, duration={motion['duration']:g}, paths={motion['paths']}, "
        f"seed={motion['seed']})",
        {"structure": structure, "ground": ground},
    )


def _on_one_ground(
    motion: dict[str, Any], grounds: int, structure: Structure, ground: Ground
) -> xr.Dataset:
    """Amplification of the peaks of single-storey structures, all cells under the same motions."""
    elastic = replace(structure, yield_displacement=None, reduction_factor=None)
    sides = [cells_of(model, ground, stationary=False) for model in (structure, elastic)]
    cells = join_cells([part for part, _ in sides])
    duration, envelope = motion["duration"], motion["envelope"]
    cells = cells._replace(valid=cells.valid & (cells.period <= duration))
    drawn = {name: motion[name] for name in ("paths", "seed")}
    run = prepare(cells, ground, **drawn, steps_per_period=STEPS_PER_PERIOD)
    peaks = np.full((run.plan.groups * LANES, cells.valid.size), np.nan)
    peaks[:, cells.valid] = largest_displacements(run, duration, envelope, grounds)
    own, index = sides[0]
    inelastic = peaks[:, : own.valid.size]
    other = peaks[:, own.valid.size + row_of(sides[1][1], index)]
    largest_z = row_of(structure.largest_z(), index)
    limits = falls_at(own.hardening, 1 - own.hardening, own.yield_displacement * largest_z)
    inelastic = np.where(np.isfinite(limits) & ~(inelastic <= limits), np.inf, inelastic)
    ratios = _ratios(inelastic, other)
    stayed = (inelastic <= own.yield_displacement).all(axis=0)
    status = np.where(stayed, labels.ELASTIC_LIMIT, labels.CONVERGED)
    known = ~np.isnan(ratios["amplification"])
    columns = {
        **ratios,
        "ductility": ratios["peak_mean"] / own.yield_displacement,
        "status": np.where(known, status, labels.INVALID_INPUT).astype(np.int8),
    }
    table = {name: index.copy(data=values.reshape(index.shape)) for name, values in columns.items()}
    return xr.Dataset(table, attrs=finite_attributes(run, duration, envelope))


def _of_storeys(building: MultistoreyBuilding, ground: Ground, **motion: Any) -> xr.Dataset:
    """Amplification of peak displacements and drifts of a building with storeys."""
    elastic = replace(building, **{building.strength_name: None})
    motions = simulate([building, elastic], ground, **motion)
    n = building.storeys
    own = motions.isel({FLOOR: slice(None, n), ELEMENT: slice(None, n)})
    peaks, drifts = (
        _ratios(motions[name].values[:, :n], motions[name].values[:, n : 2 * n])
        for name in ("peak", "peak_drift")
    )
    columns = {name: (FLOOR, values) for name, values in peaks.items()}
    for end in ("", "_standard_error"):
        columns[f"drift_amplification{end}"] = (ELEMENT, drifts[f"amplification{end}"])
    # The yield drift is the mean peak drift over the ductility; compared without a division.
    most = motions.peak_drift.max("path") * motions.ductility
    stayed = not bool((most > motions.peak_drift_mean).any())
    table = xr.Dataset(columns, coords=own[["peak_mean", "ductility"]].coords)
    status = np.int8(labels.ELASTIC_LIMIT if stayed else labels.CONVERGED)
    attrs = {key: value for key, value in motions.attrs.items() if not key.startswith("structure_")}
    return table.assign(ductility=own.ductility, status=status).assign_attrs(attrs)


@np.errstate(invalid="ignore")  # infinite if the structure falls in a motion
def _ratios(inelastic: Array, elastic: Array) -> dict[str, Array]:
    """Means of peaks (motions, n), their ratio, and standard errors; that of the ratio from pairs."""
    scale = np.sqrt(len(inelastic))
    mean, other = inelastic.mean(axis=0), elastic.mean(axis=0)
    ratio = mean / other
    left = (inelastic - ratio * elastic).std(axis=0, ddof=1)
    return {
        "amplification": ratio,
        "amplification_standard_error": left / scale / other,
        "peak_mean": mean,
        "peak_mean_standard_error": inelastic.std(axis=0, ddof=1) / scale,
        "elastic_peak_mean": other,
        "elastic_peak_mean_standard_error": elastic.std(axis=0, ddof=1) / scale,
    }
