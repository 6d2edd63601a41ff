"""Record files: published check values, what is read of every form, and every refusal."""

import gzip
import re
from pathlib import Path

import numpy as np
import pytest
import samples
import xarray as xr
from motions import FOLDER, motion, needs_records

import stochlin as sl
from stochlin.applications.records import files
from stochlin.applications.records.formats import FORMATS, Format, Series
from stochlin.applications.records.records import strong_part

pytestmark = pytest.mark.oracle

G = 9.80665
WAVE = np.round(0.1 * np.sin(np.arange(40) / 3), 6)
SMOOTH = np.round(0.1 * np.sin(np.arange(120) / 3), 6)
GAL = 1000 * WAVE
TIMES = [round(0.02 * i, 2) for i in range(40)]
COUNTS = np.round(6182761 / 3920 * (GAL + 7.5))
CHANNELS = {"90 Deg": GAL, "Up": 0.5 * GAL, "360 Deg": 2 * GAL}


def write(folder: Path, text: str | bytes, name: str = "record.txt") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return path


def read(folder: Path, text: str | bytes, **options) -> xr.DataArray:
    return sl.read_record(write(folder, text), **options)


def lines(*columns, separator=" ", width=1) -> str:
    """Columns side by side, or one in rows of so many numbers."""
    rows = zip(*columns, strict=True)
    if width > 1:
        rows = (columns[0][i : i + width] for i in range(0, len(columns[0]), width))
    return "\n".join(separator.join(f"{value}" for value in row) for row in rows) + "\n"


def at2(header: str, units: str = "IN UNITS OF G", values=WAVE) -> str:
    body = samples.rows(values, 5, "{:15.6E}")
    return f"PEER NGA STRONG MOTION\nSomewhere, 1/1/2000\nACCELERATION {units}\n{header}\n{body}\n"


# --- Published check values -----------------------------------------------------------------------


@needs_records
@pytest.mark.parametrize(
    ("name", "options", "peak", "samples", "step"),
    [
        ("sct190985.txt", {"units": "g", "column": 2, "time_column": 1}, 0.0995, 8171, 0.02),
        (
            "sct190985.txt",
            {"units": "g", "column": 3, "time_column": 1, "dt": 0.02},
            0.1712,
            8171,
            0.02,
        ),
        ("RSN15_KERN_TAF111.txt", {"units": "g", "dt": 0.01}, 0.1803, 5437, 0.01),
        ("elc180.AT2", {}, 0.2808, 5372, 0.01),
        ("NIS090.AT2", {"units": "g", "dt": 0.01}, 0.5027, 4096, 0.01),
    ],
)
def test_records_have_their_published_peaks(name, options, peak, samples, step):
    record = sl.read_record(FOLDER / name, **options)
    assert float(abs(record).max()) / G == pytest.approx(peak, abs=5e-5)
    assert (record.sizes, record.attrs["dt"], record.attrs["source"]) == (
        {"time": samples},
        step,
        name,
    )
    np.testing.assert_allclose(np.diff(record.time), step, rtol=1e-9)


# --- What is read
# -----------------------------------------------------------------------------------

