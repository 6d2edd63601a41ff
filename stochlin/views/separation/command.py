"""The command ``stochlin gap``: a case file in, one table and a page out."""

from __future__ import annotations

from pathlib import Path

import click

from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE_PATH,
    bad_input,
    check_target,
    data_target,
    lines,
    show,
    write,
)

REPORTS = (".html", ".htm")
MORE = "'--details' adds the shaking, drifts, all other rules and the notes on them."


@COMMANDS.register("gap")
@click.command()
@click.argument("case", required=False, type=FILE_PATH)
@click.option(
    "--report", type=FILE_PATH, help="Write a page with the table and pictures, as .html."
)
@click.option(
    "--out",
    type=FILE_PATH,
    help="Save the table, as .nc (everything) or .csv (one row for each rule).",
)
@click.option(
    "--picture",
    type=FILE_PATH,
    help="Draw the buildings to scale with the gaps and how often they are enough, as .png, .svg "
    "or .pdf, and save the data beside the picture.",
)
@click.option(
    "--details",
    is_flag=True,
    help="Also print the shaking, drifts, all other rules and notes on them.",
)
@click.option(
    "--example",
    is_flag=False,
    flag_value="short",
    type=click.Choice(["short", "full"]),
    help="Print a case file to start from, and stop; with 'full' all its keys.",
)
@click.option(
    "--example-record",
    is_flag=True,
    help="Print a synthetic record to try, a PEER AT2 file, and stop.",
)
@quiet_option
def gap(
    case: Path | None,
    report: Path | None,
    out: Path | None,
    picture: Path | None,
    details: bool,
    example: str | None,
    example_record: bool,
) -> None:
    """Compute the gap that two buildings need, by simulation, formulas and your building codes.

    CASE is a file that describes the site, the motion and the buildings. With one building, the
    command computes its set-back from the property line.

    \b
    Examples:
      stochlin gap --example > case.toml
      stochlin gap --example full
      stochlin gap --example-record > record.at2
      stochlin gap case.toml
      stochlin gap case.toml --details
      stochlin gap case.toml --report gap.html --out gap.nc
      stochlin gap case.toml --picture gap.png
    """
    with bad_input():
        if example or example_record:
            from stochlin.applications.cases import examples

            of = {"short": examples.short_example, "full": examples.full_example}
            click.echo(of.get(str(example), examples.example_record)(), nl=False)
            return
        if case is None:
            raise ValueError("CASE is missing; 'stochlin gap --example > case.toml' writes a file")
        from stochlin.applications.cases.reading.case import read_case
        from stochlin.applications.cases.separation import answer_case
        from stochlin.files.storage import CSV, TABLE_FORMATS, whole_file
        from stochlin.views.separation.pictures import elevation_figure
        from stochlin.views.separation.report import answer_sections, report_page

        described = read_case(case)
        check_target("--report", report, REPORTS, described.files)
        data = data_target(out, picture, TABLE_FORMATS, described.files)
        with progress_bar("simulating") as progress:
            answer = answer_case(described, progress)
        page = report_page(answer) if report else ""
        show([*lines(answer_sections(answer), details), *([] if details else ["", MORE])])
        table = answer.table(samples=data is not None and data.suffix.lower() != CSV)
        write(table, data, picture, lambda _: elevation_figure(answer))
        if report is not None:
            with whole_file(report) as temporary:
                temporary.write_text(page, encoding="utf-8")
            click.echo(f"saved {report}")
