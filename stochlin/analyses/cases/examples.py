"""Texts of an example case file and of an example record."""

from __future__ import annotations

import re
from importlib.resources import files

from stochlin.analyses.cases.files.schema import keys_at


def example_case() -> str:
    """Text of an example case file, TOML with comments, as ``stochlin gap --example`` prints it."""
    parts = re.split(r"(?m)^(?=\[)", _example("example_case.toml"))
    return "".join(_with_other_keys(part) for part in parts)


def example_record() -> str:
    """Text of an example of a record, a PEER AT2 file, as ``stochlin gap --example-record`` prints it.

    It is synthetic: ``simulated_motions(named_ground("firm", 0.01), 20.0, AminAng(4.0, 15.0, 0.35),
    paths=2)[0]``, written in g: a motion of the site of `example_case`.
    """
    return _example("example_record.at2")


def _with_other_keys(part: str) -> str:
    """A table of the example with a line for each key of the schema that its text does not explain."""
    header = re.match(r"\[([\w.]+)\]", part)
    keys = keys_at((header[1],)) if header and header[1] != "building_2" else {}
    said = {name for name in keys if re.search(rf"\b{name}\b", part)}
    lines = [
        f"# {name} = {key.example}".ljust(32) + f"# {key.label}"
        for name, key in keys.items()
        if name not in said
    ]
    text = part.rstrip("\n")
    return "\n".join([text, *lines]) + part[len(text) :]


def _example(name: str) -> str:
    return files("stochlin.analyses.cases").joinpath(name).read_text(encoding="utf-8")
