"""Required separation of two buildings by simulation, compared with that by every rule."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from operator import and_
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.records.cells import checked_motions
from stochlin.applications.records.gaps import recorded_gap
from stochlin.applications.separation.code_gaps import CODE_TEXTS, Rule, inputs_in_words, rules_with
from stochlin.applications.separation.rules import PairInMotion, all_rules
from stochlin.applications.separation.storeys import site_with_storeys
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.basics.parallel import Progress, part_of
from stochlin.messages import brief, hint
from stochlin.models.arguments import (
    Duration,
    Paths,
    Probability,
    Scatter,
    Seed,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground, scatter_of
from stochlin.models.rules.codes import BOTH, Site
from stochlin.models.structures import AnyStructure
from stochlin.models.uncertain import median_of
from stochlin.solver.simulation.prepared import MOST_MOTIONS, FiniteMotion, PreparedStructures
from stochlin.solver.simulation.statistics import (
    keeping_apart,
    mean_with_error,
    pair_separation,
    quantile_interval,
    required_gaps,
    separation_at,
)
from stochlin.solver.tables import labels
from stochlin.solver.tables.cells import over_cells
from stochlin.solver.tables.checks import (
    check_duration,
    check_scalars,
    standing,
)
from stochlin.solver.tables.lazy import arrays_of

RULE_VERDICTS = (
    "answer at_least_the_answer less_than_the_answer within_error not_available no_verdict"
)
ANSWER, AT_LEAST_ANSWER, LESS_THAN_ANSWER, WITHIN_ERROR, NOT_AVAILABLE, NO_VERDICT = range(6)
VERDICT_ATTRS: Mapping[str, Any] = {
    "long_name": "whether the gap has the confidence",
    "flag_values": np.arange(6, dtype=np.int8),
    "flag_meanings": RULE_VERDICTS,
}
SET_BACK = "Set-back of one building from its property line"
COMMENT_ON_CODES = (
    "A code's combination of simulated peaks: the peaks that are not exceeded with the confidence, "
    "combined as the code combines displacements of its own. This is not the gap that the code "
    "asks for, and it has no verdict."
)
SIMULATION_ASSUMPTIONS = "nonlinear simulation of the given models"
# arguments of `code_gaps` that describe the buildings and the site
CODE_ARGUMENTS = (*BOTH, "height_1", "height_2", "storeys_1", "storeys_2", "zone", "design_pga")
BEFORE_RECORDS = 0.8  # share of the work before the records, if there are any
MOTION_ATTRS = ("paths", "seed", "step_s", "duration_s", "envelope")
RULE_TEXTS: Mapping[str, str] = {
    "kind": "simulation, first passage, eq. (3) with a correlation, response spectrum analysis, "
    "linearization, or building code",
    **CODE_TEXTS,
    "missing": "why a rule has no answer",
}


@checked(uncertain=True, in_metres=True)
def separation(
    first: AnyStructure,
    second: AnyStructure | None,
    ground: Ground,
    duration: Duration,
    *,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter | None = None,
    paths: Paths | None = None,
    seed: Seed = 0,
    codes: Mapping[str, Any] | None = None,
    records: Any = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Gap that two buildings require, by simulation and by every rule.

    The gap by simulation is the quantile of ``max(u_1 - u_2)`` at the probability ``confidence``,
    in motions of this duration from rest, with ``first`` on the left. The rules use the quantiles
    of the simulated peaks of the same buildings at the same probability. The table has the error of
    each rule, and the share of the motions in which its gap prevents pounding.

    If ``second`` is None, the result is the set-back of one building: the distance from the
    property line on its right that ``max(u_1)`` of all its floors does not exceed.

    Parameters
    ----------
    first, second : Bilinear, BoucWen, Hysteretic or ShearBuilding, or None for ``second``
        Structures; a ``reduction_factor`` refers to the stationary ground. If ``second`` is None,
        ``first`` stands alone.
    ground : WhiteNoise, KanaiTajimi or CloughPenzien
        Ground. All parameters broadcast by dimension name; each cell is simulated separately.
        Parameters of structures and ground may be `Uncertain`, as in `simulate`; the rules are then
        applied to the structures at their medians.
    duration : float
        Length of each motion [s], at least a period of the structures.
    envelope : AminAng, ShinozukaSato or GammaEnvelope, optional
        Envelope of the motions; without it they are stationary from their start.
    confidence : float
        Required probability of no pounding, between 0 and 1.
    scatter : float
        As in `simulate`, by default that of the ground. It is included in the simulated gap and in
        the peaks for the rules.
    paths : int, optional
        Number of motions. By default so many that they take half a second on one core, 256 to 2048,
        and more of them, to 2048, until the 95 % interval of the gap is within 10 % of it; 2048 in
        a table.
    seed : int
        As in `simulate`.
    codes : mapping, optional
        What rules of building codes ask besides the peaks, by the names of the arguments of
        `code_gaps`: ``height_1`` and ``height_2``, ``storeys_1`` and ``storeys_2`` of oscillators;
        ``floors_align``, ``same_property``, ``same_system``; ``zone``, ``design_pga``; and
        ``numbers`` of rules.
    records : DataArray, or list or mapping of them, optional
        Recorded motions [m/s^2] over ``time`` [s], as from `read_record`.
    progress : callable, optional
        Called with the share of a simulation that is done.

    Returns
    -------
    xarray.Dataset
        Over ``rule``, of which the first is the simulation: ``gap`` [m]; ``gap_lower`` and
        ``gap_upper`` [m], the 95 % interval of the simulated gap; ``error`` [-], the gap over the
        simulated gap minus 1; ``no_pounding_probability`` [-] in the simulated motions with its 95
        % interval ``_lower`` and ``_upper``; ``rho`` [-] if the rule has one; ``verdict`` and
        ``status`` (flags). Building codes that define displacements of their own have neither
        probability nor verdict here, as the attribute ``comment`` says; `code_gaps` applies them.
        Coordinates along ``rule`` are ``kind``, ``family`` (of a code, as in `code_gaps`),
        ``reference``, ``mark``, ``assumptions`` and ``missing``.

        Over the dimensions of the parameters, from the simulation: ``peak_1`` and ``_2`` [m], the
        quantiles that the rules use; ``peak_mean_1`` and ``_2`` and ``separation_mean`` [m], with
        standard errors; ``separation_samples`` [m], also over ``path``; ``ductility_1`` and ``_2``
        [-], of the mean peaks; ``yield_displacement_1`` and ``_2`` [m]; ``reduction_factor_1`` and
        ``_2`` [-]; if a structure can fall, as in `simulate`, ``collapse_probability_1`` and ``_2``
        [-]. With records, over ``record``, the variables of `recorded_gap` with the prefix
        ``record_``.

        For buildings with storeys also ``gap_at_height`` [m] over ``rule`` and ``height`` [m], that
        of the simulation with a 95 % interval ``_lower`` and ``_upper``; ``governing_height`` [m]
        over ``rule``; and over ``element``, for every storey, ``peak_drift_mean`` [m] with its
        standard error and ``ductility`` [-].

        For one building alone, the variables ending in ``_2`` are left out, the heights are those
        of its floors, and rules that do not cover one building are NaN, with the reason in
        ``missing``.

    Raises
    ------
    ValueError, TypeError
        If a number is out of range, the duration is shorter than a period, an argument is given for
        a second building that is None, or the simulation would need too much time or memory.

    Notes
    -----
    The verdict on a rule is that it gives at least the answer, or less, if the 95 % interval of its
    probability of no pounding is above or below the confidence. With scatter, the peaks for the
    rules include it; correlations for stationary motions, and the rules ``eq_3_paper``, ``cqc`` and
    ``linearization``, which use no simulated peaks, are for motions of the median strength.

    The rule ``eq_3_paper`` is the procedure of the paper: eq. (3) with the elastic peaks times
    ``D`` of Fig. 5b, and ``rho`` of Fig. 5a, both by linearization with the Gaussian closure. The
    elastic peaks are the quantiles of ``|u|`` of the elastic structures by Vanmarcke's peak factor.
    The rule ``linearization`` has the same standard deviations and ``rho``, but one peak factor,
    that of ``u_1 - u_2`` of the yielding structures in one direction. If this were also the factor
    of both elastic peaks, the two gaps would be equal. Buildings with storeys have no
    ``eq_3_paper``.

    The rule ``cqc`` is the response spectrum analysis of both buildings together, as a code's user
    would do it if programs could: all modes of both are elastic, also where the structures yield,
    whose displacements are then those of the elastic structure (the equal displacement rule). The
    gap is the root of ``sum_ij d_i d_j rho_ij D_i D_j``, with the quantiles ``D`` of the peaks of
    the oscillators of the modes by Vanmarcke's peak factor, their correlations on the ground, and
    the shares ``d`` of ``D`` in ``u_1 - u_2`` at the height. ``rho`` is the correlation of both
    displacements by the same sum. For elastic oscillators it is ``eq_3_paper``; for one building it
    is the CQC of each floor. For 30 elastic pairs it was -2 to +13 % off the simulated gap, for
    yielding ones -87 to +141 %.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), eqs. (3) and (4); the coordinate ``reference`` for each rule.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.6, 1.0))
    >>> table = sl.separation(one, two, sl.named_ground("firm", intensity=0.01), 20.0, paths=256)
    >>> bool(table.gap.sel(rule="share_of_sum") > table.gap.sel(rule="simulation"))
    True
    >>> alone = sl.separation(two, None, sl.named_ground("firm", intensity=0.01), 20.0, paths=256)
    >>> bool(alone.gap.sel(rule="asce_7") > alone.gap.sel(rule="simulation"))  # |u| and u
    True
    """
    if records is not None:
        checked_motions(records)
    by_role = standing(first, second)
    alone = second is None
    medians = {role: median_of(structure) for role, structure in by_role.items()}
    facts = _facts_of(codes)
    numbers = facts.pop("numbers", None)
    rules = rules_with(numbers)
    site = Site(0.0, None if alone else 0.0, **facts)  # until the peaks are simulated
    check_scalars(site, "separation", "a number")
    check_duration(duration, medians)
    inputs = inputs_in_words(site, numbers)
    if any(structure.has_storeys for structure in medians.values()):
        site = site_with_storeys(site, list(medians.values()))

    # All cells of a table have the same number of motions.
    count = paths or (MOST_MOTIONS if arrays_of({**by_role, "ground": ground}) else None)
    motion = FiniteMotion(duration, envelope, scatter_of(ground, scatter), seed)

    def of_cell(ground: Ground, **by_role: AnyStructure) -> xr.Dataset:
        with np.errstate(all="ignore"):  # overflow by extreme input shows in the status
            prepared = PreparedStructures.of(by_role, ground, motion, count)
            part = part_of(progress, 0.0, 1.0 if records is None else BEFORE_RECORDS)
            motions = prepared.enough(confidence, part)
            pair = PairInMotion(prepared, motions, confidence, site)
            table = _judged(all_rules(pair, rules), pair)
            if "input_factor" in motions:
                table["input_factor"] = motions.input_factor
            table.attrs = {name: motions.attrs[name] for name in MOTION_ATTRS}
            table.attrs |= labels.of_scatter(motion.scatter)
            if records is None:
                return table
            left = pair.structures[0]
            right = None if pair.alone else pair.structures[1]
            part = part_of(progress, BEFORE_RECORDS, 1.0)
            recorded = recorded_gap(left, right, records, progress=part)
            recorded = recorded.drop_dims("quantile", errors="ignore")
            return table.assign({f"record_{name}": recorded[name] for name in recorded.data_vars})

    models: dict[str, Any] = {**by_role, "ground": ground}
    long_enough = reduce(
        and_, (structure.first_period() <= duration for structure in medians.values())
    )
    table = over_cells(of_cell, models, long_enough)
    table["verdict"] = table.verdict.where(table.gap.notnull(), NOT_AVAILABLE).astype(np.int8)
    table = labels.label(table)
    table.verdict.attrs = VERDICT_ATTRS
    for name, text in RULE_TEXTS.items():
        table[name].attrs["long_name"] = text
    return labels.with_run_information(
        table.assign_attrs(confidence=confidence, comment=COMMENT_ON_CODES),
        f"{SET_BACK if alone else 'Separation of two buildings'} by rule, "
        f"{median_of(ground).name} ground",
        f"separation(duration={duration:g}, confidence={confidence:g}, "
        f"paths={table.attrs['paths']}, seed={seed}{inputs and f', {inputs}'})",
        models,
    )


