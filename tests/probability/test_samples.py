"""Probability of pounding of what is not known exactly, against each sample by itself."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle

GROUND = sl.KanaiTajimi(0.42, 0.6, intensity=0.01)
QUAKE = {"envelope": sl.AminAng(2.0, 6.0, 0.5), "duration": 8.0, "points": 5}
SECOND = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02)
GAPS = xr.DataArray([0.03, 0.06], dims="gap", coords={"gap": [0.03, 0.06]})
STEM = "confidence_of_no_pounding_simulated"


def uncertain(size):
    """Structures with this spread of all that the test varies."""
    some = lambda median: sl.Uncertain(median, size)  # noqa: E731
    return {
        "bilinear": sl.Bilinear(some(1.0), some(0.05), 0.05, yield_displacement=some(0.03)),
        "storeys": sl.ShearBuilding.regular(
            period=some(0.8), storeys=2, storey_height=3.0, mass=2e5, damping=0.05, hardening=0.05,
            base_shear_coefficient=some(0.15),
        ),
    }  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("kind", uncertain(0.0))
def test_without_spread_it_is_that_of_the_median(kind):
    one = uncertain(0.0)[kind]
    found, exact = (
        sl.pounding_probability(each, SECOND, GROUND, GAPS, paths=64, **QUAKE)
        for each in (one, one.median())
    )
    assert (found.input_factor == 1).all()
    for name in (STEM, f"{STEM}_lower"):
        np.testing.assert_array_equal(found[name], exact[name])
    np.testing.assert_allclose(found.required_gap_simulated, exact.required_gap_simulated, rtol=1e-9)
    for name in ("required_gap", "confidence_of_no_pounding", "rho"):  # formulas are of the median
        np.testing.assert_array_equal(found[name], exact[name])


@pytest.mark.slow
def test_an_uncertain_ground_widens_what_is_needed():
    strong = sl.KanaiTajimi(0.42, 0.6, intensity=sl.Uncertain(0.01, 1.0))
    first = sl.Bilinear(1.0, 0.05)
    known, unknown = (
        sl.pounding_probability(first, SECOND, each, 0.06, paths=1024, **QUAKE)
        for each in (GROUND, strong)
    )
    assert float(unknown.required_gap_simulated_lower) > float(known.required_gap_simulated_upper)
    assert float(unknown.required_gap) == float(known.required_gap)


def test_a_fragility_is_of_what_is_known():
    one = sl.Bilinear(sl.Uncertain(1.0, 0.2), 0.05)
    with pytest.raises((TypeError, ValueError), match=r"first = .* ± 20 %.*give its median\(\)"):
        sl.pounding_fragility(one, SECOND, GROUND, 0.05, [0.01, 0.02], duration=10.0)


@pytest.mark.slow
def test_the_motions_are_those_of_a_separation():
    """One seed, one answer: to the last bit, also where each motion meets another structure."""
    storeyed = sl.ShearBuilding([2e5, 2e5], [4e7, 4e7], [3.0, 3.0], 0.05)
    options = {"duration": 12.3, "paths": 64, "seed": 3}
    some = uncertain(0.2).values()
    for first in (sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=3), storeyed, *some):
        rules = sl.separation(first, SECOND, GROUND, confidence=0.9, **options)
        gap = float(rules.separation_samples.median())
        found = sl.pounding_probability(first, SECOND, GROUND, gap, **options)
        kept = float((rules.separation_samples <= gap).mean())
        assert float(found.confidence_of_no_pounding_simulated) == kept
        assert float(found.required_gap_simulated) == float(rules.gap.sel(rule="simulation"))
