"""A package from outside that extends stochlin: installed into a folder, used from the command line."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "extending.md"
COMMAND = "from stochlin.views.command import main; main(prog_name='stochlin')"


@pytest.fixture
def install(tmp_path):
    """``install(source)`` puts a module there as a package would; returns a runner of ``stochlin``."""

    def install(source):
        (tmp_path / "toy.py").write_text(source, encoding="utf-8")
        about = tmp_path / "toy-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[stochlin.extensions]\ntoy = toy\n")

        def run(*arguments):
            path = os.pathsep.join([str(tmp_path), *filter(None, sys.path)])
            return subprocess.run(
                [sys.executable, "-W", "error", "-c", COMMAND, *map(str, arguments)],
                capture_output=True,
                text=True,
                check=False,
                cwd=tmp_path,
                env=os.environ | {"PYTHONPATH": path, "PYTHONIOENCODING": "utf-8"},
            )

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
