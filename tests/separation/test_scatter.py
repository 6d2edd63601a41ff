"""Gaps in motions differing in strength: of a linear pair they go by the factors of the motions."""

import numpy as np
import pytest

import stochlin as sl

FIRM = sl.named_ground("firm", intensity=0.01)
QUAKE = {"duration": 15.0, "envelope": sl.AminAng(2.0, 9.0, 0.4)}
ELASTIC = [sl.Bilinear(T, 0.05, mass=1e6) for T in (0.6, 1.0)]
OPTIONS = {**QUAKE, "paths": 512}
SCATTER = 0.4


@pytest.fixture(scope="module")
def tables():
    return [sl.separation(*ELASTIC, FIRM, **OPTIONS, scatter=scatter) for scatter in (0.0, SCATTER)]


@pytest.mark.invariant
def test_separations_are_those_without_scatter_times_the_factors(tables):
    none, scattered = tables
    motions = [sl.simulated_motions(FIRM, **OPTIONS, step=0.1, scatter=s) for s in (0.0, SCATTER)]
    factors = (motions[1] / motions[0])[:, 40].values
    expected = none.separation_samples * factors
    np.testing.assert_allclose(scattered.separation_samples, expected, rtol=1e-9)
    assert float(scattered.gap[0]) == pytest.approx(float(np.quantile(expected, 0.9)), rel=1e-9)
    assert scattered.attrs["scatter"] == SCATTER


@pytest.mark.invariant
def test_rules_follow_by_their_peaks_and_those_without_say_that_they_do_not(tables):
    none, scattered = tables
    unsimulated = ["linearization", "eq_3_paper", "cqc"]
    ratio = scattered.gap.sel(rule="share_of_sum") / none.gap.sel(rule="share_of_sum")
    assert 1.1 < ratio < 1.1 * np.exp(1.2816 * SCATTER)
    for rule in unsimulated:
        alone = [table.sel(rule=rule) for table in tables]
        assert alone[0].gap == alone[1].gap
        assert "scatter" not in str(alone[0].assumptions.item())
        assert "without the scatter of 0.4" in str(alone[1].assumptions.item())
