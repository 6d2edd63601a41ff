"""Hazards of OpenQuake, the USGS and in columns: known curves come back, others are refused."""

import json
import re

import numpy as np
import pytest
import samples

import stochlin as sl

pytestmark = pytest.mark.oracle

G = 9.80665
LEVELS = np.geomspace(0.05, 6.4, 8)  # g
PERIODS = {"PGA": 0.0, "SA(0.2)": 0.2, "SA(0.5)": 0.5, "SA(2.0)": 2.0}
PGA = "hazard_curve-mean-PGA_17.csv"


def frequency(period=0.0):
    """A power law; the acceleration of the same frequency falls with the period to the 0.8."""
    return 1e-6 * (LEVELS / (period**-0.8 if period else 1.0)) ** -2.5


def probability(period=0.0):
    return -np.expm1(-50 * frequency(period))


def write(folder, text, name=PGA):
    path = folder / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def openquake(measure="PGA"):
    row = probability(PERIODS[measure])
    sites = {(-99.17, 19.33): row, (-99.05, 19.40): row / 2, (-99.06, 19.41): row / 3}
    return samples.openquake(LEVELS, sites, measure)


def columns(head, *of, separator=","):
    return "\n".join(
        [head, *(separator.join(map(repr, map(float, row))) for row in zip(*of, strict=True))]
    )


SITES = openquake()
USGS = samples.usgs(
    {
        name: (LEVELS, frequency(period))
        for name, period in zip(("PGA", "SA0P2", "SA0P5", "SA2P0"), PERIODS.values(), strict=True)
    }
    | {"PGV": ([1.0, 100.0], [0.1, 1e-4])}
)


def changed_usgs(**first):
    """The response with other first values of the curve of the PGA."""
    response = json.loads(USGS)
    values = response["response"]["hazardCurves"][0]["data"][1]["values"]
    for axis, value in first.items():
        values[axis][0] = value
    return json.dumps(response)


OF_IDS = re.sub(r"(?m)^(-9)", r"roma,\1", SITES).replace("lon,", "custom_site_id,lon,")
TOTAL = "\n".join(
    ["name,lon,lat," + ",".join(f"{level:.9f}" for level in LEVELS)]
    + [
        f"{name},{lon},19.33," + ",".join(map(repr, frequency().tolist()))
        for name, lon in (("a", -99.17), ("b", -90))
    ]
)
ENDLESS = columns("pga [g],annual rate", [*LEVELS, 7, 8], [*frequency(), 0, 0])
# Text, name of the file and options of each curve, which is the power law.
READINGS = {
    "OpenQuake by number": (SITES, PGA, {"site": 1}),
    "OpenQuake by place": (SITES, PGA, {"site": (-99.172, 19.328)}),
    "OpenQuake with the names of sites": (OF_IDS, PGA, {"site": 1}),
    "nshmp": (TOTAL, "PGA/total.csv", {"site": 1}),
    "USGS": (USGS, "hazard.json", {}),
    "USGS before 2022": (samples.usgs_before_2022(USGS), "hazard.json", {}),
    "USGS before 2022, 2 s": (
        samples.usgs_before_2022(USGS),
        "hazard.json",
        {"measure": "sa", "period": 2},
    ),
    **{
        f"USGS, {T} s": (USGS, "hazard.json", {"measure": "sa", "period": T})
        for T in (0.2, 0.21, 0.3, 1.9, 2)
    },
    "columns": (columns("pga [g],annual frequency", LEVELS, frequency()), "a.csv", {}),
    "no names": (
        columns("# g", LEVELS, frequency(), separator="\t"),
        "a.csv",
        {"units": "g", "column": 1, "frequency_column": 2},
    ),
    "among others": (
        columns("n;iml [g];rate", range(8), LEVELS, frequency(), separator=";"),
        "a.csv",
        {},
    ),
    "zeros at the end": (ENDLESS, "a.csv", {}),
    "probabilities": (
        columns("pga [g],probability", LEVELS, probability()),
        "a.csv",
        {"investigation_time": 50},
    ),
}


