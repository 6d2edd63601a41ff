"""Records: published check values, every format and every refusal."""

from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from motions import FOLDER, motion, needs_records, recorded

import stochlin as sl
from stochlin.analyses.records.records import strong_part

pytestmark = pytest.mark.oracle

G = 9.80665

WAVE = [round(float(value), 6) for value in np.sin(np.arange(40) / 3) * 0.1]


def write(folder: Path, text: str | bytes, name: str = "record.txt") -> Path:
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def lines(*columns: list[float], separator: str = " ") -> str:
    return (
        "\n".join(separator.join(str(value) for value in row) for row in zip(*columns, strict=True))
        + "\n"
    )


def times(count: int = 40, step: float = 0.02) -> list[float]:
    return [round(step * i, 9) for i in range(count)]


def at2(header: str, values: list[float] = WAVE, units: str = "G") -> str:
    body = "\n".join(
        "".join(f"{value:15.6E}" for value in values[i : i + 5]) for i in range(0, len(values), 5)
    )
    title = (
        f"PEER NGA STRONG MOTION DATABASE RECORD\nSomewhere, 1/1/2000\nACCELERATION IN UNITS OF {units}"
    )
    return f"{title}\n{header}\n{body}\n"


# --- Published check values -----------------------------------------------------------------------


@needs_records
@pytest.mark.parametrize(
    ("name", "options", "peak", "samples", "step"),
    [
        ("sct190985.txt", {"units": "g", "column": 1, "time_column": 0}, 0.0995, 8171, 0.02),
        ("sct190985.txt", {"units": "g", "column": 2, "time_column": 0}, 0.1712, 8171, 0.02),
        ("sct190985.txt", {"units": "g", "column": 2, "time_column": 0, "dt": 0.02}, 0.1712, 8171, 0.02),
        ("RSN15_KERN_TAF111.txt", {"units": "g", "dt": 0.01}, 0.1803, 5437, 0.01),
        ("elc180.AT2", {}, 0.2808, 5372, 0.01),
        ("NIS090.AT2", {"units": "g", "dt": 0.01}, 0.5027, 4096, 0.01),
    ],
)
def test_records_have_their_published_peaks(name, options, peak, samples, step):
    record = sl.read_record(FOLDER / name, **options)
    assert float(abs(record).max()) / G == pytest.approx(peak, abs=5e-5)
    assert record.sizes == {"time": samples}
    assert record.attrs["dt"] == step
    assert record.attrs["source"] == name
    np.testing.assert_allclose(np.diff(record.time), step, rtol=1e-9)


@needs_records
def test_a_step_that_contradicts_a_real_time_column_is_refused():
    with pytest.raises(ValueError, match=r"dt = 0\.01 contradicts the time, whose step is 0\.02 s"):
        recorded("SCT", column=1, dt=0.01)


@needs_records
def test_lake_bed_spectrum_peaks_at_its_published_period():
    record = recorded("SCT")
    spectra = sl.charts.fit_spectra(record, sl.WhiteNoise(), part=(0, 1))
    peak = float(spectra.psd_record.idxmax("frequency"))
    step = 2.05**2 / 163.4  # of neighbouring Fourier periods
    assert 2 * np.pi / peak == pytest.approx(2.05, abs=1.5 * step)


# --- Formats ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "header",
    [
        "NPTS=  40, DT=   .0100 SEC,            ",
        "NPTS= 40, DT= .01 SEC",
        "npts=40,dt=1.0E-02",
        "  40    0.0100    NPTS, DT",
        "40 .01 NPTS, DT",
    ],
)
def test_at2_headers(tmp_path, header):
    record = sl.read_record(write(tmp_path, at2(header), "a.AT2"))
    np.testing.assert_allclose(record, np.array(WAVE) * G, rtol=1e-12)
    assert record.attrs == {
        "units": "m/s^2",
        "long_name": "ground acceleration",
        "source": "a.AT2",
        "dt": 0.01,
    }
    assert record.name == "acceleration"
    assert record.time.attrs["units"] == "s"
    assert float(record.time[-1]) == pytest.approx(0.39)


