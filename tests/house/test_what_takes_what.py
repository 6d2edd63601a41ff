"""The page that says which function takes which structure, law and ground is what trying it finds."""

import re

import pytest
from house.what_takes_what import CALLS, HEAD, PAGE, functions, linked, row, top, tried

pytestmark = pytest.mark.cli

BEFORE, _, TABLE = PAGE.read_text(encoding="utf-8").partition("| call")
ROWS = ("| call" + TABLE.partition("\n\n")[0]).splitlines()
NOTES = {text: int(number) for number, text in re.findall(r"^(\d+)\. `(.*)`$", TABLE, re.MULTILINE)}


def test_every_function_that_takes_a_structure_is_tried() -> None:
    assert {label.partition(",")[0] for label in CALLS} == functions()


@pytest.mark.slow
@pytest.mark.parametrize("label", CALLS)
def test_a_call_takes_an_oscillator_refuses_in_words_and_the_page_says_so(label: str) -> None:
    said, grounds = tried(label)
    assert said[0] == "", "bilinear oscillators are taken everywhere"
    assert grounds or "record" in label or "ground" not in label
    for message in filter(None, said):
        assert any(word in message for word in ("allowed", "give", "write", "follow")), message
        assert message.isprintable()
    found = dict(NOTES)
    assert row(label, found) in ROWS, "run make takes"
    assert found == NOTES, "run make takes"


def test_the_page_has_a_row_for_every_call_and_notes_in_the_order_of_the_rows() -> None:
    assert BEFORE == HEAD
    assert ROWS[:2] == top()
    assert [line.split(" | ")[0].removeprefix("| ") for line in ROWS[2:]] == [*map(linked, CALLS)]
    cells = [cell for line in ROWS[2:] for cell in line.strip("| ").split(" | ")[1:]]
    used = list(dict.fromkeys(int(cell) for cell in cells if cell.isdigit()))
    assert used == list(NOTES.values()) == list(range(1, len(NOTES) + 1))