@pytest.mark.filterwarnings("ignore::stochlin.messages.ImplausibleInput")  # of low seismicity
@pytest.mark.parametrize("case", READINGS)
def test_every_form_gives_the_same_curve(tmp_path, case):
    text, name, options = READINGS[case]
    hazard = sl.read_hazard(write(tmp_path, text, name), **options)
    period = options.get("period", 0.0)
    assert (hazard.measure, hazard.period) == (options.get("measure", "pga"), period or None)
    levels = np.array(hazard.intensities) / G
    exact = 1e-6 * (levels / (period**-0.8 if period else 1.0)) ** -2.5
    np.testing.assert_allclose(
        hazard.frequencies, exact, rtol=1e-5
    )  # six printed digits of a probability
    assert len(levels) >= 6


@pytest.mark.filterwarnings("ignore::stochlin.messages.ImplausibleInput")  # of low seismicity
@pytest.mark.parametrize("period", [0.2, 0.7, 2.0])
def test_between_two_files_a_power_law_is_exact(tmp_path, period):
    """Its accelerations of one frequency are a power of the period: logarithms lie on lines."""
    files = [
        write(tmp_path, openquake(of), f"{of}.csv")
        for of in ("SA(2.0)", "PGA", "SA(0.2)", "SA(0.5)")
    ]
    hazard = sl.read_hazard(files, "sa", period=period, site=1)
    exact = 1e-6 * (np.array(hazard.intensities) / G * period**0.8) ** -2.5
    np.testing.assert_allclose(hazard.frequencies, exact, rtol=1e-5)


def test_points_without_a_frequency_of_their_own_are_left_out(tmp_path):
    levels, poe = [0.01, 0.02, 0.04, 0.08, 0.16, 0.32], [1, 0.5, 0.5, 0.1, 0.0, 0.0]
    hazard = sl.read_hazard(write(tmp_path, samples.openquake(levels, {(0, 0): poe})))
    np.testing.assert_allclose(np.array(hazard.intensities) / G, [0.04, 0.08])
    np.testing.assert_allclose(hazard.frequencies, [np.log(2) / 50, -np.log(0.9) / 50])


