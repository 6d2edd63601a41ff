"""Probability of pounding in a finite motion, by formula and by simulation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import and_
from typing import Annotated, Any, Literal

import xarray as xr

from stochlin.applications.probability.formulas import by_formula, checked_gaps
from stochlin.applications.probability.hybrid import hybrid_pounding
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.messages import refuse
from stochlin.models.arguments import (
    Duration,
    Points,
    Probability,
    Scatter,
    Seed,
    Whole,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.parameters import Parameter, expect
from stochlin.models.structures import DRIFT, GAUSSIAN, AnyStructure, Gap
from stochlin.models.uncertain import median_of
from stochlin.solver.linearization.levels import why_no_drift
from stochlin.solver.linearization.transient_response import IN_TIME, InTime
from stochlin.solver.linearization.transient_systems import (
    POINTS,
    TIME,
    check_course,
    course_of,
    over_time,
)
from stochlin.solver.simulation.prepared import MOST_MOTIONS, FiniteMotion, PreparedStructures
from stochlin.solver.simulation.statistics import keeping_apart, pair_separation, quantile_interval
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import check_duration
from stochlin.solver.tables.lazy import arrays_of

Method = Literal["evolutionary", "hybrid"]
PathsIfAny = Annotated[int, Whole(0)]  # 0 for no simulation
STEM = "confidence_of_no_pounding"
PROGRESS_OF_FORMULA = 0.5  # share of the progress that the formula has beside a simulation
PASSAGE_REFERENCES = (
    f"{labels.PAPER} Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice, S. O. (1945), Bell Syst. "
    "Tech. J. 24; Roberts, J. B. and Spanos, P. D. (1990). Random vibration and statistical "
    "linearization."
)


@checked(uncertain=True, in_metres=True)
def pounding_probability(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground | None,
    gap: Parameter,
    *,
    envelope: Envelope | None = None,
    duration: Duration | None = None,
    method: Method = "evolutionary",
    record: xr.DataArray | None = None,
    confidence: Probability = 0.9,
    closure: InTime | None = None,
    scatter: Scatter | None = None,
    points: Points = POINTS,
    paths: PathsIfAny | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Probability that two structures pound in a motion of finite duration.

    The structure ``first`` is on the left; there is pounding when ``u_1 - u_2`` exceeds the gap.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic, ModifiedClough, ShearBuilding or other structure
        The structures. All parameters of oscillators broadcast by dimension name. With a building
        with storeys the gap is checked at all heights; see the notes. For what cannot be linearized
        the result has the simulated variables only, and its attribute ``comment`` gives the reason.
        A structure that falls, because it softens after yielding, has moved beyond any gap.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        The ground before modulation. With ``"hybrid"`` it may be None; it is then fitted to the
        record.
    gap : float or array
        Gap [m], positive.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motion; without it the ground motion is stationary from its start.
    duration : float
        Duration of the motion [s], at least one period of the structures. Not for ``"hybrid"``.
    method : {"evolutionary", "hybrid"}
        ``"evolutionary"``: modulated ground motion, and response by the ``closure``. ``"hybrid"``:
        energy radii, eq. (1), of both structures in ``record``, and a random phase between them.
    record : xarray.DataArray, optional
        Ground acceleration [m/s^2] over ``time`` [s] for ``"hybrid"``, such as from `read_record`.
    confidence : float
        Probability of no pounding for ``required_gap``, between 0 and 1.
    closure : {"gaussian", "drift"}, optional
        Of the formulas: transient linearization, or the drift closure in time, as in `passage_gap`.
        By default the latter for yielding oscillators whose laws have it. Not for ``"hybrid"``.
    scatter : float
        Standard deviation [-] of the logarithm of a random factor on each motion, as in `simulate`,
        by default that of the ground. Formulas are averaged over it, and structures keep the yield
        displacement that they have for ``ground``. Not for ``"hybrid"``.
    points : int
        Number of instants of the result.
    paths, seed : int, optional
        Number of the motions of the simulation, by default as in `separation`, and their seed. With
        ``paths=0`` there is no simulation.
    progress : callable, optional
        Called with the share of the work that is done.

    Returns
    -------
    xarray.Dataset
        By formula over ``time`` [s], from rest at 0: ``instantaneous_probability`` [-], the
        probability ``1 - Phi(gap/s)`` that ``u_1 - u_2`` with the standard deviation ``s`` exceeds
        the gap, and ``confidence_of_no_pounding`` [-], the probability of no pounding so far, with
        crossings in clumps (Vanmarcke), and with the ending ``_poisson`` for independent crossings;
        the standard deviations ``displacement_std_1`` and ``_2`` and ``difference_std`` [m]; and
        ``rho`` [-], NaN at rest. Also ``envelope`` [-]. With the drift closure ``drift_std_1``,
        ``_2`` and ``difference_drift_std`` [m], the standard deviations of the slow parts, which in
        the end are those of the permanent displacements; without it ``permanent_set_left_out``, a
        flag that is 1 after the strong shaking.

        Without ``time``: ``confidence_of_no_pounding_simulated`` [-] for the whole duration, with a
        95 % interval ``_lower`` and ``_upper``; ``required_gap`` [m], also ``_simulated`` with its
        interval; and ``status``. The variables of ``"hybrid"`` are in the notes.

    Raises
    ------
    ValueError, TypeError
        If an argument is out of range or of the wrong kind, the envelope has negative values or is
        zero within the whole duration, the duration is shorter than a period, or arguments do not
        belong to the method.
    ArithmeticError
        If a single case fails; in a table the cell is NaN and its status gives the reason. Also if
        a structure cannot be linearized and there is no simulation, with ``paths=0``.

    Notes
    -----
    For linear structures the moments are exact, and the confidence has the error of the crossings
    alone. For 200 random pairs in simulated motions, at gaps that 10 to 90 % of them do not close,
    it was -0.24 to +0.06 in 95 % of the cases, and -0.49 to +0.09 in all, largest for structures of
    different periods and light damping; the gap for 90 % was off by -4 to +9 % and by -6 to +24 %.

    Two buildings are checked at the floor levels of both, up to the lower roof, because
    displacements are linear between floors. The variables ``_at_height`` are the formulas at each
    height by itself. The confidence without this ending is that of the worst height, and the
    confidence at all heights together is not larger. ``confidence_of_no_pounding_at_least`` is a
    lower bound of the latter by Boole's inequality, which adds the probabilities of pounding at all
    heights and holds for any dependence between them. Likewise, ``required_gap`` is the gap at
    ``governing_height``, and the buildings need at least this gap. The simulated results hold for
    all heights together. ``displacement_std``, ``difference_std`` and ``rho`` are those at the
    highest level.

    The errors of the drift closure are those of `passage_gap`. Transient linearization omits the
    plastic drift and the permanent displacement of yielding structures after strong shaking. For
    762 random yielding pairs (R 1 to 9, hardening 0.02 to 0.3, white noise, Kanai-Tajimi and named
    grounds, 8 to 40 s) its confidence was too large by more than 0.1 in 24 % of the cases, and by
    up to 0.97.

    The simulated confidence always has an interval, and takes a second or two with the default
    ``paths``.

    The hybrid method returns, over the time of the record: ``radius_1`` and ``radius_2`` [m], the
    energy radii of both structures; ``recorded_difference`` [m], ``u_1 - u_2`` in the record; and
    ``confidence_of_no_pounding``, with one phase for all of the record. Without time it returns
    ``rho``, ``separation`` [m], the largest ``u_1 - u_2`` in the record, and ``required_gap`` [m].
    The confidence is 0 from the instant at which the radii differ by more than the gap, since one
    structure then closes the gap for any phase. The structures are oscillators, and ``rho`` is that
    of linearization, or that of the record itself if a law cannot be linearized.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eq. (1); Vanmarcke, E. H. (1975), J. Appl. Mech. 42; Rice
    (1945).

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
    >>> quake = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "duration": 25.0}
    >>> table = sl.pounding_probability(
    ...     one, two, sl.named_ground("firm", 0.01), 0.3, paths=256, **quake
    ... )
    >>> last = table.isel(time=-1)
    >>> bool(last.confidence_of_no_pounding > last.confidence_of_no_pounding_poisson)
    True
    """
    distance = checked_gaps(gap)
    if method == "hybrid":
        refuse(
            "method",
            method,
            {
                "envelope": envelope,
                "duration": duration,
                "scatter": scatter or None,
                "closure": closure,
            },
        )
        return hybrid_pounding(first, second, ground, distance, record, confidence)
    refuse("method", method, {"record": record})
    expect(median_of(ground), Ground, "ground")
    scatter = scatter_of(ground, scatter)
    if paths == 1:
        raise ValueError("paths = 1; allowed: 0 for no simulation, or a whole number from 2")
    models: dict[str, Any] = {"first": first, "second": second, "ground": ground}
    usual = {role: median_of(model) for role, model in models.items()}
    seconds = check_course(duration, envelope)
    cells = arrays_of({**models, "distance": distance}).values()
    taken = closure_in_time(closure, [usual["first"], usual["second"]])
    periods = [_periods(role, usual[role], seconds) for role in ("first", "second")]
    course = course_of(envelope, seconds, min(float(period.min()) for period in periods), points)
    motion = FiniteMotion(seconds, envelope, scatter, seed)
    # All cells of a table have the same number of motions.
    count = paths or (MOST_MOTIONS if arrays_of(models) else None)

    def of_cell(first: Any, second: Any, ground: Any, distance: Gap) -> xr.Dataset:
        """All results of one pair, whose gap may be an array."""
        pair = (first, second)
        if paths != 0:
            by_role = {"first": first, "second": second}
            prepared = PreparedStructures.of(by_role, ground, motion, count)
        table = xr.Dataset()
        comment = IN_TIME[taken]
        try:
            part = part_of(progress, 0.0, 1.0 if paths == 0 else PROGRESS_OF_FORMULA)
            (table,) = by_formula(pair, ground, distance, course, confidence, scatter, part, taken)
        except ArithmeticError as error:
            if paths == 0:
                raise
            comment = f"There are no formulas: {error}."
        table["status"] = labels.status_where(distance.valid())
        if paths != 0:
            motions = prepared.enough(confidence, part_of(progress, PROGRESS_OF_FORMULA, 1.0))
            table = _with_simulation(table, motions, distance, confidence)
            table = table.assign_attrs(paths=motions.sizes["path"], seed=seed)
        yields = any(median_of(structure).yields for structure in pair)
        return table.assign_attrs(comment=comment if yields else labels.CAUTION_CROSSINGS)

    usable = reduce(and_, (period.notnull() for period in periods))
    table = over_cells(of_cell, models, usable, {"distance": distance})
    order = dict.fromkeys([TIME, *(dim for array in cells for dim in array.dims)])
    table = table.transpose(*order, ..., missing_dims="ignore")
    table = over_time(table, course, drifts=taken == DRIFT)
    about = {"confidence": confidence, "closure": taken, **labels.of_scatter(scatter)}
    return labels.with_run_information(
        labels.label(table).assign_attrs(about),
        f"Confidence of no pounding in a finite motion, {usual['ground'].name} ground",
        f"pounding_probability(duration={duration:g}, confidence={confidence:g}, "
        f"paths={table.attrs.get('paths', 0)}, seed={seed})",
        {**models, "gap": distance},
        PASSAGE_REFERENCES,
    )


