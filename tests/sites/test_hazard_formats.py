"""Hazards of OpenQuake and the USGS: curves in closed form come back, and broken files are refused."""

import json
import re

import numpy as np
import pytest
import samples
from cases import FIRM_SITE

import stochlin as sl

pytestmark = pytest.mark.oracle

G = 9.80665
LEVELS = np.geomspace(0.05, 6.4, 8)  # g
PERIODS = {"PGA": 0.0, "SA(0.2)": 0.2, "SA(0.5)": 0.5, "SA(2.0)": 2.0}


def frequency(levels, period=0.0, k0=1e-6, k=2.5):
    """A power law, in which the acceleration of the same frequency falls with the period to the 0.8."""
    scale = period**-0.8 if period else 1.0
    return k0 * (np.asarray(levels) / scale) ** -k


def probability(levels, period=0.0, years=50.0, **of):
    return -np.expm1(-years * frequency(levels, period, **of))


def write(folder, text, name="hazard.csv"):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def of_openquake(folder, measure="PGA", levels=LEVELS, **of):
    row = probability(levels, PERIODS[measure], **of)
    sites = {(-99.17, 19.33): row, (-99.05, 19.40): row / 2, (-99.06, 19.41): row / 3}
    return write(
        folder, samples.openquake(levels, sites, measure), f"hazard_curve-mean-{measure}_17.csv"
    )


def usgs(kind=samples.usgs, **of):
    names = {"PGA": 0.0, "SA0P2": 0.2, "SA0P5": 0.5, "SA2P0": 2.0}
    curves = {name: (LEVELS, frequency(LEVELS, T, **of)) for name, T in names.items()}
    return kind(curves | {"PGV": ([1.0, 100.0], [0.1, 1e-4])})


def check(hazard, period=0.0, rtol=1e-5):
    """The curve is the power law; six printed digits of a probability are behind ``rtol``."""
    levels = np.array(hazard.intensities) / G
    np.testing.assert_allclose(hazard.frequencies, frequency(levels, period), rtol=rtol)


def test_openquake_by_number_and_by_coordinates(tmp_path):
    path = of_openquake(tmp_path)
    check(sl.read_hazard(path, site=1))
    check(sl.read_hazard(path, site=(-99.172, 19.328)))
    second = sl.read_hazard(path, site=[-99.051, 19.4])
    assert second == sl.read_hazard(path, site=2)
    np.testing.assert_allclose(np.array(second.intensities), LEVELS * G, rtol=1e-6)


@pytest.mark.parametrize("kind", [samples.usgs, samples.usgs_of_before])
def test_the_usgs_has_all_measures_in_one_file(tmp_path, kind):
    path = write(tmp_path, usgs(kind), "hazard.json")
    check(sl.read_hazard(path), rtol=1e-12)
    for period in (0.2, 0.5, 2.0):
        hazard = sl.read_hazard(path, "sa", period=period)
        assert (hazard.measure, hazard.period) == ("sa", period)
        check(hazard, period, rtol=1e-12)


@pytest.mark.parametrize("period", [0.2, 0.21, 0.3, 0.7, 1.9, 2.0])
def test_between_two_periods_a_power_law_is_exact(tmp_path, period):
    """Its accelerations of one frequency are a power of the period, so that logarithms lie on lines."""
    one = write(tmp_path, usgs(), "hazard.json")
    check(sl.read_hazard(one, "sa", period=period), period, rtol=1e-12)
    files = [of_openquake(tmp_path, name) for name in ("SA(2.0)", "PGA", "SA(0.2)", "SA(0.5)")]
    check(sl.read_hazard(files, "sa", period=period, site=1), period)


def test_frequencies_may_differ_by_rounding_errors(tmp_path):
    both = frequency(LEVELS), frequency(LEVELS) * (1 + 1e-15 * np.arange(8))
    curves = {f"SA{n}P0": (n * LEVELS, values) for n, values in zip((1, 4), both, strict=True)}
    hazard = sl.read_hazard(write(tmp_path, samples.usgs(curves)), "sa", period=2.0)
    np.testing.assert_allclose(hazard.intensities, 2 * LEVELS * G, rtol=1e-9)
    np.testing.assert_allclose(hazard.frequencies, frequency(LEVELS), rtol=1e-9)


