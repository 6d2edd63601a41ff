"""Pounding in many motions: each as it is alone, the table counts them, one spoils no other."""

from typing import Any

import numpy as np
import pytest
import scipy.stats
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

SOFT = sl.Bilinear(1.2, 0.05, 0.05, yield_displacement=0.05, mass=2e5)
STIFF = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02, mass=3e5)
TOWER = sl.ShearBuilding(
    [2e5] * 3, [2e8, 1.6e8, 1e8], [3.5] * 3, 0.05, hardening=0.05, yield_drifts=0.008
)
ANNEX = sl.ShearBuilding(
    [2e5] * 2, [4e8, 3e8], [4.2, 3.0], 0.05, hardening=0.05, yield_drifts=0.006
)
BUMPER = sl.Kelvin(1e8, restitution=0.65)
GROUND = sl.named_ground("firm", intensity=0.01)
QUAKE: dict[str, Any] = {"duration": 8.0, "envelope": sl.AminAng(1.0, 5.0, 0.5)}
ONE_ONLY = {"energy_balance_error", "gap"}
CASES: dict[str, tuple[list[Any], Any, Any, dict[str, Any]]] = {
    "oscillators": ([SOFT, STIFF], 0.08, BUMPER, {}),
    "a law over the approach": ([SOFT, STIFF], 0.08, sl.HertzDamp(1e9, restitution=0.65), {}),
    "blows in a row": ([SOFT, STIFF, SOFT], [0.05, 0.02], sl.Stereomechanical(0.5), {}),
    "columns, and a link": (
        [TOWER, ANNEX, STIFF],
        [0.01, 0.03],
        BUMPER,
        {"link": [sl.Link(1e6, floors=(2, 1)), None]},
    ),
}


def motions(paths: int = 24, seed: int = 0, **other: Any) -> xr.DataArray:
    return sl.simulated_motions(GROUND, **QUAKE, paths=paths, seed=seed, **other)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_each_motion_is_what_it_is_alone_to_the_bit(case: str) -> None:
    structures, gaps, contact, options = CASES[case]
    shaking = motions(4)
    longer = {"a": shaking[2], "b": sl.simulated_motions(GROUND, 5.0, paths=2, step=0.02)[1]}
    for many, over, each in (
        (shaking, "path", list(shaking)),
        (shaking.transpose("time", "path"), "path", list(shaking)),
        (longer, "record", list(longer.values())),
    ):
        table = sl.pound(structures, gaps, contact, many, **options)
        assert table.sizes[over] == len(each)
        assert "time" not in table.dims
        for number, motion in enumerate(each):
            alone = sl.pound(structures, gaps, contact, motion, **options)
            shared = {name for name in table.data_vars if name in alone} - ONE_ONLY
            assert {"impacts", "hardest_force", "peak", "peak_acceleration_alone"} < shared
            for name in shared:
                one = table[name].isel({over: number})
                assert one.dims == alone[name].dims
                np.testing.assert_array_equal(one.values, alone[name].values, err_msg=str(name))
            worst = float(table.energy_balance_error[number])
            assert (
                worst
                == float(alone.energy_balance_error.max())
                < (1e-3 if "blows" in case else 1e-6)
            )


def test_summaries_are_those_of_the_impacts() -> None:
    shaking = motions()
    table = sl.pound([SOFT, STIFF], 0.08, BUMPER, shaking)
    for number, motion in enumerate(shaking[:6]):
        alone = sl.pound([SOFT, STIFF], 0.08, BUMPER, motion)
        one = table.isel(path=number, contact=0)
        assert int(one.impacts) == alone.sizes["impact"]
        if alone.sizes["impact"]:
            assert float(one.hardest_force) == float(alone.largest_force.max())
            assert float(one.longest_impact) == float(alone.impact_duration.max())
            assert float(one.contact_energy) == pytest.approx(float(alone.contact_lost_energy[-1]))
        else:
            assert float(one.hardest_force) == float(one.longest_impact) == 0
        given = alone.energy_transferred.sum("impact").values
        np.testing.assert_allclose(one.energy_received, given)


# --- Against the simulations that know no contact
# ---------------------------------------------------


@pytest.mark.parametrize(
    "pair",
    [
        pytest.param((SOFT, STIFF), id="oscillators"),
        pytest.param((TOWER, ANNEX), id="storeys", marks=pytest.mark.slow),
    ],
)
def test_they_meet_in_the_motions_whose_separation_exceeds_the_gap(pair: tuple[Any, Any]) -> None:
    """Those step otherwise: paths within their error of the gap may be either."""
    simulated = sl.simulate(pair, GROUND, **QUAKE, paths=32, seed=3)
    apart = simulated.separation[:, 0, 1]
    shaking = motions(32, seed=3, step=simulated.attrs["step_s"])
    gap = float(apart.median())
    table = sl.pound(pair, gap, BUMPER, shaking)
    hit = (table.impacts_between > 0).isel(neighbours=0).values
    near = np.abs(apart.values / gap - 1) < 0.02
    assert near.sum() <= 4
    np.testing.assert_array_equal(hit[~near], (apart.values > gap)[~near])
    exceeded = sl.exceedance(apart, gap)
    assert abs(float(table.pounding_probability[0] - exceeded.probability)) <= near.sum() / 32
    exact = sl.recorded_gap(*pair, list(shaking)).separation.values
    clear = np.abs(exact / gap - 1) > 2e-4
    np.testing.assert_array_equal(hit[clear], (exact > gap)[clear])
    course = sl.pounding_probability(*pair, GROUND, gap, **QUAKE, paths=32, seed=3)
    confidence = float(course.confidence_of_no_pounding_simulated)
    assert abs(float(table.no_pounding_probability[0]) - confidence) <= near.sum() / 32