ONE = samples.openquake(LEVELS, {(0.0, 0.0): probability()})
REFUSALS = {
    r"site is missing: .* has 1 \(-99\.17, 19\.33\), 2 .*; give its number": SITES,
    "site = 0 is unknown": (SITES, {"site": 0}),
    r"where the nearest is 2 \(-99\.05, 19\.4\)": (SITES, {"site": (-99.1, 19.33)}),
    "units = 'gal' contradicts .* states 'g'": (SITES, {"site": 1, "units": "gal"}),
    "period = 1 is beyond .*: within PGA": (SITES, {"site": 1, "measure": "sa", "period": 1.0}),
    "states 50 years, which investigation_time = 1 contradicts": (
        SITES,
        {"site": 1, "investigation_time": 1},
    ),
    "imt, iml, poe; allowed: a hazard curve": (
        "lon,lat,imt,iml,poe\n12,41,PGA,.1,.3\n12,41,PGA,.2,.1\n"
    ),
    "pga-0.02; allowed: a hazard curve": "lon,lat,PGA-0.1,PGA-0.02\n12,41,.3,.7\n13,41,.3,.6\n",
    r"allowed: imt='PGA' or imt='SA\(0\.5\)', or a folder SA0P5": (TOTAL, {"site": 1}),
    "line 3, column 4: 'x.0E-02' is not a probability": re.sub(r"\d\.\d+E", "x.0E", ONE, count=1),
    "has no site, or a name twice; allowed": "\n".join(ONE.split("\n")[:2]),
    "the table does not state the time": ONE.replace("investigation_time", "time"),
    r"'PGV'; allowed: imt='PGA' or imt='SA\(0\.5\)'": ONE.replace("'PGA'", "'PGV'"),
    "line 3, column 5: the annual frequency .* follows .*; allowed: falling": samples.openquake(
        [0.1, 0.2, 0.3], {(0, 0): [0.1, 0.2, 0.01]}
    ),
    "annual frequency 0.01 follows 0.00210526": "pga [g],return period\n.1,475\n.2,100\n",
    "2 'rate density': a density; allowed: a column": "pga [g],rate density\n.1,.01\n.2,.001\n",
    "2 'CDF': a probability that it is not exceeded": "pga [g],CDF\n.1,.9\n.2,.99\n",
    "2 'pdf', and frequency_column = 2 is a density": (
        "pga [g],pdf\n.1,.01\n.2,.001\n",
        {"frequency_column": 2},
    ),
    "has 'poe', a probability; give investigation_time=": columns(
        "pga [g],poe", LEVELS, probability()
    ),
    "line 3: the annual frequency is 0": columns("pga [g],rate", [0.1, 0.2, 0.3], [1, 0, 0.1]),
    "site = 1 does not apply": (columns("pga [g],rate", LEVELS, frequency()), {"site": 1}),
    r"is no response of the hazard service of the USGS \(Expecting": '{"response": [',
    r"the USGS \('response'\); allowed: the whole response": '{"answer": []}',
    "PGA, number 1: the intensity is 'few'; allowed: a finite": changed_usgs(xs="few"),
    "csv, PGA: 7 xs beside 8 ys; allowed: as many of both": USGS.replace("[0.05, ", "[", 1),
    "PGA, number 1: the annual frequency is inf; allowed: a finite number": changed_usgs(ys=np.inf),
    "PGA, number 1: the annual frequency is nan; allowed": changed_usgs(ys=np.nan),
    "PGA, number 1: the intensity is inf; allowed": changed_usgs(xs=-np.inf).replace(
        "-Inf", "Inf", 1
    ),
    "PGA, number 1: the intensity is -inf; allowed": changed_usgs(xs=-np.inf),
    "PGA, number 1: the intensity is True; allowed": changed_usgs(xs=True),
    "PGA, number 1: the intensity is None; allowed": changed_usgs(xs=None),
    "PGA, number 1: the annual frequency is '0.1'; allowed": changed_usgs(ys="0.1"),
    "PGA, number 1: the annual frequency is inf; allowed: a": changed_usgs(ys=10**400),
    "PGA, number 1: the annual frequency is -inf; allowed": changed_usgs(ys=7.5).replace(
        "7.5", "-1e400"
    ),
    "PGA, number 1: the annual frequency is -0.1; allowed: positive": changed_usgs(ys=-0.1),
    "PGA, number 1: the annual frequency is 1e.30; allowed: 10000 a year": changed_usgs(ys=1e30),
    r"the USGS \(PGA has 2 components 'Total' in place of 1\); allowed": USGS.replace(
        "Grid", "Total", 1
    ),
    r"the USGS \(PGA has 0 components 'Total' in place of 1\); allowed": USGS.replace(
        "Total", "All", 1
    ),
    "csv: PGA is there twice": USGS.replace("SA0P2", "PGA"),
    r"the USGS \(an object has the key 'response' twice\); allowed": USGS.replace(
        "status", "response", 1
    ),
    r"the USGS \(an object has the key 'ys' twice\); allowed": USGS.replace('"xs"', '"ys"', 1),
    r"the USGS \(maximum recursion depth": '{"response": ' + 100_000 * "[" + 100_000 * "]" + "}",
    "2 'IML': an intensity; allowed: a column of an annual": columns(
        "iml [g],IML", LEVELS, frequency()
    ),
    "give column= .* from 1, as column=1": columns("iml,iml,rate", LEVELS, LEVELS, frequency()),
    "line 2, column 2: 'inf' is not an annual": "pga [g],rate\n0.1,inf\n0.2,0.1\n0.3,0.01\n",
    "line 3, column 2: '1e400' is not an annual": "pga [g],rate\n0.1,1\n0.2,1e400\n0.3,0.01\n",
    "line 2: the annual frequency is 1e.06; allowed: 10000": "pga [g],rate\n0.1,1e6\n0.2,0.1\n",
    "the file does not say the unit of the acceleration; give units=": USGS.replace("(g)", ""),
    r"period = 0\.1 is beyond .*PGA, SA\(0\.2": (USGS, {"measure": "sa", "period": 0.1}),
    "units = 'g'; allowed with intensity: none": (USGS, {"measure": "intensity", "units": "g"}),
    "measure = 'intensity' is not in .*; allowed: PGA": (USGS, {"measure": "intensity"}),
    "1 'first', 2 .*; give column= .* and frequency_column=": (
        "first,second,third\n.1,5,.2\n.2,6,.1\n"
    ),
    "site = 1 does not apply: .* is a response of the USGS": (USGS, {"site": 1}),
}