@pytest.mark.parametrize("sign", [-1, 1])
def test_a_time_may_be_a_quarter_of_a_step_astray(tmp_path, sign):
    def read(share):
        time = np.array(times())
        time[20] += 0.02 * sign * share
        options = {"units": "g", "column": 1, "time_column": 0}
        return sl.read_record(write(tmp_path, lines(time.tolist(), WAVE)), **options)

    np.testing.assert_allclose(read(0.24).time, times(), rtol=1e-9)
    with pytest.raises(ValueError, match=r"time is uneven: its step changes before 0\.[34]\d* s"):
        read(0.26)


def test_at2_states_its_units(tmp_path):
    path = write(tmp_path, at2("NPTS= 40, DT= .01 SEC", units="CM/SEC/SEC"))
    np.testing.assert_allclose(sl.read_record(path), np.array(WAVE) / 100, rtol=1e-12)
    silent = write(tmp_path, at2("NPTS= 40, DT= .01 SEC").replace("IN UNITS OF G", ""))
    np.testing.assert_allclose(sl.read_record(silent, units="gal"), np.array(WAVE) / 100, rtol=1e-12)
    with pytest.raises(
        ValueError, match=r"units is missing .* 'g', 'm/s\^2', 'cm/s\^2', 'mm/s\^2', 'gal'"
    ):
        sl.read_record(silent)


@pytest.mark.parametrize(
    "text",
    [
        lines(times(), WAVE),
        lines(times(), WAVE, separator="\t"),
        lines(times(), WAVE, separator=","),
        lines(times(), WAVE, separator=" , "),
        lines(times(), WAVE, separator=";"),
        lines(times(), WAVE, separator=",").replace("\n", ",\n"),
        lines(times(), WAVE).replace("\n", "\r\n"),
        lines(times(), WAVE).replace("\n", "\n\n  \n"),
        "# a comment\n% another\n\n" + lines(times(), WAVE).replace("\n", "  # inline\n"),
        "time,acc\n" + lines(times(), WAVE, separator=","),
        '"time" , "acc"\r\n' + lines(times(), WAVE, separator=",").replace("\n", "\r\n"),
        "time (s)\tacc north\n" + lines(times(), WAVE, separator="\t"),
        "time acc\n" + lines(times(), WAVE),
        lines(times(), WAVE) + "\x1a",
        b"\xef\xbb\xbf" + lines(times(), WAVE).encode(),
        "# México\n".encode("latin-1") + lines(times(), WAVE).encode(),
    ],
)
def test_columns_are_taken_by_number(tmp_path, text):
    path = write(tmp_path, text)
    for column in (1, None):
        record = sl.read_record(path, units="m/s^2", column=column, time_column=0)
        np.testing.assert_array_equal(record, WAVE)
        np.testing.assert_allclose(record.time, times(), atol=1e-12)
        assert record.attrs["dt"] == 0.02


def test_columns_are_taken_by_name(tmp_path):
    other = [2 * value for value in WAVE]
    text = "time,north [gal],east [gal]\n" + lines(times(), WAVE, other, separator=",")
    path = write(tmp_path, text)
    east = sl.read_record(path, units="gal", column="east [gal]", time_column="time")
    np.testing.assert_allclose(east, np.array(other) / 100)
    with pytest.raises(ValueError, match=r"units = 'g' contradicts record.txt, which states 'cm/s\^2'"):
        sl.read_record(path, units="g", column=1, time_column=0)


def test_unused_columns_may_hold_text(tmp_path):
    text = lines(["2000-01-01"] * 40, WAVE, separator=",")
    np.testing.assert_array_equal(
        sl.read_record(write(tmp_path, text), units="m/s^2", column=1, dt=0.5), WAVE
    )


@pytest.mark.parametrize("spelling", [".5E-03", "+0.5e-3", ".5D-03", "0.5d-3", "5.E-4", "0.0005"])
def test_fortran_numbers_are_read(tmp_path, spelling):
    path = write(tmp_path, "\n".join([spelling] * 20))
    np.testing.assert_array_equal(sl.read_record(path, dt=0.01, units="m/s^2"), 0.0005)


