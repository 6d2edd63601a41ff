"""Rules from outside: a code rule and one for effective properties, in the tables of every command."""

import math
import re

import cases
import pytest
import xarray as xr

import stochlin as sl

pytestmark = pytest.mark.cli

CASE = f"""\
{cases.FIRM_SITE}[building_1]
period = "0.7 s"
damping = "5 %"
hardening = "10 %"
reduction_factor = 12
[building_2]
period = "1.1 s"
damping = "5 %"
elastic = true
[separation]
confidence = 0.9
[simulation]
paths = 128
"""


@pytest.mark.slow
def test_both_rules_are_in_the_table_of_gaps(toy, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    done = toy("gap", "case.toml", "--out", "gap.nc", "--details")
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "gap.nc") as table:
        rules = table.rule.values.tolist()
        chosen = table.sel(rule="atlantis")
        root = table.sel(rule="eq_3_root")
        assert chosen.reference == "Building regulations of Atlantis, 7.3"
        assert chosen.kind == "code"
        total = float(table.peak_1 + table.peak_2)
        # floors do not align: twice half the sum and 2 cm
        assert float(chosen.gap) == pytest.approx(total + 0.04, rel=1e-12)
        mu = float(table.ductility_1)
        assert mu > 1
        rho = eq_4(0.7 * math.sqrt(mu), 1.1, 0.05 + 0.04 * (mu - 1), 0.05)
        assert float(root.rho) == pytest.approx(rho, rel=1e-12)
    builtin = (*sl.rules.effective_rule_names(), *sl.rules.code_rule_names())
    ours = [name for name in rules if name.removeprefix("eq_3_") in {*builtin, "root", "atlantis"}]
    expected = [f"eq_3_{n}" for n in (*sl.rules.effective_rule_names(), "root")]
    assert ours == [*expected, *sl.rules.code_rule_names(), "atlantis"]  # ours first, in their order
    assert re.search(r"^atlantis +[\d.]+ .* M$", done.stdout, re.MULTILINE)


def eq_4(period_1, period_2, damping_1, damping_2):
    """Eq. (4) of the paper, in the frequencies of both structures."""
    one, two = 1 / period_1, 1 / period_2
    above = 8 * math.sqrt(damping_1 * damping_2) * (damping_1 * one + damping_2 * two)
    above *= (one * two) ** 1.5
    below = (one**2 - two**2) ** 2 + 4 * damping_1 * damping_2 * one * two * (one**2 + two**2)
    return above / (below + 4 * (damping_1**2 + damping_2**2) * (one * two) ** 2)


def test_rho_takes_the_rule(toy, tmp_path):
    given = "--hardening .1 --reduction-factor 4 --method effective --rule root --out table.nc"
    done = toy("rho", "--period-1", "0.7s", "--period-2", "1.1s", *given.split())
    assert done.returncode == 0, done.stderr
    with xr.open_dataset(tmp_path / "table.nc") as table:
        mu = [float(table[f"ductility_peak_{n}"]) for n in (1, 2)]
        periods = [period * math.sqrt(m) for period, m in zip((0.7, 1.1), mu, strict=True)]
        dampings = [0.05 + 0.04 * (m - 1) for m in mu]
        assert min(mu) > 1
        assert float(table.rho) == pytest.approx(eq_4(*periods, *dampings), rel=1e-12)
        assert table.attrs["rule"] == "root: Some author (2031), Some journal 4 [M]"
