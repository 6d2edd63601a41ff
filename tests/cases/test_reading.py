"""The reading of case files by forms: what is read, what is refused, and what is said of it."""

from __future__ import annotations

import pickle
import tomllib
import warnings
from pathlib import Path

import pytest
from commands import answered

import stochlin as sl
from stochlin.applications.cases.examples import short_example
from stochlin.applications.cases.reading.case import Case, read_case

pytestmark = pytest.mark.invariant

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLE = short_example()
SITE = 'ground = "firm"\nintensity = "0.01 m^2/s^3"'
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"\n'
BUILDING = EXAMPLE[EXAMPLE.index('period = "1.0 s"') : EXAMPLE.index("[building_2]")]
STRENGTH = EXAMPLE[EXAMPLE.index("reduction_factor = 4") : EXAMPLE.index('height = "24 m"')]
HARDENING = 'hardening = "5 %"               # stiffness after yielding over that before\n'


def chain(masses: str, stiffnesses: str, more: str = 'storey_height = "3 m"\n') -> str:
    """The lines of a building by its storeys."""
    return f"masses = {masses}\nstiffnesses = {stiffnesses}\n{more}damping = 0.05\nelastic = true\n"


# An edit of the example, and a piece of the message, of which $ is the end.
MISTAKES = {
    "unit missing": ('period = "1.0 s"', "period = 1.0", 'units, "1 s", "1 ms"'),
    "unit unknown": ('"1.0 s"', '"1.0 sekunde"', "unknown unit 'sekunde'; allowed: s, ms"),
    "weight for mass": (
        '"3200 t"', '"3200 kN"', """a weight, in 'kN'; write its mass, "326.3 t"$"""
    ),
    "hyphen of ends": ('"1.0 s"', '"0.8-1.2 s"', 'a hyphen between two ends; write "0.8 to 1.2 s"'),
    "fraction": ('"5 cm"', '"3 1/8 in"', 'has a fraction; write "3.125 in"'),
    "comma": ('"1.0 s"', '"1,0 s"', 'no decimal point; write "1.0 s"'),
    "percent": ('damping = "5 %"', "damping = 5", 'for 5 % write "5 %"'),
    "percent of percent": ('damping = "5 %"', 'damping = "500 %"', "(a ratio, 0.05 for 5 %)$"),
    "no percent": ('damping = "5 %"', "damping = 150", "(a ratio, 0.05 for 5 %)$"),
    "negative": ('damping = "5 %"', 'damping = "-5 %"', "out of range; allowed: 0 < value < 1"),
    "ground misspelled": ('"firm"', '"frim"', "did you mean 'firm'?"),
    "wall fixed to a number": (
        "[contact]",
        '[wall_left]\ngap = "2 cm"\nfixed = true\n[contact]',
        "wall_left.fixed = True is not known; allowed: ground, space$",
    ),
    "swapped": (
        'rise_end = "4 s"', 'rise_end = "16 s"', "strong_end = 15; allowed: from rise_end, 16"
    ),
    "no strength": (STRENGTH, "", "has no strength; allowed: one of reduction_factor, yield"),
    "two strengths": (STRENGTH, STRENGTH + 'yield_displacement = "3 cm"\n', "as reduction_factor"),
    "strength and elastic": (
        STRENGTH, STRENGTH + "elastic = true\n", "as well as reduction_factor"
    ),
    "truth": (STRENGTH, 'elastic = "yes"\n', "neither true nor false; allowed: true, false"),
    "number as text": ("storeys = 8", 'storeys = "8"', "no whole number; allowed: a whole number"),
    "of storeys": (STRENGTH, f'{STRENGTH}floor_mass = "400 t"\n', "a building without storeys"),
    "gaps": (
        '"5 cm"', '["5 cm", "3 cm"]', "does not fit the number of buildings, 2; allowed: 1 in all"
    ),
    "two strengths of shaking": ('[motion]', 'pga = "0.3 g"\n[motion]', "as well as intensity"),
    "spread": (
        '"1.0 s"', '"1.0 s +- 0.2"', 'up to 100 %, "1 s +- 20 %", or two ends, "0.8 to 1.2 s"$'
    ),
    "spread of a ratio": (
        STRENGTH, 'reduction_factor = "4 +- 1"\n', '"4 +- 20 %", or two ends, "3.2'
    ),
    "wide spread": (
        '"1.0 s"', '"1.0 s +- 200 %"', "no valid spread; allowed: a share of up to 100 %"
    ),
    "ends": ('"1.0 s"', '"1.2 to 0.8 s"', "allowed: 0 < lower <= higher"),
    "certain": ('"5 cm"', '"5 cm +- 10 %"', "cannot be uncertain; allowed: a number in cm"),
    "record": ("[motion]", '[[site.records]]\npath = "a.at2"\n[motion]', "there is no such file"),
    "displacements": ("storeys = 8", 'displacements = ["1 cm", "2 cm"]', "does not fit 1 floors"),
    "code": ("floors_align = true", 'codes = ["eurocode8"]', "did you mean 'eurocode_8'?"),
    "contact": ("restitution = 0.65", "", "does not fit: Kelvin"),
    "no table": ("[contact]", "[measures]\nm = 3\n[contact]", "m = 3 is no table"),
    "no hazard": ("[motion]", '[site.hazard]\nmeasure = "pga"\n[motion]', "hazard.file is missing"),
    "control sign": ('"Annex"', r'"A\u001b[2J"', "a text on one line"),
    "many digits": ('damping = "5 %"', f"damping = 1{400 * '0'}", "about 1e400 is out of range"),
    "long number": ('"0.6 s"', f'"{"6" * 200_000} km"', "has the unknown unit 'km'"),
    "long name": ('"Annex"', f'"{"A" * 200_000}"', "200 characters at most"),
    "spread of spaces": ('"0.6 s"', f'"1{" " * 200_000}+- x"', "valid spread"),
    "dotted key": ("[contact]", "[contact]\na.b.c = 3", "contact.a is not a key"),
    "unit of Hertz": ('"kelvin"', '"hertz_damp"', "allowed: N/m^1.5"),
    "list of gaps": ('"5 cm"', '["5 cm", "-3 cm"]', "has a number 2 that is out of range"),
    "shape of a ground": (
        'ground = "firm"', 'ground = "kanai_tajimi"', "(and also damping); allowed"
    ),
    "ground and spectrum": (
        'ground = "firm"', f"{CODE}ground = 'firm'", "of a site by its spectrum"
    ),
    "no code": (SITE, 'spectrum = "eurocode_9"', "did you mean 'eurocode_8'"),
    "no return period": (
        SITE, 'ground = "firm"\nreturn_period = "475 yr"', "needs a hazard; allowed"
    ),
    "hazard elsewhere": ("[contact]", '[hazard]\nmeasure = "pga"\n[contact]', "is not a key"),
    "risk without a hazard": ("[contact]", 'risk = "2 % in 50 years"\n[contact]', "needs a hazard"),
    "code without factors": (
        "[contact]", 'codes = ["asce_7"]\n[contact]', "asce_7 needs it, or a site"
    ),
    "suite": ("[motion]", '[site.suite]\npath = "none"\n[motion]', "neither a folder nor a table"),
    "strength without hardening": (HARDENING, "", "reduction_factor = 4 needs hardening"),
    "hysteresis without its law": (
        "storeys = 8", "storeys = 8\nbeta = 0.5", "beta = 0.5 is not a key"
    ),
    "ductility": (STRENGTH, "ductility = 0.5\n", "out of range; allowed: 1 < value"),
    "table misspelled": ("[separation]", "[separatio]", "did you mean separation?"),
    "second building": ("[building_2]", "[building_]", "did you mean building_2?"),
    "key misspelled": ("confidence =", "confidnce =", "did you mean confidence?"),
    "motion of a record": ('"amin_ang"', '"fitted"', "motion.duration = '20 s' is not a key"),
    "storeys without heights": (
        BUILDING,
        chain('["1 t"]', '["1 MN/m"]', ""),
        "no height of its storeys; allowed: one of storey_height, heights",
    ),
    "too few heights": (
        BUILDING,
        'period = "1 s"\nstoreys = 2\nheights = ["3 m"]\nfloor_mass = "9 t"\ndamping = 0.05\n'
        "elastic = true\n",
        "has 1 values; allowed: one, or 2",
    ),
    "different spreads": (
        BUILDING,
        chain('["90 t +- 5 %", "90 t +- 6 %"]', '["9 MN/m", "9 MN/m"]'),
        "allowed: one spread for all of them",
    ),
    "site twice": (
        "[motion]",
        '[site.hazard]\nmeasure = "pga"\nfile = "a"\nsite = 1\ncoordinates = [1, 2]\n[motion]',
        "is given as well as site; allowed: one of site, coordinates",
    ),
    "period of pga": (
        "[motion]",
        '[site.suite]\npath = "a"\npga = "0.3 g"\nsa_period = "1 s"\n[motion]',
        "needs sa",
    ),
    "fitted to nothing": (SITE, 'ground = "fitted"', "needs a record"),
}  # fmt: skip
# Lines of a measure, and a piece of the message.
OF_MEASURES = {
    "": "does nothing; allowed: added_damping_1",
    'link_stiffness = "1 MN/m"': "did you mean link.stiffness?",
    "link.floors = [1, 1]": "link is a link that does nothing",
    'link.stiffness = "1 MN/m"\nlink.floors = [5, 1]': "allowed: up to [1, 1]",
    'link.stiffness = "1 MN/m"\nlink.hardening = 0.1': "allowed: both for a link that yields",
    'link.damping_constant = "1 MN s/m"\nlink.damping_exponent = 0.5': "MN (s/m)^0.5",
    "dampers_1 = { storeys = [1] }": "does nothing; give stiffness or damping_constant",
    'dampers_1 = { storeys = [1, 2], stiffness = "1 MN/m" }': "or storeys 1 to 1",
    'dampers_1 = { storeys = "some", stiffness = "1 MN/m" }': "storeys = 'some'",
    'dampers_1 = { stiffness = ["1 MN/m", "2 MN/m"] }': "is no number",
    'dampers_1 = "20 MN s"': "allowed: a line [measures.m.dampers_1], keys below it",
    'bumper = { thickness = "5 cm" }': (
        "without contact (a bumper is [contact], for 'stochlin pound')"
    ),
}
DOUBTS = {
    "late yield": (STRENGTH, 'yield_displacement = "3 m"\n', "is it in cm or mm"),
    "weak shaking": ('"0.01 m^2/s^3"', '"0.01 cm^2/s^3"', "usual are 1e-4 to 0.1 m^2/s^3"),
    "short motion": ('"20 s"', '"3 s"', "ends before its strong part"),
    "metres": ('"5 cm"', '"5 m"', "usual are 0.01 to 0.5 m; is it in cm?"),
    "kilograms": ('"3200 t"', '"3200 kg"', "is it in t?"),
    "kN/m for MN/m": (
        BUILDING,
        chain('["300 t"]', '["300 kN/m"]'),
        "a first period of 6.28 s is 55 times 0.05 h^0.75 of a height of 3 m",
    ),
    "MN/m for kN/m": (
        BUILDING,
        chain('["300 t", "300 t"]', '["3e8 kN/m", "3e8 kN/m"]'),
        "a first period of 0.0102 s is 0.053 times 0.05 h^0.75 of a height of 6 m",
    ),
    "unused": (STRENGTH, STRENGTH + "behaviour_factor = 3\n", "is not used; name your code"),
}


