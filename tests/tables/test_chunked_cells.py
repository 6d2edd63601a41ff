"""Tables that are computed cell by cell: lazy, in chunks, and the same to the last bit."""

import numpy as np
import pytest
import xarray as xr
from cases import axis

import stochlin as sl
from stochlin.solver.tables.cells import over_cells

pytestmark = pytest.mark.invariant

pytest.importorskip("dask", reason="dask is in the extra 'scale'")

GROUND = sl.KanaiTajimi(0.5, 0.3, intensity=0.01)
HAZARD = sl.PowerLawHazard(k0=0.01, k=2.5)
SECOND = sl.Bilinear(1.0, 0.05)
VERBS = {
    "separation": lambda one: sl.separation(one, SECOND, GROUND, 5.0, paths=32),
    "pounding_risk": lambda one: sl.pounding_risk(one, SECOND, GROUND, 0.2, HAZARD, 5.0, paths=32),
    "required_gap": lambda one: sl.required_gap(
        one, None, GROUND, HAZARD, 5.0, risk=0.001, paths=32
    ),
}


def building(chunk=None):
    """With a cell out of range, a whole chunk of such, and one that is longer than the motions."""
    periods = axis("period", [-1.0, -2.0, 0.7, -1.0, 9.0], chunk)
    return sl.Bilinear(periods, axis("damping", [0.03, 0.05], chunk))


def assert_same(lazy, eager):
    found = lazy.compute() if lazy.chunks else lazy
    for model in ("first", "second"):  # those in chunks are told without their numbers
        found.attrs.pop(model, None)
        eager.attrs.pop(model, None)
    xr.testing.assert_identical(found, eager)


@pytest.mark.slow
@pytest.mark.parametrize("verb", VERBS)
def test_a_lazy_table_is_the_eager_one(verb):
    lazy = VERBS[verb](building(2))
    assert lazy.chunks["period"] == (2, 2, 1)
    assert_same(lazy, VERBS[verb](building()))


def test_only_one_cell_is_computed_before_the_table_is_asked_for():
    asked = []

    def of_cell(first):
        asked.append(float(first.arrays()["period"]))
        return xr.Dataset({"twice": 2 * first.arrays()["period"]})

    lazy = over_cells(of_cell, {"first": building(1)})
    assert len(asked) == 1
    np.testing.assert_array_equal(lazy.twice.isel(period=[2, 4], damping=0), [1.4, 18.0])


def test_no_valid_cell_is_said_before_the_table_is_asked_for():
    wrong = sl.Bilinear(axis("period", [-1.0, -2.0], 1), 0.05)
    with pytest.raises(ValueError, match="no cell has valid parameters"):
        VERBS["separation"](wrong)
