"""Design spectra against the formulas of their codes, written out by hand; files of spectra."""

import json
import re

import numpy as np
import pytest
import xarray as xr
from motions import motion, write_at2

import stochlin as sl
from stochlin.applications.sites.design_spectra import reduced_eurocode_8
from stochlin.applications.sites.spectra import interpolated

G = 9.80665


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("soil", "kind", "period", "over_ag"),
    [
        ("A", 1, 0.0, 1.0),
        ("A", 1, 0.06, 1.6),
        ("A", 1, 0.3, 2.5),
        ("A", 1, 1.0, 2.5 * 0.4),
        ("A", 1, 3.0, 2.5 * 0.4 * 2.0 / 9.0),
        ("B", 1, 0.5, 1.2 * 2.5),
        ("C", 1, 1.2, 1.15 * 2.5 * 0.5),
        ("D", 1, 4.0, 1.35 * 2.5 * 0.8 * 2.0 / 16.0),
        ("E", 1, 1.0, 1.4 * 2.5 * 0.5),
        ("A", 2, 0.05, 2.5),
        ("B", 2, 1.0, 1.35 * 2.5 * 0.25),
        ("C", 2, 2.0, 1.5 * 2.5 * 0.25 * 1.2 / 4.0),
        ("d", 2, 0.3, 1.8 * 2.5),
        ("E", 2, 0.0, 1.6),
    ],
)
def test_eurocode_8_has_its_tabled_values(soil, kind, period, over_ag):
    spectrum = sl.eurocode_8(2.0, soil, kind)
    assert float(spectrum.sel(period=period, method="nearest")) == pytest.approx(2.0 * over_ag)


@pytest.mark.invariant
def test_ground_and_type_of_eurocode_8_are_those_of_its_tables():
    with pytest.raises(ValueError, match="soil = 'F' is no ground type; allowed: A, B, C, D, E"):
        sl.eurocode_8(2.0, "F")
    with pytest.raises(ValueError, match="type = 3 is unknown; allowed: 1, 2"):
        sl.eurocode_8(2.0, "B", 3)


@pytest.mark.extreme
@pytest.mark.oracle
def test_damping_of_eurocode_8():
    two, five, thirty = (
        sl.eurocode_8(2.0, "B", damping=x).sel(period=0.3) for x in (0.02, 0.05, 0.3)
    )
    assert float(two / five) == pytest.approx(np.sqrt(10 / 7))
    assert float(thirty / five) == pytest.approx(0.55)


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("period", "behaviour", "over_ag"),
    [
        (0.0, 3.0, 1.15 * 2 / 3),  # (3.13)
        (0.1, 3.0, 1.15 * (2 / 3 + 0.5 * (2.5 / 3 - 2 / 3))),
        (0.1, 1.0, 1.15 * (2 / 3 + 0.5 * (2.5 - 2 / 3))),
        (0.4, 3.0, 1.15 * 2.5 / 3),  # (3.14)
        (1.2, 3.0, 1.15 * 2.5 / 3 * 0.5),  # (3.15)
        (3.0, 1.5, 1.15 * 2.5 / 1.5 * 0.6 * 2.0 / 9.0),  # (3.16): 0.256
        (1.2, 8.0, 0.2),  # 1.15 * 2.5 / 8 * 0.5 = 0.180 is less
        (3.0, 3.0, 0.2),  # 0.128 is less
    ],
)
def test_design_spectrum_of_eurocode_8_by_hand(period, behaviour, over_ag):
    """EN 1998-1, 3.2.2.5, ground C, type 1: S = 1.15, TB = 0.2, TC = 0.6, TD = 2 s; beta = 0.2."""
    elastic = sl.eurocode_8(2.0, "C", damping=0.02)  # q includes the damping
    reduced = reduced_eurocode_8(elastic, period, behaviour)
    assert reduced == pytest.approx(2.0 * over_ag, rel=1e-12)
    strong = (3 * elastic).assign_attrs(elastic.attrs)
    assert reduced_eurocode_8(strong, period, behaviour) == pytest.approx(3 * reduced, rel=1e-12)


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("period", "over_g"),
    [(0.0, 0.4), (0.06, 0.7), (0.12, 1.0), (0.6, 1.0), (1.2, 0.5), (8.0, 0.075), (10.0, 0.048)],
)
def test_asce_7_has_its_values_by_hand(period, over_g):
    spectrum = sl.asce_7(G, 0.6 * G, 8.0)
    assert float(spectrum.sel(period=period, method="nearest")) == pytest.approx(over_g * G)


