"""Processes of Python that this one starts: none of them imports from the folder in which it runs.

A program that is started as ``python -c`` looks for modules in the current folder first, also for those
of Python itself: a file ``pickle.py`` of somebody else would be run.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

PACKAGE = Path(__file__).parents[3]  # the folder that holds the package
# What a child runs before all else: the package is found where this process has it, after all others.
_BEGIN = "import sys; sys.path.append({folder!r}); "


def command(program: str, *arguments: str) -> list[str]:
    """The command line of a child that runs a program, a text in Python, with these arguments."""
    return [sys.executable, "-P", "-c", _BEGIN.format(folder=str(PACKAGE)) + program, *arguments]


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """The environment of a child, and of what it starts in turn, with further variables."""
    return {**os.environ, "PYTHONSAFEPATH": "1", **(variables or {})}


def isolated(program: Path, *arguments: str) -> list[str]:
    """The command line of a child that runs the program of a file with the library of Python alone."""
    return [sys.executable, "-I", "-S", str(program), *arguments]
