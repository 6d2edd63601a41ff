"""Laws of several states in sympy: their rates, their steps, and where they can be used."""

import numpy as np
import pytest
import sympy

import stochlin as sl

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


def hysteretic(law=None, **changed):
    return sl.Hysteretic(**GIVEN | changed, law=law or baber_noori(**PINCHING))


def test_it_is_the_law_that_is_known_by_its_name():
    own = {
        "exponent": "n",
        "strength_decay": "d_nu",
        "stiffness_decay": "d_eta",
        "pinching": "zeta_s",
    }
    own |= {"pinching_rate": "p", "pinching_start": "q", "pinching_width": "psi"}
    own |= {"beta": "beta", "pinching_spread": "d_psi", "pinching_coupling": "share"}
    known = sl.BoucWenBaberNoori(**GIVEN, **{name: PINCHING[key] for name, key in own.items()})
    peaks = sl.simulate([hysteretic(), known], GROUND, paths=32, duration=5.0).peak
    np.testing.assert_allclose(peaks[:, 0], peaks[:, 1], rtol=1e-9)


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
    message = (
        "number 1: law = .* no stationary response: .* for ever .e.; .*simulate with a duration"
    )
    with pytest.raises(ValueError, match=message):
        sl.simulate([building(hysteretic().law)], GROUND, paths=32)


SAME = {"e": Z * V}


@pytest.mark.parametrize(
    ("law", "error", "message"),
    [
        ({"e": Z * V}, ValueError, "law = .* has rates of e; allowed: z and"),
        ({"z": V, "v": Z}, ValueError, "digits, not 'v'"),
        ({"z": V, "e 1": Z * V}, ValueError, "names of letters and digits"),
        ({"z": V} | {f"e{n}": Z * V for n in range(8)}, ValueError, "at most 7 further"),
        ({"z": V, "e": 1.0}, TypeError, "law = 1.0 is not allowed; give a sympy expression"),
        ((1, 2), TypeError, "give a sympy expression, or a mapping"),
        ({"z": V, "e": D * V}, ValueError, "law of e = .*'d'.*allowed: 'v', 'z', 'e'"),
        ({"z": Z} | SAME, ValueError, "law of z = z has the symbols"),
        ({"z": V / E} | SAME, ValueError, "further states from 0 to 2.5, or where all"),
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
        with pytest.raises(ValueError, match=r"growing_states = .*allowed: some of \['e'\]"):
            hysteretic({"z": V, "e": Z * V}, growing_states=growing)
