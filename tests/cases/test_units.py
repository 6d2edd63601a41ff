"""Units: the case of letters never changes a size; a refusal says what was probably meant."""

import re
from itertools import product

import numpy as np
import pytest

import stochlin as sl
from stochlin.applications.cases.reading.kinds import WithUnit
from stochlin.models.parameters import Range
from stochlin.models.units import UNITS, likely_unit, parsed, size_of, stated_size

pytestmark = pytest.mark.invariant

# Exact spellings of all names of units, with their sizes in SI.
NAMES = {
    **{"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048},
    **{"kg": 1.0, "t": 1e3, "tonne": 1e3},
    **{
        "s": 1.0,
        "sec": 1.0,
        "secs": 1.0,
        "second": 1.0,
        "seconds": 1.0,
        "sn": 1.0,
        "ms": 1e-3,
        "msec": 1e-3,
    },
    **{"yr": 1.0, "years": 1.0, "a": 1.0, "g": 9.80665, "gal": 0.01, "%": 0.01},
    **{"N": 1.0, "kN": 1e3, "MN": 1e6, "kgf": 9.80665, "tonf": 9806.65, "ton": 9806.65},
    **{
        "lb": 4.4482216152605,
        "lbf": 4.4482216152605,
        "kip": 4448.2216152605,
        "kips": 4448.2216152605,
    },
    **{"seg": 1.0, "sek": 1.0, "mg": 9.80665e-3, "%g": 9.80665e-2},
    "psi": 6894.757293168361,
}


def cases(name):
    """All spellings of a name with capitals or small letters."""
    return {
        "".join(letters) for letters in product(*({each.lower(), each.upper()} for each in name))
    }


@pytest.mark.parametrize("name", NAMES)
def test_a_name_in_any_case_has_its_size_or_is_unknown(name):
    exact = parsed(name)
    assert exact[0] == pytest.approx(NAMES[name], rel=1e-14)
    sizes = {spelling: parsed(spelling) for spelling in cases(name)}
    assert {*sizes.values()} <= {exact, None}
    known = {spelling for spelling, size in sizes.items() if size}
    prefixed = {"mm": {"mm", "MM"}, "ms": {"ms"}, "msec": {"msec"}, "MN": {"MN"}, "mg": {"mg"}}
    assert known == prefixed.get(name, {*sizes})


@pytest.mark.parametrize(("quantity", "unit"), [(of, unit) for of in UNITS for unit in UNITS[of]])
def test_a_unit_in_any_case_has_its_size_or_is_unknown(quantity, unit):
    sizes = {size_of(spelling, quantity) for spelling in cases(unit)}
    assert sizes <= {size_of(unit, quantity), None}
    assert all(
        likely_unit(spelling, quantity) == f"did you mean {unit!r}? "
        for spelling in cases(unit)
        if size_of(spelling, quantity) is None and unit in {"ms", "MN", "mm"}
    )


@pytest.mark.parametrize(
    ("unit", "quantity", "size"),
    [
        *(("CM/SEC/SEC", "m/s^2", 0.01), ("MM/S/S", "m/s^2", 1e-3), ("mm/S**2", "m/s^2", 1e-3)),
        *(("cm/sec2", "m/s^2", 0.01), ("CM/S^2", "m/s^2", 0.01), ("M/S2", "m/s^2", 1.0)),
        *(("G", "m/s^2", 9.80665), ("GAL", "m/s^2", 0.01), ("Gal", "m/s^2", 0.01)),
        *(
            ("KN-M", "N m", 1e3),
            ("kN-s²/m", "kg", 1e3),
            ("KIP-SEC^2/IN", "kg", 4448.2216152605 / 0.0254),
        ),
        *(
            ("ton", "kg", 1e3),
            ("Tons", "kg", 1e3),
            ("% G", "m/s^2", 0.0980665),
            ("cm/sn2", "m/s^2", 0.01),
        ),
        *(("Ton-s2/m", "kg", 9806.65), ("SEC", "s", 1.0), ("Sec", "s", 1.0), ("FT", "m", 0.3048)),
        *(
            ("MM", "m", 1e-3),
            ("IN", "m", 0.0254),
            ("CM", "m", 0.01),
            ("M", "m", 1.0),
            ("Kip", "N", 4448.22),
        ),
        *(
            ("KN/M", "N/m", 1e3),
            ("MN/M", "N/m", 1e6),
            ("KN S/M", "N s/m", 1e3),
            ("MM/M", "1", 1e-3),
        ),
        *(("KG", "kg", 1.0), ("T", "kg", 1e3), ("KGF", "N", 9.80665), ("PSI", "N/m^2", 6894.757)),
    ],
)
def test_spellings_of_programs_are_read(unit, quantity, size):
    assert size_of(unit, quantity) == pytest.approx(size, rel=1e-5)


REFUSED = [
    *(("Ms", "s", "ms"), ("MS", "s", "ms"), ("mS", "s", "ms"), ("Msec", "s", "msec")),
    *(("mN", "N", "MN"), ("Mn", "N", "MN"), ("mn", "N", "MN"), ("mN/m", "N/m", "MN/m")),
    *(("mN s/m", "N s/m", "MN s/m"), ("mN-s/m", "N s/m", "MN-s/m"), ("Mm", "m", "mm")),
    *(
        ("mM/s^2", "m/s^2", "mm/s^2"),
        ("kN/Mm", "N/m", "kN/mm"),
        ("% %", "1", "%"),
        ("%/s", "1", "%"),
    ),
    *(("% s", "s", "s"), ("m %", "m", "m"), ("%2", "1", "%"), ("s Mm/S", "m", "s mm/S")),
]


@pytest.mark.parametrize(("unit", "quantity", "likely"), REFUSED)
def test_another_prefix_is_refused_with_the_likely_one(unit, quantity, likely):
    assert size_of(unit, quantity) is None
    assert size_of(likely, quantity) is not None
    with pytest.raises(ValueError, match="unknown unit") as caught:
        WithUnit(quantity, Range()).in_si(f"5 {unit}")
    assert f"did you mean {likely!r}? allowed: " in str(caught.value)


@pytest.mark.parametrize("unit", ["", "x", "kNm", "sekunde", "%%%", "x %", "\n"])
def test_no_unit_is_guessed_of_what_is_like_none(unit):
    assert likely_unit(unit, "s") == ""


def test_a_unit_of_a_caller_or_a_file_is_refused_with_the_likely_one():
    likely = "did you mean 'mm/s\\^2'\\? "
    with pytest.raises(ValueError, match=f"^units = 'Mm/s.2' is not a known unit; {likely}allowed"):
        stated_size("acceleration", "", "Mm/s^2", "a.txt")
    with pytest.raises(
        ValueError, match=f"^a.txt: 'Mm/s.2' is not a known .*; {likely}give units="
    ):
        stated_size("acceleration", "Mm/s^2", None, "a.txt")


def test_times_and_records_of_files_are_refused_with_the_likely_unit(tmp_path):
    wave = 0.1 * np.sin(np.arange(40))
    path = tmp_path / "wave.csv"
    rows = [f"{20 * n},{value:.5f}" for n, value in enumerate(wave)]
    path.write_text("\n".join(["t [Ms],acc [g]", *rows]), encoding="utf-8")
    with pytest.raises(ValueError, match="in 'Ms'; did you mean 'ms'\\? allowed: s, ms"):
        sl.read_record(path, time_column=1)
    for unit, read in (
        ("MSEC", True),
        ("msec", True),
        ("MS", True),
        ("Msec", False),
        ("Ms", False),
    ):
        values = "\n".join(f"{value:.5f}" for value in wave)
        path = tmp_path / "wave.at2"
        path.write_text(
            f"A\nB\nUNITS OF G\nNPTS= 40, DT= 20.0 {unit}\n{values}\n", encoding="utf-8"
        )
        if read:
            assert sl.read_record(path).attrs["dt"] == 0.02
        else:
            with pytest.raises(ValueError, match="the time step in SEC or MSEC"):
                sl.read_record(path)


@pytest.mark.parametrize("name", NAMES)
def test_no_product_of_units_is_too_large_or_small_for_a_number(name):
    """Whatever its powers and its length: it has a size, or it is unknown."""
    for power, times, over in product(("", "9", "9.99", "99999"), (1, 3, 9, 40, 10**5), ("", "1/")):
        stated = parsed(over + " ".join(times * [name + power]))
        assert stated is None or 1e-300 < stated[0] < 1e300
    assert parsed(f"{name}99/{name}98") is None


@pytest.mark.parametrize(
    ("written", "readings"),
    [
        ("3 200 t", {3.2e6}),
        ("3'200 t", {3.2e6}),
        ("3\u2019200 t", {3.2e6}),
        ("3_200 t", {3.2e6}),
        ("3\xa0200 t", {3.2e6}),
        ("3,200 t", {3.2e6, 3.2e3}),
        ("1,234,567 kg", {1234567.0}),
        ("1.234.567 kg", {1234567.0}),
        ("3.200,5 t", {3.2005e6}),
        ("3,200.5 t", {3.2005e6}),
        ("1 234 567,5 kg", {1234567.5}),
        ("3,2 t", {3.2e3}),
        (",5t", {500.0}),
    ],
)
def test_a_number_with_another_sign_is_refused_with_how_to_write_it(written, readings):
    """Whatever the refusal proposes is read, as one of the numbers that may have been meant."""
    mass = WithUnit("kg", Range())
    with pytest.raises(ValueError, match="no decimal point; write ") as refused:
        mass.read(written, print)
    proposed = re.findall('"(.*?)"', str(refused.value))
    assert {mass.read(text, print) for text in proposed} == readings
