"""Suites of records: read, scaled, written, and asked for gaps."""

import warnings
from itertools import product

import numpy as np
import pytest
import samples
import scipy.stats
from motions import write_at2

import stochlin as sl

pytestmark = [
    pytest.mark.filterwarnings("ignore:.* are the same motion"),  # of files with the same wave
    pytest.mark.filterwarnings("ignore:.* are of one earthquake and station; is one"),
]

G = 9.80665
MOTIONS = sl.simulated_motions(
    sl.named_ground("firm", 0.01), 15.0, sl.AminAng(2.0, 11.0, 2.0), paths=3, seed=8
)
SUITE = dict(zip("abc", MOTIONS, strict=True))


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
    (folder / "readme.txt").write_text(
        "These are records.\nThey are not corrected.\n", encoding="utf-8"
    )
    with pytest.warns(UserWarning, match=r"readme\.txt is left out: no record can be seen"):
        suite = sl.read_records(folder)
    assert list(suite) == ["more/two.at2", "one.AT2"]
    np.testing.assert_allclose(suite["one.AT2"], MOTIONS[0], atol=1e-6)


def test_a_table_says_of_each_file_what_it_is(folder):
    columns(folder / "timed.txt", MOTIONS[2], with_time=True)
    columns(folder / "plain.txt", MOTIONS[2], with_time=False)
    table = folder / "suite.csv"
    table.write_text(
        'file,event,station,dt,units\none.AT2,Duzce,Bolu,,\ntimed.txt,second,,0.01,"t s, g"\n'
        "plain.txt,third,,0.01,g; as it came\n",
        encoding="utf-8",
    )
    suite = sl.read_records(table)
    assert list(suite) == ["one.AT2", "timed.txt", "plain.txt"]
    np.testing.assert_allclose(suite["timed.txt"], suite["plain.txt"], rtol=1e-12)
    about = suite["one.AT2"].attrs
    assert (about["event"], about["station"], about["file"]) == ("Duzce", "Bolu", "one.AT2")
    assert "component" not in about


WAVE = np.round(100 * np.sin(np.arange(40) / 3), 4)
PEER = """
-- Summary of PEER Ground Motion Database Search Criteria --
 -- Summary of Metadata of Selected Records --
 Result ID, Scale Factor, Earthquake Name, Year, Station Name, Horizontal-1 Acc. Filename,\
 Horizontal-2 Acc. Filename, Vertical Acc. Filename
1,   1.25, "Imperial Valley-02", 1940, "El Centro Array #9", RSN6_180.AT2, RSN6_270.AT2, RSN6_UP.AT2
2,   0.50, "Northridge", 1994, "Place, here", RSN7_000.AT2, RSN7_090.AT2, -----

 -- Scaled Spectra used in Search & Scaling --
 Period (sec), RSN-6 Horizontal-1 pSa (g)
0.01, 0.1
""".replace("\\\n", "")


def knet(direction):
    return samples.knet(np.round(1e4 * WAVE)).replace("N-S", direction)


def at2(title="made"):
    head = f"PEER STRONG MOTION\n{title}\nUNITS OF G\nNPTS= 40, DT= .01 SEC\n"
    return head + "\n".join(f"{value / 1000:.6f}" for value in WAVE)


