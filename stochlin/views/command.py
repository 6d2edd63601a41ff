"""The command line: ``stochlin charts``, ``stochlin verify``, ``stochlin rho``; ``gap`` is a module.

Libraries are imported inside the commands: ``stochlin --help`` should not wait for them.
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin._version import __version__
from stochlin.views.atlases.command import atlas, lookup
from stochlin.views.explorer.command import explore
from stochlin.views.mitigation.command import mitigate
from stochlin.views.pounding.command import pound
from stochlin.views.probability.command import probability
from stochlin.views.separation.command import gap
from stochlin.views.shared import options as shared
from stochlin.views.shared.options import (
    CLOSURES,
    chart_options,
    numbers_option,
    record_options,
    shared_option,
    simulation_options,
)
from stochlin.views.shared.screen import bad_input, on_screen

if TYPE_CHECKING:
    import xarray as xr

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}


@click.group(context_settings=CONTEXT)
@click.version_option(__version__, prog_name="stochlin")
def main() -> None:
    """Correlation and separation of neighbouring yielding buildings."""


main.add_command(gap)
main.add_command(atlas)
main.add_command(lookup)
main.add_command(probability)
main.add_command(pound)
main.add_command(mitigate)
main.add_command(explore)


@main.command()
@click.argument("name", required=False)
@chart_options(points=161, reduction_factors="1,2,4,6")
@click.option(
    "--ductility", type=float, default=4.0, show_default=True, help="Peak ductility in Fig. 3b."
)
@record_options
def charts(
    name: str | None, out: Path, picture_format: str, record: Path | None, **options: Any
) -> None:
    """Draw the design charts, all or the one called NAME, each beside its dataset (.nc).

    \b
    Without a record: fig3a, fig3b; on narrow-band ground (xig .05) fig4a, fig4b, fig4c, fig5a, fig5b,
    and the same with the ending _broad_band (xig .6); of contact elements fig6, fig7, fig8.
    With --record: site_spectrum, fig1 (pseudo energy radius), per_spectrum and fig2 (critical gap)
    of the record, and Figs. 4 and 5 with the ending _site, on the fitted ground.

    \b
    Examples:
      stochlin charts
      stochlin charts fig5a --damping .02 --hardening .1 --format pdf --out out
      stochlin charts --record taft.txt --dt .01 --units g
    """
    from stochlin.analyses.charts.charts import chart_functions

    with bad_input():
        settings = shared.chart_settings(options)
        motion, site = shared.site(record, options) if record else (None, None)
        functions = chart_functions(settings, motion, site)
        if name is not None and name not in functions:
            raise ValueError(f"NAME = {name!r} is no chart; allowed: {', '.join(functions)}")
        chosen = functions if name is None else {name: functions[name]}
        out.mkdir(parents=True, exist_ok=True)
        with click.progressbar(
            chosen.items(), label="charts", file=sys.stderr, item_show_func=lambda item: item and item[0]
        ) as bar:
            for chart, compute in bar:
                _write_chart(compute(), out / chart, picture_format)
    click.echo(f"{len(chosen)} charts and their datasets in {out}")


@main.command()
@click.argument("name", default="fig5a")
@chart_options(points=31, reduction_factors="2,4,6")
@simulation_options
def verify(name: str, out: Path, picture_format: str, **options: Any) -> None:
    """Draw the chart NAME linearized, simulated, and their difference (fig5a if not given).

    \b
    Examples:
      stochlin verify
      stochlin verify fig4b --reduction-factors 2,4 --paths 512
    """
    from stochlin.analyses.charts.verification import verify_chart

    with bad_input():
        dataset = verify_chart(name, shared.chart_settings(options))
        out.mkdir(parents=True, exist_ok=True)
        _write_chart(dataset, out / f"{name}_verified", picture_format)
    click.echo(dataset.attrs["comment"])
    click.echo(f"{name}_verified and its dataset in {out}")


@main.command()
@shared_option("period", "Period [s].")
@shared_option("damping", "Damping ratio.", "0.05")
@shared_option("hardening", "Hardening ratio.")
@shared_option("reduction-factor", "R = 3 sigma_el/uy; without a strength: elastic.")
@shared_option("yield-displacement", "uy [m], instead of R.")
@click.option(
    "--ground",
    default="white-noise",
    show_default=True,
    help="white-noise, kanai-tajimi, clough-penzien, or a named ground such as firm or sct_1985_ns.",
)
@numbers_option("--ground-period", "2 pi/wg [s].")
@numbers_option("--ground-damping", "xig.")
@numbers_option("--high-pass-period", "2 pi/wf [s].")
@numbers_option("--high-pass-damping", "xif.")
@numbers_option("--intensity", "S0 [m^2/s^3], two-sided; 1 if not given.")
@click.option(
    "--method",
    type=click.Choice(["linearization", "white_noise", "effective", "simulation"]),
    default="linearization",
    show_default=True,
)
@click.option(
    "--rule",
    default="iwan_1980",
    show_default=True,
    help="Effective properties, where the method is effective.",
)
@simulation_options
@click.option("--closure", type=click.Choice(CLOSURES), default="gaussian", show_default=True)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), help="Save the table, .nc or .csv."
)
@record_options
def rho(record: Path | None, out: Path | None, **options: Any) -> None:
    """Correlation coefficient of a pair of structures, or a table over any parameters.

    A number is a value (0.5), a list (0.5,1,2) or a sweep start:stop:count, with :log for a
    geometric one (0.2:4:81:log). Options without a number in the name hold for both structures.

    \b
    Examples:
      stochlin rho --period-1 .7 --period-2 1
      stochlin rho --period-1 .2:2:19 --period-2 1 --hardening .05 --reduction-factor 2,4,6 \\
          --ground kanai-tajimi --ground-period 2 --ground-damping .05 --out table.nc
      stochlin rho --period 1 --period-2 1.2 --record taft.txt --dt .01 --units g
    """
    from stochlin.analyses.correlation.correlation import correlate
    from stochlin.analyses.tables.storage import save_table

    with bad_input():
        first, second = shared.structures(options)
        ground = shared.site(record, options)[1] if record else shared.ground(options)
        chosen = {key: options[key] for key in ("closure", "rule", "paths", "seed")}
        table = correlate(first, second, ground, options["method"], **chosen)
        click.echo(f"# {table.attrs['title']}")
        for role in ("first", "second", "ground"):
            click.echo(f"# {role}: {table.attrs[role]}")
        if "comment" in table.attrs:
            click.echo(f"# {table.attrs['comment']}")
        click.echo(on_screen(table))
        if out is not None:
            save_table(table, out)
            click.echo(f"# saved {out}")


def _write_chart(dataset: xr.Dataset, stem: Path, picture_format: str) -> None:
    """The dataset, and the picture drawn from it beside it."""
    from stochlin.analyses.tables.storage import save_table
    from stochlin.views.charts.charts import draw
    from stochlin.views.shared.style import save

    save_table(dataset, stem.with_name(f"{stem.name}.nc"))
    save(draw(dataset), stem.with_name(f"{stem.name}.{picture_format}"))
