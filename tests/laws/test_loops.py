"""Loops of structures along a prescribed displacement."""

import numpy as np
import pytest

import stochlin as sl

pytestmark = pytest.mark.oracle

GIVEN = {"period": 0.5, "damping": 0.05, "hardening": 0.1, "yield_displacement": 0.02}
SQUARE = (2 * np.pi / GIVEN["period"]) ** 2


def test_the_bilinear_loop_is_a_parallelogram():
    """Its area is that of the rectangle of the slips; the force at the turns is known by hand."""
    loop = sl.hysteresis_loop(sl.Bilinear(**GIVEN), [0.06, -0.06, 0.06], refine=60)
    force = loop.force_per_mass[::60] / SQUARE
    np.testing.assert_allclose(force, [0.0, 0.024, -0.024, 0.024], atol=1e-12)
    work = np.diff(loop.hysteretic_work_per_mass[::60])
    np.testing.assert_allclose(work[1:].sum(), 4 * 0.9 * SQUARE * 0.02 * 0.04, rtol=1e-3)


def test_an_elastic_structure_has_a_line():
    loop = sl.hysteresis_loop(sl.Flag(0.5, 0.05), [0.1, -0.2])
    np.testing.assert_allclose(loop.force_per_mass, SQUARE * loop.displacement, rtol=1e-12)
    assert np.isnan(loop.z).all()
    assert float(loop.hysteretic_work_per_mass[-1]) == 0


def test_the_loop_of_a_record_is_that_of_its_displacements():
    """The response to a record and a test with the same displacements have the same z and work."""
    structure = sl.ModifiedClough(**GIVEN)
    record = sl.simulated_motions(sl.KanaiTajimi(0.4, 0.6, 0.02), 5.0, paths=2, seed=3)[0]
    table = sl.respond(structure, record, refine=8)
    loop = sl.hysteresis_loop(structure, table.displacement[1:], refine=1)
    np.testing.assert_allclose(loop.z, table.z, atol=2e-3)


@pytest.mark.parametrize(
    ("structure", "displacement", "message"),
    [
        (
            sl.Bilinear(0.5, 0.05, 0.1, reduction_factor=2),
            [0.1, 0.2],
            "allowed: its yield_displacement",
        ),
        (sl.Bilinear([0.5, 0.6], 0.05), [0.1, 0.2], "period is an array"),
        (sl.Bilinear(0.5, 0.05), [0.1], "displacement = .*allowed: two or more finite numbers"),
        (sl.Bilinear(0.5, 0.05), [0.1, np.nan], "allowed: two or more finite numbers in metres"),
    ],
)
def test_what_is_wrong_is_said(structure, displacement, message):
    with pytest.raises(ValueError, match=message):
        sl.hysteresis_loop(structure, displacement)
