"""TOML files, read as data; errors state the line."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from stochlin.analyses.tables.inputs import read_input
from stochlin.messages import brief, plain

MOST_BYTES = 2**20  # of a case file or a specification, which a person writes


def read_toml(path: Path) -> tuple[str, dict[str, Any]]:
    """Text and data of a TOML file.

    Raises an OSError if the file cannot be read, and a ValueError if it is no TOML.
    """
    name, content = plain(path.name), read_input(path, MOST_BYTES)
    try:
        text = content.decode("utf-8-sig")
        return text, tomllib.loads(text)
    except UnicodeDecodeError as error:
        raise ValueError(
            f"{name} is no TOML file: it is not text in UTF-8 ({error}); save it as such"
        ) from error
    except RecursionError as error:
        raise ValueError(f"{name} is nested too deeply; allowed: tables and their keys") from error
    except ValueError as error:  # TOML errors, and numbers with thousands of digits
        match = re.search(r"line (\d+)", str(error))
        lines = text.splitlines()
        endless = (n for n, entry in enumerate(lines, 1) if re.search(r"[\d_]{1000}", entry))
        line = int(match[1]) if match else next(endless, len(lines))
        excerpt = lines[line - 1].strip() if 0 < line <= len(lines) else ""
        raise ValueError(
            f"{name}, line {line}: {brief(excerpt)} is no TOML file's text ({plain(error)}); a value "
            'with a unit and any other text stand in quotation marks, such as period = "0.6 s"'
        ) from error
