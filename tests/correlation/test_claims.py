"""What the paper says of eq. (4), of linearization and of the ground, against simulation."""

from functools import cache
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from scipy.special import ndtr

import stochlin as sl

pytestmark = pytest.mark.paper

GROUND_PERIOD = 1.0
BROAD, NARROW = 0.6, 0.05  # damping of the ground
LOGS = np.delete(np.linspace(-2, 2, 17), 8)
RATIOS = 2.0**LOGS  # T1/T2 from 1/4 to 4, without 1
PERIODS = (0.5, 1.0, 2.0)  # T2 over the ground's
FACTORS = (2, 4, 6)
RULES = sl.rules.effective_rule_names(unverified=True)
SIMPLIFIED = tuple(name for name in RULES if name != "elastic")
JENG = "jeng_kasai_maison_1992_unverified"
SAME_AS_WRITTEN = 0.0051  # two digits are written


def yielding(period, factor):
    return sl.Bilinear(period, damping=0.05, hardening=0.05, reduction_factor=factor)


class Simulated(NamedTuple):
    """Of structures at `RATIOS` with the one of ratio 1."""

    rho: np.ndarray
    error: np.ndarray
    std: np.ndarray

    def difference_std(self, rho):
        """Of ``u_1 - u_2`` with these standard deviations, to which a gap is proportional."""
        one, two = self.std[:-1], self.std[-1]
        return np.sqrt(one**2 + two**2 - 2 * rho * one * two)


@cache
def simulated(ground_damping, period, factor, paths=64):
    structures = [yielding(ratio * period, factor) for ratio in (*RATIOS, 1.0)]
    ground = sl.KanaiTajimi(GROUND_PERIOD, ground_damping)
    table = sl.simulate(structures, ground, paths=paths, seed=1)
    assert (table.status == 0).all()
    return Simulated(
        table.rho.values[-1, :-1],
        table.rho_standard_error.values[-1, :-1],
        table.displacement_std.values,
    )


@cache
def formulas(ground_damping, period, factor, closure="gaussian"):
    """Linearized pairs, and rho by each rule at their linearized peak ductilities."""
    first = yielding(xr.DataArray(RATIOS * period, dims="ratio"), factor)
    ground = sl.KanaiTajimi(GROUND_PERIOD, ground_damping)
    table = sl.correlate(first, yielding(period, factor), ground, closure=closure)
    return table, by_rule(3 * table.ductility_std_1, 3 * table.ductility_std_2)


def by_rule(ductility_1, ductility_2):
    both = {f"{name}_{n}": 0.05 for name in ("damping", "hardening") for n in (1, 2)}
    given = {"ductility_1": ductility_1, "ductility_2": ductility_2, **both}
    ratios = xr.DataArray(RATIOS, dims="ratio")
    return {
        name: sl.rules.rho_effective(ratios, 1.0, rule=name, **given).rho.values for name in RULES
    }


def apart(one, other):
    """Mean distance of two curves."""
    return float(np.abs(one - other).mean())


# ---- "For broad band input linearization and the simplified formulas yield similar estimates" ----


def test_the_rule_named_after_jeng_is_nearer_to_linearization_on_broad_band_than_on_narrow_band():
    """The paper's contrast: in the mean of 144 pairs in each of 15 settings, not for T2 = Tg."""
    ratio, period, factor, hardening, damping = (
        xr.DataArray(values, [(name, values)])
        for name, values in {
            "ratio": RATIOS,
            "period": np.array(PERIODS),
            "factor": np.array(FACTORS),
            "hardening": np.array([0.02, 0.05, 0.1, 0.2, 0.3]),
            "damping": np.array([0.02, 0.05, 0.1]),
        }.items()
    )
    periods = ratio * period, period
    pair = [sl.Bilinear(each, damping, hardening, reduction_factor=factor) for each in periods]
    of_pairs, by_period = {}, {}
    for band, extremes in ((BROAD, (0.10, 0.14)), (NARROW, (0.16, 0.26))):
        ground = sl.KanaiTajimi(GROUND_PERIOD, band)
        by_rule = sl.correlate(*pair, ground, "effective", rule=JENG).rho
        away = np.abs(by_rule - sl.correlate(*pair, ground).rho).mean(["ratio", "factor"])
        of_pairs[band] = away.mean("period")
        by_period[band] = away.sel(hardening=0.05, damping=0.05)
        found = float(of_pairs[band].min()), float(of_pairs[band].max())
        assert found == pytest.approx(extremes, abs=SAME_AS_WRITTEN)
    assert (of_pairs[BROAD] < of_pairs[NARROW]).all()
    np.testing.assert_allclose(by_period[BROAD], [0.132, 0.119, 0.099], atol=SAME_AS_WRITTEN / 10)
    np.testing.assert_allclose(by_period[NARROW], [0.289, 0.096, 0.176], atol=SAME_AS_WRITTEN / 10)
    means = [float(by_period[band].mean()) for band in (BROAD, NARROW)]
    assert means == pytest.approx([0.117, 0.187], abs=SAME_AS_WRITTEN / 10)


