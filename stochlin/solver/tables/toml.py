"""TOML files, read as data and written; errors state the line."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from stochlin.messages import LONGEST, plain
from stochlin.solver.tables.inputs import read_input

BACKSLASH = (
    "a backslash begins a special sign in \"double quotes\": write a path in 'single quotes', or with /"
)
_NAME = re.compile(r"\s*(\[++[^]]*+\]+|[^=\[]+=)")  # a table, or a key with its equals sign
_CURES = {  # of lines that are no TOML, by how they are written: what to do
    r'"[^"]*\\': BACKSLASH,
    r"=\s*[-+]?\d+,\d": 'write a decimal point, and a unit within quotation marks: "1.0 s"',
    r"=\s*[-+]?\.\d": "write a digit before the decimal point, such as 0.5",
    "": 'a value with a unit and any other text stand in quotation marks, such as period = "0.6 s"',
}
_BARE = re.compile(r"[A-Za-z0-9_-]+")
MOST_BYTES = 2**20  # of a case file, which a person writes
MOST_DOTS = 16  # in a key; the parser's time and memory grow with their square
_PART = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_DEEP = re.compile(rf"(?<![\w\\-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MOST_DOTS + 1}}}")
NESTED = f"is nested too deeply; allowed: tables and their keys, at most {MOST_DOTS} dots in a key"


def read_toml(path: Path, other: str | None = None) -> tuple[str, dict[str, Any]]:
    """Text and data of a TOML file, or of another text in its place.

    Raises an OSError if the file cannot be read, and a ValueError if it is no TOML.
    """
    name = plain(path.name)
    content = read_input(path, MOST_BYTES) if other is None else other.encode("utf-8", "replace")
    try:
        text = content.decode("utf-8-sig")
        return text, toml_tables(text)
    except UnicodeDecodeError as error:
        raise ValueError(
            f"{name} is no TOML file: it is not text in UTF-8 ({error}); save it as such"
        ) from error
    except ValueError as error:  # TOML errors, and numbers with thousands of digits
        if NESTED in str(error):
            raise ValueError(f"{name}, {error}") from error
        match, lines = re.search(r"\(at line (\d+), column \d+\)$", str(error)), text.splitlines()
        endless = (n for n, entry in enumerate(lines, 1) if re.search(r"(?<![\d_])[\d_]{1000}", entry))
        line = int(match[1]) if match else next(endless, len(lines))
        excerpt = lines[line - 1].strip() if 0 < line <= len(lines) else ""
        if len(excerpt) > LONGEST:  # the mistake is often at its end
            excerpt = f"{excerpt[: LONGEST // 2 - 3]}...{excerpt[-LONGEST // 2 :]}"
        if re.search("twice|overwrite|mutate|redefine|Duplicate", str(error)):
            raise ValueError(f"{name}, line {line}: {_twice(lines, line, str(error))}") from error
        cure = next(advice for pattern, advice in _CURES.items() if re.search(pattern, excerpt))
        raise ValueError(
            f"{name}, line {line}: '{plain(excerpt)}' is no TOML file's text ({plain(error)}); {cure}"
        ) from error


def toml_tables(text: str) -> dict[str, Any]:
    """Data of a text; raises a ValueError if it is no TOML, or takes too much work to read."""
    if deep := _DEEP.search(text):
        raise ValueError(f"line {text.count(chr(10), 0, deep.start()) + 1}: a key {NESTED}")
    try:
        return tomllib.loads(text)
    except RecursionError as error:
        raise ValueError(f"a value {NESTED}") from error


def toml_text(values: Mapping[str, Any]) -> str:
    """Text of a TOML file with these tables, with all digits of their numbers."""
    return "\n".join(_lines(values, "")) + "\n"


def _lines(values: Mapping[str, Any], place: str) -> Iterator[str]:
    """Lines of a table: its keys, and then the tables in it."""
    within = {key: value for key, value in values.items() if _tables(value)}
    yield from (f"{_key(key)} = {_value(value)}" for key, value in values.items() if key not in within)
    for key, value in within.items():
        name = f"{place}{_key(key)}"
        for table in _tables(value):
            if isinstance(value, list):
                yield from ("", f"[[{name}]]")
            elif not table or not all(map(_tables, table.values())):  # a table of tables needs no line
                yield from ("", f"[{name}]")
            yield from _lines(table, f"{name}.")


def _tables(value: Any) -> list[Mapping[str, Any]]:
    """The tables that a value of a TOML file consists of; none for any other value."""
    tables = value if isinstance(value, list) else [value]
    return tables if all(isinstance(table, dict) for table in tables) else []


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else _value(name)


def _value(value: Any) -> str:
    """Text of a value; texts and truth values are written as in JSON."""
    if isinstance(value, list):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, (str, bool)):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    return repr(value)


def _twice(lines: Sequence[str], number: int, error: str) -> str:
    """Message on a table or a key that is there twice; ``error`` is that of the parser."""
    names = [match[1].strip(" \t=") if (match := _NAME.match(line)) else "" for line in lines]
    name, first = names[number - 1], 1 + names.index(names[number - 1])
    if within := re.search(r"namespace \('(\w+)',\)|table key '(\w+)'", error):  # in braces
        name, first = within[1] or within[2], number
    where = f" in line {first}" if first < number or within else ""
    return (
        f"'{plain(name)}' is already given{where}; allowed: each table and each key once, so leave one "
        "out, or give it another name"
    )