def read(folder: Path, old: str = "", new: str = "") -> tuple[Case, list[str]]:
    """The case of the example after an edit, and its warnings."""
    assert old in EXAMPLE
    path = folder / "case.toml"
    path.write_text(EXAMPLE.replace(old, new, 1) if old else EXAMPLE, encoding="utf-8")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        return read_case(path), [str(warning.message) for warning in caught]


@pytest.mark.parametrize("what", MISTAKES)
def test_a_mistake_is_refused_with_its_line(what: str, tmp_path: Path) -> None:
    old, new, says = MISTAKES[what]
    with pytest.raises(ValueError, match=r"^case\.toml, line \d+: ") as refused:
        read(tmp_path, old, new)
    message = str(refused.value)
    assert says in f"{message}$"
    assert message.isprintable()
    assert len(message) < 700


def test_a_file_is_asked_about_also_where_it_is_refused(tmp_path: Path) -> None:
    """A curve that does not bend may have its columns exchanged, which its 26 m show."""
    curve = "roof [m],base shear [N]\n0,0\n8,2e5\n15,4e5\n19,6e5\n26,32e5\n"
    (tmp_path / "push.csv").write_text(curve, encoding="utf-8")
    second = EXAMPLE[EXAMPLE.index("[building_2]") : EXAMPLE.index("[separation]")]
    building = 'period = "0.6 s"\nstoreys = 5\nstorey_height = "3 m"\nfloor_mass = "300 t"\n'
    pushed = f'[building_2]\n{building}damping = "5 %"\npushover = "push.csv"\n'
    (tmp_path / "case.toml").write_text(EXAMPLE.replace(second, pushed), encoding="utf-8")
    with (
        pytest.warns(
            sl.DoubtfulInput, match=r"line \d+: building_2.pushover.* displacement is 26 m"
        ),
        pytest.raises(ValueError, match="pushover does not bend"),
    ):
        read_case(tmp_path / "case.toml")


