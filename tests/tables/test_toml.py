"""Written TOML is what was to be written, to the last digit."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

import pytest
from cases import example_case
from hypothesis import given
from hypothesis import strategies as st

from stochlin.solver.tables.toml import read_toml, toml_text

pytestmark = pytest.mark.invariant

PLAIN = st.one_of(
    st.booleans(), st.integers(-(2**62), 2**62), st.floats(allow_nan=False), st.text(max_size=9)
)
VALUES = st.recursive(
    PLAIN,
    lambda inner: st.one_of(
        st.lists(PLAIN, max_size=3),
        st.dictionaries(st.text(max_size=5), inner, max_size=3),
        st.lists(st.dictionaries(st.text(max_size=5), inner, max_size=3), max_size=2),
    ),
    max_leaves=12,
)


@given(st.dictionaries(st.text(max_size=5), VALUES, max_size=4))
def test_any_tables_are_read_again_as_they_were(values: dict[str, Any]) -> None:
    assert tomllib.loads(toml_text(values)) == values


def test_the_example_of_a_case_is_read_again_as_it_was() -> None:
    values = tomllib.loads(example_case())
    assert tomllib.loads(toml_text(values)) == values


ENDLESS = {  # which would take minutes or memory for ever
    '["' + 'a" . "' * 30_000 + 'a"]': "line 1: a key is nested too deeply; allowed: tables",
    f"a = {'[' * 100_000}": "a value is nested too deeply; allowed: tables",
    "".join(f"[a_{n}]\n" for n in range(60_000)) + "[a_1]": "or give it another name",
    f"a = 1\na = 1\n{'[' * 300_000}": "line 2: 'a' is already given in line 1;",
    f"a = 1{'0' * 5000}  # {'x'.join(['9' * 999] * 900)}": "line 1: 'a = 1000",
    '["line 9"]\n["line 9"]': "line 2: '[\"line 9\"]' is already given in line 1;",
}


@pytest.mark.parametrize("text", ENDLESS, ids=range(len(ENDLESS)))
def test_what_the_parser_does_not_end_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"^case\.toml, ") as refusal:
        read_toml(tmp_path / "case.toml")
    assert ENDLESS[text] in str(refusal.value)
