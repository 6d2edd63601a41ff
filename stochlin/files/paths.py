"""Paths that a user gives."""

from __future__ import annotations

import os
from pathlib import Path

from stochlin.messages import brief

LONGEST_PATH = 4096


def as_path(name: str, value: object) -> Path:
    """The path; raises a TypeError or ValueError if ``value`` cannot be one."""
    if not isinstance(value, (str, os.PathLike)):
        raise TypeError(f"{name} = {brief(value)}; allowed: the name of a file, as text or a path")
    if len(os.fspath(value)) > LONGEST_PATH:
        raise ValueError(f"{name} = {brief(value)} is too long; allowed: {LONGEST_PATH} characters")
    return Path(value)