@pytest.mark.parametrize("lines", OF_MEASURES)
def test_a_mistake_in_a_measure_is_refused_with_its_line(lines: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^case\.toml, line \d+: measures\.m") as refused:
        read(tmp_path, "[contact]", f"[measures.m]\n{lines}\n[contact]")
    assert OF_MEASURES[lines] in str(refused.value)


@pytest.mark.parametrize(
    ("line", "side"),
    [('dampers_1 = "20 MN s/m"', 1), ('dampers_2 = "50 MN/m"', 2), ('link = "5 MN/m"', 0)],
)
def test_a_number_in_place_of_a_table_is_refused_with_a_table_that_is_read(
    line, side, tmp_path: Path
):
    """It is pasted as it is shown, with its quotation marks."""
    with pytest.raises(ValueError, match="is no table; allowed: ") as refused:
        read(tmp_path, "[contact]", f"[measures.m]\n{line}\n[contact]")
    shown = str(refused.value).partition("; allowed: ")[2]
    case, _ = read(tmp_path, "[contact]", f"[measures.m]\n{shown}\n[contact]")
    (link,) = case.measures["m"].links
    assert link.structures == ((side, side) if side else (1, 2))
    assert {link.stiffness, link.damping_constant} == {
        0.0,
        float(line.split('"')[1].split()[0]) * 1e6,
    }


@pytest.mark.parametrize("what", DOUBTS)
def test_a_doubtful_value_is_warned_of_once(what: str, tmp_path: Path) -> None:
    old, new, says = DOUBTS[what]
    _, (message,) = read(tmp_path, old, new)
    assert message.startswith("case.toml, line ")
    assert says in message


def test_the_short_example_is_short_and_right(tmp_path: Path) -> None:
    """It is read without a warning, and a copy of the case is equal."""
    case, doubts = read(tmp_path)
    assert not doubts
    assert len(EXAMPLE.splitlines()) <= 40
    assert [building.period for building in case.buildings] == [1.0, 0.6]
    assert case.site.ground.intensity == 0.01
    copy = pickle.loads(pickle.dumps(case))
    assert copy == case
    assert copy.buildings[0].structure == case.buildings[0].structure


def test_the_full_example_has_the_keys_of_a_case_and_what_is_allowed() -> None:
    full = answered("gap", "--example", "full").output
    case = tomllib.loads((DOCS / "worked_case.toml").read_text(encoding="utf-8"))
    for table in ("site", "separation", "building_1", "simulation"):
        part = full.partition(f"# [{table}]\n")[2].partition("\n\n")[0]
        keys = {line.split()[1] for line in part.splitlines()}
        assert {key for key, value in case[table].items() if not isinstance(value, dict)} <= keys
    assert "# damping                Damping ratio: a number; 0 < value < 1" in full
    assert "# [[site.records]]" in full


@pytest.mark.filterwarnings("ignore:.*ends before its strong part")
def test_a_motion_shorter_than_a_period_is_refused_with_its_key(tmp_path):
    (tmp_path / "case.toml").write_text(EXAMPLE.replace('"20 s"', '"0.9 s"'), encoding="utf-8")
    says = r"line 10: motion\.duration = '0\.9 s' is shorter than the period of Office block, 1 s"
    with pytest.raises(ValueError, match=says):
        read_case(tmp_path / "case.toml")
