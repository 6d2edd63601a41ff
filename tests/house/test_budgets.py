"""Every room keeps within its budget of code lines, which `budgets.toml` has; so does the whole."""

import ast
import io
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

import stochlin as sl

pytestmark = pytest.mark.invariant

ROOT = Path(sl.__file__).parent
PLACE = Path(__file__).parent / "budgets.toml"
BUDGETS = tomllib.loads(PLACE.read_text(encoding="utf-8"))
ROOMS = {
    f"{floor}/{room}": budget
    for floor, rooms in BUDGETS.items()
    if isinstance(rooms, dict)
    for room, budget in rooms.items()
}
WITHOUT_CODE = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE),
    *(tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER),
}

DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def code_lines(text: str) -> int:
    """Lines on which a statement stands that is neither an import nor a docstring."""
    lines = {
        line
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type not in WITHOUT_CODE
        for line in range(token.start[0], token.end[0] + 1)
    }
    for statement in imports_and_docstrings(ast.parse(text)):
        lines.difference_update(range(statement.lineno, statement.end_lineno + 1))
    return len(lines)


def imports_and_docstrings(tree: ast.Module) -> Iterator[ast.stmt]:
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node
        elif isinstance(node, DOCUMENTED) and ast.get_docstring(node) is not None:
            yield node.body[0]


@cache
def lines_by_room() -> Counter[str]:
    """By floor and room; a room that is one file has its name, what lies beside the rooms none."""
    lines: Counter[str] = Counter()
    for path in ROOT.rglob("*.py"):
        floor, *rest = path.relative_to(ROOT).with_suffix("").parts
        room = f"{floor}/{rest[0]}" if rest and rest[0] != "__init__" else ""
        lines[room] += code_lines(path.read_text(encoding="utf-8"))
    return lines


def test_code_lines_are_those_of_statements_without_imports_docstrings_and_comments() -> None:
    text = '''"""A module."""

import ast
from io import (
    StringIO,
)

SIZE = 3  # counts


# does not count
def area(
    a, b
):
    """A formula.

    Of a rectangle.
    """

    import math

    text = """two
    lines"""
    return a * b
'''
    assert code_lines(text) == 7
    assert code_lines('"""A docstring."""\n') == code_lines("\n# nothing\n") == 0


def test_every_room_has_a_budget() -> None:
    assert set(ROOMS) == set(lines_by_room()) - {""}


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_keeps_within_its_budget(room: str) -> None:
    assert lines_by_room()[room] <= ROOMS[room], (
        f"stochlin/{room} has {lines_by_room()[room]} lines of code, its budget is {ROOMS[room]}: "
        f"write less, or ask for more in tests/house/{PLACE.name}"
    )


def test_the_whole_keeps_within_its_budget() -> None:
    lines, budget = lines_by_room().total(), BUDGETS["whole"]
    assert lines <= budget, (
        f"stochlin has {lines} lines of code, its budget is {budget}: "
        f"write less, or ask for more in tests/house/{PLACE.name}"
    )
