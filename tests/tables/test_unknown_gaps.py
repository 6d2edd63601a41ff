"""What is not known never counts as safe: NaN in place of a gap, of a sample or of a peak."""

import inspect

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.applications.risk.rates import SeparationsByIntensity, lognormal_fragility
from stochlin.applications.separation.code_gaps import Rule
from stochlin.applications.separation.separation import NOT_AVAILABLE, judged_rules
from stochlin.solver.simulation.statistics import keeping_apart, quantile_interval

pytestmark = pytest.mark.invariant

NAN = float("nan")
ONE, TWO = (sl.Bilinear(period, 0.05, mass=1e5) for period in (0.6, 1.0))
FIRM = sl.named_ground("firm", intensity=0.01)
TIME = 0.02 * np.arange(500)
RECORD = xr.DataArray(
    np.sin(5 * TIME), dims="time", coords={"time": TIME}, attrs={"units": "m/s^2"}
)
HAZARD = sl.HazardCurve([0.1, 1.0, 10.0], [0.1, 0.01, 0.001])
STEEL = sl.Kelvin(1e8, restitution=0.65)
MEASURES = {"dampers": sl.Measure(0.1, 0.1)}
SAMPLES = xr.DataArray(np.linspace(0.01, 0.4, 64), dims="path")
MOTION = {"duration": 10.0, "paths": 64}

OF_NUMBERS = {
    "damping_for_gap": lambda gap: sl.damping_for_gap(RECORD, ONE, TWO, gap),
    "existing_gap": lambda gap: sl.existing_gap(ONE, TWO, FIRM, gap=gap, **MOTION),
    "mitigate": lambda gap: sl.mitigate(ONE, TWO, FIRM, gap=gap, measures=MEASURES, **MOTION),
    "pound": lambda gap: sl.pound([ONE, TWO, ONE], [0.1, gap], STEEL, RECORD),
    "pounding_risk": lambda gap: sl.pounding_risk(ONE, TWO, FIRM, gap, HAZARD, **MOTION),
    "code rule": lambda peak: sl.rules.code_rule("asce_7").gap(peak, 0.1),
}
OF_TABLES = {
    "passage_gap": lambda gap: sl.passage_gap(ONE, TWO, FIRM, 10.0, gap=gap),
    "exceedance": lambda gap: sl.exceedance(SAMPLES, gap),
    "pounding_estimate": lambda gap: sl.pounding_estimate(
        ONE, TWO, gap, sl.Stereomechanical(0.65), 0.1, 0.1
    ),
    "pounding_fragility": lambda gap: sl.pounding_fragility(
        ONE, TWO, FIRM, gap, [0.01, 0.04], **MOTION
    ),
    "pounding_probability": lambda gap: sl.pounding_probability(ONE, TWO, FIRM, gap, **MOTION),
    "pounding_probability hybrid": lambda gap: sl.pounding_probability(
        ONE, TWO, FIRM, gap, method="hybrid", record=RECORD
    ),
    "critical_gap": lambda peak: sl.critical_gap(peak, 0.1, 0.5),
    "code_gaps": lambda peak: sl.code_gaps(peak, 0.1),
}


def axis(values, coordinates=None):
    coords = {} if coordinates is None else {"spot": coordinates}
    return xr.DataArray(values, dims="spot", coords=coords)


def test_every_function_of_a_gap_is_below():
    takes_gap = {
        name
        for name in sl.__all__
        if inspect.isfunction(function := getattr(sl, name))
        and {"gap", "gaps"} & {*inspect.signature(function).parameters}
    }
    assert takes_gap <= {*OF_NUMBERS, *OF_TABLES}


@pytest.mark.parametrize("name", [*OF_NUMBERS, *OF_TABLES])
def test_a_single_gap_that_is_nan_is_refused(name):
    call = (OF_NUMBERS | OF_TABLES)[name]
    with pytest.raises(ValueError, match="nan") as caught:
        call(NAN)
    assert "allowed: " in str(caught.value)
    with pytest.raises((ValueError, TypeError)):
        call(xr.DataArray(NAN))


@pytest.mark.parametrize("name", OF_TABLES)
def test_a_gap_that_is_nan_is_a_cell_of_its_own(name):
    """It is NaN with a status, and the other cells are those of a table without it."""
    call = OF_TABLES[name]
    table, known = call(axis([0.05, NAN, 0.2])), call(axis([0.05, 0.2]))
    missing, rest = table.isel(spot=1), table.isel(spot=[0, 2])
    xr.testing.assert_equal(rest.drop_attrs(), known.drop_attrs())
    over_gaps = [each for each in table.data_vars if "spot" in table[each].dims]
    assert over_gaps
    for each in over_gaps:
        if missing[each].dtype.kind == "f":
            assert missing[each].isnull().all(), each
    assert (missing.status == 3).all()
    assert table.status.attrs["flag_meanings"].split()[3] == "invalid_input"


@pytest.mark.parametrize("name", ["pounding_probability", "pounding_fragility"])
@pytest.mark.parametrize("dim", ["path", "time", "height"])
def test_gaps_lie_along_no_dimension_of_the_result(name, dim):
    """A gap along the motions would be compared with one motion each."""
    with pytest.raises(ValueError, match=f"a dimension is named '{dim}'"):
        OF_TABLES[name](axis(np.linspace(0.01, 0.4, 64)).rename(spot=dim))


