"""Codes with a least gap by height: clauses by hand at three heights, with both kinds of floors."""

import pytest

import stochlin as sl

G = 9.80665


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("height", "level", "not_level"),
    [
        (6.0, max(0.25 * 0.10, 0.030), max(0.5 * 0.10, 0.030)),
        (12.0, max(0.25 * 0.10, 0.030 + 2 * 0.010), max(0.5 * 0.10, 0.030 + 2 * 0.010)),
        (24.0, max(0.25 * 0.10, 0.030 + 6 * 0.010), max(0.5 * 0.10, 0.030 + 6 * 0.010)),
    ],
)
def test_turkey_by_hand(height, level, not_level):
    """TBDY 2018, 4.9.3: R/I u = 6 and 8 cm, root 10 cm; beside 30 m the lower height counts."""
    rule = sl.rules.code_rule("tbdy_2018")
    for align, gap in ((True, level), (False, not_level)):
        assert float(rule.gap(0.06, 0.08, height, 30.0, align)) == pytest.approx(gap, rel=1e-12)
        assert float(rule.gap(0.08, 0.06, 30.0, height, align)) == pytest.approx(gap, rel=1e-12)


@pytest.mark.oracle
@pytest.mark.parametrize("name", ["ntc_2008", "ntc_2018"])
@pytest.mark.parametrize(
    ("height", "share", "gap"),
    [
        (6.0, 0.25, max(0.07, 0.06 * 0.5)),
        (18.0, 0.25, max(0.07, 0.18 * 0.5)),
        (30.0, 0.25, max(0.07, 0.30 * 0.5)),
        (30.0, 0.60, max(0.07, 0.30 * 1.0)),  # 2 ag S/g = 1.2 counts as 1
    ],
)
def test_italy_by_hand(name, height, share, gap):
    """NTC 2018, 7.2.1: the sum 3 + 4 cm, and h/100 (2 ag S/g), the factor 1 at most; any floors."""
    rule = sl.rules.code_rule(name)
    for align in (True, False):
        found = rule.gap(0.03, 0.04, height, 40.0, align, design_pga=share * G)
        assert float(found) == pytest.approx(gap, rel=1e-5)  # g with its standard digits


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("height", "storeys", "importance", "each"),
    [
        (12.0, 4, 1.0, 0.005 * 12),
        (12.0, 4, 1.2, max(0.005 * 12, 0.15)),  # important
        (25.6, 8, 1.0, 0.005 * 25.6),
        (28.8, 9, 1.0, max(0.005 * 28.8, 0.15)),
        (40.0, 12, 1.0, max(0.005 * 40, 0.15)),
    ],
)
def test_iran_by_hand(height, storeys, importance, each):
    """Standard 2800: nonlinear displacement 15 cm; the neighbour has 6 m and 2 storeys, so 3 cm."""
    rule = sl.rules.code_rule("iran_2800")
    one = {"storeys_1": storeys, "importance_1": importance}
    assert float(rule.gap(0.15, None, height, **one)) == pytest.approx(each, rel=1e-12)
    for align in (True, False):
        gap = rule.gap(0.15, 0.15, height, 6.0, align, storeys_2=2, **one)
        assert float(gap) == pytest.approx(each + 0.005 * 6, rel=1e-12)


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("height", "storeys", "level", "not_level", "empty_plot"),
    [
        (6.0, 2, 0.0, 0.0, 0.0),
        (9.0, 3, 0.0, 0.01 * 9, 0.0),
        (12.0, 4, 0.02 * 12, 0.03 * 12, 0.01 * 12),
        (30.0, 10, 0.02 * 30, 0.03 * 30, 0.01 * 30),
    ],
)
def test_colombia_by_hand(height, storeys, level, not_level, empty_plot):
    """NSR-10, table A.6.5-1, beside a house of one storey; displacements do not count."""
    rule = sl.rules.code_rule("nsr_10")
    for align, gap in ((True, level), (False, not_level)):
        found = rule.gap(0.5, 0.5, height, 3.0, align, storeys_1=storeys, storeys_2=1)
        assert float(found) == pytest.approx(gap, rel=1e-12)
    assert float(rule.gap(0.5, None, height, storeys_1=storeys)) == pytest.approx(
        empty_plot, rel=1e-12
    )