HEADER = "NPTS=  40, DT=   .0200 SEC"
TIMED, PLAIN = {"units": "g", "time_column": 1}, {"units": "g", "dt": 0.02}
COMMAS = "t [s];acc, north [g];when\n" + lines(
    TIMES, WAVE, ["24.12.2000"] * 40, separator=";"
).replace(".", ",").replace("24,12,2000", "24.12.2000")
RAISED = {"units": "gal", "time_column": "time [s]"}
# Text, options and the factor of WAVE in m/s^2; the time step is 0.02 s in all of them.
READINGS = {
    **{
        f"AT2 {header}": (at2(header), {}, G)
        for header in (
            *(f"{HEADER},            ", "npts=40,dt=2.0E-02", "  40    0.0200    NPTS, DT"),
            *(
                "40 .02 NPTS, DT",
                "NPTS 40 DT 0.02",
                "DT= .02 SEC, NPTS= 40",
                "NPTS= 40\nDT= .02 SEC",
            ),
            *("DT= .02 SEC\nNPTS= 40", "NPTS= 40, DT= 20.0 MSEC", "NPTS: 40 DT: 20 ms"),
            "40, 0.02, NPTS, DT (SEC)",
        )
    },
    **{
        f"AT2 {units}": (at2(HEADER, units), {}, factor)
        for units, factor in {
            **dict.fromkeys(
                ("TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz", "UNITS OF G."), G
            ),
            **dict.fromkeys(
                ("IN UNITS OF G;", "IN UNITS OF (G)", "IN UNITS OF G'S", "UNITS: G"), G
            ),
            **dict.fromkeys(("IN UNITS OF CM/SEC/SEC.", "UNITS [cm/s2]", "UNITS = CM/S**2,"), 0.01),
        }.items()
    },
    "AT2 without units": (at2(HEADER, ""), {"units": "gal"}, 0.01),
    "commas": (lines(TIMES, WAVE, separator=" , "), TIMED, G),
    "comments": ("# a\n% b\n\n" + lines(TIMES, WAVE).replace("\n", "  # inline\n"), TIMED, G),
    "names": ("time,acc\n" + lines(TIMES, WAVE, separator=","), TIMED, G),
    "names of two words": ("time [s]  acc north\n" + lines(TIMES, WAVE), RAISED, 0.01),
    "a row of units": (
        "time acc\n(s) [gal]\n" + lines(TIMES, WAVE),
        {"time_column": "time [s]"},
        0.01,
    ),
    "Latin": ("# México\n" + lines(TIMES, WAVE), TIMED, G),
    "Fortran": (lines([f"{10 * value:.6f}D-01" for value in WAVE]), PLAIN, G),
    "two units": (f"acc (corrected) [gal]\n{lines(WAVE)}", {"dt": 0.02}, 0.01),
    "decimal commas": (COMMAS, {"time_column": 1, "column": 2}, G),
    "milliseconds": (
        "t [ms],acc #1 [g]\n" + lines(range(0, 800, 20), WAVE, separator=","),
        {"time_column": 1},
        G,
    ),
    "like names": (
        "t,a [g],a [gal]\n" + lines(TIMES, WAVE, WAVE, separator=","),
        {"time_column": "t", "column": "a [gal]"},
        0.01,
    ),
    "two titles": (f"El Centro\nof 1940 (gal)\n{lines(WAVE)}", {"dt": 0.02}, 0.01),
    "two titles above a name": (
        f"El Centro\nof 1940\nacc (gal)\n{lines(WAVE)}",
        {"dt": 0.02},
        0.01,
    ),
    "more lines above": (f"a: b\nc\nd\n{lines(WAVE)}", {**PLAIN, "skip": 3}, G),
    "count and step": (f"El Centro 1940 NS\n40 0.02\n{lines(WAVE)}", {"units": "g"}, G),
    "step and count": (f"0.02, 40\n{lines(WAVE, width=8, separator=',')}", {"units": "g"}, G),
    "rows of eight": (lines(WAVE, width=8), {**PLAIN, "wrapped": True}, G),
    # Numbers that run on, as Fortran writes wide ones; older words and units.
    "CSMIP": (samples.csmip({"H1": -GAL}, "in cm/sec2. (8f10.6)", digits=6), {}, -10),
    "CSMIP name": (samples.csmip(CHANNELS), {"component": "90deg"}, 10),
    "CSMIP number": (samples.csmip(CHANNELS), {"component": 3}, 20),
    "COSMOS": (samples.cosmos({"H1": -GAL}, digits=6, step=20.0), {}, -10),
    "COSMOS without step": (samples.cosmos({"H1": GAL}, step=-999.0), {"dt": 0.02}, 10),
}


@pytest.mark.filterwarnings("ignore:.*its peak is 0.000102 g")  # of the wave in gal
@pytest.mark.parametrize("case", READINGS)
def test_every_form_gives_the_same_motion(tmp_path, case):
    text, options, factor = READINGS[case]
    record = read(tmp_path, text, **options)
    np.testing.assert_allclose(
        record, factor * WAVE, rtol=1e-12, atol=6e-6
    )  # of a printed digit in g
    np.testing.assert_allclose(record.time, TIMES, atol=1e-12)
    assert record.attrs["dt"] == pytest.approx(0.02, rel=1e-12)
    assert (record.name, record.attrs["units"], record.time.attrs["units"]) == (
        "acceleration",
        "m/s^2",
        "s",
    )


