"""A wrong number is named with its value and what is allowed; in tables it spoils its cell only."""

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

pytestmark = [pytest.mark.invariant, pytest.mark.extreme]

STRUCTURE = {"period": 1.0, "damping": 0.05, "hardening": 0.1, "reduction_factor": 3.0}
GROUND = {"period": 1.0, "damping": 0.3, "intensity": 1.0}
SOIL = sl.KanaiTajimi(**GROUND)

MASKED = np.ma.masked_array([1, 9], [False, True])


def test_masked_numbers_are_missing_ones():
    """What stands below a mask is a bad cell, or refused as what is no number."""
    table = sl.linearize(sl.Bilinear(MASKED, 0.05), SOIL)
    assert table.status.values.tolist() == [1, 3]
    assert np.isnan(sl.ImpactKelvin(1e8, restitution=0.5 * MASKED).e).values.tolist() == [
        False,
        True,
    ]
    assert np.isnan(SOIL.psd(MASKED)).values.tolist() == [False, True]
    for call in (
        lambda: sl.HazardCurve(MASKED, [0.1, 0.01]),
        lambda: sl.ModalBuilding([0.5], [MASKED], [1e5] * 2, [3.0] * 2, 0.05),
        lambda: sl.ModalBuilding([0.5], [[0.9, 1.0]], 1e5 * MASKED, [3.0] * 2, 0.05),
        lambda: sl.Uncertain(MASKED, 0.1),
        lambda: sl.hysteresis_loop(sl.Bilinear(1.0, 0.05), MASKED),
        lambda: sl.Bilinear(np.ma.masked, 0.05),
    ):
        with pytest.raises(ValueError, match=r"nan|masked_array.*; allowed: .*finite"):
            call()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"damping": 5}, r"damping = 5 .*a ratio, 0\.05 for 5 %"),
        ({"damping": 1}, r"damping = 1 .*value < 1"),
        ({"hardening": -1}, "hardening = -1 .*a stationary response needs more than 0"),
        ({"hardening": 1.2}, "hardening = 1.2 .*value <= 1"),
        ({"hardening": None}, "hardening is not given"),
        ({"yield_displacement": 0.1}, "yield_displacement and reduction_factor; allowed: one"),
        ({"period": 1e-200}, "period = 1e-200 is out of range; allowed: 1e-09 <= value <= 1e"),
    ],
    ids=str,
)
def test_mistake_of_the_trade_is_explained(change, message):
    with pytest.raises(ValueError, match=message):
        sl.Bilinear(**STRUCTURE | change)


def labelled(values, labels):
    return xr.DataArray(np.array(values), dims="x", coords={"x": labels})


def test_arrays_that_do_not_fit_together_are_refused():
    with pytest.raises(ValueError, match=r"Bilinear: .*share a dimension"):
        sl.Bilinear([1.0, 2.0], [0.05, 0.05, 0.05])
    with pytest.raises(ValueError, match=r"Bilinear: .*share a dimension"):
        sl.Bilinear(labelled([1.0, 2.0], [0, 1]), labelled([0.05, 0.05], [0, 2]))
    with pytest.raises(ValueError, match="structure and ground"):
        sl.linearize(
            sl.Bilinear(labelled([1.0, 2.0], [0, 1]), 0.05),
            sl.KanaiTajimi(labelled([1.0, 2.0], [0, 2]), 0.3),
        )
    with pytest.raises(ValueError, match="structure and ground"):
        sl.linearize(sl.Bilinear([1.0, 2.0], 0.05), sl.KanaiTajimi([1.0, 2.0, 3.0], 0.3))
    for other in ([1.0, 2.0, 3.0], labelled([1.0, 2.0], [0, 2])):
        mine = [1.0, 2.0] if isinstance(other, list) else labelled([1.0, 2.0], [0, 1])
        with pytest.raises(ValueError, match="first, second and ground share a dimension"):
            sl.correlate(sl.Bilinear(mine, 0.05), sl.Bilinear(other, 0.05), SOIL)


@pytest.mark.parametrize("closure", ["gaussian", "clipped"])
def test_lone_case_that_does_not_converge_raises_with_the_cure(closure):
    structure = sl.Bilinear(**STRUCTURE)
    with pytest.raises(
        ArithmeticError, match=r"Bilinear \(period 1 s.*not converged; raise max_iterations"
    ):
        sl.linearize(structure, SOIL, closure, max_iterations=1)
    with pytest.raises(ArithmeticError, match="not converged; raise max_iterations"):
        sl.correlate(structure, structure, SOIL, closure=closure, max_iterations=1)


def test_an_array_in_another_unit_is_refused():
    """Its values would be taken for metres: a 5 cm gap for one of 5 m, which is always enough."""
    values = xr.DataArray([0.05, 0.08], dims="x")
    samples = xr.DataArray([0.1, 0.2], dims="path")
    for units, call, message in (
        (
            "cm",
            lambda gap: sl.exceedance(samples, gap),
            "gap is in 'cm', .*; allowed: m, so convert",
        ),
        ("ft", lambda uy: sl.Bilinear(1.0, 0.05, 0.1, uy), "yield_displacement is in 'ft'"),
        (
            "ms",
            lambda period: sl.Bilinear(period, 0.05),
            "Bilinear: period is in 'ms', .* allowed: s,",
        ),
        (
            "%",
            lambda damping: sl.Bilinear(1.0, damping),
            "Bilinear: damping is in '%', .* allowed: 1,",
        ),
    ):
        with pytest.raises(ValueError, match=message):
            call(values.assign_attrs(units=units))
        assert call(values.assign_attrs(units="1"))  # kept by arithmetic with a ratio in front


def test_an_array_in_the_unit_of_the_parameter_is_taken_however_it_is_spelled():
    for units in ("s", "sec", "seconds"):
        period = xr.DataArray([0.5, 1.0], dims="period", attrs={"units": units})
        assert sl.linearize(sl.Bilinear(period, 0.05), SOIL).displacement_std.notnull().all()
