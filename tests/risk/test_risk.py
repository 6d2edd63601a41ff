"""Risk of two buildings, against counting in motions of drawn intensities."""

from dataclasses import replace

import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.risk import risk as risk_module
from stochlin.applications.risk.risk import allowed_rate
from stochlin.solver.simulation.prepared import FiniteMotion

GROUND = sl.named_ground("firm", intensity=0.01)
SHAPE = sl.AminAng(2.0, 10.0, 0.5)
ELASTIC = tuple(sl.Bilinear(T, 0.05) for T in (0.6, 1.0))
YIELDING = tuple(sl.Bilinear(T, 0.05, 0.05, reduction_factor=3) for T in (0.6, 1.0))
STOREYS = sl.ShearBuilding.regular(
    period=0.4, storeys=3, storey_height=3.0, mass=2e5, damping=0.05, hardening=0.05,
    base_shear_coefficient=0.2,
)  # fmt: skip


def counted(pair, hazard, gap, count, paths):
    """Share of motions that pound among those of intensities drawn from the hazard, times its rate.

    ``count`` intensities of equal share, one in the middle of each; motions of a seed of their own.
    """
    lowest = float(hazard.intensity(20.0))
    share = (np.arange(count) + 0.5) / count
    intensity = np.array([float(hazard.intensity(20.0 / one)) for one in share])
    strong = [sl.scale_ground(GROUND, 15.0, SHAPE, pga=1.0)]
    uy = [sl.reduction_factor(s, GROUND).yield_displacement if s.yields else None for s in pair]
    fixed = [
        sl.Bilinear(
            s.period, s.damping, s.hardening, yield_displacement=None if y is None else float(y)
        )
        for s, y in zip(pair, uy, strict=True)
    ]
    hits = []
    for n, im in enumerate(intensity):
        ground = replace(strong[0], intensity=strong[0].intensity * im**2)
        table = sl.simulate(
            fixed, ground, paths=paths, seed=1000 + n, duration=15.0, envelope=SHAPE
        )
        hits.append(float((table.separation[:, 0, 1] > gap).mean()))
    hits, rate = np.array(hits), float(hazard.frequency(lowest))
    error = np.sqrt((hits * (1 - hits)).sum() / paths) / count
    return rate * hits.mean(), rate * error


@pytest.mark.parametrize(
    ("count", "paths"), [(24, 128), pytest.param(100, 1024, marks=pytest.mark.slow)]
)
def test_rate_of_yielding_structures_is_that_of_counting(count, paths):
    hazard, gap = sl.PowerLawHazard(k0=0.02, k=2.5), 0.08
    table = sl.pounding_risk(*YIELDING, GROUND, gap, hazard, 15.0, envelope=SHAPE, paths=512)
    found, error = counted(YIELDING, hazard, gap, count, paths)
    # What is weaker than 20 years has hardly a part in it.
    weak = float(table.annual_rate_by_intensity.sel(from_intensity=slice(0, 0.4)).sum())
    both = np.hypot(error, float(table.annual_rate_standard_error))
    assert abs(float(table.annual_rate) - found) < 4 * both + weak
    for end, sign in (("lower", -1), ("upper", 1)):
        rate = float(table.annual_rate + sign * 1.96 * table.annual_rate_standard_error)
        share = float(table[f"probability_in_years_{end}"])
        assert share == pytest.approx(1 - np.exp(-50 * max(rate, 0.0)), rel=1e-9)


@pytest.mark.slow
def test_storeys_keep_the_gap_that_is_asked_for():
    hazard = sl.HazardCurve([0.5, 1.0, 2.0, 4.0, 8.0], [0.02, 5e-3, 1e-3, 1.5e-4, 1e-5])
    common = {"envelope": SHAPE, "paths": 128}
    asked = sl.required_gap(
        STOREYS, ELASTIC[1], GROUND, hazard, 15.0, risk="10 % in 50 years", **common
    )
    gap = float(asked.required_gap)
    assert float(asked.required_gap_lower) < gap < float(asked.required_gap_upper)
    table = sl.pounding_risk(STOREYS, ELASTIC[1], GROUND, gap, hazard, 15.0, **common)
    assert float(table.annual_rate) == pytest.approx(-np.log(0.9) / 50, rel=1e-4)
    assert float(table.probability_in_years) == pytest.approx(0.1, rel=1e-4)
    ends = [float(table[f"probability_in_years_{end}"]) for end in ("lower", "upper")]
    assert ends[0] < 0.1 < ends[1]