@pytest.mark.oracle
def test_corners_of_asce_7_are_among_its_periods():
    spectrum = sl.asce_7(1.3 * G, 0.4567 * G, 6.0)
    for corner in (0.2 * 0.4567 / 1.3, 0.4567 / 1.3, 6.0):
        assert np.abs(spectrum.period - corner).min() < 1e-12
    assert float(spectrum.max()) == pytest.approx(1.3 * G)


def written(path, rows, head="T,Sa [g]"):
    path.write_text("\n".join([head, *rows]), encoding="utf-8")
    return path


def of_code():
    period = np.array([0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.7, 1, 1.4, 2, 2.8, 4])
    shape = sl.eurocode_8(2.0, "B").interp(period=period).values / G
    return [f"{t:g},{a:.9g}" for t, a in zip(period, shape, strict=True)]


def test_a_file_gives_what_was_written(tmp_path):
    spectrum = sl.read_spectrum(written(tmp_path / "site.csv", of_code()), elastic=True)
    np.testing.assert_allclose(
        spectrum, sl.eurocode_8(2.0, "B").interp(period=spectrum.period), rtol=1e-8
    )
    assert spectrum.attrs["source"] == "site.csv"
    plain = written(tmp_path / "plain.csv", of_code(), "T,Sa")
    same = sl.read_spectrum(plain, units="g", damping=0.02, elastic=True)
    np.testing.assert_array_equal(same, spectrum)
    assert same.attrs["damping"] == 0.02


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("rows", "head", "message"),
    [
        (
            of_code(),
            "T,Sa",
            "the file does not say the unit of the acceleration; give units=, allowed: g",
        ),
        (
            [*of_code()[:5], "0.25,-1"],
            None,
            "line 7: the acceleration at 0.25 s is -9.8.*allowed: posit",
        ),
        ([*of_code()[:5], "0.15,1"], None, "(time|period|increas)"),
        (of_code()[:3], None, "spectrum has 3 points; allowed: 4 or more"),
    ],
)
def test_a_file_that_holds_no_spectrum_is_refused(tmp_path, rows, head, message):
    with pytest.raises(ValueError, match=message):
        sl.read_spectrum(written(tmp_path / "site.csv", rows, head or "T,Sa [g]"), elastic=True)


@pytest.mark.parametrize(
    ("between", "at_350_ms"), [("linear", 0.9 - 0.15 * 0.4 / 0.3), ("logarithmic", None)]
)
def test_a_spectrum_of_six_points_is_read_as_its_code_says(tmp_path, between, at_350_ms):
    """Those of Canada, linear between; the other is a line of the logarithms."""
    points = {0.2: 0.9, 0.5: 0.5, 1.0: 0.26, 2.0: 0.12, 5.0: 0.03, 10.0: 0.01}
    rows = [f"{t},{sa}" for t, sa in points.items()]
    path = written(tmp_path / "site.csv", rows)
    spectrum = sl.read_spectrum(path, between=between, elastic=True)

    def at(period):
        return interpolated(spectrum.period.values, spectrum.values, np.array([period])).item() / G

    assert at(0.35) == pytest.approx(
        at_350_ms or 0.9 * (0.5 / 0.9) ** (np.log(1.75) / np.log(2.5)), rel=1e-4
    )
    for period, ordinate in points.items():
        assert at(period) == pytest.approx(ordinate, rel=1e-12)
    with pytest.warns(UserWarning, match="its points are far apart; .* or between='linear'"):
        sl.read_spectrum(path, elastic=True)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("change", "error", "message"),
    [
        (lambda s: s.to_numpy(), TypeError, "ndarray"),
        (lambda s: s.assign_attrs(units="g"), ValueError, "units 'g'; allowed: m/s"),
        (
            lambda s: xr.DataArray(s.values, coords=s.coords),
            ValueError,
            "no attribute units; allowed: m/s",
        ),
        (lambda s: s.assign_attrs(damping=5), ValueError, "damping 5; allowed: 0 < damping < 1"),
        (lambda s: s[::-1], ValueError, "allowed: increasing periods"),
        (lambda s: s.where(s.period != 1.0), ValueError, "at 1 s is nan; allowed: positive$"),
        (
            lambda s: s.copy(data=s.period.values).assign_coords(period=s.values),
            ValueError,
            "or are the columns of periods and ordinates exchanged",
        ),
        (lambda s: s.sel(period=slice(0.2, 0.5)), ValueError, "half a decade"),
    ],
)
def test_an_array_that_is_no_spectrum_is_refused(change, error, message):
    spectrum = sl.eurocode_8(2.0, "B")
    with pytest.raises(error, match=message):
        sl.fit_ground(change(spectrum), duration=20.0)


