"""Comparison of mitigation measures against pounding in one table, and the least sufficient ones."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import chain

import numpy as np
import xarray as xr

from stochlin.applications.mitigation.mitigated_pair import (
    AS_BUILT,
    GIVEN,
    MeasureLine,
    MitigatedPair,
)
from stochlin.applications.separation.separation import NOT_AVAILABLE, VERDICT_ATTRS, verdict_of
from stochlin.kernels.basics.parallel import Progress
from stochlin.messages import brief
from stochlin.models.arguments import (
    Duration,
    Metres,
    Paths,
    Probability,
    Scatter,
    Seed,
    check_label,
    checked,
)
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.measures import Measure
from stochlin.models.parameters import expect
from stochlin.models.systems import AnyStructure
from stochlin.models.uncertain import applied, median_of
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.simulation.simulation import check_repeated
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_duration

VERDICTS = "answer enough not_enough within_error not_available no_verdict"  # numbered as those of rules
SIMULATIONS = 60  # usual number of simulations of all searches together
TEXTS: dict[str, str] = {
    "kind": "as built, given, or the least that is sufficient",
    "description": "the measure with its parameters",
    "missing": "missing results of a row, and the reason",
    "link_kind": "link between both structures, or damper in one of them",
    "link_place": "floors of the link (structure.floor)",
}


@checked
def mitigate(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    duration: Duration,
    gap: Metres,
    measures: Mapping[str, Measure],
    *,
    envelope: Envelope | None = None,
    confidence: Probability = 0.9,
    scatter: Scatter = 0.0,
    paths: Paths | None = None,
    seed: Seed = 0,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compare mitigation measures against pounding in the same motions, and find the least sufficient.

    The rows of the table are the buildings as built and each given measure. Further rows are the least
    damping, added to both buildings or to one of them, and the least dashpot between both, with which
    the buildings do not touch with the probability ``confidence``. Nothing is searched if the gap is
    enough as built.

    Parameters
    ----------
    first, second, ground, duration
        As in `separation`, with numbers or `Uncertain` parameters. Oscillators with a link need a mass.
    gap : float
        Existing gap [m], positive.
    measures : mapping of str to Measure
        Measures by name; may be empty.
    envelope, confidence, scatter, paths, seed
        As in `separation`.
    progress : callable, optional
        Called with the share of the rows that is done.

    Returns
    -------
    xarray.Dataset
        Over ``measure``: ``added_damping_1`` and ``_2`` [-], and ``link_damping_constant`` [N s/m] of
        all links between both buildings together, NaN if some of their dashpots are not linear.

        Over ``measure``, by simulation: ``required_gap`` [m], and ``no_pounding_probability`` [-] with
        the existing gap, each with a 95 % interval ``_lower`` and ``_upper``; ``verdict`` on the gap.
        By linearization: ``rho`` [-] and ``relative_displacement_std`` [m]. The coordinates ``kind``,
        ``description`` and ``missing`` are texts. A row whose search found nothing is NaN.

        For measures with links or dampers, over ``measure`` and ``link``, its place in the list: the
        texts ``link_kind`` and ``link_place``, the floors as structure.floor; ``peak_link_force`` [N],
        ``peak_link_stroke`` [m] and ``link_energy`` [J], which it dissipates in a motion, each as
        ``_mean`` and 95 % ``_quantile`` over the simulated motions without contact. Cells beyond the
        links of a measure are NaN.

    Raises
    ------
    ValueError, TypeError
        If a gap, mass or measure is out of range, missing or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    Strengths are converted to metres as built. All results are for motions without contact: what a
    bumper changes is computed by `pound`, with its contact and with the gap less its thickness.
    Linearization is unsafe if structures yield and is given for comparison. A least measure is the first
    that is enough as the damping grows from zero.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for links and supplemental damping.

    Examples
    --------
    >>> import stochlin as sl
    >>> one, two = (sl.Bilinear(T, 0.05, 0.05, reduction_factor=3, mass=1e6) for T in (0.6, 1.0))
    >>> measures = {"dampers": sl.Measure(0.1, 0.1), "dashpot": sl.Measure(link=sl.Link(0.0, 5e6))}
    >>> ground = sl.named_ground("firm", intensity=0.01)
    >>> table = sl.mitigate(one, two, ground, 20.0, 0.08, measures, paths=128)
    >>> bool((table.required_gap.isel(measure=slice(1, 3)) < table.required_gap[0]).all())
    True
    >>> table.measure.values[-1].item()
    'least dashpot between'
    """
    _check(measures)
    usual = median_of(ground)
    left, right = (
        applied(lambda s: strength_in_metres(s, usual), structure) for structure in (first, second)
    )
    both = {"first": median_of(left), "second": median_of(right)}
    check_duration(duration, both)
    simulations = len(measures) + SIMULATIONS
    motion = {"duration": duration, "envelope": envelope, "scatter": scatter, "seed": seed}
    pair = MitigatedPair(
        structures=(left, right),
        ground=ground,
        gap=float(gap),
        motion={**motion, "quantiles": [confidence]},
        paths=check_repeated([*both.values()], usual, duration, paths, simulations),
    )
    lines = [MeasureLine(AS_BUILT, AS_BUILT, Measure())]
    for name, measure in measures.items():
        try:
            pair.system(measure)
        except ValueError as error:
            raise ValueError(f"measures[{brief(name)}]: {error}") from error
        lines.append(MeasureLine(name, GIVEN, measure))
    searches = pair.searches()
    tables = []
    for line in chain(lines, map(pair.least, searches)):
        tables.append(pair.row(line))
        if progress is not None:
            progress(len(tables) / (len(lines) + len(searches)))
    return labels.with_run_information(
        _table(tables, confidence).assign_attrs(
            gap_m=float(gap),
            confidence=confidence,
            **labels.of_scatter(scatter),
            duration_s=duration,
            paths=pair.built.sizes["path"],
            seed=seed,
        ),
        f"Measures against pounding, {usual.name} ground",
        f"mitigate(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        {"first": first, "second": second, "ground": ground},
    )


def _check(measures: Mapping[str, Measure]) -> None:
    """Raise an error unless these are measures by name."""
    if not isinstance(measures, Mapping):
        raise TypeError(f"measures = {brief(measures)}; allowed: a mapping of them by name")
    for name, measure in measures.items():
        check_label("the name of a measure", name)
        expect(measure, Measure, f"measures[{brief(name)}]")


def _table(rows: list[xr.Dataset], confidence: float) -> xr.Dataset:
    """The rows, one below the other; what a row does not have is NaN."""
    table = xr.concat(
        rows, "measure", data_vars="all", coords="minimal", compat="override", join="outer"
    )
    known = table.required_gap.notnull()
    verdict = verdict_of(table.data_vars, confidence).where(known, NOT_AVAILABLE)
    table["verdict"] = verdict.astype(np.int8)
    table["status"] = labels.status_where(known, labels.NOT_CONVERGED)
    table = labels.label(table)
    table.verdict.attrs = {**VERDICT_ATTRS, "flag_meanings": VERDICTS}
    for name, text in TEXTS.items():
        if name in table:
            table[name] = table[name].fillna("").astype(str).assign_attrs(long_name=text)
    return table.set_coords([name for name in TEXTS if name in table])
