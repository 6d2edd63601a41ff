"""Commands as users type them, run within the process of the tests, and programs in their own."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result

import stochlin as sl
from stochlin.views.command import main


def invoke(*arguments: object, **options: Any) -> Result:
    """The command, however it ends; options are those of click's runner."""
    return CliRunner().invoke(main, [str(argument) for argument in arguments], **options)


def answered(*arguments: object, **options: Any) -> Result:
    """A command that does what it is asked for."""
    result = invoke(*arguments, **options)
    assert result.exit_code == 0, result.output
    return result


def refused(*arguments: object) -> str:
    """What a command says, on one line, that is refused as a user's error is."""
    result = invoke(*arguments)
    assert result.exit_code == 2, result.output
    assert "Traceback" not in result.output
    return " ".join(result.output.split())


def process(
    folder: Path, setting: dict[str, str], *command: str
) -> subprocess.CompletedProcess[str]:
    """One with these variables in its environment."""
    places = os.pathsep.join([str(Path(sl.__file__).parents[1]), *filter(None, sys.path)])
    environment = {**os.environ, "PYTHONPATH": places, **setting}
    return subprocess.run(
        [sys.executable, *command],
        check=False,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
    )
