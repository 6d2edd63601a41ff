"""Small pieces of work that between them call all compiled code, for all kinds of its arguments."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from stochlin.applications.pounding.pounding import pound
from stochlin.applications.probability.probability import pounding_probability
from stochlin.applications.records.gaps import recorded_gap
from stochlin.applications.records.response import respond, response_spectrum
from stochlin.kernels.correlation.bilinear_pair import linearized_pair
from stochlin.models.buildings.shear import ShearBuilding
from stochlin.models.contacts.elements import LinearSpring
from stochlin.models.grounds import Ground, KanaiTajimi, WhiteNoise, named_ground
from stochlin.models.laws.bilinear import Bilinear
from stochlin.models.laws.bouc_wen import BoucWen
from stochlin.models.links import Link
from stochlin.models.uncertain import Uncertain
from stochlin.solver.simulation.simulation import simulate

TASK_SECONDS = 8.0
TASK_PATHS = 32
YIELDING_VALUES: Any = {"hardening": 0.05, "yield_displacement": 0.01}
STOREY_VALUES: Any = {"storey_height": 3.0, "mass": 1e6, "base_shear_coefficient": 0.1}


def _ground() -> Ground:
    return KanaiTajimi(0.5, 0.3, intensity=0.01)


def _pair() -> tuple[Bilinear, Bilinear]:
    first = Bilinear(0.8, 0.05, **YIELDING_VALUES, mass=1e6)
    second = Bilinear(0.5, 0.05, **YIELDING_VALUES, mass=1e6)
    return first, second


def _tower(period: Any = 0.8) -> ShearBuilding:
    return ShearBuilding.regular(
        period=period, storeys=2, damping=0.05, hardening=0.05, **STOREY_VALUES
    )


def _record() -> xr.DataArray:
    time = 0.02 * np.arange(200)
    return xr.DataArray(
        3 * np.sin(9 * time), dims="time", coords={"time": time}, attrs={"units": "m/s^2"}
    )


def _finite(structures: Sequence[Any], ground: Any, link: Link | None = None) -> None:
    simulate(structures, ground, paths=TASK_PATHS, duration=TASK_SECONDS, link=link)


def pounding() -> None:
    """Buildings in a row through a record, without a link and with one."""
    for link in (None, Link(1e7)):
        pound(_pair(), 0.01, LinearSpring(1e9), _record(), link=link)


def tables() -> None:
    """Two structures by numbers alone; tables of correlation coefficients need no compiled code."""
    linearized_pair((0.8, 0.05, 0.1, 0.01), (0.5, 0.05, 0.1, 0.01), (0.01,))


def records() -> None:
    """Oscillators in a record, one by one and side by side."""
    first, second = _pair()
    recorded_gap(first, second, _record())
    response_spectrum(_record(), [0.5, 1.0], 0.05)
    respond(first, _record())


def oscillators() -> None:
    """Simulated motions: all grounds, the laws with their own time steps, uncertain parameters."""
    first, second = _pair()
    for ground in (WhiteNoise(0.01), _ground(), named_ground("firm", intensity=0.01)):
        _finite([first, second], ground)
    _finite([first, BoucWen(0.5, 0.05, **YIELDING_VALUES)], _ground())
    simulate([first, second], _ground(), paths=TASK_PATHS, relaxation_times=1.0)
    pounding_probability(first, second, _ground(), 0.05, duration=TASK_SECONDS, paths=TASK_PATHS)
    unknown: Any = Uncertain(0.5, 0.1)
    uncertain = Bilinear(unknown, 0.05, **YIELDING_VALUES)
    _finite([uncertain, second], KanaiTajimi(unknown, 0.3, intensity=0.01))


def storeys() -> None:
    """The same of buildings with storeys, by themselves and beside oscillators, and with a link."""
    _finite([_tower()], _ground())
    _finite([_tower(), _pair()[1]], _ground(), Link(1e7))
    _finite([_tower(Uncertain(0.8, 0.1)), _pair()[1]], _ground())
    simulate([_tower(), _pair()[1]], _ground(), paths=TASK_PATHS, relaxation_times=1.0)


# The longest first: they are taken in turn by as many processes as there are cores.
TASKS = {
    "pounding": pounding,
    "tables": tables,
    "storeys": storeys,
    "oscillators": oscillators,
    "records": records,
}


def main() -> None:
    """Perform the tasks whose names come in, a line each, and write each name when it is done."""
    for line in sys.stdin:
        TASKS[line.strip()]()
        sys.stdout.write(line)
        sys.stdout.flush()
