"""The command ``stochlin probability``: how likely pounding is in a case, printed and drawn."""

from __future__ import annotations

import warnings
from pathlib import Path

import click

from stochlin.applications.cases.rows import gap_of, pair_of
from stochlin.messages import ImplausibleInput
from stochlin.views.shared.blocks import PICTURE_FORMATS
from stochlin.views.shared.options import QuantityType
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


@COMMANDS.register("probability")
@click.command()
@click.argument("case", type=FILE_PATH)
@click.option(
    "--gap",
    type=QuantityType("m"),
    help="Gap, such as 8cm, instead of the existing gap of the file.",
)
@click.option("--out", type=FILE_PATH, help="Save the table as .nc or .csv.")
@click.option("--picture", type=FILE_PATH, help="Draw the probability as .png, .svg or .pdf.")
@quiet_option
def probability(case: Path, gap: float | None, out: Path | None, picture: Path | None) -> None:
    """Compute the probability over time that two buildings pound in earthquakes of finite duration.

    CASE is a file like that of 'stochlin gap --example'. As .csv, the table has a row for each
    instant.

    \b
    Examples:
      stochlin probability case.toml
      stochlin probability case.toml --gap 8cm --picture probability.png --out probability.nc
    """
    from stochlin.applications.cases.pairs import judge_gap
    from stochlin.applications.cases.reading.case import read_case
    from stochlin.applications.cases.rows import TOUCHING
    from stochlin.files.storage import TABLE_FORMATS
    from stochlin.models.plausible import PLAUSIBLE
    from stochlin.views.probability.pictures import draw_pounding
    from stochlin.views.probability.words import answer_sections

    with bad_input():
        described = read_case(case)
        check_target("--out", out, TABLE_FORMATS, described.files)
        check_target("--picture", picture, PICTURE_FORMATS, described.files)
        _ = pair_of(described)  # raises where there are not two
        chosen = gap_of(described) if gap is None else gap or TOUCHING
        if chosen is None:
            what = "has no existing gap; allowed: one there, or --gap 5cm"
            raise described.whole.table.error("separation", what)
        if text := PLAUSIBLE["gap"].doubt(gap or 0.0):
            warnings.warn(f"--gap is {gap:g} m; {text}", ImplausibleInput, stacklevel=2)
        with progress_bar("simulating") as progress:
            table = judge_gap(described, chosen, progress)
        show(lines(answer_sections(table, described, chosen)))
        write(table, out, picture, draw_pounding)
