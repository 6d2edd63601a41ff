"""Comparison of mitigation measures against pounding in one table, and the least sufficient ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.analyses.linearization.strength import strength_in_metres
from stochlin.analyses.mitigation.devices import TEXTS as OF_DEVICES
from stochlin.analyses.mitigation.devices import devices_table
from stochlin.analyses.mitigation.mitigated_pair import RECORDED, MitigatedPair
from stochlin.analyses.mitigation.searches import MeasureLine, Search, searches
from stochlin.analyses.mitigation.variables import VARIABLES
from stochlin.analyses.pounding.rows import checked_buildings
from stochlin.analyses.records.records import checked_record
from stochlin.analyses.separation.separation import NOT_AVAILABLE, VERDICT_ATTRS, verdict_of
from stochlin.analyses.simulation.simulation import check_repeated
from stochlin.analyses.tables import labels
from stochlin.analyses.tables.checks import check_existing
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
    is_number,
)
from stochlin.models.contacts import Contact
from stochlin.models.envelopes import Envelope
from stochlin.models.grounds import Ground
from stochlin.models.links import Link
from stochlin.models.measures import Measure
from stochlin.models.parameters import expect
from stochlin.models.structures import Structure
from stochlin.models.systems import AnyStructure
from stochlin.models.uncertain import applied, median_of

AS_BUILT = "as built"
VERDICTS = "answer enough not_enough within_error not_available no_verdict"  # numbered as those of rules
SIMULATIONS = 60  # usual number of simulations of all searches together
TEXTS: dict[str, str] = {
    "kind": "as built, given, or the least that meets an aim",
    "aim": "aim of the least measure: the confidence, or the limit of amplification in the records",
    "contact": "contact between the buildings",
    "description": "the measure with its parameters",
    "missing": "missing results of a row, and the reason",
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
    paths: Paths = 2048,
    seed: Seed = 0,
    contact: Contact | None = None,
    records: Mapping[str, xr.DataArray] | None = None,
    amplification_limit: float | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Compare mitigation measures against pounding in the same motions, and find the least sufficient.

    The rows of the table are the buildings as built and each given measure. Further rows are the least
    damping, added to both buildings or to one of them, and the least dashpot between both, with which
    the buildings do not touch with the probability ``confidence``. With an amplification limit, there
    are also the least measures that keep it in the records. There is no search for an aim that is met as
    built.

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
    amplification_limit : float, optional
        Largest allowed peak in the records over the peak as built without neighbours [-], positive.
    progress : callable, optional
        Called with the share of the rows that is done.

    Returns
    -------
    xarray.Dataset
        Over ``measure``, the parameters of the measure: ``added_damping_1`` and ``_2``,
        ``stiffening_1`` and ``_2``, ``strengthening_1`` and ``_2`` [-], ``bumper_thickness`` [m]; for
        all links between both buildings together ``links`` (their number), ``link_stiffness`` [N/m],
        ``link_damping_constant`` [N (s/m)^a] and ``link_damping_exponent`` a [-]; for all devices in
        each building likewise ``devices_1``, ``device_stiffness_1`` [N/m],
        ``device_damping_constant_1`` [N (s/m)^a] and ``device_damping_exponent_1`` [-], and ``_2``.
        Damping constants with different exponents cannot be added and are NaN.

        Over ``measure``, by simulation: ``required_gap`` [m], and ``no_pounding_probability`` [-] with
        the existing gap, each with a 95 % interval ``_lower`` and ``_upper``; ``verdict`` on the gap;
        ``peak_mean_1`` and ``_2`` [m] without contact, with standard errors. By linearization: ``rho``
        [-] and ``relative_displacement_std`` [m]. The coordinates ``kind``, ``aim``, ``contact``,
        ``description`` and ``missing`` are texts. A row whose search found nothing is NaN.

        For measures with links, dampers or bumpers, over ``measure`` and ``device``: the texts
        ``device_kind`` and ``device_place``, the floors as structure.floor; ``device_force`` [N],
        ``device_stroke`` [m] and ``device_energy`` [J], which it dissipates in a motion, each as
        ``_mean`` and ``_mean_standard_error`` over the simulated motions, and as their 95 %
        ``_quantile`` with the 95 % interval ``_lower`` and ``_upper``. Links and dampers are in all
        motions, without contact; bumpers in the first 256, with contact and median parameters, and
        with zeros in motions without an impact. Cells beyond the devices of a measure are NaN. With
        records there are also ``device_force``, ``device_stroke`` and ``device_energy`` in each
        ``record``, with contact.

        With records, over ``measure`` and ``record``: ``amplification_1`` and ``_2`` [-], the peak over
        the peak as built without neighbours; ``impacts``, ``largest_force`` [N] and
        ``deepest_compression`` [m] of the contact; ``largest_link_force`` [N] of any link or device.

    Raises
    ------
    ValueError, TypeError
        If a gap, limit, mass or measure is out of range, missing or of the wrong kind; otherwise as in
        `separation`.

    Notes
    -----
    Strengths are converted to metres as built; stiffening and strengthening change them as described in
    `Measure`. Peaks, required gaps and probabilities are for motions without contact and do not depend
    on the kind of contact; the effect of bumpers shows only in the records. Linearization is unsafe if
    structures yield and is given for comparison. A least measure is the first that meets its aim as the
    damping grows from zero.

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
    left, right = _checked(first, second, ground, measures, contact, records, amplification_limit)
    both = [median_of(structure) for structure in (left, right)]
    check_existing(gap, duration, dict(zip(("first", "second"), both, strict=True)))
    check_repeated(both, median_of(ground), duration, paths, len(measures) + SIMULATIONS)
    if progress is not None:
        progress(0.0)
    site = MitigatedPair(
        structures=(left, right),
        ground=ground,
        gap=float(gap),
        confidence=confidence,
        motion={
            "duration": duration,
            "envelope": envelope,
            "scatter": scatter,
            "paths": paths,
            "seed": seed,
        },
        contact=contact,
        records=records or {},
    )
    for name, measure in measures.items():
        try:
            site.check(measure)
        except (TypeError, ValueError) as error:
            raise type(error)(f"measures[{brief(name)}]: {error}") from error
    lines = [MeasureLine(AS_BUILT, AS_BUILT, Measure())]
    for name, measure in measures.items():
        lines.append(MeasureLine(name, "given", measure, missing=_missing(site, measure)))
    wanted: list[MeasureLine | Search] = [*lines, *searches(site, amplification_limit)]
    rows, columns, devices = [], [], []
    for done, each in enumerate(wanted, start=1):
        row = each.result() if isinstance(each, Search) else each
        column, of_row, note = _column(site, row)
        rows.append(row._replace(missing="; ".join(filter(None, [row.missing, note]))))
        columns.append(column)
        devices.append(of_row)
        if progress is not None:
            progress(done / len(wanted))
    models = {"first": first, "second": second, "ground": ground}
    return labels.with_run_information(
        _table(rows, columns, devices, site).assign_attrs(
            gap_m=float(gap),
            confidence=confidence,
            **labels.of_scatter(scatter),
            duration_s=duration,
            paths=paths,
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
    limit: float | None,
) -> list[Any]:
    """The structures, with strengths in metres, after a check of all arguments."""
    for name, mapping in (("measures", measures), ("records", records)):
        if not isinstance(mapping, Mapping) and (mapping is not None or name == "measures"):
            raise TypeError(f"{name} = {brief(mapping)}; allowed: a mapping of them by name")
    for name, measure in measures.items():
        check_label("the name of a measure", name)
        expect(measure, Measure, f"measures[{brief(name)}]")
    if records and contact is None:
        raise ValueError(
            "contact is missing, but records are given; give the contact between the buildings as built"
        )
    for name, motion in (records or {}).items():
        check_label("the name of a record", name)
        try:
            checked_record(motion)
        except (TypeError, ValueError) as error:
            raise type(error)(f"records[{brief(name)}]: {error}") from error
    for role, structure in (("first", median_of(first)), ("second", median_of(second))):
        if records and isinstance(structure, Structure) and structure.mass is None:
            raise ValueError(f"{role} cannot pound: its mass is not given; allowed: 0 < mass, in kg")
    if limit is not None and not (records and is_number(limit) and 0 < limit < np.inf):
        raise ValueError(
            f"amplification_limit = {brief(limit)}; allowed: a positive number, with contact and records"
        )
    usual = median_of(ground)
    pair = [applied(lambda s: strength_in_metres(s, usual), structure) for structure in (first, second)]
    if records:
        checked_buildings([median_of(structure) for structure in pair])
    return pair


def _missing(site: MitigatedPair, measure: Measure) -> str:
    """What is not computed for a given measure, and why."""
    notes = []
    if measure.contact is not None and not site.records:
        notes.append("the effect of a contact is only computed in records, and none is given")
    if measure.has_bumpers and site.contact_of(measure) is None:
        notes.append("forces of bumpers are only computed with a contact, and none is given")
    if measure.has_bumpers and not site.weighed:
        notes.append("forces of bumpers are only computed with the masses of both structures")
    return "; ".join(notes)


def _column(site: MitigatedPair, row: MeasureLine) -> tuple[dict[str, Any], list[dict[str, Any]], str]:
    """All variables of a row by name, those of each of its devices, and why some are missing."""
    measure = row.measure
    if measure is None:
        return {}, [], ""
    simulated, links = site.simulated(measure)
    bumpers, note = site.bumped(measure)
    devices: list[dict[str, Any]] = [
        {"device_kind": each.kind, "device_place": each.place, **each.statistics()}
        for each in [*links, *bumpers]
    ]
    column: dict[str, Any] = {
        **{name: getattr(measure, name) for name in measure.parameter_names()},
        **_sums("link{}", [link for link in measure.links if not link.within_one]),
        **_sums("device{}_1", [link for link in measure.links if link.structures == (1, 1)]),
        **_sums("device{}_2", [link for link in measure.links if link.structures == (2, 2)]),
        **simulated,
        **site.linearized(measure),
    }
    if not site.records:
        return column, devices, note
    recorded, of_records = site.recorded(measure)
    pairs = zip(devices, of_records, strict=True)
    return column | recorded, [device | each.in_records() for device, each in pairs], note


def _sums(name: str, links: Sequence[Link]) -> dict[str, float]:
    """Number and sums of stiffnesses and damping constants of links; NaN for unlike exponents."""
    exponents = {link.exponent for link in links if link.damping_constant}
    constant = sum(link.number("damping_constant") for link in links)
    return {
        name.format("s"): len(links),
        name.format("_stiffness"): sum(link.number("stiffness") for link in links),
        name.format("_damping_constant"): np.nan if len(exponents) > 1 else constant,
        name.format("_damping_exponent"): exponents.pop() if len(exponents) == 1 else np.nan,
    }


def _table(
    rows: Sequence[MeasureLine],
    columns: Sequence[Mapping[str, Any]],
    devices: Sequence[Sequence[Mapping[str, Any]]],
    site: MitigatedPair,
) -> xr.Dataset:
    def texts(name: str) -> list[str]:
        return [getattr(row, name) for row in rows]

    built = "" if site.contact is None else site.contact.describe()
    contacts = [
        row.measure.contact.describe() if row.measure and row.measure.contact else built for row in rows
    ]
    table = xr.Dataset(
        coords={
            "measure": ("measure", texts("name"), {"long_name": "measure"}),
            **{name: ("measure", texts(name)) for name in ("kind", "aim", "missing")},
            "contact": ("measure", contacts),
            "description": ("measure", [row.measure.describe() if row.measure else "" for row in rows]),
        }
    )
    if site.records:
        table = table.assign_coords(record=("record", list(site.records), {"long_name": "record"}))
    for name in columns[0]:
        blank = np.full(len(site.records), np.nan) if name in RECORDED else np.nan
        values = np.array([column.get(name, blank) for column in columns], float)
        table[name] = (("measure", "record") if name in RECORDED else ("measure",), values)
    table = table.merge(devices_table(devices, len(site.records)))
    known = table.required_gap.notnull()
    verdict = verdict_of(table.data_vars, site.confidence).where(known, NOT_AVAILABLE)
    table["verdict"] = verdict.astype(np.int8)
    table["status"] = labels.status_where(known, labels.NOT_CONVERGED)
    table = labels.label(table, VARIABLES)
    table.verdict.attrs = {**VERDICT_ATTRS, "flag_meanings": VERDICTS}
    for name, text in (TEXTS | OF_DEVICES).items():
        if name in table.coords:
            table[name].attrs["long_name"] = text
    return table
