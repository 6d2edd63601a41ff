"""Case files: what is read is what is written, in any unit, and what is wrong is said with its line."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from cases import blocks_to_uncomment, recorded_example, uncommented
from hypothesis import given
from hypothesis import strategies as st

import stochlin as sl
from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.examples import example_case, example_record
from stochlin.analyses.cases.files.quantities import Quantity, in_si
from stochlin.analyses.cases.files.sections import Section, key_lines
from stochlin.analyses.cases.pounding import pound_case
from stochlin.analyses.cases.probability import judge_gap
from stochlin.analyses.cases.separation import answer_case
from stochlin.messages import DoubtfulInput
from stochlin.models.grounds import rms_acceleration
from stochlin.models.parameters import Range
from stochlin.models.plausible import PLAUSIBLE
from stochlin.models.units import UNITS, size_of
from stochlin.views.separation.verdict import reason

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()


def read(folder: Path, text: str) -> Case:
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return sl.read_case(path)


def changed(old: str, new: str, count: int = 1) -> str:
    assert old in EXAMPLE, old
    return EXAMPLE.replace(old, new, count)


def line_of(text: str, part: str) -> int:
    return next(n for n, line in enumerate(text.splitlines(), 1) if line.startswith(part))


def wave(folder: Path, name: str = "wave.txt", seed: int = 1) -> Path:
    time = 0.02 * np.arange(2000)
    noise = np.random.default_rng(seed).normal(size=time.size)
    motion = np.convolve(noise, np.exp(-4 * time) * np.sin(12 * time), "full")[: time.size]
    np.savetxt(folder / name, 0.01 * motion)
    return folder / name


RECORD = '[[site.records]]\npath = "wave.txt"\nunits = "g"\ndt = "20 ms"\n'
FITTED = f'ground = "fitted"\n{RECORD}'
GROUND = 'ground = "firm"'
# The envelope of the example is not that of the record: its motions are too weak, which is told.
OTHER_ENERGY = pytest.mark.filterwarnings("ignore:.*times the energy of the record")


def with_site(lines: str) -> str:
    start, end = EXAMPLE.index("[site]"), EXAMPLE.index("[motion]")
    return f"{EXAMPLE[:start]}[site]\n{lines}\n{EXAMPLE[end:]}"


def test_example_is_what_its_comments_say(tmp_path: Path) -> None:
    case = read(tmp_path, EXAMPLE)
    firm = sl.named_ground("firm", intensity=0.01)
    assert case.ground == firm
    assert case.envelope == sl.AminAng(4.0, 15.0, 0.35)
    assert case.first.structure == sl.Bilinear(1.0, 0.05, 0.05, reduction_factor=4, mass=3.2e6)
    assert (case.duration, case.gap, case.confidence) == (20.0, 0.05, 0.9)
    # The comment on the intensity: an rms acceleration of 0.1 g.
    assert rms_acceleration(case.ground) == pytest.approx(0.1 * 9.80665, rel=0.02)


def test_every_commented_choice_of_the_example_can_be_taken(tmp_path: Path) -> None:
    wave(tmp_path, "taft.txt")
    filtered = 'ground = "kanai_tajimi"\nperiod = "2 s"\ndamping = 0.05\nintensity = "0.001 m^2/s^3"\n'
    record = blocks_to_uncomment("[[site.records]]")[0].replace("#   ", "")
    case = read(tmp_path, with_site(filtered + record))
    assert case.ground == sl.KanaiTajimi(2.0, 0.05, 0.001)
    assert list(case.records) == ["Taft 1952"]
    assert list(read(tmp_path, recorded_example()).records) == ["Taft 1952"]
    for strength in ('yield_displacement = "3 cm"', "ductility = 4", "elastic = true"):
        one = read(tmp_path, changed("\nreduction_factor = 4\nheight", f"\n{strength}\nheight"))
        assert one.first.strength == strength.split(" ")[0]
    assert read(tmp_path, changed("# zone", "zone")).zone == "II"
    assert read(tmp_path, changed("# unverified", "unverified")).unverified


def at2(values: np.ndarray) -> str:
    rows = "\n".join(" ".join(f"{value:.6E}" for value in row) for row in values.reshape(-1, 5))
    return f"PEER NGA\nSomewhere\nACCELERATION IN UNITS OF G\nNPTS= {values.size}, DT= .02 SEC\n{rows}\n"


def test_progress_of_an_answer_never_goes_back(tmp_path: Path) -> None:
    shares: list[float] = []
    answer = answer_case(read(tmp_path, changed("paths = 2048", "paths = 100")), shares.append)
    assert answer.separation.sizes["path"] == answer.case.paths == 128  # whole groups of 32
    assert "% of 128 motions" in reason(answer)
    assert shares == sorted(shares)
    assert shares[-1] == 1


def test_the_example_of_a_record_is_what_its_description_says(tmp_path: Path) -> None:
    """To its last digit, where another library may round differently."""
    (tmp_path / "record.at2").write_text(example_record())
    assert example_record().splitlines()[1].startswith("SYNTHETIC, by stochlin simulated_motions")
    site = sl.named_ground("firm", 0.01), 20.0, sl.AminAng(4.0, 15.0, 0.35)
    case = read(tmp_path, EXAMPLE)
    assert (case.ground, case.duration, case.envelope) == site
    shipped, motion = sl.read_record(tmp_path / "record.at2"), sl.simulated_motions(*site, paths=2)[0]
    np.testing.assert_allclose(shipped, motion, rtol=1e-7, atol=1e-9)


def test_each_form_of_a_record_is_uncommented_as_a_block_and_runs(tmp_path: Path) -> None:
    values = np.loadtxt(wave(tmp_path, "taft.txt"))
    np.savetxt(tmp_path / "sct.txt", np.column_stack([0.02 * np.arange(values.size), 981 * values]))
    (tmp_path / "record.at2").write_text(at2(values))
    blocks = blocks_to_uncomment("[[site.records]]")
    assert len(blocks) == 3
    for block in blocks:
        case = read(tmp_path, uncommented(block))
        (record,) = case.records.values()
        assert float(abs(record).max()) == pytest.approx(9.81 * abs(values).max(), rel=1e-3)
        (table,) = pound_case(case).values()
        assert float(table.peak.min()) > 0


@OTHER_ENERGY
@pytest.mark.parametrize("name", ["kanai_tajimi", "fitted"])
def test_a_ground_is_uncommented_in_place_of_the_two_lines_above(name: str, tmp_path: Path) -> None:
    (block,) = blocks_to_uncomment(f'ground = "{name}"')
    wave(tmp_path, "taft.txt")
    record = blocks_to_uncomment("[[site.records]]")[0]
    lines = uncommented(block).replace(record, record.replace("#   ", ""))
    text = lines.replace('\nground = "firm"', "").replace('\nintensity = "0.01 m^2/s^3"', "")
    assert isinstance(read(tmp_path, text).ground, sl.KanaiTajimi)


@given(
    st.sampled_from([units for units in UNITS if units != "1"]).flatmap(
        lambda units: st.tuples(st.just(units), st.sampled_from(sorted(UNITS[units])))
    ),
    st.floats(1e-6, 1e6),
    st.sampled_from(["", " ", "  "]),
)
def test_a_value_is_its_number_times_its_unit(pair: tuple[str, str], value: float, space: str) -> None:
    units, unit = pair
    section = Section("case.toml", (), {"key": f"{value!r}{space}{unit}"}, {})
    if unit == "1/s" and not space:  # "21/s" might be 2 or 21
        with pytest.raises(ValueError, match="unknown unit"):
            section.number("key", Quantity(units, Range()))
        return
    found = section.number("key", Quantity(units, Range()))
    assert found == pytest.approx(value * size_of(unit, units), rel=1e-14)


@pytest.mark.parametrize(
    ("text", "units", "value"),
    [
        ("2 kip-sec²/in", "kg", 2 * 4448.2216152605 / 0.0254),
        ("3 KN/m", "N/m", 3e3),
        ("100 lb/in", "N/m", 444.82216152605 / 0.0254),
        ("5 tonf*s/m", "N s/m", 5e3 * 9.80665),
        ("4 ft/s/s", "m/s^2", 4 * 0.3048),
        ("1 kip/in^1.5", "N/m^1.5", 4448.2216152605 / 0.0254**1.5),
    ],
)
def test_units_are_read_as_people_spell_them(text: str, units: str, value: float) -> None:
    assert in_si(text, Quantity(units, Range())) == pytest.approx(value, rel=1e-12)


@given(st.text(max_size=20))
def test_any_text_is_a_quantity_or_an_error_that_names_the_key(text: str) -> None:
    section = Section("case.toml", ("building_1",), {"period": text}, {("building_1", "period"): 7})
    try:
        said = ""
        assert 0 < section.number("period", Quantity("s", Range())) < math.inf
    except ValueError as error:
        said = str(error)
    if said:
        assert said.startswith("case.toml, line 7: building_1.period = ")
        assert "allowed" in said


def test_ductility_gives_the_strength_that_has_it(tmp_path: Path) -> None:
    case = read(tmp_path, changed("\nreduction_factor = 4\nheight", "\nductility = 3\nheight"))
    structure = case.first.structure
    found = sl.linearize(structure, case.ground, "drift")
    assert 3 * float(found.ductility_std) == pytest.approx(3.0, rel=1e-6)


@OTHER_ENERGY
def test_records_are_read_beside_the_file_and_the_first_is_fitted(tmp_path: Path) -> None:
    path = wave(tmp_path)
    wave(tmp_path, "other.txt", seed=2)
    other = RECORD.replace("wave.txt", "other.txt")
    case = read(tmp_path, with_site(f'{FITTED}name = "Here"\n{other}'))
    assert list(case.records) == ["Here", "other.txt"]
    assert case.ground == sl.fit_ground(sl.read_record(path, dt=0.02, units="g"))
    assert case.fitted


# What to change, and what the message says of it: the line that starts with the third, and words.
WRONG = {
    "unknown key": ("storeys = 8", "storys = 8", "storys", ["1.storys", "did you mean storeys?"]),
    "unknown unit": ('"5 cm"', '"5 km"', "existing", ["'km'", "allowed: cm, m, mm, in, ft"]),
    "text for a number": ('"0.6 s"', '"short"', 'period = "short"', ["is no number", '"1 s"']),
    "truth for a number": ('damping = "5 %"', "damping = true", "damping", ["is no number", "0.05"]),
    "period out of range": (
        '"0.6 s"',
        '"-0.6 s"',
        'period = "-0.6 s"',
        ["1e-09 <= value <= 1e+09, finite, in s"],
    ),
    "two strengths": (
        "\nreduction_factor = 4\nheight",
        "\nreduction_factor = 4\nductility = 4\nheight",
        "ductility = 4",
        ["2 times, by reduction_factor and ductility", "allowed: one of"],
    ),
    "hardening missing": (
        'hardening = "5 %"               # st',
        "# st",
        "[building_1]",
        ["building_1.hardening", "missing"],
    ),
    "unknown ground": ('"firm"', '"firmm"', "ground =", ["did you mean 'firm'?", "kanai_tajimi"]),
    "parameter of another envelope": ('"amin_ang"', '"gamma"', "rise_end", ["power, decay"]),
    "envelope that falls before it rises": (
        '"15 s"',
        '"1 s"',
        "[motion]",
        ["allowed: from rise_end, 4"],
    ),
    "neither true nor false": ("align = true", 'align = "yes"', "floors_align", ["true, false"]),
    "no words": ('name = "Annex"', 'name = " "', 'name = " "', ["a text on one line"]),
    "control sign": ('name = "Annex"', r'name = "A\u001b[2J"', 'name = "A', ["a text on one line"]),
    "unquoted unit": ('"0.6 s"', "0.6 s", "period = 0.6 s", ["no TOML", 'period = "0.6 s"']),
    "whole number beyond all": (
        'damping = "5 %"',
        f"damping = 1{400 * '0'}",
        "damping = 1",
        ["about 1e400 is out of range"],
    ),
    "more digits than Python reads": ("seed = 0", f"seed = 1{5000 * '0'}", "seed = 1", ["is no TOML"]),
    "long value": ('"0.6 s"', f'"{"6" * 200_000} km"', 'period = "666', ["has the unknown unit 'km'"]),
    "long name": ('"Annex"', f'"{"A" * 200_000}"', 'name = "AAA', ["200 characters at most"]),
    "spread of spaces": (
        '"0.6 s"',
        f'"1{" " * 200_000}+- x"',
        'period = "1  ',
        ["valid spread"],
    ),
    "measure without a name": ('"Rubber bumpers"', '" "', '[measures." "]', ["that cannot be shown"]),
    "sign between thousands": ('"3200 t"', '"3,200 t"', "mass", ['as "3.200 t", or no', 'as "3200 t"']),
    "bare decimal comma": ('"0.6 s"', "0,6", "period = 0,6", ["write a decimal point"]),
    "no digit before the point": ("= 4\nheight", "= .5\nheight", "reduction_factor = .5", ["as 0.5"]),
    "path": ('"Annex"', r'"C:\annex"', 'name = "C:', [r'name = "C:\annex"', "'single quotes', or with"]),
    "path with a tab": ('"Annex"', r'"C:\taft"', 'name = "C:', ["no line of text", "'single quotes'"]),
    "key twice": ("storeys = 8", "storeys = 8\nstoreys  = 8", "storeys  =", ["'storeys'", "line 135"]),
    "dotted key": ("[contact]", "[contact]\na.b.c = 3", "a.b.c", ["contact.a is not a key"]),
    "nothing to fit to": (GROUND, 'ground = "fitted"', "intensity", ["site.intensity", "estimator"]),
}


@pytest.mark.parametrize("what", WRONG)
def test_what_is_wrong_is_said_with_file_line_and_key(what: str, tmp_path: Path) -> None:
    old, new, at, says = WRONG[what]
    text = changed(old, new)
    building_2 = "building_2" in says[0]
    start = text.index("[building_2]") if building_2 else 0
    skipped = text[:start].count("\n")
    with pytest.raises(ValueError, match=r"case\.toml") as caught:
        read(tmp_path, text)
    message = str(caught.value)
    assert message.startswith(f"case.toml, line {skipped + line_of(text[start:], at)}: "), message
    for part in says:
        assert part in message
    assert message.isprintable()
    assert len(message) < 500


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('"90 %"', '"90"'),
        ('"90 %"', '"0.9"'),
        ('"90 %"', "90"),
        ('damping = "5 %"', "damping = 5"),
        ('damping = "5 %"', 'damping = "2,5 %"'),
        ("= 4\nheight", '= "4"\nheight'),
        ('"5 cm"', "0.05"),
        ('"5 cm"', "5"),
        ('"5 cm"', '"5"'),
        ('\nintensity = "0.01 m^2/s^3"', "\nintensity = 100"),
    ],
)
def test_the_first_cure_of_a_number_works(old: str, new: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"case\.toml, line") as caught:
        read(tmp_path, changed(old, new))
    cure = re.search(
        r'(?:mean|units,|allowed:|quotation marks,|point, as) ("[^"]+"|[\d.]+)(?: or|,|\?|$)',
        str(caught.value),
    )
    wrong = new.replace("\nheight", "").rpartition("= ")[2]
    assert cure is not None, str(caught.value)
    read(tmp_path, changed(old, new.replace(wrong, cure[1])))  # without a warning


# What to change, and what is said of it: the key, words, and what may be meant instead.
DOUBTED = {
    "gap in metres": ('"5 cm"', '"5 m"', "separation.existing", '0.01 to 1 m; did you mean "5 cm"?'),
    "mass in kilograms": ('"3200 t"', '"3200 kg"', "building_1.mass", 'did you mean "3200 t"?'),
    "light storeys": ('"3200 t"', '"20 t"', "building_1.mass", "2500 kg for each of 8 storeys"),
    "late yield": (
        "\nreduction_factor = 4\nheight",
        '\nyield_displacement = "3 m"\nheight',
        "building_1.yield_displacement",
        'did you mean "3 cm"?',
    ),
    "late yield, uncertain": (
        "\nreduction_factor = 4\nheight",
        '\nyield_displacement = "4 m +- 10 %"\nheight',
        "building_1.yield_displacement",
        "usual are 0.005 to 1 m",
    ),
    "weak shaking": (
        '\nintensity = "0.01 m^2/s^3"',
        '\nintensity = "0.01 cm^2/s^3"',
        "site.intensity",
        'did you mean "0.01 m^2/s^3"?',
    ),
    "long period": ('"0.6 s"', '"600 s"', "building_2.period", 'did you mean "600 ms"?'),
    "short motion": ('"20 s"', '"3 s"', "motion.duration", "ends before its strong part"),
    "share in percent": ('"90 %"', '"0.9 %"', "separation.confidence", "usual are 0.5 to 0.99"),
    "damping in percent": ('\ndamping = "5 %"', '\ndamping = "0.05 %"', "damping", "usual are 0.005 to"),
    "low building": ('"24 m"', '"24 cm"', "building_1.height", 'did you mean "24 m"?'),
}


@pytest.mark.parametrize("what", DOUBTED)
def test_what_is_implausible_is_asked_about_once_with_its_line(what: str, tmp_path: Path) -> None:
    old, new, key, says = DOUBTED[what]
    with pytest.warns(DoubtfulInput) as told:
        read(tmp_path, changed(old, new))
    (message,) = (str(one.message) for one in told)
    assert re.match(rf"case\.toml, line \d+: \S*{key} = .* is doubtful: ", message)
    assert says in message


def test_a_hundred_buildings_are_allowed_and_two_thousand_not_listed(tmp_path: Path) -> None:
    more = "".join(f"[building_{n}]\n" for n in range(3, 2003))
    for title, says in (
        ("motion", "building_101 is given; allowed: 100 build"),
        ("motions", "not a key"),
    ):
        with pytest.raises(ValueError, match=rf"case\.toml, line \d+: .*{says}") as caught:
            read(tmp_path, changed("[motion]", f"{more}[{title}]"))
        assert len(str(caught.value)) < 1000


def test_a_name_that_clears_the_screen_is_refused(tmp_path: Path) -> None:
    for table in ("measures.", "site.", ""):
        with pytest.raises(ValueError, match=rf"{table}.*\\x1b\[2J") as caught:
            read(tmp_path, changed('[measures."Rubber bumpers"]', rf'[{table}"\u001b[2J"]'))
        assert str(caught.value).isprintable()


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ('ground = "fitted"', ["site.ground", "needs a record"]),
        (FITTED.replace("wave", "nowhere"), ["site.records.path", "cannot be read", "nowhere.txt"]),
        (FITTED + RECORD, ["is used twice"]),
        (f'model = "white"\n{FITTED}', ["kanai_tajimi, clough_penzien"]),
        ('ground = "firm"\nrecords = 3', ["[[site.records]]"]),
    ],
)
def test_what_is_wrong_with_a_site(lines: str, says: list[str], tmp_path: Path) -> None:
    wave(tmp_path)
    with pytest.raises(ValueError, match=r"case\.toml, line \d+: ") as caught:
        read(tmp_path, with_site(lines))
    for part in says:
        assert part in str(caught.value)


def test_what_is_no_case_file(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    with pytest.raises(FileNotFoundError, match=r"case\.toml"):
        sl.read_case(path)
    for content, says in (
        (b"\xff\xfe\x00", "UTF-8"),
        (b"", "site is missing"),
        (b"site = 5\n", "is no table"),
        (b"[site\n", "is no TOML"),
    ):
        path.write_bytes(content)
        with pytest.raises(ValueError, match=says):
            sl.read_case(path)


def test_lines_of_keys_in_every_way_of_writing_them() -> None:
    text = '''title = "a"
text = """
[site]
period = 1
"""
[ "site" ]  # note
a.b = 1
[[site.records]]
path = "x"
[[site.records]]
"path" = "y"
'''
    lines = key_lines(text)
    assert lines["site",] == 6
    assert lines["site", "a", "b"] == 7
    assert lines["site", "records", 0, "path"] == 9
    assert lines["site", "records", 1, "path"] == 11
    assert ("period",) not in lines


@given(st.floats(0.2, 3.0), st.floats(0.02, 0.9), st.floats(1e-4, 1.0))
def test_rms_acceleration_of_kanai_tajimi_ground(
    period: float, damping: float, intensity: float
) -> None:
    w = 2 * math.pi / period
    exact = math.sqrt(math.pi * intensity * w * (1 + 4 * damping**2) / (2 * damping))
    found = rms_acceleration(sl.KanaiTajimi(period, damping, intensity))
    assert found == pytest.approx(exact, rel=1e-3)  # the tail beyond 1e4 Hz
    assert rms_acceleration(sl.WhiteNoise(intensity)) == math.inf


def test_answer_is_that_of_the_library(tmp_path: Path) -> None:
    wave(tmp_path)
    site = f'{GROUND}\nintensity = "0.01 m^2/s^3"\n{RECORD}'
    common = 'floors_align = true\nsame_property = true\nsame_system = true\nzone = "II"\n'
    text = with_site(site).replace("paths = 2048", "paths = 128").replace("floors_align = true", common)
    case = read(tmp_path, text)
    answer = answer_case(case)
    pair = [sl.Bilinear(T, 0.05, 0.05, reduction_factor=4) for T in (1.0, 0.6)]
    motion = {"envelope": sl.AminAng(4.0, 15.0, 0.35), "paths": 128}
    ground = sl.named_ground("firm", intensity=0.01)
    record = sl.read_record(tmp_path / "wave.txt", dt=0.02, units="g")
    sites = {"height_1": 24.0, "height_2": 15.0, "storeys_1": 8, "storeys_2": 5, "zone": "II"}
    sites |= dict.fromkeys(("floors_align", "same_property", "same_system"), True)
    expected = sl.separation(*pair, ground, 20.0, **motion, **sites, records={"wave.txt": record})
    # Sums over modes are rounded otherwise by the oldest libraries.
    xr.testing.assert_allclose(answer.separation, expected, rtol=1e-13, atol=1e-15)
    assert answer.existing is not None
    assert answer.existing.equals(sl.existing_gap(*pair, ground, 20.0, 0.05, **motion))
    np.testing.assert_allclose(
        answer.spectrum.psd_ground, ground.psd(answer.spectrum.frequency.values), rtol=1e-12
    )
    assert "path" not in answer.table(samples=False).dims
    assert "existing_least_added_damping" in answer.table()


@pytest.mark.slow
def test_a_building_takes_a_law_and_its_parameters(tmp_path: Path) -> None:
    """Where an analysis knows fewer laws, it says so before any work."""
    wave(tmp_path)
    text = changed('name = "Annex"', 'name = "Annex"\nlaw = "bouc_wen"\nbeta = "60 %"\nexponent = 2')
    structure = read(tmp_path, text).second.structure
    given = {"damping": 0.05, "mass": 1.5e6, "beta": 0.6, "exponent": 2.0}
    assert isinstance(structure, sl.BoucWen)
    assert {name: getattr(structure, name) for name in given} == given
    assert structure.gamma == sl.BoucWen(1.0, 0.05).gamma
    few = text.replace("paths = 2048", "paths = 128")
    case = read(tmp_path, few.replace("[motion]", f"{RECORD}[motion]"))
    assert judge_gap(case, 0.05).records.record_required_gap > 0
    (table,) = pound_case(case).values()
    assert np.isfinite(table.peak).all()
    assert np.isnan(table.largest_radius_amplification).all()


def test_an_acceleration_that_is_not_known_is_not_doubted() -> None:
    """White noise has no peak acceleration."""
    assert [*map(PLAUSIBLE["pga"].holds, (np.nan, 100.0, 1e-3))] == [True, False, False]
