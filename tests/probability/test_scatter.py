"""Probabilities in motions differing in strength: formulas averaged, simulation, a convolution."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.applications.probability.formulas import strengths

GROUND = sl.KanaiTajimi(2 * np.pi / 15, 0.6, 0.01)
QUAKE = {"duration": 15.0, "envelope": sl.AminAng(2.0, 9.0, 0.4)}
ELASTIC = [sl.Bilinear(T, 0.05) for T in (0.6, 1.0)]
SCATTER = 0.4
GAPS = xr.DataArray([0.05, 0.1, 0.15, 0.2], dims="gap")


@pytest.mark.oracle
@pytest.mark.parametrize("scatter", [1e-3, 0.1, 0.4, 0.7, 2.0])
@pytest.mark.parametrize("width", [0.15, 0.4])
def test_strengths_average_a_lognormal_peak(scatter, width):
    """A peak of this standard deviation of its logarithm times a lognormal factor is lognormal."""
    normal = pytest.importorskip("scipy.stats").norm.cdf
    factors, weights = strengths(scatter)
    level = np.linspace(-4, 4, 81) * np.hypot(scatter, width)
    found = weights @ normal((level - np.log(factors)[:, None]) / width)
    assert weights.sum() == pytest.approx(1)
    assert np.abs(found - normal(level / np.hypot(scatter, width))).max() < 2e-3


@pytest.mark.oracle
def test_an_elastic_pair_by_the_mean_over_its_gap_over_the_factor():
    """Linear structures under ``a`` times the motion meet across a gap as across ``gap/a``."""
    factors, weights = strengths(SCATTER)
    shares = xr.DataArray(factors, dims="factor"), xr.DataArray(weights, dims="factor")
    single = sl.pounding_probability(
        *ELASTIC, GROUND, GAPS / shares[0], paths=0, points=11, **QUAKE
    )
    found = sl.pounding_probability(
        *ELASTIC, GROUND, GAPS, paths=0, points=11, scatter=SCATTER, **QUAKE
    )
    for ending in ("", "_poisson"):
        name = f"confidence_of_no_pounding{ending}"
        np.testing.assert_allclose(found[name], single[name].dot(shares[1]), rtol=1e-5)
    now = single.instantaneous_probability.dot(shares[1])
    np.testing.assert_allclose(found.instantaneous_probability, now, rtol=1e-5)
    square = float(weights @ factors**2)
    assert square == pytest.approx(np.exp(2 * SCATTER**2), rel=0.02)
    for name in ("displacement_std_1", "displacement_std_2", "difference_std"):
        np.testing.assert_allclose(found[name], single[name] * np.sqrt(square), rtol=1e-5)
    np.testing.assert_allclose(found.rho, single.rho, atol=1e-5)


@pytest.mark.slow
@pytest.mark.oracle
def test_a_fragility_widens_as_the_convolution_with_the_scatter_says():
    """Over ``ln a``, half of ``ln S0``: the curve without scatter, averaged over a normal shift."""
    logarithm = np.arange(-8, 9) * 0.25
    intensity = 0.01 * np.exp(2 * logarithm)
    curves = [
        sl.pounding_fragility(*ELASTIC, GROUND, 0.15, intensity, scatter=s, paths=1024, **QUAKE)
        for s in (0.0, SCATTER)
    ]
    shift = np.linspace(-4, 4, 401) * SCATTER
    weights = np.exp(-0.5 * (shift / SCATTER) ** 2)
    inner = slice(6, 12)  # elsewhere the shift leaves the table
    for ending, error in (("", 0.01), ("_simulated", 0.04)):
        none, found = (curve[f"pounding_probability{ending}"].values for curve in curves)
        spread = np.interp(logarithm[:, None] + shift, logarithm, none) @ weights / weights.sum()
        assert np.abs(found - spread)[inner].max() < error
        # Steeper in the middle without scatter.
        assert np.ptp(none[inner]) > np.ptp(found[inner])
