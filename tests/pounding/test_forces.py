"""What floors and storeys bear: accelerations, shears, forces of links, the energy of each hit."""

from pathlib import Path

import numpy as np
import peaks_of_steps
import pytest
from cases import with_slow
from motions import FOLDER, finer, motion, needs_records, recorded, shaking

import stochlin as sl

pytestmark = pytest.mark.oracle

SPRING, BUMPER, BLOW = (
    sl.LinearSpring(2e9),
    sl.Kelvin(5e7, restitution=0.5),
    sl.Stereomechanical(0.5),
)


def building(n, stiffness=2e8, mass=2e5, **other):
    given = {"hardening": 0.05, "yield_drifts": 0.008} | other
    springs = np.linspace(1.5, 0.7, n) * stiffness
    return sl.ShearBuilding([mass] * n, springs, [3.0] * n, 0.05, **given)


@pytest.mark.extreme
def test_forces_of_floors_are_in_balance():
    """Inertia, shears, damping and contacts of every floor add up to nothing."""
    pair = [building(3), building(2, 4e8)]
    table = sl.pound(pair, 0.005, BUMPER, shaking())
    assert table.sizes["impact"] > 3
    for number, each in enumerate(pair, start=1):
        one, n = table.sel(structure=number), each.storeys
        shear = one.storey_shear.values[:, :n]
        above = np.concatenate([shear[:, 1:], np.zeros((shear.shape[0], 1))], axis=1)
        drag = one.velocity.values[:, :n] @ each.damping_matrix().T
        push = np.zeros_like(shear)
        sign = 1.0 if number == 2 else -1.0
        push[:, :2] = sign * table.contact_force.values
        rest = 2e5 * one.acceleration.values[:, :n] + shear - above + drag - push
        size = abs(shear).max()
        np.testing.assert_allclose(rest, 0, atol=1e-9 * size)
        np.testing.assert_array_equal(table.base_shear.sel(structure=number), shear[:, 0])


@pytest.mark.extreme  # a bumper
@pytest.mark.parametrize("contact", with_slow([SPRING, BUMPER, BLOW], [BUMPER]))
def test_peaks_are_those_between_outputs(contact):
    pair = [building(3), building(2, 4e8)]
    link = sl.Link(5e6, 1e5)
    coarse = sl.pound(pair, 0.005, contact, shaking(), link=link)
    fine = sl.pound(pair, 0.005, contact, finer(shaking(), 100), link=link)
    for name in ("acceleration", "storey_shear", "base_shear", "link_force"):
        most = abs(fine[name]).max("time")
        # Blows change the drag, and with it accelerations, for a moment that is between two
        # outputs.
        if not isinstance(contact, sl.Stereomechanical) or name.endswith("shear"):
            np.testing.assert_allclose(coarse[f"peak_{name}"], most, rtol=0.01)
        sampled = (1 - 1e-9) * abs(coarse[name]).max("time")
        assert (coarse[f"peak_{name}"] >= sampled).where(most > 0, True).all()
    if contact is SPRING:
        floors = float((coarse.peak_acceleration / abs(coarse.acceleration).max("time")).max())
        assert floors > 1.2  # an impact is over between two outputs


@pytest.mark.extreme
def test_yielding_storeys_bear_their_strength():
    pair = [building(3, hardening=1e-9), building(2, 4e8, hardening=1e-9)]
    table = sl.pound(pair, 0.005, BUMPER, shaking(size=8.0))
    strength = np.linspace(1.5, 0.7, 3) * 2e8 * 0.008
    assert float(table.peak_storey_shear[0, 0]) == pytest.approx(strength[0], rel=1e-6)
    assert (table.peak_storey_shear[0] <= strength * (1 + 1e-6)).all()


@pytest.mark.extreme
@pytest.mark.parametrize("contact", [SPRING, BUMPER, sl.Hertz(5e9), BLOW, sl.Stereomechanical(0)])
def test_energy_of_each_hit_goes_somewhere(contact):
    """What a building gains from its contacts is what its own energies cannot explain."""
    pair = [
        sl.Bilinear(1.1, 0.05, 0.05, yield_displacement=0.03, mass=2e5),
        sl.Bilinear(0.5, 0.05, 0.1, yield_displacement=0.015, mass=3e5),
    ]
    table = sl.pound(pair, 0.005, contact, shaking(size=2.0))
    last = table.isel(time=-1)
    kept = last.kinetic_energy + last.elastic_energy + last.viscous_energy + last.hysteretic_energy
    gained = (kept - last.input_energy).values
    handed = table.energy_transferred.sum("impact").values
    size = float(abs(table.input_energy).max())
    assert table.sizes["impact"] > 3
    blows = isinstance(
        contact, sl.Stereomechanical
    )  # within a step, see `check_energy` of histories
    np.testing.assert_allclose(handed, gained, rtol=0, atol=(1e-4 if blows else 1e-6) * size)
    both = table.energy_transferred.sum("side")
    done = np.isclose(table.impact_time + table.impact_duration, float(table.time[-1]))
    np.testing.assert_allclose(
        both.values[~done], -table.energy_lost.values[~done], rtol=1e-9, atol=1e-9 * size
    )
    assert float(abs(table.energy_transferred).max()) > 1e-3 * size


