"""Forms and cases of the explorer: the first form with other values."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import stochlin as sl
from stochlin.analyses.cases.case import Case
from stochlin.analyses.explorer.form import Form
from stochlin.analyses.explorer.opening import first_form, opened

Table = Mapping[str, Any]
"""Values of controls by their names, in SI units, such as ``{"period": 0.7, "yields": False}``."""


def changed(form: Form, **tables: Table) -> Form:
    """The form with other values in its tables: ``changed(form, building_1={"period": 0.7})``."""
    values = {(table, name): value for table, values in tables.items() for name, value in values.items()}
    assert values.keys() <= form.values.keys(), values.keys() - form.values.keys()
    return form.changed(values)


def form_with(**tables: Table) -> Form:
    """The first form with other values in its tables."""
    return changed(first_form(), **tables)


def case_with(**tables: Table) -> Case:
    """The case of the first form with other values in its tables."""
    return form_with(**tables).case()


def opened_text(text: str, folder: Path) -> tuple[Form, list[str]]:
    """The form of the text of a case file, which is kept in the folder, and remarks on it."""
    path = folder / "case.toml"
    path.write_text(text, encoding="utf-8")
    return opened(sl.read_case(path))
