"""The table of measures against what its rows are made of, called one by one."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.analyses.separation.existing_gap import CLOSE

pytestmark = pytest.mark.oracle

GROUND = sl.named_ground("firm", intensity=0.01)
MOTION = {"envelope": sl.AminAng(4.0, 12.0, 0.35), "paths": 128, "seed": 3}
DURATION, GAP = 15.0, 0.05
STEEL, RUBBER = sl.Kelvin(1e9, restitution=0.65), sl.Kelvin(2e7, restitution=0.4)
LINK = sl.Link(2e7, 2e6)
MEASURES = {
    "dampers": sl.Measure(0.1, 0.05),
    "link": sl.Measure(link=LINK),
    "bumpers": sl.Measure(contact=RUBBER),
}


def pair(**changes):
    return [
        sl.Bilinear(T, 0.05, 0.05, mass=1e6, **({"reduction_factor": 3} | changes)) for T in (0.6, 1.0)
    ]


def record(samples=400, dt=0.02):
    noise = np.random.default_rng(11).standard_normal(samples + 10)
    values = 2.5 * np.convolve(noise, np.hanning(11), mode="valid")[:samples] / 3
    return xr.DataArray(values, dims="time", coords={"time": dt * np.arange(samples)})


@pytest.fixture(scope="module")
def table():
    return sl.mitigate(
        *pair(),
        GROUND,
        DURATION,
        GAP,
        MEASURES,
        contact=STEEL,
        records={"noise": record()},
        amplification_limit=0.9,
        **MOTION,
    )


def by_strength():
    """The pair by its yield displacements."""
    solved = [sl.linearize(s, GROUND).yield_displacement for s in pair()]
    return [
        sl.Bilinear(s.period, 0.05, 0.05, yield_displacement=float(uy), mass=1e6)
        for s, uy in zip(pair(), solved, strict=True)
    ]


def test_as_built_and_least_damping_are_those_of_existing_gap(table):
    known = sl.existing_gap(*pair(), GROUND, DURATION, GAP, **MOTION)
    built = table.sel(measure="as built")
    assert float(built.no_pounding_probability) == float(known.no_pounding_probability)
    np.testing.assert_allclose(built.required_gap, known.required_gap, rtol=1e-9)
    least = table.sel(measure="least damping, both")
    np.testing.assert_allclose(least.added_damping_1, known.least_added_damping, rtol=1e-6)
    assert float(least.added_damping_1) == float(least.added_damping_2) > 0


def test_a_link_is_simulated_and_linearized_as_linked(table):
    row = table.sel(measure="link")
    motions = sl.simulate(by_strength(), GROUND, duration=DURATION, quantiles=[0.9], link=LINK, **MOTION)
    np.testing.assert_allclose(row.required_gap, motions.separation_quantile[0, 0, 1], rtol=1e-9)
    np.testing.assert_allclose(row.peak_mean_2, motions.peak_mean[1], rtol=1e-9)
    solved = sl.correlate_linked(*by_strength(), GROUND, LINK)
    for name in ("rho", "relative_displacement_std"):
        np.testing.assert_allclose(row[name], solved[name], rtol=1e-6)
    assert float(row.link_stiffness) == LINK.stiffness


def test_records_are_those_of_pound(table):
    alone = sl.pound(by_strength(), GAP, STEEL, record()).peak_alone
    one, two = by_strength()
    damped = [
        sl.Bilinear(s.period, 0.05 + x, 0.05, yield_displacement=s.yield_displacement, mass=1e6)
        for s, x in ((one, 0.1), (two, 0.05))
    ]
    runs = {
        "as built": sl.pound([one, two], GAP, STEEL, record()),
        "dampers": sl.pound(damped, GAP, STEEL, record()),
        "link": sl.pound([one, two], GAP, STEEL, record(), link=LINK),
        "bumpers": sl.pound([one, two], GAP, RUBBER, record()),
    }
    for name, run in runs.items():
        row = table.sel(measure=name, record="noise")
        for n in (0, 1):
            np.testing.assert_allclose(row[f"amplification_{n + 1}"], run.peak[n] / alone[n], rtol=1e-6)
        assert float(row.impacts) == run.sizes["impact"]


def test_bumpers_matter_on_records_alone(table):
    built, bumpers = table.sel(measure="as built"), table.sel(measure="bumpers")
    assert float(built.required_gap) == float(bumpers.required_gap)
    assert float(bumpers.largest_force[0]) < 0.5 * float(built.largest_force[0])
    assert bumpers.contact.item() == RUBBER.describe()


def test_least_measures_meet_their_aim(table):
    least = table.where(table.kind == "least", drop=True)
    aimed = least.where((least.aim == "confidence") & least.required_gap.notnull(), drop=True)
    assert aimed.sizes["measure"] >= 2
    np.testing.assert_allclose(aimed.required_gap, GAP, rtol=5 * CLOSE)
    limited = least.where((least.aim == "amplification") & least.required_gap.notnull(), drop=True)
    assert limited.sizes["measure"] >= 1
    worst = np.maximum(limited.amplification_1, limited.amplification_2).max("record")
    np.testing.assert_allclose(worst, 0.9, rtol=5 * CLOSE)
    for name in least.measure.values[least.required_gap.isnull().values]:
        row = least.sel(measure=name)
        assert "nothing up to" in row.missing.item()
        assert int(row.verdict) == 4


def test_equal_buildings_need_no_gap():
    one, _ = pair()
    table = sl.mitigate(one, one, GROUND, DURATION, GAP, {}, **MOTION)
    assert float(table.required_gap.sel(measure="as built")) == 0
    assert table.measure.values.tolist() == ["as built"]  # nothing has to be found
    assert "amplification_1" not in table


def test_bumpers_without_records_say_what_is_missing():
    measures = {"bumpers": MEASURES["bumpers"]}
    table = sl.mitigate(*pair(), GROUND, DURATION, GAP, measures, contact=STEEL, **MOTION)
    assert "shows on records" in table.sel(measure="bumpers").missing.item()
    assert float(table.required_gap[0]) == float(table.required_gap[1])


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ({"gap": -0.1}, "gap = -0.1; allowed: a positive number"),
        ({"measures": {"glue": 3}}, r"measures\['glue'\] = 3 is of the wrong kind"),
        ({"records": {"r": record()}}, "contact is not given, records are"),
        ({"contact": STEEL, "records": {"r": record() * np.nan}}, r"records\['r'\]"),
        ({"amplification_limit": 1.0}, "amplification_limit = 1.0; allowed: a positive number, with"),
        ({"measures": {"d": sl.Measure(0.96)}}, "added_damping_1 = 0.96 makes the damping 1.01"),
        ({"confidence": 2}, "confidence = 2"),
    ],
)
def test_bad_input(changes, told):
    options = {"gap": GAP, "measures": {}} | MOTION | changes
    with pytest.raises((ValueError, TypeError), match=told):
        sl.mitigate(*pair(), GROUND, DURATION, **options)


def test_links_and_contacts_ask_for_masses():
    light = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0)]
    with pytest.raises(ValueError, match="mass is not given"):
        sl.mitigate(*light, GROUND, DURATION, GAP, {"link": sl.Measure(link=LINK)}, **MOTION)
    with pytest.raises(ValueError, match="first cannot pound"):
        sl.mitigate(*light, GROUND, DURATION, GAP, {}, contact=STEEL, records={"r": record()}, **MOTION)
    table = sl.mitigate(*light, GROUND, DURATION, GAP, {}, **MOTION)
    assert "least dashpot between" not in table.measure
