"""Columns of all files: known by what their titles say, and never by their place."""

import re
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from cases import read_text

import stochlin as sl
from stochlin.applications.sheets.quantities import (
    ANGULAR_COLUMN,
    DISPLACEMENT_COLUMN,
    FREQUENCY_COLUMN,
    PERIOD_COLUMN,
    QUANTITIES,
    RATE_COLUMN,
    RETURN_PERIOD_COLUMN,
    TIME_COLUMN,
    Quantity,
)
from stochlin.models.units import UNITS, size_of

pytestmark = pytest.mark.invariant

G = 9.80665
T = np.geomspace(0.05, 4.0, 24)
SA = np.where(T < 0.5, 1.0, 0.5 / T) * (1 - np.exp(-25 * T))  # g
TIMES = 0.02 * np.arange(24)
WAVE = 0.1 * np.sin(np.arange(24))
LEVELS = np.geomspace(0.05, 1.6, 6)
RATES = 1e-4 * LEVELS**-2.5
ROOF, SHEAR = np.array([0, 0.01, 0.03, 0.06]), np.array([0, 500, 700, 750])


class Reader(NamedTuple):
    """A reader with a table that it reads, and what it gives."""

    read: Callable[..., Any]
    titles: Sequence[str]
    columns: Sequence[np.ndarray]
    names: Sequence[str]  # of its arguments
    values: Callable[[Any], np.ndarray]
    wanted: np.ndarray
    # What the first column has under a title of these quantities; no other one is read.
    first: dict[Quantity, np.ndarray]
    options: dict[str, Any]  # for a table without units


read_elastic = partial(sl.read_spectrum, elastic=True)


def both(array: Any) -> np.ndarray:
    """Coordinate and values of an array."""
    return np.array([array[array.dims[0]].values, array.values])


READERS = {
    "spectrum": Reader(
        read_elastic,
        ("Period [s]", "Sa [g]"),
        (T, SA),
        ("period_column", "column"),
        both,
        np.array([T, G * SA]),
        {PERIOD_COLUMN: T, FREQUENCY_COLUMN: 1 / T, ANGULAR_COLUMN: 2 * np.pi / T},
        {"units": "g"},
    ),
    "record": Reader(
        sl.read_record,
        ("time [s]", "acc [g]"),
        (TIMES, WAVE),
        ("time_column", "column"),
        both,
        np.array([TIMES, G * WAVE]),
        {TIME_COLUMN: TIMES},
        {"units": "g"},
    ),
    "hazard": Reader(
        sl.read_hazard,
        ("annual rate", "pga [g]"),
        (RATES, LEVELS),
        ("frequency_column", "column"),
        lambda curve: np.array([curve.frequencies, curve.intensities]),
        np.array([RATES, G * LEVELS]),
        {RATE_COLUMN: RATES, RETURN_PERIOD_COLUMN: 1 / RATES},
        {"units": "g"},
    ),
    "pushover": Reader(
        sl.read_pushover,
        ("roof [m]", "base shear [kN]"),
        (ROOF, SHEAR),
        ("displacement_column", "force_column"),
        both,
        np.array([ROOF, 1e3 * SHEAR]),
        {DISPLACEMENT_COLUMN: ROOF},
        {"length_units": "m", "force_units": "kN"},
    ),
}
UNLIKE = {  # other columns that files have
    "Remark": [f"x{n}" for n in range(24)],
    "Nr": np.arange(1, 25),
    "Vs30 [km/s]": np.linspace(0.2, 0.8, 24),
    "": np.arange(24),
}


def written(folder: Path, titles: Sequence[str], columns: Sequence[Any]) -> Path:
    path = folder / "a.csv"
    rows = zip(*columns, strict=False)
    names = [f'"{title}"' if "," in title else title for title in titles]
    lines = [",".join(names), *(",".join(f"{x}" for x in row) for row in rows)]
    path.write_text("\n".join(lines if any(titles) else lines[1:]), encoding="utf-8")
    return path


