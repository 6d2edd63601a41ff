"""The table of measures against what its rows are made of, called one by one."""

from dataclasses import replace

import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.separation.existing_gap import CLOSE_GAPS

pytestmark = pytest.mark.oracle

GROUND = sl.named_ground("firm", intensity=0.01)
MOTION = {"duration": 15.0, "envelope": sl.AminAng(4.0, 12.0, 0.35), "paths": 128, "seed": 3}
GAP = 0.05
LINK = sl.Link(2e7, 2e6)
MEASURES = {
    "dampers": sl.Measure(0.1, 0.05),
    "link": sl.Measure(link=LINK),
}


def pair(**changes):
    return [
        sl.Bilinear(T, 0.05, 0.05, mass=1e6, **({"reduction_factor": 3} | changes))
        for T in (0.6, 1.0)
    ]


@pytest.fixture(scope="module")
def table():
    return sl.mitigate(*pair(), GROUND, GAP, MEASURES, **MOTION)


def by_strength():
    """The pair by its yield displacements."""
    solved = [sl.linearize(s, GROUND).yield_displacement for s in pair()]
    return [
        sl.Bilinear(s.period, 0.05, 0.05, yield_displacement=float(uy), mass=1e6)
        for s, uy in zip(pair(), solved, strict=True)
    ]


@pytest.mark.slow
def test_as_built_and_least_damping_are_those_of_existing_gap(table):
    known = sl.existing_gap(*pair(), GROUND, GAP, **MOTION)
    built = table.sel(measure="as built")
    assert float(built.no_pounding_probability) == float(known.no_pounding_probability)
    np.testing.assert_allclose(built.required_gap, known.required_gap, rtol=1e-9)
    least = table.sel(measure="least damping, both")
    # Both searches end within CLOSE_GAPS of the gap, which falls with a third or more of the
    # damping's power.
    np.testing.assert_allclose(
        least.added_damping_1, known.least_added_damping, rtol=3 * CLOSE_GAPS
    )
    np.testing.assert_allclose(least.required_gap, GAP, rtol=CLOSE_GAPS)
    assert float(least.added_damping_1) == float(least.added_damping_2) > 0


@pytest.mark.slow
def test_a_link_is_simulated_and_linearized_as_linked(table):
    row = table.sel(measure="link")
    motions = sl.simulate(by_strength(), GROUND, quantiles=[0.9], link=LINK, **MOTION)
    np.testing.assert_allclose(row.required_gap, motions.separation_quantile[0, 0, 1], rtol=1e-9)
    solved = sl.linearize_system(by_strength(), GROUND, [LINK])
    for name in ("rho", "relative_displacement_std"):
        np.testing.assert_allclose(row[name], solved[name][0, 1], rtol=1e-6)
    assert float(row.link_damping_constant) == LINK.damping_constant


def test_added_damping_is_that_of_other_structures(table):
    row = table.sel(measure="dampers")
    damped = [
        replace(structure, damping=0.05 + more)
        for structure, more in zip(by_strength(), (0.1, 0.05), strict=True)
    ]
    motions = sl.simulate(damped, GROUND, quantiles=[0.9], **MOTION)
    np.testing.assert_allclose(row.required_gap, motions.separation_quantile[0, 0, 1], rtol=1e-9)
    np.testing.assert_allclose(row.rho, sl.correlate(*damped, GROUND).rho, rtol=1e-6)


def test_least_measures_are_just_enough(table):
    least = table.where(table.kind == "least", drop=True)
    known = least.required_gap.notnull()
    assert int(known.sum()) >= 2
    np.testing.assert_allclose(least.required_gap[known], GAP, rtol=CLOSE_GAPS)
    for name in least.measure.values[~known.values]:
        row = least.sel(measure=name)
        assert "was searched, and none is enough" in row.missing.item()
        assert int(row.verdict) == 4


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"measures": {"glue": 3}}, r"measures\['glue'\] = 3 is of the wrong kind"),
        (
            {"measures": {"d": sl.Measure(0.96)}},
            "added_damping_1 = 0.96 raises the damping to 1.01",
        ),
        (
            {"measures": {"l": sl.Measure(link=sl.Link(1e6, structures=(1, 3)))}},
            r"measures\['l'\]: link 1: ties the structures 1 and 3 of 2",
        ),
    ],
)
def test_options_out_of_range_are_refused(changes, told):
    options = {"gap": GAP, "measures": {}} | MOTION | changes
    with pytest.raises((ValueError, TypeError), match=told):
        sl.mitigate(*pair(), GROUND, **options)


@pytest.mark.parametrize(
    ("given", "error", "told"),
    [
        (
            {"added_damping_1": [0.1, 0.2]},
            ValueError,
            "added_damping_1 is an array; allowed: a number",
        ),
        ({"link": "glue"}, TypeError, "link = 'glue'; allowed: a Link, or a list of them"),
        ({"link": [sl.Link(1e6), 3]}, TypeError, "link, number 2 = 3 is of the wrong kind"),
        ({"link": sl.Link([1e6, 2e6])}, ValueError, "stiffness is an array"),
    ],
)
def test_measures_that_cannot_be_built_are_refused(given, error, told):
    with pytest.raises(error, match=told):
        sl.Measure(**given)


def test_links_ask_for_masses():
    light = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0)]
    with pytest.raises(ValueError, match="mass is not given"):
        sl.mitigate(*light, GROUND, GAP, {"link": sl.Measure(link=LINK)}, **MOTION)
    table = sl.mitigate(*light, GROUND, GAP, {}, **MOTION)
    assert "least dashpot between" not in table.measure


@pytest.mark.slow
def test_measures_of_buildings_that_are_not_known_exactly():
    """Without spread as known; with it, more is required. Only the last searches for enough."""

    def pair(size):
        return [
            sl.Bilinear(sl.Uncertain(T, size), 0.05, 0.05, reduction_factor=3, mass=1e6)
            for T in (0.6, 1.0)
        ]

    def table(both, gap=0.5):
        given = {"link": sl.Measure(link=sl.Link(1e7, 1e6))}
        return sl.mitigate(*both, GROUND, gap, given, duration=8.0, paths=32)

    still, known = table(pair(0.0)), table([one.median() for one in pair(0.0)])
    np.testing.assert_allclose(still.required_gap, known.required_gap, rtol=5e-3)
    np.testing.assert_allclose(still.rho, known.rho, rtol=0.05)
    assert float(table(pair(0.3), gap=0.08).required_gap[0]) > float(still.required_gap[0])