@pytest.mark.parametrize(
    "name", ["exceedance", "pounding_estimate", "pounding_fragility", "pounding_probability"]
)
def test_no_dimension_of_a_gap_takes_the_place_of_the_status(name):
    """Where it did, nothing said which of the cells are NaN and why."""
    with pytest.raises(ValueError, match="a dimension is named 'status'"):
        OF_TABLES[name](axis([0.05, NAN]).rename(spot="status"))


def test_what_exceedance_cannot_name_is_refused():
    for coordinate in ("probability", "path"):
        with pytest.raises(ValueError, match=f"named '{coordinate}', as a part of the result"):
            sl.exceedance(
                SAMPLES, axis(0.1 * np.ones(1)).isel(spot=0).assign_coords({coordinate: 3})
            )


@pytest.mark.parametrize("name", OF_TABLES)
def test_an_uncertain_gap_is_refused(name):
    with pytest.raises((ValueError, TypeError), match=r"uncertain; allowed|± 10 %.*; allowed"):
        OF_TABLES[name](sl.Uncertain(0.1, 0.1))


X, Y = axis([0.05, 0.1], [1, 2]), axis([0.05, 0.1], [2, 3])
PAIRS = {
    "exceedance": lambda: sl.exceedance(SAMPLES * X, Y),
    "exceedance over paths": lambda: sl.exceedance(X.rename(spot="path"), Y.rename(spot="path")),
    "pounding_estimate": lambda: sl.pounding_estimate(
        ONE, TWO, X, sl.Stereomechanical(0.65), Y, 0.1
    ),
    "pounding_estimate of structures": lambda: sl.pounding_estimate(
        sl.Bilinear(10 * X, 0.05, mass=1e5), TWO, Y, sl.Stereomechanical(0.65), 0.1, 0.1
    ),
    "pounding_probability": lambda: sl.pounding_probability(
        sl.Bilinear(10 * X, 0.05), TWO, FIRM, Y, **MOTION
    ),
    "critical_gap": lambda: sl.critical_gap(X, Y, 0.5),
    "code_gaps": lambda: sl.code_gaps(X, Y),
    "recorded_gap": lambda: sl.recorded_gap(
        sl.Bilinear(10 * X, 0.05), sl.Bilinear(10 * Y, 0.05), RECORD
    ),
    "damping_for_gap": lambda: sl.damping_for_gap(
        RECORD, sl.Bilinear(10 * X, 0.05), sl.Bilinear(10 * Y, 0.05), 0.1
    ),
    "energy_gap": lambda: sl.energy_gap(
        sl.Bilinear(10 * X, 0.05), sl.Bilinear(10 * Y, 0.05), RECORD
    ),
}


@pytest.mark.parametrize("name", PAIRS)
def test_other_coordinates_are_not_joined(name):
    with pytest.raises(ValueError, match="share a dimension whose coordinates or lengths differ: "):
        PAIRS[name]()


def test_a_sample_that_is_nan_makes_its_cell_unknown():
    samples = xr.concat([SAMPLES, SAMPLES.where(SAMPLES < 0.3), SAMPLES], "floor")
    table, known = sl.exceedance(samples, 0.25), sl.exceedance(SAMPLES, 0.25)
    assert table.status.values.tolist() == [0, 3, 0]
    for name in ("probability", "probability_lower", "probability_upper"):
        np.testing.assert_array_equal(table[name], [known[name], NAN, known[name]])
    with pytest.raises(ValueError, match=r"^samples: nan is among"):
        sl.exceedance(samples[1], 0.25)
    with pytest.raises(ValueError, match=r"^samples is empty"):
        sl.exceedance(SAMPLES[:0], 0.25)


def test_infinity_is_known():
    """What falls exceeds any gap; an infinite gap is exceeded by nothing else."""
    samples = xr.DataArray([0.1, 0.2, np.inf, -np.inf], dims="path")
    table = sl.exceedance(samples, xr.DataArray([-np.inf, 0.15, np.inf], dims="gap"))
    assert table.probability.values.tolist() == [0.75, 0.5, 0.25]
    assert (table.status == 0).all()
    assert float(sl.exceedance(samples, np.inf).probability) == 0.25


def test_shares_quantiles_and_verdicts_of_unknown_samples_are_unknown():
    samples = xr.concat([SAMPLES, SAMPLES.where(SAMPLES < 0.3)], "floor").transpose("path", "floor")
    apart = keeping_apart(samples, 0.5)
    assert all(share.isnull().values.tolist() == [False, True] for share in apart.values())
    for each in quantile_interval(samples.values, 0.9):
        assert np.isnan(each).tolist() == [False, True]

    rules = [Rule("stated", "stated", np.array([gap])) for gap in (0.3, NAN)]
    judged = judged_rules(rules, SAMPLES, 0.9, 0.35)
    assert (judged.verdict == NOT_AVAILABLE).values.tolist() == [False, True]
    assert np.isnan(judged.no_pounding_probability[1])
    motions = SeparationsByIntensity(np.array([1.0, 2.0]), np.array([[0.1, 0.2], [0.1, NAN]]))
    assert np.isnan(lognormal_fragility(motions, 0.15)[:4]).all()


@pytest.mark.filterwarnings("ignore:.*are the same motion")
@pytest.mark.parametrize("records", [[RECORD, 2 * RECORD]])
def test_quantiles_over_records_of_a_failed_cell_are_unknown(records):
    structure = sl.Bilinear(axis([0.5, NAN]), 0.05)
    table = sl.recorded_gap(structure, TWO, records)
    for end in ("", "_lower", "_upper"):
        values = table[f"separation_quantile{end}"].transpose("spot", ...)
        assert values[0].notnull().all()
        assert values[1].isnull().all()