@pytest.mark.parametrize("name", READERS)
def test_a_first_column_of_any_title_is_read_right_or_refused_by_its_title(name, tmp_path):
    """Each word of the table is the title of a column with the coordinate, or what follows from it.

    Of words of the same meaning, readers other than that of spectra get one.
    """
    reader = READERS[name]
    words = {quantities: word for word, quantities in QUANTITIES.items()}.values()
    for word in QUANTITIES if name == "spectrum" else words:
        quantities = QUANTITIES[word]
        fitting = [of for of in reader.first if of in quantities]
        first = reader.first[fitting[0]] if fitting else reader.columns[0]
        path = written(tmp_path, [word, reader.titles[1]], [first, reader.columns[1]])
        options = dict([*reader.options.items()][:1])
        if fitting:
            values = reader.values(reader.read(path, **options))
            np.testing.assert_allclose(values, reader.wanted, rtol=1e-12, err_msg=word)
        else:
            with pytest.raises(ValueError, match=f"{word!r}|dt is missing"):
                reader.read(path, **options)


@pytest.mark.parametrize("name", READERS)
def test_the_order_of_columns_changes_nothing(name, tmp_path):
    reader = READERS[name]
    titles, columns = [*reader.titles, *UNLIKE], [*reader.columns, *UNLIKE.values()]
    rotated = [np.roll(range(len(titles)), shift) for shift in range(len(titles))]
    for order in [*rotated, *(each[::-1] for each in rotated)]:
        path = written(tmp_path, [titles[n] for n in order], [columns[n] for n in order])
        np.testing.assert_allclose(reader.values(reader.read(path)), reader.wanted, rtol=1e-12)


def test_decimal_commas_between_commas_are_refused(tmp_path):
    (tmp_path / "site.csv").write_text("T,Sa [g]\n0,1,0,3\n0,2,0,6\n0,5,0,75\n1,0,0,75\n2,0,0,38\n")
    with pytest.raises(ValueError, match=r"beyond the 2 columns above; allowed: .* or ';' between"):
        sl.read_spectrum(tmp_path / "site.csv", elastic=True)


@pytest.mark.parametrize("index", ["", "Unnamed: 0", "No"])
@pytest.mark.parametrize("start", [0, 1])
@pytest.mark.parametrize("name", READERS)
def test_an_index_changes_nothing(name, index, start, tmp_path):
    reader = READERS[name]
    numbers = np.arange(start, start + len(reader.columns[0]))
    path = written(tmp_path, [index, *reader.titles], [numbers, *reader.columns])
    np.testing.assert_allclose(reader.values(reader.read(path)), reader.wanted, rtol=1e-12)
    twice = written(tmp_path, ["", index, *reader.titles], [numbers, numbers, *reader.columns])
    np.testing.assert_allclose(reader.values(reader.read(twice)), reader.wanted, rtol=1e-12)


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("form", ["{} [{}]", "{} ({})", "{}({})", "{}_{}", "{}, {}", "{}/{}"])
def test_every_unit_in_a_title_gives_the_same(name, form, tmp_path):
    reader = READERS[name]
    words = [title.partition(" [")[0] for title in reader.titles]
    units = [title.partition("[")[2].rstrip("]") for title in reader.titles]
    known = {
        (of, side): size for of in UNITS for side in (0, 1) if (size := size_of(units[side], of))
    }
    for (of, side), size in known.items():
        for unit in UNITS[of]:
            titles, columns = [*reader.titles], [*reader.columns]
            titles[side] = form.format(words[side], unit)
            columns[side] = columns[side] * size / size_of(unit, of)
            path = written(tmp_path, titles, columns)
            values = reader.values(reader.read(path))
            np.testing.assert_allclose(values, reader.wanted, rtol=1e-12, err_msg=titles[side])


