"""Simulated correlations in chunks of dask: lazy, and those of the whole table to the last bit."""

import numpy as np
import pytest
import xarray as xr
from cases import axis

import stochlin as sl

pytestmark = pytest.mark.invariant

pytest.importorskip("dask", reason="dask is in the extra 'scale'")

GROUND = sl.KanaiTajimi(0.5, 0.3, intensity=0.01)
OPTIONS = {"method": "simulation", "paths": 64, "relaxation_times": 5}


def elastic(chunk=None):
    """The shortest and the longest period in chunks of their own, and one of cells that are wrong."""
    one = axis("period_1", [0.3, 0.5, -1.0, -2.0, 2.0], chunk)
    return sl.Bilinear(one, 0.05), sl.Bilinear(axis("period_2", [0.4, -1.0, 1.1], chunk), 0.04), GROUND


def yielding(chunk=None):
    """On two grounds, with a dimension that both structures share."""
    factor = axis("reduction_factor", [3.0, 4.0, 6.0], chunk and 1)
    one = sl.Bilinear(axis("period", [0.4, 0.9], chunk and 1), 0.05, 0.1, reduction_factor=factor)
    two = sl.BoucWen(0.7, 0.05, 0.2, reduction_factor=factor)
    return one, two, sl.KanaiTajimi(axis("soil", [0.3, 0.8], chunk and 1), 0.3, intensity=0.01)


def assert_same_bits(lazy, eager):
    assert set(lazy.data_vars) == set(eager.data_vars)
    found = lazy.compute() if lazy.chunks else lazy
    for name, variable in eager.data_vars.items():
        assert lazy[name].chunks is not None or lazy.chunks == {}, name
        assert found[name].dtype == variable.dtype
        same = found[name].transpose(*variable.dims)
        np.testing.assert_array_equal(same, variable, err_msg=str(name))
        assert found[name].attrs.keys() == variable.attrs.keys()
    assert {**found.attrs, "first": 0, "second": 0, "ground": 0} == {
        **eager.attrs,
        "first": 0,
        "second": 0,
        "ground": 0,
    }


@pytest.mark.parametrize("models", [elastic, pytest.param(yielding, marks=pytest.mark.slow)])
def test_chunks_are_those_of_the_whole_table(models):
    lazy = sl.correlate(*models(2), **OPTIONS)
    assert len(lazy.rho.data.__dask_keys__()) > 1
    assert_same_bits(lazy, sl.correlate(*models(), **OPTIONS))


def test_a_chunk_is_simulated_when_it_is_asked_for(monkeypatch):
    from stochlin.analyses.correlation import simulated

    sizes = []

    def simulate(run, progress):
        sizes.append(run.crowd.size)
        return moments(run, progress)

    moments = simulated.simulate_moments
    monkeypatch.setattr(simulated, "simulate_moments", simulate)
    lazy = sl.correlate(*elastic(2), **OPTIONS)
    assert not sizes
    part = lazy.rho.isel(period_1=slice(0, 2), period_2=slice(2, 3)).compute(scheduler="synchronous")
    assert np.isfinite(part).all()
    assert sizes == [3]


def test_no_valid_structure_is_said_before_the_table_is_asked_for():
    wrong = sl.Bilinear(axis("period", [-1.0, -2.0], 1), 0.05)
    with pytest.raises(ValueError, match="no structure has valid parameters"):
        sl.correlate(wrong, wrong, GROUND, **OPTIONS)


def test_more_structures_than_one_ensemble_holds_are_taken_in_chunks():
    many = sl.Bilinear(axis("one", np.geomspace(0.5, 2, 6000)).chunk(one=600), 0.05)
    other = sl.Bilinear(axis("two", np.geomspace(0.5, 2, 6000)).chunk(two=600), 0.05)
    table = sl.correlate(many, other, GROUND, **OPTIONS)
    assert table.rho.shape == (6000, 6000)


def test_a_table_that_is_sent_to_a_worker_has_the_same_bits():
    cloudpickle = pytest.importorskip("cloudpickle", reason="cloudpickle comes with dask")
    lazy = sl.correlate(*elastic(2), **OPTIONS, progress=print)
    sent = cloudpickle.loads(cloudpickle.dumps(lazy))
    xr.testing.assert_equal(sent.compute(scheduler="synchronous"), sl.correlate(*elastic(), **OPTIONS))
