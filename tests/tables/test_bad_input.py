"""A wrong number is named, with its value and what is allowed; in a table it spoils its cell only."""

import cases
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
FAILED = 2  # the first status that is a failure


OPTIONAL = {"hardening", "reduction_factor"}  # to be left out together
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


@parameters(but=OPTIONAL)
def test_none_is_refused_where_a_number_is_needed(model, values, name):
    with pytest.raises((TypeError, ValueError), match=rf"{model.__name__}: {name} = None"):
        model(**values | {name: None})


@every_parameter
def test_plain_array_has_one_dimension_and_is_not_empty(model, values, name):
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is .*2 dimensions; allowed: "):
        model(**values | {name: np.full((2, 2), values[name])})
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is empty; allowed: "):
        model(**values | {name: np.array([])})
    with pytest.raises(ValueError, match=rf"{model.__name__}: {name} is empty; allowed: "):
        model(**values | {name: xr.DataArray(np.empty(0), dims="x")})


def test_ragged_list_is_refused_by_name():
    with pytest.raises((TypeError, ValueError), match="Bilinear: period"):
        sl.Bilinear(**STRUCTURE | {"period": [[1.0], [1.0, 2.0]]})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"damping": 5}, r"damping = 5 .*a ratio, 0\.05 for 5 %"),
        ({"damping": 1}, r"damping = 1 .*value < 1"),
        ({"hardening": -1}, "hardening = -1 .*a stationary response needs more than 0"),
        ({"hardening": 1.2}, "hardening = 1.2 .*value <= 1"),
        ({"hardening": None}, "hardening is not given"),
        ({"yield_displacement": 0.1}, "yield_displacement and reduction_factor are both given"),
        ({"peak_factor": 0}, "peak_factor = 0"),
    ],
    ids=str,
)
def test_mistake_of_the_trade_is_explained(change, message):
    with pytest.raises(ValueError, match=message):
        sl.Bilinear(**STRUCTURE | change)


def test_undamped_ground_is_refused_with_the_reason():
    with pytest.raises(ValueError, match=r"KanaiTajimi: damping = 0 .*no stationary motion"):
        sl.KanaiTajimi(period=1.0, damping=0)


def test_white_noise_formula_checks_its_arguments():
    with pytest.raises(ValueError, match=r"damping_1 = 5 .*a ratio"):
        sl.rho_white_noise(1.0, 1.0, 5, 0.05)
    with pytest.raises(ValueError, match="period_2 = -1 "):
        sl.rho_white_noise(1.0, -1, 0.05, 0.05)
    with pytest.raises((TypeError, ValueError), match="period_1"):
        sl.rho_white_noise(None, 1.0, 0.05, 0.05)


def test_unknown_names_are_answered_with_the_known_ones():
    structure = sl.Bilinear(**STRUCTURE)
    with pytest.raises(ValueError, match=r"closure = 'linear' .*gaussian, clipped, drift"):
        sl.linearize(structure, SOIL, "linear")
    with pytest.raises(ValueError, match=r"closure = 'clipped' .*BoucWen; allowed: gaussian"):
        sl.linearize(sl.BoucWen(**STRUCTURE), SOIL, "clipped")
    with pytest.raises(ValueError, match=r"method = 'guess' .*linearization, .*white_noise"):
        sl.correlate(structure, structure, SOIL, method="guess")


def test_closure_none_is_not_a_silent_switch_to_elastic():
    with pytest.raises((TypeError, ValueError), match="closure = None"):
        sl.linearize(sl.Bilinear(**STRUCTURE), SOIL, None)


def test_structure_and_ground_in_each_others_place():
    structure = sl.Bilinear(**STRUCTURE)
    for function, arguments in (
        (sl.linearize, (SOIL, structure)),
        (sl.correlate, (structure, SOIL, structure)),
        (sl.linearize, (structure, "rock")),
        (sl.amplification, (structure, None)),
    ):
        with pytest.raises(TypeError, match=r"(structure|first|second|ground) = .*allowed"):
            function(*arguments)


