"""The rule ``eq_3_paper``: elastic peaks times D of Fig. 5b, and rho of Fig. 5a, in eq. (3)."""

import numpy as np
import pytest

import stochlin as sl

LAKEBED = sl.KanaiTajimi(2.0, 0.05, 0.01)
FIRM = sl.named_ground("firm", intensity=0.01)
SECONDS, CONFIDENCE = 60.0, 0.8
FEW = {"paths": 256, "confidence": CONFIDENCE}


def pair(first=1.0, second=1.6, **options):
    strength = {"hardening": 0.05, "reduction_factor": 4.0} | options
    return tuple(sl.Bilinear(period, 0.05, **strength) for period in (first, second))


def elastic_peaks(*periods, ground, seconds=SECONDS):
    """Quantiles of elastic peaks from mean and standard deviation, by a Gumbel distribution."""
    scale = np.sqrt(6) / np.pi
    reduced = -np.log(-np.log(CONFIDENCE)) - np.euler_gamma
    tables = [sl.peak_response(sl.Bilinear(period, 0.05), ground, seconds) for period in periods]
    return [float(table.peak_mean + scale * reduced * table.peak_std) for table in tables]


def gap_of(table, rule="eq_3_paper"):
    return float(table.gap.sel(rule=rule))


@pytest.mark.paper
@pytest.mark.parametrize("ground", [LAKEBED, FIRM], ids=["lake bed", "firm"])
def test_it_is_eq_3_of_the_elastic_peaks_times_d_with_the_linearized_rho(ground):
    first, second = pair()
    table = sl.separation(first, second, ground, SECONDS, **FEW)
    rho = sl.correlate(first, second, ground).rho
    amplified = [
        peak * sl.amplification(structure, ground, closure="gaussian").amplification
        for structure, peak in zip(
            (first, second), elastic_peaks(1.0, 1.6, ground=ground), strict=True
        )
    ]
    assert gap_of(table) == pytest.approx(float(sl.critical_gap(*amplified, rho).gap), rel=1e-9)
    assert float(table.rho.sel(rule="eq_3_paper")) == pytest.approx(float(rho), rel=1e-12)
    assert "1996" in table.reference.sel(rule="eq_3_paper").item()


@pytest.mark.paper
def test_an_envelope_shortens_it_to_the_stationary_motion_of_equal_energy():
    envelope = sl.AminAng(4.0, 15.0, 0.35)
    table = sl.separation(*pair(), FIRM, 30.0, envelope=envelope, **FEW)
    time = np.linspace(0, 30, 30001)
    seconds = float(np.trapezoid(np.asarray(envelope.at(time)) ** 2, time))
    whole = sl.separation(*pair(), FIRM, seconds, **FEW)
    assert gap_of(table) == pytest.approx(gap_of(whole), rel=1e-4)


@pytest.mark.oracle
def test_with_one_peak_factor_for_all_responses_it_would_be_linearization_alone():
    """Both have the same standard deviations and rho; the peak factors are of other responses."""
    first, second = pair()
    table = sl.separation(first, second, LAKEBED, SECONDS, **FEW)
    found = sl.correlate(first, second, LAKEBED)
    alone = gap_of(table, "linearization")
    factor = alone / float(found.relative_displacement_std)
    same = [factor * found[f"displacement_std_{n}"] for n in (1, 2)]
    assert float(sl.critical_gap(*same, found.rho).gap) == pytest.approx(alone, rel=1e-9)
    own = [
        peak / float(sl.linearize(sl.Bilinear(period, 0.05), LAKEBED).displacement_std)
        for period, peak in zip((1.0, 1.6), elastic_peaks(1.0, 1.6, ground=LAKEBED), strict=True)
    ]
    with_own = [each * found[f"displacement_std_{n}"] for n, each in enumerate(own, start=1)]
    assert gap_of(table) == pytest.approx(
        float(sl.critical_gap(*with_own, found.rho).gap), rel=1e-9
    )
    assert abs(gap_of(table) / alone - 1) > 0.02


@pytest.mark.filterwarnings("ignore:.*its strong shaking has 0.37 s")
@pytest.mark.invariant
def test_what_it_lacks_is_said():
    alone = sl.separation(pair()[0], None, FIRM, 20.0, **FEW).sel(rule="eq_3_paper")
    assert np.isnan(alone.gap)
    assert "second building" in alone.missing.item()
    short = sl.separation(*pair(), FIRM, 2.0, envelope=sl.AminAng(0.1, 0.2, 2.0), **FEW).sel(
        rule="eq_3_paper"
    )
    assert np.isnan(short.gap)
    assert "too short for a peak" in short.missing.item()
