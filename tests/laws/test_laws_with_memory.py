"""Laws of several states in sympy: their rates, their steps, and where they can be used."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import stochlin as sl
from stochlin.kernels.simulation import moving as moves
from stochlin.kernels.simulation.stepping import LANES
from stochlin.models.systems import arrangement_of
from stochlin.solver.simulation.connected_structures import connected_groups

pytestmark = pytest.mark.oracle

V, Z, E, D = sympy.symbols("v z e d")
PINCHING = {
    "beta": 0.6,
    "gamma": 0.4,
    "n": 1.5,
    "d_nu": 0.02,
    "d_eta": 0.05,
    "zeta_s": 0.9,
    "p": 1.0,
    "q": 0.15,
    "psi": 0.2,
    "d_psi": 0.01,
    "share": 0.4,
}
PLAIN = PINCHING | {"d_nu": 0.0, "d_eta": 0.0, "zeta_s": 0.0}
GROUND = sl.KanaiTajimi(0.4, 0.6, 0.02)
GIVEN = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}


def baber_noori(beta, gamma, n, d_nu, d_eta, zeta_s, p, q, psi, d_psi, share):
    """The law of Baber and Noori, with pinching as by Foliente (1995), as a user writes it."""
    nu, eta = 1 + d_nu * E, 1 + d_eta * E
    zeta = zeta_s * (1 - sympy.exp(-p * E))
    spread = (psi + d_psi * E) * (share + zeta)
    most = (nu * (beta + gamma)) ** (-1 / n)
    h = 1 - zeta * sympy.exp(-(((Z * sympy.sign(V) - q * most) / spread) ** 2))
    slip = nu * (beta * abs(V) * abs(Z) ** (n - 1) * Z + gamma * V * abs(Z) ** n)
    return {"z": h / eta * (V - slip), "e": Z * V}


def rates_of(v, z, e, *, beta, gamma, n, d_nu, d_eta, zeta_s, p, q, psi, d_psi, share):
    """The same by numpy; loading and unloading apart."""
    wear = 1 + d_nu * e
    softening = np.where(z * v > 0, beta + gamma, gamma - beta) * wear * np.abs(z) ** n
    pinched = zeta_s * -np.expm1(-p * e)
    peak = q / (wear * (beta + gamma)) ** (1 / n)
    width = (psi + d_psi * e) * (share + pinched)
    h = 1 - pinched / np.exp(((np.where(v > 0, z, -z) - peak) / width) ** 2)
    return np.array([h * v * (1 - softening) / (1 + d_eta * e), z * v])


def hysteretic(law=None, **changed):
    return sl.Hysteretic(**GIVEN | changed, law=law or baber_noori(**PINCHING))


def test_an_oscillator_follows_an_ode_solver():
    """The error of the displacement falls with the square of the step, that of the trapezoidal rule."""
    structure, w = hysteretic(), 2 * np.pi / GIVEN["period"]
    uy, xi, alpha = GIVEN["yield_displacement"], GIVEN["damping"], GIVEN["hardening"]

    def forcing(t):
        return 6 * np.sin(9 * t) * np.sin(1.3 * t)

    def slopes(t, x):
        u, v, z, e = x
        force = 2 * xi * w * v + alpha * w**2 * u + (1 - alpha) * w**2 * uy * z
        return [v, forcing(t) - force, *rates_of(v / uy, z, e, **PINCHING)]

    exact = solve_ivp(slopes, (0, 3), np.zeros(4), rtol=1e-9, atol=1e-11, max_step=2e-3).y[:, -1]
    part = connected_groups(arrangement_of([structure]))[0].part
    errors = []
    for steps in (600, 1200, 2400):
        t = np.linspace(0, 3, steps + 1)
        mean = 0.5 * (forcing(t[1:]) + forcing(t[:-1]))
        f, x, out = np.repeat(mean[:, None], LANES, axis=1), part.at_rest(), np.empty((1, 1, LANES))
        part.block(3 / steps)(f, x, steps, out)
        state = [x.elements[0, moves.Z, 0] / uy, x.memory[0, 0, 0]]
        errors.append(np.abs([(out[0, 0, 0] - exact[0]) / uy, *(state - exact[2:])]).max())
    assert exact[3] > 10  # it yields and wears
    assert errors[0] < 0.1
    assert errors[2] < 0.4 * errors[1] < 0.16 * errors[0]


def building(law):
    strength = {"hardening": 0.1, "yield_drifts": 0.01}
    return sl.ShearBuilding([1e5] * 2, [4e7] * 2, [3.0] * 2, 0.05, law=law, **strength)


def test_storeys_of_a_building_have_the_law():
    one, worn = building(baber_noori(**PLAIN)), building(baber_noori(**PINCHING))
    other = sl.ShearBuilding(
        *(one.masses, one.stiffnesses, one.heights, 0.05, 0.1, 0.01),
        law="bouc_wen",
        law_parameters={"beta": 0.6, "gamma": 0.4, "exponent": 1.5},
    )
    table = sl.simulate([one, other, worn], GROUND, paths=32, duration=5.0)
    peaks = table.peak.values.reshape(32, 3, 2)
    np.testing.assert_allclose(peaks[:, 0], peaks[:, 1], rtol=1e-5)
    assert np.abs(peaks[:, 2] / peaks[:, 0] - 1).max() > 0.01
    assert worn.oscillator().symbolic() == baber_noori(**PINCHING)
    assert "e: v*z" in worn.describe()


def test_storeys_that_wear_have_no_stationary_response():
    message = "number 1: law = .* no stationary response: .* for ever .e.; .*simulate with a duration"
    with pytest.raises(ValueError, match=message):
        sl.simulate([building(hysteretic().law)], GROUND, paths=32)


SAME = {"e": Z * V}


@pytest.mark.parametrize(
    ("law", "error", "message"),
    [
        ({"e": Z * V}, ValueError, "law = .* has rates of e; allowed: those of z"),
        ({"z": V, "v": Z}, ValueError, "not 'v', the ductility rate"),
        ({"z": V, "e 1": Z * V}, ValueError, "names consist of letters and digits"),
        ({"z": V} | {f"e{n}": Z * V for n in range(8)}, ValueError, "at most 7 further"),
        ({"z": V, "e": 1.0}, TypeError, "law = 1.0 is not allowed; give a sympy expression"),
        ((1, 2), TypeError, "give a sympy expression, or a mapping"),
        ({"z": V, "e": D * V}, ValueError, "law of e = .*'d'.*allowed: 'v', 'z', 'e'"),
        ({"z": Z} | SAME, ValueError, "law of z = z has the symbols"),
        ({"z": V, "e": sympy.gamma(Z)}, ValueError, "gamma.* has no numeric form"),
        ({"z": V / E} | SAME, ValueError, "further states from 0 to 2.5 and at z = e = 0"),
        ({"z": V, "e": sympy.sqrt(Z)}, ValueError, "not real and finite"),
        ({"z": V * (1 - Z)} | SAME, ValueError, "differs with the direction"),
        ({"z": V, "e": V + Z * V}, ValueError, "differs with the direction"),
    ],
    ids=str,
)
def test_bad_laws_are_refused_with_the_cure(law, error, message):
    with pytest.raises(error, match=message):
        sl.Hysteretic(**GIVEN, law=law)


@pytest.mark.parametrize(
    ("law", "growing"),
    [
        ({"z": V - abs(V) * Z / (1 + E), "e": Z * V}, ("e",)),
        ({"z": V - abs(V) * D, "d": V - D}, ()),
        ({"z": V * (1 - D * Z / (1 + E)), "d": V, "e": D * V}, ("e",)),
    ],
    ids=["energy", "displacement", "both"],
)
def test_a_law_says_which_states_keep_their_signs_and_is_held_to_it(law, growing):
    one = hysteretic(law, growing_states=growing)
    assert one.growing() == growing
    if growing != one.further_states():
        with pytest.raises(ValueError, match=r"differs with the direction; .* growing_states = "):
            hysteretic(law)


def test_growing_states_are_states_besides_z():
    for growing in (("z",), "e", ("e", "d")):
        with pytest.raises(ValueError, match=r"growing_states = .*allowed: .* some of \['e'\]"):
            hysteretic({"z": V, "e": Z * V}, growing_states=growing)
