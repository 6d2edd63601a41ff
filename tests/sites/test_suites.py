"""Suites of records: read, scaled, written, and asked for gaps."""

import csv
from pathlib import Path

import numpy as np
import pytest
from motions import write_at2

import stochlin as sl

G = 9.80665
MOTIONS = sl.simulated_motions(sl.named_ground("firm", 0.01), 15.0, paths=3, seed=8)
SUITE = dict(zip("abc", MOTIONS, strict=True))
SHARED = Path(__file__).parents[3] / "shared" / "records"


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "more").mkdir()
    write_at2(MOTIONS[0], tmp_path / "one.AT2")
    write_at2(MOTIONS[1], tmp_path / "more" / "two.at2")
    (tmp_path / "notes.md").write_text("not a record", encoding="utf-8")
    return tmp_path


def columns(path, motion, with_time):
    rows = zip(motion.time.values, motion.values / G, strict=True)
    lines = [f"{t:.4f} {a:.9e}" if with_time else f"{a:.9e}" for t, a in rows]
    path.write_text("\n".join(lines), encoding="utf-8")


def test_a_folder_is_read_in_the_order_of_its_names(folder):
    suite = sl.read_records(folder)
    assert list(suite) == ["more/two.at2", "one.AT2"]
    np.testing.assert_allclose(suite["one.AT2"], MOTIONS[0], atol=1e-6)


def test_a_table_says_of_each_file_what_it_is(folder):
    columns(folder / "timed.txt", MOTIONS[2], with_time=True)
    columns(folder / "plain.txt", MOTIONS[2], with_time=False)
    table = folder / "suite.csv"
    table.write_text(
        'file,event,dt,units\none.AT2,first,,\ntimed.txt,second,0.01,"t s, g"\n'
        "plain.txt,third,0.01,g; as it came\n",
        encoding="utf-8",
    )
    suite = sl.read_records(table)
    assert list(suite) == ["one.AT2", "timed.txt", "plain.txt"]
    np.testing.assert_allclose(suite["timed.txt"], suite["plain.txt"], rtol=1e-12)


def test_a_time_step_of_a_table_that_contradicts_the_file_is_refused(folder):
    columns(folder / "timed.txt", MOTIONS[2], with_time=True)
    table = folder / "suite.csv"
    table.write_text('file,dt,units\ntimed.txt,0.02,"t s, g"\n', encoding="utf-8")
    with pytest.raises(ValueError, match=r"suite.csv, line 2, timed.txt: dt = 0.02 contradicts"):
        sl.read_records(table)


def test_a_record_knows_where_it_is_from(folder):
    table = folder / "suite.csv"
    table.write_text("file,event,station,component\none.AT2,Duzce,Bolu,\n", encoding="utf-8")
    about = sl.read_records(table)["one.AT2"].attrs
    assert (about["event"], about["station"]) == ("Duzce", "Bolu")
    assert "component" not in about


@pytest.mark.parametrize(
    ("title", "known"),
    [
        ("Imperial Valley-02, 5/19/1940, El Centro Array #9, 180", "Imperial Valley-02, 5/19/1940"),
        ("KOBE 01/16/95 2046, El Centro Array #9, 090 (CUE)", "KOBE 01/16/95 2046"),
        ("written by another program", None),
    ],
)
def test_the_title_of_an_at2_file_names_earthquake_and_station(folder, title, known):
    path = folder / "one.AT2"
    *_, rest = path.read_text(encoding="utf-8").split("\n", 3)
    head = "PEER NGA STRONG MOTION DATABASE RECORD"
    units = "ACCELERATION TIME HISTORY IN UNITS OF G,  PGA=   .48431 G"
    path.write_text("\n".join([head, title, units, rest]), encoding="utf-8")
    about = sl.read_record(path).attrs
    assert about.get("event") == known
    assert about.get("station") == (known and "El Centro Array #9")


