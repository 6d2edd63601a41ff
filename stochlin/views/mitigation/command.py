"""The command ``stochlin mitigate``: measures against pounding of a case file, compared."""

from __future__ import annotations

from pathlib import Path

import click

from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE_PATH,
    bad_input,
    check_target,
    lines,
    show,
    write,
)


@COMMANDS.register("mitigate")
@click.command()
@click.argument("case", type=FILE_PATH)
@click.option(
    "--out", type=FILE_PATH, help="Save the table as .nc, or as .csv without the devices."
)
@quiet_option
def mitigate(case: Path, out: Path | None) -> None:
    """Compare links and added damping against pounding, and find the least that is sufficient.

    CASE is a file like that of 'stochlin gap --example', with two buildings, the existing gap and
    the measures to compare.

    \b
    Examples:
      stochlin mitigate case.toml
      stochlin mitigate case.toml --out measures.csv
    """
    with bad_input():
        from stochlin.applications.cases.pairs import mitigate_case
        from stochlin.applications.cases.reading.case import read_case
        from stochlin.files.storage import CSV, TABLE_FORMATS
        from stochlin.views.mitigation.words import answer_sections

        described = read_case(case)
        check_target("--out", out, TABLE_FORMATS, described.files)
        with progress_bar("measures") as progress:
            table = mitigate_case(described, progress)
        show(lines(answer_sections(table, described)))
        if out is not None and out.suffix.lower() == CSV:  # a row for each measure
            table = table.drop_dims("link", errors="ignore")
        write(table, out)