FILES = {
    "knet": (samples.knet(COUNTS, memo="# 100 %"), {}, "N-S", 0.01),
    "esm": (samples.esm(GAL), {}, "HNE", 0.005),
    "unam": (samples.unam([0.5 * GAL, GAL, 2 * GAL]), {"component": "N00E"}, "N00E", 0.005),
    "csmip": (samples.csmip(CHANNELS), {"component": "90 Deg"}, "90 Deg", 0.02),
    "cosmos": (samples.cosmos({"340 deg": GAL}), {}, "340 deg", 0.01),
}


def test_every_format_is_read_here():
    assert set(FORMATS) >= {*FILES, "at2"}


def test_a_format_reads_the_header_in_comments(tmp_path, monkeypatch):
    """As networks write it: a line '# key: value' for each, above one column."""

    def of_network(file):
        stated = dict(line[1:].split(":") for line in file.written if line.startswith("#"))
        values = file.numbers(len(stated) + 1, len(file.lines))
        return [Series(values, None, float(stated[" dt"]), stated[" units"].strip())]

    network = Format("a file of the network", re.compile(r"\A# network: "), of_network, "csv")
    monkeypatch.setattr(files, "FORMATS", {**FORMATS, "network": network})
    record = read(tmp_path, "# network: here\n# dt: 0.02\n# units: g\n" + "\n".join(map(str, WAVE)))
    np.testing.assert_allclose(record, G * WAVE, rtol=1e-12)
    assert record.attrs["dt"] == 0.02


@pytest.mark.parametrize("header", ["", "^", ".*", r"\d", r"^\s*\S+"])
def test_a_format_that_claims_every_file_is_refused(header):
    with pytest.raises(
        ValueError, match=r"^a network's file: the header .* is in every file; allowed"
    ):
        Format("a network's file", re.compile(header), lambda file: [], "csv")


@pytest.mark.parametrize("name", FILES)
def test_every_format_states_its_step_and_component(tmp_path, name):
    text, options, component, step = FILES[name]
    record = read(tmp_path, text, **options)
    offset = GAL.mean() if name == "knet" else 0.0  # of which the mean is subtracted
    # of a count, or of the printed digits [cm/s^2]
    exact = 3920 / 6182761 if name == "knet" else 1e-9
    np.testing.assert_allclose(record, (GAL - offset) / 100, atol=exact / 100, rtol=1e-12)
    assert record.attrs["dt"] == pytest.approx(step, rel=1e-12)
    assert (record.attrs["component"], record.attrs["units"]) == (component, "m/s^2")
    for other in (
        text.replace("\n", "\r\n"),
        gzip.compress(text[:200].encode()) + gzip.compress(text[200:].encode()),
        text + "\n  \n",
        b"\xef\xbb\xbf" + text.encode(),
    ):
        np.testing.assert_array_equal(read(tmp_path, other, **options), record)


def test_rows_beyond_the_stated_number_are_left_out(tmp_path):
    record = read(tmp_path, samples.unam([GAL], "/N00E") + "    9.0000\n    9.0000\n")
    np.testing.assert_allclose(record, GAL / 100, rtol=1e-12)
    assert record.attrs["comment"] == "2 rows beyond the stated 40 are left out"


def test_the_mean_is_subtracted_where_the_baseline_is_not_corrected(tmp_path):
    """The largest acceleration in the header of K-NET files is that about the mean."""
    record = read(tmp_path, samples.knet(COUNTS))
    offset = COUNTS.mean() * 3920 / 6182761
    np.testing.assert_allclose(record, COUNTS * 3920 / 6182761 / 100 - offset / 100, atol=1e-12)
    assert record.attrs["comment"] == f"its mean of {offset:.6g} gal is subtracted"
    raw = read(tmp_path, samples.esm(GAL + 3, baseline="BASELINE NOT REMOVED"))
    np.testing.assert_allclose(raw, (GAL - GAL.mean()) / 100, atol=1e-8)
    assert "comment" not in read(tmp_path, samples.esm(GAL)).attrs


