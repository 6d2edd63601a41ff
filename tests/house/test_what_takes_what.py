"""The page that says which function takes which structure, law and ground is what trying it finds."""

from __future__ import annotations

import pytest
from house.what_takes_what import CALLS, PAGE, functions, page, tried

pytestmark = pytest.mark.cli


def test_every_function_that_takes_a_structure_is_tried() -> None:
    assert {label.partition(",")[0] for label in CALLS} == functions()


@pytest.mark.slow
@pytest.mark.parametrize("label", CALLS)
def test_a_call_takes_an_oscillator_and_refuses_in_words(label: str) -> None:
    said, grounds = tried(label)
    assert said[0] == "", "bilinear oscillators are taken everywhere"
    assert grounds or "record" in label or "ground" not in label
    for message in filter(None, said):
        assert any(word in message for word in ("allowed", "give", "write")), message
        assert message.isprintable()


@pytest.mark.slow
def test_the_page_is_what_is_found() -> None:
    assert PAGE.read_text(encoding="utf-8") == page(), "run make takes"