# ---- On narrow band: what eq. (4) with effective properties, and linearization, make of a gap ----


# Mean distance of rho from the simulated: linearization, the drift closure, the rules in their
# order.
OFF = {
    BROAD: (0.08, 0.02, 0.41, 0.16, 0.10, 0.24, 0.21, 0.14, 0.16),
    NARROW: (0.17, 0.025, 0.40, 0.18, 0.13, 0.23, 0.21, 0.17, 0.18),
}
# On narrow band: how often rho of a rule is 0.05 and more above the simulated, and how often the
# gap of it and of the true standard deviations is too small by a twentieth and more.
TOO_HIGH = {
    "secant": (0.58, 0.49),
    "iwan_1980": (0.18, 0.14),
    "fema_440": (0.12, 0.10),
    "kasai_jagiasi_jeng_1996_unverified": (0.57, 0.53),
}
# The gap of the true standard deviations and the linearized rho over the simulated: least, largest.
FED = {BROAD: (0.80, 1.00), NARROW: (0.46, 1.26)}


@pytest.mark.slow
@pytest.mark.parametrize("band", [BROAD, NARROW], ids=["broad", "narrow"])
def test_how_near_linearization_and_the_rules_are_to_simulation(band):
    """Over 144 pairs: three periods, three strengths, 16 ratios. Means are exact to 0.003."""
    away = {name: [] for name in ("linearization", "drift", *RULES)}
    fed, higher, short = [], {name: [] for name in RULES}, {name: [] for name in RULES}
    for case in ((period, factor) for period in PERIODS for factor in FACTORS):
        found = simulated(band, *case)
        (linearized, rules), (drift, _) = formulas(band, *case), formulas(band, *case, "drift")
        curves = {"linearization": linearized.rho.values, "drift": drift.rho.values, **rules}
        needed = found.difference_std(found.rho)
        for name, rho in curves.items():
            away[name].append(apart(rho, found.rho))
        for name, rho in rules.items():
            higher[name].append(rho > found.rho + 0.05)
            short[name].append(found.difference_std(rho) < 0.95 * needed)
        fed.append(found.difference_std(linearized.rho.values) / needed)
    assert [np.mean(each) for each in away.values()] == pytest.approx(OFF[band], abs=0.007)
    assert (np.min(fed), np.max(fed)) == pytest.approx(FED[band], abs=0.02)
    assert not np.any(short["elastic"])
    if band == NARROW:
        by_period = np.reshape(away["linearization"], (len(PERIODS), -1)).mean(axis=1)
        assert by_period == pytest.approx([0.26, 0.10, 0.15], abs=0.007)
        for name, expected in TOO_HIGH.items():
            assert (np.mean(higher[name]), np.mean(short[name])) == pytest.approx(
                expected, abs=0.03
            )
        assert min(np.mean(higher[name]) for name in SIMPLIFIED) == np.mean(higher["fema_440"])


def test_on_narrow_band_a_rule_gives_higher_correlations_near_the_ground_period():
    """Iwan, R = 4, T2 = Tg: above linearization for T1 from .59 to .84 T2, simulation to 1.19."""
    found, (linearized, rules) = simulated(NARROW, 1.0, 4), formulas(NARROW, 1.0, 4)
    iwan = rules["iwan_1980"]
    between = (RATIOS > 0.55) & (RATIOS < 0.9)
    np.testing.assert_array_equal(iwan > linearized.rho.values, between)
    gap = found.difference_std(iwan) / found.difference_std(found.rho)
    assert (gap[(RATIOS < 0.55) | (RATIOS > 1.3)] > 1).all()
    assert gap[between | np.isclose(RATIOS, 2**0.25)].max() < 0.97
    assert gap.min() == pytest.approx(0.78, abs=0.02)


