"""Processes of Python that this one starts: none of them imports from the folder in which it runs.

A program that is started as ``python -c`` looks for modules in the current folder first, also for
those of Python itself: a file ``pickle.py`` of somebody else would be run.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

PACKAGE = Path(__file__).parents[2]
# What a child runs before all else. The package is the one that this process runs, which need not
# be the first that `sys.path` has; the other modules of its folder come after all others.
_BEGIN = """
import sys
from importlib.util import module_from_spec, spec_from_file_location
sys.path.append({folder!r})
_spec = spec_from_file_location({name!r}, {start!r}, submodule_search_locations=[{package!r}])
sys.modules[{name!r}] = module_from_spec(_spec)
_spec.loader.exec_module(sys.modules[{name!r}])
"""


def command(program: str, *arguments: str) -> list[str]:
    """The command line of a child that runs a program, a text in Python, with these arguments."""
    begin = _BEGIN.format(
        folder=str(PACKAGE.parent),
        name=PACKAGE.name,
        start=str(PACKAGE / "__init__.py"),
        package=str(PACKAGE),
    )
    return [sys.executable, "-P", "-c", begin + program, *arguments]


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment of a child, and of what it starts in turn, with further variables."""
    return {**os.environ, "PYTHONSAFEPATH": "1", **(variables or {})}


def isolated(program: Path, *arguments: str) -> list[str]:
    """The command line of a child that runs the program of a file with Python's library alone."""
    return [sys.executable, "-I", "-S", str(program), *arguments]
