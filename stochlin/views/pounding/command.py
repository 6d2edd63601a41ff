"""The command ``stochlin pound``: the pounding of a case file, printed and drawn."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stochlin.views.shared.screen import (
    COMMANDS,
    FILE,
    PICTURES,
    bad_input,
    check_target,
    data_target,
    lines,
    progress_bar,
    show,
    write,
)

if TYPE_CHECKING:
    from stochlin.applications.cases.reading.case import Case

TABLES = (".nc",)


@COMMANDS.register("pound")
@click.command()
@click.argument("case", type=FILE)
@click.option(
    "--out",
    type=FILE,
    help="Save histories and impacts as .nc, one file for each record. For many motions, save one "
    "table as .nc, or as .csv with one row for each motion.",
)
@click.option(
    "--picture",
    type=FILE,
    help="Draw the histories, or how often peaks are exceeded in many motions, as .png, .svg or .pdf, "
    "and save the data beside the picture.",
)
@click.option(
    "--motions",
    type=click.IntRange(min=2),
    help="Simulate this number of motions of the site in place of its records, and print one table of "
    "their results.",
)
@click.option(
    "--steps-per-contact",
    type=int,
    default=16,
    show_default=True,
    help="Time steps in half a period of the contact, 4 to 4096. All time steps become shorter with it; "
    "the error falls with its square.",
)
def pound(
    case: Path, out: Path | None, picture: Path | None, motions: int | None, steps_per_contact: int
) -> None:
    """Compute the impacts of neighbouring buildings in a recorded motion, or in many motions.

    CASE is a file like that of 'stochlin gap --example', with one record or more, the mass of every
    building, the existing gaps, and the contacts between the buildings. Rows of more than two buildings,
    one building alone, which has no gaps, and buildings described by their storeys are allowed. Six or
    more records are shown together in one table with means and quantiles, and so are simulated motions.

    \b
    Examples:
      stochlin gap --example > case.toml
      stochlin gap --example-record > record.at2
      stochlin pound case.toml
      stochlin pound case.toml --picture pound.png
      stochlin pound case.toml --out pound.nc
      stochlin pound case.toml --motions 100 --picture pound.png --out pound.csv
    """
    with bad_input():
        from stochlin.applications.cases.pounding import pound_case
        from stochlin.applications.cases.reading.case import read_case
        from stochlin.applications.cases.shaking import MOST_RECORDS
        from stochlin.views.pounding.pictures import draw_pound
        from stochlin.views.pounding.words import answer_sections

        described = read_case(case)
        if motions is not None or len(described.site.records) > MOST_RECORDS:
            _together(described, motions, out, picture, steps_per_contact)
            return
        data = out if out or not picture else picture.with_suffix(TABLES[0])
        drawn = _by_record("--picture", picture, PICTURES, described)
        saved = _by_record("--out" if out else "--picture", data, TABLES, described)
        with progress_bar("pounding") as progress:
            tables = pound_case(described, progress, steps_per_contact=steps_per_contact)
        show(lines(answer_sections(described, tables)))
        for record, table in tables.items():
            write(table, saved.get(record), drawn.get(record), draw_pound)


def _together(
    case: Case, motions: int | None, out: Path | None, picture: Path | None, steps_per_contact: int
) -> None:
    """Show and save the results of many motions."""
    from stochlin.applications.cases.pounding import by_motion, pound_motions
    from stochlin.solver.tables.storage import CSV, FORMATS
    from stochlin.views.pounding.pictures import draw_ensemble
    from stochlin.views.pounding.words import ensemble_sections

    data = data_target(out, picture, FORMATS, case.files)
    with progress_bar("pounding") as progress:
        table = pound_motions(case, motions, progress, steps_per_contact=steps_per_contact)
    show(lines(ensemble_sections(case, table)))
    sheet = data is not None and data.suffix.lower() == CSV
    write(by_motion(table) if sheet else table, data, None, draw_ensemble)
    write(table, None, picture, draw_ensemble)


def _by_record(option: str, path: Path | None, allowed: Sequence[str], case: Case) -> dict[str, Path]:
    """The file of each record: the one that is asked for, or, of several, one with its number."""
    if path is None:
        return {}
    records = list(case.site.records)
    named = {r: path.with_name(f"{path.stem}-{n}{path.suffix}") for n, r in enumerate(records, 1)}
    if len(records) == 1:
        named = {records[0]: path}
    for target in named.values():
        check_target(option, target, allowed, case.files)
    return named