def test_hazards_of_different_measures_are_one_hazard():
    """Of PGA, of ``Sa``, and of ``S0`` whose square root they are in proportion to."""
    motion = {"duration": 15.0, "envelope": SHAPE}
    by_pga = sl.PowerLawHazard(0.01, 2.4)
    intensity = sl.scale_ground(GROUND, **motion, pga=1.0).intensity
    sa = float(
        sl.simulated_spectrum(
            sl.scale_ground(GROUND, **motion, pga=1.0), [0.6], 15.0, SHAPE, paths=1024
        ).pseudo_acceleration[0]
    )
    by_sa = sl.PowerLawHazard(0.01 * sa**2.4, 2.4, measure="sa", period=0.6)
    by_intensity = sl.PowerLawHazard(0.01 * intensity**1.2, 1.2, measure="intensity")
    rates = [
        float(
            sl.pounding_risk(
                *YIELDING, GROUND, 0.08, hazard, 15.0, envelope=SHAPE, paths=64
            ).annual_rate
        )
        for hazard in (by_pga, by_intensity, by_sa)
    ]
    assert rates[1] == pytest.approx(rates[0], rel=0.01)  # other points of the same curve
    assert rates[2] == pytest.approx(rates[0], rel=0.02)


@pytest.mark.parametrize(
    ("risk", "rate"),
    [("2 % in 50 years", -np.log(0.98) / 50), ("10%in 10yr", -np.log(0.9) / 10), (1e-3, 1e-3)],
)
def test_risks_are_read_as_rates_a_year(risk, rate):
    assert allowed_rate(risk)[0] == pytest.approx(rate, rel=1e-12)


def test_risks_that_are_none_or_outside_of_the_hazard_are_named():
    hazard = sl.HazardCurve([0.5, 4.0], [5e-3, 1e-3])
    for risk, told in (
        (0.01, "allowed: between 0.001 and 0.005 a year"),
        ("2 %", "risk = "),
        ("2 % in 0 years", "risk = "),
        ("100 % in 5 years", "risk = "),
        (0, "risk = "),
    ):
        with pytest.raises(ValueError, match=told):
            sl.required_gap(*ELASTIC, GROUND, hazard, 15.0, risk=risk, paths=32)


def test_a_large_risk_in_words_is_asked_about_as_its_number_is():
    hazard = sl.PowerLawHazard(0.02, 2.5)
    for risk, shown in (
        ("50 % in 50 years", "'50 % in 50 years' is 0.0139 a year"),
        (0.0139, "0.0139"),
    ):
        with pytest.warns(sl.ImplausibleInput, match=f"{shown}.*usual are 1e-4 to 2e-3 per year"):
            sl.required_gap(*ELASTIC, GROUND, hazard, 15.0, risk=risk, paths=32)


@pytest.mark.slow
def test_risk_of_what_is_not_known_exactly_is_the_mean_of_the_rates_of_drawn_pairs():
    hazard, gap = sl.PowerLawHazard(k0=0.02, k=2.5), 0.08
    spread = sl.Bilinear(sl.Uncertain(0.6, 0.4), 0.05, 0.05, yield_displacement=0.02)

    def risk(first, paths, seed=0):
        options = {"envelope": SHAPE, "paths": paths, "seed": seed}
        return sl.pounding_risk(first, ELASTIC[1], GROUND, gap, hazard, 15.0, **options)

    table = risk(spread, 512)
    factors = np.exp(0.4 * np.random.default_rng(9).standard_normal(24))
    pairs = [spread.at({"period": float(factor)}) for factor in factors]
    drawn = np.array([float(risk(one, 32, 50 + n).annual_rate) for n, one in enumerate(pairs)])
    error = np.hypot(drawn.std(ddof=1) / np.sqrt(24), float(table.annual_rate_standard_error))
    assert abs(drawn.mean() - float(table.annual_rate)) < 4 * error


@pytest.mark.oracle
def test_the_error_of_a_rate_contains_that_of_the_intensities(monkeypatch):
    """Of yielding structures, by the same motions at many more intensities."""
    pair = dict(zip(("first", "second"), YIELDING, strict=True))
    motion = pair, GROUND, sl.PowerLawHazard(k0=0.02, k=2.5), FiniteMotion(15.0, SHAPE, 0.0, 3), 512
    usual = risk_module.RiskSimulation(*motion).run()
    monkeypatch.setattr(risk_module, "SIMULATED_INTENSITIES", 97)
    fine = risk_module.RiskSimulation(*motion).run()
    for gap in (0.05, 0.1, 0.2):
        off = abs(usual.rate(gap)[0] - fine.rate(gap)[0])
        assert off <= max(2 * usual.quadrature_error(gap), 0.005 * fine.rate(gap)[0])
        assert off < usual.rate(gap)[1]
