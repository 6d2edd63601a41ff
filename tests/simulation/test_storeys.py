"""Floors on storeys in simulated motions: limits and invariance."""

import numpy as np
import pytest
import sympy

import stochlin as sl
from stochlin.models.systems import shares_at, stick_model_of
from stochlin.solver.simulation.structures_in_motion import meeting_heights

pytestmark = pytest.mark.oracle

BROAD = sl.KanaiTajimi(2 * np.pi / 15, 0.6, 0.02)
V, Z = sympy.symbols("v z")
SMOOTH = V - sympy.Abs(V) * Z
LAWS = {
    "elastic": {},
    "bilinear": {"hardening": 0.1, "yield_drifts": 0.01},
    "bouc_wen": {"hardening": 0.1, "yield_drifts": 0.01, "law": "bouc_wen"},
    "sympy": {"hardening": 0.1, "yield_drifts": 0.01, "law": SMOOTH},
}


def four(**changes):
    usual = {"hardening": 0.05, "yield_drifts": [0.010, 0.010, 0.009, 0.008]}
    stiffnesses = np.array([4, 3.6, 3, 2.2]) * 1e8
    return sl.ShearBuilding(
        [2e5, 2e5, 2e5, 1.5e5], stiffnesses, [3.0] * 4, 0.05, **(usual | changes)
    )


def two(**changes):
    usual = {"hardening": 0.1, "yield_drifts": 0.006}
    return sl.ShearBuilding([1.5e5] * 2, [2.5e8, 2e8], [3.0] * 2, 0.05, **(usual | changes))


def single(law):
    """A building of one storey and the oscillator that it is."""
    mass, period = 3e5, 0.5
    building = sl.ShearBuilding(
        [mass], [mass * (2 * np.pi / period) ** 2], [3.0], 0.05, **LAWS[law]
    )
    return building, building.oscillator()


@pytest.mark.parametrize("law", LAWS)
def test_a_building_of_one_storey_is_an_oscillator(law):
    building, oscillator = single(law)
    other = sl.Bilinear(0.8, 0.03)
    finite = {"paths": 64, "duration": 12.0, "seed": 5}
    one, same = (sl.simulate([each, other], BROAD, **finite) for each in (building, oscillator))
    scale = float(same.peak.max())
    np.testing.assert_allclose(one.peak.values, same.peak.values, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(one.separation, same.separation, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(
        one.peak_drift[:, 0].values, same.peak[:, 0].values, rtol=0, atol=1e-9 * scale
    )


def test_elastic_floors_have_the_variance_of_their_modes():
    building = four(yield_drifts=None, hardening=None)
    table = sl.simulate([building], sl.WhiteNoise(0.01), paths=256, seed=2)
    mass, (w, shapes) = building.masses.values, building._modes()
    share = shapes * (mass @ shapes)
    modes = [sl.Bilinear(2 * np.pi / each, 0.05) for each in w]
    covariance = np.zeros((4, 4))
    for m, one in enumerate(modes):
        for n, other in enumerate(modes):
            pair = sl.correlate(one, other, sl.WhiteNoise(0.01))
            product = float(pair.rho * pair.displacement_std_1 * pair.displacement_std_2)
            covariance += product * np.outer(share[:, m], share[:, n])
    off = table.displacement_std.values - np.sqrt(np.diag(covariance))
    assert (np.abs(off) < 4 * table.displacement_std_standard_error.values).all()


def test_a_storey_that_its_weight_leaves_no_hardening_has_no_stationary_answer():
    soft = {"masses": [4e5] * 2, "stiffnesses": [4e7] * 2, "heights": [3.0] * 2, "damping": 0.05}
    building = sl.ShearBuilding(**soft, hardening=0.05, yield_drifts=0.02, p_delta=True)
    with pytest.raises(
        ValueError, match=r"storey 1 has no stiffness after yielding.*with a duration"
    ):
        sl.simulate([building], BROAD)
    without = sl.ShearBuilding(**soft, hardening=0.05, yield_drifts=0.02)
    with_weight, plain = (
        sl.simulate([b], BROAD, paths=128, duration=30.0) for b in (building, without)
    )
    drifts = (table.peak_drift.median("path")[0] for table in (with_weight, plain))
    assert float(next(drifts)) > 1.05 * float(next(drifts))  # in most motions it falls
    fallen = np.isposinf(with_weight.peak_drift).all("element")
    assert 0 < float(fallen.mean()) == float(with_weight.collapse_probability[0]) < 1
    assert "collapse_probability" not in plain


def test_between_floors_nothing_is_larger_than_at_the_levels_of_both():
    low = stick_model_of(two())
    high = stick_model_of(sl.ShearBuilding([1e5] * 5, [1e8] * 5, [2.2] * 5, 0.05))
    heights = meeting_heights(low, high)
    np.testing.assert_allclose(heights, [2.2, 3.0, 4.4, 6.0])
    rng = np.random.default_rng(8)
    for _ in range(50):
        motions = [rng.standard_normal(stick.system.mass.size) for stick in (low, high)]

        def apart(height, motions=motions):
            one, other = (
                shares_at(stick.levels, height) @ motion
                for stick, motion in zip((low, high), motions, strict=True)
            )
            return one - other

        dense = max(apart(height) for height in np.linspace(1e-6, 6.0, 400))
        assert dense <= max(0.0, *map(apart, heights)) + 1e-12


def test_laws_in_one_frame_are_each_their_own():
    """Linked by nothing, a building of another law moves as it does alone."""
    pair = [four(law=SMOOTH), two(law="bouc_wen", law_parameters={"beta": 0.6, "gamma": -0.1})]
    usual = {"paths": 32, "duration": 6.0, "seed": 2}
    free, linked = (
        sl.simulate(pair, BROAD, link=link, **usual) for link in (None, sl.Link(0.0, floors=(2, 2)))
    )
    np.testing.assert_allclose(free.peak, linked.peak, rtol=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"link": sl.Link(1e6, floors=(9, 1))},
            r"floors = \(9, 1\), structure 1 has 4; allowed: 1 to 4",
        ),
        ({"link": sl.Link(1e6, structures=(1, 3))}, "ties the structures 1 and 3 of 2"),
        ({"link": [sl.Link(1e6)] * 2}, "2 given; allowed: one between each two"),
        ({"duration": 0.1}, "shorter than the period of"),
    ],
)
def test_what_does_not_fit_together_is_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        sl.simulate([four(), two()], BROAD, paths=32, **arguments)
