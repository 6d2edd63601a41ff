"""Comparison of mitigation measures against pounding in one table, and the least sufficient ones."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.mitigation.mitigated_pair import MitigatedPair
from stochlin.applications.mitigation.searches import MeasureLine, Search, searches
from stochlin.applications.pounding.rows import check_contact, checked_buildings
from stochlin.applications.records.cells import checked_motions
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
from stochlin.models.contacts import Contact
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

AS_BUILT = "as built"
VERDICTS = "answer enough not_enough within_error not_available no_verdict"  # numbered as those of rules
SIMULATIONS = 60  # usual number of simulations of all searches together
NO_RECORDS = "the effect of a contact is only computed in records, and none is given"
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
    contact: Contact | None = None,
    records: Mapping[str, xr.DataArray] | None = None,
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
    contact : Contact, optional
        Contact between the buildings as built, required with records.
    records : mapping of str to xarray.DataArray, optional
        Ground accelerations [m/s^2] by name, as from `read_record`, for which pounding is computed.
    progress : callable, optional
        Called with the share of the rows that is done.

    Returns
    -------
    xarray.Dataset
        Over ``measure``: ``added_damping_1`` and ``_2`` [-], ``bumper_thickness`` [m], and
        ``link_damping_constant`` [N s/m] of all links between both buildings together, NaN if some of
        their dashpots are not linear.

        Over ``measure``, by simulation: ``required_gap`` [m], and ``no_pounding_probability`` [-] with
        the existing gap, each with a 95 % interval ``_lower`` and ``_upper``; ``verdict`` on the gap.
        By linearization: ``rho`` [-] and ``relative_displacement_std`` [m]. The coordinates ``kind``,
        ``description`` and ``missing`` are texts. A row whose search found nothing is NaN.

        For measures with links or dampers, over ``measure`` and ``link``, its place in the list: the
        texts ``link_kind`` and ``link_place``, the floors as structure.floor; ``peak_link_force`` [N],
        ``peak_link_stroke`` [m] and ``link_energy`` [J], which it dissipates in a motion, each as
        ``_mean`` and 95 % ``_quantile`` over the simulated motions without contact. Cells beyond the
        links of a measure are NaN.

        With records, over ``measure`` and ``record``: ``amplification_1`` and ``_2`` [-], the peak over
        the peak as built without neighbours; ``impacts``, ``largest_force`` [N] and
        ``deepest_compression`` [m] of the contact; ``largest_link_force`` [N] of any link or device.

    Raises
    ------
    ValueError, TypeError
        If a gap, mass or measure is out of range, missing or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    Strengths are converted to metres as built; stiffening and strengthening change them as described in
    `Measure`. Peaks, required gaps and probabilities are for motions without contact and do not depend
    on the kind of contact; the effect of bumpers shows only in the records. Linearization is unsafe if
    structures yield and is given for comparison. A least measure is the first that is enough
    as the damping grows from zero.

    Contact between bumpers counts as pounding. With bumpers, the probability of no pounding is that of
    the gap minus their thickness, the required gap includes their thickness, and pounding in the records
    is computed with the remaining gap. A ``deepest_compression`` beyond ``bumper_thickness`` means that
    the bumpers would be crushed; their behaviour beyond this is not modelled.

    References
    ----------
    Valles-Mattox and Reinhorn (1996), for links, bumpers and supplemental damping.

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
    left, right = _checked(first, second, ground, measures, contact, records)
    both = [median_of(structure) for structure in (left, right)]
    check_duration(duration, dict(zip(("first", "second"), both, strict=True)))
    motion = {"duration": duration, "envelope": envelope, "scatter": scatter, "seed": seed}
    pair = MitigatedPair(
        structures=(left, right),
        ground=ground,
        gap=float(gap),
        motion={**motion, "quantiles": [confidence]},
        paths=check_repeated(both, median_of(ground), duration, paths, len(measures) + SIMULATIONS),
        contact=contact,
        records=records or {},
    )
    if progress is not None:
        progress(0.0)
    lines: list[MeasureLine | Search] = [MeasureLine(AS_BUILT, AS_BUILT, Measure())]
    for name, measure in measures.items():
        try:
            pair.open_gap(measure)
            pair.system(measure)
        except (TypeError, ValueError) as error:
            raise type(error)(f"measures[{brief(name)}]: {error}") from error
        missing = NO_RECORDS if measure.has_bumpers and not records else ""
        lines.append(MeasureLine(name, "given", measure, missing=missing))
    lines += searches(pair)
    tables = []
    for done, line in enumerate(lines, start=1):
        row = line.result(pair) if isinstance(line, Search) else line
        described = "" if row.measure is None else row.measure.describe()
        texts = {"kind": row.kind, "description": described, "missing": row.missing}
        results = xr.Dataset() if row.measure is None else pair.row(row.measure)
        tables.append(xr.Dataset(texts, {"measure": row.name}).merge(results))
        if progress is not None:
            progress(done / len(lines))
    models = {"first": first, "second": second, "ground": ground}
    return labels.with_run_information(
        _table(tables, confidence).assign_attrs(
            gap_m=float(gap),
            confidence=confidence,
            **labels.of_scatter(scatter),
            duration_s=duration,
            paths=pair.built.sizes["path"],
            seed=seed,
        ),
        f"Measures against pounding, {median_of(ground).name} ground",
        f"mitigate(gap={gap:g}, duration={duration:g}, confidence={confidence:g}, seed={seed})",
        models if contact is None else models | {"contact": contact},
    )


def _checked(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground,
    measures: Mapping[str, Measure],
    contact: Contact | None,
    records: Mapping[str, xr.DataArray] | None,
) -> list[Any]:
    """The structures, with strengths in metres, after a check of the other arguments."""
    for name, mapping in (("measures", measures), ("records", records)):
        if not isinstance(mapping, Mapping) and (mapping is not None or name == "measures"):
            raise TypeError(f"{name} = {brief(mapping)}; allowed: a mapping of them by name")
        for label in mapping or ():
            check_label(f"the name of a {name.removesuffix('s')}", label)
    for name, measure in measures.items():
        expect(measure, Measure, f"measures[{brief(name)}]")
    usual = median_of(ground)
    pair = [applied(lambda s: strength_in_metres(s, usual), structure) for structure in (first, second)]
    if records:
        checked_motions(records)
        check_contact("contact", contact)
        checked_buildings([median_of(structure) for structure in pair])
    return pair


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
