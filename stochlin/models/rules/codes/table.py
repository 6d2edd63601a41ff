"""The separation rules of `national.toml`, with their formulas."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from importlib.resources import files
from typing import Any

from stochlin.models.rules.codes import CODE_RULES, CodeRule, Number, formulas
from stochlin.models.rules.published import publish


def _read(name: str, row: dict[str, Any]) -> CodeRule:
    """A rule from its row of the table."""
    row = {key: tuple(value) if isinstance(value, list) else value for key, value in row.items()}
    row["of_pairs"] = tuple(PAIRS[pair] for pair in row.pop("pairs", ()))
    if "number" in row:
        row["number"] = Number(**row["number"])
    named = {key: getattr(formulas, row.pop(key)) for key in ("gap_of", "line_of") if key in row}
    return CodeRule(name=name, **named, **row)


TABLE = tomllib.loads(files(__package__).joinpath("national.toml").read_text(encoding="utf-8"))
PAIRS: Mapping[str, str] = TABLE.pop("pairs")
for place, (name, row) in enumerate(TABLE.items()):
    publish(CODE_RULES, _read(name, row), place)
