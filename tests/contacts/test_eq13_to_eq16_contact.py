"""Eqs. (13) to (16), Figs. 6 to 8: impact, contact elements, and what they leave of a velocity."""

import hypothesis.strategies as st
import numpy as np
import pytest
import xarray as xr
from hypothesis import given

import stochlin as sl
from stochlin.charts import (
    ChartSettings,
    contact_history_chart,
    contact_loop_chart,
)
from stochlin.kernels.simulation.contacts import velocities_after_impact

pytestmark = pytest.mark.paper

SPEED, MASS, SHARE = st.floats(-10, 10), st.floats(1e-3, 1e9), st.floats(0, 1)

# --- Eq. (13) -------------------------------------------------------------------------------------


@given(SPEED, SPEED, MASS, MASS, SHARE)
def test_impact_keeps_momentum_and_turns_the_relative_velocity(v1, v2, m1, m2, e):
    v1, v2 = max(v1, v2), min(v1, v2)
    first, second = velocities_after_impact(v1, v2, m1, m2, e)
    rounding = 8 * np.finfo(float).eps * (abs(v1) + abs(v2))
    assert first - second == pytest.approx(-e * (v1 - v2), abs=rounding)
    assert m1 * (first - v1) == pytest.approx(-m2 * (second - v2), abs=(m1 + m2) * rounding)


# --- Eqs. (14) to (16) ----------------------------------------------------------------------------


@given(st.floats(1e-12, 1))
def test_eq15_is_the_kelvin_element_s(e):
    eq_15 = -np.log(e) / np.sqrt(np.pi**2 + np.log(e) ** 2)
    assert sl.Kelvin.damping_ratio(e) == pytest.approx(eq_15, rel=1e-14)


# --- Fig. 8 and the values beside it --------------------------------------------------------------


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (sl.Kelvin, [0.7292, 0.3723, 0.1630, 0.0015]),
        (sl.NoTensionKelvin, [0.7441, 0.4510, 0.2984, 0.1553]),
        (sl.ImpactKelvin, [0.8626, 0.6715, 0.5463, 0.3941]),
    ],
)
def test_restitution_has_the_values_of_fig8(kind, values):
    np.testing.assert_allclose(kind.restitution([0.1, 0.3, 0.5, 0.9]), values, rtol=0, atol=5.1e-5)


# --- Figs. 6 and 7 --------------------------------------------------------------------------------


def quadrature_error(chart):
    """A few h^2, as forces have kinks where a dashpot stops; Jankowski's begins as t^(1/4), too."""
    step = chart.scaled_time.isel(point=1)
    return xr.where(chart.element == "Jankowski", step**1.25, 4 * step**2)


def loop_area(chart):
    """Work of the force on the deformation, by Simpson's rule in time."""
    power = chart.scaled_force * chart.scaled_velocity
    step = chart.scaled_time.isel(point=1)
    weights = xr.DataArray(np.where(np.arange(chart.sizes["point"]) % 2, 4.0, 2.0), dims="point")
    weights[[0, -1]] = 1.0
    return step / 3 * (power * weights).sum("point")


@pytest.fixture(name="chart", scope="module", params=[contact_loop_chart, contact_history_chart])
def a_chart(request):
    return request.param(ChartSettings(points=2001))


def test_loops_begin_and_end_as_contacts_do(chart):
    first, last = chart.isel(point=0), chart.isel(point=-1)
    assert (first.scaled_deformation == 0).all()
    assert (first.scaled_velocity == 1).all()
    np.testing.assert_allclose(last.scaled_velocity, -chart.restitution, rtol=1e-9)
    np.testing.assert_allclose(last.scaled_time, chart.scaled_contact_time)
    kelvin = last.sel(element="Kelvin")
    pull = 2 * kelvin.contact_damping * kelvin.scaled_velocity
    assert float(kelvin.scaled_force) == pytest.approx(float(pull), rel=1e-12)
    part = last.sel(element="NoTensionKelvin")
    assert abs(float(part.scaled_force)) < 1e-14
    assert float(part.scaled_deformation) > 0.1
    others = last.drop_sel(element="NoTensionKelvin")
    np.testing.assert_allclose(others.scaled_deformation, 0, atol=1e-11)


def test_loop_area_is_the_energy_lost(chart):
    lost = (1 - chart.restitution**2) / 2
    assert (np.abs(loop_area(chart) - lost) < quadrature_error(chart)).all()
