"""A result of simulate from outside, the documentation's: what it is, where it is reported."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.solver.simulation.results import RESULTS, register_result

GROUND = sl.KanaiTajimi(0.5, 0.5, 0.05)
# at rest at its end
MOTION = {"paths": 32, "duration": 90.0, "envelope": sl.AminAng(2.0, 6.0, 2.0)}
YIELDING = {"damping": 0.1, "hardening": 0.1, "yield_displacement": 0.01}
FRAME = sl.ShearBuilding(
    masses=[2e5, 2e5, 1e5],
    stiffnesses=[3e8, 2e8, 1e8],
    damping=0.1,
    hardening=0.05,
    heights=[3.0, 3.0, 3.0],
    yield_drifts=0.004,
)


@pytest.fixture
def residual(example):
    """The result of the page, and the drifts at the end."""
    example("A result of simulate", RESULTS)
    register_result("last_drift", ["element"], units="m", long_name="drift at the end")(
        lambda motions: motions.displacement @ motions.moving.system.drifts.T
    )
    yield
    del RESULTS._things["last_drift"], RESULTS._places["last_drift"]


@pytest.mark.oracle
@pytest.mark.usefixtures("residual")
@pytest.mark.parametrize(
    "structures",
    [
        [sl.Bilinear(0.5, **YIELDING), sl.Bilinear(0.3, 0.1), sl.BoucWen(0.8, **YIELDING)],
        [FRAME, sl.Bilinear(0.5, **YIELDING)],
        [sl.Bilinear(0.5, 0.1, sl.Uncertain(0.1, 0.3), yield_displacement=0.01)],
    ],
    ids=["oscillators", "storeys", "uncertain hardening"],
)
def test_the_result_of_the_page_is_the_drift_at_rest(structures):
    """Of any law: the integrated motion has come to rest, where the forces of all springs are 0."""
    table = sl.simulate(structures, GROUND, **MOTION)
    assert float(abs(table.residual_drift).max()) > 1e-3
    np.testing.assert_allclose(table.residual_drift, table.last_drift, rtol=0, atol=1e-9)


@pytest.mark.oracle
@pytest.mark.usefixtures("residual")
def test_it_is_known_before_the_structure_is_at_rest():
    """From the end of a motion on, which is then weak, the plastic part stays as it is."""
    pair = [sl.Bilinear(0.5, **YIELDING), sl.Bilinear(1.0, **YIELDING)]
    early, late = (sl.simulate(pair, GROUND, **MOTION | {"duration": s}) for s in (10.0, 90.0))
    assert float(abs(early.last_drift - late.last_drift).max()) > 1e-4
    np.testing.assert_allclose(early.residual_drift, late.residual_drift, rtol=0, atol=1e-9)


@pytest.mark.invariant
@pytest.mark.usefixtures("residual")
def test_it_has_unit_and_mean_and_is_infinite_where_a_structure_falls():
    weak = sl.Bilinear(1.0, 0.05, -0.1, yield_displacement=0.01)
    table = sl.simulate([weak], GROUND, **MOTION | {"duration": 12.0})
    falls = np.isposinf(table.peak.values)
    assert falls.any()
    np.testing.assert_array_equal(np.isposinf(table.residual_drift.values), falls)
    assert table.residual_drift.attrs == {
        "units": "m",
        "long_name": "drift that remains when the structure has come to rest",
    }
    assert table.residual_drift_mean.attrs["long_name"].startswith("mean of the drift that remains")
    linked = [sl.Bilinear(t, **YIELDING, mass=1e5) for t in (0.5, 1.0)]
    table = sl.simulate(linked, GROUND, **MOTION | {"duration": 12.0}, link=sl.Link(stiffness=1e6))
    assert "residual_drift" not in table


@pytest.mark.invariant
@pytest.mark.parametrize("stated", [{}, {"units": "m"}, {"long_name": "drift at the end"}])
def test_a_result_without_unit_or_long_name_is_refused(stated):
    with pytest.raises(ValueError, match="'end_drift' lacks units and long_name; give both"):
        register_result("end_drift", ["element"], **stated)


@pytest.mark.extreme
@pytest.mark.invariant
def test_every_result_has_a_unit_and_a_long_name():
    pair = [FRAME, sl.Bilinear(0.5, **YIELDING, mass=1e5)]
    table = sl.simulate(pair, GROUND, **MOTION | {"duration": 5.0}, link=sl.Link(stiffness=1e6))
    for name in table.data_vars.keys() & RESULTS.keys():
        assert {"units", "long_name"} <= table[name].attrs.keys(), name
