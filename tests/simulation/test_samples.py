"""Motions on samples of what is not known exactly, against each sample alone and brute force."""

import numpy as np
import pytest
from cases import with_slow

import stochlin as sl

GROUND = sl.named_ground("firm", intensity=0.01)
SHAPE = sl.AminAng(2.0, 10.0, 0.5)
MOTION = {"duration": 15.0, "envelope": SHAPE}
SECOND = sl.Bilinear(0.6, 0.05, 0.05, yield_displacement=0.02)
STIFF = sl.Bilinear(0.1, 0.05)  # so that its period sets the steps
STRONG = {"yield_displacement": 0.03}


def spread(size):
    """Structures of every kind, with this spread of all that may be uncertain of them."""
    some = lambda median: sl.Uncertain(median, size)  # noqa: E731
    return {
        "bilinear": sl.Bilinear(some(1.0), some(0.05), 0.05, yield_displacement=some(0.03)),
        "reduction factor": sl.Bilinear(some(1.0), 0.05, some(0.05), reduction_factor=some(3.0)),
        "elastic": sl.Bilinear(some(1.0), some(0.05)),
        "bouc_wen": sl.BoucWen(some(1.0), 0.05, 0.1, **STRONG, beta=some(0.6), gamma=0.4),
        "storeys": sl.ShearBuilding.regular(
            period=some(0.8), storeys=3, storey_height=3.0, mass=some(2e5), damping=0.05,
            hardening=0.05, base_shear_coefficient=some(0.15),
        ),
        "stiffnesses": sl.ShearBuilding(
            [2e5] * 2, some([2e8, 1.5e8]), [3.0] * 2, 0.05, 0.05, some([0.01, 0.008])
        ),
    }  # fmt: skip


def sample(table, path):
    """Factors of one motion by parameter, where all are of one model."""
    names = [str(name).partition(".")[2] for name in table.input.values]
    return dict(zip(names, map(float, table.input_factor[path]), strict=True))


@pytest.mark.parametrize("kind", with_slow(spread(0.1), {"reduction factor"}))
def test_every_motion_is_that_of_its_sample_alone(kind):
    uncertain = spread(0.1)[kind]
    found = sl.simulate([uncertain, SECOND, STIFF], GROUND, paths=32, **MOTION)
    for path in (0, 17):
        alone = sl.simulate(
            [uncertain.at(sample(found, path)), SECOND, STIFF], GROUND, paths=32, **MOTION
        )
        exact = float(alone.separation[path, 0, 1])
        assert float(found.separation[path, 0, 1]) == pytest.approx(exact, rel=1e-6)


def test_every_motion_is_that_of_its_own_ground():
    first = sl.Bilinear(1.0, 0.05, 0.05, **STRONG)
    ground = sl.CloughPenzien(
        sl.Uncertain(0.4, 0.2), sl.Uncertain.between(0.4, 0.6), 4.0, 0.6, sl.Uncertain(0.01, 0.3)
    )
    found = sl.simulate([first, SECOND, STIFF], ground, paths=32, **MOTION)
    for path in (3, 20):
        own = ground.at(sample(found, path))
        alone = sl.simulate([first, SECOND, STIFF], own, paths=32, **MOTION)
        exact = float(alone.separation[path, 0, 1])
        assert float(found.separation[path, 0, 1]) == pytest.approx(exact, rel=1e-9)
    still = sl.KanaiTajimi(sl.Uncertain(0.4, 0.0), 0.5, 0.01)
    one, other = (
        sl.simulate([first, SECOND], each, paths=32, **MOTION).separation
        for each in (still, still.median())
    )
    np.testing.assert_allclose(one, other, rtol=1e-9, atol=1e-12)


def test_samples_are_those_of_the_distribution():
    """A Latin hypercube: one sample in each of as many equal parts."""
    first = sl.Bilinear(sl.Uncertain(1.0, 0.2), sl.Uncertain.between(0.03, 0.07))
    found = sl.simulate([first], GROUND, paths=256, **MOTION)
    period, damping = (
        found.input_factor.sel(input=f"structure_1.{n}").values for n in ("period", "damping")
    )
    shares = (np.arange(256) + 0.5) / 256
    np.testing.assert_allclose(np.sort(damping), 0.6 + 0.8 * shares, atol=0.8 / 256)
    assert np.log(period).std() == pytest.approx(0.2, rel=0.02)
    assert abs(np.corrcoef(period, damping)[0, 1]) < 4 / np.sqrt(256)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: sl.Uncertain(1.0, 20), "for 20 % write 0.2"),
        (lambda: sl.Uncertain("long", 0.1), "median = 'long'; allowed: a number"),
        (lambda: sl.Uncertain(np.inf, 0.1), "allowed: finite numbers"),
        (lambda: sl.Uncertain(1.0, 0.1, "normal"), "allowed: lognormal, uniform"),
        (lambda: sl.Uncertain.between(1.2, 0.8), "allowed: 0 < lower <= higher"),
        (lambda: sl.Bilinear(sl.Uncertain(-1.0, 0.1), 0.05), "period = -1 is out of range"),
        (lambda: sl.Bilinear(1.0, sl.Uncertain(0.5, 0.5)), "less spread, or another kind"),
        (lambda: sl.Bilinear(sl.Uncertain.between(0.0, 1.0), 0.05), "allowed: 0 < lower <= higher"),
        (lambda: sl.linearize(spread(0.1)["elastic"], GROUND), r"give its median\(\)"),
        (lambda: sl.correlate(spread(0.1)["elastic"], SECOND, GROUND), r"give its median\(\)"),
    ],
)
def test_what_cannot_be_uncertain_is_named(make, told):
    with pytest.raises((ValueError, TypeError), match=told):
        make()
