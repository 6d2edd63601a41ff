"""Damping devices and dashpots with an exponent, linearized: quadrature, limits, simulation."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.integrate
import scipy.optimize
import xarray as xr

import stochlin as sl
from stochlin.kernels.linearization.gaussian import absolute_moment, equivalent_dashpot

pytestmark = pytest.mark.oracle

GROUND = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.02)
TALL = sl.ShearBuilding(
    np.array([2, 2, 2, 1.5]) * 1e5,
    np.array([4, 3.6, 3, 2.2]) * 1e8,
    [3.0] * 4,
    0.05,
    0.05,
    [0.005] * 4,
)
ONE = sl.Bilinear(0.5, 0.05, mass=1e6)
BETWEEN = sl.Link(
    1e7, 1e6, damping_exponent=0.5, hardening=0.1, yield_displacement=0.01, structures=(1, 2)
)


def damper(constant, exponent, structure=1, floors=(1, 0)):
    place = {"structures": (structure, structure), "floors": floors}
    return sl.Link(0.0, constant, damping_exponent=exponent, **place)


STOREYS = [damper(2e6, 0.3, floors=(n, n - 1)) for n in (1, 2, 3, 4)]


@pytest.mark.parametrize("std", [1e-3, 0.7])
@pytest.mark.parametrize("exponent", [0.05, 0.2, 0.5, 1.0, 1.7, 2.0])
def test_linear_dashpot_is_that_of_the_least_mean_square(exponent, std):
    """Of ``c |v|^a sign(v) - c_eq v`` for a Gaussian rate."""

    def mean(power):
        def integrand(s):  # v = std s^4: no root at zero
            return (std * s**4) ** power * np.exp(-0.5 * s**8) * 4 * s**3 * 2 / np.sqrt(2 * np.pi)

        return scipy.integrate.quad(integrand, 0, 3, epsabs=0, epsrel=1e-13)[0]

    assert absolute_moment(exponent, std) == pytest.approx(mean(exponent), rel=1e-11)
    found = equivalent_dashpot(3.0, exponent, std)
    assert found == pytest.approx(3 * mean(exponent + 1) / mean(2), rel=1e-11)


@pytest.mark.parametrize("exponent", [0.1, 0.3, 0.6, 1.5, 2.0])
def test_oscillator_on_white_noise(exponent):
    """Closed form: the noise's power, ``pi S0 m``, is what both dashpots take, ``c sigma_v^2``."""
    s0, constant = 0.01, 1e6
    own = 2 * ONE.damping * 2 * np.pi / ONE.period * ONE.mass
    factor = equivalent_dashpot(constant, exponent, 1.0)

    def excess(log_rate):
        rate = np.exp(log_rate)
        return (own + factor * rate ** (exponent - 1)) * rate**2 - np.pi * s0 * ONE.mass

    rate = np.exp(scipy.optimize.brentq(excess, -20, 5, xtol=1e-14))
    table = sl.linearize_system([ONE], sl.WhiteNoise(s0), [damper(constant, exponent)])
    assert float(table.velocity_std[0]) == pytest.approx(rate, rel=1e-11)
    assert float(table.displacement_std[0]) == pytest.approx(
        rate * ONE.period / (2 * np.pi), rel=1e-11
    )
    told = float(table.equivalent_damping_constant.sel(link="link 1"))
    assert told == pytest.approx(factor * rate ** (exponent - 1), rel=1e-11)
    force = constant * np.sqrt(absolute_moment(2 * exponent, rate))
    assert float(table.link_force_std[0]) == pytest.approx(force, rel=1e-11)
    assert int(table.status) == 1


def test_end_of_the_loop_is_that_of_the_linear_dashpots_it_names():
    links = [*STOREYS, BETWEEN]
    table = sl.linearize_system([TALL, ONE], GROUND, links)
    assert max(table.covariance_change[-1], table.coefficient_change[-1]) < 1e-10
    told = table.equivalent_damping_constant.values
    linear = [
        replace(one, damping_constant=c, damping_exponent=None)
        for one, c in zip(links, told, strict=True)
    ]
    again = sl.linearize_system([TALL, ONE], GROUND, linear)
    np.testing.assert_allclose(table.covariance, again.covariance, rtol=0, atol=1e-12)
    assert "equivalent_damping_constant" not in again
    space = sl.statespace([TALL, ONE], GROUND, table.c_eq.values, table.k_eq.values, links=linear)
    np.testing.assert_allclose(
        sl.stationary_covariance(space), table.covariance, rtol=0, atol=1e-12
    )
    names = list(table.state.values)
    rate = np.zeros(len(names))
    rate[names.index("v_1.4")], rate[names.index("v_2")] = 1, -1
    std = np.sqrt(rate @ table.covariance.values @ rate)
    assert told[-1] == pytest.approx(equivalent_dashpot(1e6, 0.5, std), rel=1e-9)