KIK_NET = ("NS1", "EW1", "UD1", "NS2", "EW2", "UD2")
CHANNELS = {"90 Deg": WAVE, "Up": 0.5 * WAVE, "360 Deg": 2 * WAVE}
# Files of a folder, and those that are read: without vertical components and those in a borehole.
DELIVERED = {
    "K-NET": ({"A.NS": knet("N-S"), "A.EW": knet("E-W"), "A.UD": knet("U-D")}, ["A.EW", "A.NS"]),
    "KiK-net": ({f"A.{end}": knet(f"{n}") for n, end in enumerate(KIK_NET, 1)}, ["A.EW2", "A.NS2"]),
    "ESM": (
        {f"{c}.asc": samples.esm(WAVE).replace("HNE", c) for c in ("HNE", "HNZ", "HGZ")},
        ["HNE.asc"],
    ),
    "PEER": ({"a.at2": at2("K, 1/1/1995, X, 090"), "b.at2": at2("K, 1/1/1995, X, UP")}, ["a.at2"]),
    "PEER, by name": (
        {"RSN6_I-ELC180.AT2": at2(), "RSN6_I-ELC-UP.AT2": at2()},
        ["RSN6_I-ELC180.AT2"],
    ),
    "DWN, by name": ({"kobe-000.at2": at2(), "kobe-dwn.at2": at2()}, ["kobe-000.at2"]),
    "CSMIP": ({"a.v2": samples.csmip(CHANNELS)}, ["a.v2, 90 Deg", "a.v2, 360 Deg"]),
    "COSMOS": ({"a.v2c": samples.cosmos(CHANNELS)}, ["a.v2c, 90 Deg", "a.v2c, 360 Deg"]),
    "UNAM": ({"A.191": samples.unam([WAVE] * 3)}, ["A.191, N00E", "A.191, N90E"]),
    "PEER's table": (
        {
            **dict.fromkeys(
                ("RSN6_180.AT2", "RSN6_270.AT2", "RSN6_UP.AT2", "RSN7_000.AT2", "RSN7_090.AT2"),
                at2(),
            )
        }
        | {"_SearchResults.csv": PEER},
        ["RSN6_180.AT2", "RSN6_270.AT2", "RSN7_000.AT2", "RSN7_090.AT2"],
    ),
}


@pytest.mark.parametrize("case", DELIVERED)
def test_suites_are_horizontal(tmp_path, case):
    files, wanted = DELIVERED[case]
    for name, text in files.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    if case == "PEER's table":
        suite = sl.read_records(tmp_path)
        about = suite["RSN7_090.AT2"].attrs
        assert (about["event"], about["station"]) == ("Northridge, 1994", "Place, here")
        assert [record.attrs["scale_factor"] for record in suite.values()] == [1.25, 1.25, 0.5, 0.5]
    else:
        with pytest.warns(UserWarning, match=r"left out: vertical or in a borehole; read_record"):
            suite = sl.read_records(tmp_path)
    assert sorted(suite) == sorted(wanted)


OTHER = samples.cosmos({"Other": WAVE})
# Files that state their component: their ending, and the text with a component.
STATING = {
    "K-NET": ("dat", knet),
    "ESM": ("asc", lambda word: samples.esm(WAVE).replace("HNE", word)),
    "PEER": ("at2", lambda word: at2(f"K, 1/1/1995, X, {word}")),
    "PEER, by its title": ("at2", lambda word: at2(f"El Centro, {word}")),
    "CSMIP": ("v2", lambda word: samples.csmip({word: WAVE})),
    "COSMOS": ("v2c", lambda word: samples.cosmos({word: WAVE})),
    "COSMOS, by its channel": (
        "v2c",
        lambda word: OTHER.replace("| Sensor", f"|<SCNL>A.{word}.C"),
    ),
    "UNAM": ("191", lambda word: samples.unam([WAVE], f"/{word}")),
    "a column": ("csv", lambda word: f"{word} [g]\n" + "\n".join(map(str, WAVE / 1000))),
}
# Files that do not.
SILENT = {
    "PEER": ("at2", at2()),
    "COSMOS": ("v2c", OTHER),
    "columns": ("csv", "acc [g]\n" + "\n".join(map(str, WAVE / 1000))),
}


def read_horizontal(folder, texts):
    """Names of the records of a suite of these texts by name, with a warning on the others."""
    for name, text in texts.items():
        (folder / name).write_text(text, encoding="utf-8")
    with pytest.warns(UserWarning, match=r"left out: vertical or in a borehole; read_record"):
        return list(
            sl.read_records(folder, dt=0.01 if any(".csv" in name for name in texts) else None)
        )


