"""The command ``stochlin warmup``: compile now what would otherwise be compiled at its first use."""

from __future__ import annotations

import click

from stochlin.views.shared.screen import COMMANDS, bad_input, progress_bar


@COMMANDS.register("warmup")
@click.command()
def warmup() -> None:
    """Compile everything now, so that no command has to wait for it.

    The time steps of stochlin are compiled for this machine when they are first needed, which takes from
    seconds to a minute, and kept on the disk: in the folder of the program, in the user's cache folder
    if that cannot be written, or in the folder that the environment variable NUMBA_CACHE_DIR names. They
    are compiled again after an update of stochlin or numba, and for another kind of processor. Where no
    folder can be written, the command ends with exit status 1.

    In the recipe of a container, put this command directly after the installation.

    \b
    Example:
      stochlin warmup
    """
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import get_context

    from stochlin.kernels.basics.compiled import NOT_COMPILED, NOT_KEPT, UNCOMPILED, code_folder
    from stochlin.kernels.basics.parallel import cores
    from stochlin.views.warmup.tasks import TASKS, perform

    with bad_input():
        if code_folder() is None:
            raise RuntimeError(NOT_KEPT)
    if UNCOMPILED:
        click.echo(NOT_COMPILED)
        return
    with (
        bad_input(),
        progress_bar("compiling") as progress,
        ProcessPoolExecutor(min(cores(), len(TASKS)), get_context("spawn")) as processes,
    ):
        progress(0.0)
        for done, task in enumerate(as_completed(processes.submit(perform, name) for name in TASKS)):
            task.result()
            progress((done + 1) / len(TASKS))
    click.echo("everything is compiled")
