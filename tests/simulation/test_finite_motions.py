"""Peaks and separations of finite motions: exact limits, other estimates, order statistics."""

import numpy as np
import pytest
import scipy.integrate
import scipy.stats
import sympy
import xarray as xr

import stochlin as sl
from stochlin.kernels.simulation.ensemble import MotionGroup
from stochlin.solver.simulation.statistics import quantile_intervals
from stochlin.solver.simulation.structures_in_motion import structures_in_motion

pytestmark = pytest.mark.oracle

BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6)
QUAKE = sl.AminAng(4.0, 15.0, 0.35)


def elastic(period, damping=0.05):
    return sl.Bilinear(period, damping)


def mean(samples):
    return samples.mean("path"), samples.std("path", ddof=1) / np.sqrt(samples.sizes["path"])


def test_variance_under_an_envelope_follows_the_lyapunov_equation():
    """Displacement of an elastic structure at the end of a rise, over 4096 motions."""
    w, xi, intensity, steps, period = 2 * np.pi, 0.05, 0.01, 96, 1.0
    noise = sl.WhiteNoise(intensity)
    options = {"paths": 4096, "seed": 3, "steps_per_period": 32}
    run = structures_in_motion([elastic(period)], noise, None, False, **options).run
    plan = run.plan._replace(every=1, samples=steps)
    envelope = QUAKE.at(plan.dt * (np.arange(steps) + 0.5))
    last = [
        MotionGroup(run.ensemble._replace(plan=plan), group).block(envelope)[-1, 0].copy()
        for group in range(plan.groups)
    ]
    sampled = np.concatenate(last) ** 2

    matrix = np.array([[0, 1], [-(w**2), -2 * xi * w]])

    def rate(time, flat):
        covariance = flat.reshape(2, 2)
        drive = np.diag([0, 2 * np.pi * intensity * float(QUAKE.at(np.array(time))) ** 2])
        return (matrix @ covariance + covariance @ matrix.T + drive).ravel()

    end = scipy.integrate.solve_ivp(rate, (0, steps * plan.dt), np.zeros(4), rtol=1e-9, atol=1e-14)
    error = sampled.std(ddof=1) / np.sqrt(sampled.size)
    # half a per cent for the step: the rule is exact for stationary variances only
    assert abs(sampled.mean() - end.y[0, -1]) < 4 * error + 0.005 * end.y[0, -1]


def test_structures_that_change_places_exchange_their_sides():
    """By symmetry of the motion, u1 - u2 and u2 - u1 have one distribution."""
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (0.7, 1.0)]
    apart = sl.simulate(pair, BROAD, paths=2048, duration=30.0, envelope=QUAKE).separation
    assert scipy.stats.ks_2samp(apart[:, 0, 1], apart[:, 1, 0]).pvalue > 1e-4


@pytest.mark.extreme
def test_exceedance_is_monotone_and_covers():
    rng = np.random.default_rng(5)
    gaps = xr.DataArray(np.linspace(-1, 4, 21), dims="gap")
    table = sl.exceedance(xr.DataArray(rng.normal(size=1000), dims="path"), gaps)
    assert (np.diff(table.probability) <= 0).all()
    assert (table.probability_lower <= table.probability).all()
    assert (table.probability_upper >= table.probability).all()
    exact = scipy.stats.norm.sf(gaps)
    inside = (table.probability_lower <= exact) & (exact <= table.probability_upper)
    assert int(inside.sum()) >= 17  # one sample: the 21 intervals succeed or fail together
    assert float(sl.exceedance(xr.DataArray([1.0, 2.0], dims="path"), 2.5).probability_lower) == 0.0
    for wrong in ([0.1], np.array([0.1]), xr.DataArray("wide")):
        with pytest.raises(TypeError, match=r"^gap = "):
            sl.exceedance(xr.DataArray([1.0], dims="path"), wrong)


def test_envelopes_match_their_formulas():
    time = np.array([1.0, 4.0, 9.0, 20.0])
    np.testing.assert_allclose(QUAKE.at(time), [1 / 16, 1, 1, np.exp(-0.35 * 5)])
    np.testing.assert_allclose(sl.GammaEnvelope(1.0, 0.2).at(time), time / 5 * np.exp(1 - time / 5))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"duration": 0}, "duration = 0"),
        ({"duration": 5.0, "quantiles": (0.5, 1.0)}, "quantiles"),
        ({"duration": 5.0, "quantiles": ()}, "quantiles"),
        ({"duration": 5.0, "envelope": 3}, "envelope = 3"),
        ({"duration": 5.0, "scatter": 40}, "scatter = 40.*allowed"),
        ({"envelope": QUAKE}, "envelope is given without a duration"),
        ({"scatter": 0.4}, r"scatter = 0\.4 is given without a duration"),
        (
            {"structures": [elastic([0.5, 1.0])]},
            r"structures\[0\]: period is an array",
        ),
        ({"structures": [elastic(sl.Uncertain(1.0, 0.2))]}, "structure_1: period is uncertain"),
    ],
    ids=str,
)
def test_bad_motions_are_refused(change, message):
    with pytest.raises((TypeError, ValueError), match=message):
        sl.simulate(**{"structures": [elastic(1.0)], "ground": BROAD, "paths": 32} | change)


V, Z = sympy.symbols("v z")
GIVEN = {"hardening": 0.1, "yield_displacement": 0.02}
OF_ALL_LAWS = [
    sl.Bilinear(0.7, 0.05, **GIVEN),
    sl.BoucWen(1.1, 0.05, **GIVEN, exponent=1.7),
    sl.Hysteretic(0.9, 0.05, **GIVEN, law=V - (abs(V) * abs(Z) ** 0.4 * Z + V * abs(Z) ** 1.4) / 2),
]


def test_a_motion_has_the_same_bits_among_few_and_many_and_beside_other_structures():
    many = sl.simulate(OF_ALL_LAWS, BROAD, paths=96, duration=6.0, seed=4, steps_per_period=40)
    few = sl.simulate(OF_ALL_LAWS, BROAD, paths=32, duration=6.0, seed=4, steps_per_period=40)
    np.testing.assert_array_equal(few.separation, many.separation[:32])
    turned = sl.simulate(
        OF_ALL_LAWS[::-1], BROAD, paths=32, duration=6.0, seed=4, steps_per_period=40
    )
    np.testing.assert_array_equal(turned.peak[:, ::-1], few.peak)
    np.testing.assert_array_equal(turned.separation[:, 2, 0], few.separation[:, 0, 2])


@pytest.mark.parametrize("count", [32, 256, 2048])
def test_an_interval_of_a_quantile_contains_it_as_often_as_it_says(count):
    """By the binomial distribution of how many samples are below the quantile."""
    levels = np.array([0.02, 0.5, 0.84, 0.95, 0.999])
    ranks = np.arange(1, count + 1)
    _, low, high = quantile_intervals(ranks.astype(float), levels)
    below = np.array(
        [scipy.stats.binom.pmf(np.arange(count + 1), count, level) for level in levels]
    )
    covered = [
        p[int(a) : int(min(b, count + 1))].sum() for p, a, b in zip(below, low, high, strict=True)
    ]
    assert (np.array(covered) >= 0.95).all()
    inside = (low > 0) & (high < np.inf)
    assert (np.array(covered)[inside] < 0.99).all()
