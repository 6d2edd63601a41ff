"""Strength for a ductility: by another root finder, in exact limits, and back again."""

import cases
import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.solver.linearization.strength import strength_in_metres

pytestmark = [pytest.mark.oracle, pytest.mark.extreme]

GROUND = sl.KanaiTajimi(1.0, 0.3)
CELLS = 60


def draw(seed, domain=cases.PRACTICE):
    rng = np.random.default_rng([9, seed])
    structure = cases.draw_structure(rng, domain, CELLS)
    del structure["reduction_factor"]
    return structure, cases.draw_ground(rng, domain, CELLS)


@pytest.mark.parametrize("closure", ["gaussian", "clipped", "drift"])
@pytest.mark.parametrize("domain", [cases.PRACTICE, cases.BEYOND], ids=["practice", "beyond"])
def test_the_strength_found_has_the_ductility(closure, domain):
    structure, ground = draw(1, domain)
    target = xr.DataArray([0.5, 1.0, 3.0, 8.0], dims="target")
    table = sl.strength_for_ductility(
        sl.Bilinear(**structure), sl.KanaiTajimi(**ground), target, closure=closure
    )
    found = table.status < 2
    # with the clipped closure some fixed points near a jump do not converge
    assert float(found.mean()) > (0.999 if closure == "gaussian" else 0.98)
    again = sl.linearize(
        sl.Bilinear(**structure, yield_displacement=table.yield_displacement.where(found, 1.0)),
        sl.KanaiTajimi(**ground),
        closure,
    )
    reached = (3 * again.ductility_std / target).where(found, 1.0)
    np.testing.assert_allclose(reached, 1, rtol=1e-8)
    assert (np.isnan(table.reduction_factor) == ~found).all()


def test_elastic_structure_has_the_ductility_of_its_reduction_factor():
    """Far from yielding: ``mu = R``, exactly."""
    structure, ground = draw(4)
    table = sl.strength_for_ductility(sl.Bilinear(**structure), sl.KanaiTajimi(**ground), 0.05)
    np.testing.assert_allclose(table.reduction_factor, 0.05, rtol=1e-10)


def test_peak_factor_is_the_structures_unless_given():
    high = sl.strength_for_ductility(sl.Bilinear(0.5, 0.05, 0.05, peak_factor=4.0), GROUND, 4.0)
    given = sl.strength_for_ductility(sl.Bilinear(0.5, 0.05, 0.05), GROUND, 4.0, peak_factor=4.0)
    usual = sl.strength_for_ductility(sl.Bilinear(0.5, 0.05, 0.05), GROUND, 4.0)
    assert float(high.yield_displacement) == float(given.yield_displacement)
    assert float(high.yield_displacement) > float(usual.yield_displacement)
    assert float(given.ductility_std) == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize(
    ("ground", "unsafe"),
    [(sl.KanaiTajimi(0.42, 0.6), 5.8), (sl.KanaiTajimi(2.0, 0.05), 15.0)],
    ids=["broad band", "lake bed"],
)
def test_simulated_the_strength_has_the_ductility_that_was_asked_for(ground, unsafe):
    """The Gaussian closure gives a strength with ductility much larger than the 4 asked for."""
    building = sl.Bilinear(0.6, 0.05, 0.05)
    drifting, gaussian = (
        sl.strength_for_ductility(building, ground, 4.0, closure=c) for c in ("drift", "gaussian")
    )
    strengths = [float(table.yield_displacement) for table in (drifting, gaussian)]
    found = sl.simulate(
        [sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=uy) for uy in strengths], ground, paths=64
    )
    true = 3 * found.ductility_std.values
    assert true[0] == pytest.approx(4.0, rel=0.06)
    assert true[1] > unsafe
    assert (int(drifting.caution), int(gaussian.caution)) == (0, 1)
    assert float(gaussian.bias) == pytest.approx(4.0 / true[1] - 1, abs=0.05)
    assert "too small" in gaussian.attrs["comment"]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"structure": sl.Bilinear(1.0, 0.05)}, "hardening is not given"),
        ({"structure": sl.Bilinear(np.ones(2), 0.05, 0.1), "ductility": np.ones(3)}, "share a dim"),
    ],
)
def test_bad_arguments_are_refused(change, message):
    arguments = {"structure": sl.Bilinear(1.0, 0.05, 0.1), "ground": GROUND, "ductility": 4.0}
    with pytest.raises(ValueError, match=message):
        sl.strength_for_ductility(**arguments | change)


def test_reduction_factor_and_yield_displacement_are_inverse():
    structure, ground = draw(5)
    r = np.random.default_rng(5).uniform(0.5, 8, CELLS)
    soil = sl.KanaiTajimi(**ground)
    uy = sl.linearize(sl.Bilinear(**structure, reduction_factor=r), soil).yield_displacement
    back = sl.reduction_factor(sl.Bilinear(**structure, yield_displacement=uy), soil)
    np.testing.assert_allclose(back.reduction_factor, r, rtol=1e-13)
    same = sl.reduction_factor(sl.Bilinear(**structure, reduction_factor=r), soil)
    np.testing.assert_allclose(same.reduction_factor, r, rtol=1e-13)


def test_reduction_factor_needs_a_strength():
    with pytest.raises(ValueError, match="has no strength"):
        sl.reduction_factor(sl.Bilinear(1.0, 0.05), GROUND)


@pytest.mark.parametrize("intensity", [1e-320, 1e308])
def test_what_is_too_extreme_is_said_in_terms_of_what_was_given(intensity):
    structure = sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4)
    ground = sl.named_ground("firm", intensity=intensity)
    with pytest.raises(ArithmeticError, match=r"Bilinear \(period 1 s.*ductility.4") as caught:
        sl.strength_for_ductility(structure, ground, 4.0)
    assert "DuctilityTarget" not in str(caught.value)
    if intensity > 1:
        with pytest.raises(
            ArithmeticError, match=r"elastic response of Bilinear \(.*cannot|beyond"
        ):
            strength_in_metres(structure, ground)