def test_a_record_in_place_of_a_spectrum_is_named(tmp_path):
    """Its header and its rows are no columns, which would be asked for one by one."""
    write_at2(motion(np.sin(np.arange(64.0))), tmp_path / "site.csv")
    with pytest.raises(
        ValueError, match=r"^site\.csv is a record, an AT2 file; allowed: a spectrum"
    ):
        sl.read_spectrum(tmp_path / "site.csv", elastic=True)


PERIODS = [
    0,
    0.01,
    0.02,
    0.03,
    0.05,
    0.075,
    0.1,
    0.15,
    0.2,
    0.3,
    0.5,
    0.75,
    1,
    1.5,
    2,
    3,
    4,
    5,
    7.5,
    10,
]


def usgs(**names):
    """A response of the design services of the USGS with spectra of ASCE 7, each times a number."""
    spectrum = sl.asce_7(G, 0.6 * G, 8.0).interp(period=PERIODS) / G
    data = {
        name: {"periods": PERIODS, "ordinates": (times * spectrum).values.tolist()}
        for name, times in names.items()
    }
    return json.dumps({"request": {}, "response": {"data": {"sds": 1.0, **data}, "metadata": {}}})


ALL = {
    "multiPeriodMCErSpectrum": 1.5,
    "twoPeriodMCErSpectrum": 1.6,
    "twoPeriodDesignSpectrum": 1.1,
    "multiPeriodDesignSpectrum": 1.0,
    "verticalDesignSpectrum": 0.7,
}


@pytest.mark.oracle
@pytest.mark.parametrize(
    ("there", "column", "read"),
    [
        (ALL, None, "multiPeriodDesignSpectrum"),
        (["twoPeriodDesignSpectrum", "multiPeriodMCErSpectrum"], None, "twoPeriodDesignSpectrum"),
        *((ALL, name, name) for name in [*ALL][:4]),
    ],
)
def test_a_response_of_the_usgs_is_read_and_says_which_spectrum_it_is(
    tmp_path, there, column, read
):
    path = tmp_path / "asce.json"
    path.write_text(usgs(**{name: ALL[name] for name in there}), encoding="utf-8")
    spectrum = sl.read_spectrum(path, column=column)
    expected = ALL[read] * sl.asce_7(G, 0.6 * G, 8.0).interp(period=PERIODS)
    np.testing.assert_allclose(spectrum.values, expected.values)
    assert spectrum.attrs["spectrum"] == read
    assert spectrum.period.values.tolist() == PERIODS


USGS_REFUSALS = {
    "u.json has no design spectrum; allowed as column: multiPeriodMCErSpectrum": (
        usgs(multiPeriodMCErSpectrum=1.5),
        {},
    ),
    "'verticalDesignSpectrum' is not in u.json; allowed as column: multiPeriodDesignSpectrum": (
        usgs(multiPeriodDesignSpectrum=1, verticalDesignSpectrum=1),
        {"column": "verticalDesignSpectrum"},
    ),
    "u.json has no design spectrum; allowed: the response for ASCE 7-22": (usgs(), {}),
    "u.json is JSON and no response of the design services": ('{"a": 1}', {}),
    "no response of the design": ('{"a": ', {}),
    "number 5: the period is None; allowed: a finite number": (
        usgs(multiPeriodDesignSpectrum=1).replace("0.05", "null", 1),
        {},
    ),
    "19 periods beside 20 ordinates; allowed: as many of both": (
        usgs(multiPeriodDesignSpectrum=1).replace("0.05, ", "", 1),
        {},
    ),
    "contradicts u.json, which states 'g'; correct it, or leave it out": (
        usgs(multiPeriodDesignSpectrum=1),
        {"units": "m/s^2"},
    ),
    "damping = 0.02 contradicts u.json, whose spectra have 0.05; leave it out": (
        usgs(multiPeriodDesignSpectrum=1),
        {"damping": 0.02},
    ),
}


@pytest.mark.oracle
@pytest.mark.parametrize("message", USGS_REFUSALS)
def test_what_is_no_spectrum_of_the_usgs_is_refused(tmp_path, message):
    text, options = USGS_REFUSALS[message]
    path = tmp_path / "u.json"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=re.escape(message)):
        sl.read_spectrum(path, **options)