def test_force_of_a_link_with_spring_and_dashpot():
    """Of Gaussian states, drawn; the linear part alone would be 4 % less."""
    table = sl.linearize_system([TALL, ONE], GROUND, [BETWEEN])
    rng, names = np.random.default_rng(5), list(table.state.values)
    x = dict(
        zip(
            names,
            rng.multivariate_normal(np.zeros(len(names)), table.covariance, 400_000).T,
            strict=True,
        )
    )
    drift, rate = (x[f"{kind}_1.4"] - x[f"{kind}_2"] for kind in "uv")
    force = 1e6 * drift + 9e6 * x["z_link 1"] + 1e6 * np.sign(rate) * np.abs(rate) ** 0.5
    assert float(table.link_force_std[0]) == pytest.approx(force.std(), rel=0.006)


@pytest.mark.parametrize("exponent", [0.3, 2.0])
def test_simulation_of_dampers_in_every_storey(exponent):
    """Within the error of simulation and what linearization may be off, 3 % of the drifts.

    Dampers of a twentieth of the weight at .3 m/s. Where they hold storeys fast much of the time
    the rates are not Gaussian: of a fifth of the weight, a = .3, the upper drift comes out 23 % too
    small.
    """
    low = sl.ShearBuilding([2e5] * 2, [3e8, 2e8], [3.0] * 2, 0.05)
    links = [
        replace(one, damping_constant=2e5 / 0.3**exponent, damping_exponent=exponent)
        for one in STOREYS
    ]
    linear = sl.linearize_system([low], GROUND, links[:2])
    exact = sl.simulate([low], GROUND, link=links[:2], paths=128, relaxation_times=10, seed=1)
    bare = sl.linearize_system([low], GROUND)
    off = np.abs(linear.drift_std[:2].values - exact.drift_std.values)
    assert (off < 0.03 * exact.drift_std + 3 * exact.drift_std_standard_error).all()
    assert (linear.drift_std < 0.9 * bare.drift_std).all()


@pytest.mark.extreme
def test_hysteretic_device_in_an_elastic_oscillator_makes_it_bilinear():
    k, share, hardening = ONE.mass * (2 * np.pi / ONE.period) ** 2, 0.4, 0.1
    device = sl.Link(
        share * k, hardening=hardening, yield_displacement=0.01, structures=(1, 1), floors=(1, 0)
    )
    soft = replace(ONE, period=ONE.period / np.sqrt(1 - share), damping=0.05 / np.sqrt(1 - share))
    left = 1 - share + hardening * share
    one = sl.linearize_system([soft], GROUND, [device])
    whole = sl.linearize(replace(ONE, hardening=left, yield_displacement=0.01), GROUND)
    assert float(one.displacement_std[0]) == pytest.approx(float(whole.displacement_std), rel=1e-9)
    assert float(one.k_eq.sel(element="link 1")) == pytest.approx(float(whole.k_eq), rel=1e-8)


def test_a_table_of_exponents_of_two_linked_oscillators():
    pair = ONE, sl.Bilinear(0.8, 0.05, 0.1, reduction_factor=3, mass=2e6)
    exponents = xr.DataArray([0.3, 1.0, 5.0, 2.0], dims="a")
    link = sl.Link(1e7, 1e6, damping_exponent=exponents)
    table = sl.linearize_system(pair, GROUND, [link])
    constants = table.equivalent_damping_constant.isel(link=0)
    assert table.status.values.tolist() == [0, 0, 3, 0]
    assert np.isnan(constants[2])
    alone = sl.linearize_system(pair, GROUND, [replace(link, damping_exponent=0.3)])
    np.testing.assert_allclose(table.rho[0], alone.rho, rtol=1e-12)
    np.testing.assert_allclose(constants[0], alone.equivalent_damping_constant[0], rtol=1e-12)
    assert float(constants[1]) == 1e6
