"""Formats of record files: what is read agrees with what was written, and broken files are refused."""

import gzip
from pathlib import Path

import numpy as np
import pytest
import samples
from cases import recorded_example
from motions import write_at2

import stochlin as sl
from stochlin.analyses.records.files import is_record
from stochlin.analyses.records.formats import FORMATS
from stochlin.analyses.records.formats import __path__ as folder

pytestmark = pytest.mark.oracle

WAVE = np.round(100 * np.sin(np.arange(40) / 3), 4)  # cm/s^2
COUNTS = np.round(6182761 / 3920 * (WAVE + 7.5))
CHANNELS = {"90 Deg": WAVE, "Up": 0.5 * WAVE, "360 Deg": 2 * WAVE}


def write(folder: Path, text: str | bytes, name: str = "record.txt") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode("latin-1"))
    return path


FILES = {
    "knet": (samples.knet(COUNTS), {}, "N-S", 0.01),
    "esm": (samples.esm(WAVE), {}, "HNE", 0.005),
    "unam": (samples.unam([0.5 * WAVE, WAVE, 2 * WAVE]), {"component": "N00E"}, "N00E", 0.005),
    "csmip": (samples.csmip(CHANNELS), {"component": "90 Deg"}, "90 Deg", 0.02),
    "cosmos": (samples.cosmos({"340 deg": WAVE}), {}, "340 deg", 0.01),
}


def read(folder, text, **options):
    return sl.read_record(write(folder, text), **options)


def test_each_file_of_the_package_is_one_format():
    names = {path.stem for path in Path(folder[0]).glob("*.py")} - {"__init__"}
    assert set(FORMATS) == names == {*FILES, "at2"}


@pytest.mark.parametrize("name", FILES)
def test_every_format_gives_the_same_motion(tmp_path, name):
    text, options, component, step = FILES[name]
    record = read(tmp_path, text, **options)
    offset = WAVE.mean() if name == "knet" else 0.0  # of which the mean is subtracted
    exact = 3920 / 6182761 if name == "knet" else 1e-9  # of a count, or of the printed digits [cm/s^2]
    np.testing.assert_allclose(record, (WAVE - offset) / 100, atol=exact / 100, rtol=1e-12)
    assert record.attrs["dt"] == pytest.approx(step, rel=1e-12)
    assert record.attrs["component"] == component
    assert record.attrs["units"] == "m/s^2"


@pytest.mark.parametrize("name", FILES)
def test_line_ends_and_gzip_do_not_matter(tmp_path, name):
    text, options, *_ = FILES[name]
    plain = read(tmp_path, text, **options)
    for other in (
        text.replace("\n", "\r\n"),
        gzip.compress(text.encode()),
        gzip.compress(text[:200].encode()) + gzip.compress(text[200:].encode()),
        text + "\n\n\x1a" if name == "at2" else text + "\n  \n",
        b"\xef\xbb\xbf" + text.encode(),
    ):
        np.testing.assert_array_equal(read(tmp_path, other, **options), plain)


@pytest.mark.parametrize(
    ("text", "options", "factor"),
    [
        # Numbers that run on, as Fortran writes wide ones.
        (samples.csmip({"90 Deg": -WAVE}, "in cm/sec2. (8f10.6)", digits=6), {}, -1),
        (samples.cosmos({"Up": -WAVE}, digits=6), {}, -1),
        (samples.unam([-WAVE] * 3, digits=6), {"component": 3}, -1),
        # Older words and units.
        (samples.csmip({"90 DEG": WAVE}, " (UNITS: CM/SEC/SEC)").upper(), {}, 1),
        (samples.csmip({"H1": WAVE / 1000}, "in g. (8f10.6)", digits=6), {}, 0.980665),
        (samples.cosmos({"Up": WAVE / 1000}, "g(02)", digits=6), {}, 0.980665),
        (samples.unam([WAVE] * 3).replace("Gal (cm/s/s)", "cm/s/s"), {"component": "v"}, 1),
        (samples.unam([WAVE], "/N00E"), {}, 1),
        (samples.esm(WAVE).replace("ACCELERATION", "Acceleration"), {}, 1),
        # Names of components in other spellings, or by their numbers.
        (samples.csmip(CHANNELS), {"component": "90deg"}, 1),
        (samples.csmip(CHANNELS), {"component": 3}, 2),
        (samples.cosmos(CHANNELS), {"component": "2"}, 0.5),
        # What the file does not state is given.
        (samples.unam([WAVE], "/V").replace("Gal (cm/s/s)", "", 1), {"units": "gal"}, 1),
        (samples.cosmos({"Up": WAVE}, step=-999.0), {"dt": 0.02}, 1),
        # Rows beyond the stated number, as some networks repeat the last sample.
        (samples.unam([WAVE], "/V") + "    9.0000\n    9.0000\n", {}, 1),
    ],
)
def test_odd_but_legal_files_are_read(tmp_path, text, options, factor):
    record = read(tmp_path, text, **options)
    np.testing.assert_allclose(record, factor * WAVE / 100, atol=6e-6)  # of a digit in g


