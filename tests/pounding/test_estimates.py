"""The estimate from energies: storeys by their first mode, chains of hits, its error in motions."""

import numpy as np
import pounding_estimates as benchmark
import pytest
import xarray as xr

import stochlin as sl

BLOW = sl.Stereomechanical(0.65)
CONTACT = sl.Kelvin(5e8, restitution=0.65)
ROW = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((1.2, 2e5), (0.6, 4e5), (0.9, 3e5))]
RADII = [0.1, 0.06, 0.08]
TOWER = sl.ShearBuilding([3e5] * 4, [3e8, 2.5e8, 2e8, 1e8], [3.5] * 4, 0.05)
ANNEX = sl.ShearBuilding([2e5] * 3, [4e8] * 3, [3.5, 3.5, 3.0], 0.05)
MOTIONS = sl.simulated_motions(sl.named_ground("firm", intensity=0.01), 8.0, paths=6, seed=2)


def grown(first, second, gap, one, two):
    hit = sl.pounding_estimate(first, second, gap, BLOW, one, two)
    return [float(hit[f"largest_radius_amplification_{n}"]) for n in (1, 2)]


@pytest.mark.invariant
def test_a_row_of_two_is_the_pair():
    radii = xr.DataArray([0.05, 0.1, -1.0], dims="case")
    pair = sl.pounding_estimate(*ROW[:2], 0.02, BLOW, radii, 0.06)
    row = sl.pounding_estimate_row(ROW[:2], 0.02, BLOW, [radii, 0.06])
    for side in (0, 1):
        wanted = pair[f"largest_radius_amplification_{side + 1}"]
        found = row.radius_amplification.isel(neighbours=0, side=side)
        np.testing.assert_array_equal(found, wanted)
        one, chain = (
            row[f"{name}_radius_amplification"].isel(structure=side) for name in ("largest", "chain")
        )
        np.testing.assert_array_equal(one, np.maximum(wanted, 1.0))
        np.testing.assert_array_equal(chain, one)
    assert row.status.values.tolist() == [0, 0, 3]


@pytest.mark.invariant
@pytest.mark.parametrize("contact", [BLOW, CONTACT])
def test_the_estimate_of_a_history_is_that_of_the_row_with_its_energy_radii(contact):
    """Structures that yield and that do not, and a gap too wide for a hit."""
    motion, gaps = MOTIONS.isel(path=0), [0.02, 0.0, 0.5]
    yields = sl.Bilinear(0.8, 0.03, 0.1, yield_displacement=0.01, mass=2.5e5)
    structures = [ROW[0], yields, *ROW[1:]]
    radii = []
    for each in structures:
        strength = {"hardening": 0.1, "yield_displacement": 0.01} if each is yields else {}
        table = sl.pseudo_energy_radius(motion, each.period, each.damping, **strength)
        radii.append(float(table.pseudo_energy_radius))
    wanted = sl.pounding_estimate_row(structures, gaps, contact, radii).largest_radius_amplification
    found = sl.pound(structures, gaps, contact, motion).largest_radius_amplification
    np.testing.assert_array_equal(found, wanted)
    assert float(wanted[1]) > 1


@pytest.mark.slow
@pytest.mark.invariant
def test_a_period_that_is_too_short_for_the_motion_has_no_estimate_and_spoils_that_of_its_neighbours():
    motion = MOTIONS.isel(path=0)
    stiff = sl.Bilinear(0.09 * float(motion.time[1] - motion.time[0]), 0.05, mass=3e5)
    table = sl.pound([*ROW, stiff], [0.02, 0.02, 0.02], CONTACT, motion)
    assert np.isnan(table.largest_radius_amplification).values.tolist() == [False, False, True, True]
    assert np.isfinite(table.peak).all()


@pytest.mark.oracle
def test_a_chain_is_hit_after_hit_with_the_radii_that_they_leave():
    row = sl.pounding_estimate_row(ROW, [0.02, 0.03], BLOW, RADII)
    one, two = grown(ROW[0], ROW[1], 0.02, RADII[0], RADII[1])
    then, three = grown(ROW[1], ROW[2], 0.03, two * RADII[1], RADII[2])
    from_left = [one, max(two, two * then), three]
    other, last = grown(ROW[1], ROW[2], 0.03, RADII[1], RADII[2])
    first, again = grown(ROW[0], ROW[1], 0.02, RADII[0], other * RADII[1])
    from_right = [first, max(other, other * again), last]
    wanted = np.maximum(np.maximum(from_left, from_right), 1.0)
    np.testing.assert_allclose(row.chain_radius_amplification, wanted, rtol=1e-14)
    np.testing.assert_allclose(
        row.largest_radius_amplification, np.maximum([one, max(two, other), last], 1.0), rtol=1e-14
    )
    assert (row.chain_radius_amplification >= row.largest_radius_amplification).all()
    assert (row.chain_radius_amplification > row.largest_radius_amplification).any()
    mirrored = sl.pounding_estimate_row(ROW[::-1], [0.03, 0.02], BLOW, RADII[::-1])
    np.testing.assert_allclose(mirrored.chain_radius_amplification[::-1], wanted, rtol=1e-12)


