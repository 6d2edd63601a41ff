"""The command ``stochlin charts``, which writes datasets and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stochlin.views.shared.blocks import PICTURE_FORMATS
from stochlin.views.shared.options import OptionList, QuantityType, as_option
from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import COMMANDS, bad_input, check_target

RATIO_TYPE, SECONDS_TYPE, METRES_TYPE = map(QuantityType, ("1", "s", "m"))
RATIO_LIST = OptionList("1")
NOT_BELOW_ZERO = click.IntRange(min=0)
AT_LEAST_TWO = click.IntRange(min=2)
# Type, default and help of the options; all but the first three are parameters of ChartSettings.
CHART_OPTIONS: dict[str, tuple[Any, Any, str]] = {
    "out": (click.Path(file_okay=False, path_type=Path), "figures", "Folder for the files."),
    "format": (
        click.Choice([ending[1:] for ending in PICTURE_FORMATS]),
        "png",
        "Kind of the pictures.",
    ),
    "print_width": (
        METRES_TYPE,
        None,
        "Width in print, such as 84mm: no title and notes, larger text.",
    ),
    "damping": (RATIO_TYPE, "0.05", "Damping ratio of the structures."),
    "hardening": (RATIO_TYPE, "0.05", "Hardening ratio."),
    "reduction_factors": (RATIO_LIST, "1,2,4,6", "R of the curves in Figs. 4, 5b and 9."),
    "plane_reduction_factor": (RATIO_TYPE, "4", "R of Fig. 5a."),
    "ductility": (RATIO_TYPE, "4", "Peak ductility in Fig. 3b."),
    "curves": (click.STRING, None, "Effective rules in Fig. 3b, such as iwan_1980,fema_440."),
    "ground_period": (SECONDS_TYPE, "2s", "Period of the model grounds [s]."),
    "ground_dampings": (RATIO_LIST, "0.05,0.6", "Damping of the model grounds: a panel for each."),
    "points": (AT_LEAST_TWO, 161, "Number of periods along an axis."),
    "paths": (AT_LEAST_TWO, 64, "Simulated motions; 32 times as many in Fig. 9."),
    "simulated_points": (
        NOT_BELOW_ZERO,
        None,
        "Simulated periods: 21 in Fig. 4, 41 in 5a, 11 in 9; 0 for none.",
    ),
}

COMPARISON = (
    "Draw a second picture of Figs. 4 and 5, with linearization, drift closure and simulation."
)


@COMMANDS.register("charts")
@click.command(
    params=[
        click.Option([as_option(name)], type=kind, default=default, show_default=True, help=text)
        for name, (kind, default, text) in CHART_OPTIONS.items()
    ]
)
@click.argument("name", required=False)
@click.option("--comparison", is_flag=True, help=COMPARISON)
@click.option(
    "--record", type=click.Path(path_type=Path), help="File of a record for Figs. 1 and 2."
)
@click.option("--units", help="Units of the record, such as g, if its file does not state them.")
@click.option("--dt", type=SECONDS_TYPE, help="Its time step [s], likewise.")
@quiet_option
def charts(
    name: str | None,
    comparison: bool,
    record: Path | None,
    units: str | None,
    dt: float | None,
    **options: Any,
) -> None:
    """Draw all design charts, or the one called NAME, and save the dataset of each beside it (.nc).

    \b Of a record or a simulated motion fig1 (pseudo energy radius), fig1b (energies), fig2
    (critical gap); fig3a, fig3b; with a panel for each ground fig4a, fig4b, fig4c, fig5a, fig5b; of
    contact elements fig6, fig7, fig8; of the required gap fig9.

    \b
    Examples:
      stochlin charts
      stochlin charts fig4b --comparison
      stochlin charts fig2 --record record.at2
      stochlin charts fig3b --curves jeng_kasai_maison_1992_unverified,iwan_1980
      stochlin charts fig4b --print-width 84mm --format pdf --out out
      stochlin charts fig5a --damping 0.02 --hardening 0.1 --format pdf --out out
    """
    from stochlin.applications.figures.charts import CHARTS, ChartSettings, chart_functions
    from stochlin.applications.records.records import read_record
    from stochlin.registry import as_key
    from stochlin.views.figures.pictures import width_in_print

    with bad_input():
        chosen = {key: options[key] for key in options if key in ChartSettings.__dataclass_fields__}
        if options["curves"] is not None:
            chosen["curves"] = options["curves"].split(",")
        if record is not None:
            chosen["record"] = read_record(record, units=units, dt=dt)
        elif (units, dt) != (None, None):
            raise ValueError("--units or --dt is given without --record; allowed: with it")
        functions = chart_functions(ChartSettings(**chosen))
        names = [*functions] if name is None else [as_key(name)]
        CHARTS.named(names[0], "NAME")
        width_in_print(options["print_width"])
        out: Path = options["out"]
        out.mkdir(parents=True, exist_ok=True)
        for stem in names:
            for ending in (".nc", f".{options['format']}"):
                check_target("--out", out / f"{stem}{ending}", (ending,))
        with progress_bar("charts", lambda: stem) as progress:
            for number, stem in enumerate(names):
                progress(number / len(names))
                _write(functions[stem](), out / stem, comparison, options)
            progress(1.0)
    click.echo(f"{len(names)} charts and their datasets in {out}")


def _write(dataset: Any, path: Path, comparison: bool, options: dict[str, Any]) -> None:
    """Write the dataset and its pictures."""
    from stochlin.files.storage import save_table
    from stochlin.views.figures.pictures import draw
    from stochlin.views.shared.style import PRINT, SCREEN, save

    width = options["print_width"]
    pictures = {"": draw(dataset, print_width=width)}
    if comparison and "comparison" in dataset.attrs:
        pictures["_comparison"] = draw(dataset, comparison=True, print_width=width)
    save_table(dataset, path.with_name(f"{path.name}.nc"))
    for end, figure in pictures.items():
        picture = path.with_name(f"{path.name}{end}.{options['format']}")
        save(figure, picture, SCREEN if width is None else PRINT)
