"""Energies of structures in recorded motions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import simpson

import stochlin as sl

DT = 0.02
KEPT = (
    "viscous_energy_per_mass",
    "hysteretic_energy_per_mass",
    "kinetic_energy_per_mass",
    "elastic_energy_per_mass",
)


def motion(seconds=12.0, seed=3):
    shape = sl.AminAng(2.0, 7.0, 0.6)
    ground = sl.KanaiTajimi(0.6, 0.4, intensity=0.02)
    return sl.simulated_motions(ground, seconds, shape, paths=2, seed=seed, step=DT)[0]


RECORD = motion()


def imbalance(table):
    lost = table.input_energy_per_mass - sum(table[name] for name in KEPT)
    return float(abs(lost).max() / table.input_energy_per_mass.max())


@pytest.mark.invariant
@settings(max_examples=40, deadline=None)
@given(
    period=st.floats(0.05, 10.0),
    damping=st.floats(0.001, 0.9),
    hardening=st.floats(0.01, 1.0),
    strength=st.floats(0.01, 3.0),
)
def test_energies_balance(period, damping, hardening, strength):
    peak = float(sl.response_spectrum(RECORD, period, damping).displacement_max)
    one = sl.Bilinear(period, damping, hardening, yield_displacement=strength * peak)
    table = sl.respond(one, RECORD)
    assert imbalance(table) < 1e-9
    for name in ("viscous_energy_per_mass", "hysteretic_energy_per_mass"):
        assert (table[name].diff("time") >= -1e-12 * table.input_energy_per_mass.max()).all()
    last = sl.response_spectrum(
        RECORD, period, damping, hardening=hardening, yield_displacement=strength * peak
    )
    for name in ("input_energy_per_mass", "viscous_energy_per_mass", "hysteretic_energy_per_mass"):
        assert float(last[name]) == pytest.approx(float(table[name][-1]), rel=1e-12)


TOWER = sl.ShearBuilding.regular(
    period=0.8,
    storeys=3,
    storey_height=3.0,
    mass=2e5,
    damping=0.05,
    hardening=0.05,
    base_shear_coefficient=0.1,
)


@pytest.mark.oracle
@pytest.mark.parametrize("one", [sl.BoucWen(0.8, 0.05, 0.05, yield_displacement=0.02), TOWER])
def test_what_yielding_dissipates_is_the_work_of_the_hysteretic_force(one):
    table = sl.respond(one, RECORD, refine=4)
    assert imbalance(table) < 1e-9
    whole, work = 1.0, 0.0
    if isinstance(one, sl.ShearBuilding):
        drift, stiffness = table.storey_drift.values, one.arrays()["stiffnesses"].values
        yields, whole = one.arrays()["yield_drifts"].values, float(one.arrays()["masses"].sum())
    else:
        drift, stiffness, yields = table.displacement.values[:, None], (2 * np.pi / 0.8) ** 2, 0.02
    z = yields * table.z.values.reshape(drift.shape)
    for column in (0.95 * stiffness * np.trapezoid(z, drift - z, axis=0)).ravel():
        work += column / whole
    assert float(table.hysteretic_energy_per_mass[-1]) == pytest.approx(work, rel=2e-3)
    lost = table.hysteretic_energy_per_mass.diff("time")
    assert (lost > -1e-6 * lost.max()).all()  # a step in which z changes its sign has an error


@pytest.mark.oracle
def test_energies_of_an_elastic_structure_by_quadrature():
    table = sl.respond(sl.Bilinear(0.5, 0.02), RECORD, refine=8)
    ground, t = RECORD.interp(time=table.time), table.time.values
    put_in = -simpson(ground * table.velocity, x=t)
    assert float(table.input_energy_per_mass[-1]) == pytest.approx(put_in, rel=1e-6)
    assert float(table.hysteretic_energy_per_mass.max()) == 0
    radius = 0.5 * (2 * np.pi / 0.5) ** 2 * table.radius**2
    np.testing.assert_allclose(
        table.kinetic_energy_per_mass + table.elastic_energy_per_mass, radius, rtol=1e-12
    )


@pytest.mark.invariant
def test_fig1b_is_of_the_same_energies_and_radii():
    table = sl.charts.energy_chart(RECORD, 0.8, 0.05, 0.05, 4.0)
    elastic = table.sel(reduction_factor=1)
    # Without yielding the radius is what is left of the energy put in.
    left = elastic.input_energy_radius**2 - elastic.viscous_energy_radius**2
    np.testing.assert_allclose(
        left, elastic.radius**2, atol=1e-9 * float(elastic.radius.max()) ** 2
    )
    assert float(elastic.hysteretic_energy_radius.max()) == 0
    assert float(table.radius.sel(reduction_factor=4).max()) <= float(elastic.radius.max())
    at_end = sl.response_spectrum(RECORD, 0.8, 0.05).input_energy_per_mass
    radius = float(elastic.input_energy_radius[-1]) * 2 * np.pi / 0.8
    assert radius**2 / 2 == pytest.approx(float(at_end), rel=1e-9)
    assert 0 < float(table.significant_begin) < float(table.significant_end) < float(table.time[-1])
    sl.charts.draw(table)
