"""A package from outside that extends stochlin: installed into a folder, used from the command line."""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path
from subprocess import PIPE, CompletedProcess, Popen

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "extending.md"
# Imports take longer than most commands: one process runs those of a package, one after another.
COMMANDS = """
import io, json, os, sys
from contextlib import redirect_stderr, redirect_stdout
from stochlin.views.command import main
for line in sys.stdin:
    folder, *arguments = json.loads(line)
    os.chdir(folder)
    out, error, status = io.StringIO(), io.StringIO(), 0
    with redirect_stdout(out), redirect_stderr(error):
        try:
            main(arguments, prog_name="stochlin")
        except SystemExit as end:
            status = end.code
    print(json.dumps([status, out.getvalue(), error.getvalue()]), flush=True)
"""


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """``start(source, code)`` runs code where a module ``toy`` of this source is installed."""
    running = {}

    def start(source, code=COMMANDS):
        if (source, code) in running:
            return running[source, code]
        folder = tmp_path_factory.mktemp("installed")
        (folder / "toy.py").write_text(source, encoding="utf-8")
        about = folder / "toy-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[stochlin.extensions]\ntoy = toy\n")
        path = os.pathsep.join([str(folder), *filter(None, sys.path)])
        running[source, code] = Popen(
            [sys.executable, "-W", "error", "-c", code],
            stdin=PIPE,
            stdout=PIPE,
            text=True,
            encoding="utf-8",
            cwd=folder,
            env=os.environ | {"PYTHONPATH": path, "PYTHONIOENCODING": "utf-8"},
        )
        return running[source, code]

    yield start
    for process in running.values():
        process.communicate()


@pytest.fixture
def install(start, tmp_path):
    """``install(source)`` installs a module; returns a runner of ``stochlin``, in the test's folder."""

    def install(source):
        process = start(source)

        def run(*arguments):
            command = [str(argument) for argument in (tmp_path, *arguments)]
            process.stdin.write(json.dumps(command) + "\n")
            process.stdin.flush()
            return CompletedProcess(command, *json.loads(process.stdout.readline()))

        return run

    return install


@pytest.fixture
def example():
    """``example(heading)`` is the code in that section of the page, as a reader would copy it."""

    def example(heading):
        section = (
            PAGE.read_text(encoding="utf-8").partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
        )
        return re.search(r"^```py\n(.*?)^```", section, re.DOTALL | re.MULTILINE)[1]

    return example
