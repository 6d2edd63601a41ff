"""Scatter from motion to motion: the same motions, each times a lognormal factor of its own."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats

import stochlin as sl

FIRM = sl.named_ground("firm", intensity=0.01)
QUAKE = {"duration": 20.0, "envelope": sl.AminAng(2.0, 12.0, 0.4)}
ELASTIC = [sl.Bilinear(0.6, 0.05), sl.Bilinear(1.0, 0.05)]
YIELDING = [sl.Bilinear(T, 0.05, 0.05, yield_displacement=0.03) for T in (0.6, 1.0)]
SCATTER = 0.4


def simulated(structures=ELASTIC, scatter=SCATTER, **more):
    return sl.simulate(structures, FIRM, **{"paths": 2048, **QUAKE, **more}, scatter=scatter)


def factors(**more):
    one, none = (simulated(scatter=scatter, **more).separation for scatter in (SCATTER, 0.0))
    return (one / none).values[:, 0, 1]


@pytest.mark.oracle
def test_factors_are_lognormal_with_median_1_and_independent():
    logarithm = np.log(factors(paths=8192)) / SCATTER
    # The numbers of the simulation are normal within 9e-4 of the distribution function.
    assert scipy.stats.kstest(logarithm, "norm").pvalue > 1e-3
    assert abs(np.corrcoef(logarithm[1:], logarithm[:-1])[0, 1]) < 4 / np.sqrt(logarithm.size)


@pytest.mark.invariant
def test_elastic_structures_and_ground_go_by_one_factor_a_motion():
    """Whatever the structures, their number, the steps and the quantity."""
    own = factors(paths=64)
    others = factors(structures=[*ELASTIC, sl.Bilinear(0.2, 0.02)], paths=64)
    dense = factors(paths=64, steps_per_period=64)
    more = factors(paths=128)[:64]
    twice = simulated(scatter=2 * SCATTER, paths=64).peak / simulated(scatter=0.0, paths=64).peak
    ground = [
        sl.simulated_motions(FIRM, paths=64, **QUAKE, scatter=s, step=0.05) for s in (0, SCATTER)
    ]
    shaken = (ground[1].isel(time=50) / ground[0].isel(time=50)).values
    for found in (others, dense, more, np.sqrt(twice.values[:, 1]), shaken):
        np.testing.assert_allclose(found, own, rtol=1e-9)


@pytest.mark.invariant
def test_a_yielding_structure_is_that_under_a_motion_that_much_stronger():
    """The factor multiplies the ground, not the response: compared on the motions themselves."""
    table = simulated(YIELDING, paths=32)
    options = {"paths": 32, "step": table.attrs["step_s"], **QUAKE}
    motions = sl.simulated_motions(FIRM, **options, scatter=SCATTER)
    strongest = int(np.abs(motions.values).max(axis=1).argmax())
    response = sl.respond(YIELDING[1], motions[strongest])
    peak = float(np.abs(response.displacement).max())
    # The record is interpolated between its samples, the ground of a simulation is not.
    assert peak == pytest.approx(float(table.peak[strongest, 1]), rel=0.02)


OF_ALL = {
    sl.separation: {},
    sl.existing_gap: {"gap": 0.1},
    sl.mitigate: {"gap": 0.1, "measures": {}},
    sl.pounding_probability: {"gap": 0.1},
    sl.pounding_fragility: {"gap": 0.1, "intensity": [0.01]},
    sl.sensitivity: {},
    sl.pounding_risk: {"gap": 0.1, "hazard": sl.PowerLawHazard(k0=0.01, k=2.5)},
}
FITTED = replace(FIRM, scatter=0.3, source="fitted to a spectrum")


@pytest.mark.invariant
@pytest.mark.filterwarnings("ignore::stochlin.messages.DoubtfulInput")
@pytest.mark.parametrize("call", [*OF_ALL, sl.simulate, sl.simulated_motions])
def test_the_scatter_of_a_ground_is_the_default_of_all(call):
    """As in a case file: a fit to a spectrum or a record has one, other grounds have none."""
    structures = {sl.simulate: [ELASTIC], sl.simulated_motions: []}.get(call, ELASTIC)
    default, stated, none = (
        call(*structures, ground, **OF_ALL.get(call, {}), duration=8.0, paths=32, **scatter)
        for ground, scatter in ((FITTED, {}), (FIRM, {"scatter": 0.3}), (FITTED, {"scatter": 0.0}))
    )
    assert (default.attrs["scatter"], default.attrs["ground_source"]) == (0.3, FITTED.source)
    assert default.drop_attrs().identical(stated.drop_attrs())
    assert not default.drop_attrs().identical(none.drop_attrs())


@pytest.mark.invariant
@pytest.mark.parametrize("wrong", [-0.1, 2.1, 40, np.nan, np.inf, "0.4", [0.4], True])
def test_scatter_out_of_range_is_refused_by_all(wrong):
    every = [
        lambda: simulated(scatter=wrong),
        lambda: sl.simulated_motions(FIRM, 5.0, scatter=wrong),
    ]
    options = {**QUAKE, "paths": 512, "scatter": wrong}
    every += [
        lambda c=c, more=more: c(*ELASTIC, FIRM, **more, **options) for c, more in OF_ALL.items()
    ]
    for call in every:
        with pytest.raises(
            ValueError,
            match=r"scatter = .* is (no number|out of range); allowed: a number from 0 to 2",
        ):
            call()
