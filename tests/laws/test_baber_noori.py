"""The law of Baber, Wen and Noori: its states against another integrator; where it is refused."""

from itertools import pairwise

import numpy as np
import pytest
from loops import by_dop853, by_steps
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import stochlin as sl

pytestmark = pytest.mark.oracle

GROUND = sl.KanaiTajimi(0.4, 0.6, 0.02)
GIVEN = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}
DECAY = {"strength_decay": 0.02, "stiffness_decay": 0.05}
WORN = {"beta": 0.6, "exponent": 1.5, **DECAY, "pinching": 0.9}
WORN |= {"pinching_rate": 1.0, "pinching_start": 0.15, "pinching_width": 0.2}
WORN |= {"pinching_spread": 0.01, "pinching_coupling": 0.4}


def worn(**changed):
    return sl.BoucWenBaberNoori(**GIVEN | WORN | changed)


def slopes(direction, w):
    """``dz/dmu`` and ``dE/dmu`` by hand."""
    z, e = w
    beta, n, d_nu, d_eta, zeta_s, p, q, psi, d_psi, share = WORN.values()
    nu, eta, loading = 1 + d_nu * e, 1 + d_eta * e, z * direction > 0
    slip = nu * abs(z) ** n * (1.0 if loading else 1 - 2 * beta)
    zeta = zeta_s * -np.expm1(-p * e)
    width = (psi + d_psi * e) * (share + zeta)
    h = 1 - zeta * np.exp(-(((z * direction - q / nu ** (1 / n)) / width) ** 2))
    return h / eta * (1 - slip), z


def published_history():
    """Extensions of ``2 t sin(2 pi t)`` at its turns, at 1.1, 2.3 and 3.9, and which these are."""

    def extension(t):
        return 2 * t * np.sin(2 * np.pi * t)

    def rate(t):
        return np.sin(2 * np.pi * t) + 2 * np.pi * t * np.cos(2 * np.pi * t)

    grid = np.linspace(0.01, 4, 400)
    found = [brentq(rate, a, b) for a, b in pairwise(grid) if rate(a) * rate(b) < 0]
    times = np.sort([0.0, *found, 1.1, 2.3, 3.9])
    return extension(times), np.searchsorted(times, [1.1, 2.3, 3.9])


EXPECTED = [[0.88180116, 1.64180666], [0.78911271, 7.84019183], [-0.02266042, 19.36526975]]


def test_states_along_a_history():
    """z and E, from an integrator of eighth order outside this repository."""
    turns, at = published_history()
    exact = by_dop853(slopes, turns, 2)
    np.testing.assert_allclose(exact[at], EXPECTED, rtol=0, atol=1e-7)
    found = by_steps(worn().step(), turns[:, None], 4000, WORN.values())[0][:, :, 0]
    np.testing.assert_allclose(found[at], EXPECTED, rtol=0, atol=1e-7)
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-8)


def test_an_oscillator_on_a_record_follows_an_ode_solver():
    structure, w = worn(), 2 * np.pi / GIVEN["period"]
    uy, xi, alpha = GIVEN["yield_displacement"], GIVEN["damping"], GIVEN["hardening"]
    record = sl.simulated_motions(GROUND, 6.0, paths=2, seed=3)[0]
    time = record.time.to_numpy()

    def slope(t, x):
        u, v, z, e = x
        of_z, of_e = slopes(np.sign(v), (z, e))
        force = alpha * w**2 * u + (1 - alpha) * w**2 * uy * z
        pull = -2 * xi * w * v - force - np.interp(t, time, record)
        return [v, pull, v / uy * of_z, v / uy * of_e]

    exact = solve_ivp(slope, time[[0, -1]], np.zeros(4), rtol=1e-7, atol=1e-10, max_step=1e-2)
    table = sl.respond(structure, record)
    assert exact.y[3, -1] > 5  # it degrades
    peak = np.abs(exact.y[0]).max()
    np.testing.assert_allclose(table.displacement[-1], exact.y[0, -1], rtol=0, atol=5e-4 * peak)
    np.testing.assert_allclose(np.abs(table.displacement).max(), peak, rtol=5e-4)
    spent = exact.y[3, -1] * (1 - alpha) * (w * uy) ** 2
    ends = table.isel(time=-1)
    stored = 0.5 * (1 - alpha) * (w * uy * exact.y[2, -1]) ** 2
    np.testing.assert_allclose(ends.hysteretic_energy_per_mass + stored, spent, rtol=2e-3)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"pinching": 1.0}, "pinching = 1 .*allowed: 0 <= value < 1, .*all stiffness"),
        ({"exponent": 0.5}, "exponent = 0.5 is out of range; allowed: 1 <= value"),
        (
            {"strength_decay": -0.1},
            "strength_decay = -0.1 .*allowed: 0 <= value, .*nothing stronger",
        ),
        ({"beta": 0.0}, "beta = 0 .*allowed: 0 < value, .*dissipate nothing"),
    ],
    ids=str,
)
def test_parameters_out_of_range_are_refused(changed, message):
    with pytest.raises(ValueError, match=message):
        worn(**changed)


@pytest.mark.parametrize(
    "one", [worn(), sl.ModifiedClough(**GIVEN)], ids=lambda one: type(one).__name__
)
def test_stationary_analyses_name_the_finite_motion_instead(one):
    other, message = sl.Bilinear(0.7, 0.05), type(one).__name__ + " .*{} simulate with a duration"
    for linearizing in (
        lambda: sl.linearize(one, GROUND),
        lambda: sl.correlate(one, other, GROUND),
        lambda: sl.linearize_system([one], GROUND),
    ):
        with pytest.raises(ArithmeticError, match=message.format("cannot be linearized.*")):
            linearizing()
    for simulating in (
        lambda: sl.simulate([other, one], GROUND, paths=32),
        lambda: sl.correlate(one, other, GROUND, method="simulation", paths=32),
    ):
        with pytest.raises(ValueError, match=message.format("has no stationary response.*")):
            simulating()
