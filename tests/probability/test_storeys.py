"""Probability of pounding of buildings with storeys: the formula, at all heights at once."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from cases import covariances_in_time

import stochlin as sl

pytestmark = pytest.mark.oracle

BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6, intensity=0.01)
QUAKE = {"envelope": sl.AminAng(1.0, 3.0, 0.5), "duration": 4.0}
TALL = sl.ShearBuilding(
    [2e5, 2e5, 2e5, 1.5e5],
    [1.1e8, 0.9e8, 0.8e8, 0.5e8],
    [4.0, 3.0, 3.0, 3.0],
    damping=0.05,
    hardening=0.05,
    yield_drifts=[0.010, 0.010, 0.009, 0.008],
)
LOW = sl.ShearBuilding(
    [1.5e5] * 2, [1.2e8, 0.9e8], [3.2] * 2, 0.03, 0.1, yield_drifts=0.006, dampers=[5e5, 0.0]
)


def elastic(building):
    return replace(building, hardening=None, yield_drifts=None)


def probability(*args, **changes):
    return sl.pounding_probability(*args, **({"paths": 0} | QUAKE | changes))


def one_storey(oscillator, **law):
    """The same as a building."""
    stiffness = 1e5 * (2 * np.pi / oscillator.period) ** 2
    strength = {"yield_drifts": oscillator.yield_displacement} if oscillator.yields else {}
    return sl.ShearBuilding(
        [1e5], [stiffness], [9.0], oscillator.damping, oscillator.hardening, **strength, **law
    )


# --- One storey is an oscillator ------------------------------------------------------------------


def test_one_storey_is_the_oscillator():
    pair = (
        sl.BoucWen(0.6, 0.05, 0.1, yield_displacement=0.02, beta=0.6, gamma=0.4),
        sl.Bilinear(1.0, 0.03, 0.1, yield_displacement=0.03),
    )
    expected = probability(*pair, BROAD, 0.1)
    one = one_storey(pair[0], law="bouc_wen", law_parameters={"beta": 0.6, "gamma": 0.4})
    for building in ((one, one_storey(pair[1])), (one, pair[1])):
        found = probability(*building, BROAD, 0.1)
        least = found.confidence_of_no_pounding_at_least  # of one height
        np.testing.assert_allclose(least, found.confidence_of_no_pounding, rtol=0, atol=1e-15)
        for column in (
            *("confidence_of_no_pounding", "confidence_of_no_pounding_poisson", "required_gap"),
            *("displacement_std_1", "displacement_std_2", "difference_std", "rho"),
        ):
            size = 1.0 if column == "required_gap" else float(abs(expected[column]).max())
            np.testing.assert_allclose(
                found[column], expected[column], rtol=0, atol=1e-9 * size, err_msg=column
            )


# --- Moments --------------------------------------------------------------------------------------


def seen(table, state, floors):
    """Row of the states that gives a sum of displacements."""
    row = np.zeros(table.sizes["state"])
    for name, share in floors.items():
        row[table.state.values.tolist().index(f"{state}_{name}")] = share
    return row


@pytest.mark.slow
@pytest.mark.parametrize("ground", [sl.WhiteNoise(0.01), BROAD], ids=["white", "broad band"])
def test_linear_moments_are_those_of_the_lyapunov_differential_equation(ground):
    """P' = A P + P A' + Q of the matrix that `statespace` writes, integrated by itself."""
    pair = replace(elastic(TALL), p_delta=True), elastic(LOW)
    found = probability(*pair, ground, 0.1, points=8)
    space = sl.statespace(pair, ground)
    p = covariances_in_time(space, QUAKE["envelope"], found.time.values, (1.0, 3.0, 4.0))
    share = (6.4 - 4.0) / 3.0  # of the second floor of TALL at the roof of LOW
    places = {
        3.2: ({"1.1": 0.8}, {"2.1": 1.0}),
        4.0: ({"1.1": 1.0}, {"2.1": 0.75, "2.2": 0.25}),
        6.4: ({"1.1": 1 - share, "1.2": share}, {"2.2": 1.0}),
    }
    assert found.height.values.tolist() == pytest.approx(list(places))
    for number, (one, two) in enumerate(places.values()):
        u_1, u_2 = seen(space, "u", one), seen(space, "u", two)
        apart = u_1 - u_2
        std_1, std_2, both = (np.sqrt(np.einsum("i,tij,j->t", r, p, r)) for r in (u_1, u_2, apart))
        atol = 1e-5 * both.max()
        here = found.isel(height=number)
        np.testing.assert_allclose(here.difference_std_at_height, both, rtol=0, atol=atol)
        rho = np.einsum("i,tij,j->t", u_1, p, u_2)[1:] / (std_1 * std_2)[1:]
        np.testing.assert_allclose(here.rho_at_height[1:], rho, rtol=0, atol=1e-5)
    np.testing.assert_allclose(found.displacement_std_1, std_1, rtol=0, atol=atol)
    np.testing.assert_allclose(found.difference_std, both, rtol=0, atol=atol)


@pytest.mark.slow
def test_storeys_that_yield_come_to_rest_at_the_stationary_linearization():
    pair = replace(TALL, heights=[3.2] * 4, hardening=0.3), replace(LOW, hardening=0.3)
    strong = replace(BROAD, intensity=0.03)
    table = probability(*pair, strong, 0.1, envelope=None, duration=40.0, points=3).isel(time=-1)
    still = sl.linearize_system(pair, strong)
    assert float(still.ductility_std.min()) > 0.7
    for number, here in enumerate((table.isel(height=0), table.isel(height=1)), start=1):
        floors = {"floor": f"1.{number}", "floor_2": f"2.{number}"}
        both, rho = (
            float(still[name].sel(floors)) for name in ("relative_displacement_std", "rho")
        )
        assert float(here.difference_std_at_height) == pytest.approx(both, rel=1e-4)
        assert float(here.rho_at_height) == pytest.approx(rho, abs=1e-4)


# --- All heights at once --------------------------------------------------------------------------


def test_bounds_of_all_heights_and_their_order():
    gaps = xr.DataArray([0.01, 0.03, 0.06, 0.1, 1.0], dims="gap")
    table = probability(TALL, LOW, BROAD, gaps)
    by_height = table.confidence_of_no_pounding_at_height
    np.testing.assert_array_equal(table.confidence_of_no_pounding, by_height.min("height"))
    least = table.confidence_of_no_pounding_at_least
    assert bool((least <= table.confidence_of_no_pounding).all())
    assert bool((least >= 0).all())
    np.testing.assert_allclose(least[..., -1], 1.0, atol=1e-12)
    assert float(table.required_gap) == float(table.required_gap_at_height.max())
    governing = table.required_gap_at_height.sel(height=table.governing_height)
    assert float(governing) == float(table.required_gap)
    assert bool((table.confidence_of_no_pounding.diff("gap") >= 0).all())
    for name, variable in table.variables.items():
        assert variable.attrs.get("long_name") or name in ("gap", "status"), name


def test_the_formula_knows_what_the_weight_takes():
    """It eats the hardening of a storey: no stationary answer, but one for a motion that ends."""
    soft = sl.ShearBuilding([4e5] * 2, [4e7] * 2, [3.0] * 2, 0.05, 0.05, yield_drifts=0.02)
    with pytest.raises(ValueError, match="has no stationary value"):
        sl.linearize_system([replace(soft, p_delta=True)], BROAD)
    leaning = probability(replace(soft, p_delta=True), LOW, BROAD, 0.2)
    upright = probability(soft, LOW, BROAD, 0.2)
    for table in (leaning, upright):
        assert bool(table.confidence_of_no_pounding.notnull().all())
    assert float(leaning.displacement_std_1[-1]) > float(upright.displacement_std_1[-1])


@pytest.mark.extreme
def test_gap_and_structure_may_share_a_dimension():
    periods, gaps = (xr.DataArray(values, dims="case") for values in ([0.4, 0.6], [0.05, 0.08]))
    options = {"points": 3, "duration": 2.5, "paths": 64}
    table = probability(TALL, sl.Bilinear(periods, 0.05), BROAD, gaps, **options)
    assert table.confidence_of_no_pounding_simulated.dims == ("case",)
    alone = probability(TALL, sl.Bilinear(0.6, 0.05), BROAD, 0.08, **options)
    for name in ("confidence_of_no_pounding_simulated", "required_gap_simulated"):
        np.testing.assert_array_equal(table[name].isel(case=1), alone[name])
