"""Devices inside buildings, and dashpots with an exponent, in buildings that pound."""

from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
import xarray as xr
from cases import assert_near
from hypothesis import given, settings
from motions import finer, from_sample_to_sample, smooth_noise

import stochlin as sl

pytestmark = pytest.mark.oracle

FAR = 0.8  # [m]: no contact
SPRING = sl.LinearSpring(1e8)
PACE = 0.2  # [m/s]: where all dashpots of the tests have one force
CONSTANT = 2e5  # [N s/m]: of the linear one


def record(samples: int = 200) -> xr.DataArray:
    return 2.0 * smooth_noise(samples, 7) / 3


def pair(**law: Any) -> list[sl.Bilinear]:
    return [sl.Bilinear(0.9, 0.03, mass=2e5, **law), sl.Bilinear(0.5, 0.06, mass=3e5, **law)]


def towers(**other: Any) -> list[sl.ShearBuilding]:
    given = {"hardening": 0.05, "yield_drifts": 0.008} | other
    low = sl.ShearBuilding([2e5] * 2, [1e8, 8e7], [3.0] * 2, 0.05, **given)
    high = sl.ShearBuilding([2e5] * 4, [2e8] * 4, [3.0] * 4, 0.05, **given)
    return [low, high]


def dashpot(exponent: float, times: float = 1.0, **place: Any) -> sl.Link:
    """One whose force at ``PACE`` is that of the linear one."""
    constant = times * CONSTANT * PACE ** (1 - exponent)
    return sl.Link(0.0, constant, damping_exponent=exponent, **place)


def in_storeys(structure: int, storeys: Any, **device: Any) -> list[sl.Link]:
    return [
        sl.Link(**device, structures=(structure, structure), floors=(n, n - 1)) for n in storeys
    ]


@pytest.mark.parametrize(
    ("exponent", "times", "method", "close"),
    [
        (0.1, 1, "Radau", 1e-5),
        (
            0.35,
            1,
            "DOP853",
            1e-5,
        ),  # from rest, where the law has no slope, the implicit one goes astray
        (2.0, 1, "Radau", 1e-5),
    ],
)
def test_a_dashpot_with_an_exponent_moves_as_by_another_integrator(
    exponent: float, times: float, method: str, close: float
) -> None:
    """With the law down to rest."""
    link, motion = dashpot(exponent, times), record(20)
    c, one, two = link.damping_constant, *pair()
    mass, w = np.array([one.mass, two.mass]), 2 * np.pi / np.array([one.period, two.period])
    drag = 2 * np.array([one.damping, two.damping]) * w

    def rates(t, x, ground, slope):
        v = x[2] - x[3]
        force = c * np.sign(v) * abs(v) ** exponent * np.array([-1.0, 1.0]) / mass
        return np.append(x[2:], force - w**2 * x[:2] - drag * x[2:] - ground - slope * t)

    wanted = from_sample_to_sample(rates, motion, 4, method=method, rtol=1e-9, atol=1e-12)
    table = sl.pound(pair(), FAR, SPRING, motion, link=link, steps_per_contact=128)
    assert_near(table.displacement, wanted[:, :2], close)
    assert float(table.energy_balance_error.max()) < 1e-9
    pace = (table.velocity[:, 0] - table.velocity[:, 1]).values
    force = c * np.sign(pace) * abs(pace) ** exponent
    clear = abs(pace) > 1e-4 * abs(pace).max()
    np.testing.assert_allclose(table.link_force[clear, 0], force[clear], rtol=1e-9)


def test_a_linear_device_is_a_damper_of_the_storey_or_damping() -> None:
    devices = in_storeys(2, range(1, 5), damping_constant=2e6)
    low, high = towers()
    damped = sl.ShearBuilding([2e5] * 4, [2e8] * 4, [3.0] * 4, 0.05, 0.05, 0.008, dampers=2e6)
    found = sl.pound([low, high], 0.01, SPRING, record(), link=devices)
    wanted = sl.pound([low, damped], 0.01, SPRING, record())
    assert found.sizes["impact"] == wanted.sizes["impact"] > 3
    assert_near(found.displacement, wanted.displacement, 1e-8)
    np.testing.assert_allclose(found.peak_alone, wanted.peak_alone, rtol=1e-7)
    lost = found.viscous_energy.sum("structure") + found.link_lost_energy
    np.testing.assert_allclose(lost[-1], wanted.viscous_energy.sum("structure")[-1], rtol=1e-7)


@pytest.mark.slow
@settings(max_examples=25)
@given(
    exponent=st.floats(0.1, 2.0),
    times=st.floats(0.01, 30.0),
    stiffness=st.sampled_from([0.0, 3e7]),
    yields=st.booleans(),
    place=st.sampled_from(
        [((1, 2), (2, 2)), ((1, 1), (2, 1)), ((1, 1), (1, 0)), ((2, 2), (4, 0)), ((2, 1), (1, 1))]
    ),
    gap=st.floats(0.0, 0.02),
    jumps=st.booleans(),
)
def test_energy_of_any_device_is_accounted_for(
    exponent: float,
    times: float,
    stiffness: float,
    yields: bool,
    place: Any,
    gap: float,
    jumps: bool,
) -> None:
    law = {"hardening": 0.1, "yield_displacement": 0.003} if yields and stiffness else {}
    constant = times * CONSTANT * PACE ** (1 - exponent)
    structures, floors = place
    link = sl.Link(
        stiffness, constant, damping_exponent=exponent, **law, structures=structures, floors=floors
    )
    contact = sl.Stereomechanical(0.5) if jumps else sl.Kelvin(1e8, restitution=0.6)
    table = sl.pound(towers(), gap, contact, record(100), link=link)
    assert float(table.energy_balance_error.max()) < (1e-3 if jumps else 1e-6)
    lost = table.link_lost_energy.values
    assert np.diff(lost).min() >= -1e-9 * max(lost.max(), 1.0)
    assert lost[-1] > 0


@pytest.mark.parametrize("contact", [sl.Kelvin(3e7, restitution=0.4), sl.Hertz(3e8)])
def test_compression_is_that_of_a_fine_history(contact: sl.Kelvin) -> None:
    row = towers()
    table = sl.pound(row, 0.005, contact, finer(record(100), 100))
    u = table.displacement
    apart = (u.sel(structure=1) - u.sel(structure=2)).sel(floor=[1, 2]).max("time") - 0.005
    np.testing.assert_allclose(table.deepest_compression, apart.clip(0.0), rtol=2e-3)
