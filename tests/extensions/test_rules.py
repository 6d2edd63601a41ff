"""Rules from outside: a code rule, one for effective properties, a peak factor, in every table."""

import math
import re

import cases
import pytest
import xarray as xr

import stochlin as sl
from stochlin.models.rules.codes import CODE_RULES, rules_of
from stochlin.models.rules.peak_factors import PEAK_FACTORS

CASE = f"""\
{cases.FIRM_SITE}[building_1]
period = "0.7 s"
damping = "5 %"
hardening = "10 %"
reduction_factor = 12
height = "12 m"
[building_2]
period = "1.1 s"
damping = "5 %"
elastic = true
height = "15 m"
[separation]
confidence = 0.9
[simulation]
paths = 128
"""


@pytest.mark.cli
@pytest.mark.slow
def test_both_rules_are_in_the_table_of_gaps(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    done = toy("gap", "case.toml", "--out", "gap.nc", "--details")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "gap.nc") as table:
        rules = table.rule.values.tolist()
        chosen = table.sel(rule="nch_433")
        effective = table.sel(rule="eq_3_gulkan_sozen_1974")
        assert chosen.reference == "NCh 433.Of1996, modified in 2009, Chile, 5.10"
        assert chosen.kind == "code"
        both = (table.peak_1, 12.0), (table.peak_2, 15.0)
        distances = [max(float(peak) * 2 / 3, 0.002 * height, 0.015) for peak, height in both]
        assert float(chosen.gap) == pytest.approx(sum(distances), rel=1e-12)
        mu = float(table.ductility_1)
        assert mu > 1
        rho = eq_4(0.7 * math.sqrt(mu), 1.1, 0.05 + 0.2 * (1 - mu**-0.5), 0.05)
        assert float(effective.rho) == pytest.approx(rho, rel=1e-12)
    builtin = (*sl.rules.effective_rule_names(), *sl.rules.code_rule_names())
    ours = [
        name
        for name in rules
        if name.removeprefix("eq_3_") in {*builtin, "gulkan_sozen_1974", "nch_433"}
    ]
    expected = [f"eq_3_{n}" for n in (*sl.rules.effective_rule_names(), "gulkan_sozen_1974")]
    assert ours == [*expected, *sl.rules.code_rule_names(), "nch_433"]  # ours first, in their order
    assert re.search(r"^nch_433 +[\d.]+ .* M$", done.stdout, re.MULTILINE)


def eq_4(period_1, period_2, damping_1, damping_2):
    """Eq. (4) of the paper, in the frequencies of both structures."""
    one, two = 1 / period_1, 1 / period_2
    above = 8 * math.sqrt(damping_1 * damping_2) * (damping_1 * one + damping_2 * two)
    above *= (one * two) ** 1.5
    below = (one**2 - two**2) ** 2 + 4 * damping_1 * damping_2 * one * two * (one**2 + two**2)
    return above / (below + 4 * (damping_1**2 + damping_2**2) * (one * two) ** 2)


@pytest.mark.cli
def test_rho_takes_the_rule(toy, tmp_path):
    given = (
        "--hardening .1 --reduction-factor 4 --method effective --rule gulkan_sozen --out table.nc"
    )
    done = toy("rho", "--period-1", "0.7s", "--period-2", "1.1s", *given.split())
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "table.nc") as table:
        mu = [float(table[f"ductility_peak_{n}"]) for n in (1, 2)]
        periods = [period * math.sqrt(m) for period, m in zip((0.7, 1.1), mu, strict=True)]
        dampings = [0.05 + 0.2 * (1 - m**-0.5) for m in mu]
        assert min(mu) > 1
        assert float(table.rho) == pytest.approx(eq_4(*periods, *dampings), rel=1e-12)
        source = "Gülkan, P. and Sozen, M. A. (1974), J. Am. Concrete Inst. 71, 604-610"
        assert table.attrs["rule"] == f"gulkan_sozen_1974: {source} [M]"


@pytest.mark.oracle
def test_the_code_rule_of_the_page_keeps_the_largest_of_three_distances(example):
    rule = example("A code rule", CODE_RULES)
    for peak, height, distance in ((0.06, 12.0, 0.04), (0.03, 12.0, 0.024), (0.01, 5.0, 0.015)):
        assert float(rule.gap(peak, None, height)) == pytest.approx(distance, rel=1e-12)
        both = rule.gap(peak, 0.3, height, 30.0)
        assert float(both) == pytest.approx(distance + 0.2, rel=1e-12)
    assert rule in rules_of("chile")


@pytest.mark.oracle
def test_the_peak_factor_of_the_page_has_the_moments_of_the_largest_amplitude(example):
    """``E = sqrt(pi/2) sum (-1)^(k+1) C(N, k)/sqrt(k)``, and of squares ``2 sum 1/k``."""
    factor = example("A peak factor", PEAK_FACTORS)
    for n in (1, 2, 5, 20):
        terms = [(-1) ** (k + 1) * math.comb(n, k) / math.sqrt(k) for k in range(1, n + 1)]
        mean = math.sqrt(math.pi / 2) * math.fsum(terms)
        square = 2 * sum(1 / k for k in range(1, n + 1))
        assert float(factor.mean(n, 0.3)) == pytest.approx(mean, rel=1e-9)
        assert float(factor.std(n, 0.3)) == pytest.approx(math.sqrt(square - mean**2), rel=1e-9)
        assert float(factor.mean(2 * n, 0.3, sides=1)) == pytest.approx(mean, rel=1e-9)