@pytest.mark.parametrize(
    ("title", "event"),
    [
        ("Imperial Valley-02, 5/19/1940, El Centro Array #9, 180", "Imperial Valley-02, 5/19/1940"),
        ("KOBE 01/16/95 2046, El Centro Array #9, 090 (CUE)", "KOBE 01/16/95 2046"),
        ("written by another program", None),
    ],
)
def test_the_title_of_an_at2_file_names_earthquake_and_station(tmp_path, title, event):
    about = read(tmp_path, at2(HEADER).replace("Somewhere, 1/1/2000", title)).attrs
    assert about.get("event") == event
    assert about.get("station") == (event and "El Centro Array #9")


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_time_may_be_a_quarter_of_a_step_astray(tmp_path, sign):
    def astray(share):
        time = np.array(TIMES)
        time[20] += 0.02 * sign * share
        return read(tmp_path, lines(time, WAVE), **TIMED)

    np.testing.assert_allclose(astray(0.24).time, TIMES, rtol=1e-9)
    with pytest.raises(ValueError, match=r"time is uneven: 0\.[34]\d* s is followed by"):
        astray(0.26)


@pytest.mark.parametrize("step", [0.005, 1 / 128, 1 / 300, 0.02])
def test_printed_times_are_rounded(tmp_path, step):
    time = [round(step * i, 3) for i in range(1000)]
    text = lines(time, np.linspace(1, 0, 1000) * np.sin(40 * step * np.arange(1000)))
    assert read(tmp_path, text, **TIMED).attrs["dt"] == pytest.approx(step, rel=2e-4)
    assert read(tmp_path, text, **TIMED, dt=step).attrs["dt"] == step


# --- What is refused
# --------------------------------------------------------------------------------

TABLE = lines(TIMES, WAVE, WAVE)
NAMED = "time,north,east\n" + lines(TIMES, WAVE, WAVE, separator=",")
SINGLE = lines(WAVE)
UNKNOWN = "record.txt has no accelerations in a format that is known; allowed: a COSMOS file, "
HOURS = lines([f"{value:.2f}" for value in TIMES], WAVE)


def changed(line: int, text: str) -> str:
    rows = HOURS.splitlines()
    return "\n".join([*rows[: line - 1], text, *rows[line:]])


# Formats of other networks, and texts.
NOT_KNOWN = [
    "time,acc\n",
    "Corrected accelerogram 2020_ABCS GNS\nSite ABCS 40 00S\n 2018 2 12\n 1 2\n",
    "2 CORRECTED ACCELEROGRAM\n*\nABC\n 1989 10 18 Some\n*\n 1 1989 291\n",
    "RECORDS\nPLACE : X\nSAMPLING (sec) : 0.01\nN-S E-W U-D\n 1 2 3\n",
    "UNCORRECTED DATA\nABC\nUNITS ARE SEC AND G/10.\n 0.0 1.0 0.1 2.0\n",
    f"ACCELERATION IN UNITS OF G/10\n{SINGLE}",
    samples.csmip({"H1": GAL}).replace("of accel data", "of raw data"),
    samples.cosmos({"H1": GAL}).replace("acceleration pts", "velocity pts"),
]

