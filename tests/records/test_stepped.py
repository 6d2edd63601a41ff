"""Structures of any law and buildings in a recorded motion: exact answers and other integrators."""

import numpy as np
import pytest
import scipy.integrate
import sympy
import xarray as xr

import stochlin as sl
from stochlin.applications.records.cells import checked_motions
from stochlin.applications.records.stepped import stepped_gap

pytestmark = [pytest.mark.oracle, pytest.mark.filterwarnings("ignore:.*its (peak|velocity)")]

V, Z = sympy.symbols("v z")


def motion(samples=1200, dt=0.02, seed=0):
    time = dt * np.arange(samples)
    shape = np.minimum(time / 4, 1) * np.exp(-0.1 * np.maximum(time - 12, 0))
    noise = np.convolve(
        np.random.default_rng(seed).standard_normal(samples), np.ones(6) / 6, "same"
    )
    values = 4 * shape * (np.sin(9 * time) + 2 * noise)
    return xr.DataArray(values, dims="time", coords={"time": time}, attrs={"units": "m/s^2"})


def tower(storeys=5, height=3.2, **changes):
    usual = {"hardening": 0.05, "base_shear_coefficient": 0.2, "damping": 0.05, "mass": 3e5}
    regular = {"period": 0.12 * storeys, "storeys": storeys, "storey_height": height}
    return sl.ShearBuilding.regular(**(regular | usual | changes))


@pytest.mark.parametrize("seed", range(4))
def test_steps_give_the_exact_answer_of_bilinear_pairs(seed):
    rng = np.random.default_rng(seed)
    pair = [
        sl.Bilinear(period, 0.05, hardening, yield_displacement=uy)
        for period, hardening, uy in zip(
            rng.uniform(0.3, 1.5, 2),
            rng.uniform(0.02, 0.5, 2),
            rng.uniform(0.005, 0.1, 2),
            strict=True,
        )
    ]
    record = motion(seed=seed)
    exact, found = sl.recorded_gap(*pair, record), stepped_gap(pair, checked_motions(record))
    for name in ("separation", "peak_1", "peak_2", "rho"):
        assert float(found[name]) == pytest.approx(float(exact[name]), rel=2e-4), name
    assert float(found.step_error) <= 1e-4
    assert int(found.status) == int(exact.status)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["bouc_wen", "sympy"])
def test_other_laws_follow_an_ode_solver(law):
    uy, w, alpha = 0.02, 2 * np.pi / 0.7, 0.1
    given = {"yield_displacement": uy}
    structure = sl.BoucWen(0.7, 0.05, alpha, beta=0.6, gamma=0.3, exponent=1.0, **given)
    if law == "sympy":
        slip = V - 0.6 * sympy.Abs(V) * Z - 0.3 * V * sympy.Abs(Z)
        structure = sl.Hysteretic(0.7, 0.05, alpha, law=slip, **given)
    record = motion(600)
    time = record.time.values

    def rates(t, x):
        u, v, z = x
        ground = np.interp(t, time, record.values)
        rate = v / uy
        force = 2 * 0.05 * w * v + alpha * w**2 * u + (1 - alpha) * w**2 * uy * z
        return [v, -ground - force, rate - 0.6 * abs(rate) * z - 0.3 * rate * abs(z)]

    exact = scipy.integrate.solve_ivp(
        rates, (0, time[-1]), np.zeros(3), t_eval=time, rtol=1e-8, atol=1e-10, max_step=5e-3
    ).y
    table = sl.respond(structure, record)
    peak = np.abs(exact[0]).max()
    assert peak > 2 * uy
    np.testing.assert_allclose(table.displacement, exact[0], rtol=0, atol=3e-4 * peak)
    np.testing.assert_allclose(table.z, exact[2], rtol=0, atol=1e-3)


@pytest.mark.slow
def test_buildings_move_as_the_method_of_eighth_order_says():
    """`pound` of the same buildings, so far apart that they never meet."""
    pair, record = [tower(3), tower(4, 2.7, p_delta=True)], motion(700)
    far = sl.pound(pair, 0.8, sl.Kelvin(1e8, restitution=0.6), record)
    for n, building in enumerate(pair, start=1):
        found = sl.respond(building, record).displacement.values
        exact = far.displacement.sel(structure=n).values[:, : building.storeys]
        peak = np.abs(exact).max()
        np.testing.assert_allclose(found, exact, rtol=0, atol=3e-4 * peak)
    gap = sl.recorded_gap(*pair, record)
    assert gap.height.values.tolist() == pytest.approx([2.7, 3.2, 5.4, 6.4, 8.1, 9.6])
    one, two = (far.displacement.sel(structure=n) for n in (1, 2))
    between = two.sel(floor=2) + (9.6 - 8.1) / 2.7 * (two.sel(floor=4) - two.sel(floor=3))
    at_roof = one.sel(floor=3) - (two.sel(floor=3) + between - two.sel(floor=2))
    assert float(gap.separation_at_height[-1]) == pytest.approx(float(at_roof.max()), rel=2e-3)
    assert float(gap.separation) == float(gap.separation_at_height.max())


def test_several_records_and_a_table_of_structures():
    records = {"one": motion(400), "two": motion(400, seed=1)}
    strengths = xr.DataArray([0.01, -1.0, 0.05], dims="uy")
    first = sl.BoucWen(0.5, 0.05, 0.1, yield_displacement=strengths)
    table = sl.recorded_gap(first, sl.Bilinear(0.8, 0.05), records)
    assert dict(table.separation.sizes) == {"record": 2, "uy": 3}
    assert table.separation.isnull().values.tolist() == [[False, True, False]] * 2
    alone = sl.recorded_gap(
        sl.BoucWen(0.5, 0.05, 0.1, yield_displacement=0.05), sl.Bilinear(0.8, 0.05), records["two"]
    )
    assert float(table.separation.sel(record="two")[2]) == float(alone.separation)
