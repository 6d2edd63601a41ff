"""Laws with memory linearized in time: against another integrator, energy balance and limits."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import stochlin as sl
from stochlin.models.laws.bouc_wen import gaussian

pytestmark = pytest.mark.oracle

GIVEN = {"period": 0.6, "damping": 0.05, "hardening": 0.05, "yield_displacement": 0.02}
DECAY = {"strength_decay": 0.05, "stiffness_decay": 0.1}
WHITE, BROAD = sl.WhiteNoise(0.04), sl.KanaiTajimi(0.4, 0.6, 0.02)
QUAKE = sl.AminAng(1.5, 3.0, 0.5)
DURATION = 5.0
V, Z, E, D = sympy.symbols("v z e d")


def worn(**changed):
    return sl.BoucWenBaberNoori(**GIVEN | DECAY | changed)


def response(structure, ground=BROAD, duration=DURATION, points=21):
    return sl.transient_response(structure, ground, duration, envelope=QUAKE, points=points)


@pytest.mark.extreme
def test_without_decay_it_is_bouc_wen():
    """Whose coefficients are in closed form; the energy is then only watched."""
    none = dict.fromkeys(DECAY, 0.0)
    found = response(worn(beta=0.7, exponent=1.5, **none), duration=2.5)
    expected = response(sl.BoucWen(**GIVEN, beta=0.7, gamma=0.3, exponent=1.5), duration=2.5)
    for name in expected:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-5, atol=1e-8)


def test_moments_of_decay_follow_their_differential_equations():
    """On white noise, in yield displacements, with the Bouc-Wen closure scaled by hand."""
    structure, times = worn(exponent=1.5), np.linspace(0, DURATION, 21)
    w, xi, alpha = 2 * np.pi / structure.period, structure.damping, structure.hardening
    power = 2 * np.pi * WHITE.intensity / structure.yield_displacement**2
    law = np.array([[structure.beta], [1 - structure.beta], [structure.exponent]])

    def rates(time, y):
        x, e = y[:9].reshape(3, 3), y[9]
        nu, eta = 1 + structure.strength_decay * e, 1 + structure.stiffness_decay * e
        sv, sz = np.sqrt(np.maximum([x[1, 1], x[2, 2]], 1e-30))
        r = np.clip(x[1, 2] / (sv * sz), -0.999999, 0.999999)
        slip, relaxation = gaussian(np.array([[sv], [sz], [r]]), law).coefficients[:, 0]
        matrix = np.array(
            [
                [0, 1, 0],
                [-alpha * w**2, -2 * xi * w, -(1 - alpha) * w**2],
                [0, (1 - nu * slip) / eta, -nu / eta * relaxation],
            ]
        )
        change = matrix @ x + x @ matrix.T
        change[1, 1] += power * float(QUAKE.at(np.array(time))) ** 2
        return [*change.ravel(), x[1, 2]]

    state, rows = np.zeros(10), [np.zeros(10)]
    for begin, end in ((0, 1.5), (1.5, 3.0), (3.0, DURATION)):
        shown = times[(times > begin) & (times <= end)]
        solved = solve_ivp(rates, (begin, end), state, "DOP853", shown, rtol=1e-10, atol=1e-16)
        rows, state = [*rows, *solved.y.T], solved.y[:, -1]
    expected, found = np.array(rows), response(structure, WHITE)
    uy = structure.yield_displacement
    late = times > 0.5  # before, z is below a twenty-fifth of the yield displacement
    for name, values in (
        ("displacement_std", uy * np.sqrt(expected[:, 0])),
        ("velocity_std", uy * np.sqrt(expected[:, 4])),
        ("z_std", np.sqrt(expected[:, 8])),
    ):
        np.testing.assert_allclose(found[name][late], values[late], rtol=2e-4)
    np.testing.assert_allclose(found.state_mean[late, 0], expected[late, 9], rtol=2e-4, atol=1e-5)
    assert float(found.state_mean[-1, 0]) > 4


@pytest.mark.parametrize(
    "structure",
    [
        sl.Bilinear(**GIVEN),
        pytest.param(worn(pinching=0.9), marks=pytest.mark.slow),
        sl.Bilinear(0.6, 0.05),
    ],
    ids=["bilinear", "pinched", "elastic"],
)
def test_the_work_of_white_noise_goes_into_all_energies(structure):
    """The mean power of white noise on a mass is ``pi S0 m(t)^2``, whatever the mass does."""
    table = response(structure, WHITE, points=1001)
    w = 2 * np.pi / structure.period
    alpha = structure.hardening if structure.yields else 1.0
    velocity = table.velocity_std**2
    given = np.pi * WHITE.intensity * (QUAKE.at(table.time) ** 2).cumulative_integrate("time")
    kinetic, elastic = 0.5 * velocity, 0.5 * alpha * w**2 * table.displacement_std**2
    viscous = 2 * structure.damping * w * velocity.cumulative_integrate("time")
    total = kinetic + elastic + viscous + table.hysteretic_energy_per_mass
    np.testing.assert_allclose(total, given, atol=2e-4 * float(given[-1]))
    taken = float(table.hysteretic_energy_per_mass[-1] / given[-1])
    assert taken > 0.4 if structure.yields else taken == 0


@pytest.mark.extreme
def test_a_users_law_is_linearized_in_the_same_way():
    slip = (1 + 0.05 * E) * (abs(V) * Z + V * abs(Z)) / 2
    law = {"z": (V - slip) / (1 + E / 10), "e": Z * V}
    found, expected = (
        response(one, duration=2.5) for one in (sl.Hysteretic(**GIVEN, law=law), worn())
    )
    for name in expected:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-5, atol=1e-8)
    assert list(found.state.values) == ["e"]


@pytest.mark.parametrize(
    ("structure", "message"),
    [
        (
            sl.ModifiedClough(**GIVEN),
            "ModifiedClough cannot .* not given in symbols; .* by simulate",
        ),
        (sl.Flag(**GIVEN), "Flag cannot be linearized: its rates are not given in symbols"),
        (
            sl.Hysteretic(
                **GIVEN,
                law={"z": V - abs(V) * (0.9 * Z + D / 30), "d": V - abs(V) * D / 3},
                growing_states=(),
            ),
            "cannot be linearized in time: d has no mean",
        ),
        (worn(pinching=0.9, pinching_width=0.001), "pinching_width = 0.001.* allowed 1e-03"),
    ],
    ids=["clough", "flag", "a state that turns", "too steep"],
)
def test_what_has_no_closure_in_time_says_why(structure, message):
    with pytest.raises(ArithmeticError, match=message):
        response(structure)
