"""The command ``stochlin building``: what a file says of a building, printed."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stochlin.messages import brief
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE_PATH,
    bad_input,
    check_target,
    lines,
    show,
    write,
)

ANY_DAMPING = 0.05  # which changes nothing that is shown


@COMMANDS.register("building")
@click.command()
@click.argument("modes", required=False, type=click.Path(path_type=Path))
@click.option("--direction", help="Direction of the gap, if the file has several: UX or UY.")
@click.option("--points", help="Points whose displacements are the shapes, one a floor: 11,21,31.")
@click.option("--tower", help="Tower, or diaphragm, if the file has several buildings: T1.")
@click.option(
    "--mass-units", help="Unit of the masses, if the file does not say it: kg, t, kN-s2/m."
)
@click.option(
    "--length-units", help="Unit of the levels, if the file does not say it: m, cm, mm, ft."
)
@click.option(
    "--pushover",
    type=FILE_PATH,
    help="Pushover curve of the building under forces of its first mode: the strength of that "
    "mode.",
)
@click.option(
    "--pushover-units",
    help="Units of displacement and base shear in that file, if it does not say them: mm,kN.",
)
@click.option(
    "--pushover-columns",
    help="Columns of displacement and base shear in that file, by title or number from 1: 1,2.",
)
@click.option("--example", is_flag=True, help="Print a table of modes to start from, and stop.")
@click.option("--out", type=FILE_PATH, help="Save the modes as .nc, or as .csv.")
def building(
    modes: Path | None,
    points: str | None,
    pushover: Path | None,
    pushover_units: str | None,
    pushover_columns: str | None,
    example: bool,
    out: Path | None,
    **options: Any,
) -> None:
    """Show what files say of a building: periods, masses, shapes, strength, and what is assumed.

    MODES is a file with the modes of a building: a table in plain form, or tables that ETABS
    exports as .xlsx or .csv, in one file or in a folder. A case file takes it as modes =
    "tower.csv".

    \b
    Examples:
      stochlin building --example > tower.csv
      stochlin building tower.csv
      stochlin building tower.csv --pushover push.csv
      stochlin building etabs.xlsx --direction UX --points 12
    """
    with bad_input():
        from stochlin.applications.buildings.mode_files.plain import EXAMPLE
        from stochlin.applications.buildings.modes import read_modes, with_masses
        from stochlin.applications.buildings.pushover import (
            bilinear_of,
            pushover_options,
            read_pushover,
        )
        from stochlin.files.storage import TABLE_FORMATS
        from stochlin.models.buildings.modal import ModalBuilding
        from stochlin.views.buildings.words import building_sections

        if example:
            click.echo(EXAMPLE, nl=False)
            return
        if modes is None:
            raise ValueError(
                "MODES is missing; 'stochlin building --example > tower.csv' writes one"
            )
        check_target("--out", out, TABLE_FORMATS, [modes, *([pushover] if pushover else [])])
        named = [name.strip() for name in points.split(",")] if points else ()
        table = read_modes(modes, points=named, **options)
        of_modes = ModalBuilding.from_table(table, damping=ANY_DAMPING)
        ideal: Any = None
        if pushover is not None:
            units = _pair("--pushover-units", pushover_units, "mm,kN")
            columns = _pair("--pushover-columns", pushover_columns, "1,2")
            numbers = [int(name) if name.isdigit() else name for name in columns]
            called = dict.fromkeys(("length_units", "force_units"), "--pushover-units")
            called |= dict.fromkeys(("displacement_column", "force_column"), "--pushover-columns")
            with bad_input(**called):
                ideal = bilinear_of(read_pushover(pushover, **pushover_options(units, numbers)))
            of_modes = of_modes.with_pushover(ideal)
        table = with_masses(table, of_modes)
        show(lines(building_sections(table, of_modes, ideal)))
        write(table, out)


def _pair(option: str, texts: str | None, example: str) -> list[str]:
    """The two texts of an option, of displacement and base shear; none without it."""
    pair = [] if texts is None else [*map(str.strip, texts.split(","))]
    if len(pair) not in (0, 2):
        raise ValueError(f"{option} {brief(texts)}; allowed: two of them, such as {example}")
    return pair
