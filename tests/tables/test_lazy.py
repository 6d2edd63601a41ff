"""Tables of dask: lazy, and the same to the last bit, but for rounding of the drift closure."""

import numpy as np
import pytest
from cases import axis

import stochlin as sl
from stochlin.solver.correlation import pairs

pytestmark = pytest.mark.invariant

pytest.importorskip("dask", reason="dask is in the extra 'scale'")

PERIODS = np.geomspace(0.05, 9, 15)
OPTIONS = [
    {},
    {"closure": "clipped"},
    {"method": "white_noise"},
    {"method": "effective"},
]


def models(chunk_1=None, chunk_2=None):
    """Two structures and a ground; a shared dimension, and cells that fail."""
    axes = {
        "period_1": (PERIODS, chunk_1),
        "period_2": (PERIODS[::-2], chunk_2),
        "reduction_factor": ([0.5, 3.0, -1.0, 6.0], 3),
        "ground_damping": ([0.05, 0.3], 1),
    }
    arrays = {
        name: axis(name, np.array(values, float), chunk if chunk_1 else None)
        for name, (values, chunk) in axes.items()
    }
    shared = {"damping": 0.05, "hardening": 0.05, "reduction_factor": arrays["reduction_factor"]}
    ground = sl.KanaiTajimi(2.0, arrays["ground_damping"])
    return *(sl.Bilinear(arrays[f"period_{n}"], **shared) for n in (1, 2)), ground


def assert_same(lazy, eager):
    assert list(lazy.data_vars) == list(eager.data_vars)
    computed = lazy.compute(scheduler="threads")
    for name, variable in eager.data_vars.items():
        assert lazy[name].chunks is not None, name
        found = computed[name].transpose(*variable.dims)
        assert found.dtype == variable.dtype
        np.testing.assert_allclose(found, variable, rtol=1e-12, atol=1e-14, err_msg=str(name))
        assert found.attrs.keys() == variable.attrs.keys()


@pytest.mark.slow
@pytest.mark.parametrize("chunks", [(7, 5), (100, 9)])
@pytest.mark.parametrize("options", OPTIONS, ids=str)
def test_lazy_tables_are_the_eager_ones(options, chunks):
    lazy = sl.correlate(*models(*chunks), **options)
    assert_same(lazy, sl.correlate(*models(), **options))


def test_chunks_of_a_single_cell():
    """A structure alone takes other ways through numpy's loops than one in a row."""
    few = {"period_1": slice(6, 8), "period_2": slice(3, 5)}
    parts, whole = ([model.isel(few) for model in chunked] for chunked in (models(1, 1), models()))
    assert_same(sl.correlate(*parts), sl.correlate(*whole))


def test_a_structure_alone_is_the_same_in_chunks():
    first, _, ground = models(7, 5)
    eager, _, same = models()
    for closure in ("gaussian", "clipped"):
        assert_same(sl.linearize(first, ground, closure), sl.linearize(eager, same, closure))


GROUNDS = {
    "white noise": sl.WhiteNoise(0.01),
    "Kanai-Tajimi": sl.KanaiTajimi(0.4, 0.6),
    "narrow-band": sl.KanaiTajimi(2.0, 0.05),
    "Clough-Penzien": sl.named_ground("firm", 0.01),
}
LINEARIZED = (
    "rho",
    "relative_displacement_std",
    *(f"{name}_{n}" for name in ("displacement_std", "ductility_std") for n in (1, 2)),
)


@pytest.mark.parametrize("closure", ["gaussian", "clipped", "drift"])
@pytest.mark.parametrize("ground", GROUNDS)
def test_chunks_change_the_drift_closure_by_rounding_alone(ground, closure):
    """Also beside a structure differing by 1e-4, whose relative displacement magnifies rounding."""
    periods = np.append(np.geomspace(0.1, 3, 20), [1.0, 1.0001])
    beside = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=3)

    def table(chunk):
        first = sl.Bilinear(axis("period", periods, chunk), 0.05, 0.05, reduction_factor=3)
        return sl.correlate(first, beside, GROUNDS[ground], closure=closure).load()

    whole = table(None)
    for chunk in (3, 7):
        parts = table(chunk)
        for name, values in whole.items():
            exact = closure != "drift" and name in LINEARIZED
            if exact or values.dtype.kind != "f":
                np.testing.assert_array_equal(parts[name], values, err_msg=f"{name}, {chunk}")
            elif "std" in name and not name.startswith("relative"):
                np.testing.assert_allclose(
                    parts[name], values, rtol=1e-12, err_msg=f"{name}, {chunk}"
                )
            else:
                magnified = 1e-6 * name.startswith("relative")
                np.testing.assert_allclose(parts[name], values, magnified, 1e-9, err_msg=name)


def test_nothing_is_computed_before_it_is_asked_for():
    import dask

    def never(*_, **__):
        raise AssertionError("computed")

    with dask.config.set(scheduler=never):
        table = sl.correlate(*models(7, 5))
        assert "in chunks over" in table.attrs["first"]
        assert table.rho.chunks is not None


def test_correlations_that_are_computed_alone_cost_no_bias(monkeypatch):
    table = sl.correlate(*models(7, 5))

    def refuse(*arguments):
        raise ArithmeticError("the bias is computed")

    monkeypatch.setattr(pairs, "judged", refuse)
    assert np.isfinite(table[["rho", "displacement_std_1", "status"]].compute().rho).any()
    with pytest.raises(ArithmeticError, match="the bias is computed"):
        table.bias.compute()
