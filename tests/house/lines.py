"""Prints the package's lines of code, modules and public names for `make check`; judges nothing."""

import ast
import io
import tokenize
from collections.abc import Iterator
from pathlib import Path

import stochlin as sl

ROOT = Path(sl.__file__).parent
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


if __name__ == "__main__":
    modules = sorted(ROOT.rglob("*.py"))
    lines = sum(code_lines(path.read_text(encoding="utf-8")) for path in modules)
    subjects = sum(path.name != "__init__.py" for path in modules)
    print(f"{lines} lines, {subjects} modules, {len(sl.__all__)} public names")  # noqa: T201