@pytest.mark.invariant
@pytest.mark.parametrize("case", STATING)
def test_vertical_is_what_a_file_states(tmp_path, case):
    ending, text = STATING[case]
    words = [word for word in samples.VERTICAL if "channel" not in case or word.isalnum()]
    files = {f"{n:02}.{ending}": text(word) for n, word in enumerate(words)}
    files[f"horizontal.{ending}"] = text("HNE")
    assert read_horizontal(tmp_path, files) == [f"horizontal.{ending}"]


@pytest.mark.invariant
@pytest.mark.parametrize("case", SILENT)
def test_vertical_is_what_the_name_of_a_file_says(tmp_path, case):
    ending, text = SILENT[case]
    names = [f"RSN{n}_{word}.{ending}" for n, word in enumerate(samples.VERTICAL)]
    names += [f"{word}.RSN{n}.acc.{ending}" for n, word in enumerate(samples.VERTICAL)]
    level = [f"V1-U-000.{ending}", f"V1-U-090.{ending}", f"ZUR_S75E.{ending}"]
    assert read_horizontal(tmp_path, dict.fromkeys([*names, *level], text)) == level


@pytest.mark.invariant
def test_a_contradiction_is_said(tmp_path):
    (tmp_path / "RSN1_UP.at2").write_text(at2("K, 1/1/1995, X, 090"), encoding="utf-8")
    with pytest.warns(
        UserWarning, match=r"RSN1_UP\.at2: another direction in the name of the file than"
    ):
        assert list(sl.read_records(tmp_path)) == ["RSN1_UP.at2"]


@pytest.mark.invariant
@pytest.mark.filterwarnings("ignore:.*left out")
def test_a_folder_of_vertical_records_is_read_with_a_component(tmp_path):
    (tmp_path / "RSN1_UP.at2").write_text(at2(), encoding="utf-8")
    with pytest.raises(
        ValueError, match="holds vertical ones alone, which component= reads; allowed: one"
    ):
        sl.read_records(tmp_path)
    with pytest.warns(sl.DoubtfulInput, match="'UP' is vertical"):
        assert list(sl.read_records(tmp_path, component="UP")) == ["RSN1_UP.at2"]


def csmip_at_station(component):
    return samples.csmip({component: WAVE}).replace("Uncorrected", "Station No. 23287\nUncorrected")


# Texts with a component in an earthquake of this number, at the same station.
OF_QUAKES = {
    "K-NET": ("ns", lambda c, n: knet(("N-S", "E-W")[c]).replace("18 23:25:00", f"18 23:2{n}:00")),
    "ESM": (
        "asc",
        lambda c, n: samples.esm(WAVE).replace("HNE", f"HN{c + 1}").replace("0000106", f"{n}"),
    ),
    "ESM, by its date": (
        "asc",
        lambda c, n: (
            samples.esm(WAVE)
            .replace("HNE", f"HN{c + 1}")
            .replace("EVENT_ID: EMSC-20190728_0000106", "EVENT_DATE_YYYYMMDD: 20190728")
            .replace("23:08", f"23:0{n}")
        ),
    ),
    "PEER": ("at2", lambda c, n: at2(f"GREECE, 1/{n}/1995, X, {90 * c:03}")),
    "CSMIP": (
        "v2",
        lambda c, n: csmip_at_station(f"{90 * c} Deg").replace("1548167", f"{n}548167"),
    ),
    "COSMOS": (
        "v2c",
        lambda c, n: samples.cosmos({f"{90 * c} deg": WAVE}).replace("13:53", f"13:5{n}"),
    ),
    "UNAM": (
        "191",
        lambda c, n: samples.unam([WAVE], f"/N{90 * c:02}E").replace("18:14", f"18:1{n}"),
    ),
}


