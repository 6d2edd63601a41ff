"""`make mutants SEED=1`: the share of random changes of the code that its nearest tests catch.

A mutant is the package with one small change: of an operator, a comparison, a number, a sign, `and`
to `or`, `min` to `max`, or a condition negated. The places are drawn from all kernels, the solver
and its applications. Each mutant is written into a copy of the repository in a temporary folder,
where the nearest tests run until one fails: the examples of the mutated module, the tests that
import it, those with its name, and the others of its room, of a room with its name, and, where no
test imports it, of the rooms that do. A survivor is a hole in the tests, or a change without
effect, as of a tolerance or the size of a chunk.

At the end, the tests that caught a mutant run on the unchanged copy, where they have to pass. Each
copy compiles the kernels that its tests call. 60 mutants take an hour on a free core.
"""

import ast
import os
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from house.test_rooms_and_names import imports

ROOT = Path(__file__).parents[2]
MODULES = sorted(
    path
    for floor in ("kernels", "solver", "applications")
    for path in (ROOT / "stochlin" / floor).rglob("*.py")
)
TESTS = sorted(ROOT.glob("tests/**/test_*.py"))
COUNT = 60
LIMIT = 180  # seconds for one test, compilation included; one that takes longer hangs
MEMORY = 12 << 30  # bytes of data of one process; of addresses, a browser needs more
SURVIVED, MISUSED = (
    (0, 5),
    4,
)  # exit statuses of pytest: all pass, or there is no test; wrong arguments
NOT_COPIED = (".git", ".venv", "build", "dist", ".*_cache", ".hypothesis")


def both_ways(*pairs: tuple[Any, Any]) -> dict[Any, Any]:
    return dict(pairs) | {other: first for first, other in pairs}


OPERATORS = {
    **both_ways(
        (ast.Add, ast.Sub), (ast.Mult, ast.Div), (ast.BitAnd, ast.BitOr), (ast.And, ast.Or)
    ),
    **{ast.Pow: ast.Mult, ast.FloorDiv: ast.Mult, ast.Mod: ast.FloorDiv},
}
BOUNDS = both_ways((ast.Lt, ast.LtE), (ast.Gt, ast.GtE))
SENSES = both_ways((ast.Lt, ast.Gt), (ast.LtE, ast.GtE), (ast.Eq, ast.NotEq)) | both_ways(
    (ast.Is, ast.IsNot), (ast.In, ast.NotIn)
)
EXTREMES = both_ways(
    *((f"{of}min{end}", f"{of}max{end}") for of in ("", "arg", "nan", "f") for end in ("", "imum"))
)


class Mutant(NamedTuple):
    """A change of one expression, or of an assignment such as ``x += y``."""

    path: Path
    node: ast.expr | ast.AugAssign
    changed: ast.AST

    def source(self) -> str:
        """The whole module with this change; `ast` counts columns in bytes."""
        lines = self.path.read_bytes().splitlines(keepends=True)
        begin = sum(map(len, lines[: self.node.lineno - 1])) + self.node.col_offset
        end = sum(map(len, lines[: self.node.end_lineno - 1])) + self.node.end_col_offset
        text, whole = ast.unparse(self.changed), b"".join(lines)
        text = text if isinstance(self.changed, ast.stmt | ast.Constant | ast.Name) else f"({text})"
        return (whole[:begin] + text.encode() + whole[end:]).decode()

    def __str__(self) -> str:
        before, after = (
            text.splitlines()[self.node.lineno - 1].strip()
            for text in (self.path.read_text(encoding="utf-8"), self.source())
        )
        return f"{self.path.relative_to(ROOT)}:{self.node.lineno}\n    {before}\n    {after}"


def changes(node: ast.AST) -> list[ast.AST]:
    """All small changes of one node, without those of its parts."""
    changed: list[ast.AST] = []
    match node:
        case ast.BinOp(left, op, right) if type(op) in OPERATORS and not is_text(left, right):
            changed = [ast.BinOp(left, OPERATORS[type(op)](), right)]
        case ast.AugAssign(target, op, value) if type(op) in OPERATORS and not is_text(value):
            changed = [ast.AugAssign(target, OPERATORS[type(op)](), value)]
        case ast.BoolOp(op, values):
            changed = [ast.BoolOp(OPERATORS[type(op)](), values)]
        case ast.Compare(left, [op, *more], right):
            others = [others[type(op)] for others in (BOUNDS, SENSES) if type(op) in others]
            changed = [ast.Compare(left, [other(), *more], right) for other in others]
        case ast.UnaryOp(ast.USub() | ast.Not() | ast.Invert(), operand):
            changed = [operand]
        case ast.Constant(int(value)) if not isinstance(value, bool):
            changed = [ast.Constant(value + 1), ast.Constant(abs(value - 1))]
        case ast.Constant(float(value)):
            changed = [ast.Constant(2 * value or 1.0), ast.Constant(value / 2 or -1.0)]
        case ast.Name(name) if name in EXTREMES:
            changed = [ast.Name(EXTREMES[name])]
        case ast.Attribute(value, name) if name in EXTREMES:
            changed = [ast.Attribute(value, EXTREMES[name])]
    return changed