@pytest.mark.parametrize("name", READERS)
def test_columns_are_counted_from_1(name, tmp_path):
    """Without titles they are asked for, with an example that is read."""
    reader = READERS[name]
    path = written(tmp_path, ["", ""], reader.columns)
    numbers = dict(zip(reader.names, (1, 2), strict=True))
    read = reader.read(path, **numbers, **reader.options)
    np.testing.assert_allclose(reader.values(read), reader.wanted, rtol=1e-12)
    if hasattr(read, "attrs"):
        assert "column 1 (" in read.attrs["columns"]
        assert "column 2 (" in read.attrs["columns"]
    for argument in reader.names:
        with pytest.raises(
            ValueError, match=f"{argument} = 0 is no column; .* columns are counted from 1"
        ):
            reader.read(path, **{**numbers, argument: 0}, **reader.options)
    if name != "record":  # in which equal steps are those of a time
        with pytest.raises(ValueError, match=r"give .*= .*, as \w+=1, \w+=2"):
            reader.read(path, **reader.options)


# --- What is read besides ---


def test_what_follows_from_another_quantity_is_converted_and_said(tmp_path):
    omega = 2 * np.pi / T
    files = {
        ("log10T", "Sa [g]"): (np.log10(T), SA),
        ("ln(T)", "Sa [g]"): (np.log(T), SA),
        ("log10(freq) [Hz]", "ln(Sa) [g]"): (-np.log10(T), np.log(SA)),
        ("Sa_g", "Freq (rad/s)"): (SA, omega),
        ("T (s)", "PSV [cm/s]"): (T, 100 * G * SA / omega),
        ("Periyot (sn)", "SD [mm]"): (T, 1000 * G * SA / omega**2),
        ("T", "SD [cm]", "PSV [cm/s]", "PSA [%g]"): (T, 0 * T, 0 * T, 100 * SA),
    }
    for titles, columns in files.items():
        read = read_elastic(written(tmp_path, titles, columns))
        np.testing.assert_allclose(both(read), [T, G * SA], rtol=1e-9)
        assert ("converted" in read.attrs.get("columns", "")) == (len(titles) == 2)


MEASURES = {
    "Sa (2%) [g]": "damping ratio of 0.02; give damping=0.02",
    "Sa quantile-0.84 [g]": "",
    "SA(0.5) [g]": "",
    "Sa ratio": "",
    "PGA [g]": "is a peak ground acceleration; allowed: a spectral acceleration",
    "vel [g]": "is in a unit of another quantity",
    "log Sa [g]": "is a logarithm; allowed",
}


@pytest.mark.parametrize("title", MEASURES)
def test_another_measure_is_not_taken_by_itself(title, tmp_path):
    """Neither where it is the only other column; asked for, it is read if its title allows that."""
    path = written(tmp_path, ["T (s)", title], [T, SA])
    with pytest.raises(
        ValueError, match=r"the table has 2 columns, 1 'T .s.': a period"
    ) as refused:
        read_elastic(path, units="g")
    assert repr(title) in str(refused.value)
    if MEASURES[title]:
        with pytest.raises(ValueError, match=MEASURES[title]):
            read_elastic(path, column=2)
    else:
        np.testing.assert_allclose(read_elastic(path, column=title, units="g"), G * SA)


def test_the_measure_of_a_hazard_is_the_one_of_its_title(tmp_path):
    path = written(tmp_path, ["SA(0.5) [g]", "SA(1.0) [g]", "AFE"], [LEVELS, LEVELS / 2, RATES])
    for period, size in ((0.5, 1.0), (1.0, 0.5)):
        read = sl.read_hazard(path, "sa", period=period)
        np.testing.assert_allclose(read.intensities, G * size * LEVELS)
    with pytest.raises(ValueError, match=r"column = 1 is that of 0.5 s; allowed: that of 2 s"):
        sl.read_hazard(path, "sa", period=2.0, column=1)
    poe = written(tmp_path, ["iml [g]", "poe [%]"], [LEVELS, -100 * np.expm1(-50 * RATES)])
    read = sl.read_hazard(poe, investigation_time=50.0)
    np.testing.assert_allclose(read.frequencies, RATES, rtol=1e-9)


ETABS = """TABLE:  Functions - Response Spectrum - User Defined
Name,Period,Value,Damping
,sec,,
"""


