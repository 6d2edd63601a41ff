"""Tables of the package, as TOML files beside the modules that use them."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def data_of(package: str | None, name: str) -> dict[str, Any]:
    """The content of a TOML file in the folder of a package."""
    assert package is not None  # of a module that is run as a program
    return tomllib.loads(files(package).joinpath(name).read_text(encoding="utf-8"))
