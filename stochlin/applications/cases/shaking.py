"""Intensity of the motions and records of a case, and warnings on implausible results."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr
from scipy import constants

from stochlin.applications.records.cells import ends_of_events
from stochlin.applications.records.components import events_of
from stochlin.applications.records.gaps import quantiles_of_records
from stochlin.applications.records.records import strong_part
from stochlin.applications.records.response import response_spectrum
from stochlin.applications.sites.elastic_spectra import USUAL_DAMPING
from stochlin.applications.sites.intensity import shaking
from stochlin.models.plausible import PLAUSIBLE
from stochlin.solver.simulation.statistics import keeping_apart
from stochlin.solver.tables import labels

if TYPE_CHECKING:
    from stochlin.applications.cases.reading.case import Case

MOST_RECORDS = 5  # records reported one by one; of more, statistics are reported
RECORD_QUANTILES = (0.5, 0.84)  # quantiles over more records, besides the confidence of the case


def shaking_of(case: Case) -> xr.Dataset:
    """Mean intensity of the motions of a case: PGA, rms, S0, and Sa at each building's period."""
    return shaking(case.site.ground, np.array(case.periods), *case.site.course[:2])


def recorded_shaking(record: xr.DataArray, periods: list[float]) -> dict[str, xr.DataArray]:
    """Intensity of a record: PGA, rms of its strong part, and Sa at periods over ``structure``."""
    shown, place = np.unique(periods, return_inverse=True)
    accelerations = response_spectrum(record, shown, USUAL_DAMPING).pseudo_acceleration.to_numpy()[
        place
    ]
    return {
        "peak_ground_acceleration": abs(record).max(),
        "rms_acceleration": (strong_part(record) ** 2).mean() ** 0.5,
        "spectral_acceleration": xr.DataArray(accelerations, dims="structure"),
    }


def over_records(case: Case, separations: xr.DataArray, gap: float) -> xr.Dataset:
    """Quantiles of the separations [m] in records, and the share of records without pounding.

    The intervals are those of `ends_of_events`.
    """
    levels = np.unique([*RECORD_QUANTILES, case.wanted.confidence])
    events = events_of(case.site.records, [*case.site.records.values()])
    table = quantiles_of_records("record_gap", separations, events, levels)
    smallest, largest = ends_of_events(separations, events)
    # Most events are within the gap by the smallest values.
    samples = (sample.rename(record="path") for sample in (separations, largest, smallest))
    shares = [keeping_apart(sample, gap) for sample in samples]
    columns = {
        f"record_{name}": sample[name] for name, sample in zip(shares[0], shares, strict=True)
    }
    return labels.label(table.assign(columns).assign_attrs(independent=len({*events})))


def doubts(shaken: xr.Dataset) -> list[str]:
    """Texts on implausible shaking."""
    limits = PLAUSIBLE["pga"]
    pga = float(shaken["peak_ground_acceleration"])
    peak = f"{pga / constants.g:.3g} g, and usual are {limits.usual}"
    return [] if limits.holds(pga) else [f"peak ground acceleration: {peak}"]