def test_a_function_of_etabs_is_read(tmp_path):
    rows = [
        f"Site,{t},{a},{'0.05' if n == 0 else ''}"
        for n, (t, a) in enumerate(zip(T, SA, strict=True))
    ]
    path = tmp_path / "a.csv"
    path.write_text(ETABS + "\n".join(rows), encoding="utf-8")
    np.testing.assert_allclose(both(read_elastic(path, units="g")), [T, G * SA])
    with pytest.raises(
        ValueError, match=r"line 4: the damping ratio is 0.05, which damping = 0.02"
    ):
        read_elastic(path, units="g", damping=0.02)
    path.write_text(ETABS + "\n".join([*rows, *(row.replace("Site", "B") for row in rows)]))
    with pytest.raises(ValueError, match="a second spectrum, 'B' beside 'Site'"):
        read_elastic(path, units="g")


def test_a_uniform_hazard_spectrum_of_openquake_is_that_of_its_site(tmp_path):
    titles = [
        f"{p}~{of}" for p in (0.1, 0.02) for of in ("PGA", *(f"SA({t})" for t in (0.2, 0.5, 1.0)))
    ]
    sites = {(-70.6, -33.4): 1.0, (-70.0, -33.0): 0.5}
    values = np.array([0.4, 0.9, 0.8, 0.4, 0.8, 1.8, 1.6, 0.8])
    rows = ["#,,,\"kind='mean', investigation_time=50.0\"", ",".join(["lon", "lat", *titles])]
    rows += [",".join(map(str, [*place, *(size * values)])) for place, size in sites.items()]
    path = tmp_path / "a.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    read = read_elastic(path, site=(-70.0, -33.0), column="0.02", between="linear")
    np.testing.assert_allclose(read.sel(period=[0, 0.2, 0.5, 1]), G * 0.5 * values[4:])
    assert "probability 0.02" in read.attrs["comment"]
    with pytest.raises(ValueError, match=r"probabilities 0.1, 0.02, and column is missing"):
        read_elastic(path, site=1)
    with pytest.raises(ValueError, match=r"site is missing: .* has 1 .-70.6, -33.4., 2"):
        read_elastic(path, column="0.1")


@pytest.mark.parametrize("head", ["", "El Centro\n", "time [s] acc [g]\n"])
def test_count_and_step_above_columns_are_no_sample(head, tmp_path):
    rows = [f"{t:.2f} {a:.6f}" for t, a in zip(TIMES, WAVE, strict=True)]
    path = tmp_path / "a.txt"
    path.write_text(f"{head}24 0.02\n" + "\n".join(rows), encoding="utf-8")
    read = sl.read_record(path, units="g")
    np.testing.assert_allclose(read, G * WAVE, atol=1e-5)
    np.testing.assert_allclose(read.time, TIMES, atol=1e-12)
    with pytest.raises(ValueError, match="contradicts"):
        sl.read_record(path, units="g", dt=0.01)


def test_components_may_be_named_by_a_letter(tmp_path):
    """Which is no unit, such as N, S and T."""
    for letter in "NSEWZTVHXYRL":
        path = written(tmp_path, ["time", letter, "other"], [TIMES, WAVE, 2 * WAVE])
        with pytest.warns(match="is vertical") if letter in "ZV" else nullcontext():
            record = sl.read_record(path, column=letter, units="g")
        np.testing.assert_allclose(record, G * WAVE)


@pytest.mark.parametrize("form", ["2020-01-31T23:59:{:06.3f}", "2020-01-31 23:59:{:06.3f}Z"])
def test_dates_are_seconds_from_the_first(form, tmp_path):
    path = written(tmp_path, ["Date", "acc [g]"], [[form.format(50 + t) for t in TIMES], WAVE])
    np.testing.assert_allclose(both(sl.read_record(path)), [TIMES, G * WAVE], atol=1e-12)
    path.write_text(path.read_text().replace(":50.1", ":5x.1"))
    with pytest.raises(
        ValueError, match=r"line 7, column 1: .* is no date with a time; allowed: as 2020-"
    ):
        sl.read_record(path)


