"""Small pieces of work that between them call all compiled code, for all kinds of its arguments."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

import stochlin as sl
from stochlin.models.grounds import Ground

SECONDS, PATHS = 8.0, 32
YIELDING: Any = {"hardening": 0.05, "yield_displacement": 0.01}


def _ground() -> Ground:
    return sl.KanaiTajimi(0.5, 0.3, intensity=0.01)


def _pair() -> tuple[sl.Bilinear, sl.Bilinear]:
    one, two = (sl.Bilinear(period, 0.05, **YIELDING, mass=1e6) for period in (0.8, 0.5))
    return one, two


def _tower(period: Any = 0.8) -> sl.ShearBuilding:
    return sl.ShearBuilding.regular(
        period=period,
        storeys=2,
        storey_height=3.0,
        mass=1e6,
        damping=0.05,
        hardening=0.05,
        base_shear_coefficient=0.1,
    )


def _record() -> xr.DataArray:
    time = 0.02 * np.arange(200)
    return xr.DataArray(3 * np.sin(9 * time), dims="time", coords={"time": time})


def _finite(structures: Sequence[Any], ground: Any) -> None:
    sl.simulate(structures, ground, paths=PATHS, duration=SECONDS)


def pounding() -> None:
    """Buildings in a row through a record."""
    sl.pound(_pair(), 0.01, sl.LinearSpring(1e8), _record())


def tables() -> None:
    """Correlation coefficients and the bias maps."""
    for closure in ("gaussian", "drift"):
        sl.correlate(*_pair(), _ground(), closure=closure)


def records() -> None:
    """Oscillators in a record, one by one and side by side."""
    one, two = _pair()
    sl.recorded_gap(one, two, _record())
    sl.response_spectrum(_record(), [0.5, 1.0], 0.05)
    sl.respond(one, _record())


def oscillators() -> None:
    """Simulated motions: all grounds, the laws with time steps of their own, uncertain parameters."""
    one, two = _pair()
    for ground in (sl.WhiteNoise(0.01), _ground(), sl.named_ground("firm", intensity=0.01)):
        _finite([one, two], ground)
    _finite([one, sl.BoucWen(0.5, 0.05, **YIELDING)], _ground())
    sl.simulate([one, two], _ground(), paths=PATHS, relaxation_times=1.0)
    unknown: Any = sl.Uncertain(0.5, 0.1)
    uncertain = sl.Bilinear(unknown, 0.05, **YIELDING)
    _finite([uncertain, two], sl.KanaiTajimi(unknown, 0.3, intensity=0.01))


def storeys() -> None:
    """The same of buildings with storeys, by themselves and beside oscillators."""
    _finite([_tower()], _ground())
    _finite([_tower(sl.Uncertain(0.8, 0.1)), _pair()[1]], _ground())
    sl.simulate([_tower(), _pair()[1]], _ground(), paths=PATHS, relaxation_times=1.0)


def contacts() -> None:
    """The forces of contact elements."""
    sl.Kelvin(1e8, restitution=0.6).force([0.0, 0.01], [0.1, 0.1], 0.1, 1e6)


# The longest first: they are taken in turn by as many processes as there are cores.
TASKS: Mapping[str, Callable[[], None]] = {
    task.__name__: task for task in (pounding, tables, storeys, oscillators, records, contacts)
}


def perform(name: str) -> str:
    """Do one of them, in a process of its own."""
    TASKS[name]()
    return name
