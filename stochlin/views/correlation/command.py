"""The command ``stochlin rho``: the correlation of a pair of structures, or a table of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stochlin.views.shared.options import ground_of, numbers_option, structures
from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import (
    COMMANDS,
    FILE_PATH,
    bad_input,
    check_target,
    on_screen,
    show,
)

if TYPE_CHECKING:
    import xarray as xr

GROUND_HELP = "white-noise, kanai-tajimi, or a named ground such as firm or sct_1985_ns."
METHOD_HELP = "linearization, white_noise, effective or simulation."
RULE_HELP = "Rule for the effective properties, with --method effective."
PATHS_HELP = "Number of simulated motions, with --method simulation."


@COMMANDS.register("rho")
@click.command()
@numbers_option("--period-1", "Period of structure 1 [s].", "s", required=True)
@numbers_option("--period-2", "Period of structure 2 [s].", "s", required=True)
@numbers_option("--damping", "Damping ratio.", default="0.05")
@numbers_option("--hardening", "Hardening ratio.")
@numbers_option("--reduction-factor", "R = 3 sigma_el/uy; elastic if it is not given.")
@click.option("--ground", default="white-noise", show_default=True, help=GROUND_HELP)
@numbers_option("--ground-period", "Period of the ground [s].", "s")
@numbers_option("--ground-damping", "Damping ratio of the ground.")
@click.option("--method", default="linearization", show_default=True, help=METHOD_HELP)
@click.option(
    "--closure", default="gaussian", show_default=True, help="gaussian, clipped or drift."
)
@click.option("--rule", default="iwan_1980", show_default=True, help=RULE_HELP)
@click.option(
    "--paths", type=click.IntRange(min=2), default=256, show_default=True, help=PATHS_HELP
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True)
@click.option("--out", type=FILE_PATH, help="Save the table as .nc or .csv.")
@quiet_option
def rho(out: Path | None, method: Any, **options: Any) -> None:
    """Compute the correlation coefficient of two bilinear structures, or a table over parameters.

    A number is a value (0.5s), a list (0.5s,1s,2s) or a sweep start:stop:count, with :log for a
    geometric one (0.2s:4s:81:log). Periods have their unit, as in case files: 0.7s, 700ms. Both
    structures have the same damping, hardening and strength; stochlin.correlate of the library
    takes any two, of any hysteresis law, on any ground, also one that fit_ground fits to a record.

    \b
    Examples:
      stochlin rho --period-1 0.7s --period-2 1s
      stochlin rho --period-1 0.2s:2s:19 --period-2 1s --hardening 0.05 --reduction-factor 2,4,6 \\
          --ground kanai-tajimi --ground-period 2s --ground-damping 0.05 --out table.nc
    """
    from stochlin.files.storage import TABLE_FORMATS, save_table
    from stochlin.models.descriptions import roles_in_words
    from stochlin.solver.correlation.correlation import correlate

    with bad_input():
        check_target("--out", out, TABLE_FORMATS)
        first, second = structures(options)
        ground = ground_of(options)
        chosen = {key: options[key] for key in ("closure", "rule", "paths", "seed")}
        with progress_bar("simulating") as progress:
            table = correlate(first, second, ground, method, **chosen, progress=progress)
        click.echo(f"# {table.attrs['title']}")
        show(f"# {line}" for line in roles_in_words(table.attrs, "first", "second", "ground"))
        if comment := of_these(table) or table.attrs.get("comment"):
            click.echo(f"# {comment}")
        click.echo(on_screen(table))
        if out is not None:
            save_table(table, out)
            click.echo(f"# saved {out}")


def of_these(table: xr.Dataset) -> str:
    """The errors of linearization for pairs of a table, by its bias; empty if any is not known."""
    names = "bias", "bias_1", "bias_2", "relative_displacement_bias"
    if not all(name in table and bool(table[name].notnull().all()) for name in names):
        return ""
    of_rho = table["bias"]
    first = table["bias_1"]
    second = table["bias_2"]
    apart = table["relative_displacement_bias"]
    if not of_rho.any() and not apart.any():  # of elastic structures
        return ""
    return (
        f"Caution: against the drift closure, linearized \N{GREEK SMALL LETTER RHO} is off by "
        f"{_span(of_rho)}, the standard deviations by {_span(100 * first)} % and "
        f"{_span(100 * second)} %, and that of u1 - u2, to which a gap is proportional, "
        f"by {_span(100 * apart)} %."
    )


def _span(values: xr.DataArray) -> str:
    """The least and the largest of some errors."""
    return " to ".join(dict.fromkeys(f"{float(end):+.2g}" for end in (values.min(), values.max())))