@pytest.mark.invariant
def test_a_row_out_of_reach_is_not_amplified():
    row = sl.pounding_estimate_row([*ROW, TOWER], [1.0] * 3, BLOW, [*RADII, 0.1])
    for name in ("largest", "chain"):
        assert (row[f"{name}_radius_amplification"] == 1).all()


@pytest.mark.invariant
def test_one_storey_is_an_oscillator():
    stiffness = 3e5 * (2 * np.pi / 0.8) ** 2
    hut = sl.ShearBuilding([3e5], [stiffness], [4.0], 0.05)
    as_hut = sl.pounding_estimate(hut, ROW[1], 0.02, BLOW, 0.08, 0.06)
    alone = sl.pounding_estimate(sl.Bilinear(0.8, 0.05, mass=3e5), ROW[1], 0.02, BLOW, 0.08, 0.06)
    for name in ("radius_amplification_1", "velocity_after_2", "energy_lost"):
        found = as_hut[name].isel(contact=0)
        np.testing.assert_allclose(found, alone[name].transpose(*found.dims), rtol=1e-12)


@pytest.mark.oracle
def test_a_hit_at_a_storey_takes_from_the_modes_what_eq_13_says():
    """Modal energies before and after, with the generalised mass and shape written down again."""
    radii = (0.08, 0.05)
    hit = sl.pounding_estimate(TOWER, ANNEX, 0.01, BLOW, *radii)
    assert hit.level.values.tolist() == [3.5, 7.0, 10.0, 10.5][: hit.sizes["contact"]]
    lost = 0.0
    for n, (building, radius) in enumerate(zip((TOWER, ANNEX), radii, strict=True), start=1):
        w, shapes = building._modes()
        masses = building.arrays()["masses"].to_numpy()
        shape = building.participation().to_numpy()
        assert np.allclose(shape / shape[-1], shapes[:, 0] / shapes[-1, 0])
        modal = shape @ (masses * shape)
        growth = hit[f"radius_amplification_{n}"]
        lost = lost - 0.5 * modal * w[0] ** 2 * radius**2 * (growth**2 - 1)
        if n == 1:  # velocities of a level, from the mode's own
            floor = int(hit.floor_left[1]) - 1
            before = hit.velocity_before_1.isel(contact=1).max() / shape[floor]
            assert float(before) <= w[0] * radius * (1 + 1e-12)
    lost, wanted = xr.broadcast(lost, hit.energy_lost)
    np.testing.assert_allclose(lost, wanted, rtol=1e-8, atol=1e-8 * float(wanted.max()))


@pytest.mark.oracle
def test_what_pounding_does_is_what_pound_finds():
    error = sl.pounding_estimate_error(ROW, [0.02, 0.02], CONTACT, MOTIONS)
    many = sl.pound(ROW, [0.02, 0.02], CONTACT, MOTIONS)
    np.testing.assert_allclose(error.peak_amplification, many.amplification, rtol=1e-12)
    impacts = many.impacts.values
    wanted = np.stack([impacts[:, 0], impacts.sum(axis=1), impacts[:, 1]], axis=1)
    np.testing.assert_array_equal(error.hits, wanted)
    for n, structure in enumerate(ROW):
        radius = [
            float(sl.pseudo_energy_radius(each, structure.period, 0.05).pseudo_energy_radius)
            for each in MOTIONS
        ]  # the largest may lie between samples, 0.01 s apart
        np.testing.assert_allclose(error.radius_alone.isel(structure=n), radius, rtol=5e-3)
        told = sl.pounding_estimate_row(
            ROW, [0.02, 0.02], CONTACT, list(error.radius_alone.isel(path=0).values), points=91
        )
        assert told.chain_radius_amplification[n] == error.chain_radius_amplification[0, n]


@pytest.mark.invariant
def test_storeys_have_the_radius_of_their_first_mode():
    error = sl.pounding_estimate_error([TOWER, ANNEX], 0.005, CONTACT, MOTIONS)
    for n, building in enumerate((TOWER, ANNEX)):
        mode = building.oscillator()
        radius = [
            float(sl.pseudo_energy_radius(each, mode.period, 0.05).pseudo_energy_radius)
            for each in MOTIONS
        ]
        np.testing.assert_allclose(error.radius_alone.isel(structure=n), radius, rtol=1e-2)
    assert (error.peak_radius_amplification > 0.3).all()


