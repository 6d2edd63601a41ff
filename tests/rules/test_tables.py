"""Peaks, gaps, rules and strengths as tables: labelled, storable, repeatable, cell by cell."""

from __future__ import annotations

import io

import numpy as np
import pytest
import xarray as xr
from cases import axis

import stochlin as sl

pytestmark = pytest.mark.invariant

GROUND = sl.KanaiTajimi(1.0, 0.3)
YIELDING = {"damping": 0.05, "hardening": 0.05, "reduction_factor": 3.0}
PAIR = {"damping_1": 0.05, "damping_2": 0.03, "hardening_1": 0.05, "hardening_2": 0.1}


def period():
    return axis("period_1", [0.5, -1.0, 1.0])


def building():
    return sl.Bilinear(period(), **YIELDING)


RESULTS = {
    "peak_response": lambda: sl.peak_response(building(), GROUND, axis("duration", [10.0, 30.0])),
    "one-sided": lambda: sl.peak_response(building(), GROUND, 20.0, sides=1, model="DK80"),
    "rho_effective": lambda: sl.rho_effective(period(), 1.0, **PAIR, ductility_1=4.0, ductility_2=2.0),
    "effective": lambda: sl.correlate(
        building(), sl.Bilinear(0.8, **YIELDING), GROUND, method="effective", rule="fema_440"
    ),
    "critical_gap": lambda: sl.critical_gap(0.3, 0.2, axis("rho", [-0.5, 2.0, 1.0])),
    "code_gaps": lambda: sl.code_gaps(axis("peak_1", [0.1, -1.0, 0.2]), 0.04, zone="I"),
    "strength_for_ductility": lambda: sl.strength_for_ductility(building(), GROUND, 4.0),
    "reduction_factor": lambda: sl.reduction_factor(building(), GROUND),
}
every_result = pytest.mark.parametrize("result", RESULTS.values(), ids=list(RESULTS))


@every_result
def test_every_variable_says_what_it_is(result):
    table = result()
    for name, variable in table.data_vars.items():
        assert variable.attrs["long_name"], name
        if name in ("status", "caution"):
            assert variable.dtype == variable.attrs["flag_values"].dtype == np.int8
        else:
            assert variable.attrs["units"], name
    assert {"title", "references", "stochlin_version", "history"} <= set(table.attrs)


@every_result
def test_bad_cell_is_blank_and_the_others_are_not(result):
    table = result()
    shown = next(iter(table.data_vars))
    failed = table.status >= 2
    assert bool(failed.any())
    assert not bool(failed.all())
    assert (table[shown].isnull() == failed).all()


@every_result
def test_file_gives_back_what_was_written(result):
    table = result()
    stored = bytes(table.to_netcdf(engine="scipy"))
    with xr.open_dataset(io.BytesIO(stored), engine="scipy") as back:
        xr.testing.assert_equal(back.load(), table)
        assert back.attrs == table.attrs


@every_result
def test_same_inputs_give_the_same_dataset(result):
    xr.testing.assert_identical(result(), result())


def test_from_a_pair_to_its_gap():
    """The way through: peaks and a correlation make the gap, smaller than that of the sum."""
    pair = [sl.Bilinear(T, **YIELDING) for T in (0.6, 1.0)]
    peaks = [sl.peak_response(one, GROUND, 30.0).peak_mean for one in pair]
    gap = sl.critical_gap(*peaks, sl.correlate(*pair, GROUND).rho).gap
    codes = sl.code_gaps(*peaks).gap
    assert float(gap) < float(codes.sel(rule="srss")) < float(codes.sel(rule="share_of_sum"))
