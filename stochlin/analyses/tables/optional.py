"""Optional packages, imported where they are needed."""

from __future__ import annotations

import importlib
from typing import Any


def needed(module: str, what: str, extra: str, otherwise: str = "") -> Any:
    """An optional package; an ImportError with the command that installs it if it is missing.

    ``otherwise`` is what can be done without it.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        cure = "; or ".join(filter(None, (f"pip install 'stochlin[{extra}]'", otherwise)))
        raise ImportError(f"{what} needs {module}: {cure}") from error
