"""The estimate from energies has the error that is said, in motions."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import stochlin as sl

CONTACT = sl.Kelvin(5e8, restitution=0.65)


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
    table = sl.pound(structures, gap, contact, motions)
    radii = []
    for s in structures:
        own = (
            {"hardening": s.hardening, "yield_displacement": s.yield_displacement}
            if s.yields
            else {}
        )
        each = [sl.pseudo_energy_radius(motion, s.period, 0.05, **own) for motion in motions]
        values = [float(one.pseudo_energy_radius) for one in each]
        radii.append(xr.DataArray(values, dims="path"))
    hit = sl.pounding_estimate(*structures, gap, contact, *radii)
    estimate = [hit[f"largest_radius_amplification_{n}"].clip(1.0) for n in (1, 2)]
    both = np.array([table.amplification.values, np.transpose(estimate)])
    return np.where(table.impacts.values > 0, both, np.nan)


def mean_and_error(logs):
    """Over pairs, motions and structures; the error is from the scatter between pairs."""
    each = np.nanmean(logs[~np.isnan(logs).all(axis=(1, 2))], axis=(1, 2))
    return each.mean(), each.std(ddof=1) / np.sqrt(each.size)


# With standard errors, from 60 pairs: bias of the estimate, and what a bumper changes, as
# logarithms.
SAID = {
    False: ((0.264, 0.018), (-0.064, 0.007), (-0.077, 0.005)),
    True: ((0.204, 0.015), (-0.020, 0.005), (-0.079, 0.006)),
}


@pytest.mark.slow
@pytest.mark.paper
@pytest.mark.extreme  # bumpers
@pytest.mark.parametrize("yields", SAID, ids=["elastic", "yielding"])
def test_the_estimate_has_the_error_that_is_said_and_a_bumper_makes_it_smaller(yields):
    """The smaller restitution of a bumper leads to smaller amplifications, says the paper."""
    rng, bumper = np.random.default_rng(11), sl.Kelvin(5e8, restitution=0.3)
    logs = []
    for _ in range(14):
        structures, gap, motions = pair(rng, yields)
        without, with_it = (
            np.log(amplifications(structures, gap, contact, motions))
            for contact in (CONTACT, bumper)
        )
        logs.append([without[1] - without[0], *(with_it - without)])
    logs = np.array(logs)
    assert np.nanmax(logs[:, 2]) <= 1e-12
    for column, (said, error) in enumerate(SAID[yields]):
        mean, own = mean_and_error(logs[:, column])
        assert abs(mean - said) < 4 * np.hypot(error, own)
