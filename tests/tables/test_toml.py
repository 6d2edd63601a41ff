"""What would take a TOML parser minutes or memory for ever is refused at once, with its line."""

from __future__ import annotations

from pathlib import Path

import pytest

from stochlin.files.toml import read_toml

pytestmark = pytest.mark.invariant

ENDLESS = {
    '["' + 'a" . "' * 30_000 + 'a"]': "line 1: a key is nested too deeply; allowed: tables",
    f"a = {'[' * 100_000}": "a value is nested too deeply; allowed: tables",
    "".join(f"[a_{n}]\n" for n in range(60_000)) + "[a_1]": "each key once",
    f"a = 1{'0' * 5000}  # {'x'.join(['9' * 999] * 900)}": "line 1: 'a = 1000",
}


@pytest.mark.parametrize("text", ENDLESS, ids=range(len(ENDLESS)))
def test_what_the_parser_does_not_end_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "case.toml").write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r"^case\.toml, ") as refusal:
        read_toml(tmp_path / "case.toml")
    assert ENDLESS[text] in str(refusal.value)