def is_text(*nodes: ast.AST) -> bool:
    return any(
        isinstance(n, ast.JoinedStr) or isinstance(getattr(n, "value", 0), str) for n in nodes
    )


def places(path: Path) -> Iterator[tuple[ast.AST, list[ast.AST]]]:
    """Changeable nodes of a module, each with its changes: none in annotations and messages."""
    nodes: list[ast.AST] = [ast.parse(path.read_bytes())]
    while nodes:
        node = nodes.pop()
        warns = isinstance(node, ast.Call) and "warn" in ast.unparse(node.func)
        if warns or isinstance(node, ast.Raise | ast.JoinedStr):
            continue
        if changed := changes(node):
            yield node, changed
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            yield node.test, [ast.UnaryOp(ast.Not(), node.test)]
        annotations = [getattr(node, name, None) for name in ("annotation", "returns")]
        nodes += [part for part in ast.iter_child_nodes(node) if part not in annotations]


def draw(seed: int, count: int) -> list[Mutant]:
    """Mutants at different places, each place as likely as any other."""
    chance = random.Random(seed)
    drawn = chance.sample([(path, *place) for path in MODULES for place in places(path)], count)
    return [Mutant(path, node, chance.choice(changed)) for path, node, changed in drawn]


def nearest(path: Path) -> list[str]:
    """The mutated module, for its examples, and the files of its tests, the nearest first."""
    parts = path.relative_to(ROOT).with_suffix("").parts
    name, room = ".".join(parts), parts[2]
    importing = {test for test in TESTS if name in imports(test)}
    others = [] if importing else [module for module in MODULES if name in imports(module)]
    rooms = {*parts[2:], *(module.relative_to(ROOT).parts[2] for module in others)}
    tests = sorted(
        (test for test in TESTS if test in importing or test.parent.name in rooms),
        key=lambda test: (
            test not in importing,
            parts[-1] not in test.stem,
            test.parent.name != room,
        ),
    )
    return [str(each.relative_to(ROOT)) for each in (path, *tests)]


def run_tests(tests: list[str], mutant: Mutant | None = None) -> tuple[bool, set[str]]:
    """Whether tests in a copy fail, and which do: the first, or without a mutant all of them."""
    options = ["-rfE", "-p", "no:cacheprovider", "-o", "faulthandler_exit_on_timeout=true"]
    options += ["-m", "not slow", "-o", f"faulthandler_timeout={LIMIT}"]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / ROOT.name
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(*NOT_COPIED))
        if mutant:
            options.append("--exitfirst")
            (copy / mutant.path.relative_to(ROOT)).write_text(mutant.source(), encoding="utf-8")
        done = subprocess.run(
            [sys.executable, "-m", "pytest", *options, *tests],
            cwd=copy,
            env=os.environ
            | {"PYTHONPATH": str(copy), "OPENBLAS_NUM_THREADS": "1", "MPLBACKEND": "agg"},
            capture_output=True,
            text=True,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY)),
        )
    if done.returncode == MISUSED:
        raise RuntimeError(f"pytest did not run: {done.stdout}{done.stderr}")
    failed = re.findall(r"^(?:FAILED|ERROR) (.*?)(?: - .*)?$", done.stdout, re.MULTILINE)
    return done.returncode not in SURVIVED, set(failed)


def main(seed: int) -> None:
    survivors, catching = [], set()
    for number, mutant in enumerate(draw(seed, COUNT), start=1):
        begin = time.monotonic()
        caught, by = run_tests(nearest(mutant.path), mutant)
        catching |= by
        survivors += [] if caught else [mutant]
        how = (
            f"caught by {', '.join(by) or 'a crash, or a test that hangs'}"
            if caught
            else "SURVIVED"
        )
        print(f"{number}. {mutant}\n    {how}, {time.monotonic() - begin:.0f} s", flush=True)
    share = 1 - len(survivors) / COUNT
    print(f"\nSeed {seed}: {share:.0%} of {COUNT} mutants are caught. Survivors:")
    print(*survivors, sep="\n")
    _, wrong = run_tests(sorted(catching)) if catching else (False, set())
    if wrong:
        sys.exit(f"Without any mutant these tests fail, too: {', '.join(sorted(wrong))}")


if __name__ == "__main__":
    main(int(sys.argv[1]))
