"""Written TOML is what was to be written, to the last digit."""

from __future__ import annotations

import tomllib
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from stochlin.analyses.cases.examples import example_case
from stochlin.analyses.tables.toml import toml_text

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