@pytest.mark.invariant
def test_bias_scatter_and_share_are_those_of_the_motions_with_hits():
    error = sl.pounding_estimate_error(ROW[:2], 0.09, CONTACT, MOTIONS)
    hit = (error.hits > 0).values[:, 0]
    assert 1 < hit.sum() < 6
    log = np.log(error.largest_radius_amplification / error.peak_amplification).values[hit, 0]
    one = error.sel(structure=1, of="displacement", estimate="one hit")
    assert int(one.motions_with_hits) == hit.sum()
    assert float(one.estimate_bias) == pytest.approx(log.mean(), rel=1e-12)
    assert float(one.estimate_scatter) == pytest.approx(log.std(ddof=1), rel=1e-12)
    assert float(one.exceeded_probability) == pytest.approx((log < 0).mean(), rel=1e-12)
    assert one.exceeded_probability_lower <= one.exceeded_probability <= one.exceeded_probability_upper
    apart = sl.pounding_estimate_error(ROW[:2], 5.0, CONTACT, MOTIONS)
    assert apart.estimate_bias.isnull().all()
    assert apart.exceeded_probability.isnull().all()


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        ({"structures": ROW[:1]}, ValueError, "structures = .*at least two"),
        ({"structures": [*ROW[:2], sl.Bilinear(1.0, 0.05)]}, ValueError, "number 3: mass is not given"),
        ({"structures": [*ROW[:2], 3]}, TypeError, "structures, number 3 = 3"),
        ({"gaps": [0.02]}, ValueError, "2 in all"),
        ({"radii": [0.1, 0.1]}, ValueError, "radii = .*allowed: a list of 3"),
        ({"radii": 0.1}, ValueError, "radii = 0.1; allowed: a list of 3"),
        ({"radii": [0.1, 0.1, -0.1]}, ValueError, "radii, number 3 = -0.1"),
        ({"radii": [[0.1, 0.2], [0.1] * 3, 0.1]}, ValueError, "radii: their dimensions do not fit"),
        ({"contact": 0.5}, TypeError, "contact = 0.5"),
    ],
)
def test_what_cannot_be_estimated_in_a_row_is_refused(change, error, message):
    usual = {"structures": ROW, "gaps": [0.02, 0.02], "contact": BLOW, "radii": RADII}
    with pytest.raises(error, match=message):
        sl.pounding_estimate_row(**(usual | change))


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"structures": ROW[:1], "gaps": ()}, "structures has one building; allowed: at least two"),
        ({"contact": None}, "contact is not given"),
        ({"motion": MOTIONS[0]}, "motion: only one is given; allowed: two or more"),
        ({"motion": [MOTIONS[0]]}, "motion: only one is given; allowed: two or more"),
        ({"points": 1}, "points = 1"),
    ],
)
def test_an_error_of_nothing_is_refused(change, message):
    usual = {"structures": ROW[:2], "gaps": [0.02], "contact": CONTACT, "motion": MOTIONS}
    with pytest.raises(ValueError, match=message):
        sl.pounding_estimate_error(**(usual | change))


# What is said of the error: bias and share exceeded, one hit and chain, of the largest displacement.
SAID = {
    ("two oscillators", False): [(0.264, 0.018, 0.130)],
    ("two oscillators", True): [(0.204, 0.015, 0.182)],
    ("two buildings with storeys", False): [(0.349, 0.010, 0.0)],
    ("two buildings with storeys", True): [(0.265, 0.010, 0.006)],
    ("three oscillators", False): [(0.320, 0.017, 0.092), (0.423, 0.018, 0.045)],
    ("three oscillators", True): [(0.277, 0.016, 0.141), (0.375, 0.017, 0.064)],
}
ROWS_OF = {"two oscillators": 14, "two buildings with storeys": 5, "three oscillators": 8}


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.parametrize("kind", SAID, ids=lambda kind: f"{kind[0]}, {benchmark.YIELDS[kind[1]]}")
def test_other_rows_have_the_error_that_is_said(kind):
    """Within four standard errors of both; of a share by the binomial, with rows as its number."""
    rows = ROWS_OF[kind[0]]
    logs = benchmark.logarithms(kind, rows, seed=11)
    for estimate, (bias, error, share) in enumerate(SAID[kind]):
        found, own_error, scatter, exceeded, _ = benchmark.figures(logs[..., estimate, 0])
        assert abs(found - bias) < 4 * np.hypot(error, own_error)
        assert 0.1 < scatter < 0.45
        spread = np.sqrt(max(share, 0.02) * (1 - share) * (1 / rows + 1 / benchmark.ROWS))
        assert abs(exceeded - share) < 4 * spread


@pytest.mark.slow
@pytest.mark.paper
@pytest.mark.parametrize(
    ("yields", "said"),
    [(False, ((-0.064, 0.007), (-0.077, 0.005))), (True, ((-0.020, 0.005), (-0.079, 0.006)))],
)
def test_a_bumper_makes_the_estimate_smaller_and_the_truth_in_the_mean(yields, said):
    """The smaller restitution of a bumper leads to smaller amplifications, says the paper."""
    changes = benchmark.effect_of_bumper(("two oscillators", yields), 14, seed=5)
    assert changes[:, 2].max() <= 1e-12
    for column, (mean, error) in enumerate(said):
        own = changes[:, column].std(ddof=1) / np.sqrt(len(changes))
        assert abs(changes[:, column].mean() - mean) < 4 * np.hypot(error, own)