# Message, text and options.
REFUSALS = [
    ("record.txt is empty", "", PLAIN),
    (r"dt is missing .*give dt= or time_column=", SINGLE, {"units": "g"}),
    (r"say the unit .*; give units=, allowed: g, m/s\^2, cm/s\^2, gal", SINGLE, {"dt": 0.01}),
    (r"record.txt is 1e-300 s; allowed: 1e-06", SINGLE, {"dt": 1e-300, "units": "g"}),
    (r"3 columns, .*; give column= .*, or wrapped=True for .* 120 num", TABLE, PLAIN),
    ("'time': a time, 2 'north', 3 'east', and column = 'up' is", NAMED, {**TIMED, "column": "up"}),
    ("column = 'b' is the title of several", "a,b [g],b [cm]\n1,2,3\n2,3,4\n", {"column": "b"}),
    (r"has '1 \(0, 0.02, 0.04, ...\)' as time_column and as column", TABLE, {**TIMED, "column": 1}),
    (
        "column = 0 is no column; allowed: 1 to 3, since columns are counted from 1",
        TABLE,
        {"column": 0},
    ),
    (
        r"has the time in .min.; allowed: s, ms",
        NAMED.replace("time", "t [min]"),
        TIMED | {"column": 2},
    ),
    (
        r"record.txt, line 8, column 2: '0.1x' is not an acceleration",
        changed(8, "0.14 0.1x"),
        TIMED,
    ),
    ("line 3: 1 columns; allowed: 2, as in the first", "0.0,1\n0.1,2\n0.2,\n" * 9, TIMED),
    (r"does not increase: 0\.08 s is followed by 0\.08 s", changed(6, "0.08 1"), TIMED),
    (
        r"record\.txt: time is uneven: 0\.18 s is followed by 0\.22 s; fill a gap",
        changed(11, ""),
        TIMED,
    ),
    (r"dt = 0\.01 contradicts the time, .* 0\.02 s", HOURS, {**TIMED, "dt": 0.01}),
    ("record has 15 samples; allowed: at least 16", lines(WAVE[:15]), PLAIN),
    (
        "2 'vel .cm/s.': a velocity; allowed: a column of an acceleration$",
        "t,vel [cm/s]\n" + lines(TIMES, WAVE, separator=","),
        TIMED,
    ),
    ("1 'vel': a velocity; allowed: a column of an acceleration", lines(["vel", *WAVE]), PLAIN),
    ("column = 2 is a velocity; allowed: an acc", NAMED.replace("north", "vel"), {"column": 2}),
    (r"1 \(0, 0.02, .*\), which rises by equal steps, as a time", HOURS, {**PLAIN, "column": 1}),
    ("decimal commas, as '0,012'; allowed: points", "0,012\n-0,034\n" * 20, PLAIN),
    (
        "'0.0' is not an acceleration; allowed: a number, with ',' before its decimals, as '0,",
        COMMAS.replace(";0,0;", ";0.0;"),
        {**TIMED, "column": 2},
    ),
    ("record.txt is text in UTF-16; allowed: UTF-8", SINGLE.encode("utf-16"), PLAIN),
    ("record.txt is no text; allowed: text in UTF-8", WAVE.tobytes(), PLAIN),
    ("or wrapped=True for one series of 40 numbers", lines(WAVE, width=8), PLAIN),
    ("wrapped = True does not apply: record.txt is an AT2", at2(HEADER), {"wrapped": True}),
    ("line 4: .*; allowed there: 'NPTS= 5372, DT", at2("NPTS= 40, DT= 1E999 SEC"), {}),
    ("line 4: 'NPTS= 40, DT= 100 HZ'; allowed there", at2("NPTS= 40, DT= 100 HZ"), {}),
    (r"dt = 0\.01 contradicts .*states 0\.02", at2(HEADER), {"dt": 0.01}),
    ("record.txt has 'CM/S'; allowed: units of an acc", at2(HEADER, "UNITS OF CM/S"), {}),
    ("holds 40 values, but line 4 states 41", at2(HEADER.replace("40", "41")), {}),
    (r"holds 36 values, but line 12 states 40; .*fetch it", samples.knet(COUNTS)[:-40], {}),
    (r"line 14: 'Scale Factor .*allowed there", samples.knet(COUNTS, "(gal)/6182761"), {}),
    ("has no line 'Memo.'", samples.knet(COUNTS).replace("Memo.", "Note."), {}),
    (r"'E-W' is not in .*: 1 \(N-S\)", samples.knet(COUNTS), {"component": "E-W"}),
    ("line 14: .*: 'DATA_TYPE: ACC", samples.esm(GAL).replace("TYPE: ACC", "TYPE: V"), {}),
    (r"has 1 \(V\), 2 \(N00E\), 3 \(N90E\); give comp", samples.unam([GAL] * 3), {}),
    ("'V' is more than one in", samples.unam([GAL] * 3, "/V/V/V"), {"component": "V"}),
    ("line 18: .*each of 3 channels", samples.unam([GAL] * 3).replace("/0.005", "", 1), {}),
    ("line 23: .*: the length of 40", samples.unam([GAL] * 3).replace("/0.20", "/0.40"), {}),
    ("has no data; allowed: ", samples.unam([GAL]).replace("DATOS DE ACEL", "ACEL"), {}),
    ("line 6: .*equally spaced at no sec", samples.csmip({"H1": GAL}, step="no"), {}),
    ("line 25: .*length of", samples.cosmos({"H1": GAL}).replace(" 0.4", " 0.8"), {}),
    ("gzip and damaged .*fetch it", gzip.compress(samples.knet(COUNTS).encode())[:-9], {}),
    ("record.txt, unpacked, has 67108865 bytes", gzip.compress(bytes(2**26 + 1)), {}),
    *((UNKNOWN, text, PLAIN) for text in NOT_KNOWN),
]


