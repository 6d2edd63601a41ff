"""TOML files, read as data; errors state the line."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from stochlin.files.file_kinds import check_kind
from stochlin.files.inputs import read_input
from stochlin.messages import plain

BACKSLASH = (
    'a backslash begins a special sign in "double quotes": '
    "write a path in 'single quotes', or with /"
)
VALUES = 'texts, also with a unit, in quotation marks, as period = "0.6 s", and numbers such as 0.5'
MOST_CASE_BYTES = 2**20  # of a case file, which a person writes
MOST_DOTS = 16  # in a key; the parser's time and memory grow with their square
_PART_OF_KEY = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_DEEP = re.compile(
    rf"(?<![\w\\-]){_PART_OF_KEY}(?:[ \t]*+\.[ \t]*+{_PART_OF_KEY}){{{MOST_DOTS + 1}}}"
)
NESTED = f"is nested too deeply; allowed: tables and their keys, at most {MOST_DOTS} dots in a key"


def read_toml(path: Path, other: str | None = None) -> tuple[str, dict[str, Any]]:
    """Text and data of a TOML file, or of another text in its place.

    Raises an OSError if the file cannot be read, and a ValueError if it is no TOML.
    """
    name = plain(path.name)
    content = (
        read_input(path, MOST_CASE_BYTES) if other is None else other.encode("utf-8", "replace")
    )
    check_kind(name, content)
    try:
        text = content.decode("utf-8-sig")
        return text, toml_tables(text)
    except UnicodeDecodeError as error:
        raise ValueError(f"{name} is no TOML file in UTF-8 ({error}); save it in UTF-8") from error
    except ValueError as error:  # TOML errors, and numbers with thousands of digits
        if NESTED in str(error):
            raise ValueError(f"{name}, {error}") from error
        match = re.search(r"\(at line (\d+), column \d+\)$", str(error))
        lines = text.splitlines()
        endless = (
            n for n, entry in enumerate(lines, 1) if re.search(r"(?<![\d_])[\d_]{1000}", entry)
        )
        line = int(match[1]) if match else next(endless, len(lines))
        excerpt = lines[line - 1].strip() if 0 < line <= len(lines) else ""
        allowed = BACKSLASH if "\\" in excerpt else f"each table and each key once; {VALUES}"
        what = f"'{plain(excerpt)}' is no TOML file's text ({plain(error)}); allowed: {allowed}"
        raise ValueError(f"{name}, line {line}: {what}") from error


def toml_tables(text: str) -> dict[str, Any]:
    """Data of a text; raises a ValueError if it is no TOML, or takes too much work to read."""
    if deep := _DEEP.search(text):
        raise ValueError(f"line {text.count(chr(10), 0, deep.start()) + 1}: a key {NESTED}")
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ValueError(f"a value {NESTED}") from error