def test_return_periods_are_read_and_said(tmp_path):
    titles = {"IML [g]": LEVELS, "Tr (yr)": 1 / (100 * frequency())}
    curve = sl.read_hazard(write(tmp_path, columns(",".join(titles), *titles.values()), "site.csv"))
    np.testing.assert_allclose(curve.frequencies, 100 * frequency(), rtol=1e-12)
    assert curve.source == "site.csv; column 2 'Tr (yr)' is a return period, converted"


def test_columns_by_number_are_said(tmp_path):
    path = write(tmp_path, columns("a,b", LEVELS, 100 * frequency()), "site.csv")
    curve = sl.read_hazard(path, units="g", column=1, frequency_column=2)
    assert curve.source == (
        "site.csv; column 1 'a' is an acceleration; column 2 'b' is an annual frequency"
    )
    assert curve == sl.HazardCurve(curve.intensities, curve.frequencies)


@pytest.mark.parametrize("message", REFUSALS)
def test_what_is_no_hazard_curve_is_refused(tmp_path, message):
    text, options = row if isinstance(row := REFUSALS[message], tuple) else (row, {})
    with pytest.raises((ValueError, TypeError), match=message):
        sl.read_hazard(write(tmp_path, text), **options)


@pytest.mark.parametrize("years", [50, 1000])
@pytest.mark.parametrize(
    "form", ["rate per {} years", "rate (1/{} yr)", "frequency in {} a", "tasa (1/{} años)"]
)
def test_frequencies_of_several_years_are_no_annual_ones(tmp_path, form, years):
    """They are refused with the divisor, unless the column is asked for by its number."""
    rows = "0.1,0.02\n0.2,0.002\n0.4,0.0002\n"
    path = write(tmp_path, f"pga [g],{form.format(years)}\n{rows}")
    with pytest.raises(ValueError, match=f"annual frequencies, so divide them by {years}"):
        sl.read_hazard(path)
    annual = sl.read_hazard(write(tmp_path, f"pga [g],{form.format(1)}\n{rows}", "annual.csv"))
    assert sl.read_hazard(path, frequency_column=2) == annual


def test_files_that_do_not_fit_are_refused(tmp_path):
    twice = write(tmp_path, SITES)
    with pytest.raises(ValueError, match=r"17\.csv: PGA is there twice"):
        sl.read_hazard([twice, twice], site=1)
    apart = json.loads(USGS)
    apart["response"]["hazardCurves"][2]["data"][1]["values"]["ys"] = [
        1e-9 * 0.1**n for n in range(8)
    ]
    with pytest.raises(ValueError, match=r"SA\(0\.2\) and SA\(0\.5\) do not overlap in frequency"):
        sl.read_hazard(write(tmp_path, json.dumps(apart)), "sa", period=0.3)
