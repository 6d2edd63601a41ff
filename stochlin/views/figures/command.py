"""The command ``stochlin charts``, which writes datasets and pictures."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import click

from stochlin.messages import brief
from stochlin.views.shared import options as shared
from stochlin.views.shared.options import (
    QuantityType,
    closure_option,
    numbers_option,
    record_options,
    together,
)
from stochlin.views.shared.screen import COMMANDS, PICTURES, bad_input, check_target, progress_bar

FOLDER = click.Path(file_okay=False, path_type=Path)
FORMAT = click.Choice([ending[1:] for ending in PICTURES])
RATIO, SECONDS, METRES = map(QuantityType, ("1", "s", "m"))
COUNT, WHOLE = click.IntRange(min=0), click.IntRange(min=2)
# Name, kind, default and help of the options that take one value.
OPTIONS: tuple[tuple[str, Any, Any, str], ...] = (
    ("out", FOLDER, "figures", "Folder for the files."),
    ("format", FORMAT, "png", "Kind of the pictures."),
    ("print-width", METRES, None, "Width in print, such as 84mm: no title and notes, larger text."),
    ("damping", RATIO, "0.05", "Damping ratio of the structures."),
    ("hardening", RATIO, "0.05", "Hardening ratio."),
    ("plane-reduction-factor", RATIO, "4", "R of Fig. 5a."),
    ("ductility", RATIO, "4", "Peak ductility in Fig. 3b."),
    ("ground-period", SECONDS, "2s", "Period of the model grounds [s]."),
    ("points", WHOLE, 161, "Number of periods along an axis."),
    ("paths", WHOLE, 64, "Simulated motions."),
    ("simulated-points", COUNT, None, "Simulated periods: 21 in Fig. 4, 41 in Fig. 5a; 0 for none."),
    ("structure-period", SECONDS, None, "Period of the structure in Fig. 1: that of the ground."),
)


@COMMANDS.register("charts")
@click.command()
@click.argument("name", required=False)
@together(
    *(
        click.option(
            f"--{name}", type=kind, default=default, show_default=default is not None, help=text
        )
        for name, kind, default, text in OPTIONS
    )
)
@numbers_option("--reduction-factors", "R of the curves in Figs. 4 and 5b.", default="1,2,4,6")
@numbers_option("--ground-damping", "Of the model grounds: a panel for each.", default="0.05,0.6")
@click.option(
    "--curves",
    metavar="NAMES",
    help="Effective rules in Fig. 3b and in the comparison of Fig. 4, such as iwan_1980,fema_440. "
    "Default: in Fig. 3b the verified ones and that of the paper, in Fig. 4 penzien_1997 and iwan_1980.",
)
@closure_option
@click.option(
    "--comparison",
    is_flag=True,
    help="Draw a second picture of Figs. 4 and 5, with linearization, drift closure and simulation.",
)
@record_options
def charts(name: str | None, record: Path | None, comparison: bool, **options: Any) -> None:
    """Draw all design charts, or the one called NAME, and save the dataset of each beside it (.nc).

    \b
    Without a record: fig3a, fig3b; with a panel for each ground fig4a, fig4b, fig4c, fig5a, fig5b; of
    contact elements fig6, fig7, fig8; of a simulated motion fig1, fig1b, fig2.
    With --record: site_spectrum, fig1 (pseudo energy radius), fig1b (beside energies) and fig2 (critical
    gap) of the record, and Figs. 4 and 5 with the ending _site, on the fitted ground.

    \b
    Examples:
      stochlin charts
      stochlin charts fig4b --comparison
      stochlin charts fig3b --curves jeng_kasai_maison_1992_unverified,iwan_1980
      stochlin charts fig4b --print-width 84mm --format pdf --out out
      stochlin charts fig5a --damping 0.02 --hardening 0.1 --format pdf --out out
      stochlin gap --example-record > record.at2
      stochlin charts --record record.at2
      stochlin charts fig1b --record record.at2 --structure-period 1s
      stochlin charts site_spectrum --record column.txt --dt 0.01s --units g
    """
    from stochlin.views.figures.charts import chart_functions
    from stochlin.views.figures.panels import width_in_print
    from stochlin.views.figures.settings import ChartSettings

    with bad_input():
        fields = {field.name for field in dataclasses.fields(ChartSettings)}
        chosen = {key: value for key, value in options.items() if key in fields}
        chosen["ground_dampings"] = options["ground_damping"]
        if options["curves"] is not None:
            chosen["curves"] = options["curves"].split(",")
        lists = {key: tuple(value) for key, value in chosen.items() if isinstance(value, list)}
        motion = shared.site(record, options) if record else ()
        functions = chart_functions(ChartSettings(**chosen | lists), *motion)
        if name is not None and name not in functions:
            raise ValueError(f"NAME = {brief(name)} is no chart; allowed: {', '.join(functions)}")
        width_in_print(options["print_width"])
        out: Path = options["out"]
        out.mkdir(parents=True, exist_ok=True)
        names = list(functions) if name is None else [name]
        for stem in names:
            for ending in (".nc", f".{options['format']}"):
                check_target("--out", out / f"{stem}{ending}", (ending,), [record] if record else [])
        with progress_bar("charts", lambda _: stem) as progress:
            for number, stem in enumerate(names):
                progress(number / len(names))
                _write(functions[stem](), out / stem, comparison, options)
            progress(1.0)
    click.echo(f"{len(names)} charts and their datasets in {out}")


def _write(dataset: Any, path: Path, comparison: bool, options: dict[str, Any]) -> None:
    """Write the dataset and its pictures."""
    from stochlin.solver.tables.storage import save_table
    from stochlin.views.figures.charts import draw
    from stochlin.views.shared.style import PRINT, SCREEN, save

    width = options["print_width"]
    pictures = {"": draw(dataset, print_width=width)}
    if comparison and "comparison" in dataset.attrs:
        pictures["_comparison"] = draw(dataset, comparison=True, print_width=width)
    save_table(dataset, path.with_name(f"{path.name}.nc"))
    for end, figure in pictures.items():
        picture = path.with_name(f"{path.name}{end}.{options['format']}")
        save(figure, picture, SCREEN if width is None else PRINT)
