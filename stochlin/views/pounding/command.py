"""The command ``stochlin pound``: the pounding of a case file, printed and drawn."""

from __future__ import annotations

from pathlib import Path

import click

from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE_PATH,
    bad_input,
    data_target,
    lines,
    show,
    write,
)


@COMMANDS.register("pound")
@click.command()
@click.argument("case", type=FILE_PATH)
@click.option(
    "--out",
    type=FILE_PATH,
    help="Save the histories and impacts in one record, or the results of each of several motions, "
    "as .nc.",
)
@click.option(
    "--picture",
    type=FILE_PATH,
    help="Draw the histories, or how often peaks are exceeded in many motions, as .png, .svg or "
    ".pdf, and save the data beside the picture.",
)
@click.option(
    "--motions",
    type=click.IntRange(min=2),
    help="Simulate this number of motions of the site in place of its records, and print one table "
    "of their results.",
)
@click.option(
    "--steps-per-contact",
    type=int,
    default=16,
    show_default=True,
    help="Time steps in half a period of the contact, 4 to 4096. All time steps become shorter "
    "with it; the error falls with its square.",
)
@quiet_option
def pound(
    case: Path, out: Path | None, picture: Path | None, motions: int | None, steps_per_contact: int
) -> None:
    """Compute the impacts of neighbouring buildings in a recorded motion, or in many motions.

    CASE is a file like that of 'stochlin gap --example', with one record or more, the mass of every
    building, the existing gaps, and the contacts between the buildings. Rows of more than two
    buildings, one building alone, which has no gaps, and buildings described by their storeys are
    allowed. Two or more records are shown together in one table with means and quantiles, and so
    are simulated motions.

    \b
    Examples:
      stochlin gap --example > case.toml
      stochlin gap --example-record > record.at2
      stochlin pound case.toml
      stochlin pound case.toml --picture pound.png
      stochlin pound case.toml --out pound.nc
      stochlin pound case.toml --motions 100 --picture pound.png --out pound.nc
    """
    with bad_input():
        from stochlin.applications.cases.pounding import pound_case
        from stochlin.applications.cases.reading.case import read_case
        from stochlin.views.pounding.pictures import draw_pound
        from stochlin.views.pounding.words import answer_sections

        described = read_case(case)
        data = data_target(out, picture, (".nc",), described.files)
        with progress_bar("pounding") as progress:
            table = pound_case(described, motions, progress, steps_per_contact=steps_per_contact)
        show(lines(answer_sections(described, table)))
        write(table, data, picture, draw_pound)