def _facts_of(codes: Mapping[str, Any] | None) -> dict[str, Any]:
    """What rules of codes ask, with names that are known."""
    if not isinstance(codes, Mapping | None):
        raise TypeError(
            f"codes = {brief(codes)}; allowed: a mapping with {', '.join(CODE_ARGUMENTS)}, numbers"
        )
    facts = dict(codes or {})
    if unknown := [name for name in facts if name not in (*CODE_ARGUMENTS, "numbers")]:
        what = f"codes has {brief(unknown[0])}, which is not known"
        allowed = f"{', '.join(CODE_ARGUMENTS)}, numbers"
        raise ValueError(f"{what}; {hint(unknown[0], CODE_ARGUMENTS)}allowed: {allowed}")
    return facts


def verdict_of(shares: Mapping[Any, xr.DataArray], confidence: float) -> xr.DataArray:
    """Verdict by a 95 % interval of the probability of no pounding: enough, too low, undecided."""
    lower = shares["no_pounding_probability_lower"]
    upper = shares["no_pounding_probability_upper"]
    below = upper < confidence
    above = lower >= confidence
    undecided = xr.where(below, LESS_THAN_ANSWER, WITHIN_ERROR)  # type: ignore[no-untyped-call]
    verdict: xr.DataArray
    verdict = xr.where(above, AT_LEAST_ANSWER, undecided)  # type: ignore[no-untyped-call]
    return verdict