# ---- "rho rises with R", which Figs. 3b and 4 suggest ----


@pytest.mark.slow
def test_correlation_does_not_rise_with_strength_reduction_for_structures_stiffer_than_a_lake_bed():
    found = [simulated(NARROW, 0.5, factor) for factor in FACTORS]
    rho, error = (np.array([getattr(each, name)[0] for each in found]) for name in ("rho", "error"))
    assert (np.abs(rho - [0.58, 0.24, -0.02]) < 4 * error + SAME_AS_WRITTEN).all()  # T1/T2 = 1/4
    linearized = [float(formulas(NARROW, 0.5, factor)[0].rho[0]) for factor in FACTORS]
    np.testing.assert_allclose(linearized, [0.95, 0.93, 0.86], atol=SAME_AS_WRITTEN)
    falls = [RATIOS[after.rho < before.rho] for before, after in pairwise(found)]
    assert set(RATIOS[RATIOS < 0.55]) <= set(falls[0]) & set(falls[1])
    assert (falls[0] < 0.55).all()


# ---- "(4) can be used for linear structures on broad band", not on narrow band ----


@pytest.mark.parametrize(
    ("band", "gap", "rho"),
    [(BROAD, (0.98, 1.22), 0.04), (NARROW, (0.82, 4.78), 0.31)],
    ids=["broad", "narrow"],
)
def test_eq_4_for_linear_structures_holds_on_broad_band_alone(band, gap, rho):
    """Eq. (3) with the rho of eq. (4) over that with the ground's exact rho; T/Tg 0.25 to 4."""
    periods = GROUND_PERIOD * np.geomspace(0.25, 4, 81)
    first, second = (
        sl.Bilinear(xr.DataArray(periods, dims=name, coords={name: periods}), 0.05)
        for name in ("period_1", "period_2")
    )
    ground = sl.KanaiTajimi(GROUND_PERIOD, band)
    exact, formula = (
        sl.correlate(first, second, ground, m) for m in ("linearization", "white_noise")
    )
    needed, found = (
        sl.critical_gap(exact.displacement_std_1, exact.displacement_std_2, table.rho).gap
        for table in (exact, formula)
    )
    apart_in_period = exact.period_1 != exact.period_2
    ratio = (found / needed).where(apart_in_period)
    assert (float(ratio.min()), float(ratio.max())) == pytest.approx(gap, abs=SAME_AS_WRITTEN)
    off = np.abs(formula.rho - exact.rho).where(apart_in_period)
    assert float(off.mean()) == pytest.approx(rho, abs=SAME_AS_WRITTEN)


def test_the_ground_s_period_decides_on_narrow_band():
    """T1 = 0.7 T2, elastic: from T2 = Tg/4 to 4 Tg, and the largest and least between."""
    periods = xr.DataArray(np.geomspace(0.25, 4, 81), dims="period")
    pair = sl.Bilinear(0.7 * periods, 0.05), sl.Bilinear(periods, 0.05)
    narrow, broad = (
        sl.correlate(*pair, sl.KanaiTajimi(GROUND_PERIOD, band)).rho for band in (NARROW, BROAD)
    )
    for rho, least, largest in ((narrow, -0.37, 0.99), (broad, 0.04, 0.43)):
        assert float(rho.min()) == pytest.approx(least, abs=SAME_AS_WRITTEN)
        assert float(rho.max()) == pytest.approx(largest, abs=SAME_AS_WRITTEN)
    assert float(sl.rho_white_noise(0.7, 1.0, 0.05, 0.05).rho) == pytest.approx(
        0.07, abs=SAME_AS_WRITTEN
    )


def test_gaussian_z_leaves_the_range_of_the_law():
    """Eqs. (9), (10) take z as Gaussian; bounded by 1, it cannot be."""
    structures = yielding(1.0, xr.DataArray([2.0, 4.0, 6.0], dims="factor"))
    beyond = 2 * ndtr(-1 / sl.linearize(structures, sl.WhiteNoise(1.0)).z_std.values)
    np.testing.assert_allclose(beyond, [0.06, 0.18, 0.27], atol=SAME_AS_WRITTEN)
