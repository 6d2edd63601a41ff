"""OpenSeesPy, for the benchmarks and the tests that compare with it."""

import ctypes
import importlib
import importlib.util
from pathlib import Path
from typing import Any


def load_opensees() -> Any:
    """The module, or an ImportError that says why not.

    Its Linux wheels carry libraries that the linker does not always find by itself.
    """
    bundle = importlib.util.find_spec("openseespylinux")
    for folder in (bundle.submodule_search_locations or []) if bundle else []:
        for pattern in ("libquadmath*", "libgfortran*", "libblas*", "liblapack*"):
            for library in sorted(Path(folder, "lib").glob(pattern)):
                try:
                    ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
                except OSError:
                    continue  # then the import below tells
    try:
        return importlib.import_module("openseespy.opensees")
    except (ImportError, RuntimeError, OSError) as error:
        raise ImportError(f"OpenSeesPy does not load: {error}") from error


def opensees_or_none() -> Any:
    """The module, or None: a benchmark then leaves it out."""
    try:
        return load_opensees()
    except ImportError:
        return None