@pytest.mark.parametrize(
    ("setting", "value"),
    [
        ("rtol", -1.0),
        ("rtol", np.nan),
        ("rtol", "fine"),
        ("atol", -1.0),
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


BAD_CELLS = [
    ("period", -1.0),
    ("period", 0.0),
    ("period", np.nan),
    ("damping", 5.0),
    ("damping", np.inf),
    ("hardening", 0.0),
    ("hardening", 1.2),
    ("reduction_factor", -2.0),
    ("peak_factor", 0.0),
]


@pytest.mark.parametrize("closure", ["gaussian", "clipped"])
@pytest.mark.parametrize(("name", "value"), BAD_CELLS)
def test_bad_cell_fails_alone(closure, name, value):
    """The neighbours are the same to the last bit as in a table that never had it."""
    rng = np.random.default_rng(80)
    good = cases.draw_structure(rng, cases.PRACTICE, 9) | {"peak_factor": np.full(9, 3.0)}
    bad = {key: array.copy() for key, array in good.items()}
    bad[name][4] = value
    without = {key: np.delete(array, 4) for key, array in good.items()}
    table, clean = (sl.linearize(sl.Bilinear(**v), SOIL, closure) for v in (bad, without))
    assert table.status.attrs["flag_meanings"].split()[int(table.status[4])] == "invalid_input"
    for variable in set(table.data_vars) - {"status", "iterations"}:
        assert np.isnan(table[variable][4]) or variable == "caution"
        np.testing.assert_array_equal(np.delete(table[variable], 4), clean[variable])
    assert table.caution.attrs["flag_meanings"].split()[int(table.caution[4])] == "outside_of_the_map"
    np.testing.assert_array_equal(np.delete(table.status, 4), clean.status)


@pytest.mark.parametrize(
    "ground",
    [{"period": [1.0, -1.0, 2.0]}, {"damping": [0.3, 0.0, 0.2]}, {"intensity": [1.0, np.nan, 3]}],
    ids=str,
)
def test_bad_ground_cell_fails_alone(ground):
    structure = sl.Bilinear(**STRUCTURE)
    table = sl.linearize(structure, sl.KanaiTajimi(**GROUND | ground))
    assert np.isnan(table.displacement_std).values.tolist() == [False, True, False]
    assert (table.status >= FAILED).values.tolist() == [False, True, False]


def test_bad_cell_of_a_pair_blanks_its_row_and_nothing_else():
    rows = xr.DataArray([0.5, -1.0, 2.0], dims="row")
    columns = xr.DataArray([0.7, 1.0], dims="column")
    second = sl.Bilinear(columns, 0.05, 0.1, reduction_factor=2)
    table = sl.correlate(sl.Bilinear(rows, 0.05, 0.1, reduction_factor=2), second, SOIL)
    clean = sl.correlate(sl.Bilinear(rows[[0, 2]], 0.05, 0.1, reduction_factor=2), second, SOIL)
    assert np.isnan(table.rho.isel(row=1)).all()
    assert (table.status.isel(row=1) >= FAILED).all()
    np.testing.assert_array_equal(table.rho.isel(row=[0, 2]), clean.rho)
    assert not np.isnan(table.displacement_std_2).any()


def test_bad_cell_of_the_white_noise_formula():
    table = sl.rho_white_noise([1.0, -2.0, 3.0], 1.0, 0.05, [0.05, 0.05, 5.0])
    assert np.isnan(table.rho).values.tolist() == [False, True, True]
    assert table.status.values.tolist() == [0, 3, 3]
    assert float(table.rho[0]) == pytest.approx(1)


def test_table_without_a_valid_cell_still_answers():
    table = sl.linearize(sl.Bilinear([-1.0, np.nan], 0.05, 0.1, reduction_factor=2), SOIL)
    assert np.isnan(table.displacement_std).all()
    assert (table.status >= FAILED).all()


@pytest.mark.parametrize("closure", ["gaussian", "clipped"])
def test_lone_case_that_does_not_converge_raises_with_the_cure(closure):
    structure = sl.Bilinear(**STRUCTURE)
    with pytest.raises(
        ArithmeticError, match=r"Bilinear\(period=1.*not converged; raise max_iterations"
    ):
        sl.linearize(structure, SOIL, closure, max_iterations=1)
    with pytest.raises(ArithmeticError, match="not converged; raise max_iterations"):
        sl.correlate(structure, structure, SOIL, closure=closure, max_iterations=1)


def test_cell_that_does_not_converge_is_nan_with_its_status():
    structure = sl.Bilinear(**STRUCTURE | {"reduction_factor": [0.05, 3.0]})
    table = sl.linearize(structure, SOIL, max_iterations=1)
    meanings = table.status.attrs["flag_meanings"].split()
    assert meanings[int(table.status[1])] == "not_converged"
    assert np.isnan(table.displacement_std[1])
    assert np.isnan(table.k_eq[1])


def test_models_cannot_be_changed_behind_the_checks():
    structure = sl.Bilinear(**STRUCTURE)
    with pytest.raises(AttributeError):
        structure.damping = 5.0
