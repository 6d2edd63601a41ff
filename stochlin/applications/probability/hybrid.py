"""Probability of pounding in a recorded motion, with energy radii from it and a random phase."""

from __future__ import annotations

import numpy as np
import xarray as xr

from stochlin.applications.probability.formulas import gaps_in_a_row, over_gaps
from stochlin.applications.records.cells import ONE_STRUCTURE, check_structure
from stochlin.applications.records.gaps import recorded_gap
from stochlin.applications.records.ground_fit import ground_of_record
from stochlin.applications.records.response import respond
from stochlin.kernels.basics.arrays import Array
from stochlin.kernels.probability import beyond_phase, concentration, least_phase
from stochlin.models.grounds import Ground
from stochlin.models.parameters import expect
from stochlin.models.states import NotLinearizedError
from stochlin.models.structures import AnyStructure, Gap, Structure
from stochlin.solver.correlation.correlation import correlate
from stochlin.solver.linearization.strength import strength_in_metres
from stochlin.solver.linearization.transient_systems import TIME
from stochlin.solver.tables import labels
from stochlin.solver.tables.checks import check_scalars

RECORD_POINTS_PER_PERIOD = 16
HYBRID_TOLERANCE = 1e-6  # relative tolerance of the search for a gap


def hybrid_pounding(
    first: AnyStructure,
    second: AnyStructure,
    ground: Ground | None,
    distance: Gap,
    record: xr.DataArray | None,
    confidence: float,
) -> xr.Dataset:
    """Dataset of `pounding_probability` by the hybrid method.

    For a phase difference ``D`` in [0, pi] of the two structures, ``u_1 - u_2`` reaches an
    amplitude ``A(t, D)`` once in each cycle, which increases with ``D``. If ``D`` is the same
    during the whole record, there was pounding if ``D`` exceeds the smallest phase difference that
    leads to pounding at some instant until then. The phase differences have the correlation of
    linearization, or that of the record itself if a law cannot be linearized.
    """
    for role, structure in (("first", first), ("second", second)):
        expect(structure, Structure, role)
        check_scalars(structure, role, ONE_STRUCTURE)
    if record is None:
        raise ValueError("record is missing; method='hybrid' needs one, such as from read_record")
    if ground is None:
        ground = ground_of_record(record)
    expect(ground, Ground, "ground")
    left = _in_metres(first, ground, "first")
    right = _in_metres(second, ground, "second")
    period = min(float(left.arrays()["period"]), float(right.arrays()["period"]))
    step = float(record["time"][1] - record["time"][0])
    refine = max(1, int(np.ceil(RECORD_POINTS_PER_PERIOD * step / period)))
    motions = [respond(structure, record, refine=refine) for structure in (left, right)]
    radius_1 = motions[0].radius.to_numpy()
    radius_2 = motions[1].radius.to_numpy()
    recorded = recorded_gap(left, right, record)
    try:
        rho = float(correlate(left, right, ground, bias=False).rho)
    except NotLinearizedError:
        rho = float(recorded.rho)
    k = concentration(min(max(rho, -1.0), 1.0))
    phase = least_phase(radius_1[:, None], radius_2[:, None], gaps_in_a_row(distance))
    least = np.minimum.accumulate(phase)
    table = xr.Dataset(coords=motions[0].coords).assign(
        confidence_of_no_pounding=over_gaps(1 - beyond_phase(least, k), distance, TIME),
        radius_1=motions[0].radius,
        radius_2=motions[1].radius,
        recorded_difference=motions[0].displacement - motions[1].displacement,
        separation=recorded.separation,
        required_gap=_required(radius_1, radius_2, k, confidence),
        rho=rho,
        status=labels.status_where(distance.valid()),
    )
    table = labels.label(table.drop_attrs(deep=False)).assign_attrs(
        confidence=confidence,
        record=str(record.attrs.get("source", "record")),
        phase="von Mises distribution, mean cosine rho",
    )
    return labels.with_run_information(
        table,
        "Probability of pounding in a recorded motion, random phase",
        f"pounding_probability(method='hybrid', confidence={confidence:g})",
        {"first": left, "second": right, "ground": ground, "gap": distance},
    )


def _in_metres(structure: AnyStructure, ground: Ground, role: str) -> Structure:
    """The structure with its strength in metres, checked for the response to a record."""
    structure = strength_in_metres(structure, ground)
    check_structure(role, structure)
    assert isinstance(structure, Structure)
    return structure


def _required(radius_1: Array, radius_2: Array, k: float, confidence: float) -> float:
    """Gap [m] for a confidence over the record with one phase, by bisection."""
    low, high = 0.0, float((radius_1 + radius_2).max())
    while high - low > HYBRID_TOLERANCE * high:
        middle = 0.5 * (low + high)
        phase = least_phase(radius_1, radius_2, np.full_like(radius_1, middle)).min(keepdims=True)
        enough = 1 - float(beyond_phase(phase, k)[0]) >= confidence
        low, high = (low, middle) if enough else (middle, high)
    return high
