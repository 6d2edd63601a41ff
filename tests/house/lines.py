"""Lines, modules and public names, now and as `budgets.toml` has them; `make check` prints both."""

import ast
import io
import tokenize
import tomllib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import stochlin as sl

ROOT = Path(sl.__file__).parent
BUDGETS = Path(__file__).with_name("budgets.toml")
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


def sizes() -> Counter[str]:
    """Lines by floor and module of the house; those of all, modules and public names."""
    counts: Counter[str] = Counter()
    for path in ROOT.rglob("*.py"):
        floor, *rest = path.relative_to(ROOT).with_suffix("").parts
        lines = code_lines(path.read_text(encoding="utf-8"))
        counts["whole lines"] += lines
        counts["whole modules"] += path.name != "__init__.py"
        if rest and rest[0] != "__init__":
            counts[f"{floor} {rest[0]}"] += lines
    counts["whole names"] = len(sl.__all__)
    return counts


def budgets(text: str) -> dict[str, tuple[int, int]]:
    """Aim and size by floor and module."""
    floors: dict[str, dict[str, Any]] = tomllib.loads(text)
    return {
        f"{floor} {room}": tuple(numbers)
        for floor, rooms in floors.items()
        for room, numbers in rooms.items()
    }


if __name__ == "__main__":
    now, written = sizes(), budgets(BUDGETS.read_text(encoding="utf-8"))
    for name in ("whole lines", "whole modules", "whole names"):
        aim, before = written[name]
        print(f"{name.split()[1]}: {before} before, {now[name]} now, {aim} is the aim")  # noqa: T201
