"""Tables by simulation: the same labels as by linearization, the same numbers as `simulate`."""

import numpy as np
import pytest
from cases import axis, check_labels

import stochlin as sl

pytestmark = pytest.mark.invariant

FEW = {"paths": 64, "relaxation_times": 3.0}
LAKEBED = sl.KanaiTajimi(period=2.0, damping=0.05)


def building(period, **changes):
    return sl.Bilinear(
        period, **{"damping": 0.05, "hardening": 0.1, "reduction_factor": 4} | changes
    )


def test_table_has_the_numbers_of_simulate():
    """The same structures in the same order on the same seed are the same ensemble."""
    first, second = [0.8, 1.5], [1.0, 2.0]
    table = sl.correlate(
        building(axis("period_1", first)),
        building(axis("period_2", second)),
        LAKEBED,
        "simulation",
        **FEW,
    )
    row = sl.simulate([building(period) for period in first + second], LAKEBED, **FEW)
    np.testing.assert_array_equal(table.rho, row.rho[:2, 2:])
    np.testing.assert_array_equal(table.rho_standard_error, row.rho_standard_error[:2, 2:])
    np.testing.assert_array_equal(table.displacement_std_2, row.displacement_std[2:])


def test_table_has_the_labels_of_linearization():
    first, second = building(axis("period_1", [0.8, 1.5])), building(1.0)
    simulated = sl.correlate(first, second, LAKEBED, "simulation", **FEW)
    linearized = sl.correlate(first, second, LAKEBED)
    own = {name for name in linearized.data_vars if name.startswith("bias")} | {"caution"}
    assert set(linearized.data_vars) - own <= set(simulated.data_vars)
    check_labels(simulated)
    assert simulated.attrs["paths"] == FEW["paths"]


def test_dimensions_of_the_ground_and_shared_ones():
    factor = axis("factor", [2.0, 4.0])
    ground = sl.KanaiTajimi(period=2.0, damping=axis("bandwidth", [0.05, 0.6]))
    pair = [building(period, reduction_factor=factor) for period in (1.0, 1.4)]
    table = sl.correlate(*pair, ground, "simulation", **FEW)
    assert dict(table.sizes) == {"bandwidth": 2, "factor": 2}
    alone = [building(period, reduction_factor=4.0) for period in (1.0, 1.4)]
    expected = sl.correlate(*alone, sl.KanaiTajimi(2.0, 0.6), "simulation", **FEW)
    one = table.sel(factor=4.0, bandwidth=0.6)
    # other companions on the same motions: the step and the length differ, not the truth
    error = np.hypot(one.rho_standard_error, expected.rho_standard_error)
    assert abs(one.rho - expected.rho) < 4 * error


def test_pairs_of_structures_that_yield_rarely_have_no_rho_and_the_others_have():
    factors = axis("factor", [0.8, 4.0])
    rare = building(4.0, reduction_factor=factors, hardening=0.001)
    table = sl.correlate(building(0.5), rare, LAKEBED, "simulation", **FEW)
    assert table.status.values.tolist() == [6, 0]
    assert table.rho.isnull().values.tolist() == [True, False]
    assert table.displacement_std_2.notnull().all()


def test_many_grounds_are_refused_by_the_time_of_all_of_them(monkeypatch):
    """One of them takes 2.5 ms by the estimate, forty 0.1 s."""
    for module in ("simulation.stationary_motions", "correlation.simulated"):
        monkeypatch.setattr(f"stochlin.solver.{module}.cores", lambda: 1)
    monkeypatch.setattr("stochlin.solver.tables.checks.MOST_SECONDS", 0.05)
    pair = [building(period) for period in (0.8, 1.0)]
    one, several = (sl.KanaiTajimi(2.0, axis("bandwidth", np.full(n, 0.3))) for n in (1, 40))
    sl.correlate(*pair, one, "simulation", **FEW)
    monkeypatch.setattr("stochlin.solver.correlation.simulated.simulate", None)
    with pytest.raises(
        ValueError, match=r"the simulations on 40 grounds would take .*fewer grounds"
    ):
        sl.correlate(*pair, several, "simulation", **FEW)
