"""A package from outside that extends stochlin: installed into a folder, used from the command line."""

import os
import re
import sys
from pathlib import Path

import pytest
from commands import process

PAGE = Path(__file__).parents[2] / "docs" / "extending.md"


@pytest.fixture
def install(tmp_path):
    """``install(source)`` installs a module ``toy``; returns a runner of ``stochlin`` in the folder."""

    def installed(source):
        (tmp_path / "toy.py").write_text(source, encoding="utf-8")
        about = tmp_path / "toy-1.0.dist-info"
        about.mkdir()
        (about / "METADATA").write_text("Metadata-Version: 2.1\nName: toy\nVersion: 1.0\n")
        (about / "entry_points.txt").write_text("[stochlin.extensions]\ntoy = toy\n")
        path = {"PYTHONPATH": os.pathsep.join([str(tmp_path), *filter(None, sys.path)])}
        start = "-W", "error", "-m", "stochlin"
        return lambda *arguments: process(tmp_path, path, *start, *map(str, arguments))

    return installed


@pytest.fixture
def toy(install):
    """A runner of ``stochlin`` with all examples of the page, as a reader would copy them."""
    sections = re.split(r"^## ", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    code = (re.search(r"^```py\n(.*?)^```", each, re.DOTALL | re.MULTILINE) for each in sections)
    return install("\n".join(found[1] for found in code if found))
