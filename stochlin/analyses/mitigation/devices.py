"""Force, stroke and dissipated energy of each link, damper and bumper of a measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from stochlin.analyses.pounding.rows import meetings
from stochlin.analyses.simulation.finite_motions import mean_with_error, quantile_intervals
from stochlin.analyses.tables import labels
from stochlin.kernels.basics.arrays import Array
from stochlin.models.systems import Arrangement

DEVICE = "device"
LEVEL = 0.95  # of the quantile over motions
QUANTITIES = "force", "stroke", "energy"
OF_LINKS = "peak_link_force", "peak_link_stroke", "link_energy"
OF_BUMPERS = "hardest_force", "deepest_compression", "contact_energy"
TEXTS: dict[str, str] = {
    "device_kind": "link between both structures, damper in one of them, or bumper",
    "device_place": "floors of the device (structure.floor)",
}


class Device(NamedTuple):
    """A link, damper or bumper, and its force [N], stroke [m] and energy [J] in each motion (3, m)."""

    kind: str
    place: str
    samples: Array

    def statistics(self) -> dict[str, float]:
        """Means with standard errors, and 95 % quantiles with intervals, over the motions."""
        row: dict[str, float] = {}
        for name, values in zip(QUANTITIES, self.samples, strict=True):
            mean, error = mean_with_error(values)
            intervals = np.full((3, 1), np.nan)
            if np.isfinite(values).all():
                intervals = np.array(quantile_intervals(values, np.array([LEVEL])))
            row |= {f"device_{name}_mean": mean, f"device_{name}_mean_standard_error": error}
            ends = zip(labels.VALUE_AND_ENDS, intervals[:, 0], strict=True)
            row |= {f"device_{name}_quantile{end}": value for end, value in ends}
        return row

    def in_records(self) -> dict[str, Array]:
        """The values in each record."""
        return {f"device_{name}": each for name, each in zip(QUANTITIES, self.samples, strict=True)}


def links_of(motions: xr.Dataset, system: Arrangement) -> list[Device]:
    """All links and dampers in the motions of a dataset of `simulate` or `pound`."""
    if not system.ties:
        return []
    samples = np.stack([motions[name].values for name in OF_LINKS])
    floors = system.floors
    return [
        Device(
            "damper" if tie.link.within_one else "link",
            f"{floors[tie.one]} to {floors[tie.two] if tie.two >= 0 else 'ground'}",
            samples[..., number],
        )
        for number, tie in enumerate(system.ties)
    ]


def bumpers_of(motions: xr.Dataset, system: Arrangement) -> list[Device]:
    """All contacts of two buildings in the motions of a dataset of `pound`; 0 without an impact."""
    samples = np.stack([motions[n].where(motions.impacts != 0, 0.0).values for n in OF_BUMPERS])
    floors, second = system.floors, int(system.first[1])
    places = meetings([stack.levels for stack in system.stacks])
    return [
        Device(
            "bumper",
            f"{floors[place.floor_left]} to {floors[second + place.floor_right]}",
            samples[..., number],
        )
        for number, place in enumerate(places)
    ]


def devices_table(rows: Sequence[Sequence[Mapping[str, Any]]], records: int) -> xr.Dataset:
    """Values of the devices of each measure over ``measure``, ``device`` and, of some, ``record``.

    Measures with fewer devices are filled up with NaN. Without devices the dataset is empty.
    """
    most = max(map(len, rows), default=0)
    if not most:
        return xr.Dataset()
    columns: dict[str, Any] = {}
    for number, row in enumerate(rows):
        for place, device in enumerate(row):
            for name, value in device.items():
                over = ("measure", DEVICE, *(["record"] if np.ndim(value) else []))
                shape = (len(rows), most, records)[: len(over)]
                blank = np.full(shape, "" if name in TEXTS else np.nan, object)
                columns.setdefault(name, (over, blank))[1][number, place] = value
    columns = {
        n: (over, each.astype(str if n in TEXTS else float)) for n, (over, each) in columns.items()
    }
    axis = (DEVICE, np.arange(1, most + 1), {"long_name": "device of the measure"})
    return xr.Dataset(columns, {DEVICE: axis}).set_coords(TEXTS)
