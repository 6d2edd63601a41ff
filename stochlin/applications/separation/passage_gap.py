"""Required gap of two oscillators without simulation, by the drift closure in time."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.slabs import in_ranges
from stochlin.models.arguments import Duration, Probability, Scatter, checked
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.parameters import Parameter
from stochlin.models.structures import Gap, Structure
from stochlin.solver.correlation.levels import PairsInTime, pairs_in_time
from stochlin.solver.linearization.equivalent_systems import Oscillators, in_columns
from stochlin.solver.linearization.levels import EnvelopesInTime, in_metres, strengths, why_no_drift
from stochlin.solver.linearization.transient_systems import check_course
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import flat
from stochlin.solver.tables.checks import check_duration, standing
from stochlin.solver.tables.lazy import in_blocks

PAIRS_TOGETHER = 256  # pairs that are computed together
VARIABLES_OF_PAIRS = (
    "displacement_std_2",
    "drift_std_2",
    "difference_std",
    "difference_drift_std",
    "rho",
)
VARIABLES_OF_CELLS = (
    "required_gap",
    "required_gap_error",
    "caution",
    "displacement_std_1",
    "drift_std_1",
    "status",
)
INVALID_CELLS = {"caution": 2, "status": labels.INVALID_INPUT}  # of invalid cells; others are NaN
CAUTION_ATTRS: Mapping[str, Any] = {
    "long_name": "caution flag of the required gap",
    "flag_values": np.arange(3, dtype=np.int8),
    "flag_meanings": "usual_error larger_error ground_of_unknown_error",
}


@checked(in_metres=True)
def passage_gap(
    first: Structure,
    second: Structure | None,
    ground: Ground,
    duration: Duration,
    *,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter | None = None,
    gap: Parameter | None = None,
) -> xr.Dataset:
    """Gap that two bilinear oscillators require in a motion, without simulation.

    The displacements have a fast part, a Gaussian process by the clipped closure, and a slow
    plastic drift. The gap is that which ``u_1 - u_2`` does not exceed with the probability
    ``confidence``, with ``first`` on the left, by eqs. (14) to (21) of ``docs/drift.md``.

    Parameters
    ----------
    first, second : Bilinear, or None for ``second``
        Structures, which may be elastic. If ``second`` is None, the result is the set-back of
        ``first`` from a line on its right.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        Ground. All parameters broadcast by dimension name; with dask arrays the table is lazy.
    duration : float
        Length of the motion [s], at least a period of the structures.
    envelope, confidence, scatter
        As in `separation`.
    gap : float or array, optional
        A gap [m] whose probability of no pounding is asked for; it broadcasts with the parameters.

    Returns
    -------
    xarray.Dataset
        Over the dimensions of the parameters: ``required_gap`` [m]; ``required_gap_error`` [-], the
        mean absolute relative error in simulated pairs of the same kind, and the flag ``caution``,
        1 where errors are larger than usual; ``displacement_std_1``, ``_2`` and ``difference_std``
        [m] at the instant at which ``u_1 - u_2`` varies most; ``drift_std_1``, ``_2`` and
        ``difference_drift_std`` [m], the standard deviations of the permanent displacements at the
        end of the motion; ``rho`` [-], the correlation of the displacements while the envelope is
        at least half of its maximum; with a ``gap`` also ``no_pounding_probability`` [-]; and
        ``status``.

    Raises
    ------
    ValueError, TypeError
        If a structure has storeys, a law without the drift closure or no stiffness after yielding,
        an argument is out of range, or dimensions do not fit.
    ArithmeticError
        If a single case fails; in a table the cell is NaN.

    Notes
    -----
    Errors were measured on 900 simulated pairs. They are larger than usual, with ``caution``, for
    periods within 8 %, on grounds with a damping of 0.2 or less, for structures that are both
    stiffer than the ground, and in less than a cycle of strong shaking: see ``docs/drift.md``.

    References
    ----------
    The derivation is our own; Vanmarcke, E. H. (1975), J. Appl. Mech. 42, for crossings in clumps.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0))
    >>> ground, quake = sl.KanaiTajimi(0.42, 0.6, intensity=0.01), sl.AminAng(4, 15, 0.35)
    >>> round(float(sl.passage_gap(one, two, ground, 30.0, envelope=quake).required_gap), 2)  # m
    0.11
    """
    structures = standing(first, second)
    if missing := why_no_drift([*structures.values()]):
        raise ValueError(
            f"passage_gap: {missing}; allowed: bilinear oscillators; separation simulates others"
        )
    seconds = check_course(duration, envelope)
    check_duration(seconds, structures)
    scatter = scatter_of(ground, scatter)
    course = EnvelopesInTime.of(envelope, seconds, *strengths(scatter))
    models: dict[str, Any] = {**structures, "ground": ground}
    if gap is not None:
        models["distance"] = Gap(gap)
    table_of_cells = partial(_table_of_cells, course=course, confidence=confidence)
    table = labels.label(in_blocks(table_of_cells, models))
    table.caution.attrs = dict(CAUTION_ATTRS)
    labels.raise_if_lone_failure(table, "passage_gap", *structures.values(), ground)
    about = {"confidence": confidence, "duration_s": seconds, **labels.of_scatter(scatter)}
    shape = "none" if envelope is None else envelope.describe()
    return labels.with_run_information(
        table.assign_attrs(about, envelope_model=shape, comment=labels.CAUTION_FINITE_DRIFT),
        f"Required {'gap' if second else 'set-back'} by the drift closure in time, {ground.name} "
        "ground",
        f"passage_gap(duration={duration:g}, confidence={confidence:g})",
        models,
    )


def _table_of_cells(
    ground: Ground,
    *,
    course: EnvelopesInTime,
    confidence: float,
    distance: Gap | None = None,
    **structures: Structure,
) -> xr.Dataset:
    """Variables of `passage_gap`."""
    models: dict[str, Any] = {
        role: in_metres(structure, ground, float(course.times[-1]))
        for role, structure in structures.items()
    }
    beside = {} if distance is None else {"distance": distance}
    cells = flat({**models, "ground": ground, **beside})
    count = cells.where.size
    gaps = None if distance is None else in_columns([cells.models["distance"].gap], count)[0]
    oscillators = [Oscillators.of(cells.of_structure(role)) for role in structures]

    def part(at: slice) -> dict[str, Array]:
        pairs = pairs_in_time([structure.at(at) for structure in oscillators], ground, course)
        return _columns(pairs, confidence, None if gaps is None else gaps[at])

    if count:
        parts = in_ranges(part, count, PAIRS_TOGETHER)
        columns = {name: np.concatenate([values[name] for values in parts]) for name in parts[0]}
    else:
        names = [*VARIABLES_OF_CELLS, *(VARIABLES_OF_PAIRS if len(structures) > 1 else ())]
        names += ["no_pounding_probability"] if beside else []
        columns = {name: np.empty(0, np.int8 if name in INVALID_CELLS else float) for name in names}
    return xr.Dataset(
        {name: cells.array(row, INVALID_CELLS.get(name, np.nan)) for name, row in columns.items()}
    )


def _columns(pairs: PairsInTime, confidence: float, gaps: Array | None) -> dict[str, Array]:
    """The variables of cells (n,)."""
    first = pairs.first
    second = pairs.second
    mean = pairs.means
    variance = mean(pairs.difference)
    instant = variance.argmax(axis=0)[None]
    sides = [first] if second is None else [first, second]
    columns = {"required_gap": pairs.required_gaps(confidence)}
    columns |= {"required_gap_error": pairs.expected.error, "caution": pairs.expected.caution}
    for n, side in enumerate(sides, 1):
        variance_of_side = np.take_along_axis(mean(side.variance), instant, axis=0)[0]
        columns[f"displacement_std_{n}"] = np.sqrt(variance_of_side)
        columns[f"drift_std_{n}"] = np.sqrt(mean(side.offset)[-1])
    if second is not None:
        columns["difference_std"] = np.sqrt(np.take_along_axis(variance, instant, axis=0)[0])
        columns["difference_drift_std"] = np.sqrt(mean(pairs.moves.offset**2)[-1])
        columns["rho"] = pairs.strong_rho()
    if gaps is not None:
        stays = pairs.survival(gaps[:, None])
        columns["no_pounding_probability"] = stays[:, 0, -1]
    for name, row in columns.items():
        columns[name] = np.where(pairs.failed, INVALID_CELLS.get(name, np.nan), row)
    columns["caution"] = columns["caution"].astype(np.int8)
    columns["status"] = labels.status_where(~pairs.failed, labels.NOT_CONVERGED)
    return columns
