"""Eq. (3) with the energy radii of a record, and the least damping that it asks for."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.optimize
import xarray as xr
from motions import motion

import stochlin as sl


def noise(seed=0, size=1500):
    return motion(np.random.default_rng(seed).normal(size=size))


def hum(period=1.0, size=6000):
    """A motion of one frequency that lasts: what is left is the steady state."""
    time = 0.02 * np.arange(size)
    return motion(np.sin(2 * np.pi * time / period) * np.minimum(time / 40, 1))


FIRST, SECOND = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.6, 0.05)
WEAK = [replace(one, hardening=0.1, yield_displacement=0.01) for one in (FIRST, SECOND)]
GROUND = sl.KanaiTajimi(0.5, 0.4)


@pytest.mark.paper
def test_it_is_eq_3_of_the_radii_of_both_alone_and_eq_4():
    table = sl.energy_gap(FIRST, SECOND, noise())
    radii = [sl.pseudo_energy_radius(noise(), T, 0.05).pseudo_energy_radius for T in (1.0, 0.6)]
    rho = sl.rho_white_noise(1.0, 0.6, 0.05, 0.05).rho
    gap = sl.critical_gap(*radii, rho).gap
    assert float(table.critical_gap) == pytest.approx(float(gap), rel=1e-3)  # their own sub-steps
    own = (table.pseudo_energy_radius_1, table.pseudo_energy_radius_2)
    assert float(table.critical_gap) == float(sl.critical_gap(*own, rho).gap)
    truth = sl.recorded_gap(FIRST, SECOND, noise())
    xr.testing.assert_equal(table[list(truth.data_vars)], truth)
    assert float(table.critical_gap_error) == pytest.approx(
        float(gap / truth.separation - 1), rel=1e-2
    )


@pytest.mark.paper
@pytest.mark.extreme
def test_least_damping_of_a_steady_hum_is_that_of_the_closed_form():
    """In a sinusoid, ``r_PER`` of a soft and of a stiff structure and eq. (4) are known."""
    soft, stiff = sl.Bilinear(1.0, 0.05), sl.Bilinear(0.5, 0.05)

    def radius(period, damping):
        ratio = period / 1.0  # of the motion's frequency to the structure's
        amplitude = (period / (2 * np.pi)) ** 2 / np.hypot(1 - ratio**2, 2 * damping * ratio)
        return amplitude * max(1.0, ratio)

    def eq_3(added):
        one, two = radius(1.0, 0.05 + added), radius(0.5, 0.05 + added)
        rho = float(sl.rho_white_noise(1.0, 0.5, 0.05 + added, 0.05 + added).rho)
        return np.sqrt(one**2 + two**2 - 2 * rho * one * two)

    gap = 0.5 * eq_3(0.0)
    expected = scipy.optimize.brentq(lambda x: eq_3(x) - gap, 0, 0.4)
    table = sl.damping_for_gap(hum(), soft, stiff, gap)
    # the hum grows slowly, so that little is left of its beginning
    assert float(table.least_added_damping.sel(damped="both")) == pytest.approx(expected, rel=0.01)

    def phasor(period, damping):
        ratio = period / 1.0
        return (period / (2 * np.pi)) ** 2 / (1 - ratio**2 + 2j * damping * ratio)

    def true(added):
        return abs(phasor(1.0, 0.05 + added) - phasor(0.5, 0.05 + added))

    gap = 0.5 * true(0.0)
    expected = scipy.optimize.brentq(lambda x: true(x) - gap, 0, 0.4)
    least = sl.damping_for_gap(hum(), soft, stiff, gap).least_added_damping_recorded
    assert float(least.sel(damped="both")) == pytest.approx(expected, rel=0.01)


@pytest.mark.oracle
@pytest.mark.parametrize("options", [{}, {"ground": GROUND}], ids=["elastic", "yielding"])
def test_least_damping_put_back_gives_the_gap(options):
    pair = WEAK if options else (FIRST, SECOND)
    now = sl.energy_gap(*pair, noise(), **options)
    if options:
        assert float(now.rho_estimate) == float(sl.correlate(*WEAK, GROUND).rho)
    gap = 0.9 * min(float(now.critical_gap), float(now.separation))
    table = sl.damping_for_gap(noise(), *pair, gap, **options)
    for where, shares in (("both", (1, 1)), ("structure 1", (1, 0)), ("structure 2", (0, 1))):
        for name, of in (("critical_gap", ""), ("separation", "_recorded")):
            least = float(table[f"least_added_damping{of}"].sel(damped=where))
            scan = table[name].sel(damped=where)
            enough = scan.added_damping.values[scan.values <= gap]
            if not enough.size:
                assert np.isnan(least)
                continue
            assert enough[0] - 0.01 <= least <= enough[0]  # the first that is enough
            one, two = (
                replace(s, damping=s.damping + x * least) for s, x in zip(pair, shares, strict=True)
            )
            again = sl.energy_gap(one, two, noise(), **options)
            assert float(again[name]) == pytest.approx(gap, rel=2e-3)


@pytest.mark.invariant
def test_wide_gap_needs_nothing_and_damping_one_of_two_equal_buildings_parts_them():
    wide = sl.damping_for_gap(noise(), FIRST, SECOND, 0.8)
    assert wide.least_added_damping.values.tolist() == [0.0, 0.0, 0.0]
    equal = sl.damping_for_gap(noise(), FIRST, FIRST, 1e-3)
    assert (equal.critical_gap.sel(damped="structure 1").diff("added_damping")[:5] > 0).all()
    turned = sl.damping_for_gap(-noise(), SECOND, FIRST, 0.01)
    plain = sl.damping_for_gap(noise(), FIRST, SECOND, 0.01)
    swapped = turned.least_added_damping.sel(damped=["both", "structure 2", "structure 1"])
    np.testing.assert_allclose(swapped, plain.least_added_damping, rtol=1e-9)


@pytest.mark.invariant
def test_cells_records_and_grounds_are_taken_one_by_one():
    first = sl.Bilinear(xr.DataArray([0.8, 1.2], dims="period"), 0.05)
    grounds = sl.KanaiTajimi(xr.DataArray([0.5, 1.0], dims="soil"), 0.4)
    table = sl.damping_for_gap({"a": noise(), "b": noise(1)}, first, SECOND, 0.02, ground=grounds)
    assert dict(table.least_added_damping.sizes) == {
        "record": 2,
        "period": 2,
        "soil": 2,
        "damped": 3,
    }
    last = first.isel({"period": 1}), SECOND
    alone = sl.damping_for_gap(noise(1), *last, 0.02, ground=grounds.isel({"soil": 1}))
    for name in ("least_added_damping", "least_added_damping_recorded", "critical_gap"):
        cell = table[name].isel(record=1, period=1, soil=1, missing_dims="ignore")
        np.testing.assert_allclose(cell, alone[name], rtol=1e-12)


@pytest.mark.invariant
def test_it_goes_with_the_motion_and_does_not_ask_which_building_is_first():
    usual = sl.energy_gap(FIRST, SECOND, noise())
    louder = sl.energy_gap(FIRST, SECOND, 2 * noise())
    assert float(louder.critical_gap) == pytest.approx(2 * float(usual.critical_gap), rel=1e-12)
    turned = sl.energy_gap(SECOND, FIRST, -noise())
    for name in ("critical_gap", "separation"):
        assert float(turned[name]) == pytest.approx(float(usual[name]), rel=1e-12)
    assert float(sl.energy_gap(FIRST, FIRST, noise()).critical_gap) == pytest.approx(0, abs=1e-12)