def judged_rules(
    rules: Sequence[Rule], samples: xr.DataArray, confidence: float, required: float
) -> xr.Dataset:
    """The gaps of rules, judged by simulated motions that need ``samples`` [m].

    ``required`` is the gap by simulation [m], whose interval is not known here.
    """
    gap = xr.DataArray([rule.gap for rule in rules], dims="rule")
    shares = keeping_apart(samples, gap)
    answered = gap.notnull()
    judged = xr.DataArray([rule.judged for rule in rules], dims="rule")
    verdict = verdict_of(shares, confidence).where(judged, NO_VERDICT)
    verdict = verdict.where(answered, NOT_AVAILABLE)
    columns = {name: ("rule", [getattr(rule, name) for rule in rules]) for name in RULE_TEXTS}
    return xr.Dataset(
        {
            "gap": gap,
            **{f"gap_{end}": xr.full_like(gap, np.nan) for end in labels.ENDS},
            "error": gap / (required if 0 < required < np.inf else np.nan) - 1,
            **{name: share.where(answered & judged) for name, share in shares.items()},
            "rho": ("rule", [rule.rho for rule in rules]),
            "verdict": verdict.astype(np.int8),
            "status": labels.status_where(answered),
        },
        coords={"rule": ("rule", [rule.name for rule in rules]), **columns},
    )


