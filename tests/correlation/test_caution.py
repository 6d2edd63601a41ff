"""Whether the caution of the difference of displacements protects, on pairs that were simulated."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.oracle
HARD_PAIRS = Path(__file__).with_name("hard_pairs.nc")


def difference(std_1, std_2, rho):
    return np.sqrt((std_1 - std_2) ** 2 + 2 * std_1 * std_2 * (1 - rho))


@cache
def hard_pairs():
    with HARD_PAIRS.open("rb") as stream:
        return xr.load_dataset(stream, engine="scipy").astype(float)


def models(ground, structures):
    """A hard pair and its ground, which is white noise where it has no period."""
    pair = [sl.Bilinear(*values[:3], reduction_factor=values[3]) for values in structures.tolist()]
    period, damping, *high_pass = ground.tolist()
    if np.isnan(period):
        return *pair, sl.WhiteNoise()
    if np.isnan(high_pass[0]):
        return *pair, sl.KanaiTajimi(period, damping)
    return *pair, sl.CloughPenzien(period, damping, *high_pass)


@pytest.mark.slow
@pytest.mark.extreme
@pytest.mark.parametrize("family", ["equal", "ridge", "damping", "strong"])
def test_hard_pairs_meet_another_simulation(family):
    """Other motions; four standard errors of both simulations, each of which has about the same."""
    stored = hard_pairs().sel(family=family)
    of_motions = {"paths": 64, "relaxation_times": 50.0, "steps_per_period": 16, "seed": 1000}
    for number in range(2):
        part = stored.isel(number=number)
        pair = models(part.ground.values, part.structures.values)
        table = sl.correlate(*pair, "simulation", **of_motions)
        kept = part.simulated.sel(quantity="relative_displacement_std").item()
        error = part.simulated.sel(quantity="standard_error").item()
        assert table.relative_displacement_std.item() == pytest.approx(kept, rel=4 * 2**0.5 * error)


def test_nearly_equal_structures_are_on_the_safe_side():
    """As their bias says; by the signatures alone 23 % of such pairs were off by over -10 %."""
    apart = sl.Bilinear([1.05, 1.0], 0.05, 0.1, reduction_factor=4)
    table = sl.correlate(
        sl.Bilinear(1.0, 0.05, 0.1, reduction_factor=4),
        apart,
        sl.KanaiTajimi(1.0, 0.3),
        closure="drift",
    )
    bias = table.relative_displacement_bias.values
    assert 0.04 < bias[0] < 0.07
    assert (
        bias[1] == table.relative_displacement_std[1] == table.relative_displacement_error[1] == 0
    )


@pytest.mark.parametrize("ground", [sl.KanaiTajimi(1.0, 0.3), sl.WhiteNoise()])
def test_nearly_equal_structures_meet_a_simulation(ground):
    pair = [sl.Bilinear(period, 0.05, 0.1, reduction_factor=4) for period in (1.0, 1.05)]
    table = sl.correlate(*pair, ground, closure="drift")
    exact = sl.correlate(*pair, ground, "simulation", paths=64, steps_per_period=16)
    off = float(table.relative_displacement_std / exact.relative_displacement_std) - 1
    assert -0.05 < off < 0.15
    assert int(table.relative_displacement_caution) == int(exact.relative_displacement_caution) == 0


def test_every_method_reports_the_difference():
    pair = [sl.Bilinear(period, 0.05, 0.1, reduction_factor=4) for period in (1.0, 1.4)]
    ground = sl.KanaiTajimi(1.0, 0.3)
    truth = float(sl.correlate(*pair, ground, closure="drift").relative_displacement_std)
    for method, closure, caution in (
        ("linearization", "gaussian", 1),
        ("linearization", "clipped", 1),
        ("linearization", "drift", 0),
        ("simulation", "gaussian", 0),
        ("white_noise", "gaussian", 2),
        ("effective", "gaussian", 2),
    ):
        table = sl.correlate(*pair, ground, method, closure=closure, paths=64, steps_per_period=16)
        std = difference(table.displacement_std_1, table.displacement_std_2, table.rho)
        assert float(table.relative_displacement_std) == pytest.approx(float(std), rel=1e-12)
        assert int(table.relative_displacement_caution) == caution
        bias = float(table.relative_displacement_bias)
        assert np.isnan(bias) == (caution == 2)
        if caution < 2:
            assert float(std) / (1 + bias) == pytest.approx(truth, rel=0.06)


def test_no_map_knows_two_soils_in_parallel():
    ground = sl.ParallelGround((sl.KanaiTajimi(1.0, 0.3), sl.KanaiTajimi(2.0, 0.3)))
    pair = [sl.Bilinear(period, 0.05, 0.1, reduction_factor=4) for period in (1.0, 1.4)]
    table = sl.correlate(*pair, ground, closure="drift")
    assert np.isnan(table.relative_displacement_bias)
    assert int(table.relative_displacement_caution) == int(table.caution) == 2
    assert float(table.relative_displacement_std) > 0
