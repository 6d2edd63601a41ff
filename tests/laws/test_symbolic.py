"""Laws written in sympy: the same answers as closed forms, and as two-dimensional quadrature."""

import cases
import numpy as np
import pytest
import sympy
from scipy.integrate import dblquad

import stochlin as sl
from stochlin.models.laws import bilinear, bouc_wen
from stochlin.models.symbolic import compiled

pytestmark = pytest.mark.oracle

V, Z = sympy.symbols("v z")
COMPARED = ["displacement_std", "velocity_std", "z_std", "velocity_z_corr", "c_eq", "k_eq"]
GROUND = sl.KanaiTajimi(period=0.8, damping=0.3)


def structure(kind, rng, **law):
    return kind(**cases.draw_structure(rng, cases.PRACTICE, 12), **law)


def assert_same_response(one, other, tolerance=1e-9):
    first, second = sl.linearize(one, GROUND), sl.linearize(other, GROUND)
    assert not first.status.any()
    for name in COMPARED:
        np.testing.assert_allclose(first[name], second[name], rtol=tolerance, atol=0, err_msg=name)


@pytest.mark.parametrize(
    "own",
    [
        None,
        (0.5, 0.5, 1),
        (0.7, -0.4, 1),
        (0.5, 0.5, 2),
        (0.9, 0.1, 3),
        (0.5, 0.5, 2.5),
        (0.6, 0.3, 1.2),
    ],
)
def test_known_laws_as_expressions(own):
    names = dict(zip(("beta", "gamma", "exponent"), own or (), strict=False))
    law = bouc_wen.symbolic() if own else bilinear.symbolic()
    law = law.subs({s: names[s.name] for s in law.free_symbols if s.name in names})
    symbolic = structure(sl.Hysteretic, np.random.default_rng(41), law=law)
    kind = sl.BoucWen if own else sl.Bilinear
    own_floats = {name: float(value) for name, value in names.items()}
    closed = structure(kind, np.random.default_rng(41), **own_floats)
    assert_same_response(symbolic, closed)


def gaussian_average(function, sv, sz, r):
    """``E[function(v, z)]`` by nested QUADPACK, over the half plane ``v > 0`` twice."""

    def integrand(v, z):
        square = (v / sv) ** 2 - 2 * r * v * z / (sv * sz) + (z / sz) ** 2
        return function(v, z) * np.exp(-square / (2 * (1 - r * r)))

    norm = 2 * np.pi * sv * sz * np.sqrt(1 - r * r)
    accuracy = {"epsabs": 1e-12, "epsrel": 1e-11}
    parts = [
        dblquad(integrand, low * sz, high * sz, 0, 9 * sv, **accuracy)[0]
        for low, high in ((-9, 0), (0, 9))
    ]
    return 2 * sum(parts) / norm


def creep(v, z):
    return v - 0.2 * z**3


def saturating(v, z):
    return np.tanh(v) * (1 - np.abs(z)) - 0.1 * z


def fractional(v, z):
    return v - 0.5 * (np.abs(v) * np.sign(z) + v) * np.abs(z) ** 2.5


def viscous_friction(v, z):
    return v - 0.4 * np.abs(v) * z - 0.3 * np.tanh(2 * v) * z * z


@pytest.mark.parametrize(
    ("law", "function"),
    [
        (V - sympy.Rational(1, 5) * Z**3, creep),
        (sympy.tanh(V) * (1 - sympy.Abs(Z)) - Z / 10, saturating),
        (V - 0.4 * sympy.Abs(V) * Z - 0.3 * sympy.tanh(2 * V) * Z**2, viscous_friction),
        (V - 0.5 * (sympy.Abs(V) * sympy.sign(Z) + V) * sympy.Abs(Z) ** 2.5, fractional),
    ],
    ids=["creep", "saturating", "viscous friction", "power 2.5"],
)
@pytest.mark.parametrize("latent", [(1.0, 0.5, 0.3), (2.0, 1.2, -0.4), (0.6, 0.9, 0.7)])
def test_law_is_regressed_under_the_gaussian_density(law, function, latent):
    sv, sz, r = latent
    by_v = gaussian_average(lambda v, z: (v - function(v, z)) * v, *latent)
    by_z = gaussian_average(lambda v, z: (v - function(v, z)) * z, *latent)
    expected = cases.regressed((by_v, by_z), sv * sv, sz * sz, r * sv * sz)
    found = compiled(law).gaussian(np.array(latent)[:, None], np.empty((0, 1))).coefficients[:, 0]
    np.testing.assert_allclose(
        found, expected, rtol=1e-9, atol=1e-10
    )  # ACCURACY of the law's own check


@pytest.mark.parametrize(
    ("law", "error", "message"),
    [
        (V - Z**2, ValueError, "differs with the direction"),
        (V * (1 - Z), ValueError, "differs with the direction"),
        (V - sympy.Symbol("beta") * Z, ValueError, "beta"),
        (sympy.sin(Z), ValueError, "allowed: 'v', 'z'"),
        (sympy.Integer(0), ValueError, "allowed: 'v', 'z'"),
        (V / Z, ValueError, "where all states are 0"),
        (V - V * abs(Z) ** -0.5, ValueError, "not real and finite"),
        (V - sympy.sqrt(Z), ValueError, r"not real.* take powers of Abs\(z\)"),
        ("v - z", TypeError, "sympy expression"),
        pytest.param(lambda v, z: v - z, TypeError, "sympy expression", id="a function"),
    ],
    ids=str,
)
def test_unusable_law_is_refused_with_a_reason(law, error, message):
    with pytest.raises(error, match=message):
        sl.Hysteretic(period=1.0, damping=0.05, hardening=0.1, reduction_factor=2, law=law)


HIDDEN = sympy.Heaviside(-V - Z - 1) - sympy.Heaviside(V + Z - 1)
LIMITED = V * sympy.Max(abs(Z) - 0.7, 0)


@pytest.mark.parametrize(
    ("law", "cause"),
    [
        (V + HIDDEN, "have the error"),
        (V - LIMITED - 0.1 * HIDDEN, "have the error"),
        (V - V * abs(Z) ** 0.1, "allowed 1e-09; write kinks"),
        (2 * V - V * sympy.exp(Z**4), "error inf, allowed 1e-09"),
    ],
    ids=str,
)
def test_linearization_refuses_a_law_whose_expectations_are_not_accurate(law, cause):
    one = sl.Hysteretic(1.0, 0.05, 0.1, yield_displacement=0.1, mass=1e5, law=law)
    for linearizing in (sl.linearize, lambda one, ground: sl.linearize_system([one], ground)):
        with pytest.raises(ArithmeticError, match=f"cannot be linearized.*{cause}.*use simulation"):
            linearizing(one, GROUND)
