"""The command ``stochlin rho``: the correlation of a pair of structures, or a table of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from stochlin.views.shared import options as shared
from stochlin.views.shared.options import (
    Extended,
    Names,
    closure_option,
    ground_option,
    law_options,
    options_of_grounds,
    options_of_laws,
    record_options,
    shared_option,
    simulation_options,
    solver_option,
)
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE,
    bad_input,
    check_target,
    on_screen,
    progress_bar,
    show,
)


@COMMANDS.register("rho")
@click.command(cls=Extended, after="law_2", by=(options_of_laws, ground_option, options_of_grounds))
@shared_option("period", "Period [s].", units="s")
@shared_option("damping", "Damping ratio.", "0.05")
@shared_option("hardening", "Hardening ratio.")
@shared_option("reduction-factor", "R = 3 sigma_el/uy; elastic if no strength is given.")
@shared_option("yield-displacement", "uy [m], instead of R.", units="m")
@law_options
@click.option(
    "--method",
    type=Names("stochlin.solver.correlation.correlation", "METHODS"),
    default="linearization",
    show_default=True,
)
@click.option(
    "--rule",
    type=Names("stochlin.models.rules.effective_properties", "EFFECTIVE_RULES"),
    default="iwan_1980",
    show_default=True,
    help="Rule for the effective properties, with --method effective.",
)
@simulation_options
@closure_option
@solver_option
@click.option("--out", type=FILE, help="Save the table as .nc or .csv.")
@record_options
def rho(record: Path | None, out: Path | None, **options: Any) -> None:
    """Compute the correlation coefficient of a pair of structures, or a table over any parameters.

    A number is a value (0.5s), a list (0.5s,1s,2s) or a sweep start:stop:count, with :log for a
    geometric one (0.2s:4s:81:log). Each has its unit, as in case files: 3cm, 700ms, 0.01m^2/s^3; ratios
    have none. Options of structures apply to both, and with -1 or -2 behind the name to one of them. The
    parameters of a law are options, too, such as --beta and --exponent of bouc_wen.

    \b
    Examples:
      stochlin rho --period-1 0.7s --period-2 1s
      stochlin rho --period-1 0.2s:2s:19 --period-2 1s --hardening 0.05 --reduction-factor 2,4,6 \\
          --ground kanai-tajimi --ground-period 2s --ground-damping 0.05 --out table.nc
      stochlin rho --period 1s --period-2 1.2s --record record.at2
      stochlin rho --period 0.7s --period-2 1s --hardening 0.05 --reduction-factor 4 \\
          --law bouc_wen --exponent 2
    """
    from stochlin.solver.correlation.correlation import correlate
    from stochlin.solver.tables.storage import FORMATS, save_table
    from stochlin.views.shared.words import roles_in_words

    with bad_input():
        check_target("--out", out, FORMATS, [record] if record else [])
        first, second = shared.structures(options)
        strengths = [options[f"yield_displacement{number}"] for number in ("", "_1", "_2")]
        if record is None and options["intensity"] is None and any(strengths):
            raise click.UsageError(
                "--yield-displacement needs the strength of the shaking: give --intensity as well, or "
                "--reduction-factor in its place"
            )
        ground = shared.site(record, options)[1] if record else shared.ground(options)
        chosen = {key: options[key] for key in ("closure", "solver", "rule", "paths", "seed")}
        with progress_bar("simulating") as progress:
            table = correlate(first, second, ground, options["method"], **chosen, progress=progress)
        click.echo(f"# {table.attrs['title']}")
        show(f"# {line}" for line in roles_in_words(table.attrs, "first", "second", "ground"))
        if "comment" in table.attrs:
            click.echo(f"# {table.attrs['comment']}")
        click.echo(on_screen(table))
        if out is not None:
            save_table(table, out)
            click.echo(f"# saved {out}")
