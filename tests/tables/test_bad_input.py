"""A wrong number is named, with its value and what is allowed; in a table it spoils its cell only."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

STRUCTURE = {"period": 1.0, "damping": 0.05, "hardening": 0.1, "reduction_factor": 3.0}
GROUND = {"period": 1.0, "damping": 0.3, "intensity": 1.0}
HIGH_PASS = {"high_pass_period": 5.0, "high_pass_damping": 0.6}
MODELS = [
    (sl.Bilinear, STRUCTURE),
    (sl.BoucWen, STRUCTURE | {"beta": 0.5, "gamma": 0.5, "exponent": 1.0}),
    (sl.WhiteNoise, {"intensity": 1.0}),
    (sl.KanaiTajimi, GROUND),
    (sl.CloughPenzien, GROUND | HIGH_PASS),
]
PARAMETERS = [(model, values, name) for model, values in MODELS for name in values]
SOIL = sl.KanaiTajimi(**GROUND)
ANY_SIGN = {"gamma", "hardening"}


def name_of(argument):
    return getattr(argument, "__name__", argument if isinstance(argument, str) else "")


def parameters(but=frozenset()):
    chosen = [one for one in PARAMETERS if one[2] not in but]
    return pytest.mark.parametrize(("model", "values", "name"), chosen, ids=name_of)


every_parameter = parameters()


@every_parameter
@pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
def test_number_that_is_none_is_refused_everywhere(model, values, name, number):
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} = {number:g} .*allowed: .*finite"):
        model(**values | {name: number})


@parameters(but=ANY_SIGN)
@pytest.mark.parametrize("number", [-1.0, 0.0])
def test_negative_and_zero_are_refused_where_a_positive_number_is_meant(model, values, name, number):
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} = {number:g} .*allowed: .*value"):
        model(**values | {name: number})


@every_parameter
@pytest.mark.parametrize(
    "value",
    ["1", b"1", True, 1 + 0j, ["a", "b"], [True], [1, None], {"a": 1}, np.datetime64("1985-09-19")],
)
def test_what_is_not_a_real_number_is_refused(model, values, name, value):
    with pytest.raises(TypeError, match=rf"{model.__name__}: {name} = .*not a real number; allowed: "):
        model(**values | {name: value})


@every_parameter
def test_plain_array_has_one_dimension_and_is_not_empty(model, values, name):
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is .*2 dimensions; allowed: "):
        model(**values | {name: np.full((2, 2), values[name])})
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is empty; allowed: "):
        model(**values | {name: np.array([])})
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is empty; allowed: "):
        model(**values | {name: xr.DataArray(np.empty(0), dims="x")})


MASKED = np.ma.masked_array([1, 9], [False, True])


def test_masked_numbers_are_missing_ones():
    """What stands below a mask is a bad cell, or refused as what is no number."""
    table = sl.linearize(sl.Bilinear(MASKED, 0.05), SOIL)
    assert table.status.values.tolist() == [1, 3]
    assert np.isnan(sl.ImpactKelvin(1e8, restitution=0.5 * MASKED).e).values.tolist() == [False, True]
    assert np.isnan(SOIL.psd(MASKED)).values.tolist() == [False, True]
    for call in (
        lambda: sl.HazardCurve(MASKED, [0.1, 0.01]),
        lambda: sl.ModalBuilding([0.5], [MASKED], [1e5] * 2, [3.0] * 2, 0.05),
        lambda: sl.ModalBuilding([0.5], [[0.9, 1.0]], 1e5 * MASKED, [3.0] * 2, 0.05),
        lambda: sl.Uncertain(MASKED, 0.1),
        lambda: sl.hysteresis_loop(sl.Bilinear(1.0, 0.05), MASKED),
        lambda: sl.Bilinear(np.ma.masked, 0.05),
    ):
        with pytest.raises(ValueError, match=r"nan|masked_array.*; allowed: .*finite"):
            call()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"damping": 5}, r"damping = 5 .*a ratio, 0\.05 for 5 %"),
        ({"damping": 1}, r"damping = 1 .*value < 1"),
        ({"hardening": -1}, "hardening = -1 .*a stationary response needs more than 0"),
        ({"hardening": 1.2}, "hardening = 1.2 .*value <= 1"),
        ({"hardening": None}, "hardening is not given"),
        ({"yield_displacement": 0.1}, "yield_displacement and reduction_factor; allowed: one"),
        ({"peak_factor": 0}, "peak_factor = 0"),
        ({"period": 1e-200}, "period = 1e-200 is out of range; allowed: 1e-09 <= value <= 1e"),
    ],
    ids=str,
)
def test_mistake_of_the_trade_is_explained(change, message):
    with pytest.raises(ValueError, match=message):
        sl.Bilinear(**STRUCTURE | change)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("rtol", -1.0),
        ("rtol", np.nan),
        ("rtol", "fine"),
        ("max_iterations", 0),
        ("max_iterations", -3),
        ("max_iterations", 2.5),
    ],
)
def test_stop_rule_is_checked(setting, value):
    with pytest.raises((TypeError, ValueError), match=rf"{setting} = .*allowed"):
        sl.linearize(sl.Bilinear(**STRUCTURE), SOIL, **{setting: value})


def labelled(values, labels):
    return xr.DataArray(np.array(values), dims="x", coords={"x": labels})


def test_arrays_that_do_not_fit_together_are_refused():
    with pytest.raises(ValueError, match=r"Bilinear: .*share a dimension"):
        sl.Bilinear([1.0, 2.0], [0.05, 0.05, 0.05])
    with pytest.raises(ValueError, match=r"Bilinear: .*share a dimension"):
        sl.Bilinear(labelled([1.0, 2.0], [0, 1]), labelled([0.05, 0.05], [0, 2]))
    with pytest.raises(ValueError, match="structure and ground"):
        sl.linearize(
            sl.Bilinear(labelled([1.0, 2.0], [0, 1]), 0.05),
            sl.KanaiTajimi(labelled([1.0, 2.0], [0, 2]), 0.3),
        )
    with pytest.raises(ValueError, match="structure and ground"):
        sl.linearize(sl.Bilinear([1.0, 2.0], 0.05), sl.KanaiTajimi([1.0, 2.0, 3.0], 0.3))
    for other in ([1.0, 2.0, 3.0], labelled([1.0, 2.0], [0, 2])):
        mine = [1.0, 2.0] if isinstance(other, list) else labelled([1.0, 2.0], [0, 1])
        with pytest.raises(ValueError, match="first, second and ground share a dimension"):
            sl.correlate(sl.Bilinear(mine, 0.05), sl.Bilinear(other, 0.05), SOIL)


@pytest.mark.parametrize("closure", ["gaussian", "clipped"])
def test_lone_case_that_does_not_converge_raises_with_the_cure(closure):
    structure = sl.Bilinear(**STRUCTURE)
    with pytest.raises(
        ArithmeticError, match=r"Bilinear \(period 1 s.*not converged; raise max_iterations"
    ):
        sl.linearize(structure, SOIL, closure, max_iterations=1)
    with pytest.raises(ArithmeticError, match="not converged; raise max_iterations"):
        sl.correlate(structure, structure, SOIL, closure=closure, max_iterations=1)