def test_the_mean_is_subtracted_where_the_baseline_is_not_corrected(tmp_path):
    """The largest acceleration in the header of K-NET files is that about the mean."""
    record = read(tmp_path, samples.knet(COUNTS, memo="# 100 %"))
    about_mean = (COUNTS - COUNTS.mean()) * 3920 / 6182761 / 100
    np.testing.assert_allclose(record, about_mean, rtol=1e-12)
    offset = COUNTS.mean() * 3920 / 6182761
    assert record.attrs["comment"] == f"its mean of {offset:.6g} gal is subtracted"
    raw = read(tmp_path, samples.esm(WAVE + 3, baseline="BASELINE NOT REMOVED"))
    np.testing.assert_allclose(raw, (WAVE - WAVE.mean()) / 100, atol=1e-8)
    assert "comment" not in read(tmp_path, samples.esm(WAVE)).attrs


REFUSALS = {
    "knet cut": (
        samples.knet(COUNTS)[:-40],
        {},
        r"holds 36 values, but line 12 states 40; .*fetch it again",
    ),
    "knet scale": (
        samples.knet(COUNTS, "(gal)/6182761"),
        {},
        r"line 14: 'Scale Factor .*allowed there: 'Scale Factor      3920\(gal\)/6182761'",
    ),
    "knet rate": (
        samples.knet(COUNTS).replace("100Hz", "fast"),
        {},
        r"line 11: 'Sampling Freq\(Hz\) fast'; allowed there: a positive number",
    ),
    "knet header": (samples.knet(COUNTS).replace("Memo.", "Note."), {}, "has no line 'Memo.'"),
    "knet text": (samples.knet(COUNTS).replace(f"{COUNTS[39]:.0f}", "12a"), {}, "line 22: '12a' is not"),
    "knet other component": (
        samples.knet(COUNTS),
        {"component": "E-W"},
        r"component = 'E-W' is not in record.txt; allowed: 1 \(N-S\)",
    ),
    "esm no units": (samples.esm(WAVE, ""), {}, "units is missing and record.txt does not state it"),
    "esm velocity": (
        samples.esm(WAVE).replace("TYPE: ACC", "TYPE: VEL"),
        {},
        "line 14: 'DATA_TYPE: VELELERATION'; allowed there: 'DATA_TYPE: ACCELERATION'",
    ),
    "esm count": (
        samples.esm(WAVE).replace("NDATA: 40", "NDATA: 41"),
        {},
        "holds 40 .* line 8 states 41",
    ),
    "esm step": (
        samples.esm(WAVE).replace("0.005000", "0"),
        {},
        "line 7: 'SAMPLING_INTERVAL_S: 0'; allowed there: a positive number",
    ),
    "unam component": (
        samples.unam([WAVE] * 3),
        {},
        r"component is missing: record.txt has 1 \(V\), 2 \(N00E\), 3 \(N90E\); give component=",
    ),
    "unam two alike": (
        samples.unam([WAVE] * 3, "/V/V/V"),
        {"component": "V"},
        "component = 'V' is more than one in record.txt",
    ),
    "unam step": (
        samples.unam([WAVE] * 3).replace("/0.005/0.005/0.005", "/0.005/0.005"),
        {},
        "line 18: 'INTERVALO .*a positive number for each of 3 channels",
    ),
    "unam decimated": (
        samples.unam([WAVE] * 3).replace("/0.20/0.20/0.20", "/0.40/0.40/0.40"),
        {"component": 1},
        "line 22: 'DURACION .*the length of 40 samples with a step of 0.005 s",
    ),
    "unam cut": (samples.unam([WAVE] * 3)[:-31], {}, "holds 117 values, but line 23 states 120"),
    "unam no data": (
        samples.unam([WAVE]).replace("DATOS DE ACEL", "ACEL"),
        {},
        "has no data; allowed: ",
    ),
    "csmip velocity": (
        samples.csmip(CHANNELS).replace("cm/sec2", "cm/sec"),
        {"component": 1},
        "units = 'cm/sec' is not",
    ),
    "csmip volume 1": (
        samples.csmip({"Up": WAVE}).replace("of accel data", "of raw data"),
        {},
        "has no accelerations; allowed: such as '15050 points of accel data",
    ),
    "csmip step": (samples.csmip({"Up": WAVE}, step="no"), {}, "line 6: .*equally spaced at no sec"),
    "cosmos no step": (
        samples.cosmos({"Up": WAVE}, step=-999.0),
        {},
        "dt is missing and record.txt does",
    ),
    "cosmos length": (
        samples.cosmos({"Up": WAVE}).replace("    0.400000", "    0.800000"),
        {},
        "line 25: .*the length of 40 samples with a step of 0.01 s",
    ),
    "cosmos velocity": (
        samples.cosmos({"Up": WAVE}).replace("  acceleration pts", "  velocity pts"),
        {},
        "record.txt has no accelerations",
    ),
    "gzip cut": (
        gzip.compress(samples.knet(COUNTS).encode())[:-9],
        {},
        "gzip and damaged .*fetch it again",
    ),
    "gzip too large": (gzip.compress(bytes(2**26 + 1)), {}, "record.txt, unpacked, has 67108865 bytes"),
    "component of a list": (
        samples.knet(COUNTS),
        {"component": [1]},
        r"component = \[1\]; allowed: the name",
    ),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_broken_files_are_refused_by_line(tmp_path, case):
    text, options, message = REFUSALS[case]
    with pytest.raises(ValueError, match=message):
        read(tmp_path, text, **options)


# --- Semicolons and decimal commas ---------------------------------------------------------------------

TIMES = np.arange(40) / 50
POINTS = "t [s];acc, north [gal];when\n" + "".join(
    f"{time:.2f};{value:.4f};24.12.2000\n" for time, value in zip(TIMES, WAVE, strict=True)
)
COMMAS = POINTS.replace(".", ",").replace("24,12,2000", "24.12.2000")
BOTH = {"time_column": 0, "column": 1}


@pytest.mark.parametrize(
    "text", [POINTS, COMMAS, COMMAS.replace(";24.12.2000", "").replace(";when", "")]
)
def test_semicolons_may_separate_decimal_commas(tmp_path, text):
    record = read(tmp_path, text, **BOTH)
    np.testing.assert_allclose(record, WAVE / 100, rtol=1e-12)
    assert record.attrs["dt"] == 0.02


def test_points_and_commas_together_are_refused(tmp_path):
    mixed = COMMAS.replace(";0,0000;", ";0.0000;")
    with pytest.raises(ValueError, match="has decimal points in line 2 and decimal commas in line 2"):
        read(tmp_path, mixed, **BOTH)
    with pytest.raises(ValueError, match=r"line 3: '1\.032\.7195' is not a number"):
        read(tmp_path, COMMAS.replace("32,7195", "1.032,7195"), **BOTH)


# --- Suites and case files -----------------------------------------------------------------------------


def test_a_suite_reads_one_component_of_each_file(tmp_path):
    write(tmp_path, samples.unam([WAVE, 2 * WAVE, WAVE]), "ACAC1709.191")
    write(
        tmp_path,
        gzip.compress(samples.unam([WAVE, WAVE, 2 * WAVE], "/N90E/V/N00E").encode()),
        "B.191.gz",
    )
    write(tmp_path, "no record", "read.me")
    suite = sl.read_records(tmp_path, component="N00E")
    assert list(suite) == ["ACAC1709.191", "B.191.gz"]
    for record in suite.values():
        np.testing.assert_allclose(record, WAVE / 50, rtol=1e-12)
    table = write(tmp_path, "file,component\nACAC1709.191,V\nB.191.gz,N90E\n", "table.csv")
    for record in sl.read_records(table).values():
        np.testing.assert_allclose(record, WAVE / 100, rtol=1e-12)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a.AT2", True),
        ("MYG002.NS", True),
        ("x.EW2.gz", True),
        ("s.V2c", True),
        ("s.v2", True),
        ("ACAC1709.191", True),
        ("h.ASC", True),
        ("notes.md", False),
        ("a.tar.gz", False),
        ("a.1234", False),
    ],
)
def test_folders_are_searched_for_the_endings_of_all_formats(name, expected):
    assert is_record(name) is expected


def test_a_case_file_names_the_component(tmp_path):
    write(tmp_path, samples.unam([WAVE, 2 * WAVE, WAVE]), "ACAC1709.191")
    text = recorded_example().replace('"taft.txt"', '"ACAC1709.191"\ncomponent = "N00E"')
    case = write(tmp_path, text.replace('\nunits = "g"', "").replace('\ndt = "0.01 s"', ""), "case.toml")
    (record,) = sl.read_case(case).records.values()
    np.testing.assert_allclose(record, WAVE / 50, rtol=1e-12)
    case.write_text(case.read_text().replace('"N00E"', '"N45E"'))
    with pytest.raises(
        ValueError, match=r"case.toml, line \d+: .*component = 'N45E' is not in ACAC1709"
    ):
        sl.read_case(case)


def test_a_component_names_a_file_that_holds_one(tmp_path):
    text = "\n".join(f"{value:.4f}" for value in WAVE)
    record = read(tmp_path, text, dt=0.01, units="gal", component="NS")
    assert record.attrs["component"] == "NS"
    write_at2(record, tmp_path / "a.at2")
    again = sl.read_record(tmp_path / "a.at2", component="NS")
    np.testing.assert_allclose(again, record, rtol=1e-6, atol=1e-9)
