"""Contacts against their laws written out, against mpmath, and on the way there and back."""

import hypothesis.strategies as st
import mpmath
import numpy as np
import pytest
import xarray as xr
from hypothesis import given

import stochlin as sl
from stochlin.kernels.simulation import contacts as kernel

pytestmark = pytest.mark.oracle

KELVINS = [sl.Kelvin, sl.NoTensionKelvin, sl.ImpactKelvin]


# --- The compiled force ---------------------------------------------------------------------------


MASS, V0, K, N, XI = 2e4, 0.7, 3e6, 1.7, 0.4
C = 2 * XI * np.sqrt(K * MASS)
FORCES = [
    (sl.LinearSpring(K), lambda d, v: K * d),
    (sl.Kelvin(K, damping_ratio=XI), lambda d, v: K * d + C * v),
    (sl.NoTensionKelvin(K, damping_ratio=XI), lambda d, v: max(K * d + C * v, 0.0)),
    (sl.ImpactKelvin(K, damping_ratio=XI), lambda d, v: K * d + C * max(v, 0.0)),
    (sl.Hertz(K, exponent=N), lambda d, v: K * d**N),
    (sl.HertzDamp(K, damping_factor=XI, exponent=N), lambda d, v: K * d**N * (1 + XI * v / V0)),
    (
        sl.Jankowski(K, damping_ratio=XI),
        lambda d, v: K * d**1.5 + 2 * XI * np.sqrt(K * np.sqrt(d) * MASS) * max(v, 0.0),
    ),
]


@pytest.mark.parametrize(("contact", "law"), FORCES, ids=[type(one).__name__ for one, _ in FORCES])
def test_compiled_force_is_the_law(contact, law):
    compiled = contact.force_law(MASS)
    for d in (1e-6, 0.003, 0.2):
        for v in (-0.9, -0.01, 0.0, 0.3):
            found = kernel.force(compiled, d, v, V0)
            assert found == pytest.approx(law(d, v), rel=1e-13)
            leaves = d + C / K * v if isinstance(contact, sl.NoTensionKelvin) else d
            assert kernel.separation_margin(compiled, d, v) == pytest.approx(leaves, rel=1e-13)
        assert kernel.force(compiled, -d, 0.3, V0) == 0


def test_a_part_of_a_table_of_contacts_has_the_dimensions_that_are_left():
    contact = sl.Kelvin(xr.DataArray([1e6, 2e6], dims="k"), damping_ratio=[0.1, 0.2, -1.0])
    part = contact.isel({"case": slice(1, 2), "other": slice(1)})
    np.testing.assert_array_equal(part.damping, [0.2])
    assert part.stiffness.sizes == {"k": 2}


# --- Closed forms against more digits -------------------------------------------------------------

NEAR_ONE = [1 + sign * 10.0**-p for p in range(1, 17) for sign in (-1, 1)]
WIDE = [*np.geomspace(1e-15, 1e15, 61), *NEAR_ONE, 1.0]


def angle_ratio(xi):
    x = mpmath.mpf(xi)
    if x == 1:
        return mpmath.mpf(1)
    return mpmath.re(mpmath.acos(x) / mpmath.sqrt(1 - x * x))


@pytest.mark.parametrize("factor", [1, 2])
def test_restitution_to_the_last_digits(factor):
    kind = {1: sl.ImpactKelvin, 2: sl.NoTensionKelvin}[factor]
    with mpmath.workdps(60):
        for xi in WIDE:
            ratio = angle_ratio(xi)
            e = float(mpmath.exp(-factor * mpmath.mpf(xi) * ratio))
            # exp(-y) of a rounded y; y is below 80 here
            assert kind.restitution(xi) == pytest.approx(e, rel=5e-14)


ACROSS = [1 - 10.0**-p for p in range(1, 16)] + [0.1, 0.3, 0.5, 0.53, 0.56, 0.6, 0.77]


def test_hertz_damp_to_the_last_digits():
    # Lambert's W solves the energy balance for e, in another way. The error of a, relative, shows
    # in e as a part of 1 - e, since a is about 1.5 (1 - e) near 1.
    with mpmath.workdps(80):
        for e in ACROSS:
            a = mpmath.mpf(sl.HertzDamp.damping_factor(e))
            exact = (1 + mpmath.re(mpmath.lambertw(-(1 + a) * mpmath.exp(-(1 + a))))) / a
            balance = a * (1 + exact) - mpmath.log((1 + a) / (1 - a * exact))
            assert abs(balance) < mpmath.mpf(10) ** -60
            assert abs(exact - mpmath.mpf(e)) < 1e-14 * (1 - e)
            assert sl.HertzDamp.restitution(float(a)) == pytest.approx(float(exact), rel=4e-16)