def test_points_without_a_frequency_of_their_own_are_left_out(tmp_path):
    levels, poe = [0.01, 0.02, 0.04, 0.08, 0.16, 0.32], [1, 0.5, 0.5, 0.1, 0.0, 0.0]
    path = write(tmp_path, samples.openquake(levels, {(0, 0): poe}))
    hazard = sl.read_hazard(path)
    np.testing.assert_allclose(np.array(hazard.intensities) / G, [0.04, 0.08])
    np.testing.assert_allclose(hazard.frequencies, [np.log(2) / 50, -np.log(0.9) / 50])


def test_probabilities_in_columns_need_their_time(tmp_path):
    rows = "\n".join(f"{x:.9f},{p:.12f}" for x, p in zip(LEVELS, probability(LEVELS), strict=True))
    path = write(tmp_path, f"pga [g],probability\n{rows}\n")
    check(sl.read_hazard(path, investigation_time=50))
    with pytest.raises(
        ValueError, match=r"column 'probability' of hazard\.csv .* give investigation_time"
    ):
        sl.read_hazard(path)
    with pytest.raises(ValueError, match=r"line 4, row 3: the probability is 1\.5; allowed"):
        sl.read_hazard(write(tmp_path, "0.1,0.9\n0.2,0.8\n\n0.3,1.5\n"), investigation_time=50)
    with pytest.raises(ValueError, match=r"site = 1 does not apply: hazard\.csv is a file of"):
        sl.read_hazard(path, investigation_time=50, site=1)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, r"site is missing: .* has 3 sites, 1 \(-99\.17, 19\.33\), 2 .*; give the number of one"),
        ({"site": 4}, "site = 4 is not in .*; allowed: 1 to 3"),
        ({"site": 0}, "site = 0 is not in"),
        (
            {"site": (-99.1, 19.33)},
            r"the nearest one is 2 \(-99\.05, 19\.4\); allowed: a site within 0\.01",
        ),
        ({"site": "CU"}, "site = 'CU'; allowed: a number from 1, or longitude and latitude"),
        ({"site": 1, "units": "gal"}, r"units = 'cm/s\^2' contradicts .* states 'g'"),
        ({"site": 1, "measure": "sa", "period": 1.0}, r"period = 1 is beyond .* has PGA; allowed"),
        ({"site": 1, "measure": "intensity"}, "measure = 'intensity' is not in .* has PGA"),
        ({"site": 1, "investigation_time": 1}, "investigation_time = 1 contradicts .* which states 50"),
        (
            {"site": 1, "investigation_time": -1},
            "investigation_time = -1 is out of range; allowed: a positive",
        ),
    ],
)
def test_what_a_file_of_openquake_does_not_have_is_refused(tmp_path, options, message):
    with pytest.raises((ValueError, TypeError), match=message):
        sl.read_hazard(of_openquake(tmp_path), **options)


ONE = samples.openquake(LEVELS, {(0.0, 0.0): probability(LEVELS)})
BROKEN = {
    "level": (ONE.replace("poe-0.0500000", "poe-low"), r"line 2: .*allowed: names such as 'poe-0.005'"),
    "number": (re.sub(r"\d\.\d+E", "x.0E", ONE, count=1), "line 3: .*allowed: 11 numbers"),
    "cut": (ONE.rpartition(",")[0], "line 3: .*allowed: 11 numbers"),
    "no site": ("\n".join(ONE.split("\n")[:2]), "has no site; allowed: a row of probabilities"),
    "no time": (
        ONE.replace("investigation_time", "time"),
        "investigation_time is missing and hazard.csv",
    ),
    "time": (ONE.replace("50.0", "0"), "line 1: investigation_time = 0; allowed: a positive number"),
    "velocity": (
        ONE.replace("'PGA'", "'PGV'"),
        r"line 1: .*PGV.*; allowed: imt='PGA' or imt='SA\(0\.5\)'",
    ),
    "no measure": (ONE.replace("imt=", "of="), "line 1: no imt; allowed: imt='PGA'"),
    "rising": (
        samples.openquake([0.1, 0.2, 0.3], {(0, 0): [0.1, 0.2, 0.01]}),
        "line 3, column poe-0.2000000: the annual frequency .* follows .*; allowed: falling",
    ),
    "negative": (
        samples.openquake([0.1, 0.2], {(0, 0): [-0.1, -0.2]}),
        "line 3, column poe-0.1000000: the probability is -0.1; allowed",
    ),
    "json": ('{"response": [', "hazard.csv is no valid JSON: .*; fetch it again"),
    "no response": ('{"answer": []}', "hazard.csv has no response.hazardCurves; allowed: the response"),
    "no imt": ('{"response": [{"data": []}]}', "hazard.csv has no imt.value"),
    "no total": (usgs().replace("Total", "Sum"), "hazard.csv has no numbers of PGA"),
    "text": (usgs().replace("[1.0, 2.0]", "[]").replace("[0.05,", '["0.05",'), "no numbers of PGA"),
    "unequal": (usgs().replace("[0.05, ", "[", 1), "PGA: 7 accelerations and 8 frequencies"),
    "no units": (usgs().replace("(g)", ""), "units is missing and hazard.csv does not state it"),
    **{
        number: (
            usgs().replace("[0.05, ", f"[{number}, ", 1),
            f"valid JSON: {number} is no finite number",
        )
        for number in ("NaN", "Infinity", "-Infinity", "1e999")
    },
    "twice": (usgs().replace('{"', '{"response": 1, "', 1), "'response' stands twice in one object"),
}