@pytest.mark.invariant
@pytest.mark.parametrize("case", OF_QUAKES)
def test_components_share_the_event_of_one_earthquake_alone(tmp_path, case):
    """The files have names that say nothing."""
    ending, text = OF_QUAKES[case]
    for n in range(4):
        (tmp_path / f"f{n}.{ending}").write_text(text(n % 2, 1 + n // 2), encoding="utf-8")
    records = list(sl.read_records(tmp_path).values())
    events = [record.attrs["event"] for record in records]
    assert events[0] == events[1] != events[2] == events[3]
    if "station" in records[0].attrs:
        assert len({record.attrs["station"] for record in records}) == 1
    with pytest.raises(
        ValueError, match=f"have the events '{events[1][:20]}.* and '{events[2][:20]}"
    ):
        sl.fit_motion(records[1:3])


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("lines", "event"),
    [
        ("(Origin:  To be determined)", "15481673.CI.WLT"),
        ("(Origin(CIT): 01/17/94, 12:30:55.4 UTC)", "01/17/94, 12:30:55.4"),
        ("Origin: 08/24/2014, 10:20:44.0 UTC (NCSN)", "08/24/2014, 10:20:44.0"),
        (
            "Rcrd of Tue Dec 20, 2022 02:34:01.0 PST    (Avol1 v2.0, 4/18)",
            "Rcrd of Tue Dec 20, 2022 02:34:01.0 PST",
        ),
        ("Record of Mon Jan 17, 1994 04:31 PST", "Record of Mon Jan 17, 1994 04:31 PST"),
        ("X      Start time: 12/20/22, 10:34: 1.0 UTC (GPS)", "12/20/22, 10:34: 1.0"),
        ("Processed: Dec 20, 2022 10:34 CGS", "15481673.CI.WLT"),
    ],
)
def test_headers_of_networks_name_the_earthquake(tmp_path, lines, event):
    text = samples.csmip({"H1": WAVE}).replace(
        "Uncorrected", f"{lines}\nStation No. 89486   40.5N\nUn", 1
    )
    (tmp_path / "a.v2").write_text(text, encoding="utf-8")
    about = sl.read_record(tmp_path / "a.v2").attrs
    assert (about["event"], about["station"]) == (event, "89486")


NAMINGS = ("RSN{n}_{c}.AT2", "{c}-q{n}.at2", "q{n}.{c}.acc.AT2", "U_{n}_{c}.AT2", "{n}/{c}.at2")
LETTERS = ("N", "E", "V")
COMPONENTS = (LETTERS, ("NS", "EW", "UD"), ("H1", "H2", "Up"), ("360", "270", "Z00"))
NAMED = [*product(NAMINGS, COMPONENTS), ("TCU{n}05{c}.AT2", LETTERS), ("{c}/r{n}.at2", LETTERS)]


@pytest.mark.invariant
@pytest.mark.parametrize(("naming", "components"), NAMED)
def test_the_gap_does_not_depend_on_how_files_are_named(tmp_path, naming, components):
    pair = sl.Bilinear(0.5, 0.05), sl.Bilinear(1.0, 0.05)
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 3.0, paths=18, seed=3)
    stated = {}
    for k, record in enumerate(motions):
        if k % 3 < 2:
            stated[f"{k}"] = record.assign_attrs(event=f"quake {k // 3}", station="s")
        path = tmp_path / naming.format(n=k // 3, c=components[k % 3])
        path.parent.mkdir(exist_ok=True)
        write_at2(record, path)
    with pytest.warns(UserWarning, match="left out: vertical"):
        suite = sl.read_records(tmp_path)
    names = sorted(suite, key=hash)
    shuffled = {name: suite[name] for name in names}
    bare = {name: suite[name].drop_attrs().assign_attrs(units="m/s^2") for name in names}
    wanted = sl.recorded_gap(*pair, stated)
    for records in (suite, shuffled, bare):
        table = sl.recorded_gap(*pair, records)
        for end in ("", "_lower", "_upper"):
            name = f"separation_quantile{end}"
            np.testing.assert_allclose(table[name], wanted[name], rtol=1e-5)


@pytest.mark.invariant
def test_records_that_may_belong_together_are_asked_about(tmp_path):
    for name in "ab":
        text = samples.esm(WAVE).replace(
            "EVENT_ID: EMSC-20190728_0000106\nEVENT_TIME_HHMMSS: 23:08:25.75\n", ""
        )
        (tmp_path / f"{name}.asc").write_text(text, encoding="utf-8")
    with pytest.warns(
        UserWarning, match=r"a\.asc, b\.asc state the station 'ARS1' and no event: each counts"
    ):
        suite = sl.read_records(tmp_path)
    assert all("event" not in record.attrs for record in suite.values())
    (tmp_path / "suite.csv").write_text(
        "file,event,station\na.asc,GREECE,X\nb.asc,GREECE,X\n", encoding="utf-8"
    )
    assert {r.attrs["event"] for r in sl.read_records(tmp_path / "suite.csv").values()} == {
        "GREECE"
    }


def test_components_of_a_station_are_one_event():
    """The interval over 24 records of 12 events is that of 12, around the quantile of all."""
    one, two = sl.Bilinear(0.5, 0.05), sl.Bilinear(1.0, 0.05)
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 8.0, paths=24, seed=3)
    place = [{"event": f"e{n // 2}", "station": "s"} for n in range(24)]
    pairs = {f"{n}": m.assign_attrs(place[n]) for n, m in enumerate(motions)}
    table = sl.recorded_gap(one, two, pairs)
    alone = sl.recorded_gap(one, two, {name: m.assign_attrs(event="") for name, m in pairs.items()})
    gaps = table.separation.values.reshape(12, 2)
    low, high = (scipy.stats.binom.ppf(tail, 12, 0.5) for tail in (0.025, 0.975))
    ends = np.sort(gaps.min(axis=1))[int(low) - 1], np.sort(gaps.max(axis=1))[int(high)]
    found = [float(table[f"separation_quantile{end}"][0]) for end in ("_lower", "", "_upper")]
    assert found == pytest.approx([ends[0], np.median(gaps), ends[1]])
    assert float(alone.separation_quantile_lower[0]) >= found[0]
    with pytest.raises(ValueError, match="2 is vertical or below; allowed: horizontal"):
        sl.fit_motion([motions[0], motions[1].assign_attrs(component="UP")])


