"""The command ``stochlin warmup``: compile now what would otherwise be compiled at first use."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import click

from stochlin.views.shared.progress import progress_bar, quiet_option
from stochlin.views.shared.screen import COMMANDS, bad_input

if TYPE_CHECKING:
    from queue import SimpleQueue


@COMMANDS.register("warmup")
@click.command()
@quiet_option
def warmup() -> None:
    """Compile everything now, so that no command has to wait for it.

    The time steps of stochlin are compiled for this machine when they are first needed, which takes
    from seconds to a minute, and kept on the disk: in the folder of the program, in the user's
    cache folder if that cannot be written, or in the folder that the environment variable
    NUMBA_CACHE_DIR names. They are compiled again after an update of stochlin or numba, and for
    another kind of processor. Where no folder can be written, the command ends with exit status 1.

    In the recipe of a container, put this command directly after the installation.

    \b
    Example:
      stochlin warmup
    """
    from concurrent.futures import ThreadPoolExecutor, as_completed
    from queue import SimpleQueue

    from stochlin.kernels.basics.compiled import NOT_COMPILED, NOT_KEPT, UNCOMPILED, code_folder
    from stochlin.kernels.basics.parallel import cores
    from stochlin.views.warmup.tasks import TASKS

    with bad_input():
        if code_folder() is None:
            raise RuntimeError(NOT_KEPT)
    if UNCOMPILED:
        click.echo(NOT_COMPILED)
        return
    count = min(cores(), len(TASKS))
    names: SimpleQueue[str] = SimpleQueue()
    for name in (*TASKS, *count * [""]):  # an empty one for each process, which ends it
        names.put(name)
    with bad_input(), progress_bar("compiling") as progress, ThreadPoolExecutor(count) as pool:
        progress(0.0)
        finished: list[str] = []

        def finish(name: str) -> None:
            finished.append(name)
            progress(len(finished) / len(TASKS))

        for process in as_completed(pool.submit(_perform, names, finish) for _ in range(count)):
            process.result()
    click.echo("everything is compiled")


def _perform(names: SimpleQueue[str], finish: Callable[[str], None]) -> None:
    """Have one process perform tasks, as long as there are any."""
    from subprocess import PIPE, Popen

    from stochlin.kernels.basics.children import command, environment

    program = "from stochlin.views.warmup.tasks import main; main()"
    with Popen(command(program), stdin=PIPE, stdout=PIPE, text=True, env=environment()) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        while name := names.get():
            process.stdin.write(f"{name}\n")
            process.stdin.flush()
            if not process.stdout.readline():
                what = f"a process has ended (exit code {process.wait()}) while it compiled {name}"
                raise RuntimeError(f"{what}; try again")
            finish(name)
        process.stdin.close()
