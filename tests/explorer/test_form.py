"""The form of a case file: it shows what the file has; what it writes is read as the same case."""

from __future__ import annotations

import tomllib

import pytest
from cases import BLOCK, read_text, with_buildings

from stochlin.applications.cases.examples import short_example
from stochlin.applications.explorer.form import MOST_TABLES, changed_text, form_of

pytestmark = pytest.mark.invariant

EXAMPLE = short_example()
CODE = 'spectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"'
STOREYS = with_buildings(
    BLOCK.format(n=1, period=1.0, storeys=6, height=3.2),
    """
[building_2]
name = "Annex"
masses = ["300 t", "250 t"]
stiffnesses = ["200 MN/m", "180 MN/m"]
heights = ["4 m", "3.2 m"]
yield_drifts = "1 cm"
damping = 0.04
hardening = 0.1
p_delta = true
""",
).replace("floors_align = true", "floors_align = false")


def entries(text: str):
    return [entry for _, of_table in form_of(text) for entry in of_table]


def shown(text: str, table: str, name: str):
    """The entry of a key."""
    return next(entry for entry in entries(text) if (entry.table, entry.name) == (table, name))


@pytest.mark.parametrize(
    ("text", "least"), [(EXAMPLE, 20), (STOREYS, 18)], ids=["short", "storeys"]
)
def test_an_entry_says_what_the_file_says(text, least):
    for entry in entries(text):
        assert entry.value == tomllib.loads(text)[entry.table][entry.name]
        assert isinstance(entry.value, bool) or entry.read(entry.text) == entry.value
        assert changed_text(text, entry) == text
    assert len(entries(text)) >= least


@pytest.mark.parametrize(
    ("text", "table", "name", "typed", "value"),
    [
        (EXAMPLE, "building_1", "period", "1.25 s", "1.25 s"),
        (EXAMPLE, "building_1", "period", "1 s +- 20 %", "1 s +- 20 %"),
        (EXAMPLE, "building_2", "reduction_factor", "3.5", 3.5),
        (EXAMPLE, "building_2", "damping", " 4 % ", "4 %"),
        (EXAMPLE, "separation", "existing", '"7 cm"', "7 cm"),
        (STOREYS, "building_2", "masses", '["300 t", "270 t"]', ["300 t", "270 t"]),
    ],
)
def test_a_typed_text_changes_one_line_of_the_file(text, table, name, typed, value, tmp_path):
    entry = shown(text, table, name)
    changed = changed_text(text, entry._replace(value=entry.read(typed)))
    wanted = tomllib.loads(text)
    wanted[table][name] = value
    lines = zip(text.splitlines(), changed.splitlines(), strict=True)
    ((old, new),) = (pair for pair in lines if pair[0] != pair[1])
    assert old.partition("#")[1:] == new.partition("#")[1:]  # its comment stays
    assert tomllib.loads(changed) == wanted
    read_text(tmp_path, changed)


def test_what_has_no_line_of_its_own_is_written_as_text_alone():
    text = 'separation = { confidence = "90 %" }\n[building_1]\nmasses = [\n"300 t",\n"200 t",\n]\n'
    assert entries(text) == []


@pytest.mark.parametrize(
    "typed", ["[" * 9999, "[1979-05-27]", '{"a": 1}', "1\n[site]", "true", "'", "é\0", ""]
)
def test_nonsense_is_a_text_that_the_reader_refuses(typed, tmp_path):
    entry = shown(EXAMPLE, "building_1", "period")
    with pytest.raises(ValueError, match=r"line \d+: building_1.period = "):
        read_text(tmp_path, changed_text(EXAMPLE, entry._replace(value=entry.read(typed))))


@pytest.mark.parametrize(
    ("name", "written", "reach", "at_half"),
    [
        ("period", '"900 ms"', (-1, 1), "1800 ms"),
        ("period", '"1 s +- 20 %"', (-1, 1), "2 s +- 20 %"),
        ("period", '"0.8 to 1.2 s"', None, None),
        ("damping", '"5 %"', (-1, 1), "10 %"),
        ("damping", "0.4", (-1, 0.65), 0.8),
        ("storeys", "8", (-1, 1), 16),
        ("mass", '"3200 t"', (-1, 1), "6400 t"),
        ("heights", '["3 m", "3 m"]', None, None),
    ],
)
def test_a_slider_reaches_four_times_as_far_in_the_unit_of_the_file(name, written, reach, at_half):
    entry = shown(f"[building_1]\n{name} = {written}\n", "building_1", name)
    assert entry.reach() == reach
    if reach is not None:
        assert entry.slid(0.5) == at_half
        assert entry.slid(0.0) == entry.value


def test_every_word_that_is_offered_makes_a_case(tmp_path):
    """The other keys of its table stay: a ground with parameters of its own is written as text."""
    for table, name, among, not_among in (
        ("site", "ground", {"firm", "white_noise"}, {"kanai_tajimi"}),
        ("site", "soil", {*"ABCDE"}, set()),
    ):
        text = EXAMPLE.replace('ground = "firm"\nintensity = "0.01 m^2/s^3"', CODE)
        entry = shown(EXAMPLE if name == "ground" else text, table, name)
        assert among <= {*entry.words} >= {entry.value}
        assert not not_among & {*entry.words}
        for word in entry.words if name == "ground" else ():
            case = read_text(tmp_path, changed_text(EXAMPLE, entry._replace(value=word)))
            assert case.site.ground.intensity == 0.01


def test_a_file_of_many_tables_has_a_form_of_few():
    """A file of a megabyte may have thirty thousand, each with fields that a browser would show."""
    many = "".join(f"[building_{n}]\nperiod = {n}\n" for n in range(1, 20_000))
    assert [title for title, _ in form_of(many)] == [
        f"Building {n}" for n in range(1, MOST_TABLES + 1)
    ]