# --- There and back -------------------------------------------------------------------------------

E = st.floats(1e-12, 1) | st.floats(0.999, 1)
RATIO = st.floats(0, 0.9) | st.floats(0, 50) | st.floats(0.999, 1.001)
DAMPED = [*KELVINS, sl.Jankowski]


@pytest.mark.parametrize("kind", DAMPED)
@given(E)
def test_restitution_of_its_damping_ratio(kind, e):
    ratio = kind.damping_ratio(e)
    assert ratio >= 0
    assert kind.restitution(ratio) == pytest.approx(e, abs=1e-12, rel=0)
    assert kind(1e8, restitution=e).damping == ratio
    assert kind(1e8, restitution=e).e == pytest.approx(e, abs=1e-12, rel=0)


@pytest.mark.parametrize("kind", DAMPED)
@given(RATIO)
def test_damping_ratio_of_its_restitution(kind, xi):
    e = kind.restitution(xi)
    if e > 0:  # Kelvin's inverse stays below 1
        rounding = 1e-12 * max(1.0, xi)
        assert kind.damping_ratio(e) == pytest.approx(xi, abs=rounding, rel=0)
    else:
        assert kind is sl.Kelvin
        assert xi > 0.99999


# --- How they are asked ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", [*DAMPED, sl.HertzDamp])
def test_answers_have_the_shape_of_the_question(kind):
    assert isinstance(kind.restitution(0.3), float)
    assert isinstance(kind.restitution(np.float32(0.5)), float)
    table = kind.restitution([0.1, np.nan, -1.0])
    np.testing.assert_array_equal(np.isnan(table), [False, True, True])
    given_values = xr.DataArray(
        [0, 1], dims="x", coords={"x": [3, 4]}, name="xi", attrs={"units": "-"}
    )
    found = kind.restitution(given_values)
    assert found.dims == ("x",)
    assert found.attrs == {"units": "1"}
    np.testing.assert_array_equal(found.x, [3, 4])


@pytest.mark.parametrize("kind", DAMPED)
@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({}, ValueError, "neither is given; allowed: exactly one"),
        ({"damping_ratio": 0.1, "restitution": 0.5}, ValueError, "both are given"),
        (
            {"damping_ratio": -0.1},
            ValueError,
            "damping_ratio = -0.1 is out of range; allowed: 0 <=",
        ),
        (
            {"restitution": 0},
            ValueError,
            "restitution = 0 is out of range; allowed: 0 < value <= 1",
        ),
        ({"restitution": 0.5, "stiffness": -1}, ValueError, "stiffness = -1 is out of range"),
    ],
)
def test_elements_out_of_range_are_refused_by_their_names(kind, arguments, error, message):
    with pytest.raises(error, match=f"^{kind.__name__}: .*{message}"):
        kind(**({"stiffness": 1e8} | arguments))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: sl.Kelvin.restitution(-1), "Kelvin: damping_ratio = -1 is out of range"),
        (lambda: sl.HertzDamp(1.0), "HertzDamp: of damping_factor and restitution neither"),
        (lambda: sl.HertzDamp(1.0, restitution=0.5, exponent=0.9), "exponent = 0.9 is out"),
        (lambda: sl.Stereomechanical(1.5), "restitution = 1.5 is out of range"),
    ],
)
def test_questions_out_of_range_are_refused_with_what_is_allowed(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_cells_out_of_range_do_not_spoil_their_neighbours():
    contact = sl.ImpactKelvin(1e8, restitution=[0.5, 2.0, 0.65])
    np.testing.assert_array_equal(contact.valid(), [True, False, True])
    np.testing.assert_allclose(contact.e, [0.5, np.nan, 0.65], rtol=1e-14)
    assert np.isfinite(contact.force_law(1e4).damping).values.tolist() == [True, False, True]
    for kind in (sl.Kelvin, sl.HertzDamp, sl.Jankowski):
        np.testing.assert_array_equal(kind([1e8, -1.0], restitution=0.5).valid(), [True, False])
