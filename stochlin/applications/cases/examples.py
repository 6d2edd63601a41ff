"""Texts to start from: a short case file, all keys, and a record."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.resources import files

from stochlin.applications.cases.reading.case import WholeCase
from stochlin.applications.cases.reading.kinds import Inner, Key
from stochlin.applications.cases.reading.tables import NO_TABLE, Form


def short_example() -> str:
    """A case of two buildings that runs, as ``stochlin gap --example`` prints it."""
    return _text("example.toml")


def full_example() -> str:
    """All keys of all tables, each with what it is and what is allowed, as comments of a file."""
    return "".join(_keys_of("", "", [WholeCase]))


def _keys_of(name: str, header: str, forms: Sequence[type[Form]]) -> Iterator[str]:
    """The lines of a table, and those of the tables in it."""
    yield header
    keys: dict[str, Key] = {}
    for form in forms:  # the first one says what a key is
        keys = {**keys, **form.keys(NO_TABLE), **keys}
    for key, (kind, about, _) in keys.items():
        if not isinstance(kind, Inner):
            yield f"# {key:<22} {about}: {kind.words}\n"
    for key, (kind, *_) in keys.items():
        if isinstance(kind, Inner) and key != "building_2":  # which has the keys of the first one
            path = f"{name}.{key}".lstrip(".")
            header = f"\n# [[{path}]]\n" if kind.several else f"\n# [{path}]\n"
            yield from _keys_of(path, header, kind.forms)


def example_record() -> str:
    """Text of an example record, a PEER AT2 file, as ``stochlin gap --example-record`` prints it.

    It is synthetic: ``simulated_motions(named_ground("firm", 0.01), 20.0, AminAng(4.0, 15.0, 0.35),
    paths=2)[0]``, written in g: a motion of the site of `short_example`.
    """
    return _text("example_record.at2")


def _text(name: str) -> str:
    return files("stochlin.applications.cases").joinpath(name).read_text(encoding="utf-8")
