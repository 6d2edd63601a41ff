"""What is counted of gaps that were tried on recorded earthquakes."""

import numpy as np
import pytest
import scipy.stats
import xarray as xr
from reality_tables import (
    FITTED,
    scatter_of,
    share_interval,
)

PLACES = 12


@pytest.mark.oracle
def test_interval_of_independent_cases_is_that_of_clopper_and_pearson():
    held = np.repeat([1.0, 0.0], [70, 30])
    lower, upper = scipy.stats.binomtest(70, 100).proportion_ci(0.95)
    np.testing.assert_allclose(share_interval(held, np.arange(100)), (0.7, lower, upper), atol=2e-3)


@pytest.mark.oracle
@pytest.mark.parametrize("share", [0.5, 0.9])
def test_interval_holds_where_cases_of_a_place_go_together(share):
    """In 500 draws of 12 places with two components and six pairs each, correlated by 0.5."""
    random = np.random.default_rng(4)
    threshold = scipy.stats.norm.ppf(share)
    inside = 0
    for _ in range(500):
        common, own = random.standard_normal((2, PLACES, 12))
        held = np.sqrt(0.5) * (common[:, :1] + own) < threshold
        _, lower, upper = share_interval(
            held.reshape(2 * PLACES, 6) * 1.0, np.repeat(np.arange(12), 2)
        )
        inside += lower <= share <= upper
    assert inside / 500 > 0.93


def tried(scatter, suite="far field", part="spectrum", seed=0):
    """Cases with lognormal gaps of this scatter beside that of the motions, 0.3."""
    random = np.random.default_rng(seed)
    sizes = {"case": 60, "scatter": 4, "strength": 3, "pair": 2}
    levels = np.array([0.0, 0.3, 0.4, FITTED])
    spread = np.sqrt(0.3**2 + np.abs(levels) ** 2)[:, None, None]
    off = np.hypot(0.3, scatter) * random.standard_normal((60, 1, 3, 2)) * np.ones((4, 1, 1))
    likely = np.broadcast_to(scipy.stats.norm.sf(0.1 / spread), off.shape)[..., None]
    cases = xr.Dataset(
        {
            "below": (list(sizes), scipy.stats.norm.cdf(off / spread)),
            "off": (list(sizes), off),
            "spread": (list(sizes), np.broadcast_to(spread, off.shape)),
            "probability": ((*sizes, "gap"), likely),
            "hit": (("case", "strength", "pair", "gap"), 1.0 * (off[:, 0, ..., None] > 0.1)),
            "needed": (("case", "strength", "pair"), np.exp(off[:, 0])),
        },
        {"scatter": levels, "strength": [1.0, 2.0, 4.0]},
    )
    return cases.assign_coords(
        part=("case", [part] * 60),
        suite=("case", [suite] * 60),
        place=("case", [f"{suite} {n // 2}" for n in range(60)]),
    )


@pytest.mark.oracle
@pytest.mark.parametrize("scatter", [0.0, 0.2, 0.35])
def test_scatter_is_found_again(scatter):
    known = [tried(scatter, seed=seed).sel(scatter=[0.0, 0.3]) for seed in (0, 1)]
    best, lower, upper = scatter_of(known)
    assert lower <= scatter <= upper or scatter == 0
    assert best == pytest.approx(scatter, abs=0.07)
