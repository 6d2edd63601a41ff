"""Commands that write an atlas and look cases up in one."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import click

from stochlin.views.shared.options import (
    Extended,
    Numbers,
    options_of_grounds,
    parameter_of,
    shared_option,
)
from stochlin.views.shared.screen import COMMANDS, FILE, bad_input, on_screen, progress_bar


@COMMANDS.register("atlas")
@click.command()
@click.argument("spec", type=FILE)
@click.option("--out", type=click.Path(path_type=Path), required=True, help="Folder of the Zarr store.")
@click.option(
    "--scheduler",
    help="Address of a dask scheduler, such as tcp://host:8786; its workers must have access to the "
    "same files. Default: the cores of this computer.",
)
def atlas(spec: Path, out: Path, scheduler: str | None) -> None:
    """Write a design atlas, a table of any size, from the specification SPEC (TOML).

    The same command continues an atlas that was interrupted at any moment.

    \b
    A specification:
      ground = "kanai_tajimi"
      [parameters]       # periods over the ground's; numbers are held, lists and sweeps are axes
      period_1 = { start = 0.1, stop = 10, count = 400, spacing = "log" }
      period_2 = { start = 0.1, stop = 10, count = 400, spacing = "log" }
      ground_damping = [0.05, 0.2, 0.6]
      damping = 0.05
      hardening = [0.02, 0.1]
      reduction_factor = [1, 2, 4, 6]

    \b
    Examples:
      stochlin atlas spec.toml --out atlas.zarr
      stochlin atlas spec.toml --out /shared/atlas.zarr --scheduler tcp://10.0.0.1:8786
    """
    from stochlin.analyses.atlases.atlas import write_atlas

    with bad_input(), progress_bar("atlas") as progress:
        table = write_atlas(spec, out, scheduler=scheduler, progress=progress)
    click.echo(f"{table.rho.size} cells in {out}")


@COMMANDS.register("lookup")
@click.command(
    cls=Extended,
    after="reduction_factor_2",
    by=(partial(options_of_grounds, without="intensity"),),  # an atlas does not depend on it
)
@click.argument("atlas", type=click.Path(path_type=Path))
@click.option(
    "--period-1",
    metavar="NUMBERS",
    help="Period of structure 1: in s with --ground-period, otherwise relative to that of the ground.",
)
@click.option("--period-2", metavar="NUMBERS", help="Period of structure 2, likewise.")
@shared_option("damping", "Damping ratio.")
@shared_option("hardening", "Hardening ratio.")
@shared_option("reduction-factor", "R = 3 sigma_el/uy.")
def lookup(atlas: Path, **options: Any) -> None:
    """Interpolate cases in ATLAS; a number may be a list or a sweep, as for 'stochlin rho'.

    \b
    Examples:
      stochlin lookup atlas.zarr --period-1 1.4s --period-2 2s --ground-period 2s --ground-damping 0.1 \\
          --hardening 0.05 --reduction-factor 4
    """
    from stochlin.analyses.atlases.atlas import open_atlas
    from stochlin.analyses.atlases.lookup import lookup as look

    with bad_input():
        periods = Numbers("1" if options["ground_period"] is None else "s")
        for name in ("period_1", "period_2"):
            options[name] = periods.convert(options[name], None, None)
        numbers = {
            name: parameter_of(name, value) for name, value in options.items() if value is not None
        }
        table = look(open_atlas(atlas), **numbers)
    click.echo(f"# {table.attrs['title']}")
    if "comment" in table.attrs:
        click.echo(f"# {table.attrs['comment']}")
    click.echo(on_screen(table))
