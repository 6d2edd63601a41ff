"""The estimate from energies: storeys by their first mode, rows in a motion, the error in motions."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

BLOW = sl.Stereomechanical(0.65)
CONTACT = sl.Kelvin(5e8, restitution=0.65)
ROW = [sl.Bilinear(T, 0.05, mass=m) for T, m in ((1.2, 2e5), (0.6, 4e5), (0.9, 3e5))]
TOWER = sl.ShearBuilding([3e5] * 4, [3e8, 2.5e8, 2e8, 1e8], [3.5] * 4, 0.05)
ANNEX = sl.ShearBuilding([2e5] * 3, [4e8] * 3, [3.5, 3.5, 3.0], 0.05)
MOTIONS = sl.simulated_motions(sl.named_ground("firm", intensity=0.01), 8.0, paths=6, seed=2)


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


def pair(rng, yields):
    """Two oscillators, their gap and two motions; strengths are a quarter of the elastic demand."""
    ground, shape = sl.named_ground("firm", intensity=0.01), sl.AminAng(2.0, 8.0, 0.5)
    seed = int(rng.integers(2**31))
    motions = sl.simulated_motions(ground, 12.0, envelope=shape, paths=2, seed=seed)
    both, radii = [], []
    for _ in range(2):
        period = np.exp(rng.uniform(np.log(0.3), np.log(2.0)))
        elastic = sl.Bilinear(period, 0.05, mass=1e6 * 10 ** rng.uniform(-0.5, 0.5))
        each = [sl.pseudo_energy_radius(m, period, 0.05).pseudo_energy_radius for m in motions]
        radii.append(float(np.mean(each)))
        strength = {"hardening": 0.05, "yield_displacement": radii[-1] / 4} if yields else {}
        both.append(replace(elastic, **strength))
    return both, rng.uniform(0.05, 0.4) * np.hypot(*radii), motions


def amplifications(structures, gap, contact, motions):
    """Computed and estimated, over motions and structures; NaN in motions without an impact."""
    each = [sl.pound(structures, gap, contact, motion) for motion in motions]
    both = []
    for motion, table in zip(motions, each, strict=True):
        strengths = (
            {"hardening": s.hardening, "yield_displacement": s.yield_displacement} if s.yields else {}
            for s in structures
        )
        radii = [
            float(sl.pseudo_energy_radius(motion, s.period, 0.05, **strength).pseudo_energy_radius)
            for s, strength in zip(structures, strengths, strict=True)
        ]
        hit = sl.pounding_estimate(*structures, gap, contact, *radii)
        estimate = [max(1.0, float(hit[f"largest_radius_amplification_{n}"])) for n in (1, 2)]
        both.append([table.amplification.values, estimate])
    met = np.array([int(hit.impacts.sum()) > 0 for hit in each])
    return np.where(met[:, None], np.moveaxis(np.array(both), 1, 0), np.nan)


def mean_and_error(logs):
    """Over pairs, motions and structures; the error is from the scatter between pairs."""
    each = np.nanmean(logs[~np.isnan(logs).all(axis=(1, 2))], axis=(1, 2))
    return each.mean(), each.std(ddof=1) / np.sqrt(each.size)


# With standard errors, from 60 pairs: bias of the estimate, and what a bumper changes, as logarithms.
SAID = {
    False: ((0.264, 0.018), (-0.064, 0.007), (-0.077, 0.005)),
    True: ((0.204, 0.015), (-0.020, 0.005), (-0.079, 0.006)),
}


@pytest.mark.slow
@pytest.mark.paper
@pytest.mark.parametrize("yields", SAID, ids=["elastic", "yielding"])
def test_the_estimate_has_the_error_that_is_said_and_a_bumper_makes_it_smaller(yields):
    """The smaller restitution of a bumper leads to smaller amplifications, says the paper."""
    rng, bumper = np.random.default_rng(11), sl.Kelvin(5e8, restitution=0.3)
    logs = []
    for _ in range(14):
        structures, gap, motions = pair(rng, yields)
        without, with_it = (
            np.log(amplifications(structures, gap, contact, motions)) for contact in (CONTACT, bumper)
        )
        logs.append([without[1] - without[0], *(with_it - without)])
    logs = np.array(logs)
    assert np.nanmax(logs[:, 2]) <= 1e-12
    for column, (said, error) in enumerate(SAID[yields]):
        mean, own = mean_and_error(logs[:, column])
        assert abs(mean - said) < 4 * np.hypot(error, own)
