"""What holds for any structures in simulated motions: scales, bounds, symmetry, limits of links."""

from dataclasses import replace

import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.invariant

BROAD = sl.KanaiTajimi(0.42, 0.6, 0.02)
MOTION = {"paths": 32, "duration": 8.0}
FRAME = sl.ShearBuilding([2e5, 1e5], [3e8, 2e8], [3.0, 3.0], 0.05, 0.05, 0.008)
LOW = sl.BoucWen(0.4, 0.05, 0.1, yield_displacement=0.01, mass=1e5)
LINKS = {
    "spring and dashpot": sl.Link(2e6, 1e6),
    "power of the velocity": sl.Link(0.0, 1e6, damping_exponent=0.4),
    "yields": sl.Link(2e7, hardening=0.05, yield_displacement=0.002),
}


@pytest.mark.extreme
@pytest.mark.parametrize("link", LINKS.values(), ids=LINKS)
def test_masses_and_lengths_have_no_scale(link):
    """A dashpot's constant goes with the length to one less its exponent."""
    heavier, longer = 7.0, 3.0
    frame = replace(
        FRAME,
        masses=FRAME.masses * heavier,
        stiffnesses=FRAME.stiffnesses * heavier,
        yield_drifts=FRAME.yield_drifts * longer,
    )
    low = replace(LOW, mass=heavier * LOW.mass, yield_displacement=longer * LOW.yield_displacement)
    exponent = link.damping_exponent or 1.0
    strengths = {}
    if link.yields:
        strengths = {"yield_displacement": longer * link.yield_displacement}
    placed = replace(
        link,
        stiffness=heavier * link.stiffness,
        damping_constant=heavier * longer ** (1 - exponent) * link.damping_constant,
        **strengths,
    )
    usual = sl.simulate([FRAME, LOW], BROAD, link=link, **MOTION)
    louder = replace(BROAD, intensity=longer**2 * BROAD.intensity)
    other = sl.simulate([frame, low], louder, link=placed, **MOTION)
    for name in ("peak", "peak_drift", "separation", "peak_link_stroke"):
        np.testing.assert_allclose(other[name], longer * usual[name], rtol=1e-6, err_msg=name)
    force, energy = other.peak_link_force, other.link_energy
    np.testing.assert_allclose(force, heavier * longer * usual.peak_link_force, rtol=1e-5)
    np.testing.assert_allclose(energy, heavier * longer**2 * usual.link_energy, rtol=1e-5)


@pytest.mark.parametrize("link", LINKS.values(), ids=LINKS)
@pytest.mark.parametrize("one", [FRAME, LOW], ids=["frame", "oscillator"])
def test_equal_structures_never_part_and_do_not_feel_their_link(one, link):
    free, tied = (sl.simulate([one, one], BROAD, link=each, **MOTION) for each in (None, link))
    assert float(tied.separation.max()) <= 1e-7 * float(tied.peak.max())  # see CLOSE_BY_LAW
    np.testing.assert_allclose(tied.peak, free.peak, rtol=1e-7)


def test_a_separation_is_at_most_the_sum_of_both_peaks():
    pair = [LOW, sl.Bilinear(1.0, 0.05, 0.05, yield_displacement=0.02)]
    table = sl.simulate(pair, BROAD, **MOTION)
    towards, away = table.peak_positive.values, table.peak_negative.values
    np.testing.assert_array_equal(table.peak, np.maximum(towards, away))
    for first, second in ((0, 1), (1, 0)):
        separation = table.separation.values[:, first, second]
        assert (separation <= towards[:, first] + away[:, second] + 1e-12).all()


@pytest.mark.parametrize("link", [sl.Link(1e12, floors=(1, 1)), sl.Link(0.0, 1e9, floors=(1, 1))])
def test_a_stiff_link_or_a_strong_dashpot_holds_two_floors_together(link):
    table = sl.simulate(
        [FRAME, replace(FRAME, masses=2 * FRAME.masses)], BROAD, link=link, **MOTION
    )
    held = table.separation_at_height[:, 0, 1].sel(height=3.0)
    assert float(held.max()) < 0.02 * float(table.separation[:, 0, 1].max())


def test_a_dashpot_whose_exponent_is_near_one_is_nearly_the_linear_one():
    pair = [LOW, replace(LOW, period=0.9)]
    linear, *near = (
        sl.simulate(pair, BROAD, link=sl.Link(0.0, 1e6, damping_exponent=a), **MOTION)
        for a in (1.0, 1 - 1e-5, 1 + 1e-5)
    )
    for table in near:
        np.testing.assert_allclose(table.peak, linear.peak, rtol=1e-3)


def test_structures_keep_their_order_whatever_their_laws():
    """Of a stationary response, too, in which kinds of laws are stepped apart."""
    three = [LOW, sl.Bilinear(0.8, 0.05), sl.Bilinear(0.6, 0.05, 0.1, reduction_factor=3)]
    turned = [2, 0, 1]
    usual, other = (
        sl.simulate(each, BROAD, paths=32, relaxation_times=5)
        for each in (three, [three[n] for n in turned])
    )
    np.testing.assert_allclose(other.displacement_std, usual.displacement_std[turned], rtol=1e-9)
    np.testing.assert_allclose(other.rho, usual.rho.values[np.ix_(turned, turned)], atol=1e-9)


def test_a_run_ends_where_its_progress_raises():
    shares = []

    def stop(share):
        shares.append(share)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sl.simulate([LOW], BROAD, paths=320, duration=8.0, progress=stop)
    assert shares == [0.1]