@pytest.mark.parametrize("case", BROKEN)
def test_broken_files_are_refused(tmp_path, case):
    text, message = BROKEN[case]
    with pytest.raises(ValueError, match=message):
        sl.read_hazard(write(tmp_path, text))


def test_periods_and_files_that_do_not_fit_are_refused(tmp_path):
    path = write(tmp_path, usgs(), "hazard.json")
    for period in (0.1, 3.0):  # PGA is no period, and nothing is extrapolated
        with pytest.raises(
            ValueError, match=rf"period = {period:g} is beyond hazard.json, .*PGA, SA\(0\.2"
        ):
            sl.read_hazard(path, "sa", period=period)
    with pytest.raises(
        ValueError, match=r"site = 1 does not apply: hazard.json is a response of the USGS"
    ):
        sl.read_hazard(path, site=1)
    twice = of_openquake(tmp_path)
    with pytest.raises(ValueError, match=r"17\.csv: PGA is there twice; leave one out"):
        sl.read_hazard([twice, twice], site=1)
    plain = write(tmp_path, "0.1,0.01\n0.2,0.001\n")
    with pytest.raises(ValueError, match=r"allowed: one file, or several of OpenQuake"):
        sl.read_hazard([plain, plain])
    apart = json.loads(usgs())
    apart["response"]["hazardCurves"][2]["data"][1]["values"]["ys"] = [1e-9 * 0.1**n for n in range(8)]
    far = write(tmp_path, json.dumps(apart), "far.json")
    with pytest.raises(
        ValueError, match=r"SA\(0\.2\) and SA\(0\.5\) have no range of annual frequencies"
    ):
        sl.read_hazard(far, "sa", period=0.3)


CASE = """\
[building_1]
period = "1.0 s"
damping = 0.05
elastic = true
[building_2]
period = "0.6 s"
damping = 0.05
elastic = true
[separation]
confidence = 0.9
"""


def test_a_case_file_reads_them(tmp_path):
    files = [of_openquake(tmp_path, name) for name in ("SA(0.5)", "SA(2.0)")]
    names = json.dumps([path.name for path in files])

    def hazard(place):
        lines = f'measure = "sa"\nsa_period = "0.7 s"\nfile = {names}\n{place}\n'
        text = FIRM_SITE.replace("[motion]", f"[site.hazard]\n{lines}[motion]") + CASE
        return sl.read_case(write(tmp_path, text, "case.toml"))

    case = hazard("site = 2")
    assert case.hazard == sl.read_hazard(files, "sa", period=0.7, site=2)
    assert set(files) <= set(case.inputs)
    assert hazard("coordinates = [-99.05, 19.40]").hazard == case.hazard
    with pytest.raises(ValueError, match=r"case.toml, line \d+: site.hazard.file.* site is missing"):
        hazard("")
    with pytest.raises(ValueError, match=r"coordinates.* is given beside site"):
        hazard("site = 2\ncoordinates = [-99.05, 19.40]")
