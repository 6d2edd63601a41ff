"""Parameters that are extreme but allowed: a number, or NaN with a status, and never a warning."""

import mpmath
import numpy as np
import pytest
import xarray as xr
from cases import with_slow
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.solver.tables import labels

pytestmark = [pytest.mark.invariant, pytest.mark.filterwarnings("ignore:.*usual are")]

CELLS = 20
POWER = st.floats(-300, 300)
SHARE = st.floats(-300, -0.001)  # power of a ratio below 1
ELASTIC, STRENGTH, FACTOR = (), ("yield_displacement",), ("reduction_factor",)
CLOSURES = ("gaussian", "drift")


def exact(period_1, period_2, damping_1, damping_2):
    """Eq. (4) with sixty digits and all exponents."""
    with mpmath.workdps(60):
        t1, t2, x1, x2 = map(mpmath.mpf, (period_1, period_2, damping_1, damping_2))
        w1, w2 = mpmath.sqrt(t2 / t1), mpmath.sqrt(t1 / t2)
        mixed, crossed = x1 * w1 + x2 * w2, x1 * w2 + x2 * w1
        return float(
            8 * mpmath.sqrt(x1 * x2) * mixed / ((w1**2 - w2**2) ** 2 + 4 * mixed * crossed)
        )


@given(POWER, st.one_of(POWER, st.floats(-1e-6, 1e-6)), SHARE, SHARE)
def test_eq_4_holds_for_all_exponents(power, apart, xi_1, xi_2):
    period = 10.0**power
    other = period * 10.0**apart if abs(apart) < 1 else 10.0**apart
    pair = period, other, 10.0**xi_1, 10.0**xi_2
    table = sl.rho_white_noise(*pair)
    # Periods that are nearly equal amplify the rounding of their ratio by 1/xi.
    rounding = (
        4e-15 * (1 + abs(np.log(other / period)) / max(pair[2:])) if abs(apart) < 1 else 1e-14
    )
    assert int(table.status) == labels.CONVERGED
    assert float(table.rho) == pytest.approx(exact(*pair), rel=rounding, abs=1e-200)


class Extremes:
    """Random parameters over one dimension, of all exponents that are allowed."""

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)

    def positive(self, low=-300.0):
        return xr.DataArray(10 ** self.rng.uniform(low, 300, CELLS), dims="cell")

    def period(self):
        return xr.DataArray(10 ** self.rng.uniform(-9, 9, CELLS), dims="cell")

    def ratio(self):
        return xr.DataArray(10 ** self.rng.uniform(-300, -1e-3, CELLS), dims="cell")

    def structure(self, strength):
        hardening = {"hardening": self.ratio()} if strength else {}
        own = {name: self.positive() for name in strength}
        return sl.Bilinear(self.period(), self.ratio(), **hardening, **own)

    def ground(self, kind):
        if kind is sl.WhiteNoise:
            return kind(self.positive())
        soil = self.period(), self.ratio()
        if kind is sl.CloughPenzien:
            soil += self.period(), self.ratio()
        return kind(*soil, intensity=self.positive())


def check(table, *names):
    """Every cell of these variables is finite, or its status says why it is not."""
    solved = table.status < labels.NOT_CONVERGED
    for name in names:
        assert bool(np.isfinite(table[name]).where(solved, True).all()), name


KINDS = with_slow(
    [sl.WhiteNoise, sl.KanaiTajimi, sl.CloughPenzien], [sl.WhiteNoise, sl.CloughPenzien]
)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "strength", [ELASTIC, STRENGTH, FACTOR], ids=["elastic", "strength", "factor"]
)
def test_what_cannot_be_linearized_has_a_status(kind, strength):
    of = Extremes(len(strength) + 7)
    for closure in CLOSURES:
        table = sl.linearize(of.structure(strength), of.ground(kind), closure)
        check(table, "displacement_std", "velocity_std", "ductility_std")
    table = sl.amplification(of.structure(strength), of.ground(kind))
    check(table, "displacement_std", "amplification")
    table = sl.peak_response(of.structure(strength), of.ground(kind), of.positive())
    check(table, "peak_mean", "peak_std", "displacement_std")


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("strength", [ELASTIC, STRENGTH], ids=["elastic", "strength"])
def test_what_has_no_correlation_has_a_status(kind, strength):
    of = Extremes(len(strength) + 11)
    for method in ("linearization", "white_noise", "effective"):
        for closure in CLOSURES if method == "linearization" else ["gaussian"]:
            pair = of.structure(strength), of.structure(strength)
            table = sl.correlate(*pair, of.ground(kind), method, closure=closure)
            check(table, "rho", "relative_displacement_std", "ductility_std_1", "ductility_std_2")


@pytest.mark.parametrize("rule", sl.rules.effective_rule_names())
def test_what_has_no_effective_period_has_a_status(rule):
    of = Extremes(17)
    ductilities = of.positive(0), of.positive(0)
    ratios = (of.ratio() for _ in range(4))
    table = sl.rules.rho_effective(of.positive(), of.positive(), *ratios, *ductilities, rule=rule)
    check(table, "rho", "period_eq_1", "period_eq_2", "damping_eq_1", "damping_eq_2")


def test_references_that_no_ground_can_solve_leave_other_grounds_alone():
    """On a ground of so little damping the correlations of the references are rounding errors."""
    dampings = xr.DataArray([6.032988184460767e-159, 0.3], dims="cell")
    pair = [sl.Bilinear(period, 0.05, 0.05, reduction_factor=4.0) for period in (0.8, 1.0)]
    table = sl.correlate(*pair, sl.KanaiTajimi(1.0, dampings), closure="drift")
    check(table, "rho")
    usual = sl.correlate(*pair, sl.KanaiTajimi(1.0, 0.3), closure="drift")
    assert float(table.rho[1]) == pytest.approx(float(usual.rho), rel=1e-12)