@pytest.mark.parametrize(
    ("units", "metres"),
    [
        ("g", G),
        ("G", G),
        ("m/s^2", 1),
        ("cm/s^2", 0.01),
        ("gal", 0.01),
        ("Gal", 0.01),
        ("mm/s^2", 0.001),
    ],
)
def test_units_become_metres(tmp_path, units, metres):
    record = sl.read_record(write(tmp_path, lines(WAVE)), dt=0.01, units=units)
    np.testing.assert_allclose(record, np.array(WAVE) * metres, rtol=1e-15)


@pytest.mark.parametrize("step", [0.005, 1 / 128, 1 / 300, 0.02])
def test_printed_times_are_rounded(tmp_path, step):
    time = [round(step * i, 3) for i in range(1000)]
    values = list(np.sin(np.arange(1000)))
    path = write(tmp_path, lines(time, values))
    assert sl.read_record(path, units="g", time_column=0).attrs["dt"] == pytest.approx(step, rel=2e-4)
    assert sl.read_record(path, units="g", time_column=0, dt=step).attrs["dt"] == step


def test_single_precision_times_and_a_late_start(tmp_path):
    time = [float(f"{np.float32(100 + 0.02 * (i + 1)):.5f}") for i in range(4000)]
    assert 163.37999 in time or any(abs(t * 50 - round(t * 50)) > 1e-4 for t in time)
    record = sl.read_record(write(tmp_path, lines(time, [1.0] * 4000)), units="g", time_column=0)
    assert record.attrs["dt"] == pytest.approx(0.02, rel=1e-6)
    assert float(record.time[0]) == pytest.approx(100.02)


# --- Refusals ---------------------------------------------------------------------------------------

TABLE = lines(times(), WAVE, WAVE)
NAMED = "time,north,east\n" + lines(times(), WAVE, WAVE, separator=",")
SINGLE = lines(WAVE)
READY = {"dt": 0.01, "units": "g"}
BOTH = {"units": "g", "time_column": 0}


def changed(index: int, value: str, *, first: bool = False) -> str:
    rows = lines(times(), WAVE).splitlines()
    fields = rows[index].split()
    rows[index] = f"{value} {fields[1]}" if first else f"{fields[0]} {value}"
    return "\n".join(rows)


def without(*indices: int) -> str:
    return "\n".join(row for i, row in enumerate(lines(times(), WAVE).splitlines()) if i not in indices)


DRIFTING = lines([round(0.01 * i * (1 + i / 500), 5) for i in range(100)], [1.0] * 100)