@pytest.mark.parametrize(("message", "text", "options"), REFUSALS, ids=[row[0] for row in REFUSALS])
def test_refusals_say_what_and_where(tmp_path, message, text, options):
    with pytest.raises(ValueError, match=message):
        read(tmp_path, text, **options)


def test_three_components_without_titles_are_no_rows_of_a_series(tmp_path):
    components = SMOOTH[:40], 0.8 * SMOOTH[40:80], 0.5 * SMOOTH[80:]
    for number, values in enumerate(components, start=1):
        record = read(tmp_path, lines(*components), **PLAIN, column=number)
        np.testing.assert_allclose(record, values * 9.80665, rtol=1e-9)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (
            lines([i * 10 for i in range(40)], WAVE),
            TIMED,
            "its time step is 10 s.*is time in seconds",
        ),
        (lines(100 * WAVE), PLAIN, "its peak is 10 g.*are the units right"),
        (
            lines(*[WAVE] * 5),
            {**PLAIN, "column": 1},
            "its 5 columns may be rows of one series; is it",
        ),
        (
            lines(*SMOOTH.reshape(40, 3).T),
            {**PLAIN, "column": 2},
            "its 3 columns may be rows of one",
        ),
        (
            "acc UD\n" + lines(10 * WAVE, separator=","),
            PLAIN,
            "'acc UD' is vertical, and gaps follow from horiz",
        ),
        (
            "roof acc\n" + lines(10 * WAVE, separator=","),
            PLAIN,
            "'roof acc' may be the motion of a building",
        ),
    ],
)
def test_what_is_hardly_meant_is_asked_about(tmp_path, text, options, message):
    with pytest.warns(UserWarning, match=f"^record.txt: {message}") as caught:
        read(tmp_path, text, **options)
    assert len(caught) == 1
    assert caught[0].filename == __file__


# --- Strong part
# --------------------------------------------------------------------------------------


def test_strong_part_of_a_decaying_signal():
    """Energy 1 - exp(-2 t), so the part runs from -log(1-start)/2 to -log(1-end)/2."""
    record = motion(np.exp(-1e-3 * np.arange(20000)), 1e-3, source="a")
    part = strong_part(record, 0.25, 0.75)
    np.testing.assert_allclose(part.time[[0, -1]], -np.log1p([-0.25, -0.75]) / 2, atol=1.5e-3)
    assert part.attrs == record.attrs | {"energy_part": "25-75 %"}
    assert "energy_part" not in record.attrs


@pytest.mark.parametrize(
    ("record", "error", "message"),
    [
        (np.ones(50), TypeError, "record is a ndarray; allowed: an xarray.DataArray"),
        (xr.DataArray(np.ones(50), dims="time"), ValueError, "allowed: time with its coordinate"),
        (motion(WAVE) * 1j, TypeError, "complex128 over float64; allowed"),
        (motion(WAVE, units="g"), ValueError, r"units 'g'; allowed: m/s\^2, so convert its v"),
        (motion([1.0] * 20 + [np.nan]), ValueError, r"record is nan at 0\.4 s"),
        (motion(WAVE).isel(time=slice(None, None, -1)), ValueError, "time does not increase"),
        (motion(WAVE).drop_isel(time=20), ValueError, "time is uneven"),
        ([], ValueError, "record is empty"),
        ([motion(WAVE), np.ones(3)], TypeError, "record 2: record is a ndarray"),
        ({"a": motion(WAVE)[:5]}, ValueError, "record a: record has 5 samples"),
        (
            motion(WAVE).assign_coords(time=np.arange(WAVE.size).astype("datetime64[ms]")),
            TypeError,
            r"datetime64.*; allowed: numbers; "
            r"write \(time - time\[0\]\) / np.timedelta64\(1, 's'\)",
        ),
    ],
)
def test_what_is_not_a_record(record, error, message):
    with pytest.raises(error, match=message):
        sl.response_spectrum(record, 0.5, 0.05)
