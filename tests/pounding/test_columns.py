"""Slabs that meet columns: limits, symmetry, one hit by hand, and the balance of energy."""

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given, settings
from motions import shaking

import stochlin as sl

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

BALANCE = 1e-8
CONTACTS = {
    "spring": sl.LinearSpring(2e8),
    "kelvin": sl.Kelvin(2e8, restitution=0.65),
    "no tension": sl.NoTensionKelvin(2e8, restitution=0.65),
    "impact kelvin": sl.ImpactKelvin(2e8, restitution=0.65),
    "hertz": sl.Hertz(2e9),
    "hertz-damp": sl.HertzDamp(2e9, restitution=0.65),
    "jankowski": sl.Jankowski(2e9, restitution=0.65),
}


def building(heights, stiffness=2e8, mass=2e5, **other):
    n = len(heights)
    given = {"hardening": 0.05, "yield_drifts": 0.008} | other
    return sl.ShearBuilding(
        [mass] * n, np.linspace(1.5, 0.7, n) * stiffness, heights, 0.05, **given
    )


TALL, LOW = building([3.5] * 5), building([4.2, 3.0, 3.0, 3.0], 4e8, 3e5, yield_drifts=0.006)


def test_where_slabs_meet_columns_is_told():
    table = sl.pound([TALL, LOW], 0.01, CONTACTS["kelvin"], shaking())
    assert table.level.values.tolist() == pytest.approx([3.5, 4.2, 7.0, 7.2, 10.2, 10.5, 13.2])
    assert set(table.kind.values) == {"slab to column"}
    across = table.isel(neighbours=0)  # at all levels together
    assert int(across.impacts_between) == table.sizes["impact"]
    assert float(across.hardest_force_between) == float(table.largest_force.max())
    assert float(across.contact_energy_between) == pytest.approx(float(table.energy_lost.sum()))
    assert table.column.values.tolist() == [
        "right",
        "left",
        "right",
        "left",
        "left",
        "right",
        "left",
    ]
    assert table.storey.values.tolist() == [1, 2, 2, 3, 3, 4, 4]
    np.testing.assert_allclose(table.share[:3], [3.5 / 4.2, 0.2, 2.8 / 3])
    level = sl.pound([TALL, building([3.5, 4.0])], 0.01, CONTACTS["kelvin"], shaking())
    assert level.storey.values.tolist() == [0, 2, 3]  # the first is one of two slabs
    hit = table.impact_contact.values
    for number, force in enumerate(table.column_force.values, start=1):
        assert force == pytest.approx(table.largest_force.values[hit == number].max(initial=0.0))
    left = table.column.values == "left"
    k, yields = np.where(left, 2e8 * np.linspace(1.5, 0.7, 5)[table.storey.values - 1], 0.0), 0.008
    np.testing.assert_allclose(
        table.column_force_share[left], (table.column_force / (k * yields))[left], rtol=1e-12
    )


@pytest.mark.slow
@settings(max_examples=20)
@given(
    heights=st.tuples(*2 * [st.lists(st.floats(2.5, 6.0), min_size=1, max_size=5)]),
    masses=st.tuples(*2 * [st.floats(5e4, 1e6)]),
    gap=st.floats(0.0, 0.02),
    name=st.sampled_from(["kelvin", "no tension", "impact kelvin", "jankowski"]),
    seed=st.integers(0, 10**6),
    law=st.sampled_from(["bilinear", "bouc_wen"]),
)
def test_energy_balances_for_any_storeys(heights, masses, gap, name, seed, law):
    row = [building(h, 3e8, m, law=law) for h, m in zip(heights, masses, strict=True)]
    table = sl.pound(row, gap, CONTACTS[name], shaking(150, seed))
    assert float(table.energy_balance_error.max()) < 1e-6  # measured: 1e-9, and better
    assert table.level.values.tolist() == sorted(table.level.values.tolist())
    assert float(table.level.max()) <= min(sum(h) for h in heights) + 0.05
    far = sl.pound(row, 1.0, CONTACTS[name], shaking(150, seed))
    np.testing.assert_array_equal(far.amplification.values[0, : len(heights[0])], 1.0)


def test_an_oscillator_meets_the_roof_of_its_neighbour():
    row = [TALL, sl.BoucWen(0.5, 0.05, 0.1, yield_displacement=0.01, mass=3e5), LOW]
    table = sl.pound(row, [0.005, 0.005], CONTACTS["kelvin"], shaking())
    assert table.floor_left.values.tolist() == [1, 5]
    assert table.floor_right.values.tolist() == [4, 1]
    assert table.level.values.tolist() == pytest.approx([13.2, 17.5])
    assert set(table.impact_contact.values) == {1, 2}
    assert float(table.energy_balance_error.max()) < BALANCE
    assert table.displacement.sel(structure=2, floor=[2, 3, 4, 5]).isnull().all()
