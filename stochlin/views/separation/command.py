"""The command ``stochlin gap``: a case file in, one table and a page out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stochlin.views.shared.screen import (
    COMMANDS,
    FILE,
    bad_input,
    check_target,
    paragraph,
    progress_bar,
    show,
)

if TYPE_CHECKING:
    from stochlin.analyses.cases.separation import CaseAnswer

REPORTS = (".html", ".htm")


@COMMANDS.register("gap")
@click.command()
@click.argument("case", required=False, type=FILE)
@click.option("--report", type=FILE, help="Write a page with table and pictures, .html.")
@click.option("--out", type=FILE, help="Save the table, .nc (everything) or .csv (a row a rule).")
@click.option("--example", is_flag=True, help="Print a case file to start from, and stop.")
def gap(case: Path | None, report: Path | None, out: Path | None, example: bool) -> None:
    """How far apart two buildings must stand, by simulation and by every rule.

    CASE is a file that describes the site, the motion and the buildings.

    \b
    Examples:
      stochlin gap --example > case.toml
      stochlin gap case.toml
      stochlin gap case.toml --report gap.html --out gap.nc
    """
    with bad_input():
        if example:
            from stochlin.analyses.cases.case import example_case

            click.echo(example_case(), nl=False)
            return
        if case is None:
            raise ValueError(
                "CASE is missing; 'stochlin gap --example > case.toml' writes one to start from"
            )
        from stochlin.analyses.tables.storage import FORMATS

        check_target("--report", report, REPORTS)
        check_target("--out", out, FORMATS)
        answer = _answer(case)
        page = _page(answer) if report else ""
        show(_lines(answer))
        if out is not None:
            from stochlin.analyses.tables.storage import save_table

            save_table(answer.table(samples=out.suffix.lower() == ".nc"), out)
            click.echo(f"saved {out}")
        if report is not None:
            from stochlin.analyses.tables.storage import whole_file

            with whole_file(report) as temporary:
                temporary.write_text(page, encoding="utf-8")
            click.echo(f"saved {report}")


def _answer(path: Path) -> CaseAnswer:
    from stochlin.analyses.cases.case import read_case
    from stochlin.analyses.cases.separation import answer_case

    case = read_case(path)
    with progress_bar("simulating") as progress:
        return answer_case(case, progress)


def _page(answer: CaseAnswer) -> str:
    from stochlin.views.separation.report import report_page

    return report_page(answer)


def _lines(answer: CaseAnswer) -> list[str]:
    """What the screen shows: the answer in words, the table, and what a reader must know of it."""
    from stochlin.views.separation import words

    lines = [answer.case.title, "", *paragraph(words.headline(answer))]
    for sentence in words.summary(answer):
        lines += paragraph(sentence)
    allowed = words.allowances(answer)
    if allowed:
        lines += ["", *paragraph(allowed[0])]
        lines += [line for text in allowed[1:] for line in paragraph(f"  {text}", "    ")]
    shown = words.rows(answer)
    wide = max(len(row.rule) for row in shown)
    lines += ["", f"{'rule':{wide}}  gap [cm]  error    apart  {'verdict':13}  mark"]
    lines += [
        f"{row.rule:{wide}}  {row.gap:>8} {row.error:>6}  {row.probability:>7}  {row.verdict:13}  "
        f"{row.mark}".rstrip()
        for row in shown
    ]
    lines += [""]
    for row in shown:
        if row.missing:
            lines += paragraph(f"{row.rule}: {row.missing}", "  ")
    return [*lines, *paragraph(words.COLUMNS), *paragraph(words.MARKS)]
