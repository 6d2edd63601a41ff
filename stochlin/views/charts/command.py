"""The command ``stochlin charts``, which writes datasets and pictures."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.messages import brief
from stochlin.views.shared import options as shared
from stochlin.views.shared.options import (
    QuantityType,
    closure_option,
    numbers_option,
    record_options,
    solver_option,
    together,
)
from stochlin.views.shared.screen import COMMANDS, PICTURES, bad_input, check_target, progress_bar

if TYPE_CHECKING:
    import xarray as xr

    from stochlin.analyses.charts.settings import ChartSettings


FOLDER = click.Path(file_okay=False, path_type=Path)
NUMBERS = (
    ("--damping", "0.05", "1", "Damping ratio of the structures."),
    ("--hardening", "0.05", "1", "Hardening ratio."),
    ("--plane-reduction-factor", "4", "1", "R of Fig. 5a."),
    ("--ground-period", "2s", "s", "Period of the model grounds [s]."),
)
# For the folder of the charts and for their parameters.
OPTIONS = together(
    click.option(
        "--out", type=FOLDER, default="figures", show_default=True, help="Folder for the files."
    ),
    click.option(
        "--format",
        "picture_format",
        type=click.Choice([ending[1:] for ending in PICTURES]),
        default="png",
        show_default=True,
    ),
    *(
        click.option(name, type=QuantityType(units), default=default, show_default=True, help=text)
        for name, default, units, text in NUMBERS
    ),
    numbers_option("--reduction-factors", "R of the curves in Figs. 4 and 5b.", "1,2,4,6"),
    numbers_option("--ground-damping", "Damping of the model grounds: a panel for each.", "0.05,0.6"),
    click.option(
        "--print-width",
        type=QuantityType("m"),
        help="Width of the pictures in print, such as 84mm or 174mm for one or two columns: without "
        "title and notes, and with text of 7 points or more. Default: pictures for the screen.",
    ),
    closure_option,
    solver_option,
    click.option(
        "--points",
        type=click.IntRange(min=2),
        default=161,
        show_default=True,
        help="Number of periods along an axis.",
    ),
)


@COMMANDS.register("charts")
@click.command()
@click.argument("name", required=False)
@OPTIONS
@numbers_option("--ductility", "Peak ductilities in Fig. 3b: a panel for each.", "4")
@click.option(
    "--curves",
    callback=lambda _, __, given: given if given is None else tuple(given.split(",")),
    metavar="NAMES",
    help="What is drawn in Figs. 3b, 4 and 5: linearization, simulation, drift, elastic, white_noise, "
    "and rules such as iwan_1980,fema_440. Default: all; of the rules in Fig. 3b the verified ones and "
    "that of the paper, in Fig. 4 penzien_1997 and iwan_1980.",
)
@click.option(
    "--simulated-points",
    type=click.IntRange(min=0),
    help="Number of periods at which each curve of Fig. 4 (default: 21), and Fig. 5a along each axis "
    "(default: 41), are also simulated; 0 for none.",
)
@click.option(
    "--paths", type=click.IntRange(min=2), default=64, show_default=True, help="Simulated motions."
)
@click.option(
    "--structure-period",
    type=QuantityType("s"),
    help="Period of the structure of Fig. 1, and of the first structure of added_damping; default: "
    "that of the fitted ground.",
)
@click.option(
    "--second-period",
    type=QuantityType("s"),
    help="Period of the second structure of added_damping; default: 0.7 times the first.",
)
@click.option("--gap", type=QuantityType("m"), help="Existing gap, drawn in added_damping.")
@record_options
def charts(
    name: str | None,
    out: Path,
    picture_format: str,
    print_width: float | None,
    record: Path | None,
    **options: Any,
) -> None:
    """Draw all design charts, or the one called NAME, and save the dataset of each beside it (.nc).

    Charts that compare methods have a second picture with the ending _comparison, of the same data.

    \b
    Without a record: fig3a, fig3b; with a panel for each ground fig4a, fig4b, fig4c, fig5a, fig5b; of
    contact elements fig6, fig7, fig8; of a simulated motion fig1, fig1b, fig2.
    With --record: site_spectrum, fig1 (pseudo energy radius), fig1b (beside energies),
    per_spectrum, fig2 (critical gap) and added_damping (the gap over supplemental damping) of the
    record, and Figs. 4 and 5 with the ending _site, on the fitted ground.

    \b
    Examples:
      stochlin charts
      stochlin charts fig3b --curves jeng_kasai_maison_1992_unverified,iwan_1980
      stochlin charts fig4b --print-width 84mm --format pdf --out out
      stochlin charts fig5a --damping 0.02 --hardening 0.1 --format pdf --out out
      stochlin gap --example-record > record.at2
      stochlin charts --record record.at2
      stochlin charts fig1b --record record.at2 --structure-period 1s
      stochlin charts added_damping --record record.at2 --structure-period 1s --gap 4cm
      stochlin charts site_spectrum --record column.txt --dt 0.01s --units g
    """
    from stochlin.analyses.charts.charts import chart_functions
    from stochlin.kernels.basics.parallel import part_of
    from stochlin.views.charts.panels import width_in_print

    with bad_input():
        settings = chart_settings(options)
        motion, site = shared.site(record, options) if record else (None, None)
        functions = chart_functions(settings, motion, site)
        if name is not None and name not in functions:
            raise ValueError(f"NAME = {brief(name)} is no chart; allowed: {', '.join(functions)}")
        chosen = functions if name is None else {name: functions[name]}
        width_in_print(print_width)
        files = {key: _chart_files(out / key, picture_format, record) for key in chosen}
        with progress_bar("charts", lambda _: chart) as progress:
            for number, (chart, compute) in enumerate(chosen.items()):
                part = part_of(progress, number / len(chosen), (number + 1) / len(chosen))
                part(0.0)
                _write_chart(compute(part), *files[chart], print_width)
                part(1.0)
    click.echo(f"{len(chosen)} charts and their datasets in {out}")


def chart_settings(options: dict[str, Any]) -> ChartSettings:
    """Settings of the charts from the options of a command."""
    from stochlin.analyses.charts.settings import ChartSettings

    lists = {"reduction_factors": "reduction_factors", "ground_damping": "ground_dampings"}
    lists["ductility"] = "ductilities"
    names = {field.name for field in dataclasses.fields(ChartSettings)}
    chosen = {key: value for key, value in options.items() if key in names}
    numbers = {own: tuple(options[key]) for key, own in lists.items() if key in options}
    return ChartSettings(**chosen | numbers)


def _chart_files(stem: Path, picture_format: str, record: Path | None = None) -> tuple[Path, Path]:
    """Paths of the dataset of a chart and of its picture; raises if they cannot be written."""
    data, picture = (stem.with_name(f"{stem.name}.{ending}") for ending in ("nc", picture_format))
    there = next(folder for folder in (stem.parent, *stem.parent.parents) if folder.exists())
    for path in (data, picture):  # if the folder does not exist yet, its parent is checked
        tried = path if there == stem.parent else there / f".{path.name}"
        check_target("--out", tried, (path.suffix,), [record] if record else [])
    return data, picture


def _write_chart(dataset: xr.Dataset, data: Path, picture: Path, print_width: float | None) -> None:
    """Write the dataset and its pictures."""
    from stochlin.analyses.tables.storage import save_table
    from stochlin.views.charts.charts import draw
    from stochlin.views.shared.style import PRINT, SCREEN, save

    beside = picture.with_stem(f"{picture.stem}_comparison")
    kinds = {picture: False} | ({beside: True} if "comparison" in dataset.attrs else {})
    drawn = {
        path: draw(dataset, comparison=compared, print_width=print_width)
        for path, compared in kinds.items()
    }
    data.parent.mkdir(parents=True, exist_ok=True)
    save_table(dataset, data)
    for path, figure in drawn.items():
        save(figure, path, SCREEN if print_width is None else PRINT)
