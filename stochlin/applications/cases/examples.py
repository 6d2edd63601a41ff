"""Texts to start from: a short case file, one with all keys, and a record."""

from __future__ import annotations

from importlib.resources import files

HEADERS = {  # of tables that are not written by their name alone
    "": "the whole file",
    "site.records": "[[site.records]]",
    "building": "[building_1], [building_2] and so on",
    "measures": '[measures."A name"]',
    "measures.dampers": "dampers_1 = { } and dampers_2 = { } of a measure",
}


def short_example() -> str:
    """A case of two buildings that runs, as ``stochlin gap --example`` prints it."""
    return _text("example.toml")


def full_example() -> str:
    """All keys of all tables, each with what it is and accepts, as comments of a file."""
    from stochlin.applications.cases.reading.explained import TABLES, keys_of_table
    from stochlin.applications.cases.reading.kinds import Inner

    lines = []
    for name in TABLES:
        lines += ["", f"# {HEADERS.get(name, f'[{name}]')}"]
        for row in keys_of_table(name):
            if not isinstance(row.key.kind, Inner):
                written = f"# {row.name} = {row.example}"
                lines.append(f"{written.ljust(40)} # {row.key.about}: {row.key.kind.words}")
    return "\n".join(lines[1:]) + "\n"


def example_record() -> str:
    """Text of an example of a record, a PEER AT2 file, as ``stochlin gap --example-record`` prints it.

    It is synthetic: ``simulated_motions(named_ground("firm", 0.01), 20.0, AminAng(4.0, 15.0, 0.35),
    paths=2)[0]``, written in g: a motion of the site of `short_example`.
    """
    return _text("example_record.at2")


def printed(which: str) -> str:
    """The text of "short", "full" or "record"."""
    return {"short": short_example, "full": full_example}.get(which, example_record)()


def _text(name: str) -> str:
    return files("stochlin.applications.cases").joinpath(name).read_text(encoding="utf-8")
