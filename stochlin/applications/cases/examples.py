"""Texts to start from: a short case file, and a record."""

from __future__ import annotations

from importlib.resources import files


def short_example() -> str:
    """A case of two buildings that runs, as ``stochlin gap --example`` prints it."""
    return _text("example.toml")


def example_record() -> str:
    """Text of an example of a record, a PEER AT2 file, as ``stochlin gap --example-record`` prints it.

    It is synthetic: ``simulated_motions(named_ground("firm", 0.01), 20.0, AminAng(4.0, 15.0, 0.35),
    paths=2)[0]``, written in g: a motion of the site of `short_example`.
    """
    return _text("example_record.at2")


def _text(name: str) -> str:
    return files("stochlin.applications.cases").joinpath(name).read_text(encoding="utf-8")
