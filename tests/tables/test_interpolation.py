"""Interpolation on a grid: by Hermite splines axis by axis."""

import numpy as np
import pytest
import scipy.interpolate

from stochlin.solver.tables.interpolation import Grid, linear

pytestmark = pytest.mark.oracle


def by_splines(axes, values, point):
    """A spline with the slopes of parabolas, 0 at its ends, reduces one axis after the other."""
    for axis, x in zip(axes, point, strict=True):
        slopes = np.zeros_like(values)
        if axis.size > 2:
            slopes[1:-1] = np.gradient(values, axis, axis=0)[1:-1]
        values = scipy.interpolate.CubicHermiteSpline(axis, values, slopes)(x)
    return values


@pytest.mark.parametrize("dimensions", [1, 2, 3, 5])
def test_interpolation_is_by_splines_along_each_axis(dimensions):
    rng = np.random.default_rng(dimensions)
    axes = [np.cumsum(rng.uniform(0.1, 1, 2 + rng.integers(0, 4))) for _ in range(dimensions)]
    values = rng.standard_normal([*(axis.size for axis in axes), 3])
    points = np.array([rng.uniform(axis[0], axis[-1], 60) for axis in axes])
    points[:, :20] = np.array([rng.choice(axis, 20) for axis in axes])
    points[0, 10:20] = rng.uniform(axes[0][0], axes[0][-1], 10)
    expected = [by_splines(axes, values, point) for point in points.T]
    found = Grid.of(axes, values).at(points)
    np.testing.assert_allclose(found.T, expected, rtol=0, atol=1e-12)
    points[::2] = points[::2, :1]  # equal along every other axis
    expected = [by_splines(axes, values, point) for point in points.T]
    found = Grid.of(axes, values).at(points)
    np.testing.assert_allclose(found.T, expected, rtol=0, atol=1e-12)


def test_linear_interpolation_is_that_of_scipy():
    rng = np.random.default_rng(11)
    axes = [np.cumsum(rng.uniform(0.1, 1, size)) for size in (2, 6, 4)]
    values = rng.standard_normal((2, 6, 4, 2))
    points = np.array([rng.uniform(axis[0], axis[-1], 60) for axis in axes])
    points[:, :20] = np.array([rng.choice(axis, 20) for axis in axes])
    expected = scipy.interpolate.interpn(axes, values, points.T)
    found = Grid.of(axes, values, linear).at(points)
    np.testing.assert_allclose(found.T, expected, rtol=0, atol=1e-13)


@pytest.mark.parametrize("wrong", [np.nan, -0.1, 2.1])
def test_points_outside_are_nan_and_spoil_no_others(wrong):
    axes = [np.array([0.0, 0.5, 2.0])] * 3
    points = np.full((3, 4), 0.7)
    points[1, 2] = wrong
    out = Grid.of(axes, np.ones((3, 3, 3, 2))).at(points)
    assert np.isnan(out[:, 2]).all()
    np.testing.assert_allclose(np.delete(out, 2, axis=1), 1, rtol=0, atol=1e-14)


def test_a_section_is_the_grid_at_a_place_of_one_axis():
    rng = np.random.default_rng(7)
    axes = [np.cumsum(rng.uniform(0.1, 1, size)) for size in (3, 5, 4)]
    grid = Grid.of(axes, rng.standard_normal((3, 5, 4, 2)))
    points = np.array([rng.uniform(axis[0], axis[-1], 50) for axis in axes])
    for number in range(3):
        points[number] = points[number, 0]
        found = grid.section(number, points[number, 0]).at(np.delete(points, number, axis=0))
        np.testing.assert_allclose(found, grid.at(points), rtol=0, atol=1e-13)
