"""A package from outside that extends stochlin: installed into a folder, used from the command line."""

import json
import os
import re
import sys
from contextlib import contextmanager
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


@contextmanager
def starter(folders):
    """``start(source, code)`` runs code where a module ``toy`` of this source is installed."""
    running = {}

    def start(source, code=COMMANDS):
        if (source, code) in running:
            return running[source, code]
        folder = folders.mktemp("installed")
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


@pytest.fixture(scope="module")
def start(tmp_path_factory):
    """Starts processes that end with the tests of a file."""
    with starter(tmp_path_factory) as start:
        yield start


def runner(process, folder):
    """Runs ``stochlin`` in a folder."""

    def run(*arguments):
        command = [str(argument) for argument in (folder, *arguments)]
        process.stdin.write(json.dumps(command) + "\n")
        process.stdin.flush()
        return CompletedProcess(command, *json.loads(process.stdout.readline()))

    return run


@pytest.fixture
def install(start, tmp_path):
    """``install(source)`` installs a module; returns a runner of ``stochlin``, in the test's folder."""
    return lambda source: runner(start(source), tmp_path)


def section(heading):
    """The code in that section of the page, as a reader would copy it."""
    text = PAGE.read_text(encoding="utf-8").partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    return re.search(r"^```py\n(.*?)^```", text, re.DOTALL | re.MULTILINE)[1]


@pytest.fixture
def example():
    """``example(heading)`` is the code in that section of the page."""
    return section


@pytest.fixture(scope="session")
def of_the_page(tmp_path_factory):
    """A process in which all examples of the page are installed, as one module."""
    headings = ("A hysteresis law", "A ground", "A contact element", "A code rule")
    headings += ("A rule for effective properties", "A chart", "A command")
    with starter(tmp_path_factory) as start:
        yield start("\n".join(map(section, headings)))


@pytest.fixture
def toy(of_the_page, tmp_path):
    """Runs ``stochlin`` with all examples of the page, in the test's folder."""
    return runner(of_the_page, tmp_path)