@pytest.mark.extreme
def test_a_touch_that_others_press_for_has_its_approach_velocity():
    """The neighbour is pushed over a gap of 0.01 mm in the step in which it is struck itself."""
    row = [
        sl.Bilinear(period, 0.05, mass=mass)
        for period, mass in ((1.1, 1e6), (0.5, 1e5), (0.5, 1e6))
    ]
    first = []
    for steps in (16, 64, 256):
        table = sl.pound(
            row,
            [0.02, 1e-5],
            sl.Kelvin(2e9, restitution=0.65),
            shaking(200, 1),
            steps_per_contact=steps,
        )
        first.append(float(table.approach_velocity[np.argmax(table.impact_contact.values == 2)]))
    assert first[:2] == pytest.approx([first[2]] * 2, rel=0.12)  # measured: 10 and .5 %


def check_peaks(structure, record, most):
    """Peaks in default steps are within ``most`` of those in steps of a sixteenth."""
    usual = sl.pound([structure], motion=record)
    fine = sl.pound([structure], motion=record, steps_per_contact=256)
    for name in ("peak", "peak_storey_shear", "peak_base_shear", "peak_acceleration"):
        np.testing.assert_allclose(usual[name], fine[name], rtol=most, err_msg=name)
        sampled = {"peak": "displacement"}.get(name, name.removeprefix("peak_"))
        assert (abs(usual[sampled]).max("time") <= usual[name] * (1 + 1e-9)).all()
    return usual


@needs_records
@pytest.mark.extreme
def test_peaks_of_five_storeys_on_el_centro_are_within_a_thousandth():
    chain = peaks_of_steps.chain()
    assert float(chain.periods()[-1]) == pytest.approx(0.297, abs=5e-4)
    record = recorded("El Centro")[::2]  # in steps of 0.02 s
    usual = check_peaks(chain, record, 1e-3)
    coarse = sl.pound([chain], motion=record, steps_per_contact=8)
    drifts = abs(coarse.peak_storey_shear / usual.peak_storey_shear - 1).max()
    accelerations = abs(coarse.peak_acceleration / usual.peak_acceleration - 1).max()
    assert float(usual.step_error) == pytest.approx(float(max(drifts, accelerations)), rel=1e-6)


@needs_records
@pytest.mark.extreme
@pytest.mark.parametrize(("name", "most"), [("El Centro", 1e-3), ("Taft", 2e-3), ("Kobe", 4e-3)])
def test_peaks_of_five_storeys_that_yield(name, most):
    # At the yield of the storey above or below the acceleration of a floor has a corner.
    chain = peaks_of_steps.chain(hardening=0.05, yield_drifts=0.01)
    usual = check_peaks(chain, recorded(name), most)
    assert float(usual.hysteretic_energy[-1, 0]) > 0
    assert float(usual.step_error) == pytest.approx(3 * most, rel=0.4)


@pytest.mark.extreme
def test_the_corner_of_an_acceleration_where_a_storey_begins_to_yield():
    # Masses so heavy that their velocities stay: the forces of both storeys grow evenly, and that
    # of the upper one only until it yields, 0.0537 s after the throw, between two steps of 0.005 s.
    mass, lower, upper, yields = 1e5, 2.0, 5.0, 0.0537
    tower = sl.ShearBuilding(
        [mass] * 2, [lower, upper], [3.0] * 2, 1e-9, hardening=1e-9, yield_drifts=[1.0, yields]
    )
    still = motion(np.zeros(21), 0.01)
    table = sl.pound([tower], motion=still, start=sl.Start(velocity=[0.5, 1.5]))
    corner = (upper * yields - lower * 0.5 * yields) / mass
    assert float(table.peak_acceleration[0, 0]) == pytest.approx(corner, rel=1e-5)
    assert float(abs(table.acceleration[:, 0, 0]).max()) < 0.98 * corner


@needs_records
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::stochlin.DoubtfulInput")
def test_the_page_has_the_errors_of_peaks_by_default_steps(capsys):
    peaks_of_steps.main(FOLDER)
    page = Path(__file__).parents[2] / "docs" / "pounding.md"
    assert capsys.readouterr().out in page.read_text(encoding="utf-8")