@pytest.mark.invariant
@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("path\none.AT2", "has the columns path; allowed: with 'file'"),
        ("file\nnone.at2", "suite.csv, line 2, none.at2: .*there is no such file"),
        ("file\none.AT2\none.AT2", "line 3, one.AT2: it is listed twice"),
        ("file,dt\nplain.txt,soon", "line 2, plain.txt: dt = 'soon' is no number"),
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
def test_factors_in_a_table_are_said_not_to_be_applied(folder):
    columns(folder / "plain.txt", MOTIONS[2], with_time=False)
    (folder / "suite.csv").write_text("file,dt,units,scale\nplain.txt,0.01,g,2\n", encoding="utf-8")
    with pytest.warns(sl.DoubtfulInput, match="its column 'scale' is not applied; scale_records"):
        [record] = sl.read_records(folder / "suite.csv").values()
    np.testing.assert_allclose(record, sl.read_record(folder / "plain.txt", dt=0.01, units="g"))


@pytest.mark.invariant
def test_a_file_that_cannot_be_read_is_named(folder):
    (folder / "bad.txt").write_text("1\ntwo\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r"bad\.txt, line 2"):
        sl.read_records(folder, units="g", dt=0.01)


@pytest.mark.oracle
def test_scaled_to_a_peak_to_a_period_and_to_a_spectrum():
    peaks = [float(abs(r).max()) for r in sl.scale_records(SUITE, pga=2.5).values()]
    np.testing.assert_allclose(peaks, 2.5, rtol=1e-12)
    for record in sl.scale_records(SUITE, sa=4.0, period=0.7).values():
        found = sl.response_spectrum(record, [0.7], 0.05).pseudo_acceleration
        assert float(found[0]) == pytest.approx(4.0, rel=1e-9)
    target = sl.eurocode_8(0.25 * G, "B")
    usual = 0.2, 2.0  # s
    for band, options in ((usual, {}), ((0.3, 1.5), {"band": (0.3, 1.5)})):
        periods = np.geomspace(*band, 40)
        wanted = np.exp(np.interp(np.log(periods), np.log(target.period[1:]), np.log(target[1:])))
        for record in sl.scale_records(SUITE, spectrum=target, **options).values():
            found = sl.response_spectrum(record, periods, 0.05).pseudo_acceleration
            assert float(np.log(found / wanted).mean()) == pytest.approx(0, abs=1e-9)
            assert record.attrs["scale"] > 0


@pytest.mark.invariant
def test_a_factor_that_is_hardly_meant_is_asked_about():
    weak = 0.01 * SUITE["a"]
    with pytest.warns(UserWarning, match="a is scaled by"):
        sl.scale_records(
            {"a": weak.assign_attrs(SUITE["a"].attrs)}, pga=float(abs(SUITE["a"]).max())
        )


@pytest.mark.oracle
def test_quantiles_of_the_gap_over_a_suite():
    one, two = sl.Bilinear([0.5, 0.6], 0.05), sl.Bilinear(1.0, 0.05)
    table = sl.recorded_gap(one, two, SUITE)
    wanted = np.quantile(table.separation, table["quantile"], axis=0)
    np.testing.assert_allclose(table.separation_quantile, wanted)
    assert (table.separation_quantile_lower <= table.separation_quantile).all()
    assert (table.separation_quantile_upper >= table.separation_quantile).all()
    assert "separation_quantile" not in sl.recorded_gap(one, two, SUITE["a"])


@pytest.mark.invariant
def test_records_that_are_a_copy_or_of_one_earthquake_are_asked_about(tmp_path):
    """By their values, by how many a station has, and by their lengths; else nothing is asked."""
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 3.0, paths=6, seed=3)

    def asked(folder, names, event, length):
        (tmp_path / folder).mkdir()
        for k, name in enumerate(names):
            record = motions[event(k)][: 120 + length(k)]
            record.to_series().to_csv(tmp_path / folder / name)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            sl.read_records(tmp_path / folder, units="m/s^2")
        return " ".join(str(each.message) for each in caught)

    names = [f"q{n}{c}.csv" for n in "123" for c in "ab"]
    assert "are the same motion" in asked("copies", names, lambda k: k // 2, lambda k: 0)
    assert "q1a.csv, q1b.csv are equally long" in asked("pairs", names, int, lambda k: k // 2)
    assert not asked("alike", names, int, lambda k: 0)
    assert not asked("apart", names, int, lambda k: k)
    assert not asked("named", [f"q{n}h{k}.csv" for n in "123" for k in "12"], int, lambda k: k // 2)


@pytest.mark.invariant
def test_three_components_of_a_station_are_asked_about(tmp_path):
    motions = sl.simulated_motions(sl.named_ground("firm", 0.01), 3.0, paths=3, seed=3)
    for k, record in enumerate(motions):
        write_at2(record.assign_attrs(event="Quake 7", station="s"), tmp_path / f"r{k + 1}.at2")
    rows = "\n".join(f"r{k}.at2,Quake 7,s" for k in (1, 2, 3))
    (tmp_path / "suite.csv").write_text(f"file,event,station\n{rows}\n", encoding="utf-8")
    with pytest.warns(sl.DoubtfulInput, match="is one of them vertical"):
        sl.read_records(tmp_path / "suite.csv")
