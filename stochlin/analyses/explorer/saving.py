"""A case of the explorer as a file to save: its text, the files that it names, what is not in it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from stochlin.analyses.cases.case import Case
from stochlin.analyses.cases.sites.strength import HAZARD
from stochlin.analyses.explorer.form import SPECTRA, read_again
from stochlin.analyses.tables.toml import toml_text

HEAD = """\
# A case for 'stochlin gap', saved by 'stochlin explore'. 'stochlin gap --example' explains every line.

"""


def case_text(case: Case) -> str:
    """Text of the case file of a case, with all digits of its numbers.

    Floors that are not level are not said to align, whatever the opened file says.

    Examples
    --------
    >>> from stochlin.analyses.explorer.opening import first_form
    >>> case_text(first_form().case()).splitlines()[4:7]
    ['[site]', 'ground = "firm"', 'intensity = "0.01 m^2/s^3"']
    """
    tables = dict(case.whole.values)
    if _aligned_no_more(case):
        tables["separation"] = tables["separation"] | {"floors_align": False}
    return HEAD + toml_text(tables)


def _aligned_no_more(case: Case) -> bool:
    """Whether the tables of a case say that floors align, and they do not."""
    return bool(case.whole.section("separation").read("floors_align") and not case.floors_align)


def files_named(case: Case) -> list[str]:
    """Names of the files to which a case refers, relative to its file."""
    site = case.whole.values["site"]
    names = [record["path"] for record in site.get("records", [])]
    if site.get("spectrum", SPECTRA[0]) not in SPECTRA:
        names.append(site["spectrum"])
    of_tables = (("suite", "path"), (HAZARD, "file"))
    return names + [site[table][key] for table, key in of_tables if key in site.get(table, {})]


def left_out(case: Case, file: Mapping[str, Any]) -> list[str]:
    """Remarks on parts of the opened file, by its tables, that do not fit the case any more."""
    remarks, tables = [], dict(case.whole.values)
    if "measures" in file and "measures" not in tables:
        try:
            read_again(tables | {"measures": file["measures"]}, case.inputs[0], case.of_site.known)
        except ValueError as error:
            remarks.append(
                f"The measures of the file are left out; they do not fit the buildings: {error}."
            )
    if "suite" in file.get("site", {}) and "suite" not in tables["site"]:
        remarks.append(
            "The suite of records is left out; it is scaled to a spectrum, which the site lacks."
        )
    if _aligned_no_more(case):
        slab = case.slabs_on_columns[0]
        remarks.append(f"The saved file says floors_align = false, since {slab}.")
    return remarks