def _with_simulation(
    table: xr.Dataset, motions: xr.Dataset, distance: Gap, confidence: float
) -> xr.Dataset:
    """The table with the confidence and the required gap of simulated motions."""
    apart = pair_separation(motions)
    shares = keeping_apart(apart, distance.arrays()["gap"])
    table = table.assign(simulated_columns(STEM, shares, apart, distance, confidence))
    if "input_factor" in motions:  # of uncertain parameters
        table["input_factor"] = motions.input_factor
    return table


def closure_in_time(closure: InTime | None, structures: Sequence[AnyStructure]) -> str:
    """The closure for motions of finite length: by default that with the drift, if any."""
    missing = why_no_drift(structures)
    if closure == DRIFT and missing:
        raise ValueError(f"closure = {DRIFT!r}: {missing}; allowed: {GAUSSIAN!r}")
    yields = any(structure.yields for structure in structures)
    return closure or (DRIFT if yields and not missing else GAUSSIAN)


def _periods(role: str, structure: AnyStructure, duration: float) -> xr.DataArray:
    """First periods [s], NaN where they are invalid or longer than the duration."""
    check_duration(duration, {role: structure})
    period = structure.first_period()
    return period.where(structure.valid() & (period <= duration))


def simulated_columns(
    name: str,
    shares: Mapping[Any, xr.DataArray],
    samples: xr.DataArray,
    distance: Gap,
    confidence: float,
) -> dict[str, xr.DataArray]:
    """Simulated shares of motions with their intervals, and gaps [m] for a confidence with theirs.

    ``samples`` are the separations over ``path`` and the dimensions of the gaps; shares of invalid
    gaps are NaN.
    """
    columns = {
        f"{name}_simulated{end}": share.where(distance.valid())
        for end, share in zip(labels.VALUE_AND_ENDS, shares.values(), strict=True)
    }
    interval = quantile_interval(samples.values, confidence)
    for end, gaps in zip(labels.VALUE_AND_ENDS, interval, strict=True):
        columns[f"required_gap_simulated{end}"] = xr.DataArray(gaps, dims=samples.dims[1:])
    return columns
