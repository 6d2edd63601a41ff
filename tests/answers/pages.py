"""What the pages of `docs` take from the code: keys of case files, the reference, files shown.

Each stands in its page between two marks, ``<!-- keys: site -->`` and ``<!-- end of keys -->``, and
the page is committed with it, so that any viewer shows it. The words around the marks are written
by hand.
"""

import inspect
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import MISSING
from pathlib import Path
from typing import NamedTuple

from answers.frozen import HERE

import stochlin as sl
from stochlin.applications.cases.reading.case import forms_of
from stochlin.applications.cases.reading.tables import NO_TABLE, Form

DOCS = HERE.parents[1] / "docs"
MARKED = re.compile(r"<!-- (keys|names|file): (.+?) -->\n(.*?)<!-- end of \1 -->", re.DOTALL)
WIDTH = 88  # of a signature, which the column of the site has room for
PACKAGE = Path(sl.__file__).parent
PASSED_ON = re.compile(r"\bimport (\w+) as \1$|^    (\w+) as \2,$", re.MULTILINE)
ABBREVIATED = ("eq.", "eqs.", "Eq.", "Eqs.")  # a sentence does not end there
OF_CODE = re.compile(r"``(.+?)``|:\w+:`(.+?)`|(?<!`)`~?(.+?)`(?!`)")


class Block(NamedTuple):
    """A part of a page that the code determines."""

    page: Path
    line: int
    what: str
    shown: str
    now: str


def blocks() -> Iterator[Block]:
    """All of them, in the order of the pages."""
    for page in sorted(DOCS.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        for mark in MARKED.finditer(text):
            line = text.count("\n", 0, mark.start()) + 1
            yield Block(page, line, f"{mark[1]}: {mark[2]}", mark[3], _made(mark[1], mark[2]))


def rewritten() -> Iterator[str]:
    """Write the parts that are stale; a line for each page."""
    for page in sorted({block.page for block in blocks() if block.shown != block.now}):
        text = page.read_text(encoding="utf-8")
        page.write_text(MARKED.sub(_with_marks, text), encoding="utf-8")
        yield f"{page.relative_to(DOCS.parent)}: written"


def _with_marks(mark: re.Match[str]) -> str:
    return f"<!-- {mark[1]}: {mark[2]} -->\n{_made(mark[1], mark[2])}<!-- end of {mark[1]} -->"


def _made(kind: str, name: str) -> str:
    makers: dict[str, Callable[[str], str]] = {"keys": keys, "names": names, "file": shown_file}
    return f"\n{makers[kind](name)}\n\n"


def shown_file(name: str) -> str:
    """A file of `docs`, as it lies there."""
    file = DOCS / name
    return f"```{file.suffix[1:]}\n{file.read_text(encoding='utf-8').rstrip()}\n```"


# --- Keys of case files
# -------------------------------------------------------------------------------


def keys(name: str) -> str:
    """The table of keys of a table of case files; if it has several forms, with what each is of."""
    each = {form: form.keys(NO_TABLE) for form in forms_of(name)}
    known = {key: entry for of_form in reversed(each.values()) for key, entry in of_form.items()}
    several = len(each) > 1
    heads = ["key", "what it is", "allowed", "if it is missing"] + ["of"] * several
    rows = [heads, ["---"] * len(heads)]
    for key in dict.fromkeys(key for of_form in each.values() for key in of_form):
        default = known[key].default
        unset = isinstance(default, Form) or default in (None, MISSING, (), "")
        usual = "" if unset else f"`{str(default).lower()}`"
        having = [form for form in each if key in each[form]]
        of = ["all" if len(having) == len(each) else "; ".join(map(_called, having))] * several
        rows.append([f"`{key}`", known[key].about, known[key].kind.words, usual, *of])
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _called(form: type) -> str:
    name = re.split("[.,;]", form.__doc__ or "")[0]
    return name[:1].lower() + name[1:]


# --- The reference
# ------------------------------------------------------------------------------------


def sections() -> dict[str, list[str]]:
    """Public names by the headings of `stochlin/__init__.pyi`; a submodule's in its place."""
    stub = (PACKAGE / "__init__.pyi").read_text(encoding="utf-8")
    _, *parts = re.split(r"^# (.*)\n", stub, flags=re.MULTILINE)
    return dict(zip(parts[::2], map(_names_in, parts[1::2]), strict=True))


def _names_in(text: str) -> list[str]:
    listed: list[str] = []
    for name in (first or second for first, second in PASSED_ON.findall(text)):
        file = PACKAGE / f"{name}.py"
        inner = _names_in(file.read_text(encoding="utf-8")) if file.exists() else []
        listed += [f"{name}.{each}" for each in inner if not each.isupper()] or [name]
    return listed


def names(section: str) -> str:
    """Signature and first sentence of each public name of a section, below a heading of its own."""
    return "\n\n".join(map(_entry, sections()[section]))


def _entry(name: str) -> str:
    public: object = sl
    for part in name.split("."):
        public = getattr(public, part)
    return f"### {name}\n\n```text\n{signature(name, public)}\n```\n\n{first_sentence(public)}"


def signature(name: str, public: object) -> str:
    """Parameters and defaults; the types stand in the docstring, in words."""
    if isinstance(public, type) and issubclass(public, Warning):
        return name
    assert callable(public)
    arguments = inspect.signature(public).parameters.values()
    plain = [each.replace(annotation=inspect.Parameter.empty) for each in arguments]
    written = f"{name}{inspect.Signature(plain)}"
    return textwrap.fill(
        written, WIDTH, subsequent_indent=" " * (len(name) + 1), break_on_hyphens=False
    )


def first_sentence(public: object) -> str:
    """Of the docstring, with code as Markdown marks it."""
    paragraph = " ".join(inspect.cleandoc(public.__doc__ or "").partition("\n\n")[0].split())
    text = OF_CODE.sub(lambda code: f"`{code[1] or code[2] or code[3]}`", paragraph)
    ends = (end.end() for end in re.finditer(r"\.(?= [A-Z])", text))
    return text[: next((end for end in ends if not text[:end].endswith(ABBREVIATED)), len(text))]
