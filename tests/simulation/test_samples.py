"""Motions on samples of what is not known exactly, against each sample by itself and brute force."""

import numpy as np
import pytest
from cases import with_slow

import stochlin as sl
from stochlin.solver.simulation.finite_motions import required_gaps

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


@pytest.mark.slow
def test_required_gap_of_uncertain_periods_is_that_of_brute_force():
    """Sixty-four pairs of periods, each simulated by itself with other motions."""
    first, second = (
        sl.Bilinear(sl.Uncertain(T, 0.25), 0.05, 0.05, yield_displacement=0.03) for T in (0.6, 1.0)
    )
    table = sl.separation(first, second, GROUND, paths=1024, **MOTION)
    random, samples = np.random.default_rng(5), []
    for seed in range(64):
        pair = [
            one.at({"period": float(np.exp(0.25 * random.standard_normal()))}) for one in (first, second)
        ]
        motions = sl.simulate(pair, GROUND, paths=32, seed=100 + seed, **MOTION)
        samples.append(motions.separation[:, 0, 1].values)
    counted = np.mean(np.array(samples) <= float(table.gap[0]), axis=1)
    error = np.hypot(counted.std(ddof=1) / 8, np.sqrt(0.09 / 1024))
    assert abs(counted.mean() - 0.9) < 4 * error
    known = sl.separation(first.median(), second.median(), GROUND, paths=1024, **MOTION)
    assert float(table.gap[0]) > 1.05 * float(known.gap[0])  # what is not known costs


@pytest.mark.slow
def test_the_interval_of_a_gap_with_uncertain_periods_contains_it_as_often_as_it_says():
    """Two hundred seeds against one run of as many motions as half of them together."""
    pair = [sl.Bilinear(sl.Uncertain(T, 0.25), 0.05, 0.05, yield_displacement=0.03) for T in (0.6, 1.0)]
    motion = {"duration": 8.0, "envelope": sl.AminAng(2.0, 5.0, 0.5)}

    def gaps(paths, seed):
        return required_gaps(
            sl.simulate(pair, GROUND, paths=paths, seed=seed, quantiles=[0.9], **motion)
        )

    table = sl.separation(*pair, GROUND, paths=64, seed=3, **motion)
    answer = [float(table[name][0]) for name in ("gap", "gap_lower", "gap_upper")]
    assert gaps(64, 3) == pytest.approx(answer, rel=1e-12)
    exact, *_ = gaps(6400, 900)
    intervals = np.array([gaps(64, seed)[1:] for seed in range(200)])
    covered = ((intervals[:, 0] <= exact) & (exact <= intervals[:, 1])).mean()
    # Order statistics are a little more careful than they say; 0.98 with these seeds.
    assert abs(covered - 0.95) < 3 * np.sqrt(0.95 * 0.05 / 200)


@pytest.mark.parametrize(
    ("make", "told"),
    [
        (lambda: sl.Uncertain(1.0, -0.1), "spread = -0.1; allowed: 0 to 1"),
        (lambda: sl.Uncertain(1.0, 20), "for 20 % write 0.2"),
        (lambda: sl.Uncertain("long", 0.1), "median = 'long'; allowed: a number"),
        (lambda: sl.Uncertain(np.inf, 0.1), "allowed: finite numbers"),
        (lambda: sl.Uncertain(1.0, 0.1, "normal"), "allowed: lognormal, uniform"),
        (lambda: sl.Uncertain.between(1.2, 0.8), "two positive numbers, the lower first"),
        (lambda: sl.Bilinear(sl.Uncertain(-1.0, 0.1), 0.05), "period = -1 is out of range"),
        (lambda: sl.Bilinear(1.0, sl.Uncertain(0.5, 0.5)), "less spread, or another kind"),
        (lambda: sl.Bilinear(sl.Uncertain.between(0.0, 1.0), 0.05), "two positive numbers"),
        (lambda: sl.linearize(spread(0.1)["elastic"], GROUND), r"give its median\(\)"),
        (lambda: sl.correlate(spread(0.1)["elastic"], SECOND, GROUND), r"give its median\(\)"),
    ],
)
def test_what_cannot_be_uncertain_is_named(make, told):
    with pytest.raises((ValueError, TypeError), match=told):
        make()
