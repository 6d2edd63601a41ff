"""Values in messages: on one line, without what a terminal would obey, and never long."""

from typing import Any

import numpy as np
import pytest
import xarray as xr

import stochlin as sl
from stochlin.messages import LONGEST, brief, hint, listed, nearest, plain, sentence

pytestmark = pytest.mark.invariant


class Broken:
    def __repr__(self) -> str:
        raise RuntimeError


@pytest.mark.parametrize(
    "value",
    [
        "a" * 200_000,
        dict.fromkeys(range(1000), "b" * 1000),
        xr.Dataset({f"a{n}": ("x", np.arange(50)) for n in range(50)}),
        [[[[[[["deep" * 100]]]]]]],
        Broken(),
        [10**400, 1],
        "one\ntwo\x1b[31m\u2028\x00" * 100,
    ],
    ids=lambda value: type(value).__name__,
)
def test_any_value_is_shown_on_one_line(value: object) -> None:
    said = brief(value)
    assert said.isprintable()
    assert 0 < len(said) <= LONGEST


def test_texts_without_quotation_marks() -> None:
    assert plain("two\nlines \x1b[2J") == r"two\nlines \x1b[2J"
    assert plain("a" * 1000) == "a" * 77 + "..."
    assert listed(["one", "two"]) == "one, two"
    assert listed(map(str, range(100))) == "0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11 and 88 more"
    assert sentence(ValueError("two\n  lines")) == "two lines"
    assert "too little memory (none is left); take fewer" in sentence(MemoryError())
    assert sentence(FileNotFoundError(2, "No such file", "a.at2")).startswith(
        "a.at2: there is no such file"
    )


@pytest.mark.parametrize(
    ("module", "written", "expected"),
    [
        (sl, "seperation", "separation"),
        (sl, "bilinear", "Bilinear"),
        (sl, "kanai_tajimi", "KanaiTajimi"),
        (sl.charts, "restitution_charts", "restitution_chart"),
        (sl.rules, "code_rules", "code_rule"),
    ],
)
def test_a_mistyped_public_name_gets_the_nearest(module: Any, written: str, expected: str) -> None:
    message = rf"'{module.__name__}' has no attribute '{written}'; did you mean '{expected}'\?$"
    with pytest.raises(AttributeError, match=message):
        getattr(module, written)


def test_a_name_that_resembles_none_gets_no_suggestion() -> None:
    for module in (sl, sl.charts, sl.rules):
        with pytest.raises(AttributeError, match=r"has no attribute 'xyzzyx'$"):
            _ = module.xyzzyx


def test_the_warnings_are_public() -> None:
    with pytest.warns(sl.ImplausibleInput, match="period = 500"):
        sl.Bilinear(500.0, 0.05)
    assert issubclass(sl.ImplausibleInput, sl.DoubtfulInput)


def test_the_name_that_was_probably_meant() -> None:
    known = [
        "floor_mass",
        "link_stiffness",
        "link_damping_constant",
        "link_damping_exponent",
        "eurocode_8",
    ]
    for written, expected in (
        ("Link Damping", "link_damping_constant"),
        ("linkstiffnes", "link_stiffness"),
        ("e", "eurocode_8"),
        *((text, "") for text in ("l", "foo", "x" * 200_000, "", "\u00e9")),
    ):
        assert nearest(written, known) == expected, written[:20]


@pytest.mark.parametrize(
    ("written", "known", "likely"),
    [
        ("zzzdefghij", "abcdefghij", True),  # 7 letters of 10 are the same, 0.7
        ("zzzzefghijklm", "abcdefghijklm", False),  # 9 of 13, 0.69
        ("ggp", "gap", False),
        ("gaps", "gap", True),
        ("per", "period", True),
        ("pe", "period", False),  # two letters begin many names
    ],
)
def test_a_hint_needs_three_letters_and_seven_tenths_of_them(written, known, likely):
    assert hint(written, [known, "something else"]) == (
        f"did you mean {known!r}? " if likely else ""
    )