# --- Statistics
# -------------------------------------------------------------------------------------


def test_velocities_that_jump_say_nothing_of_forces() -> None:
    table = sl.pound([SOFT, STIFF], 0.05, sl.Stereomechanical(0.6), motions(8))
    assert float(table.impacts.sum()) > 0
    assert table.hardest_force_quantile.isnull().all()
    assert table.impacts_quantile.notnull().all()


def test_few_motions_bound_nothing() -> None:
    two = motions(2)
    assert np.isinf(sl.pound([SOFT, STIFF], 0.1, BUMPER, two).peak_quantile_upper).all()
    alone = sl.pound([SOFT, STIFF], 0.1, BUMPER, [two[0]])
    assert np.isnan(alone.peak_mean_standard_error).all()
    assert np.isfinite(alone.peak_mean).all()


def test_means_quantiles_and_shares_are_those_of_the_motions() -> None:
    table = sl.pound([SOFT, STIFF], 0.1, BUMPER, motions(40), quantiles=[0.5, 0.9])
    hits = table.impacts[:, 0].values
    assert 0 < (hits > 0).sum() < 40
    interval = scipy.stats.binomtest(int((hits > 0).sum()), 40).proportion_ci(0.95, "exact")
    assert float(table.pounding_probability[0]) == (hits > 0).mean()
    assert float(table.pounding_probability_lower[0]) == pytest.approx(interval.low)
    assert float(table.no_pounding_probability_lower[0]) == pytest.approx(1 - interval.high)
    force = table.hardest_force[:, 0].values
    assert (force[hits == 0] == 0).all()
    samples = {"hardest_force": force, "hardest_force_between": force, "impacts": hits}
    samples["peak_acceleration"] = table.peak_acceleration[:, 0].values
    for name, each in samples.items():
        found = {end: table[f"{name}_{end}"][..., 0].values for end in ("mean", "quantile")}
        np.testing.assert_allclose(found["mean"], each.mean())
        np.testing.assert_allclose(found["quantile"], np.quantile(each, [0.5, 0.9]))
        error = float(table[f"{name}_mean_standard_error"][0])
        assert error == pytest.approx(each.std(ddof=1) / np.sqrt(40))
        low, high = (float(table[f"{name}_quantile_{end}"][0, 0]) for end in ("lower", "upper"))
        ordered = np.sort(each)  # binomial order statistics of 40 for the median: 14 and 27
        assert (low, high) == (ordered[13], ordered[26])
    for name, variable in table.variables.items():
        assert "long_name" in variable.attrs, name
        assert (
            name in ("status", "missing", "neighbours", *table.coords) or "units" in variable.attrs
        )


# --- What fails
# -------------------------------------------------------------------------------------

WEAK = sl.ShearBuilding(
    [2e5] * 2, [2e7, 2e7], [3.0] * 2, 0.05, hardening=0.001, yield_drifts=0.01, p_delta=True
)


def test_a_motion_that_fails_is_named_and_spoils_no_other() -> None:
    shaking = motions(6)
    factors = xr.DataArray([0.2, 0.2, 8.0, 0.2, 0.2, 0.2], dims="path")
    strong = (factors * shaking).transpose("path", "time").assign_attrs(shaking.attrs)
    table = sl.pound([WEAK, STIFF], 0.02, BUMPER, strong)
    assert table.status.values.tolist() == [0, 0, 2, 0, 0, 0]
    assert "structure 1 falls over" in str(table.missing[2].item())
    assert [str(text) for text in np.delete(table.missing.values, 2)] == [""] * 5
    assert table.isel(path=2).impacts.isnull().all()
    rest = np.delete(np.arange(6), 2)
    others = sl.pound([WEAK, STIFF], 0.02, BUMPER, strong[rest])
    for name in table.data_vars:
        kept = table[name].isel(path=rest) if "path" in table[name].dims else table[name]
        np.testing.assert_array_equal(kept, others[name], err_msg=str(name))
    with pytest.raises(ArithmeticError, match=r"falls over.*; so in all 2 motions"):
        sl.pound([WEAK, STIFF], 0.02, BUMPER, strong[[2, 2]])


def test_what_would_take_too_long_is_refused_before_the_work() -> None:
    stubby = sl.Bilinear(1e-6, 0.05, mass=1e5)
    with pytest.raises(
        ValueError, match=r"30 motions, 240 s of motion, .* fewer and shorter motions"
    ):
        sl.pound([SOFT, stubby], 0.05, BUMPER, motions(30))