def _judged(rules: list[Rule], pair: PairInMotion) -> xr.Dataset:
    """Table of the simulated gap and the gaps of rules, each judged by the simulated motions."""
    motions = pair.motions
    samples = pair_separation(motions)
    required, lower, upper = required_gaps(motions)
    gap = np.array([required])
    simulation = Rule("simulation", "simulation", gap, assumptions=SIMULATION_ASSUMPTIONS)
    rules = [simulation, *rules]
    table = judged_rules(rules, samples, pair.confidence, required)
    table.verdict[0] = ANSWER
    for end, value in (("lower", lower), ("upper", upper)):
        table[f"gap_{end}"][0] = value
    table["separation_samples"] = samples
    table = table.assign(pair.quantities())
    names = ("separation_mean", "separation_mean_standard_error")
    mean_and_error = mean_with_error(samples.values)
    for name, value in zip(names, mean_and_error, strict=True):
        table[name] = value if pair.alone else float(motions[name][0, 1])
    return table if np.isnan(pair.heights).all() else table.merge(_by_height(rules, pair))


def _by_height(rules: list[Rule], pair: PairInMotion) -> xr.Dataset:
    """Gaps by simulation and by the rules at each height, and peaks of both structures there."""
    samples = separation_at(pair.motions, pair.heights)
    simulated, *interval = quantile_interval(samples.values, pair.confidence)
    peaks = xr.DataArray(pair.peaks, dims=("structure", "height"))
    table = gaps_by_height([simulated, *(rule.gaps for rule in rules[1:])], pair.heights)
    unknown = np.full((len(rules) - 1, simulated.size), np.nan)
    for end, values in zip(("lower", "upper"), interval, strict=True):
        table[f"gap_at_height_{end}"] = ("rule", "height"), np.vstack([values, unknown])
    table = table.assign({f"peak_at_height_{n + 1}": peaks[n] for n in range(len(pair.peaks))})
    return table.assign_coords(height=samples.height)


def gaps_by_height(gaps: Sequence[Array], heights: Array) -> xr.Dataset:
    """Gap of each rule at each height [m], and the height where it is largest [m]."""
    gaps = [np.broadcast_to(row, heights.shape) for row in gaps]
    return xr.Dataset(
        {
            "gap_at_height": (("rule", "height"), np.array(gaps)),
            "governing_height": ("rule", [_where_largest(row, heights) for row in gaps]),
        },
        coords={"height": heights},
    )


def _where_largest(gaps: Array, heights: Array) -> float:
    return np.nan if np.isnan(gaps).any() else float(heights[int(np.argmax(gaps))])
