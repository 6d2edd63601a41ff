"""Histories of z against an ODE solver under the same record, linear between its samples."""

import numpy as np
import pytest
from motions import from_sample_to_sample, shaking

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.filterwarnings("ignore:.*yield_displacement = 0.543")]

PERIOD, DAMPING = 0.7, 0.05
BOUC_WEN = {"beta": 0.6, "gamma": 0.3, "exponent": 1.0}
RECORD = shaking(120, 3, 4.0, width=9)
PEAK = float(abs(sl.respond(sl.Bilinear(PERIOD, DAMPING), RECORD).displacement).max())
TOLERANCES = {"rtol": 1e-8, "atol": 1e-10 * PEAK, "max_step": 5e-4}


def oscillator(hardening, uy, law, states):
    """Displacement, velocity and further states; ``law(rate, states)`` gives the rates of these."""
    w = 2 * np.pi / PERIOD

    def rates(t, x, ground, slope):
        u, v = x[:2]
        force = 2 * DAMPING * w * v + hardening * w**2 * u + (1 - hardening) * w**2 * uy * x[2]
        return [v, -ground - slope * t - force, *law(v / uy, x[2:])]

    return from_sample_to_sample(rates, RECORD, 2 + states, **TOLERANCES).T


def bouc_wen(rate, states):
    [z] = states
    return [rate - 0.6 * abs(rate) * z - 0.3 * rate * abs(z)]


def decaying(rate, states):
    """The law of Baber and Noori without pinching."""
    z, energy = states
    slip = (1 + 0.002 * energy) * (0.6 * abs(rate) * z + 0.4 * rate * abs(z))
    return [(rate - slip) / (1 + 0.01 * energy), z * rate]


@pytest.mark.extreme
@pytest.mark.parametrize("hardening", [0.02, 1.0])
@pytest.mark.parametrize("share", [1 / 300, 1 / 30, 3.0])
def test_z_of_bouc_wen_follows_its_rate(hardening, share):
    structure = sl.BoucWen(PERIOD, DAMPING, hardening, yield_displacement=share * PEAK, **BOUC_WEN)
    table = sl.respond(structure, RECORD)
    exact = oscillator(hardening, share * PEAK, bouc_wen, 1)
    peak = np.abs(exact[0]).max()
    np.testing.assert_allclose(table.displacement, exact[0], rtol=0, atol=2e-4 * peak)
    np.testing.assert_allclose(table.z, exact[2], rtol=0, atol=2e-4)
    assert float(table.step_error) <= 1e-4


@pytest.mark.extreme
@pytest.mark.parametrize("hardening", [0.02, 1.0])
@pytest.mark.parametrize("share", [1 / 30, 0.3])
def test_z_of_a_law_that_degrades_follows_its_rate(hardening, share):
    uy = share * PEAK
    decay = {"beta": 0.6, "strength_decay": 0.002, "stiffness_decay": 0.01}
    structure = sl.BoucWenBaberNoori(PERIOD, DAMPING, hardening, yield_displacement=uy, **decay)
    table = sl.respond(structure, RECORD)
    exact = oscillator(hardening, uy, decaying, 2)
    np.testing.assert_allclose(table.z, exact[2], rtol=0, atol=2e-4)


@pytest.mark.extreme
@pytest.mark.parametrize("beta", [0.3, 1.0])
@pytest.mark.parametrize("share", [1 / 300, 1 / 30, 1 / 3, 3.0])
def test_z_of_a_flag_follows_the_exact_displacement_where_it_gives_no_force(share, beta):
    fine = 500
    elastic = sl.respond(sl.Bilinear(PERIOD, DAMPING), RECORD, refine=fine).displacement.values
    mu = elastic / (share * PEAK)
    z, exact = 0.0, [0.0]
    for change, end in zip(np.diff(mu), mu[1:], strict=True):
        lower, upper = np.clip(end, -1.0, 1 - beta), np.clip(end, beta - 1, 1.0)
        z = min(max(z + change, lower), upper)
        exact.append(z)
    structure = sl.Flag(PERIOD, DAMPING, 1.0, yield_displacement=share * PEAK, beta=beta)
    table = sl.respond(structure, RECORD)
    np.testing.assert_allclose(table.z, exact[::fine], rtol=0, atol=3e-4)


@pytest.mark.extreme
@pytest.mark.parametrize("law", [sl.BoucWen, sl.Flag, sl.ModifiedClough])
def test_z_is_at_most_1_where_the_law_gives_no_force(law):
    table = sl.respond(law(PERIOD, DAMPING, 1.0, yield_displacement=1e-3 * PEAK), RECORD)
    assert 0.99 < float(abs(table.z).max()) <= 1 + 1e-6


@pytest.mark.extreme
@pytest.mark.parametrize("hardening", [0.05, 1.0])
def test_z_in_the_storeys_of_a_building_follows_its_rate(hardening):
    building = sl.ShearBuilding(
        masses=[2e5, 1e5],
        stiffnesses=[4e7, 2e7],
        heights=[3.0, 3.0],
        damping=DAMPING,
        hardening=hardening,
        yield_drifts=[0.1 * PEAK, 0.05 * PEAK],
        law="bouc_wen",
        law_parameters={"beta": 0.6, "gamma": 0.3},
    )
    system = building.system()
    drifts = system.extensions

    def rates(t, x, ground, slope):
        q, v, z = np.split(x, 3)
        force = drifts.T @ (system.post * (drifts @ q) + system.couple * system.strength * z)
        pushed = -(force + system.damping @ v) / system.mass - (ground + slope * t)
        pace = drifts @ v / system.strength
        return [*v, *pushed, *(pace - 0.6 * abs(pace) * z - 0.3 * pace * abs(z))]

    table = sl.respond(building, RECORD)
    exact = from_sample_to_sample(rates, RECORD, 6, **TOLERANCES)
    assert np.abs(exact[:, 4:]).max() > 0.9
    np.testing.assert_allclose(table.z, exact[:, 4:], rtol=0, atol=2e-4)


@pytest.mark.extreme
def test_what_has_not_converged_is_said(monkeypatch):
    monkeypatch.setattr("stochlin.applications.records.stepped.HALVINGS_OF_HISTORY", 1)
    with pytest.warns(UserWarning, match=r"changes by .* more than 0\.0001: see step_error"):
        table = sl.respond(sl.Flag(PERIOD, DAMPING, 1.0, yield_displacement=PEAK / 30), RECORD)
    assert float(table.step_error) > 1e-4