def test_a_time_step_that_the_time_contradicts_is_refused(tmp_path):
    path = written(tmp_path, ["time", "acc [g]"], [TIMES, WAVE])
    np.testing.assert_allclose(sl.read_record(path, dt=0.02), G * WAVE)
    with pytest.raises(ValueError, match=r"dt = 0.01 contradicts the time, whose step is 0.02 s"):
        sl.read_record(path, dt=0.01)
    coarse = written(tmp_path, ["time", "acc [g]"], [np.floor(20 * TIMES) / 20, WAVE])
    with pytest.raises(ValueError, match=r"csv: time does not increase"):
        sl.read_record(coarse)


CASE = """[site]
{}
[motion]
duration = "12 s"
[building_1]
period = "1.0 s"
damping = 0.05
elastic = true
[building_2]
period = "0.6 s"
damping = 0.05
elastic = true
[separation]
confidence = "90 %"
"""
OF_CASE = {
    "spectrum": (
        'spectrum = "a.csv"\nelastic = true\nunits = "g"\nperiod_column = {}\ncolumn = 2',
        lambda case: both(case.site.spectrum),
    ),
    "record": (
        'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'
        '[[site.records]]\npath = "a.csv"\nunits = "g"\n'
        "time_column = {}\ncolumn = 2",
        lambda case: both(case.site.records["a.csv"]),
    ),
    "hazard": (
        'ground = "firm"\nintensity = "0.01 m^2/s^3"\n'
        '[site.hazard]\nmeasure = "pga"\nfile = "a.csv"\n'
        'units = "g"\nfrequency_column = {}\ncolumn = 2',
        lambda case: READERS["hazard"].values(case.site.hazard),
    ),
}


@pytest.mark.parametrize("name", OF_CASE)
def test_a_case_file_counts_columns_from_1(name, tmp_path):
    site, values = OF_CASE[name]
    written(tmp_path, ["", ""], READERS[name].columns)
    case = read_text(tmp_path, CASE.format(site.format(1)))
    np.testing.assert_allclose(values(case), READERS[name].wanted, rtol=1e-12)
    with pytest.raises(
        ValueError, match=r"_column = 0 is no column; .* columns are counted from 1"
    ):
        read_text(tmp_path, CASE.format(site.format(0)))


@pytest.mark.parametrize("form", ["{:.2f}", "{:.3e}", "{:.2E}"])
def test_decimal_commas_may_have_an_exponent(form, tmp_path):
    path = tmp_path / "a.csv"
    rows = [
        f"{form.format(t)};{form.format(a)}".replace(".", ",") for t, a in zip(T, SA, strict=True)
    ]
    path.write_text("\n".join(["T [s];Sa [g]", *rows]), encoding="utf-8")
    spectrum = sl.read_spectrum(path, elastic=True)
    wanted = [float(form.format(a)) for a in SA]
    np.testing.assert_allclose(spectrum / G, wanted, rtol=1e-12)


@pytest.mark.parametrize(
    ("title", "says"),
    [
        ("Sa/R [g]", "not as it stands, since it says '/R'"),
        ("Sd(T) [g]", "not as it stands, since it says 'Sd(T) [g]'"),
        ("Sa 2% [g]", "damping 0.02"),
    ],
)
def test_why_a_column_is_not_taken_is_said(tmp_path, title, says):
    (tmp_path / "site.csv").write_text(f"T,{title}\n0,0.3\n0.1,0.6\n0.3,0.6\n1,0.2\n2,0.1\n")
    with pytest.raises(ValueError, match=re.escape(says)):
        sl.read_spectrum(tmp_path / "site.csv", elastic=True)


def test_points_side_by_side_are_named(tmp_path):
    rows = (["T", *np.linspace(0, 3, 16)], ["Sa [g]", *np.full(16, 0.3)])
    text = "\n".join(",".join(map(str, row)) for row in rows)
    (tmp_path / "site.csv").write_text(text)
    with pytest.raises(ValueError, match="are its points side by side"):
        sl.read_spectrum(tmp_path / "site.csv", elastic=True)