REFUSALS = {
    "empty": ("", READY, "record.txt is empty"),
    "only names": ("time,acc\n", READY, "record.txt is empty"),
    "no dt": (SINGLE, {"units": "g"}, r"dt is missing .*give dt= in seconds, or time_column="),
    "no units": (SINGLE, {"dt": 0.01}, r"units is missing .*'g', 'm/s\^2', 'cm/s\^2', 'mm/s\^2', 'gal'"),
    "unknown units": (
        SINGLE,
        {"dt": 0.01, "units": "ft/s2"},
        "units = 'ft/s2' is not a unit of acceleration",
    ),
    "dt zero": (
        SINGLE,
        {"dt": 0, "units": "g"},
        "dt = 0 is out of range; allowed: a positive, finite number of seconds",
    ),
    "no column": (
        TABLE,
        READY,
        r"column is missing: record.txt has 3 columns \(index 0 to 2\); give column=",
    ),
    "no column, names": (NAMED, BOTH, r"3 columns \(index 0 to 2\) named time, north, east"),
    "column too high": (TABLE, {**BOTH, "column": 3}, r"column = 3 is not in .* 3 columns"),
    "column name": (NAMED, {**BOTH, "column": "up"}, "column = 'up' is not in .*time, north, east"),
    "same column": (TABLE, {**BOTH, "column": 0}, "column = 0 is the time_column as well"),
    "minutes": (
        "t [min],acc\n" + lines(times(), WAVE, separator=","),
        BOTH,
        r"time_column = 0 is named 't \[min\]'; allowed: time in seconds",
    ),
    "text": (changed(7, "0.1x"), BOTH, r"record.txt, line 8: '0.1x' is not a number"),
    "empty field": ("0.0,1\n0.1,2\n0.2,\n" * 9, BOTH, "line 3: 1 columns, but line 1 has 2"),
    "NaN": (changed(9, "NaN"), BOTH, "line 10: 'NaN' is not finite"),
    "ragged": ("1 2 3\n4 5\n", READY, "line 2: 2 columns, but line 1 has 3; start a title with #"),
    "title": ("Record of a day\n" + SINGLE, READY, "line 2: 1 columns, but line 1 has 4; start a title"),
    "repeated time": (
        changed(5, "0.08", first=True),
        BOTH,
        r"does not increase: 0\.08 s is followed by 0\.08 s",
    ),
    "gap": (
        without(10),
        BOTH,
        r"time has a gap at 0\.18 s: the next is 0\.22 s, but the step is 0\.02 s",
    ),
    "drift": (DRIFTING, BOTH, r"time is uneven: its step changes before 0\.\d+ s|time has a gap"),
    "dt and time": (
        lines(times(), WAVE),
        {**BOTH, "dt": 0.01},
        r"dt = 0\.01 contradicts the time, .* 0\.02 s",
    ),
    "short": (lines(WAVE[:15]), READY, "record has 15 samples; allowed: at least 16"),
    "zeros": ("0.0\n" * 40, READY, "record holds only zeros"),
    "velocity": (
        "t,vel [cm/s]\n" + lines(times(), WAVE, separator=","),
        BOTH,
        r"column 'vel \[cm/s\]' of record.txt is in cm/s, which is no acceleration",
    ),
    "acceleration that is not known": (
        "t,acc (ft/s2)\n" + lines(times(), WAVE, separator=","),
        BOTH,
        r"is in ft/s2, which is no acceleration that is known; allowed: 'g'",
    ),
    "decimal commas": ("0,012\n-0,034\n" * 20, READY, "decimal commas, as in '0,012'; write"),
    "decimal commas, tabs": (
        "0,02\t0,012\n" * 20,
        {**BOTH, "column": 1},
        "line 1: .* is not a number.*decimal point",
    ),
    "UTF-16": (lines(WAVE).encode("utf-16"), READY, "record.txt is text in UTF-16; allowed: UTF-8"),
    "binary": (np.array(WAVE).tobytes(), READY, "record.txt is no text; allowed: PEER AT2"),
    "tiny step": (
        SINGLE,
        {"dt": 1e-300, "units": "g"},
        r"record.txt is 1e-300 s; allowed: 1e-06",
    ),
    "huge step": (at2("NPTS= 40, DT= 1E999 SEC"), {}, "is not the header of an AT2 file"),
    "two AT2 records": (at2("NPTS= 40, DT= .01 SEC") * 2, {}, r"'PEER' is not a number"),
    "AT2 dt": (at2("NPTS= 40, DT= .01 SEC"), {"dt": 0.02}, r"dt = 0\.02 contradicts .*states 0\.01"),
    "AT2 units": (
        at2("NPTS= 40, DT= .01 SEC"),
        {"units": "gal"},
        r"units = 'cm/s\^2' contradicts .*'g'",
    ),
    "AT2 velocity": (
        at2("NPTS= 40, DT= .01 SEC", units="CM/S"),
        {},
        "record.txt: units = 'CM/S' is not a unit of acceleration",
    ),
    "AT2 count": (at2("NPTS= 41, DT= .01 SEC"), {}, "holds 40 values, but line 4 states NPTS = 41"),
    "AT2 header": (
        at2("NPTS 40 DT 0.01"),
        {},
        "line 4: 'NPTS 40 DT 0.01' is not the header of an AT2 file",
    ),
    "AT2 column": (at2("NPTS= 40, DT= .01 SEC"), {"column": 0}, "column and time_column do not apply"),
    "AT2 text": (at2("NPTS= 40, DT= .01 SEC").replace("E", "x", 12), {}, r"line \d+: .* is not"),
}


