"""Curves of the drift closure have no kinks, though a map on a grid corrects them."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle
POINTS = 1281
GROUNDS = [sl.KanaiTajimi(2.0, damping) for damping in (0.05, 0.6)]  # those of Figs. 4 and 5
R = xr.DataArray([1.0, 2.0, 4.0, 6.0], dims="R")


def largest_kink(curves, logarithm):
    """Largest jump of the slope over the logarithm of the period, less curvature on both sides."""
    slope = np.diff(curves.transpose(..., "T").values) / np.diff(logarithm)
    jump = np.diff(slope)
    return np.abs(jump[..., 1:-2] + jump[..., 2:-1] - jump[..., :-3] - jump[..., 3:]).max()


def building(period, reduction_factor):
    return sl.Bilinear(period, 0.05, 0.05, reduction_factor=reduction_factor)


def periods(least):
    logarithm = np.linspace(np.log(least), np.log(4), POINTS)
    return xr.DataArray(np.exp(logarithm), dims="T"), logarithm


@pytest.mark.parametrize("ground", GROUNDS)
@pytest.mark.parametrize("second", [1.0, 2.0, 4.0])
def test_correlation_over_the_period_ratio(ground, second):
    """Fig. 4; linear interpolation in the map, and limits between its parts, gave 0.8 to 2.3."""
    ratio, x = periods(0.25)
    table = sl.correlate(building(ratio * second, R), building(second, R), ground, closure="drift")
    assert largest_kink(table.rho, x) < 0.1


@pytest.mark.parametrize("ground", GROUNDS)
def test_amplification(ground):
    """The logarithm of Fig. 5b; formerly 1.1 and 0.3."""
    ratio, x = periods(0.1)
    table = sl.amplification(building(2 * ratio, R), ground, closure="drift")
    assert largest_kink(np.log(table.amplification), x) < 0.06


def test_correlation_over_the_strength():
    """Along another axis of the map."""
    logarithm = np.linspace(np.log(0.4), np.log(14), POINTS)
    strength = xr.DataArray(np.exp(logarithm), dims="T")
    first, second = (building(period, strength) for period in (1.0, 1.3))
    for ground in GROUNDS:
        table = sl.correlate(first, second, ground, closure="drift")
        assert largest_kink(table.rho, logarithm) < 0.1
