"""`make answers`: rerun the cases, or those that are named, write down what moved and show it.

The pages of `docs` follow: the manual, and what the others take from the code.
"""

import json
import shutil
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from answers.frozen import (
    CASES,
    EXPECTED,
    FROZEN,
    INDEPENDENT,
    Case,
    differences,
    independent,
    moved_independent,
    run,
)
from answers.manual import PAGE, page
from answers.pages import rewritten as rewritten_pages


def main(names: list[str]) -> None:
    """Files of cases that have not moved stay untouched, whatever their rounding."""
    lines = [line for name in names or CASES for line in rewritten(Case.named(name))]
    text = page()
    if not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text:
        PAGE.write_text(text, encoding="utf-8")
        lines.append(f"{PAGE.name}: written")
    lines += rewritten_pages()
    print("\n".join(lines or ["Nothing moved: no file was written."]))


def rewritten(case: Case) -> Iterator[str]:
    """What moved in a case, after it is written; what did not is counted on standard error."""
    with tempfile.TemporaryDirectory() as scratch:
        results = run(case, Path(scratch))
        changes = list(differences(case, results))
        moved = [each for each in changes if each.moved]
        most = max((each.relative for each in changes), default=0.0)
        print(f"{case.folder.name}: {len(moved)} moved, largest change {most:.1e}", file=sys.stderr)
        if moved:
            shutil.rmtree(case.folder / EXPECTED, ignore_errors=True)
            shutil.copytree(results, case.folder / EXPECTED)
            yield from (f"{case.folder.name}: {each}" for each in moved)
    if (case.folder / INDEPENDENT).exists():
        yield from _independently(case)


def _independently(case: Case) -> Iterator[str]:
    try:
        now = independent(case)
    except ImportError as error:
        print(f"{case.folder.name}: not recalculated, {error}", file=sys.stderr)
        return
    if (case.folder / FROZEN).exists() and not moved_independent(case, now):
        return
    (case.folder / FROZEN).write_text(json.dumps(now, indent=1) + "\n", encoding="utf-8")
    yield f"{case.folder.name}: the independent answer is written"


if __name__ == "__main__":
    main(sys.argv[1:])