@pytest.mark.parametrize("case", REFUSALS)
def test_refusals_say_what_and_where(tmp_path, case):
    text, options, message = REFUSALS[case]
    with pytest.raises(ValueError, match=message):
        sl.read_record(write(tmp_path, text), **options)


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (lines([i * 10 for i in range(40)], WAVE), BOTH, "its time step is 10 s.*is time in seconds"),
        (lines([100 * value for value in WAVE]), READY, "its peak is 10 g.*are the units right"),
        (
            "t,vel\n" + lines(times(), WAVE, separator=","),
            BOTH,
            "its column is named 'vel'; is that an acceleration",
        ),
        (TABLE, {**READY, "column": 0}, "its values increase throughout.*the right column"),
    ],
)
def test_what_is_hardly_meant_is_asked_about(tmp_path, text, options, message):
    with pytest.warns(UserWarning, match=f"^record.txt: {message}") as caught:
        record = sl.read_record(write(tmp_path, text), **options)
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert record.sizes == {"time": 40}


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"absent\.txt"):
        sl.read_record(tmp_path / "absent.txt", **READY)


# --- Strong part --------------------------------------------------------------------------------------


def history(values, step=0.01, **attrs):
    return motion(values, step, **attrs)


def test_strong_part_of_a_constant_signal():
    record = history(np.full(1001, -2.0), units="m/s^2", source="a")
    part = strong_part(record)
    assert float(part.time[0]) == pytest.approx(0.5, abs=0.011)
    assert float(part.time[-1]) == pytest.approx(9.5, abs=0.011)
    assert part.attrs == {"units": "m/s^2", "source": "a", "energy_part": "5-95 %"}
    assert "energy_part" not in record.attrs


def test_strong_part_of_a_decaying_signal():
    """Energy 1 - exp(-2 t), so the part runs from -log(1-start)/2 to -log(1-end)/2."""
    step = 1e-3
    record = history(np.exp(-step * np.arange(20000)), step)
    part = strong_part(record, 0.25, 0.75)
    expected = -np.log1p([-0.25, -0.75]) / 2
    np.testing.assert_allclose(part.time[[0, -1]], expected, atol=1.5 * step)


@pytest.mark.parametrize("fractions", [(0.05, 0.95), (0.0, 0.5), (0.3, 0.31), (0.5, 1.0), (0, 1)])
def test_strong_part_holds_its_share_of_the_energy(fractions):
    record = history(np.random.default_rng(3).standard_normal(5000))
    part = strong_part(record, *fractions)
    share = float((part**2).sum() / (record**2).sum())
    one_sample = 2 * float((record**2).max() / (record**2).sum())
    assert share == pytest.approx(fractions[1] - fractions[0], abs=one_sample)
    assert strong_part(3 * record, *fractions).time.equals(part.time)


def test_whole_record_loses_nothing_but_silence_at_its_end():
    values = np.random.default_rng(3).standard_normal(500)
    assert strong_part(history(values), 0, 1).sizes["time"] == 500
    assert strong_part(history(np.append(values, np.zeros(100))), 0, 1).sizes["time"] == 500


@pytest.mark.parametrize("fractions", [(-0.1, 0.9), (0.5, 0.5), (0.9, 0.1), (0, 1.1), (np.nan, 0.9)])
def test_strong_part_refuses_fractions(fractions):
    with pytest.raises(ValueError, match="allowed: 0 <= start < end <= 1"):
        strong_part(history(WAVE), *fractions)


@pytest.mark.parametrize(
    ("record", "error", "message"),
    [
        (np.ones(50), TypeError, "record is a ndarray; allowed: an xarray.DataArray"),
        (xr.DataArray(np.ones(50), dims="time"), ValueError, "allowed: time alone, with its coordinate"),
        (
            history(WAVE).assign_coords(time=np.arange(40).astype("datetime64[ns]")),
            TypeError,
            r"float64 and datetime64\[ns\]; allowed: numbers",
        ),
        (history(WAVE) * 1j, TypeError, "complex128 and float64; allowed: numbers"),
        (history(WAVE, units="g"), ValueError, r"record has units 'g'; allowed: m/s\^2"),
        (history([1.0] * 20 + [np.nan]), ValueError, r"record is nan at 0\.2 s"),
        (history(WAVE).isel(time=slice(None, None, -1)), ValueError, "time does not increase"),
    ],
)
def test_what_is_not_a_record(record, error, message):
    with pytest.raises(error, match=message):
        strong_part(record)
