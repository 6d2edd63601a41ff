"""Fig. 3b: eq. (4) with effective properties, as far as the paper's claim goes."""

import numpy as np
import pytest

import stochlin as sl
from stochlin.charts import effective_rules_chart

pytestmark = pytest.mark.paper

JENG = "jeng_kasai_maison_1992_unverified"
BOTH = {"damping": 0.05, "hardening": 0.05, "ductility": 4.0}
CHART = effective_rules_chart(**BOTH, points=81)


def test_elastic_curve_is_that_of_fig_3a() -> None:
    exact = sl.rho_white_noise(CHART.period_ratio.values, 1.0, 0.05, 0.05).rho.values
    np.testing.assert_allclose(CHART.rho.sel(rule="elastic"), exact, rtol=1e-13)


def test_the_rule_of_the_paper_stands_beside_the_verified_ones_with_their_sources() -> None:
    assert tuple(CHART.rule.values) == (*sl.rules.effective_rule_names(), JENG)
    # 1 + 0.09 (mu - 1) times the periods of 0.6 and 1 s, 0.05 + 0.084 (mu - 1)^1.3, in eq. (4)
    both = {f"{name}_{n}": value for name, value in BOTH.items() for n in (1, 2)}
    assert float(sl.rules.rho_effective(0.6, 1.0, **both, rule=JENG).rho) == pytest.approx(
        0.683847, abs=5e-7
    )
    for name in CHART.rule.values:
        assert CHART.reference.sel(rule=name).item() == sl.rules.effective_rule(name).reference
        assert CHART.mark.sel(rule=name).item() == sl.rules.effective_rule(name).mark
        assert sl.rules.effective_rule(name).reference in CHART.attrs["references"]


def test_curves_are_symmetric_in_the_logarithm_of_the_ratio_and_one_at_equal_periods() -> None:
    np.testing.assert_allclose(CHART.rho, CHART.rho[:, ::-1], rtol=1e-12)
    np.testing.assert_allclose(CHART.rho[:, 40], 1.0, rtol=1e-12)


@pytest.mark.parametrize("rule", sl.rules.effective_rule_names())
def test_elastic_structures_need_no_rule(rule: str) -> None:
    chart = effective_rules_chart(0.03, 0.1, 1.0, points=21)
    np.testing.assert_allclose(chart.rho.sel(rule=rule), chart.rho.sel(rule="elastic"), rtol=1e-12)
