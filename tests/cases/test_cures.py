"""Mistakes in case files: the cure that a message names is accepted, and a doubt is told once."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import pytest
from cases import example_case, storeyed_building, with_buildings
from cases import read_text as read

from stochlin.messages import LONGEST, DoubtfulInput

pytestmark = pytest.mark.invariant

EXAMPLE = example_case()
STOREYS = with_buildings(storeyed_building(1, "period"), storeyed_building(2, "masses"))
STOREYS = STOREYS.replace("floors_align = true", "floors_align = false")
STRENGTH = 'reduction_factor = 4\nheight = "24 m"'
BOUC_WEN = EXAMPLE.replace(
    STRENGTH, f'law = "bouc_wen"\nbeta = 0.5\ngamma = 0.5\nexponent = 1\n{STRENGTH}'
)
GROUND, SHAKING = '\nground = "firm"', '\nintensity = "0.01 m^2/s^3"'
CODE = EXAMPLE.replace(GROUND, '\nspectrum = "eurocode_8"\nag = "0.25 g"\nsoil = "C"').replace(
    SHAKING, ""
)
LINK = 'link_damping_constant = "5 MN s/m"'
POWER = 'link_damping_constant = "5 {}"\nlink_damping_exponent = 0.5'
# A file, what is changed in it and into which mistake, the cure in the message, and what it is put into.
CURES = {
    "key misspelled": (EXAMPLE, "confidence =", "confidnce =", r"mean (\w+)\?", "{} ="),
    "table misspelled": (EXAMPLE, "[separation]", "[separatio]", r"mean (\w+)\?", "[{}]"),
    "second building": (EXAMPLE, "[building_2]", "[building_]", r"mean (\w+)\?", "[{}]"),
    "name misspelled": (EXAMPLE, '"amin_ang"', '"amin-ang"', r"mean '(\w+)'\?", '"{}"'),
    "key missing": (EXAMPLE, 'confidence = "90 %"', "", r"instance, (.*)$", "{}"),
    "strength missing": (EXAMPLE, STRENGTH, "", r"one of (\w+ = \d+),", "{}"),
    "law missing": (BOUC_WEN, '\nlaw = "bouc_wen"', "", r"belongs to (law = \S+),", "\n{}"),
    "few motions": (EXAMPLE, "= 2048", "= 10", r"number from (\d+) on$", "= {}"),
    "type of a spectrum": (CODE, 'soil = "C"', 'soil = "C"\ntype = 3', r"(2)$", 'soil = "C"\ntype = {}'),
    "comma after zero": (EXAMPLE, '"0.35 1/s"', '"0,350 1/s"', r'point, as ("[^"]*")$', "{}"),
    "percentage": (EXAMPLE, "tion = 0.65", "tion = 65", r'mean ("[^"]*")', "tion = {}"),
    "floor not there": (STOREYS, LINK, f"{LINK}\nlink_floors = [99, 1]", r"as (.*)$", f"{LINK}\n{{}}"),
    "exponent": (EXAMPLE, LINK, f"{LINK}\nlink_damping_exponent = 0.5", r", k(N [^,]*),", POWER),
    "weakening": (EXAMPLE, "_2 = 1.3", "_2 = 0.3", r"write strengthening(.*)$", "{}"),
    "unit missing": (EXAMPLE, '"24 m"', "24", r'units, .*("24 m")', "{}"),
    "metres": (EXAMPLE, '"5 cm"', '"5 m"', r'mean ("[^"]*")', "{}"),
    "kilograms": (EXAMPLE, '"3200 t"', '"3200 kg"', r'mean ("[^"]*")', "{}"),
    "percent twice": (EXAMPLE, '= "5 %"', '= "0.05 %"', r"mean ([^?]*)\?", "= {}"),
}
DOUBTED = "weakening", "metres", "kilograms", "percent twice"  # which are read with a warning


def changed(text: str, old: str, new: str) -> str:
    assert old in text, old
    return text.replace(old, new, 1)


def refused(folder: Path, text: str) -> str:
    """What is said of a file that is refused."""
    with pytest.raises(ValueError, match=r"^case\.toml, line") as caught:
        read(folder, text)
    return str(caught.value)


def doubted(folder: Path, text: str) -> list[str]:
    """All that is said of a file that is read with doubts."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        read(folder, text)
    assert all(issubclass(warning.category, DoubtfulInput) for warning in told)
    return [str(warning.message) for warning in told]


@pytest.mark.parametrize("what", CURES)
def test_the_cure_of_a_mistake_is_accepted(what: str, tmp_path: Path) -> None:
    """The file is then read without a warning."""
    text, old, new, cure, put_into = CURES[what]
    if what in DOUBTED:
        (message,) = doubted(tmp_path, changed(text, old, new))
    else:
        message = refused(tmp_path, changed(text, old, new))
    found = re.search(cure, message)
    assert found is not None, message
    read(tmp_path, changed(text, old, put_into.format(found[1])))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('damping = "5 %"', "damping = 1.5"),  # a slip of 0.15, not 1.5 %
        ("stiffening_2 = 1.5", "stiffening_2 = 0"),  # no share of anything
        (STRENGTH, STRENGTH.replace("= 4", "= 400")),
    ],
)
def test_no_percentage_is_suggested_where_none_was_meant(old: str, new: str, tmp_path: Path) -> None:
    text = changed(EXAMPLE, old, new)
    messages = doubted(tmp_path, text) if "= 400" in new else [refused(tmp_path, text)]
    assert not any("did you mean" in message for message in messages)


def test_a_long_line_is_shown_with_its_end(tmp_path: Path) -> None:
    drifts = ", ".join(['"1 cm"'] * 40)
    message = refused(
        tmp_path, changed(STOREYS, 'yield_drifts = "1 cm"', f"yield_drifts = [{drifts}, 1 cm]\n#")
    )
    assert re.search(r": 'yield_drifts = \[.*\.\.\..*, 1 cm\]' is no TOML file's text", message)
    assert len(message.partition("' is no TOML")[0]) < LONGEST + len("case.toml, line 999: '") + 1
