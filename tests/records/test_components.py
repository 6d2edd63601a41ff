"""Components by the names of files: which are vertical, and which files are of one record."""

from itertools import product

import pytest
from samples import VERTICAL

from stochlin.applications.records.components import FileNames, identifies, is_vertical

pytestmark = pytest.mark.invariant

# Words of both horizontal components of a record.
LEVEL = [
    *(
        ("N", "E"),
        ("NS", "EW"),
        ("N-S", "E-W"),
        ("NS2", "EW2"),
        ("north", "east"),
        ("S75E", "N15E"),
    ),
    *(
        ("000", "090"),
        ("360", "270"),
        ("HNE", "HNN"),
        ("BH100", "BH200"),
        ("HN1", "HN2"),
        ("H1", "H2"),
    ),
    *(("T", "R"), ("L", "T"), ("X", "Y"), ("long", "tran"), ("N00E", "N90E")),
    *(("FN", "FP"), ("comp1", "comp2"), ("hor1", "hor2")),
]
SEPARATORS = (".", "-", "_", "--", "..", " ")
# Where a component stands in the name of a file: last, before or after other parts, or first.
PLACED = (
    "{quake}{s}{word}.csv",
    "{quake}{s}{word}{s}acc.txt.gz",
    "{word}{s}{quake}.AT2",
    "a/{quake}{s}{word}.dat",
)
STATIONS = ("V1", "ZUR", "U", "UZ1", "LVD", "UP", "HNZ", "Z2", "UD", "RSN12", "ABC")


def in_each_case(words):
    return dict.fromkeys(form(word) for word in words for form in (str, str.upper, str.lower))


@pytest.mark.parametrize("word", in_each_case(VERTICAL))
def test_a_vertical_word_is_so_in_any_place(word):
    for place, s in product(PLACED, SEPARATORS):
        name = place.format(quake="RSN12", s=s, word=word)
        found = FileNames([name]).component(name)
        assert found is not None, name
        assert found.vertical, name
    assert is_vertical(word, "", None)
    assert is_vertical("", f"El Centro, {word}", None)


@pytest.mark.parametrize("station", STATIONS)
@pytest.mark.parametrize("pair", LEVEL)
def test_horizontal_components_stay_and_are_of_one_record(pair, station):
    """Whatever the station is called, before or behind the component, and in any case."""
    forms = "{station}{s}{word}.csv", "{word}{s}{station}.csv", "x{s}{station}{s}{word}{s}acc.csv"
    for form, s, up in product(forms, SEPARATORS, ("UD", "VRT")):
        stations = {station, "RSN7"}
        words = [word.lower() if s == "_" else word for word in (*pair, up)]
        files = {at: [form.format(s=s, word=word, station=at) for word in words] for at in stations}
        names = FileNames(name for of in files.values() for name in of)
        for of in files.values():
            first, second, vertical = of
            assert not names.component(first).vertical, first
            assert not names.component(second).vertical, second
            assert names.component(vertical).vertical, vertical
            assert names.record(first) == names.record(second)
        assert len({names.record(first) for first, *_ in files.values()}) == 2


@pytest.mark.parametrize(
    "names",
    [
        ["quake_1.csv", "quake_2.csv"],
        ["rec_000.csv", "rec_045.csv", "rec_090.csv"],
        ["120111.txt", "120112.txt"],
        ["a_N.csv", "b_E.csv"],
        ["a_N.csv", "a_S.csv"],
        ["2019-090/a.csv", "2019-180/a.csv"],
        ["CE1.V2", "CE1.V1"],
    ],
)
def test_other_names_are_of_records_of_their_own(names):
    together = FileNames(names)
    assert len({together.record(name) for name in names}) == len(names)
    assert not any(word and word.vertical for word in map(together.component, names))


def test_what_is_stated_goes_before_the_title_and_that_before_the_name():
    up, level = (FileNames([name]).component(name) for name in ("a_UP.csv", "a_090.csv"))
    assert not is_vertical("340 deg", "Up", up)
    assert is_vertical("Up", "", level)
    assert is_vertical("Other", "UD (gal)", level)
    assert is_vertical("Other", "acc [g]", up)
    assert not is_vertical("", "read by V. Miller", None)
    assert not is_vertical("?", "", level)


@pytest.mark.parametrize("event", ["GREECE", "", "Southern Italy, M 5.9", "Mw=6.1, Norcia"])
def test_a_region_identifies_no_earthquake(event):
    assert not identifies(event)
    for more in ("1/16/1995", "nc71126864", "2006/01/18 23:25:00", "-02"):
        assert identifies(f"{event} {more}")