@pytest.mark.skipif(not SHARED.exists(), reason="no records beside the project")
def test_a_table_of_records_that_were_measured():
    suite = sl.read_records(SHARED / "suites.csv")
    with (SHARED / "suites.csv").open(encoding="utf-8", newline="") as file:
        listed = {row["file"]: float(row["pga_g"]) for row in csv.DictReader(file)}
    peaks = {name: float(abs(record).max()) / G for name, record in suite.items()}
    assert peaks == pytest.approx(listed, abs=6e-5)


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("path\none.AT2", "has the columns path; allowed: a table with a column 'file'"),
        ("file\nnone.at2", "suite.csv, line 2, none.at2: .*there is no such file"),
        ("file\none.AT2\none.AT2", "line 3, one.AT2 is listed twice"),
        ("file,dt\nplain.txt,soon", "line 2, plain.txt: dt = 'soon' is no number"),
        ("file,units\nplain.txt,feet", "line 2, plain.txt: units = 'feet' is not a unit"),
        ('file,units\nplain.txt,"a, b, c"', "units = 'a, b, c'; allowed: one unit"),
        ("file", "suite.csv holds no record that can be read"),
    ],
)
def test_a_table_that_is_wrong_names_the_line(folder, rows, message):
    columns(folder / "plain.txt", MOTIONS[2], with_time=False)
    table = folder / "suite.csv"
    table.write_text(rows + "\n", encoding="utf-8")
    with pytest.raises(ValueError, match=message):
        sl.read_records(table)


@pytest.mark.invariant
def test_a_file_that_cannot_be_read_is_named_and_left_out_if_asked(folder):
    (folder / "bad.txt").write_text("1\ntwo\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"bad\.txt: "):
        sl.read_records(folder, units="g", dt=0.01)
    with pytest.warns(UserWarning, match=r"bad\.txt is left out"):
        suite = sl.read_records(folder, skip_unreadable=True)
    assert len(suite) == 2


@pytest.mark.invariant
def test_a_folder_that_is_not_there(tmp_path):
    with pytest.raises(FileNotFoundError, match="neither a folder nor a table"):
        sl.read_records(tmp_path / "records")


@pytest.mark.oracle
def test_scaled_to_a_peak_to_a_period_and_to_a_spectrum():
    peaks = [float(abs(r).max()) for r in sl.scale_records(SUITE, pga=2.5).values()]
    np.testing.assert_allclose(peaks, 2.5, rtol=1e-12)
    for record in sl.scale_records(SUITE, sa=4.0, period=0.7).values():
        found = sl.response_spectrum(record, [0.7], 0.05).pseudo_acceleration
        assert float(found[0]) == pytest.approx(4.0, rel=1e-9)
    target = sl.eurocode_8(0.25 * G, "B")
    periods = np.geomspace(0.3, 1.5, 40)
    for record in sl.scale_records(SUITE, spectrum=target, band=(0.3, 1.5)).values():
        found = sl.response_spectrum(record, periods, 0.05).pseudo_acceleration
        wanted = np.exp(np.interp(np.log(periods), np.log(target.period[1:]), np.log(target[1:])))
        assert float(np.log(found / wanted).mean()) == pytest.approx(0, abs=1e-9)
        assert record.attrs["scale"] > 0


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({}, "nothing is given; allowed: one of pga, sa with a period, spectrum"),
        ({"pga": 1.0, "sa": 2.0, "period": 1.0}, "pga and sa is given"),
        ({"sa": 2.0}, "sa and period go together"),
        ({"pga": -1.0}, "pga = -1.0 is out of range; allowed: a positive, finite number in m/s"),
        ({"spectrum": sl.eurocode_8(2.0, "A"), "band": (2.0, 8.0)}, "is not within the spectrum"),
        ({"pga": 1.0, "band": (2.0, 1.0)}, "allowed: 0 < lower < upper"),
    ],
)
def test_what_is_no_scale_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        sl.scale_records(SUITE, **options)


@pytest.mark.invariant
def test_a_factor_that_is_hardly_meant_is_asked_about():
    weak = 0.01 * SUITE["a"]
    with pytest.warns(UserWarning, match="a is scaled by"):
        sl.scale_records({"a": weak.assign_attrs(SUITE["a"].attrs)}, pga=float(abs(SUITE["a"]).max()))


@pytest.mark.oracle
def test_quantiles_of_the_gap_over_a_suite():
    one, two = sl.Bilinear([0.5, 0.6], 0.05), sl.Bilinear(1.0, 0.05)
    table = sl.recorded_gap(one, two, SUITE)
    wanted = np.quantile(table.separation, table["quantile"], axis=0)
    np.testing.assert_allclose(table.separation_quantile, wanted)
    assert (table.separation_quantile_lower <= table.separation_quantile).all()
    assert (table.separation_quantile_upper >= table.separation_quantile).all()
    assert "separation_quantile" not in sl.recorded_gap(one, two, SUITE["a"])
